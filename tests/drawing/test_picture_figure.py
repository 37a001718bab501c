"""Figures: sizes, grounds and scales in words, refused before anything is drawn."""

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.drawing.canvas import on_ground
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.drawing.picture import finished


@pytest.mark.parametrize(
    ("given", "dpi", "pixels", "dots"),
    [
        (None, None, None, None),
        ((1200, 900), None, (1200, 900), None),
        ("1200x900", None, (1200, 900), None),
        ("1200 × 900 px", 72, (1200, 900), 72),
        ("12x9cm", 300, (1417, 1063), 300),
        ("120x90mm", 300, (1417, 1063), 300),
        ("5x4in", 600, (3000, 2400), 600),
        ("2.54x1.27cm", None, (300, 150), 300),
        ("A4", None, (2480, 3508), 300),
        ("a4-landscape", 100, (1169, 827), 100),
        ("A6", 254, (1050, 1480), 254),
    ],
)
def test_a_size_is_in_pixels_or_on_paper(given, dpi, pixels, dots):
    figure = Figure(size=given, dpi=dpi)
    assert (figure.pixels, figure.dpi) == (pixels, dots)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"size": "large"}, "is not WIDTHxHEIGHT"),
        ({"size": "12x9 miles"}, "is not WIDTHxHEIGHT"),
        ({"size": (1, 2, 3)}, r"neither \(width, height\) nor"),
        ({"size": 5}, r"neither \(width, height\) nor"),
        ({"size": ("a", "b")}, r"neither \(width, height\) nor"),
        ({"size": "10.5x10"}, "whole numbers"),
        ({"size": (10.5, 10)}, "whole numbers"),
        ({"size": (0, 10)}, "0x10 pixels: 1 to 16384"),
        ({"size": "90x90cm", "dpi": 600}, "21260x21260 pixels"),
        ({"dpi": 0}, "dpi=0 is not a number of dots per inch above 0"),
        ({"dpi": "many"}, "dpi='many' is not a number of dots per inch above 0"),
        ({"pixels_per_unit": -1}, "pixels_per_unit=-1 is not a number of pixels above 0"),
        (
            {"pixels_per_unit": float("nan")},
            "pixels_per_unit=nan is not a number of pixels",
        ),
        ({"unit": "parsec"}, "unit='parsec' is no length that a scale bar knows"),
        ({"unit": "mmm"}, "did you mean 'mm'"),
        ({"unit": 3}, "unit=3 is no length"),
        (
            {"background": "reddish"},
            "none of transparent, white, paper, no name of a colour .* and no #rrggbb",
        ),
        ({"background": "ligthgray"}, "did you mean 'lightgray'"),
        ({"background": "rgb(1,2,3)"}, "no #rrggbb"),
        ({"background": "#12345"}, "no #rrggbb"),
        ({"background": 7}, "no #rrggbb"),
        ({"size": "A7"}, "A4 or A4-landscape"),
        ({"caption": 3}, "caption=3 is no text"),
    ],
)
def test_other_figures_are_refused(words, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        Figure(**words)


@pytest.mark.parametrize(
    ("given", "unit"), [("", ""), (None, ""), ("µm", "µm"), ("um", "µm"), ("Metres", "m"),
                        ("px", "px"), ("units", "units")]
)  # fmt: skip
def test_units_have_one_spelling(given, unit):
    assert Figure(unit=given).unit == unit


def test_grounds_have_their_colors():
    assert Figure().ground == (255, 255, 255)
    assert Figure(background="#0A10ff").ground == (10, 16, 255)
    assert Figure(background="transparent").ground is None
    assert Figure(background="Tomato").ground == (255, 99, 71)
    assert Figure(background="grey").ground == Figure(background="gray").ground == (128,) * 3
    assert max(Figure(background="paper").ground) < 240  # what is burnt out to white shows


def test_laying_on_a_ground_is_the_weighted_mean(rng):
    coverage = rng.integers(0, 256, (40, 40, 1))
    color = rng.integers(0, 256, (40, 40, 3))
    premultiplied = np.round(color * coverage / 255)
    drawn = np.concatenate((premultiplied, coverage), axis=2).astype(np.uint8)
    ground = (200, 0, 255)
    expected = (color * coverage + ground * (255 - coverage)) / 255
    assert np.abs(on_ground(drawn, ground).astype(float) - expected).max() <= 1
    plain = on_ground(drawn, None)
    np.testing.assert_array_equal(plain[..., 3:], coverage)
    shown = coverage[..., 0] > 127
    assert np.abs(plain[shown][:, :3].astype(float) - color[shown]).max() <= 1.5


def test_letters_are_eight_points_on_paper():
    assert Figure(size="10x10cm", dpi=720).letters((2835, 2835)) == 80
    assert Figure().letters((1000, 1000)) == 24
    assert Figure().letters((20, 20)) == 11


def corners(shape, framing, view):
    """Pixels, from the middle, at which the corners of the shape are seen."""
    seen = (shape.vertices - view.focus) @ view.frame.T
    return seen[:, :2] * framing.pixels_per_unit


@pytest.mark.parametrize("name", ["front", "isometric", "top"])
@pytest.mark.parametrize("words", [{}, {"pixels_per_unit": 40}, {"scale_bar": True}])
def test_a_turning_object_stays_in_its_picture_and_fills_it(name, words):
    from meshdepict.drawing.motion import turned

    ball = samples.sphere(162)
    shape = md.Mesh(ball.vertices * (3, 1, 0.5) + (7, 8, 9), ball.faces)
    view = md.View.fitted(name, shape)
    framing = frame(
        view,
        shape,
        Figure(size=None if "pixels_per_unit" in words else (300, 200), **words),
        turning=True,
    )
    room = np.array(framing.drawn) / 2
    reach = np.max(
        [
            np.abs(corners(shape, framing, turned(framing.view, angle))).max(axis=0)
            for angle in range(0, 360, 5)
        ],
        axis=0,
    )
    assert (reach <= room / 1.05 + 0.01).all()
    assert (reach / room).max() > 0.93  # a margin of 5 %, and 5° between the angles looked at
    if "pixels_per_unit" in words:
        assert framing.pixels_per_unit == 40


def test_a_line_seen_end_on_has_a_frame():
    line = md.Mesh([(0, 0, 0), (0, 0, 1), (0, 0, 2)], [[0, 1, 2]], winding="keep")
    framing = frame(md.View.fitted("front", line), line, Figure())
    assert np.isfinite(framing.pixels_per_unit)


@pytest.mark.parametrize("scale", [1e-3, 0.5, 3, 20])
@pytest.mark.parametrize("background", ["white", "transparent"])
def test_a_picture_of_a_speck_still_has_room_for_its_scale_bar(tmp_path, scale, background):
    baked = md.bake(md.samples.sphere(50), "lambert")
    path = baked.picture(
        tmp_path / "speck.png", pixels_per_unit=scale, scale_bar=True, background=background
    )
    image = np.asarray(Image.open(path).convert("RGB")).astype(int)
    assert image.shape[1] >= 100
    strip = image[image.shape[0] // 3 :]
    assert (strip.min(axis=2) < 100).sum() > 40  # bar and letters
    assert (strip[:, -3:].min(axis=2) > 200).all() or background == "transparent"  # none cut off


def test_the_scale_bar_says_what_the_file_says_unless_told_otherwise():
    ball = samples.sphere(200)
    metres = md.Mesh(ball.vertices, ball.faces, length_unit="m")
    view = md.View.fitted("front", ball)
    figure, told = Figure(scale_bar=True), Figure(scale_bar=True, unit="mm")
    found = [
        frame(view, shape, layout).unit
        for shape, layout in ((ball, figure), (metres, figure), (metres, told))
    ]
    assert found == ["", "m", "mm"]
    pictures = [
        draw(shape, layout) for shape, layout in ((ball, figure), (metres, figure), (metres, told))
    ]
    assert not np.array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[1], pictures[2])
    np.testing.assert_array_equal(pictures[1], draw(ball, Figure(scale_bar=True, unit="m")))


def draw(shape, figure):
    """Return a white picture with nothing but the scale bar of a shape's."""
    framing = frame(md.View.fitted("front", shape), shape, figure)
    width, height = framing.drawn
    return np.asarray(finished(np.zeros((height, width, 4), np.uint8), framing, figure))
