"""What the window is made of and needs no display: light by hand, camera, keys, previews, wipe."""

import itertools

import numpy as np
import pytest

from meshdepict import bake, samples
from meshdepict.baking.recipe import load_recipe
from meshdepict.drawing.canvas import place
from meshdepict.errors import MeshdepictError
from meshdepict.scales.making import scale_space
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light, Lights
from meshdepict.scene.names import as_light
from meshdepict.scene.view import VIEWS, View
from meshdepict.shading import METHODS
from meshdepict.shapes.mesh import Mesh
from meshdepict.viewer.controls import Control
from meshdepict.viewer.light_drag import angles, carried, dragged, lights_of
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows import exports
from meshdepict.viewer.windows.camera import (
    camera_view,
    project_in_parallel,
    project_in_perspective,
    same_sight,
)
from meshdepict.viewer.windows.cycle import colormaps, next_method, other
from meshdepict.viewer.windows.keys import KEYS, POINTER, action_of, help_text, hint
from meshdepict.viewer.windows.option_panel import readable
from meshdepict.viewer.windows.preview import Pace, Proxy
from meshdepict.viewer.windows.reopened import session_of
from meshdepict.viewer.windows.status import light_line, view_line
from meshdepict.viewer.windows.wipe import wipe_normal

pv = pytest.importorskip("pyvista")


@pytest.fixture
def view(ball):
    return View.fitted("isometric", ball)


# --- the light by hand ----------------------------------------------------------------------


def test_a_drag_from_the_middle_to_the_rim_takes_the_light_along(view):
    light = Light(view.towards_eye)
    right, up, _ = view.frame
    for drag, towards in (((0.5, 0), right), ((0, 0.5), up), ((-0.5, 0), -right), ((0, -0.5), -up)):
        np.testing.assert_allclose(dragged(light, view, drag).direction, towards, atol=1e-12)
    np.testing.assert_allclose(
        dragged(light, view, (1, 0)).direction, -view.towards_eye, atol=1e-12
    )


def test_a_drag_there_and_back_changes_nothing(view):
    light = Light((0.3, 0.5, 0.7), color=(1, 0.5, 0.2))
    back = dragged(dragged(light, view, (0.2, -0.1)), view, (-0.2, 0.1))
    np.testing.assert_allclose(back.direction, light.direction, atol=1e-12)
    np.testing.assert_array_equal(back.color, light.color)
    assert dragged(light, view, (0, 0)) is light


def test_several_lights_turn_together(view):
    lights = Lights([Light((1, 0, 0)), Light((0, 1, 0), color=(0, 1, 0))])
    turned = dragged(lights, view, (0.1, 0.2))
    assert isinstance(turned, Lights)
    for one, before in zip(turned, lights, strict=True):
        np.testing.assert_allclose(
            one.direction, dragged(before, view, (0.1, 0.2)).direction, atol=1e-12
        )
    assert turned[0].direction @ turned[1].direction == pytest.approx(0, abs=1e-12)


def test_a_panorama_cannot_be_turned_and_is_not_carried(view):
    sky = Environment(np.ones((4, 8, 3)))
    assert lights_of(sky) == ()
    with pytest.raises(MeshdepictError, match="panorama can't be turned"):
        dragged(sky, view, (0.1, 0))
    assert carried(sky, view, view) is sky


def test_a_carried_light_stands_to_the_eye_as_before(ball, view):
    for name in VIEWS:
        after = View.fitted(name, ball)
        light = carried(as_light("northwest", view), view, after)
        np.testing.assert_allclose(
            light.direction, as_light("northwest", after).direction, atol=1e-12
        )
    light = as_light("north", view)
    assert carried(light, view, view) is light


def test_angles_are_those_that_a_light_was_given_by(view):
    for azimuth, elevation in itertools.product((0, 45, 200, 359), (-60, 0, 35, 80)):
        found = angles(as_light((azimuth, elevation), view), view)
        np.testing.assert_allclose(found, (azimuth, elevation), atol=1e-6)


# --- camera and view ------------------------------------------------------------------------


def far_mesh():
    vertices = np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, 5]], float)
    return Mesh(vertices + np.array([5e5, -4e6, 30]), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


@pytest.mark.parametrize("perspective", [False, True])
@pytest.mark.parametrize("mesh", [samples.sphere(200), far_mesh()], ids=["sphere", "far"])
def test_a_view_survives_the_camera(mesh, perspective):
    for name in VIEWS:
        view = View.fitted(name, mesh, height_px=700)
        if perspective:
            view = View(view.position, view.focus, view.up, field_of_view=41.0, height_px=700)
        camera = pv.Camera()
        place(camera, view, mesh)
        back = camera_view(camera, mesh, height_px=700)
        # Two roundings of a position in world units.
        near = 4 * np.spacing(np.abs(view.position).max())
        np.testing.assert_allclose(back.position, view.position, rtol=0, atol=near)
        np.testing.assert_allclose(back.focus, view.focus, rtol=0, atol=near)
        np.testing.assert_allclose(back.frame, view.frame, atol=1e-9)
        assert (back.parallel_scale is None) == perspective
        assert same_sight(back, view, mesh)
        again = pv.Camera()
        place(again, back, mesh)
        assert same_sight(camera_view(again, mesh), view, mesh)


def test_another_eye_is_another_sight(ball, view):
    shift = np.array([1e-5 * ball.diagonal, 0, 0])
    moved = View(view.position + shift, view.focus, view.up, parallel_scale=view.parallel_scale)
    zoomed = View(view.position, view.focus, view.up, parallel_scale=view.parallel_scale * 1.001)
    assert same_sight(view, view, ball)
    assert not same_sight(view, moved, ball)
    assert not same_sight(view, zoomed, ball)


def test_perspective_and_back_keeps_the_size_at_the_focus(ball, view):
    camera = pv.Camera()
    place(camera, view, ball)
    project_in_perspective(camera)
    seen = camera_view(camera, ball)
    reach = np.linalg.norm(seen.position - seen.focus) * np.tan(np.radians(15))
    assert reach == pytest.approx(view.parallel_scale)
    project_in_parallel(camera)
    assert camera_view(camera, ball).parallel_scale == pytest.approx(view.parallel_scale)


# --- keys -----------------------------------------------------------------------------------


def test_no_key_means_two_things_and_all_are_in_the_help():
    symbols = [symbol for key in KEYS for symbol in key.symbols]
    assert len(symbols) == len(set(symbols))
    keys, words = help_text()
    assert keys.count("\n") == words.count("\n")
    for key in KEYS:
        assert action_of(key.symbols[0]) == key.action
        if not key.action.startswith(("choice", "light_")):
            assert key.words in words
    for pointer, what in POINTER:
        assert pointer in keys
        assert what in words


@pytest.mark.parametrize(("symbol", "said"), [("x", True), ("F7", True), ("Control_L", False)])
def test_other_keys_get_a_hint(symbol, said):
    assert action_of(symbol) is None
    assert ("h shows the keys" in hint(symbol)) == said


# --- round and round ------------------------------------------------------------------------


def test_going_round_comes_back():
    items = ["a", "b", "c"]
    assert [other(items, item, 1) for item in items] == ["b", "c", "a"]
    assert other(items, "a", -1) == "c"
    assert other(items, "nothing of these", 1) == "a"


def test_colour_maps_include_the_one_in_use(ball):
    session = Session(ball, "lambert")
    usual = colormaps(session)
    assert usual[0] is None
    assert "gray" not in usual
    session.paint("viridis")
    assert colormaps(session) == [*usual, "viridis"]


def test_methods_that_cannot_shade_this_are_passed_over(ball):
    names = list(METHODS)
    session = Session(ball, "light_warping", light=["north", "east"], scales=1)
    refusals = next_method(session, 1)
    start = names.index("light_warping")
    passed = [refusal.partition(":")[0] for refusal in refusals]
    assert passed == [names[(start + 1 + k) % len(names)] for k in range(len(passed))]
    assert session.method == names[(start + 1 + len(passed)) % len(names)]


@pytest.mark.parametrize(
    ("low", "high", "step", "value", "expected"),
    [(0, 100, 0, 41.3777, 41.4), (0, 1, 0, 0.123456, 0.123), (0, 8, 1, 3.6, 4), (0, 4, 0, 5, 4)],
)
def test_sliders_give_readable_values_within_their_range(low, high, step, value, expected):
    control = Control("x", "slider", "x", "", low, low=low, high=high, step=step)
    assert readable(control, value) == pytest.approx(expected, abs=1e-12)


# --- previews -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def proxy_of_sphere():
    mesh = samples.sphere(8000)
    return mesh, Proxy(mesh, most=900)


def test_a_proxy_is_a_closed_coarse_copy_of_a_sphere(proxy_of_sphere):
    mesh, proxy = proxy_of_sphere
    assert 400 < len(proxy.chosen) <= 900
    points = mesh.vertices[proxy.chosen]
    corners = points[proxy.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = np.einsum("ij,ij->i", normals, corners.mean(axis=1)) > 0
    assert outwards.mean() > 0.97  # few are turned where clusters meet
    volume = np.einsum("ij,ij->i", corners[:, 0], normals).sum() / 6
    # Chords of cells about 1/11 of the radius wide cut off little.
    assert volume == pytest.approx(4 / 3 * np.pi, rel=0.04)


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("lambert", {}), ("exaggerated", {}), ("phong", {}), ("ambient_occlusion", {"rays": 16}),
        ("light_warping", {"curvature": "view"}), ("radiance_scaling", {}), ("light_alignment", {}),
    ],
)  # fmt: skip
def test_a_preview_has_the_colours_of_the_whole(method, options, ball):
    session = Session(ball, method, scales=2, **options)
    proxy = Proxy(ball, most=700)
    preview = session.colors_at(proxy.space(session.space))
    np.testing.assert_array_equal(preview, session.colors[proxy.chosen])
    assert proxy.space(session.space) is proxy.space(session.space)


def test_a_preview_of_what_needs_neighbours_is_refused(ball):
    session = Session(ball, "unsharp_masking", scales=2)
    with pytest.raises(MeshdepictError, match="averaged"):
        session.colors_at(Proxy(ball, most=700).space(session.space))


def test_a_thinned_space_meets_the_whole_surface(ball):
    space = scale_space(ball, scales=1)
    assert Proxy(ball, most=700).space(space).surface is ball


def test_small_meshes_need_no_proxy(ball):
    assert not Proxy.worth(ball)


def test_a_mesh_of_one_point_many_times_has_a_proxy():
    mesh = Mesh(np.ones((4, 3)), [[0, 1, 2], [1, 2, 3]])
    proxy = Proxy(mesh)
    assert len(proxy.chosen) == 1
    assert len(proxy.faces) == 0


def test_a_pace_is_kept_within_the_budget():
    pace = Pace(0.05)
    pace.shading, pace.drawing = 0.03, 0.03
    assert pace.draws_in_time
    assert not pace.keeps_up
    pace.shading = 0.01
    assert pace.keeps_up
    pace.coarse_shading = 1.0
    assert not pace.coarse_keeps_up


# --- wipe -----------------------------------------------------------------------------------


@pytest.mark.parametrize("perspective", [False, True])
@pytest.mark.parametrize("place_", [0.0, 0.3, 0.5, 0.9])
def test_the_wipe_cuts_where_its_line_is(place_, perspective, ball, view):
    camera = pv.Camera()
    place(camera, view, ball)
    if perspective:
        project_in_perspective(camera)
    aspect = 1.4
    origin, normal = wipe_normal(camera, place_, aspect)
    matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1, 1)
    for x, depth in itertools.product((-0.99, -0.5, 0.1, 0.7), (0.2, 1.0)):
        # a point of the scene that is seen at x, from −1 at the left to 1 at the right
        place_in_view = np.array([x, 0.3, depth, 1.0])
        point = np.linalg.inv(pv.array_from_vtkmatrix(matrix)) @ place_in_view
        side = (point[:3] / point[3] - origin) @ normal
        assert (side > 0) == (x > 2 * place_ - 1)


# --- what is taken away ---------------------------------------------------------------------


def test_names_that_are_taken_get_a_number(tmp_path):
    paths = []
    for _ in range(3):
        paths.append(exports.free_path("ball-toon", ".png", tmp_path))
        paths[-1].touch()
    assert [path.name for path in paths] == ["ball-toon.png", "ball-toon-2.png", "ball-toon-3.png"]


def test_a_saved_recipe_bakes_the_picture_that_was_saved(tmp_path, ball):
    from PIL import Image

    session = Session(ball, "phong", scales=2)
    session.look(View((3, 2, 4), (0.1, 0, 0), (0, 1, 0), parallel_scale=1.2))
    session.drag_light((0.1, -0.2))
    session.set(shininess=9)
    picture = exports.save_snapshot(session, "ball", (160, 120), folder=tmp_path)
    recipe = exports.save_look(session, "ball", folder=tmp_path)
    again = bake(ball, **load_recipe(recipe))
    np.testing.assert_array_equal(again.colors, session.colors)
    other_picture = again.picture(tmp_path / "again.png", size=(160, 120))
    with Image.open(picture) as one, Image.open(other_picture) as two:
        np.testing.assert_array_equal(np.asarray(one), np.asarray(two))


def test_a_saved_mesh_has_the_colours(tmp_path, ball):
    from meshdepict.io import read_mesh

    session = Session(ball, "toon")
    path = exports.save_mesh(session, "ball", folder=tmp_path)
    assert path.name == "ball-toon.ply"
    vertex = read_mesh(path).attributes["vertex"]
    np.testing.assert_array_equal(vertex["red"], session.colors[:, 0])


# --- status ---------------------------------------------------------------------------------


def test_the_status_says_where_the_light_is_and_what_the_view_does(ball):
    session = Session(ball, "lambert", light=(90, 20))
    assert light_line(session) == "light: azimuth 90°, elevation 20°, fixed to the object"
    assert view_line(session) == "shaded alike for every view"
    session = Session(ball, "phong", light=[(90, 0), (0, 10)])
    session.fix_light("eye")
    assert light_line(session) == "light: azimuth 90°, elevation 0° and 1 more, fixed to the eye"
    assert view_line(session) == "shaded for this view"
    session.shine(Environment(np.ones((4, 8, 3)), name="sky"))
    assert "sky" in light_line(session)


# --- a session from a bake ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "look"),
    [
        (
            "exaggerated",
            {"light": (20, 30), "exaggeration": 33.5, "scales": 3, "colormap": "sepia"},
        ),
        ("phong", {"light": ["north", Light((1, 2, 3), color=(1, 0.5, 0.25))], "view": "top"}),
        ("lambert", {"up": "z", "light": (1, 2, 3)}),
    ],
)
def test_a_session_goes_on_from_a_bake(method, look, ball):
    baked = bake(ball, method, **look)
    session = session_of(baked)
    np.testing.assert_array_equal(session.colors, baked.colors)
    assert session.baked() is not baked  # which stays as it is
    view = baked.provenance["view"]
    session.look("back")
    assert baked.provenance["view"] == view
    session.look(baked.view)
    session.shine(session.light)  # bakes anew, from the same scale space
    np.testing.assert_array_equal(session.colors, baked.colors)
    assert session.space is baked.space


def test_what_a_session_cannot_change_is_refused(ball):
    with pytest.raises(MeshdepictError, match="can't be turned by hand"):
        session_of(bake(ball, "phong", light=Environment(np.ones((4, 8, 3)))))
    dark = np.full(len(ball.vertices), 9, np.uint8)
    own = {"vertex": dict.fromkeys(("red", "green", "blue"), dark)}
    red = Mesh(ball.vertices, ball.faces, attributes=own)
    with pytest.raises(MeshdepictError, match="its own colours"):
        session_of(bake(red, "lambert", albedo="keep"))
    with pytest.raises(MeshdepictError, match="two lights"):
        session_of(bake(ball, "lambert", colormap2d="dusk"))
