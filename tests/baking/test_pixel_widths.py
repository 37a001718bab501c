"""Widths in pixels of the view: what they are on meshes, in pictures, and where nobody knows."""

import math
import re

import numpy as np
import pytest

import meshdepict as md
from meshdepict import GBuffer, Look, MeshdepictError, View, samples, scale_space
from meshdepict.baking.pixel_widths import measured
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.scales.image_scales import image_space
from meshdepict.scales.making import smooth_normals
from meshdepict.shapes.lengths import counts_pixels, pixel_size, resolve_width
from meshdepict.viewer.session import Session


@pytest.fixture(scope="module")
def ball():
    return samples.golf_ball(1_500, dimples=12, depth=0.05)


def front(height_px=100, half=2.0):
    return View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=half, height_px=height_px)


@pytest.mark.parametrize(
    ("width", "expected"),
    [("3px", 0.12), (" 3 px ", 0.12), ("1px,0.02", 0.04), ("0.2, 1px", 0.2), ("50%,1px", None)],
)
def test_pixels_are_lengths_and_of_two_the_larger_counts(ball, width, expected):
    found = resolve_width(width, ball, front())
    assert found == pytest.approx(expected or 0.5 * ball.diagonal)
    assert counts_pixels(width)


@pytest.mark.parametrize(
    "width",
    ["px", "0px", "-1px", "nanpx", "1px,2px", "1,5", "1%,2", "1px,1,1", "0,1px", "1px,", "3 p x"],
)
def test_what_is_no_length_is_refused(ball, width):
    with pytest.raises(MeshdepictError, match=rf"width={width!r} is not a positive length.*'3px'"):
        resolve_width(width, ball, front())


@pytest.mark.parametrize("width", [None, 0.5, "0.5", "2%", True, np.float64(3)])
def test_other_widths_count_no_pixels(width):
    assert not counts_pixels(width)


def test_one_pixel_is_the_first_width_of_an_image(ball):
    buffer = GBuffer.of(ball, "front", size=(64, 64))
    mesh = scale_space(ball, scales=2, width="1px", view=buffer.view)
    np.testing.assert_allclose(mesh.widths, image_space(buffer, scales=2, ratio=2**0.5).widths)
    np.testing.assert_allclose(image_space(buffer, width="3px").widths[1], 3 * buffer.edge_length)
    # Its own pixels, whatever else is looked at.
    assert pixel_size(buffer, front()) == buffer.edge_length


def test_a_perspective_pixel_is_that_of_the_middle_of_the_shape(ball):
    eye = View((0, 0, 5), (0, 0, 0), (0, 1, 0), field_of_view=40, height_px=200)
    depth = 5 - ball.centre[2]
    half = depth * math.tan(math.radians(20))
    same = View((0, 0, 5), (0, 0, 0), (0, 1, 0), parallel_scale=half, height_px=200)
    assert pixel_size(ball, eye) == pytest.approx(pixel_size(ball, same))
    with pytest.raises(MeshdepictError, match="whose middle lies behind this view's"):
        pixel_size(ball, View((0, 0, 5), (0, 0, 9), (0, 1, 0), field_of_view=40))


def test_without_a_view_nobody_knows_how_large_pixels_are(ball):
    for attempt in (lambda: scale_space(ball, width="3px"), lambda: smooth_normals(ball, "3px")):
        with pytest.raises(MeshdepictError, match="a width in pixels needs a view"):
            attempt()
    assert scale_space(ball, scales=1, width="3px", view="front").widths[1] == pytest.approx(
        3 * pixel_size(ball, View.fitted("front", ball))
    )


def test_farther_away_more_surface_is_smoothed(ball):
    near, far = (
        scale_space(ball, scales=1, width="4px", view=front(half=half)) for half in (1.5, 15)
    )
    assert far.widths[1] == pytest.approx(10 * near.widths[1])


def test_a_bake_counts_the_pixels_of_its_view(ball):
    view = front(height_px=60)
    one = md.bake(ball, "exaggerated", width="2px", view=view)
    other = md.bake(ball, "exaggerated", width=2 * 4 / 60, view=view)
    np.testing.assert_array_equal(one.intensity, other.intensity)
    # A named one is a thousand pixels high.
    named = md.bake(ball, "exaggerated", width="2px", view="left")
    eye = View.fitted("left", ball)
    assert named.space.widths[1] == pytest.approx(4 * eye.parallel_scale / 1000)


@pytest.mark.parametrize("turning", [False, True])
@pytest.mark.parametrize("size", ["500x500", "900x300"])
def test_a_picture_counts_its_own(ball, size, turning):
    look = Look("exaggerated", width="3px", view="left")
    figure = Figure(size=size, scale_bar=True)
    found = measured(look, ball, figure, turning=turning)
    framing = frame(look.eye(ball), ball, figure, turning=turning)
    assert found.width == pytest.approx(3 / framing.pixels_per_unit)
    assert measured(found, ball, figure) is found
    # A view of one's own is drawn as it is, in pixels of the picture.
    own = measured(look.replace(view=front(half=1.7)), ball, Figure(size=size))
    assert own.width == pytest.approx(3 * 2 * 1.7 / int(size.split("x")[1]))


def first_width(line):
    return float(re.search(r"widths ([\d.e-]+) to", line)[1])


@pytest.mark.gpu
def test_the_command_counts_the_picture_that_it_draws(run, ball_ply):
    words = ("bake", "ball.ply", "--quiet", "--force", "--view", "front", "--width", "30px")
    lines = [
        run(*words, *more)
        for more in ((), ("--picture", "a.png"), ("--picture", "b.png", "--size", "250x250"))
    ]
    assert [(status, err) for status, _, err in lines] == [(0, [])] * 3
    plain, large, small = (first_width(out[0]) for _, out, _ in lines)
    assert large == pytest.approx(plain, rel=1e-4)
    assert small == pytest.approx(4 * plain, rel=1e-4)


def test_sessions_and_volumes_count_them_too(ball):
    pixel = pixel_size(ball, View.fitted("front", ball))
    session = Session(ball, "exaggerated", width="5px")
    assert session.space.widths[1] == pytest.approx(5 * pixel)
    session.look("left")
    assert session.space.widths[1] == pytest.approx(5 * pixel)  # those that it began with
    volume = samples.ct_phantom((24, 24, 24))
    baked = md.bake_volume(volume, width="40px")
    assert baked.space.widths[1] == pytest.approx(40 * pixel_size(baked.shape, baked.view))


def test_the_accessor_smooths_anew_for_a_view_of_other_pixels(ball):
    pv = pytest.importorskip("pyvista")
    data = pv.PolyData.from_regular_faces(ball.vertices, ball.faces)
    for view in (front(half=1.5), front(half=3.0)):
        one = data.depict("exaggerated", width="3px", view=view)
        other = md.bake(ball, "exaggerated", width="3px", view=view)
        np.testing.assert_array_equal(one.point_data["RGB"], other.colors)


def test_comparisons_count_the_pixels_of_their_pictures(ball):
    found = md.compare(
        ball, ["lambert", "light_alignment"], lights=["front"], size=(64, 48), width="2px", scales=2
    )
    eye = View.fitted("front", ball, aspect=64 / 48, height_px=48)
    expected = md.compare(
        ball, ["lambert", "light_alignment"], lights=["front"], size=(64, 48), scales=2,
        width=2 * 2 * eye.parallel_scale / 48,
    )  # fmt: skip
    np.testing.assert_array_equal(found.scores, expected.scores)
