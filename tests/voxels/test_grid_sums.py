"""Gaussian sums on a grid: exact on polynomials, scipy as the oracle, parts as the whole."""

from __future__ import annotations

import numpy as np
import pytest

from meshdepict.voxels import grid_sums
from meshdepict.voxels.gaussian_bands import Band, gaussian_band
from meshdepict.voxels.grid_samples import Samples, grown
from meshdepict.voxels.grid_sums import BINDING, GRADIENT, GridSums, Piece, halo, reach_of

REACH = reach_of(1e-4)


def dense(band: Band, order: int, inputs: int) -> np.ndarray:
    """A banded matrix with its zeros."""
    matrix = np.zeros((len(band.start), inputs))
    for row, (start, weights) in enumerate(zip(band.start, band.weights[order], strict=True)):
        matrix[row, start : start + band.taps] = weights
    return matrix


def piece_of(values: np.ndarray) -> Piece:
    return Piece(values, (0, 0, 0), values.shape, (float(values.min()), float(values.max())))


def derivatives(
    values: np.ndarray, samples: Samples, width: tuple[float, ...], *, tolerance: float = 1e-4
) -> np.ndarray:
    piece = piece_of(values)
    found = np.empty((3, len(samples)), np.float32)
    GridSums(piece, samples, tolerance).derivatives(np.array(width), GRADIENT, found)
    return found * piece.half_range


@pytest.fixture
def clouds(rng: np.random.Generator) -> np.ndarray:
    """Noise and steps, as int16, in an uneven box."""
    z, y, x = np.mgrid[:34, :41, :57]
    body = np.where((x - 25) ** 2 + (y - 18) ** 2 + 2 * (z - 15) ** 2 < 250, 1200, -900)
    return (body + rng.normal(0, 60, body.shape)).astype(np.int16)


# --- matrices ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("outputs", "width"), [(120, 0.0), (120, 0.3), (120, 2.0), (46, 4.0)])
def test_derivatives_of_polynomials_are_exact_inside(outputs: int, width: float) -> None:
    band = gaussian_band(120, outputs, width, reach=REACH, orders=3)
    step = 120 / outputs
    t = (np.arange(120) - 60) / step  # in output cells
    at = ((np.arange(outputs) + 0.5) * step - 0.5 - 60) / step
    inside = slice(outputs // 3, -(outputs // 3))
    first, second = dense(band, 1, 120), dense(band, 2, 120)
    for matrix, of, expected in (
        (first, np.ones(120), 0 * at),
        (first, t, 1 + 0 * at),
        (first, t**2, 2 * at),
        (second, np.ones(120), 0 * at),
        (second, t, 0 * at),
        (second, t**2, 2 + 0 * at),
    ):
        # Off the centre of a cell p_1 and t² correlate by what lies beyond the cut: e^−16.
        np.testing.assert_allclose((matrix @ of)[inside], expected[inside], atol=2e-5)


def test_rows_of_smoothing_are_averages_also_at_the_border() -> None:
    for outputs, width in ((20, 1.0), (20, 30.0), (7, 5.0), (20, 1e9)):
        band = gaussian_band(20, outputs, width, reach=REACH)
        np.testing.assert_allclose(dense(band, 0, 20).sum(axis=1), 1, rtol=1e-12)
        assert (band.weights >= 0).all()


def test_no_width_copies_and_the_limit_is_the_central_difference() -> None:
    np.testing.assert_array_equal(dense(gaussian_band(5, 5, 0, reach=5), 0, 5), np.eye(5))
    found = dense(gaussian_band(5, 5, 0, reach=5, orders=3), 1, 5)
    values = np.array([3.0, 7, 1, 2, 10])
    mirrored = np.concatenate((values[:1], values, values[-1:]))
    np.testing.assert_allclose(found @ values, (mirrored[2:] - mirrored[:-2]) / 2, atol=1e-15)


@pytest.mark.parametrize("width", [1.0, 2.3, 7.0, 40.0])
def test_a_row_is_scipys_filter(width: float, rng: np.random.Generator) -> None:
    from scipy.ndimage import gaussian_filter1d

    values = rng.normal(size=31)
    band = gaussian_band(31, 31, width, reach=8, orders=2)
    for order in (0, 1):
        expected = gaussian_filter1d(values, width, order=order, truncate=8, mode="reflect")
        # scipy samples the derivative, which at width 1 is 1e-7 short of the ramp's.
        np.testing.assert_allclose(dense(band, order, 31) @ values, expected, atol=2e-7)


# --- samples -----------------------------------------------------------------------------------


def test_samples_know_their_places(rng: np.random.Generator) -> None:
    mask = np.zeros((7, 8, 9), bool)
    mask[2:6, 1:7, 3:8] = rng.random((4, 6, 5)) < 0.3
    samples = Samples.of_mask(mask)
    np.testing.assert_array_equal(samples.flat(mask.shape), np.flatnonzero(mask))
    np.testing.assert_array_equal(samples.indices()[:, ::-1], np.argwhere(mask))
    some = rng.random(len(samples)) < 0.5
    np.testing.assert_array_equal(samples.kept(some).flat(mask.shape), np.flatnonzero(mask)[some])
    part = Samples.of_mask(mask[2:5], (2, 0, 0))
    inside = mask.copy()
    inside[5:] = False
    np.testing.assert_array_equal(part.flat(mask.shape), np.flatnonzero(inside))
    assert len(Samples.of_mask(np.zeros((2, 3, 4), bool))) == 0


def test_growing_takes_the_26_neighbours(rng: np.random.Generator) -> None:
    from scipy.ndimage import binary_dilation

    mask = rng.random((6, 7, 8)) < 0.02
    expected = binary_dilation(mask, np.ones((3, 3, 3)))
    np.testing.assert_array_equal(grown(mask), expected)
    box = np.ones(mask.shape, bool)
    found = Samples.of_mask(box).beside(mask.ravel())
    np.testing.assert_array_equal(found, expected.ravel())


# --- sums --------------------------------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("width", [(1.0, 1.0, 1.0), (1.5, 2.9, 2.0), (1.2, 6.0, 3.5), (5, 11, 8)])
def test_gradients_turn_from_scipys_by_no_more_than_the_tolerance(
    width: tuple[float, ...], tolerance: float, clouds: np.ndarray
) -> None:
    from scipy.ndimage import gaussian_filter

    mask = np.zeros(clouds.shape, bool)
    mask[::2, :, 3:] = True
    found = derivatives(clouds, Samples.of_mask(mask), width, tolerance=tolerance)
    expected = np.stack(
        [gaussian_filter(clouds.astype(float), width, order=o, truncate=9)[mask] for o in GRADIENT]
    )
    # In units of a width, so that anisotropic ones have one threshold.
    scale = np.array(width[::-1])[:, None]
    found, expected = found * scale, expected * scale
    length = np.linalg.norm(expected, axis=0)
    binding = length >= BINDING * float(np.ptp(clouds.astype(float)))
    assert binding.mean() > 0.6  # corners are even
    cross = np.linalg.norm(np.cross(found, expected, axis=0), axis=0)
    angle = np.arctan2(cross, (found * expected).sum(axis=0))
    # scipy's own kernel is 1e-7 short of a ramp at width 1.
    assert angle[binding].max() <= max(tolerance, 3e-7)


def test_slabs_give_the_numbers_of_the_whole(
    clouds: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    samples = Samples.of_mask(clouds > 500)
    for width in ((1.5, 1.5, 1.5), (4, 4, 6)):
        whole = derivatives(clouds, samples, width)
        with monkeypatch.context() as small:
            small.setattr(grid_sums, "_BLOCK", 1000)
            np.testing.assert_array_equal(derivatives(clouds, samples, width), whole)


def test_a_piece_with_its_halo_is_all_it_takes(clouds: np.ndarray) -> None:
    samples = Samples.of_mask(clouds > 500)
    for width in (1.5, 3.0):
        whole = derivatives(clouds, samples, (width,) * 3)
        far = halo(clouds.shape, np.full((1, 3), width), 1e-4)
        low = [max(a - f, 0) for a, f in zip(samples.low, far, strict=True)]
        high = [b + f for b, f in zip(samples.high, far, strict=True)]
        part = clouds[low[0] : high[0], low[1] : high[1], low[2] : high[2]]
        whole_range = piece_of(clouds).range
        piece = Piece(part, tuple(low), clouds.shape, whole_range)
        found = np.empty((3, len(samples)), np.float32)
        GridSums(piece, samples, 1e-4).derivatives(np.full(3, width), GRADIENT, found)
        np.testing.assert_array_equal(found * piece.half_range, whole)
    assert far[0] < clouds.shape[0]  # else the halo is the whole volume, and nothing is shown


def test_an_axis_of_two_voxels_and_a_width_of_a_million() -> None:
    values = np.array([[[0.0, 1.0]], [[0.0, 3.0]]]).repeat(3, axis=1)
    samples = Samples.of_mask(np.ones(values.shape, bool))
    plain = derivatives(values, samples, (0, 0, 0))
    np.testing.assert_allclose(plain[0].reshape(values.shape)[:, :, 0], [[0.5] * 3, [1.5] * 3])
    wide = derivatives(values, samples, (1e6, 1e6, 1e6))
    # The slowest wave along two voxels at two axes' length: e^−20 of the range.
    assert np.abs(wide).max() < 1e-7


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.uint16, np.int64, np.float32, np.float64])
def test_types_agree(kind: type, clouds: np.ndarray) -> None:
    values = (clouds // 16 + 100).clip(0, 255)
    samples = Samples.of_mask(clouds > 500)
    expected = derivatives(values.astype(np.float64), samples, (2, 2, 2))
    found = derivatives(values.astype(kind), samples, (2, 2, 2))
    np.testing.assert_allclose(found, expected, atol=1e-5)  # of a range of 200
