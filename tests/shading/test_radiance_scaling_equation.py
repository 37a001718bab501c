"""Radiance Scaling's function: the properties that the paper and its text ask for."""

import numpy as np
import pytest

from meshdepict.shading.radiance_scaling import scaling

CURVATURE = np.linspace(-1, 1, 41)
ALPHAS = [0.01, 0.2, 0.5, 0.8, 0.99]


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("gamma", [0.5, 4.0, 20.0])
def test_properties(alpha, gamma):
    k, d = np.meshgrid(CURVATURE, np.linspace(0, 1, 33))
    s = scaling(k, d, invariant=alpha, magnitude=gamma)
    np.testing.assert_allclose(scaling(k, alpha, invariant=alpha, magnitude=gamma), 1, rtol=1e-12)
    np.testing.assert_array_equal(scaling(0, d, invariant=alpha, magnitude=gamma), 1)
    np.testing.assert_allclose(scaling(k, 1, invariant=alpha, magnitude=gamma), np.exp(gamma * k))
    np.testing.assert_allclose(scaling(k, 0, invariant=alpha, magnitude=gamma), np.exp(-gamma * k))
    np.testing.assert_allclose(s * scaling(-k, d, invariant=alpha, magnitude=gamma), 1, rtol=1e-12)
    mirrored = scaling(k, 1 - d, invariant=alpha, magnitude=gamma)
    opposite = scaling(k, d, invariant=1 - alpha, magnitude=gamma)
    np.testing.assert_allclose(mirrored * opposite, 1, rtol=1e-9)
    steps = np.diff(s, axis=0)
    assert (steps[:, CURVATURE > 0] > 0).all()
    assert (steps[:, CURVATURE < 0] < 0).all()


@pytest.mark.parametrize("alpha", ALPHAS)
def test_it_is_the_papers_formula_with_curvature_positive_where_concave(alpha):
    gamma, (k, d) = 3.0, np.meshgrid(CURVATURE, np.linspace(0, 1, 17))
    e = np.exp(-gamma * k)
    paper = (alpha * e + d * (1 - alpha * (1 + e))) / (alpha + d * (e - alpha * (1 + e)))
    np.testing.assert_allclose(scaling(k, d, invariant=alpha, magnitude=gamma), paper, rtol=1e-9)


def test_bright_convexities_are_brightened_and_bright_concavities_darkened():
    assert scaling(0.5, 0.9) > 1 > scaling(-0.5, 0.9)
    assert scaling(0.5, 0.1) < 1 < scaling(-0.5, 0.1)


def test_reflectance_is_clamped():
    np.testing.assert_array_equal(scaling(0.3, [-1.0, 2.0]), scaling(0.3, [0.0, 1.0]))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("alpha", [0.0, 1e-30, 0.5, 1 - 1e-12, 1.0])
@pytest.mark.parametrize("gamma", [0.0, 1e4, 1e300])
def test_finite_and_positive_for_all_input(dtype, alpha, gamma):
    k, d = np.meshgrid(CURVATURE.astype(dtype), np.linspace(0, 1, 33, dtype=dtype))
    s = scaling(k, d, invariant=alpha, magnitude=gamma)
    assert s.dtype == dtype
    assert np.isfinite(s).all()
    assert (s > 0).all()
    assert np.isfinite(d * s).all()


def test_single_precision_agrees_within_its_own_rounding():
    k, d = np.meshgrid(CURVATURE, np.linspace(0, 1, 33))
    single = scaling(k.astype(np.float32), d.astype(np.float32))
    # Half a unit in the last place of γκ ≤ 4 is 2.4e-7 in the exponent; a dozen roundings more.
    np.testing.assert_allclose(single, scaling(k, d), rtol=5e-6)
