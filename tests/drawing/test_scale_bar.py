"""The scale bar: a length of 1, 2 or 5 times a power of ten, and letters for every unit."""

import math

import numpy as np
import pytest

from meshdepict.drawing.letters import font
from meshdepict.drawing.scale_bar import scale_bar


@pytest.mark.parametrize("extent", [1e-9, 0.0334, 0.9999, 1.0, 3.3333, 7, 66.6, 123456, 1e12])
@pytest.mark.parametrize("share", [0.3, 0.2, 0.5])
def test_the_longest_round_length_that_fits(extent, share):
    bar = scale_bar(extent, share=share)
    digits = bar.length / 10 ** math.floor(math.log10(bar.length) + 1e-9)
    assert min(abs(digits - round_one) for round_one in (1, 2, 5)) < 1e-9
    assert bar.length <= share * extent * 1.000001
    following = {1: 2, 2: 2.5, 5: 2}[round(digits)]
    assert bar.length * following > share * extent


@pytest.mark.parametrize(
    ("extent", "unit", "label", "parts"),
    [
        (100, "mm", "20 mm", 4),
        (100 / 3, "mm", "10 mm", 5),  # exactly the share: not lost to rounding
        (0.2, "m", "0.05 m", 5),
        (4, "", "1 unit", 5),
        (7, "", "2 units", 4),
        (20_000, "µm", "5,000 µm", 5),
        (1e-6, "m", "2e-07 m", 4),
    ],
)
def test_labels(extent, unit, label, parts):
    bar = scale_bar(extent, unit)
    assert (bar.label, bar.parts) == (label, parts)


@pytest.mark.parametrize("letter", ["µ", "μ", "Å", "м", "′"])
def test_letters_beyond_ascii_are_there(letter):
    """The box that stands for a missing letter is the same for all of them."""
    found = font(letter, 40)
    missing = np.asarray(found.getmask("\U0010fffd"))
    assert not np.array_equal(np.asarray(found.getmask(letter)), missing)
