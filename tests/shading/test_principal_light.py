"""Principal-direction light of Exaggerated Shading: eqs. 6–9 and their limits."""

import numpy as np
import pytest
from conftest import rotation

from meshdepict import samples, scale_space
from meshdepict.curvature import principal
from meshdepict.errors import MeshdepictError
from meshdepict.shading import exaggerated
from meshdepict.shading.attention import remoteness
from meshdepict.shading.bands import SINGULAR_LIGHT, band_weights
from meshdepict.shading.exaggerated import soft_toon
from meshdepict.shading.principal_light import principal_light
from meshdepict.shapes.mesh import Mesh

LIGHT = np.array([-1.0, 2.0, 3.0]) / 14**0.5


@pytest.fixture(scope="module")
def space(ball):
    return scale_space(ball, scales=4)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def written_out(space, strength, focus=None, radius=None):
    """Equations 3, 4, 5 and 9 in double precision, band by band."""
    normals = space.normals.astype(float)
    k = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
    total = k[-1] * (normals[-1] @ LIGHT)
    for i in range(len(k) - 1):
        width = space.widths[i] or space.widths[1] / space.ratio
        found = space.curvature(i)
        base = normals[i + 1]
        projected = LIGHT - base * (base @ LIGHT)[:, None]
        bend = strength * width**2 * (found.k1**2 - found.k2**2)
        bent = principal_light(projected, base, found.d1, bend)
        length = np.sqrt((bent**2).sum(axis=1) + SINGULAR_LIGHT**2)
        share = k[i]
        if focus is not None:
            share = share * np.exp(-remoteness(space, focus, radius).astype(float) / 2**i)
        total += share * soft_toon((normals[i] * bent).sum(axis=1) / length, 15.0)
    return np.clip(0.5 + 0.5 * total, 0, 1)


@pytest.mark.parametrize("strength", [0.1, 3.0, 1e3])
def test_the_kernel_is_the_equation(space, strength):
    found = exaggerated(space, LIGHT, exaggeration=15, principal_strength=strength)
    # Roundings of single precision, times the exaggeration.
    np.testing.assert_allclose(found, written_out(space, strength), atol=1e-4)


def test_attention_fades_bent_bands_too(space):
    focus, radius = (0.0, 0.0, 1.0), 0.4
    found = exaggerated(
        space, LIGHT, exaggeration=15, principal_strength=3.0, focus=focus, radius=radius
    )
    np.testing.assert_allclose(found, written_out(space, 3.0, focus, radius), atol=1e-4)


def test_without_strength_no_curvature_is_computed(ball, monkeypatch):
    calls, original = [], principal._from_normals
    monkeypatch.setattr(
        principal, "_from_normals", lambda *given: calls.append(1) or original(*given)
    )
    space = scale_space(ball, scales=4)
    exaggerated(space, LIGHT)
    exaggerated(space, LIGHT, principal_strength=0)
    assert calls == []
    for light in (LIGHT, -LIGHT):
        exaggerated(space, light, principal_strength=1)
    assert len(calls) == 4  # scales 0 … b − 1, each once


def test_a_vanishing_strength_is_the_plain_light(space):
    plain = exaggerated(space, LIGHT)
    np.testing.assert_allclose(exaggerated(space, LIGHT, principal_strength=1e-6), plain, atol=1e-4)
    assert np.abs(exaggerated(space, LIGHT, principal_strength=1e4) - plain).max() > 0.05


def test_where_no_direction_is_larger_nothing_changes():
    # On a sphere every direction bends alike; with one scale only scale 0's curvature enters.
    space = scale_space(samples.sphere(2_500), scales=1)
    plain = exaggerated(space, LIGHT)
    np.testing.assert_allclose(exaggerated(space, LIGHT, principal_strength=100), plain, atol=1e-3)


def test_any_strength_is_finite(space):
    for strength in (1e-6, 1.0, 1e6):
        found = exaggerated(space, LIGHT, principal_strength=strength)
        assert np.isfinite(found).all()
        assert found.min() >= 0
        assert found.max() <= 1


@pytest.mark.parametrize("factor", [1e-140, 1e140])
def test_units_do_not_matter(factor):
    ball = samples.golf_ball(600)
    plain = exaggerated(scale_space(ball, scales=3, tolerance=1e-7), LIGHT, principal_strength=3)
    scaled = scale_space(Mesh(ball.vertices * factor, ball.faces), scales=3, tolerance=1e-7)
    found = exaggerated(scaled, LIGHT, principal_strength=3)
    np.testing.assert_allclose(found, plain, atol=1 / 255)


def test_turning_mesh_and_light_changes_nothing(rng):
    # Relief under a light that doesn't stand along any smoothed normal.
    sheet, turn = samples.radiating_ridges(2_500), rotation(rng)
    light = unit(np.array([1.0, 0.5, 0.5]))
    plain = exaggerated(scale_space(sheet, scales=3, tolerance=1e-7), light, principal_strength=3)
    turned = scale_space(Mesh(sheet.vertices @ turn.T, sheet.faces), scales=3, tolerance=1e-7)
    found = exaggerated(turned, turn @ light, principal_strength=3)
    np.testing.assert_allclose(found, plain, atol=1 / 255)


def frames(rng, count=500):
    normals = unit(rng.normal(size=(count, 3)))
    d1 = unit(np.cross(normals, rng.normal(size=(count, 3))))
    light = LIGHT - normals * (normals @ LIGHT)[:, None]
    return normals, d1, light


def test_a_direction_has_no_sense(rng):
    normals, d1, light = frames(rng)
    bend = rng.uniform(0, 10, len(d1))
    np.testing.assert_allclose(
        principal_light(light, normals, d1, bend), principal_light(light, normals, -d1, bend)
    )


def test_it_is_continuous_at_umbilics(rng):
    # There d1 jumps by 90°, and what it contributes is no longer than bend times the light.
    normals, d1, light = frames(rng)
    d2 = np.cross(normals, d1)
    for bend in (1e-2, 1e-6):
        one, other = (principal_light(light, normals, d, bend) for d in (d1, d2))
        assert np.linalg.norm(one - other, axis=1).max() <= bend * 1.0001
    np.testing.assert_array_equal(principal_light(light, normals, d1, 0.0), light)


def test_a_strong_one_lies_along_the_direction_and_a_perpendicular_one_stays(rng):
    normals, d1, light = frames(rng)
    bent = unit(principal_light(light, normals, d1, 1e12))
    along = np.abs((bent * d1).sum(axis=1))
    clear = np.abs((light * d1).sum(axis=1)) > 0.01
    np.testing.assert_allclose(along[clear], 1, atol=1e-6)
    across = np.cross(normals, unit(light))
    np.testing.assert_allclose(principal_light(light, normals, across, 5.0), light, atol=1e-12)


def test_a_direction_along_the_coarser_normal_is_left_out(rng):
    normals, _, light = frames(rng)
    np.testing.assert_array_equal(principal_light(light, normals, normals, 5.0), light)
    # A direction that isn't tangent is projected first, and the light stays in the plane.
    bent = principal_light(light, normals, unit(rng.normal(size=normals.shape)), 5.0)
    np.testing.assert_allclose((bent * normals).sum(axis=1), 0, atol=1e-12)


def test_contrast_is_largest_along_the_first_direction(rng):
    # Eqs. 6 and 7, which eq. 9 rests on: ‖II δ‖² = 2 H κ_δ − K.
    found = principal.principal_curvatures(samples.golf_ball(600))
    angle = rng.uniform(0, np.pi, len(found.k1))
    c, s = np.cos(angle), np.sin(angle)
    contrast = np.hypot(found.k1 * c, found.k2 * s)
    normal_curvature = found.k1 * c**2 + found.k2 * s**2
    squared = 2 * found.mean * normal_curvature - found.gaussian
    np.testing.assert_allclose(contrast**2, squared, atol=1e-9)
    assert (contrast <= np.abs(found.k1) + 1e-12).all()


@pytest.mark.parametrize("strength", [-1, float("nan"), "strong"])
def test_a_strength_out_of_range(space, strength):
    with pytest.raises(
        MeshdepictError, match=r"exaggerated: principal_strength=.* is not a number"
    ):
        exaggerated(space, LIGHT, principal_strength=strength)
