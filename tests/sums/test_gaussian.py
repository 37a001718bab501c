import numpy as np
import pytest

from meshdepict import samples, threads
from meshdepict.sums import direct_sums as direct
from meshdepict.sums import gaussian
from meshdepict.sums import spectral_sums as spectral
from meshdepict.sums.gaussian import gaussian_sums
from meshdepict.sums.grid_sums import PointGrid
from meshdepict.sums.ordered_points import OrderedPoints

WIDTHS = [0.01, 0.05, 0.2, 1.0, 10.0]


def surface(count=1500):
    mesh = samples.torus(count)
    return mesh.vertices - mesh.vertices.mean(axis=0)


def channels(points, rng, count=4):
    mass = rng.uniform(0.2, 1, len(points))
    return np.vstack([mass, mass * rng.uniform(-1, 1, (count - 1, len(points)))])


@pytest.fixture(params=["direct", "grid", "spectral", "chosen"])
def way(request, monkeypatch):
    """Run a test with each way forced, and with the choice left to the estimated cost."""
    if request.param in ("direct", "spectral"):
        monkeypatch.setattr(gaussian.grid, "rule_for", lambda *a: None)
    if request.param == "direct":
        monkeypatch.setattr(gaussian.spectral, "least_cost", lambda *a: np.inf)
    if request.param in ("grid", "spectral"):
        monkeypatch.setattr(gaussian, "_pair_cost", lambda *a: np.inf)
    return request.param


@pytest.mark.parametrize("error", [1e-1, 1e-3, 1e-5, 1e-8])
@pytest.mark.parametrize("width", WIDTHS)
def test_sums_are_within_the_error_asked_for(way, width, error, rng):
    if way == "spectral" and width < 0.2:
        pytest.skip("nobody would: transforms of a thousand widths' extent")
    points = surface()
    c = channels(points, rng)
    exact = direct.exact_sums(points, c, width)
    sums = gaussian_sums(points, c, width, error=error)
    assert np.max(np.abs(sums - exact) / exact[0]) <= error


@pytest.mark.parametrize("count", [1, 2, 4, 5, 7, 10])
def test_any_number_of_channels(way, count, rng):
    points = surface(500)
    c = channels(points, rng, count)
    exact = direct.exact_sums(points, c, 0.3)
    sums = gaussian_sums(points, c, 0.3, error=1e-6)
    assert sums.shape == (count, len(points))
    assert np.max(np.abs(sums - exact) / exact[0]) <= 1e-6


def test_a_small_part_beside_a_large_one_is_as_accurate(way, rng):
    """Errors are relative to the mass at the place, not to the largest of the scene."""
    large, small = surface(3000), surface(300) * 1e-3 + np.array([4.0, 0, 0])
    points = np.vstack([large, small])
    c = channels(points, rng)
    c[:, len(large) :] *= 1e-6
    exact = direct.exact_sums(points, c, 0.3)
    sums = gaussian_sums(points, c, 0.3, error=1e-4)
    assert np.max(np.abs(sums - exact) / exact[0]) <= 1e-4


def test_a_point_off_the_surface_hears_what_reaches_it(way, rng):
    points = np.vstack([surface(800), [[0, 0, 3.0]], [[0, 0, 9.0]]])
    c = channels(points, rng)
    c[:, -2:] = 0  # no mass of its own: an unreferenced vertex
    exact = direct.exact_sums(points, c, 0.25)
    assert 0 < exact[0, -1] < 1e-200
    sums = gaussian_sums(points, c, 0.25, error=1e-4)
    assert np.max(np.abs(sums - exact) / exact[0]) <= 1e-4


def test_beyond_all_numbers_the_sum_is_zero(rng):
    points = np.vstack([surface(300), [[0, 0, 500.0]]])
    c = channels(points, rng)
    c[:, -1] = 0
    assert not gaussian_sums(points, c, 0.1, error=1e-3)[:, -1].any()


def test_targets_alone_are_computed(way, rng):
    points = surface()
    c = channels(points, rng)
    targets = rng.random(len(points)) < 0.1
    exact = direct.exact_sums(points, c, 0.2)
    sums = gaussian_sums(points, c, 0.2, error=1e-5, targets=targets)
    assert np.max(np.abs(sums - exact)[:, targets] / exact[0, targets]) <= 1e-5
    assert not sums[:, ~targets].any()


@pytest.mark.slow
def test_tiles_agree_with_neighbours(monkeypatch, rng):
    points = surface(5_000).T / 0.012
    c = channels(points.T, rng)
    monkeypatch.setattr(spectral, "_FFT_SECONDS", 1e-7)  # dear transforms: more tiles
    tiles, _ = spectral.plan_tiles(points, 1e-5, 2)
    assert len(tiles) > 4
    assert sorted(np.concatenate([t.targets for t in tiles])) == list(range(points.shape[1]))
    tiled = spectral.spectral_sums(points, c, 1e-5, tiles)
    summed = direct.PointGroups(OrderedPoints(points.T, c)).sums(1.0, 8.0, np.float64)
    assert np.max(np.abs(tiled - summed)) <= 1e-5 * summed[0].max()


def test_tiles_for_no_targets_at_all():
    points = surface(500).T
    assert spectral.plan_tiles(points, 1e-4, 2, np.zeros(points.shape[1], bool)) == ([], 0.0)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_the_compiled_gaussian_is_the_gaussian(kind, rng):
    """One source of mass one: the sums are the Gaussian itself, far into its tail."""
    points = np.zeros((400, 3))
    points[:, 0] = np.linspace(0, 14 if kind == np.float64 else 8, 400)
    c = np.zeros((1, 400))
    c[0, 0] = 1
    sums = direct.PointGroups(OrderedPoints(points, c)).sums(1.0, 20.0, kind)[0]
    tolerance = 1e-11 if kind == np.float64 else 1e-4  # t itself is rounded: relative error t·eps
    np.testing.assert_allclose(sums, np.exp(-0.5 * points[:, 0] ** 2), rtol=tolerance)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_neighbours_are_the_same_bits_on_any_number_of_threads(kind, rng):
    points = surface(5000)
    c = channels(points, rng, 9)
    found = []
    for count in (1, 2, 5):
        threads.limit(count)
        found.append(direct.PointGroups(OrderedPoints(points, c)).sums(0.05, 5.0, kind))
    threads.limit(None)
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


def test_neighbours_far_from_all_others_are_found(rng):
    """And as accurate: sixteen together may lie on two sides of a gap."""
    points = np.vstack([surface(300) + np.array([1e3 * k, 0, 0]) for k in range(7)])
    c = channels(points, rng)
    exact = direct.exact_sums(points, c, 0.2)
    sums = direct.PointGroups(OrderedPoints(points, c)).sums(0.2, 7.0, np.float32)
    assert np.max(np.abs(sums - exact) / exact[0]) <= 1e-5


def test_all_points_at_one_place(rng):
    points = np.zeros((50, 3))
    c = channels(points, rng)
    sums = gaussian_sums(points, c, 1e-3, error=1e-5)
    np.testing.assert_allclose(sums, np.repeat(c.sum(axis=1)[:, None], 50, axis=1), atol=1e-4)


def test_the_work_is_reported(way, rng):
    points = surface()
    shares = []
    gaussian_sums(points, channels(points, rng), 0.2, error=1e-4, done=shares.append)
    assert sum(shares) == pytest.approx(1)


def test_the_estimated_cost_and_the_error_choose_the_way(monkeypatch, rng):
    """A call count, not a timing."""
    calls = []
    for module, name in (
        (spectral, "spectral_sums"), (direct.PointGroups, "sums"), (PointGrid, "sums"),
    ):  # fmt: skip
        original = getattr(module, name)
        monkeypatch.setattr(
            module,
            name,
            lambda *a, _n=module.__name__, _f=original, **k: calls.append(_n) or _f(*a, **k),
        )
    points = surface(20_000)
    c = channels(points, rng, 10)
    gaussian_sums(points, c, 0.02, error=1e-4)
    assert set(calls) == {"PointGroups"}
    calls.clear()
    gaussian_sums(points, c, 1.0, error=1e-4)
    assert set(calls) == {"PointGrid"}
    calls.clear()
    gaussian_sums(points, c, 1.0, error=1e-7)
    assert set(calls) == {spectral.__name__}
