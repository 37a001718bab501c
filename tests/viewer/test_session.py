import numpy as np
import pytest
from method_families import ON_MESHES

from meshdepict import bake
from meshdepict.errors import MeshdepictError
from meshdepict.scales.making import scale_space
from meshdepict.viewer import session as session_module
from meshdepict.viewer.controls import controls
from meshdepict.viewer.session import Session


@pytest.fixture
def session(ball):
    return Session(ball, scales=3)


def test_a_session_shows_what_bake_bakes(ball, session):
    baked = bake(ball, light="northwest", scales=3)
    np.testing.assert_array_equal(session.colors, baked.colors)
    differing = {"view"}  # fitted already
    for key in baked.provenance.keys() - differing:
        assert session.baked().provenance[key] == baked.provenance[key]
    session.use("light_alignment")
    session.set(strength=0.7)
    session.shine((90, 20))
    expected = bake(ball, "light_alignment", light=(90, 20), strength=0.7, scales=3)
    np.testing.assert_array_equal(session.colors, expected.colors)


def test_nothing_is_shaded_twice_and_scale_spaces_are_shared(ball, monkeypatch):
    made = []

    def counted(*given, **more):
        made.append(more.get("scales"))
        return scale_space(*given, **more)

    monkeypatch.setattr(session_module, "scale_space", counted)
    session = Session(ball, scales=2)
    for method in ("exaggerated", "lambert", "light_warping", "toon", "exaggerated"):
        session.use(method)
        assert session.colors is session.colors
    assert made == [2]
    session.use("light_alignment")  # another ratio
    assert session.colors.shape == (len(ball.vertices), 3)
    assert made == [2, 2]


def test_a_session_without_smoothing_makes_none(ball, monkeypatch):
    session = Session(ball, "lambert")
    assert len(session.space.widths) == 1


def test_each_method_keeps_its_options(session):
    session.set(exaggeration=40)
    session.use("phong")
    assert session.options == {}
    session.use("exaggerated")
    assert session.options == {"exaggeration": 40}
    session.set(exaggeration=None)
    assert session.options == {"exaggeration": None}  # follows the shape again


def test_reset_goes_back_to_the_beginning(session):
    before = session.colors
    session.shine("east")
    session.set(exaggeration=40)
    session.paint("sepia")
    session.use("gooch")
    assert not np.array_equal(session.colors, before)
    session.reset()
    np.testing.assert_array_equal(session.colors, before)
    assert session.method == "exaggerated"


def test_colour_maps_leave_coloured_shading_alone(session):
    session.use("lit_sphere")
    before = session.colors.copy()
    session.paint("sepia")
    np.testing.assert_array_equal(session.colors, before)
    session.use("exaggerated")
    assert session.baked().provenance["colormap"] == "sepia"


def test_another_view_matters_only_to_methods_that_see(session):
    before = session.baked()
    session.look("top")
    assert session.baked() is before
    session.use("phong")
    first = session.baked()
    session.look("back")
    assert session.baked() is not first


def test_settings_bake_the_same(ball, session):
    session.set(exaggeration=30)
    session.paint("stone")
    np.testing.assert_array_equal(session.look_now().bake(ball).colors, session.colors)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda s: s.use("exagerated"), "did you mean 'exaggerated'"),
        (lambda s: s.set(exageration=3), "did you mean 'exaggeration'"),
        (lambda s: s.set(exaggeration=-1), "exaggeration=-1"),
        (lambda s: s.shine("nrth"), "did you mean 'north'"),
        (lambda s: s.look("frnt"), "did you mean 'front'"),
        (lambda s: s.paint("sepa"), "did you mean 'sepia'"),
    ],
)
def test_a_refused_change_changes_nothing(session, change, sentence):
    before = session.colors
    with pytest.raises(MeshdepictError, match=sentence):
        change(session)
    np.testing.assert_array_equal(session.colors, before)


@pytest.mark.parametrize("method", ON_MESHES)
def test_every_option_has_a_control_that_starts_within_its_range(method, session):
    session.use(method)
    for control in controls(method):
        assert control.kind in ("slider", "list", "text")
        assert control.help
        if control.kind == "slider":
            assert control.low < control.high
            session.set(**{control.name: control.low})
            session.set(**{control.name: control.high})
        if control.kind == "list":
            for choice in control.choices:
                session.set(**{control.name: choice})
        if control.default is not None:
            session.set(**{control.name: control.start})


def test_a_light_fixed_to_the_eye_goes_with_it(ball, session):
    session.fix_light("eye")
    session.look("back")
    np.testing.assert_allclose(
        session.light.direction,
        bake(ball, "lambert", view="back").view.frame.T @ (-1, 1, 1) / 3**0.5,
    )
    np.testing.assert_array_equal(session.colors, bake(ball, view="back", scales=3).colors)
    session.fix_light("object")
    before = session.light
    session.look("top")
    assert session.light is before
    with pytest.raises(MeshdepictError, match="not 'ceiling'"):
        session.fix_light("ceiling")


def test_a_dragged_light_shades_anew(session):
    before = session.colors
    session.drag_light((0, 0.3))
    assert not np.array_equal(session.colors, before)
    session.drag_light((0, -0.3))
    assert np.abs(session.colors.astype(int) - before).max() <= 1  # but for rounding


def test_colours_seen_from_elsewhere_say_so(ball, session):
    session.colors  # noqa: B018
    session.look("top")
    assert session.baked().view is session.view
    assert session.baked().provenance["view"] == str(session.view)


def test_what_was_chosen_can_be_chosen_again(session):
    session.set(exaggeration=22)
    look, colors = session.look_now(), session.colors
    session.set(exaggeration=3)
    session.use("toon")
    session.paint("sepia")
    session.look("back")
    session.go_back(look)
    np.testing.assert_array_equal(session.colors, colors)
    assert session.options == {"exaggeration": 22}


def test_colours_at_other_samples_are_those_of_the_whole(session):
    np.testing.assert_array_equal(session.colors_at(session.space), session.colors)


def test_a_changed_option_computes_what_is_missing_with_its_progress(ball):
    told = []
    session = Session(
        ball, "light_alignment", strength=0, progress=lambda done, total: told.append((done, total))
    )
    assert session.colors.shape == (len(ball.vertices), 3)
    assert not told
    session.set(strength=(0.5, 0.5, 0, 0, 0))
    np.testing.assert_array_equal(
        session.colors, bake(ball, "light_alignment", strength=(0.5, 0.5, 0, 0, 0)).colors
    )
    assert told[-1] == (2, 2)
    told.clear()
    session.set(strength=0)
    session.set(strength=(0, 0.5, 0, 0, 0))  # of what is there
    assert session.colors is session.colors
    assert not told
    session.set(strength=0.4)
    np.testing.assert_array_equal(
        session.colors, bake(ball, "light_alignment", strength=0.4).colors
    )
    assert told[-1] == (3, 3)


def test_a_stopped_session_goes_on_with_what_it_was_asked_for(ball):
    def stop(done, total):
        raise KeyboardInterrupt

    session = Session(ball, "exaggerated", progress=stop)
    with pytest.raises(KeyboardInterrupt):
        session.baked()
    session.progress = None
    np.testing.assert_array_equal(session.colors, bake(ball, "exaggerated").colors)
