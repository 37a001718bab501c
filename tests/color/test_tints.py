"""Hypsometric tints: their tables, colours of heights, and the words for both."""

import numpy as np
import pytest

from meshdepict.color import colormap
from meshdepict.color.spans import parsed_span, span_text
from meshdepict.color.srgb import srgb_to_linear
from meshdepict.color.tints import TINTS, checked_tint, parsed_tint, tint_colors, tint_table
from meshdepict.errors import MeshdepictError


@pytest.mark.parametrize("name", TINTS)
def test_tints_are_pale_and_end_light(name):
    table = tint_table(name)
    assert table.shape == (256, 3)
    luminance = srgb_to_linear(table / 255) @ [0.2126, 0.7152, 0.0722]
    assert luminance.min() > 0.4  # shading shows through
    assert luminance.argmax() == 255  # summits
    assert luminance[-1] > 0.9
    steps = np.abs(np.diff(table.astype(int), axis=0)).max()
    assert steps <= 2  # no edges where there are none
    np.testing.assert_array_equal(tint_table(f"{name}_r"), table[::-1])
    assert not table.flags.writeable


def test_a_colour_map_is_a_tint_as_well():
    np.testing.assert_array_equal(tint_table("sepia"), colormap("sepia"))
    np.testing.assert_array_equal(tint_table("gooch_r"), colormap("gooch")[::-1])


def test_the_lowest_and_the_highest_have_the_ends():
    heights = np.array([120.0, 500.0, 310.0, 119.0])
    found = tint_colors(heights, "earth")
    table = tint_table("earth")
    np.testing.assert_array_equal(found[[3, 1]], table[[0, -1]])
    share = (310 - 119) / (500 - 119)
    np.testing.assert_array_equal(found[2], table[round(share * 255)])


def test_heights_beyond_a_span_have_its_ends():
    found = tint_colors([-5.0, 0.0, 50.0, 100.0, 4000.0], "swiss", (0, 100))
    table = tint_table("swiss")
    np.testing.assert_array_equal(found, table[[0, 0, 128, 255, 255]])
    falling = tint_colors([0.0, 100.0], "swiss", (100, 0))
    np.testing.assert_array_equal(falling, table[[255, 0]])


def test_level_ground_has_the_middle():
    found = tint_colors(np.full(4, 7.5), "earth")
    np.testing.assert_array_equal(found, np.repeat(tint_table("earth")[128:129], 4, axis=0))


def test_a_tint_in_words_comes_back_to_the_last_digit():
    span = (-1 / 3, 1e3 / 7)
    text = checked_tint(("earth", *span))
    assert parsed_tint(text) == ("earth", span)
    assert checked_tint(("earth", 0, 3000)) == "earth:0..3000"
    assert checked_tint("desert") == "desert"
    assert parsed_tint("sepia_r:100..-20.5") == ("sepia_r", (100.0, -20.5))
    assert parsed_span(span_text((0.1, 1e-7))) == (0.1, 1e-7)


def test_wrong_input_is_refused():
    with pytest.raises(MeshdepictError, match="no tint is called 'erth'; did you mean 'earth'"):
        tint_table("erth")
    with pytest.raises(MeshdepictError, match="tints of their own are earth, swiss, desert"):
        tint_table("sepi")
    for wrong in ("earth:3", "earth:1..1", "earth:", "earth:a..b", "earth:1..nan", "earth:1..2..3"):
        with pytest.raises(MeshdepictError, match=r"^tint='earth:.* is not two numbers that diff"):
            checked_tint(wrong)
    for wrong in (5, ("earth",), ("earth", 1), ("earth", 1, "x"), (1, 2, 3), None):
        with pytest.raises(MeshdepictError, match="neither a name nor a name with the heights"):
            checked_tint(wrong)
    with pytest.raises(MeshdepictError, match=r"'1..1' is not two numbers"):
        checked_tint(("earth", 1, 1))
    with pytest.raises(MeshdepictError, match="is given by its name, not as None"):
        tint_table(None)
