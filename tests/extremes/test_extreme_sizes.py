"""What must not matter, however much of it there is: units, place, order."""

from __future__ import annotations

import numpy as np
import pytest
from extreme_calls import usual, variants
from method_families import ON_MESHES
from odd_meshes import golf_ball

import meshdepict as md
from meshdepict.shading import METHODS, declaration

TURNED = (0.3, -0.2, 1.0)  # a line of sight along which no vertex is seen edge on by symmetry
EXACT = {"scales": 3, "tolerance": 1e-7}


def shades(method, mesh, width, *, unit=1.0, place=(0.0, 0.0, 0.0), ways=None):
    place = np.asarray(place, float)
    space = md.scale_space(mesh, width=width, **EXACT)
    options = {}
    if "view" in declaration(METHODS[method]).needs:
        eye = 5 * unit * np.array(TURNED) + place
        options["view"] = md.View(eye, place, (0, 1, 0), parallel_scale=1.3 * unit)
    return [
        METHODS[method](space, "northwest", **options, **way) for way in ways or variants(method)
    ]


@pytest.fixture(scope="module")
def ball():
    return md.Mesh(*golf_ball())


@pytest.fixture(scope="module")
def plain(ball):
    return {method: shades(method, ball, ball.edge_length) for method in ON_MESHES}


@pytest.mark.parametrize("exponent", [-490, -100, -1, 1, 100, 490])
@pytest.mark.parametrize("method", ON_MESHES)
def test_a_power_of_two_as_the_unit_changes_no_bit(method, exponent, ball, plain):
    unit = 2.0**exponent
    mesh = md.Mesh(ball.vertices * unit, ball.faces)
    found = shades(method, mesh, ball.edge_length * unit, unit=unit)
    for one, other in zip(found, plain[method], strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("sizes", [1e4, 1e8])
@pytest.mark.parametrize("method", ON_MESHES)
def test_a_place_far_away_changes_no_more_than_rounding(method, sizes, ball):
    # 1e8 sizes away, coordinates are rounded to 1e-8 of the size, normals of edges of 0.3 to 1e-7
    # or so. In exaggerated shading that becomes 1e-4 (METHODS of it: ½ · 15 · 1e-7 / 1e-3); nothing
    # else magnifies more. Rays begin at other places, and are others.
    place = sizes * ball.diagonal * np.array([1.0, -1.0, 1.0])
    there = md.Mesh(ball.vertices + place, ball.faces)
    rounded = md.Mesh(there.vertices - place, ball.faces)
    found = shades(method, there, ball.edge_length, place=place, ways=[usual(method)])
    near = shades(method, rounded, ball.edge_length, ways=[usual(method)])
    if "rays" in usual(method):
        return
    np.testing.assert_allclose(found[0], near[0], atol=1e-3)


@pytest.mark.parametrize("method", ON_MESHES)
def test_the_order_of_faces_and_corners_does_not_matter(method, ball, plain, rng):
    order = rng.permutation(len(ball.faces))
    faces = np.roll(ball.faces[order], 1, axis=1)
    found = shades(method, md.Mesh(ball.vertices, faces), ball.edge_length)
    for one, other in zip(found, plain[method], strict=True):
        np.testing.assert_allclose(one, other, atol=1 / 255)


@pytest.mark.parametrize("unit", [2.0**-30, 2.0**30])
def test_volumes_of_tiny_and_huge_voxels_are_shaded_alike(unit):
    values = md.samples.ct_phantom((12, 10, 11)).values
    found = []
    for s in (1.0, unit):
        volume = md.Volume(values, spacing=(s, 2 * s, s))
        space = md.scale_space(volume, scales=2, width=3 * s)
        found.append(METHODS["exaggerated"](space, "northwest"))
    np.testing.assert_array_equal(*found)


@pytest.mark.parametrize("unit", [2.0**-30, 2.0**30])
@pytest.mark.parametrize("method", ["exaggerated", "lambert", "hillshade", "slope"])
def test_terrain_of_tiny_and_huge_cells_is_shaded_alike(method, unit):
    y, x = np.mgrid[:9, :11]
    z = np.sin(x) + 3 * np.cos(y)
    near, far = (
        md.bake(md.HeightField(z * s, transform=(s, 0, 0, 0, -s, 0)), method).intensity
        for s in (1.0, unit)
    )
    np.testing.assert_allclose(near, far, atol=1e-6)
