"""Views turned by 90° stand on the side that they show, in line with each other."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.drawing.arrangement import MAIN, TURNS, arranged, turn_names
from meshdepict.scene.view import VIEWS, View, named_directions


@pytest.fixture(scope="module")
def egg():
    """An ellipsoid with three different axes, away from the origin."""
    ball = samples.sphere(400)
    return md.Mesh(ball.vertices * (3, 2, 1) + (50, -20, 7), ball.faces)


def seen(arrangement, name, point):
    """Right and up of a point from the middle of a view, and towards the eye."""
    return arrangement.frames[name] @ (np.asarray(point) - arrangement.middles[name])


@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.parametrize("up", ["y", "z", "-y", "-z"])
def test_frames_are_right_handed_and_turned_by_quarters(egg, name, up):
    view = View.fitted(name, egg, up=up)
    arrangement = arranged(view, egg, TURNS)
    for turn, frame in arrangement.frames.items():
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(frame) == pytest.approx(1)
        cosine = {MAIN: 1, "back": -1}.get(turn, 0)
        assert frame[2] @ view.frame[2] == pytest.approx(cosine, abs=1e-12)


@pytest.mark.parametrize("up", ["y", "z", "-y", "-z"])
@pytest.mark.parametrize(
    ("turn", "name"),
    [("right", "right"), ("left", "left"), ("back", "back"), ("above", "top"), ("below", "bottom")],
)
def test_the_turns_of_a_front_are_the_views_that_have_names(egg, up, turn, name):
    arrangement = arranged(View.fitted("front", egg, up=up), egg, [turn])
    towards, upwards = named_directions(name, up)
    np.testing.assert_allclose(arrangement.frames[turn][2], towards, atol=1e-12)
    np.testing.assert_allclose(arrangement.frames[turn][1], upwards, atol=1e-12)


@pytest.mark.parametrize("name", ["front", "top", "isometric"])
def test_a_level_line_meets_the_same_point_in_the_next_view(egg, name):
    arrangement = arranged(View.fitted(name, egg), egg, TURNS)
    for point in egg.vertices[::40]:
        here = seen(arrangement, MAIN, point)
        for turn, (column, row) in arrangement.cells.items():
            there = seen(arrangement, turn, point)
            if row == 0:
                assert there[1] == pytest.approx(here[1], abs=1e-9)
            if column == 0:
                assert there[0] == pytest.approx(here[0], abs=1e-9)


def test_what_is_near_the_eye_is_at_the_side_of_the_main_view(egg):
    """Third-angle: the near side of a find borders on the main view in every turn but the back."""
    arrangement = arranged(View.fitted("front", egg), egg, TURNS)
    nearest = egg.vertices[egg.vertices[:, 2].argmax()]
    for turn, (axis, sign) in {
        "right": (0, -1), "left": (0, 1), "above": (1, -1), "below": (1, 1)
    }.items():  # fmt: skip
        assert sign * seen(arrangement, turn, nearest)[axis] > 0.9


def test_columns_and_rows_are_as_large_as_the_object(egg):
    arrangement = arranged(View.fitted("front", egg), egg, TURNS)
    wide, high, deep = np.ptp(egg.vertices, axis=0)
    assert list(arrangement.widths) == [-1, 0, 1, 2]
    assert list(arrangement.heights) == [-1, 0, 1]
    assert list(arrangement.widths.values()) == pytest.approx([deep, wide, deep, wide])
    assert list(arrangement.heights.values()) == pytest.approx([deep, high, deep])


def test_views_look_at_the_middle_from_outside(egg):
    arrangement = arranged(View.fitted("isometric", egg), egg, TURNS)
    for turn in arrangement.frames:
        view = arrangement.view(turn, 100, 20.0)
        assert view.parallel_scale == 2.5
        np.testing.assert_allclose(view.frame, arrangement.frames[turn], atol=1e-12)
        assert ((egg.vertices - view.position) @ view.frame[2] < 0).all()
        reach = np.abs((egg.vertices - view.focus) @ view.frame.T).max(axis=0)
        ends = (egg.vertices - view.focus) @ view.frame.T
        np.testing.assert_allclose(ends.max(axis=0)[:2], -ends.min(axis=0)[:2], atol=1e-9)
        assert reach.max() < 4


def test_words_for_turns():
    assert turn_names(["top", "right", "bottom", "right"]) == ["above", "right", "below"]
    with pytest.raises(MeshdepictError, match="'rigth' is no turn of the main view; did you mean"):
        turn_names(["rigth"])
    with pytest.raises(MeshdepictError, match="'isometric' is no turn of the main view"):
        turn_names(["isometric"])


def test_perspective_is_refused(egg):
    view = md.View((0, 0, 99), (50, -20, 7), (0, 1, 0), field_of_view=40)
    with pytest.raises(MeshdepictError, match="need a parallel view"):
        arranged(view, egg, ["right"])


def test_a_sheet_seen_from_its_edge_has_a_width():
    sheet = md.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [[0, 1, 2, 3]])
    arrangement = arranged(View.fitted("front", sheet), sheet, TURNS)
    assert min(arrangement.widths.values()) > 0
