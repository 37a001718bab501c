"""Tones of coloured light: as many as asked for, in one hue."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import Light, samples, scale_space, shading
from meshdepict.scene.material import Toon, soft_steps
from meshdepict.shading.tones import soft_tones

ORANGE = np.array([1.0, 0.5, 0.1])

# Hue is a ratio of channels, kept in single precision: its rounding is 6e-8, relative.
HUE = 1e-6


@pytest.fixture(scope="module")
def space():
    return scale_space(samples.golf_ball(1_500, dimples=12, depth=0.05), scales=2)


def shades(space):
    """Every way to draw tones: the toon method, and the material under two others."""
    light = Light((-1, 1, 1), color=ORANGE)
    material = Toon(bins=4, sharpness=6)
    yield shading.toon(space, light, bins=4)
    yield shading.light_warping(space, light, material=material)
    yield shading.radiance_scaling(space, light, material=material)


def test_grey_light_has_the_steps_it_always_had():
    grey = np.linspace(0, 2, 400)
    steps = soft_steps(grey, bins=5, sharpness=8)
    np.testing.assert_array_equal(soft_tones(grey, bins=5, sharpness=8), steps)
    colors = np.repeat(grey[:, None], 3, axis=1)
    np.testing.assert_allclose(
        soft_tones(colors, bins=5, sharpness=8), steps[:, None] * np.ones(3), rtol=1e-12
    )


def test_the_largest_channel_is_stepped_and_chromaticity_stays(rng):
    colors = rng.uniform(0, 1.5, (2_000, 3)) * rng.uniform(0, 1, (2_000, 1))
    found = soft_tones(colors, bins=6, sharpness=7)
    steps = soft_steps(colors.max(axis=1), bins=6, sharpness=7)
    np.testing.assert_allclose(found.max(axis=1), steps, atol=1e-12)
    shown = found.sum(axis=1) > 1e-3
    np.testing.assert_allclose(
        found[shown] / found[shown].sum(axis=1, keepdims=True),
        colors[shown] / colors[shown].sum(axis=1, keepdims=True),
        atol=1e-12,
    )


def test_black_stays_black_and_nothing_is_too_bright():
    dark = np.array([[0, 0, 0], [1e-40, 0, 0], [3, 2, 1], [1e30, 1e30, 0]], np.float32)
    found = soft_tones(dark, bins=8, sharpness=6)
    np.testing.assert_array_equal(found[0], 0)
    assert np.isfinite(found).all()
    assert found.min() >= 0
    np.testing.assert_allclose(found[2:], [[1, 2 / 3, 1 / 3], [1, 1, 0]], rtol=1e-6)


def test_every_tone_of_a_coloured_light_has_its_hue(space):
    for found in shades(space):
        lit = found[:, 0] > 1e-3
        assert np.ptp(found[lit, 0]) > 0.9  # from the darkest tone to the brightest
        np.testing.assert_allclose(
            found[lit] / found[lit, :1], np.broadcast_to(ORANGE, found[lit].shape), atol=HUE
        )


def test_a_light_too_bright_to_show_keeps_its_hue_as_well(space):
    light = Light((-1, 1, 1), color=3 * ORANGE)
    for found in (
        shading.toon(space, light),
        shading.light_warping(space, light, material="toon", exposure=2.0),
    ):
        lit = found[:, 0] > 1e-3
        assert (found[lit, 0] > 0.999).mean() > 0.5
        np.testing.assert_allclose(found[lit, 1], 0.5 * found[lit, 0], atol=HUE)


def test_the_red_of_a_white_and_of_an_orange_light_are_stepped_alike(space):
    white, orange = (
        shading.toon(space, Light((-1, 1, 1), color=color)) for color in ((1, 1, 1), ORANGE)
    )
    np.testing.assert_allclose(orange[:, 0], white, atol=1e-6)


def test_a_bake_shows_one_hue_to_what_levels_round(space):
    baked = md.bake(space, "toon", light=Light((-1, 1, 1), color=ORANGE))
    intensity = baked.intensity
    lit = intensity[:, 0] > 1e-3
    assert np.ptp(intensity[lit, 2] / intensity[lit, 0]) < HUE
