"""Blending layers: what each mode does at its limits, and against a readable twin."""

import numpy as np
import pytest

from meshdepict.color.blending import MODES, blended, checked_stretch, flattened, stretched
from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.errors import MeshdepictError

LEVELS = np.linspace(0, 1, 12).astype(np.float32)
A, B = (grid.ravel() for grid in np.meshgrid(LEVELS, LEVELS))
LUMA = np.array([0.30, 0.59, 0.11])
every_mode = pytest.mark.parametrize("mode", MODES)


@pytest.fixture(scope="module")
def colours():
    return np.random.default_rng(5).random((2, 4000, 3)).astype(np.float32)


def one_by_one(a, b, mode):
    """The equations, a number at a time."""
    if mode == "normal":
        return a
    if mode == "multiply":
        return a * b
    if mode == "screen":
        return 1 - (1 - a) * (1 - b)
    if mode == "overlay":
        return 1 - (1 - 2 * (b - 0.5)) * (1 - a) if b > 0.5 else 2 * b * a
    if mode == "soft_light":
        if a < 0.5:
            return 2 * b * a + b**2 * (1 - 2 * a)
        return 2 * b * (1 - a) + np.sqrt(b) * (2 * a - 1)
    if mode == "multiply_linear":
        return linear_to_srgb(float(srgb_to_linear(a)) * float(srgb_to_linear(b)))
    return a  # the luminosity of one grey upon another


def clipped_colour(colour):
    """W3C's ClipColor."""
    luma, least, most = LUMA @ colour, colour.min(), colour.max()
    if least < 0:
        colour = luma + (colour - luma) * luma / (luma - least)
    if most > 1:
        colour = luma + (colour - luma) * (1 - luma) / (most - luma)
    return colour


@every_mode
@pytest.mark.parametrize("opacity", [0.0, 0.25, 1.0])
def test_grey_layers_follow_the_equations(mode, opacity):
    found = blended(A, B, mode, opacity=opacity)
    expected = np.array([one_by_one(float(a), float(b), mode) for a, b in zip(A, B, strict=True)])
    if mode == "multiply_linear":
        light = 1 + opacity * (srgb_to_linear(A.astype(float)) - 1)
        expected = linear_to_srgb(light * srgb_to_linear(B.astype(float)))
    else:
        expected = opacity * expected + (1 - opacity) * B
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, atol=1e-6)  # single precision


@every_mode
def test_every_result_is_in_range_and_nothing_is_changed(mode, colours):
    for upper, lower in (colours, (A, B), (A[:50], colours[1][:50]), (colours[0][:50], B[:50])):
        kept = upper.copy(), lower.copy()
        for opacity in (0, 0.3, 1):
            found = blended(upper, lower, mode, opacity=opacity)
            luma = mode == "luminosity"
            assert found.ndim == (lower.ndim if luma else max(upper.ndim, lower.ndim))
            assert found.min() >= 0
            assert found.max() <= 1
        np.testing.assert_array_equal(upper, kept[0])
        np.testing.assert_array_equal(lower, kept[1])


@every_mode
def test_no_opacity_leaves_what_lies_below(mode, colours):
    upper, lower = colours
    # multiply_linear goes to linear light and back, in single precision
    np.testing.assert_allclose(blended(upper, lower, mode, opacity=0), lower, atol=2e-6)


@pytest.mark.parametrize(
    ("mode", "level"),
    [("multiply", 1.0), ("multiply_linear", 1.0), ("screen", 0.0), ("overlay", 0.5),
     ("soft_light", 0.5)],
)  # fmt: skip
def test_each_mode_has_a_grey_that_changes_nothing(mode, level, colours):
    lower = colours[1]
    upper = np.full(len(lower), level, np.float32)
    np.testing.assert_allclose(blended(upper, lower, mode), lower, atol=2e-6)


@every_mode
def test_opacity_lies_between_all_and_nothing(mode, colours):
    upper, lower = colours
    whole, half = (blended(upper, lower, mode, opacity=share) for share in (1, 0.5))
    between = (whole + lower) / 2
    if mode == "multiply_linear":
        between = linear_to_srgb((srgb_to_linear(whole) + srgb_to_linear(lower)) / 2)
    np.testing.assert_allclose(half, between, atol=2e-6)


@pytest.mark.parametrize("mode", ["multiply", "screen", "multiply_linear"])
def test_some_modes_ask_for_no_order(mode, colours):
    one, other = colours
    np.testing.assert_allclose(blended(one, other, mode), blended(other, one, mode), atol=2e-6)


def test_overlay_is_hard_light_the_other_way_round(colours):
    one, other = colours
    hard = np.where(one > 0.5, 1 - 2 * (1 - one) * (1 - other), 2 * one * other)
    np.testing.assert_allclose(blended(other, one, "overlay"), hard, atol=1e-6)


def test_luminosity_takes_the_luma_and_keeps_the_hue(colours):
    upper, lower = colours
    found = blended(upper, lower, "luminosity")
    np.testing.assert_allclose(found @ LUMA, upper @ LUMA, atol=2e-6)
    expected = [
        clipped_colour(b + LUMA @ a - LUMA @ b)
        for a, b in zip(upper.astype(float), lower.astype(float), strict=True)
    ]
    np.testing.assert_allclose(found, expected, atol=2e-6)
    grey = np.repeat(B[:, None], 3, axis=1)
    np.testing.assert_allclose(
        blended(A, grey, "luminosity"), np.repeat(A[:, None], 3, axis=1), atol=1e-6
    )


def test_grey_and_colour_meet_as_colours(colours):
    grey, colour = B, colours[0][: len(B)]
    for mode in MODES:
        three = np.repeat(grey[:, None], 3, axis=1)
        upper, same = (blended(layer, colour, mode) for layer in (grey, three))
        np.testing.assert_allclose(upper, same, atol=1e-6)
        found = blended(colour, grey, mode)
        if mode == "luminosity":  # all that it takes is a grey value
            np.testing.assert_allclose(found, colour @ LUMA, atol=1e-6)
        else:
            np.testing.assert_array_equal(found, blended(colour, three, mode))


def test_layers_are_laid_one_upon_the_other(colours):
    lowest, middle = colours
    top = lowest[::-1]
    found = flattened([(lowest, "overlay", 0.1), (middle, "screen", 0.5), (top, "multiply", 1)])
    by_hand = blended(top, blended(middle, lowest, "screen", opacity=0.5), "multiply")
    np.testing.assert_array_equal(found, by_hand)
    # The lowest has nothing to act upon.
    np.testing.assert_array_equal(flattened([(lowest, "multiply", 0.2)]), lowest)


def test_a_stretch_puts_its_ends_at_black_and_white():
    values = np.array([0.0, 0.7, 0.85, 1.0, 1.2])
    np.testing.assert_allclose(stretched(values, 0.7, 1), [0, 0, 0.5, 1, 1], atol=1e-7)
    np.testing.assert_allclose(stretched(values, 1, 0.7), [1, 1, 0.5, 0, 0], atol=1e-7)
    np.testing.assert_allclose(stretched(B, 0, 1), B, atol=0)


def test_odd_values_count_as_the_nearest():
    odd = np.array([np.nan, -1, 2, np.inf])
    np.testing.assert_array_equal(blended(odd, np.ones(4), "multiply"), [0, 0, 1, 1])


def test_wrong_input_is_refused():
    with pytest.raises(MeshdepictError, match="no blend mode is called 'multply'; did you mean 'm"):
        blended(A, B, "multply")
    with pytest.raises(MeshdepictError, match="no blend mode is called None"):
        blended(A, B, None)
    for opacity in (1.5, -0.1, np.nan, "much", None, True):
        with pytest.raises(MeshdepictError, match="is not a number from 0 to 1"):
            blended(A, B, "screen", opacity=opacity)
    with pytest.raises(MeshdepictError, match="have 3 and 144"):
        blended(A[:3], B)
    for values in (np.ones((3, 2)), 0.5, ["a"]):
        with pytest.raises(MeshdepictError, match=r"shape \(n,\) or \(n, 3\)"):
            blended(values, np.ones(3))
    with pytest.raises(MeshdepictError, match="no layers"):
        flattened([])
    for layer in ((B, "dim", 1), (B, "normal", 7)):
        with pytest.raises(MeshdepictError):
            flattened([layer])
    for stretch in (None, (1,), (0, 1, 2), (0.3, 0.3), ("a", 1), (0, np.nan), 5):
        with pytest.raises(MeshdepictError, match="is not two numbers that differ"):
            checked_stretch(stretch)
