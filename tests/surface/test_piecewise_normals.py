"""Planes, creases, and the normals of the triangles beside them."""

import numpy as np
import pytest
from conftest import angle_between

from meshdepict import samples
from meshdepict.baking.finer_mesh import FinerMesh
from meshdepict.io import read_mesh
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.coarseness import coarse_share

CORNERS = np.array([(x, y, z) for x in (0, 4) for y in (0, 3) for z in (0, 1)], float)
BOX = np.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
     (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
)  # fmt: skip


def rod(sides, rings=1):
    """A cylinder of so many sides, its caps fans round their centres."""
    angle = 2 * np.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    levels = [np.pad(circle, ((0, 0), (0, 1)), constant_values=4 * z) for z in (0, 1)]
    points = np.concatenate([*levels, [(0, 0, 0), (0, 0, 4)]])
    i = np.arange(sides)
    j = (i + 1) % sides
    bottom, top = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    parts = [(i, j, j + sides), (i, j + sides, i + sides), (j, i, bottom),
             (i + sides, j + sides, top)]  # fmt: skip
    return Mesh(points, np.concatenate([np.stack(part, axis=1) for part in parts]))


def face_normals(mesh):
    a, b, c = mesh.vertices[mesh.outward_faces].swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_a_box_is_six_planes_and_its_corners_point_outwards_evenly():
    box = Mesh(CORNERS, BOX)
    pieces = FinerMesh(box).pieces
    assert pieces.flat.all()
    np.testing.assert_allclose(pieces.corners, np.repeat(face_normals(box)[:, None], 3, 1))
    # The mean of three faces, each once, however many triangles it has there.
    outwards = np.sign(CORNERS - CORNERS.mean(axis=0)) / np.sqrt(3)
    np.testing.assert_allclose(pieces.vertices, outwards, atol=1e-12)


def test_edges_bisect_the_angle_of_two_planes_and_diagonals_lie_in_one():
    box = Mesh(CORNERS, BOX)
    finer = FinerMesh(box)
    edges = finer.edges()
    found = finer.middles(edges).normals
    owners = [face_normals(box)[[set(e) <= set(f) for f in BOX]] for e in edges]
    expected = np.array([pair.sum(axis=0) for pair in owners])
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("kind", ["apart", "turned", "apart and turned"])
def test_how_a_box_is_stored_makes_no_difference_to_its_planes(kind):
    vertices, faces = CORNERS, BOX.copy()
    if "turned" in kind:
        faces[::3] = faces[::3, ::-1]
    if "apart" in kind:
        vertices, faces = CORNERS[faces.ravel()], np.arange(36).reshape(12, 3)
    with pytest.warns(match="winding") if "turned" in kind else np.errstate():
        box = Mesh(vertices, faces)
        pieces = FinerMesh(box).pieces
        normals = face_normals(box)
    assert pieces.flat.all()
    np.testing.assert_allclose(pieces.corners, np.repeat(normals[:, None], 3, 1), atol=1e-12)
    np.testing.assert_allclose(
        np.sign(vertices - CORNERS.mean(axis=0)) * pieces.vertices > -1e-9, True
    )


def test_a_rod_stays_round_and_its_caps_are_flat():
    mesh = rod(24)
    pieces = FinerMesh(mesh).pieces
    cap = np.abs(face_normals(mesh)[:, 2]) > 0.9
    np.testing.assert_array_equal(pieces.flat, cap)
    np.testing.assert_allclose(np.abs(pieces.corners[cap][..., 2]), 1)
    radial = mesh.vertices[mesh.faces[~cap]] * (1, 1, 0)
    # Half of a side's angle at most: the seam of triangles leans to one of its neighbours.
    assert angle_between(pieces.corners[~cap].reshape(-1, 3), radial.reshape(-1, 3)).max() < 0.07
    np.testing.assert_allclose(pieces.corners[~cap][..., 2], 0, atol=1e-12)


def test_parts_of_triangles_inherit_their_normals(rng):
    finer = FinerMesh(Mesh(CORNERS, BOX))
    for _ in range(3):
        edges = finer.edges()
        finer.split(edges, finer.middles(edges), rng.random(len(edges)) < 0.6)
    mesh = finer.mesh()
    np.testing.assert_allclose(
        finer.pieces.corners, np.repeat(face_normals(mesh)[:, None], 3, 1), atol=1e-12
    )
    # A vertex inside a face of the box has its normal; on an edge, the mean of two.
    walls = (mesh.vertices == 0) | (mesh.vertices == (4, 3, 1))
    sides = np.where(mesh.vertices == 0, -1, 1) * walls
    expected = sides / np.linalg.norm(sides, axis=1, keepdims=True)
    np.testing.assert_allclose(finer.pieces.vertices, expected, atol=1e-12)


@pytest.mark.parametrize("size", [1e-6, 1e6])
def test_planes_are_found_at_any_size_and_in_single_precision_far_from_the_origin(size):
    far = (CORNERS * size + 30 * size).astype(np.float32).astype(float)
    assert FinerMesh(Mesh(far, BOX)).pieces.flat.all()


def test_what_is_smooth_has_no_planes(sphere, ball):
    for mesh in (sphere, ball, samples.torus(5_000), samples.sphere(40_000)):
        assert FinerMesh(mesh).pieces is None


@pytest.mark.parametrize("name", ["bunny_69k", "armadillo_86k"])
def test_scans_have_no_planes(data, name):
    assert FinerMesh(read_mesh(data / "mesh" / f"{name}.ply")).pieces is None


def test_flat_patches_with_nothing_sharp_about_them_keep_their_normals():
    sheet = samples.wavy_sheet(900, waves=0)
    assert FinerMesh(sheet).pieces is None


def test_large_triangles_with_other_normals_are_told_from_even_ones(sphere):
    def share(mesh):
        unit = mesh.diagonal
        return coarse_share(
            mesh.unit_points, mesh.outward_faces, mesh.normals, edge=mesh.edge_length / unit
        )

    assert share(sphere) == 0
    assert share(Mesh(CORNERS, BOX)) == 0  # all of its triangles are large
    plain = Mesh(CORNERS, BOX)
    finer = FinerMesh(plain)
    for _ in range(4):  # one of its edges many times over: the rest is large beside it
        edges = finer.edges()
        small = np.zeros(len(edges), bool)
        ends = finer.points(finer.vertices)[edges]
        small[(np.abs(ends - finer.points(finer.vertices)[0]).max(axis=(1, 2)) < 0.6)] = True
        finer.split(edges, finer.middles(edges), small)
    uneven = finer.mesh()
    long = np.linalg.norm(np.ptp(uneven.vertices[uneven.faces], axis=1), axis=1)
    assert (long > 3 * uneven.edge_length).any()
    assert share(uneven) > 0.3
