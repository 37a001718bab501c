import numpy as np
import pytest
from conftest import rotation

from meshdepict import samples
from meshdepict.errors import MeshdepictError
from meshdepict.scene.light import Light
from meshdepict.scene.names import LIGHTS, as_light, as_view, light_angles
from meshdepict.scene.upright import UPS
from meshdepict.scene.view import VIEWS, View, named_directions
from meshdepict.shapes.mesh import Mesh

SQRT3 = 3**0.5


def turned_view(turn):
    return View(5 * turn[2], (0, 0, 0), turn[1], parallel_scale=1)


# --- lights -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "xyz"),
    [
        ("northwest", (-1, 1, 1)),
        ("northeast", (1, 1, 1)),
        ("southeast", (1, -1, 1)),
        ("southwest", (-1, -1, 1)),
        ("north", (0, 2**0.5, 1)),
        ("east", (2**0.5, 0, 1)),
        ("south", (0, -(2**0.5), 1)),
        ("west", (-(2**0.5), 0, 1)),
        ("front", (0, 0, SQRT3)),
    ],
)
def test_names_are_directions_of_the_front(name, xyz):
    light = as_light(name)
    np.testing.assert_allclose(light.direction, np.array(xyz) / SQRT3, atol=1e-15)
    assert light.name == name
    assert name in LIGHTS


def test_every_name_is_known():
    for name in LIGHTS:
        assert np.linalg.norm(as_light(name).direction) == pytest.approx(1)


@pytest.mark.parametrize(
    ("azimuth", "elevation", "xyz"),
    [
        (0, 0, (0, 1, 0)),  # up
        (90, 0, (1, 0, 0)),  # clockwise from there
        (180, 0, (0, -1, 0)),
        (-90, 0, (-1, 0, 0)),
        (450, 0, (1, 0, 0)),
        (123, 90, (0, 0, 1)),
        (0, -90, (0, 0, -1)),
        (90, 30, (SQRT3 / 2, 0, 0.5)),
    ],
)
def test_angles_run_clockwise_from_up_and_out_of_the_image(azimuth, elevation, xyz):
    light = as_light((azimuth, elevation))
    np.testing.assert_allclose(light.direction, xyz, atol=1e-15)


@pytest.mark.parametrize("elevation", [120, -90.5, 1e9])
def test_an_elevation_beyond_the_eye_is_no_light(elevation):
    with pytest.raises(MeshdepictError, match="elevation is from -90"):
        as_light((30, elevation))


@pytest.mark.parametrize("angles", [(0, 0), (350, -30), (90, 89), (0, 90), (0, -90), (225, 35)])
def test_angles_of_a_light_are_those_it_was_made_from(rng, angles):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    view = View((0, 0, 0), -turn[2], turn[1], parallel_scale=1.0)
    for eye in (None, view):
        assert light_angles(as_light(angles, eye), eye) == pytest.approx(angles, abs=1e-6)


def test_names_and_angles_follow_the_view_and_directions_do_not(rng):
    turn = rotation(rng)  # its rows are right, up and towards the eye
    view = turned_view(turn)
    for given in ("northwest", "front", (200.0, 10.0)):
        expected = as_light(given).direction @ turn
        np.testing.assert_allclose(as_light(given, view).direction, expected, atol=1e-12)
    direction = (1, 2, 2)
    np.testing.assert_allclose(as_light(direction, view).direction, np.array(direction) / 3)
    fixed = Light(direction, "lamp")
    assert as_light(fixed, view) is fixed


@pytest.mark.parametrize("length", [5e-324, 1e-300, 1.0, 1e300, 1.7e308])
def test_a_direction_may_have_any_length(length):
    light = as_light(np.array([-1.0, 1.0, 1.0]) * length)
    np.testing.assert_allclose(light.direction, np.array([-1, 1, 1]) / SQRT3)


def test_a_light_is_not_changed_with_the_array_that_it_was_made_of():
    given = np.array([0.0, 0.0, 2.0])
    light = Light(given)
    given[:] = 7
    np.testing.assert_array_equal(light.direction, [0, 0, 1])
    with pytest.raises(ValueError, match="read-only"):
        light.direction[0] = 1


@pytest.mark.parametrize(
    ("text", "middle"),
    [("northwest:20", "northwest"), ("315/45:20", (315, 45)), ("315,45:20", (315, 45)),
     ("1,-2,3:20", (1, -2, 3)), ("front:20", "front")],
)  # fmt: skip
def test_a_disc_is_a_light_with_a_colon_and_its_half_angle(text, middle, rng):
    view = View((3, 1, 2), (0, 0, 0), (0, 1, 0), parallel_scale=1)
    for eye in (None, view):
        disc, light = as_light(text, eye), as_light(middle, eye)
        np.testing.assert_array_equal(disc.direction, light.direction)
        assert (disc.spread, light.spread, disc.name) == (20, 0, light.name)
        turn = rotation(rng)
        np.testing.assert_allclose(disc.turned(turn).direction, turn @ light.direction)
        assert disc.turned(turn).spread == 20


def test_lights_can_be_compared_and_collected():
    light, other = Light((0, 0, 1)), Light((0, 1, 0))
    assert light != other
    assert len({light, other, light}) == 2


@pytest.mark.parametrize(
    ("light", "text"),
    [
        ("northwest", "northwest (-0.57735 0.57735 0.57735)"),
        ((0, 0, 3), "(0 0 1)"),
        ((45, 0), "azimuth 45 elevation 0 (0.707107 0.707107 0)"),
        ("northwest:20", "northwest spread 20 (-0.57735 0.57735 0.57735)"),
        ("0,0,3:2.5", "(0 0 1) spread 2.5"),
    ],
)
def test_a_light_in_words(light, text):
    assert str(as_light(light)) == text


@pytest.mark.parametrize(
    ("light", "sentence"),
    [
        ("northwst", "no light is called 'northwst'; did you mean 'northwest'"),
        ("northwst:20", "no light is called 'northwst'; did you mean 'northwest'"),
        ("northwest:wide", "no light is called 'northwest:wide'"),
        ("northwest:181", "half the opening of its disc, from 0 to 180 degrees, not 181"),
        ("northwest:nan", "half the opening of its disc"),
        ("studio:20", "the lights of studio have spreads of their own: leave :20 out"),
        ("", "no light is called ''"),
        ((0, 0, 0), "must be three finite numbers, not all zero"),
        ((0, 0, np.nan), "neither a name, nor a direction"),
        ((0, np.inf), "neither a name"),
        ((0, 0, 10**400), "neither a name"),
        ((1, 2, 3, 4), "neither a name"),
        ([[0, 0, 1]], "neither a name"),
        (7, "neither a name"),
        (None, "light=None is neither a name"),
        (("a", "b"), "neither a name"),
    ],
)
def test_what_is_no_light(light, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        as_light(light)


@pytest.mark.parametrize("direction", [(0, 0), (1, 2, np.inf), "up", None, (0, 0, 0)])
def test_what_is_no_direction_of_a_light(direction):
    with pytest.raises(MeshdepictError, match="a light's direction must be three finite numbers"):
        Light(direction)


# --- named views ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "up", "eye", "upwards"),
    [
        ("front", "y", (0, 0, 1), (0, 1, 0)),
        ("top", "y", (0, 1, 0), (0, 0, -1)),
        ("right", "y", (1, 0, 0), (0, 1, 0)),
        ("front", "z", (0, -1, 0), (0, 0, 1)),
        ("back", "z", (0, 1, 0), (0, 0, 1)),
        ("left", "z", (-1, 0, 0), (0, 0, 1)),
        ("right", "z", (1, 0, 0), (0, 0, 1)),
        ("top", "z", (0, 0, 1), (0, 1, 0)),
        ("bottom", "z", (0, 0, -1), (0, -1, 0)),
        ("isometric", "z", (1, -1, 1), (0, 0, 1)),
        ("front", "-y", (0, 0, 1), (0, -1, 0)),
        ("front", "-z", (0, -1, 0), (0, 0, -1)),
        ("right", "-z", (-1, 0, 0), (0, 0, -1)),
        ("front", "x", (0, 0, 1), (1, 0, 0)),
        ("right", "x", (0, -1, 0), (1, 0, 0)),
        ("top", "x", (1, 0, 0), (0, 0, -1)),
        ("front", "-x", (0, 0, 1), (-1, 0, 0)),
        ("right", "-x", (0, 1, 0), (-1, 0, 0)),
    ],
)
def test_where_named_views_look_from(name, up, eye, upwards):
    found = named_directions(name, up)
    np.testing.assert_array_equal(found[0], eye)
    np.testing.assert_array_equal(found[1], upwards)


@pytest.mark.parametrize("up", UPS)
def test_frames_are_orthonormal_and_right_handed_and_opposites_face_each_other(ball, up):
    frames = {name: View.fitted(name, ball, up=up).frame for name in VIEWS}
    for frame in frames.values():
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)
        assert np.linalg.det(frame) == pytest.approx(1)
    for one, other in (("front", "back"), ("left", "right"), ("top", "bottom")):
        np.testing.assert_allclose(frames[one][2], -frames[other][2], atol=1e-15)
    # What is right in front is what the eye at the right looks along, and so on round.
    np.testing.assert_allclose(frames["front"][0], frames["right"][2], atol=1e-15)
    np.testing.assert_allclose(frames["front"][1], frames["top"][2], atol=1e-15)


@pytest.mark.parametrize("up", UPS)
@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.parametrize("aspect", [0.5, 1.0, 3.0])
def test_a_fitted_view_shows_all_and_leaves_a_margin(name, up, aspect, rng):
    points = rng.normal(size=(60, 3)) * (1, 5, 2) + (300, -20, 7)
    shape = Mesh(points, rng.integers(0, 60, (20, 3)))
    view = View.fitted(name, shape, up=up, aspect=aspect, height_px=400)
    x, y, z = ((points - view.focus) @ view.frame.T / (aspect, 1, 1)).T
    # The tighter direction fills the height but for 5 %; the object stands in the middle.
    assert max(np.abs(x).max(), np.abs(y).max()) == pytest.approx(view.parallel_scale / 1.05)
    assert x.max() == pytest.approx(-x.min())
    assert y.max() == pytest.approx(-y.min())
    assert z.max() < np.linalg.norm(view.position - view.focus)  # all of it before the eye
    assert (view.name, view.height_px, view.field_of_view) == (name, 400, None)


@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.parametrize("place", [0.0, 3.0, 1e20])
@pytest.mark.parametrize("shape", ["point", "line of sight"])
def test_what_is_a_point_in_the_picture_has_a_view(name, place, shape):
    towards, _ = named_directions(name)
    line = np.outer([1, 2, 3], towards) * max(place, 1)
    view = View.fitted(name, Mesh(place + (0 * line if shape == "point" else line), [[0, 1, 2]]))
    np.testing.assert_allclose(view.towards_eye, towards / np.linalg.norm(towards), atol=1e-6)
    assert view.parallel_scale > 1e-3 * max(place, 1)


@pytest.mark.parametrize("factor", [1e-140, 1e140])
def test_tiny_and_huge_shapes_fill_the_picture_alike(factor):
    ball = samples.sphere(42)
    plain = View.fitted("isometric", ball)
    scaled = View.fitted("isometric", Mesh(ball.vertices * factor, ball.faces))
    assert scaled.parallel_scale == pytest.approx(plain.parallel_scale * factor)
    np.testing.assert_allclose(scaled.frame, plain.frame, atol=1e-14)


def test_views_given_as_such_are_taken_as_they_are(ball):
    view = turned_view(np.eye(3))
    assert as_view(view, ball) is view
    assert as_view("top", ball, up="z").name == "top"


# --- views of one's own -----------------------------------------------------------------------


def test_up_need_not_be_perpendicular():
    view = View((0, 0, 10), (0, 0, 0), (0, 3, -40))
    np.testing.assert_allclose(view.frame, np.eye(3), atol=1e-15)
    assert view.field_of_view == 30
    assert view.parallel_scale is None


def test_a_view_is_not_changed_with_the_arrays_that_it_was_made_of():
    position = np.array([0.0, 0.0, 10.0])
    view = View(position, (0, 0, 0), (0, 1, 0))
    position[:] = 0
    np.testing.assert_array_equal(view.position, [0, 0, 10])
    for array in (view.position, view.focus, view.up):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_the_eye_may_be_anywhere():
    view = View((1e308, 0, 0), (-1e308, 0, 0), (0, 1, 0))
    np.testing.assert_allclose(view.towards_eye, [1, 0, 0])


def test_a_view_in_words():
    view = View((0, 0, 10), (0, 0, 0.5), (0, 2, 0), name="detail")
    assert str(view) == "detail from (0 0 10) to (0 0 0.5), up (0 1 0)"
    assert str(View((0, 0, 10), (0, 0, 0), (0, 2, 0))).startswith("from (0 0 10)")


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"position": (0, 0)}, "a view's position must be three finite numbers"),
        ({"position": "here"}, "a view's position must be"),
        ({"focus": (0, 0, np.nan)}, "a view's focus must be three finite numbers"),
        ({"up": (0, 0, 0)}, "a view's up direction must be three finite numbers, not all zero"),
        ({"up": (0, 0, -3)}, "up direction lies along its line of sight"),
        ({"focus": (0, 0, 5)}, "position and focus are the same point"),
        ({"field_of_view": 30, "parallel_scale": 1}, "a field of view or a parallel scale, not"),
        ({"field_of_view": 0}, "field_of_view=0 is not between 0° and 180°"),
        ({"field_of_view": 180}, "field_of_view=180"),
        ({"field_of_view": np.nan}, "field_of_view=nan"),
        ({"field_of_view": "30"}, "field_of_view='30'"),
        ({"parallel_scale": 0}, "parallel_scale=0 is not a positive length"),
        ({"parallel_scale": np.inf}, "parallel_scale=inf"),
        ({"parallel_scale": (1, 2)}, r"parallel_scale=\(1, 2\)"),
        ({"height_px": 0}, "height_px=0 is not a number of pixels"),
        ({"height_px": 10.5}, "height_px=10.5"),
        ({"height_px": np.nan}, "height_px=nan"),
        ({"height_px": "tall"}, "height_px='tall'"),
    ],
)
def test_what_is_no_view(change, sentence):
    given = {"position": (0, 0, 5), "focus": (0, 0, 0), "up": (0, 1, 0), **change}
    with pytest.raises(MeshdepictError, match=sentence):
        View(**given)


@pytest.mark.parametrize(
    ("name", "options", "sentence"),
    [
        ("fornt", {}, r"no view is called 'fornt'; did you mean 'front'\? \(there are front, back"),
        (7, {}, "no view is called 7"),
        (["front"], {}, r"no view is called \['front'\]"),
        ("front", {"up": "w"}, "up='w' is not one of y, z, -y, -z, x, -x"),
        ("front", {"aspect": 0}, "aspect=0 is not a positive ratio"),
        ("front", {"aspect": np.nan}, "aspect=nan"),
        ("front", {"height_px": 0}, "height_px=0"),
    ],
)
def test_what_is_no_named_view(ball, name, options, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        View.fitted(name, ball, **options)
