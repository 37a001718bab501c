"""Grids of PyVista: even ones are terrain, whichever way they lie, others sheets."""

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.height_grids import (
    even_transform,
    image_ground,
    is_layer,
    structured_ground,
)
from meshdepict.shapes.mesh import Mesh

pv = pytest.importorskip("pyvista")


def structured(x, y, z):
    return pv.StructuredGrid(*(np.asarray(a, np.float64)[..., None] for a in (x, y, z)))


def waves(angle=0.0, step=(2.0, 3.0)):
    i, j = np.meshgrid(np.arange(7), np.arange(5), indexing="ij")
    u, v = step[0] * i, step[1] * j
    x, y = u * np.cos(angle) - v * np.sin(angle), u * np.sin(angle) + v * np.cos(angle)
    return x + 100, y - 50, np.sin(i) + 0.2 * j


@pytest.mark.parametrize("angle", [0, 0.3, np.pi / 2, np.pi, 4.0])
@pytest.mark.parametrize("step", [(2.0, 3.0), (-2.0, 3.0), (2.0, -1.0)])
def test_an_even_structured_grid_is_terrain_with_its_own_points(angle, step):
    grid = structured(*waves(angle, step))
    field, there = structured_ground(grid)
    assert isinstance(field, HeightField)
    assert there.all()
    np.testing.assert_allclose(field.points, grid.points, rtol=0, atol=1e-9)


def test_points_without_a_height_are_left_out():
    x, y, z = waves()
    z[2, 1] = np.nan
    grid = structured(x, y, z)
    field, there = structured_ground(grid)
    np.testing.assert_array_equal(there, np.isfinite(grid.points[:, 2]))
    np.testing.assert_allclose(field.points, grid.points[there], rtol=0, atol=1e-9)


@pytest.mark.parametrize("kind", ["uneven", "sheared", "upright", "a missing place"])
def test_other_layers_are_sheets_with_the_grid_s_cells(kind):
    x, y, z = waves()
    if kind == "uneven":
        x = x**1.05
    elif kind == "sheared":
        x = x + 0.2 * y
    elif kind == "upright":
        y, z = z, y
    else:
        x[3, 2] = np.nan
    grid = structured(x, y, z)
    mesh, there = structured_ground(grid)
    assert isinstance(mesh, Mesh)
    np.testing.assert_array_equal(mesh.vertices, np.asarray(grid.points)[there])
    whole = 6 * 4 - (4 if kind == "a missing place" else 0)
    assert len(mesh.faces) == 2 * whole
    clean = np.nan_to_num(np.asarray(grid.extract_surface(algorithm="geometry").points))
    assert len(clean) == grid.n_points


def test_points_in_single_precision_are_even_as_far_as_they_can_be():
    x, y, z = waves()
    points = np.stack([x + 5e5, y + 5e6, z], axis=-1).astype(np.float32)
    grid = pv.StructuredGrid(*(np.ascontiguousarray(points[..., None, axis]) for axis in range(3)))
    field, _ = structured_ground(grid)
    assert isinstance(field, HeightField)
    np.testing.assert_allclose(field.spacing, (2, 3), atol=0.2)


def test_images_that_lie_level_are_terrain():
    image = pv.ImageData(dimensions=(6, 4, 1), spacing=(0.5, 2, 1), origin=(10, 20, 5))
    image["h"] = np.arange(24.0)
    field, _ = image_ground(image, "point", "h")
    expected = np.asarray(image.points) + np.outer(np.arange(24.0), (0, 0, 1))
    np.testing.assert_allclose(field.points, expected)
    image.direction_matrix = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]  # a quarter turn on the ground
    field, _ = image_ground(image, "point", "h")
    expected = np.asarray(image.points) + np.outer(np.arange(24.0), (0, 0, 1))
    np.testing.assert_allclose(field.points, expected)
    image.direction_matrix = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]  # on its edge
    assert isinstance(image_ground(image, "point", "h")[0], Mesh)


def test_what_has_one_layer_is_told_from_volumes_and_lines():
    assert is_layer(pv.ImageData(dimensions=(3, 4, 1)))
    assert is_layer(pv.ImageData(dimensions=(1, 4, 3)))
    assert is_layer(structured(*waves()))
    for other in (
        pv.ImageData(dimensions=(3, 4, 2)),
        pv.ImageData(dimensions=(3, 1, 1)),
        pv.StructuredGrid(),
        pv.Sphere(),
        np.zeros((3, 4)),
    ):
        assert not is_layer(other)


def test_a_grid_whose_cells_all_lack_a_point_is_no_surface():
    x, y, z = waves()
    z[::2, ::2] = np.nan
    z[1::2, 1::2] = np.nan
    with pytest.raises(MeshdepictError, match="StructuredGrid are no surface: nowhere do four"):
        structured_ground(structured(x, y, z))
    x[::2] = np.nan
    x[1::2] = np.nan
    with pytest.raises(MeshdepictError, match="no surface"):
        structured_ground(structured(x, y, z))


def test_what_is_all_in_one_place_is_not_even():
    nothing = np.zeros((3, 4))
    assert even_transform(nothing, nothing) is None
    assert even_transform(np.zeros((1, 4)), np.zeros((1, 4))) is None
