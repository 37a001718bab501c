"""Relief shades: a plane's everywhere, GDAL's where it is at hand, and no-data."""

from __future__ import annotations

import math
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from grounds import AXES, hill, placed, plane

from meshdepict.heights.horn import (
    horn_slopes,
    mark_relief,
    relief,
)
from meshdepict.heights.map_rules import MARK_AZIMUTHS, MARK_ELEVATION

NORTHWEST = np.array([-0.5, 0.5, math.sqrt(0.5)])


def mark(east: np.ndarray, north: np.ndarray) -> np.ndarray:
    """The formula of Mark (1992) for slopes, as METHODS would have it by hand."""
    aspect, height = np.arctan2(-east, -north), math.radians(MARK_ELEVATION)
    shade = np.zeros(np.shape(east))
    for azimuth in np.radians(MARK_AZIMUTHS):
        rise = np.sin(azimuth) * east + np.cos(azimuth) * north
        cosine = (math.sin(height) - math.cos(height) * rise) / np.sqrt(1 + east**2 + north**2)
        shade += 0.5 * np.sin(aspect - azimuth) ** 2 * np.maximum(cosine, 0)
    return shade


@pytest.mark.parametrize("steps", AXES.values(), ids=AXES)
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_a_plane_has_one_slope_and_one_shade_also_at_the_border(
    steps: np.ndarray, offset: float
) -> None:
    z = plane(steps, (7, 9), 0.3, -0.7) + offset
    slopes = horn_slopes(z, None, steps)
    np.testing.assert_allclose(slopes[0], 0.3, atol=1e-6)
    np.testing.assert_allclose(slopes[1], -0.7, atol=1e-6)
    normal = np.array([-0.3, 0.7, 1]) / math.sqrt(1 + 0.3**2 + 0.7**2)
    np.testing.assert_allclose(relief(z, None, steps, NORTHWEST), normal @ NORTHWEST, atol=1e-6)
    shade = float(mark(np.float64(0.3), np.float64(-0.7)))
    np.testing.assert_allclose(mark_relief(z, None, steps), shade, atol=1e-6)


def test_cells_without_a_height_neither_shade_nor_change_what_is_beside_them(
    rng: np.random.Generator,
) -> None:
    steps = AXES["turned"]
    valid = rng.random((30, 40)) > 0.35
    z = np.where(valid, plane(steps, valid.shape, 0.3, -0.7), 1e30)
    slopes = horn_slopes(z, valid, steps)
    assert not slopes[:, ~valid].any()
    assert not relief(z, valid, steps, NORTHWEST)[~valid].any()
    assert not mark_relief(z, valid, steps)[~valid].any()
    # Two neighbours, one along each axis, tell a plane.
    padded = np.pad(valid, 1)
    along = padded[1:-1, :-2] | padded[1:-1, 2:]
    down = padded[:-2, 1:-1] | padded[2:, 1:-1]
    told = valid & along & down
    assert told.sum() > 500
    np.testing.assert_allclose(slopes[0][told], 0.3, atol=1e-6)
    np.testing.assert_allclose(slopes[1][told], -0.7, atol=1e-6)


def test_a_mask_that_hides_nothing_changes_no_bit(rng: np.random.Generator) -> None:
    z = rng.normal(0, 3, (40, 30)).astype(np.float32)
    every = np.ones(z.shape, bool)
    steps = AXES["squares"]
    np.testing.assert_array_equal(horn_slopes(z, None, steps), horn_slopes(z, every, steps))
    np.testing.assert_array_equal(
        relief(z, None, steps, NORTHWEST), relief(z, every, steps, NORTHWEST)
    )
    np.testing.assert_array_equal(mark_relief(z, None, steps), mark_relief(z, every, steps))


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (1, 1)])
def test_a_row_slopes_along_itself_alone(shape: tuple[int, int]) -> None:
    z = 0.5 * 2 * np.arange(9.0)[: max(shape)].reshape(shape)
    steps = np.array([[[2.0, 0], [0, -2]]])
    east, north = horn_slopes(z, None, steps)
    np.testing.assert_allclose(east, 0.5 if shape == (1, 9) else 0)
    np.testing.assert_allclose(north, -0.5 if shape == (9, 1) else 0)


def test_steps_that_vary_from_row_to_row_count_in_their_row() -> None:
    steps = np.array([[[width, 0], [0, -3.0]] for width in (1.0, 2.0, 4.0, 8.0)])
    z = np.tile(np.arange(6.0), (4, 1))
    np.testing.assert_allclose(horn_slopes(z, None, steps)[0], 1 / steps[:, 0, :1].repeat(6, 1))


def test_slopes_of_a_smooth_hill_are_its_gradient(rng: np.random.Generator) -> None:
    steps = AXES["turned"]
    east, north = placed(steps, (60, 60))
    z, gradient = hill(east, north, width=30.0, height=10.0)
    found = horn_slopes(z, None, steps)
    # The window averages over three cells: an error of (step/width)² of the steepest slope.
    steepest = float(np.hypot(*gradient).max())
    assert np.abs(found - gradient)[:, 1:-1, 1:-1].max() < 0.02 * steepest


def test_level_ground_shades_by_the_height_of_the_sun() -> None:
    z = np.full((5, 5), 812.0, np.float32)
    steps = AXES["squares"]
    np.testing.assert_allclose(relief(z, None, steps, NORTHWEST), math.sqrt(0.5), rtol=1e-6)
    np.testing.assert_allclose(mark_relief(z, None, steps), 0.5, rtol=1e-6)
    np.testing.assert_allclose(mark_relief(z, None, steps, 90), 1, rtol=1e-6)


def test_walls_without_end_have_a_shade() -> None:
    z = np.zeros((4, 6), np.float32)
    z[:, 3:] = 1e38
    steps = AXES["squares"]
    for shade in (relief(z, None, steps, NORTHWEST), mark_relief(z, None, steps)):
        assert np.isfinite(shade).all()
        assert np.abs(shade).max() <= 1 + 1e-6


@pytest.mark.skipif(not shutil.which("gdaldem"), reason="gdaldem is not installed")
@pytest.mark.parametrize("azimuth", [315.0, 40.0])
def test_shades_are_those_of_gdaldem(
    azimuth: float, folder: Path, rng: np.random.Generator
) -> None:
    z = rng.normal(0, 1, (90, 120)).cumsum(0).cumsum(1).astype(np.float32)
    header = "ENVI\nsamples=120\nlines=90\nbands=1\ndata type=4\ninterleave=bsq\nbyte order=0\n"
    place = "map info = {UTM, 1, 1, 500000, 5000000, 2, 3, 33, North, WGS-84}\n"
    (folder / "z.hdr").write_text(header + place)
    z.tofile(folder / "z.bin")
    command = ["gdaldem", "hillshade", "z.bin", "o.bin", "-q", "-of", "ENVI", "-alt", "35"]
    subprocess.run([*command, "-az", str(azimuth)], check=True, timeout=60)
    theirs = np.fromfile(folder / "o.bin", np.uint8).reshape(z.shape).astype(float)
    turn, up = np.radians([azimuth, 35])
    light = np.array([math.sin(turn) * math.cos(up), math.cos(turn) * math.cos(up), math.sin(up)])
    ours = relief(z, None, np.array([[[2.0, 0], [0, -3.0]]]), light)
    # It maps [0, 1] to 1 … 255 and rounds.
    inner = np.s_[1:-1, 1:-1]
    assert np.abs(1 + 254 * np.clip(ours, 0, 1) - theirs)[inner].max() < 0.51
