"""Slope: the steepness of planes, of height fields and of meshes."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import shading
from meshdepict.errors import MeshdepictError
from meshdepict.scales.making import scale_space
from meshdepict.shading.slope import slope_angles
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh

COLUMNS, ROWS = np.meshgrid(np.arange(20.0), np.arange(14.0))


def plane(degrees, azimuth=30.0):
    """Ground that rises by an angle towards an azimuth, on cells of 2 m."""
    east, north = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
    rise = np.tan(np.radians(degrees))
    z = rise * 2 * (east * COLUMNS - north * ROWS)
    return HeightField(z, transform=(2, 0, 0, 0, -2, 28))


@pytest.mark.parametrize("degrees", [0.0, 0.01, 10.0, 37.0, 49.9, 50.0, 80.0])
def test_a_plane_has_one_tone_to_its_border(degrees):
    found = shading.slope(scale_space(plane(degrees), scales=0))
    np.testing.assert_allclose(found, max(0, 1 - degrees / 50), atol=2e-6)  # float32 normals


def test_the_steepest_slope_is_black():
    space = scale_space(plane(12.0), scales=0)
    np.testing.assert_allclose(shading.slope(space, steepest=15), 1 - 12 / 15, atol=2e-6)
    assert (shading.slope(space, steepest=12 - 1e-3) == 0).all()
    np.testing.assert_allclose(shading.slope(space, exposure=0.5), (1 - 12 / 50) / 2, atol=2e-6)
    with pytest.raises(MeshdepictError, match="steepest=0"):
        shading.slope(space, steepest=0)


@pytest.mark.parametrize("azimuth", [0, 90, 211])
def test_no_direction_is_special(azimuth):
    found = shading.slope(scale_space(plane(20, azimuth), scales=0))
    np.testing.assert_allclose(found, 0.6, atol=2e-6)


def test_a_cone_is_as_steep_everywhere():
    away = np.hypot(COLUMNS - 9.3, ROWS - 6.4)
    found = HeightField(-away * np.tan(np.radians(25)))
    values = found.image(shading.slope(scale_space(found, scales=0)))
    inner = np.s_[1:-1, 1:-1]  # the border has one-sided differences
    far = away[inner] > 4  # two-sided ones are off by 1/(2·4²) of the slope at most, a third of it
    np.testing.assert_allclose(values[inner][far], 0.5, atol=0.5 / 32)


def test_the_ground_as_a_mesh_is_as_steep():
    waves = HeightField(3 * np.sin(COLUMNS / 6) + 2 * np.cos(ROWS / 5))
    one, other = (shading.slope(scale_space(s, scales=0)) for s in (waves, waves.mesh))
    inner = np.zeros(waves.z.shape, bool)
    inner[1:-1, 1:-1] = True
    np.testing.assert_allclose(one[inner.ravel()], other[inner.ravel()], atol=0.02)


def test_whatever_light_there_is_it_looks_the_same():
    field = plane(20)
    one, other = (md.bake(field, "slope", light=light) for light in ("west", (10, 80)))
    np.testing.assert_array_equal(one.colors, other.colors)


def test_an_object_without_ground_is_white_where_it_faces_the_eye():
    ball = md.samples.sphere(2000)
    space = scale_space(ball, scales=0)
    for view, axis in (("front", 2), ("right", 0)):
        cosine = space.normals_at(0)[:, axis]
        expected = 1 - np.degrees(np.arccos(np.clip(cosine, -1, 1))) / 90
        found = shading.slope(space, view=view, steepest=90)
        np.testing.assert_allclose(found, np.clip(expected, 0, 1), atol=1e-4)


def test_angles_are_exact_from_level_to_upside_down():
    angles = np.array([1e-5, 0.1, 45, 89.9, 90, 135, 180])
    normals = np.stack(
        [np.sin(np.radians(angles)), 0 * angles, np.cos(np.radians(angles))], axis=1
    ).astype(np.float32)
    found = slope_angles(normals, np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(found, angles, rtol=1e-5, atol=1e-5)


def test_a_sheet_is_as_steep_whichever_way_its_axis_points():
    waves = HeightField(np.sin(COLUMNS / 6)).mesh
    turned = Mesh(waves.vertices[:, [1, 2, 0]], waves.faces)
    one, other = (shading.slope(scale_space(s, scales=0)) for s in (waves, turned))
    np.testing.assert_allclose(one, other, atol=1e-5)
