"""Scales on paper: 1:2 of millimetres at 254 dots per inch is five pixels a unit."""

import pytest

from meshdepict import MeshdepictError
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.paper_scale import paper_scale, pixels_at

PAGE = Figure(size="A4", dpi=254)


@pytest.mark.parametrize(
    ("scale", "unit", "pixels"),
    [("1:2", "mm", 5), ("2:1", "mm", 20), ("1/4", "cm", 25), ("1 : 100", "m", 100),
     ("1:2.5", "mm", 4), ("1:1", "in", 254)],
)  # fmt: skip
def test_pixels_of_a_scale_and_back(scale, unit, pixels):
    assert pixels_at(scale, PAGE, unit) == pytest.approx(pixels, rel=1e-12)
    text = scale.replace("/", ":").replace(" ", "")
    assert paper_scale(PAGE, unit).text(pixels_at(scale, PAGE, unit)) == text


@pytest.mark.parametrize("scale", ["half", "1:0", "0:1", "1:-2", "1:2:3", "", "50%"])
def test_other_texts_are_refused(scale):
    with pytest.raises(MeshdepictError, match="is not a scale on paper such as 1:2 or 2:1"):
        pixels_at(scale, PAGE, "mm")


def test_a_scale_needs_unit_and_paper():
    with pytest.raises(MeshdepictError, match="needs the unit of the coordinates"):
        pixels_at("1:2", PAGE, "")
    with pytest.raises(MeshdepictError, match="needs a size on paper"):
        pixels_at("1:2", Figure(size=(100, 100)), "mm")
    assert paper_scale(PAGE, "voxels") is None
    assert paper_scale(Figure(size=(100, 100)), "mm") is None


@pytest.mark.parametrize("pixels", [0.01, 0.0999, 1, 3.97, 4.0, 9.99, 10, 10.04, 27.3, 1234.5])
def test_rounded_scales_are_a_little_smaller_and_have_two_digits(pixels):
    paper = paper_scale(PAGE, "mm")
    rounded = paper.rounded(pixels)
    assert pixels * 0.9 < rounded <= pixels * (1 + 1e-9)
    first, last = paper.text(rounded).split(":")
    assert len((first if last == "1" else last).replace(".", "").strip("0")) <= 2
    assert paper.rounded(rounded) == pytest.approx(rounded)


@pytest.mark.parametrize(("pixels", "text"), [(4.9, "1:3"), (5, "1:2"), (10, "1:1"), (39, "3:1")])
def test_the_scale_that_fits(pixels, text):
    assert paper_scale(PAGE, "mm").fitting(pixels) == text
