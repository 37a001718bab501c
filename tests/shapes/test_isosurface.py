"""Isosurfaces: in the world, of the right size and facing outwards, whatever the grid's axes."""

import numpy as np
import pytest
from conftest import rotation

import meshdepict as md
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.isosurface import isosurface
from meshdepict.shapes.volume import Volume

RADIUS = 7.0
CENTRE = np.array((300.0, -20.0, 7.0))


def ball(direction, spacing=(1.0, 0.8, 1.3)):
    """A ball whose values fall by one per unit of length; at its radius they are 0."""
    count = np.ceil(2 * (RADIUS + 3) / np.array(spacing)).astype(int)
    z, y, x = (np.arange(n) * s for n, s in zip(count[::-1], spacing[::-1], strict=True))
    middle = (count - 1) * np.array(spacing) / 2
    distance = np.sqrt(
        (z[:, None, None] - middle[2]) ** 2 + (y[:, None] - middle[1]) ** 2 + (x - middle[0]) ** 2
    )
    origin = CENTRE - direction @ middle
    values = (RADIUS - distance).astype(np.float32)
    return Volume(values, spacing=spacing, origin=origin, direction=direction)


@pytest.mark.parametrize("mirror", [1, -1])
@pytest.mark.parametrize("value", [0.0, 2.0])
def test_a_ball_is_a_sphere_in_the_world(mirror, value, rng):
    direction = rotation(rng) * (1, mirror, 1)
    mesh = isosurface(ball(direction), value)
    away = mesh.vertices - CENTRE
    # Linear interpolation of a distance over a step of about one at a radius of five: 1/8/5.
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), RADIUS - value, atol=0.05)
    a, b, c = mesh.vertices[mesh.faces].swapaxes(0, 1)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    outwards = np.einsum("ni,ni->n", normal, (a + b + c) / 3 - CENTRE)
    assert (outwards[length > 1e-6] > 0).all()


def test_the_surface_goes_through_the_mesh_path():
    mesh = isosurface(md.samples.ct_phantom((48, 48, 48)), 200)
    baked = md.bake(mesh, scales=3)
    assert len(baked.colors) == len(mesh.vertices)
    assert baked.colors.std() > 5


@pytest.mark.parametrize("value", [-1e6, 1e6, np.nan, np.inf, True])
def test_a_value_that_nothing_has_is_refused(value):
    with pytest.raises(MeshdepictError, match="the volume's values are"):
        isosurface(ball(np.eye(3)), value)


def nested(*radii, walls=True):
    """Distances to nested spheres in a box, positive where it is dense: outside of all, or not."""
    z, y, x = np.mgrid[:40, :40, :40] - 19.5
    away = np.sqrt(x * x + y * y + z * z)[..., None] - radii
    dense = ((away < 0).sum(axis=-1) % 2 == 0) == walls
    return Volume(np.where(dense, 1, -1) * np.abs(away).min(axis=-1))


def towards_lower(mesh, volume):
    """Whether each face looks to where the values are lower, half a voxel away on either side."""
    from scipy.ndimage import map_coordinates

    a, b, c = mesh.vertices[mesh.faces].swapaxes(0, 1)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal, middle = (normal / np.maximum(length, 1e-12)), (a + b + c) / 3
    sides = [
        map_coordinates(volume.values, (middle + side * 0.5 * normal).T[::-1], order=1)
        for side in (1, -1)
    ]
    return (sides[0] < sides[1])[length[:, 0] > 1e-3]


@pytest.mark.parametrize("radii", [(9,), (6, 13), (4, 9, 14)])
def test_voids_in_a_block_face_inwards(radii):
    # Without its outer walls the block is nothing but voids: summed volumes would turn all of them.
    volume = nested(*radii)
    mesh = isosurface(volume, 0.0)
    assert towards_lower(mesh, volume).all()
    np.testing.assert_array_equal(mesh.rewound().faces, mesh.faces)
    outer = np.linalg.norm(mesh.vertices - 19.5, axis=1) > max(radii) - 1
    inwards = np.einsum("ni,ni->n", mesh.normals, 19.5 - mesh.vertices)
    assert (inwards[outer] > 0).all()


def test_nested_shells_look_out_of_what_is_dense():
    volume = nested(4, 9, 14, walls=False)
    mesh = isosurface(volume, 0.0)
    assert towards_lower(mesh, volume).all()
    away = mesh.vertices - 19.5
    radius = np.linalg.norm(away, axis=1)
    outwards = np.einsum("ni,ni->n", mesh.normals, away) > 0
    for shell, side in ((4, True), (9, False), (14, True)):
        here = np.abs(radius - shell) < 1
        assert here.any()
        assert (outwards[here] == side).all()


def test_a_surface_is_in_the_volumes_unit_of_length():
    ball_in_mm = md.samples.ct_phantom((24, 24, 24))
    assert ball_in_mm.length_unit == "mm"
    assert isosurface(ball_in_mm, 200).length_unit == "mm"
    assert isosurface(ball(np.eye(3)), 0.0).length_unit == ""
