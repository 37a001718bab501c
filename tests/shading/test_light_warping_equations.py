"""Light Warping's equations: limits, inverse, Jacobian against the paper's and by integration."""

import numpy as np
import pytest

from meshdepict.shading.light_warping import jacobian, unwarp, warp, warp_scale

SCALES = [(1.0, 1.0), (3**0.5, 3**-0.5), (3**0.5, 3**0.5), (0.6, 0.9), (1.3, 0.7)]


def directions(rng, count):
    d = rng.normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def papers_warp(light, u, v):
    """§5 as printed: t = (1+l_z)² / ((1+l_z)² + …)."""
    x, y, z = np.moveaxis(light, -1, 0)
    t = (1 + z) ** 2 / ((1 + z) ** 2 + (u * x) ** 2 + (v * y) ** 2)
    return np.stack([2 * t * u * x / (1 + z), 2 * t * v * y / (1 + z), 2 * t - 1], axis=-1)


def papers_jacobian(light, u, v):
    x, y, z = np.moveaxis(light, -1, 0)
    below = u**2 * v**2 * (1 + z) ** 2 + v**2 * x**2 + u**2 * y**2
    return 4 * u**3 * v**3 * (1 + z) ** 2 / below**2


def test_scale_is_the_papers_and_exact_where_flat():
    curvature = np.linspace(-3, 3, 61)
    expected = np.tan(np.arctan(16.62 * curvature) / 6 + np.pi / 4)
    np.testing.assert_allclose(warp_scale(curvature, 16.62), expected, rtol=1e-14)
    assert warp_scale(0.0, 16.62) == 1.0
    assert warp_scale(0.3, 0.0) == 1.0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("magnitude", [1e30, -1e30, 1e308, 16.0])
def test_scale_is_bounded_and_its_reciprocal_is_the_opposite_curvature(dtype, magnitude):
    curvature = np.array([0, 1e-30, 1e-3, 1, 1e30, np.finfo(dtype).max], dtype)
    scale, opposite = warp_scale(curvature, magnitude), warp_scale(-curvature, magnitude)
    tight = 4 * np.finfo(dtype).eps
    assert scale.dtype == dtype
    assert (scale <= np.sqrt(3) * (1 + tight)).all()
    assert (scale >= (1 - tight) / np.sqrt(3)).all()
    np.testing.assert_allclose(scale * opposite, 1, rtol=tight)


@pytest.mark.parametrize(("u", "v"), SCALES)
def test_warp_is_the_papers_formula_and_unwarp_its_inverse(rng, u, v):
    light = directions(rng, 500)
    np.testing.assert_allclose(warp(light, u, v), papers_warp(light, u, v), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(warp(light, u, v), axis=1), 1, atol=1e-14)
    np.testing.assert_allclose(unwarp(warp(light, u, v), u, v), light, atol=1e-13)
    np.testing.assert_allclose(unwarp(light, u, v), warp(light, 1 / u, 1 / v), atol=1e-15)


@pytest.mark.parametrize(("u", "v"), SCALES)
def test_jacobian_is_the_papers_formula_and_keeps_the_sphere_whole(rng, u, v):
    light = directions(rng, 500)
    expected = papers_jacobian(light, u, v)
    np.testing.assert_allclose(jacobian(light, u, v), expected, rtol=1e-9)
    # ∫ J = 4π over the sphere; the midpoint rule in (z, azimuth) is exact to the step squared.
    z = (np.arange(2000) + 0.5) / 1000 - 1
    azimuth = (np.arange(256) + 0.5) * np.pi / 128
    s = np.sqrt(1 - z**2)[:, None]
    grid = np.stack(np.broadcast_arrays(s * np.cos(azimuth), s * np.sin(azimuth), z[:, None]), -1)
    assert jacobian(grid, u, v).mean() == pytest.approx(1, abs=1e-4)
    assert jacobian(grid, u, v).max() <= 9 * (1 + 1e-12)
    assert jacobian(grid, u, v).min() >= (1 - 1e-12) / 9


def test_jacobian_is_the_change_of_solid_angle(rng):
    u, v, step = 1.4, 0.65, 1e-5
    light = directions(rng, 50)
    first = np.cross(light, directions(rng, 50))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(light, first)

    def moved(tangent):
        ahead, behind = light + step * tangent, light - step * tangent
        ahead, behind = (d / np.linalg.norm(d, axis=1, keepdims=True) for d in (ahead, behind))
        return (unwarp(ahead, u, v) - unwarp(behind, u, v)) / (2 * step)

    area = np.linalg.norm(np.cross(moved(first), moved(second)), axis=1)
    np.testing.assert_allclose(jacobian(light, u, v), area, rtol=1e-7)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_poles(dtype):
    u, v = dtype(1.5), dtype(0.8)
    poles = np.array([[0, 0, 1], [0, 0, -1]], dtype)
    np.testing.assert_array_equal(warp(poles, u, v), poles)
    np.testing.assert_array_equal(unwarp(poles, u, v), poles)
    expected = [1 / (1.5 * 0.8), (1.5**2 + 0.8**2) / 2]
    np.testing.assert_allclose(jacobian(poles, u, v), expected, rtol=1e-6)


@pytest.mark.parametrize("tilt", [1e-3, 1e-6, 1e-12, 1e-30, 1e-200])
def test_near_the_far_pole_there_is_no_cancellation(tilt):
    u, v = 1.5, 0.8
    along_u, along_v = np.array([tilt, 0, -1.0]), np.array([0, tilt, -1.0])
    # There W⁻¹ scales the plane's inverse by 1/(1/λ) = λ along the azimuth.
    np.testing.assert_allclose(unwarp(along_u, u, v)[0], u * tilt, rtol=1e-5, atol=1e-140)
    np.testing.assert_allclose(unwarp(along_v, u, v)[1], v * tilt, rtol=1e-5, atol=1e-140)
    if tilt > 1e-100:  # beyond, squares vanish and the pole's mean is as good
        np.testing.assert_allclose(jacobian(along_u, u, v), u**3 / v, rtol=1e-4)


def test_single_precision_is_kept_and_agrees(rng):
    light = directions(rng, 500)
    u, v = rng.uniform(3**-0.5, 3**0.5, (2, 500))
    single = [x.astype(np.float32) for x in (light, u, v)]
    for function in (warp, unwarp, jacobian):
        assert function(*single).dtype == np.float32
        np.testing.assert_allclose(function(*single), function(light, u, v), rtol=2e-5, atol=2e-6)
