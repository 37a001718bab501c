"""Terrain in viewers: relief on the ground, how high it stands on a slider, the light by a drag."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.recipe import load_recipe
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.browser.desk import Desk
from meshdepict.viewer.packing import pack_mesh, raised
from meshdepict.viewer.session import Session

pv = pytest.importorskip("pyvista")


@pytest.fixture(scope="module")
def field():
    y, x = np.mgrid[:24, :30] + 0.0
    z = 60 + 4 * np.exp(-((x - 12) ** 2 + (y - 10) ** 2) / 40) + 0.4 * np.sin(x)
    z[4:8, 15:20] = np.nan
    return md.HeightField(z, transform=(2, 0, 5000, 0, -2, 9000))


@pytest.fixture
def session(field):
    return Session(field)


def test_a_session_shows_what_a_bake_does(session, field):
    baked = md.bake(field)
    np.testing.assert_array_equal(session.colors, baked.colors)
    said = session.baked().provenance | {"view": "top, up z"}
    assert said == baked.provenance
    assert session.view.name == "top"
    assert session.up == "z"
    assert len(session.surface.vertices) == field.count


def test_the_factor_is_a_slider_before_those_of_the_method(session):
    first, *rest = session.controls
    assert (first.name, first.kind, first.default, session.value(first)) == (
        "z_factor", "slider", 1, 1
    )  # fmt: skip
    session.set(z_factor=3)
    assert session.value(first) == 3
    assert "z_factor" not in session.options
    named = {control.name: session.value(control) for control in rest}
    assert named["one_light"] is True  # as bakes of terrain have it
    session.use("lambert")
    assert session.controls[0] is first
    mesh = Session(md.samples.sphere(40), "lambert")
    assert "z_factor" not in {control.name for control in mesh.controls}


def test_relief_follows_the_factor(session, field):
    session.set(z_factor=3)
    baked = md.bake(field, z_factor=3)
    np.testing.assert_array_equal(session.colors, baked.colors)
    assert session.baked().provenance["z factor"] == "3"
    np.testing.assert_array_equal(session.surface.vertices, baked.mesh.vertices)
    session.set(z_factor=None)
    np.testing.assert_array_equal(session.colors, md.bake(field).colors)


def test_a_light_that_was_dragged_stays_where_it_is_while_terrain_rises(session, field):
    session.drag_light((0.2, -0.1))
    light = session.light
    session.set(z_factor=2, exaggeration=4)
    assert session.light is light
    expected = md.bake(field, z_factor=2, light=light, exaggeration=4, view="top")
    np.testing.assert_array_equal(session.colors, expected.colors)


def test_the_eye_stays_before_the_same_place(session):
    session.look("isometric")
    turned = session.view
    aside = np.array([5, 0, 0])
    moved = md.View(turned.position + aside, turned.focus + aside, turned.up, parallel_scale=9.0)
    session.look(moved)
    session.set(z_factor=4)
    rise = session.view.focus - moved.focus
    np.testing.assert_allclose(rise, (0, 0, 3 * moved.focus[2]))
    np.testing.assert_allclose(session.view.position - moved.position, rise)
    assert session.view.parallel_scale == 9


def test_going_back_takes_the_factor_along(session, field, tmp_path):
    session.set(z_factor=3)
    before = session.look_now()
    assert before.z_factor == 3
    session.set(z_factor=5)
    session.go_back(before)
    assert session.z_factor == 3
    np.testing.assert_array_equal(session.colors, md.bake(field, z_factor=3).colors)
    from meshdepict.baking.recipe import save_recipe

    save_recipe(tmp_path / "look.toml", session.settled())
    recipe = load_recipe(tmp_path / "look.toml")
    np.testing.assert_array_equal(md.bake(field, **recipe).colors, session.colors)
    session.reset()
    assert session.z_factor == 1
    np.testing.assert_array_equal(session.colors, md.bake(field).colors)


def test_a_bake_is_gone_on_with_from_its_own_heights(field):
    from meshdepict.viewer.windows.reopened import session_of

    baked = md.bake(field, z_factor=3, exaggeration=4)
    session = session_of(baked)
    assert session.z_factor == 3
    assert session.space is baked.space  # nothing is smoothed again
    np.testing.assert_array_equal(session.colors, baked.colors)
    session.set(z_factor=1)
    expected = md.bake(field, **session.options)
    np.testing.assert_array_equal(session.colors, expected.colors)


@pytest.mark.parametrize("method", md.shading.METHODS)
def test_every_method_shades_terrain(session, method):
    session.use(method)
    assert session.colors.shape == (len(session.space.points), 3)


def test_what_can_t_be_raised_or_shown_says_so(session):
    with pytest.raises(MeshdepictError, match="z_factor=0 is not a number above 0"):
        session.set(z_factor=0)
    with pytest.raises(MeshdepictError, match="z_factor='high' is not a number"):
        session.set(z_factor="high")
    assert session.z_factor == 1
    mesh = Session(md.samples.sphere(40), "lambert")
    with pytest.raises(MeshdepictError, match="about a height field, and this is a mesh"):
        mesh.raise_heights(2)
    with pytest.raises(MeshdepictError, match="z_factor is about a height field"):
        mesh.set(z_factor=2)
    with pytest.raises(MeshdepictError, match="z_factor is about a height field"):
        Session(md.samples.sphere(40), z_factor=2)
    with pytest.raises(MeshdepictError, match="no surface: nowhere do three neighbouring"):
        Session(md.HeightField(np.arange(5.0)[None]))


# --- windows --------------------------------------------------------------------------------------


@pytest.mark.parametrize("live", [False, True])
def test_the_window_s_slider_raises_the_ground(field, tmp_path, live):
    from meshdepict.viewer.windows.window import Window

    window = Window(Session(field), folder=tmp_path, size=(420, 300), off_screen=True, live=live)
    try:
        assert (window.object.why_baked == "") is live
        window.look_from("front")
        window.go(window.session.view)
        window.settle()
        flat = window.plotter.screenshot(return_img=True)
        assert window.scenery.panel.names[0] == "z_factor"
        window.scenery.panel.slide("z_factor", 6.0)
        window.settle()
        assert window.session.z_factor == 6
        high = window.plotter.screenshot(return_img=True)
        left = slice(0, window.picture_size[0])
        tall = [(image[:, left] < 200).any(axis=2).any(axis=1).sum() for image in (flat, high)]
        assert tall[1] > 1.5 * tall[0]
        saved = window.save_shape()
        assert saved.name == "height-field-exaggerated.ply"
        top = md.read_mesh(saved).vertices[:, 2].max()
        assert top == pytest.approx(6 * field.z.max())
        window.reset()
        window.draw()
        assert window.session.z_factor == 1
        again = window.scenery.panel
        again.slide("exaggeration", 9.0)  # the panel goes on
        assert window.session.options["exaggeration"] == pytest.approx(9.0)
    finally:
        window.close()


@pytest.mark.parametrize(
    "options", [{}, {"exaggeration": 3.0}, {"one_light": False}, {"contrast": 0.0}]
)
def test_live_relief_is_the_bake_s(field, options):
    from live_pictures import compare

    space = md.scale_space(field.raised(2), scales=9)
    off = compare(space, "exaggerated", options=options)
    assert np.mean(off > 2) <= 1e-3


def test_live_relief_has_no_focus(field):
    from meshdepict.viewer.live import LiveShading

    space = md.scale_space(field, scales=9)
    with pytest.raises(MeshdepictError, match="one_light has no focus"):
        LiveShading(space, "exaggerated", options={"focus": (0, 0, 0)}, view="top")


# --- the page -------------------------------------------------------------------------------------


def test_the_page_has_the_slider_and_its_mesh_is_stretched(field):
    desk = Desk(Session(field), "hill.tif")
    (control,) = [c for c in desk.look()["controls"] if c["name"] == "z_factor"]
    assert (control["kind"], control["value"], control["changed"]) == ("slider", 1.0, False)
    assert desk.apply([["option", "exaggerated", "z_factor", 2.5]]) == ""
    assert desk.session.z_factor == 2.5
    (control,) = [c for c in desk.look()["controls"] if c["name"] == "z_factor"]
    assert (control["value"], control["changed"]) == (2.5, True)
    before, info = pack_mesh(Session(field).surface)
    now = raised(info, 2.5)
    steps = np.cumsum(np.frombuffer(before[: 6 * info["vertices"]], "<u2").reshape(-1, 3), axis=0)
    places = now["low"] + (steps % 65536) * np.array(now["span"]) / 65535
    np.testing.assert_allclose(
        places, desk.session.surface.vertices, rtol=0, atol=max(now["span"]) / 65535
    )
    assert desk.apply([["option", "exaggerated", "z_factor", None]]) == ""
    assert desk.session.z_factor == 1
    assert desk.name("ply") == "hill-exaggerated.ply"
    assert desk.save("ply", desk.shown("ply"), (300, 200))[:3] == b"ply"
