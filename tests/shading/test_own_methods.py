"""A person's own method: a function made by `md.method`, wherever it stands."""

import inspect
import pickle
from typing import Annotated, Optional

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.recipe import load_recipe, save_recipe
from meshdepict.options import Range, options_of
from meshdepict.shading.registry import METHODS, find_method
from meshdepict.viewer.controls import controls
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.reopened import session_of


@md.method(source="a try", needs=("curvature",))
def stripes(space, light, *, count: int = 12, blur: float = 0.0, view="front", exposure=1.0):
    """Shade by height alone: bright and dark in turn.

    Parameters
    ----------
    blur : float
        How soft the stripes are.

    Raises
    ------
    MeshdepictError
        Never.
    """
    height = space.unit_points[:, 1] * (1 - blur)
    return np.clip((0.5 + 0.5 * np.sin(2 * np.pi * count * height)) * exposure, 0, 1)


@md.method(source="a try")
def lambert(space, light, *, exposure: float = 1.0):
    """Shade by nothing at all, under a name that is taken."""
    return np.full(len(space.points), 0.25)


@pytest.fixture(scope="module")
def ball():
    return md.samples.golf_ball(600, dimples=12)


# --- where it can be used -------------------------------------------------------------------------


def test_it_is_baked_as_it_is(ball):
    baked = md.bake(ball, stripes, count=6)
    expected = 0.5 + 0.5 * np.sin(2 * np.pi * 6 * md.scale_space(ball, scales=0).unit_points[:, 1])
    np.testing.assert_allclose(baked.intensity, expected)
    assert baked.provenance["method"] == "stripes"
    assert baked.provenance["options"] == "count=6 blur=0"
    assert "stripes" in repr(baked)


def test_a_function_and_its_name_are_one_method(ball):
    one, other = md.bake(ball, md.shading.toon, bins=3), md.bake(ball, "toon", bins=3)
    np.testing.assert_array_equal(one.colors, other.colors)
    assert one.provenance == other.provenance


def test_its_name_may_be_taken_without_harm(ball):
    assert find_method(lambert) is lambert
    assert find_method("lambert") is md.shading.lambert
    mine = md.bake(ball, lambert)
    assert (mine.intensity == 0.25).all()
    assert (session_of(mine).baked().intensity == 0.25).all()
    assert (mine.look.replace(light="east").bake(ball).intensity == 0.25).all()


def test_it_can_be_refined_and_measured(ball):
    assert md.bake(ball, stripes, count=2).edge_error.rms > 0
    assert len(md.bake(ball, stripes, count=9, refine=4).colors) > len(ball.vertices)


def test_it_shades_voxels_and_pixels(ball):
    voxels = md.bake_volume(md.samples.ct_phantom((12, 14, 10)), stripes, count=2)
    assert voxels.provenance["method"] == "stripes"
    assert np.ptp(voxels.intensity) > 0.5
    pixels = md.bake(md.GBuffer.of(ball, "front", size=(20, 20)), stripes)
    assert np.ptp(pixels.intensity) > 0.5


def test_it_is_compared_with_others(ball):
    found = md.compare(ball, ["lambert", stripes], lights=["front"], size=(40, 40), scales=1)
    assert found.methods == ("lambert", "stripes")
    with pytest.raises(md.MeshdepictError, match="two methods are called 'lambert'"):
        md.compare(ball, ["lambert", lambert], lights=["front"], size=(40, 40), scales=1)


def test_a_session_shows_it_and_goes_on_to_others(ball):
    session = session_of(md.bake(ball, stripes, count=6))
    before = session.colors
    assert (session.method, session.options) == ("stripes", {"count": 6})
    session.use("toon")
    assert session.method == "toon"
    session.reset()
    assert session.function is stripes
    np.testing.assert_array_equal(session.colors, before)
    assert Session(ball, stripes).follows_view


def test_a_live_twin_of_its_name_is_not_taken_for_it(ball):
    from meshdepict.viewer.live.look import live_method

    assert live_method(md.shading.lambert) is live_method("lambert")
    with pytest.raises(md.MeshdepictError, match="'lambert' can't be shown live"):
        live_method(lambert)


def test_its_recipe_is_loaded_where_its_name_is_known(ball, folder, monkeypatch):
    save_recipe("look.toml", md.bake(ball, stripes, count=7).look)
    with pytest.raises(md.MeshdepictError, match=r"^look.toml: no method is called 'stripes'.*"):
        load_recipe("look.toml")
    with pytest.raises(md.MeshdepictError, match=r"once a package offers it as an entry point"):
        load_recipe("look.toml")
    monkeypatch.setitem(METHODS, "stripes", stripes)
    recipe = load_recipe("look.toml")
    assert (recipe["method"], recipe["count"]) == ("stripes", 7)
    np.testing.assert_array_equal(
        md.bake(ball, **recipe).colors, md.bake(ball, stripes, count=7).colors
    )


def test_its_look_travels_to_other_processes_as_it_is(ball):
    for method in (lambert, "lambert", "toon"):
        look = md.Look(method, light="west", exposure=0.5)
        there = pickle.loads(pickle.dumps(look))
        assert there.function is look.function
        assert there.words() == look.words() == {"light": "west", "exposure": 0.5}
        np.testing.assert_array_equal(there.bake(ball).colors, look.bake(ball).colors)
    assert b"shading.toon" not in pickle.dumps(md.Look("toon"))  # by its name alone


# --- what is read from it -------------------------------------------------------------------------


def test_plain_annotations_are_options():
    found = options_of(stripes)
    assert list(found) == ["count", "blur"]
    assert (found["count"].kind, found["count"].default) == (int, 12)
    assert found["blur"].accepts == Range(help="blur")
    assert [control.kind for control in controls(stripes)] == ["text", "text"]


def test_plain_annotations_may_leave_it_open():
    def shade(space, light, *, a: int | None = None, b: Optional[float] = None, c: str = "", d=1):  # noqa: UP045
        ...

    found = options_of(shade)
    assert {name: option.kind for name, option in found.items()} == {"a": int, "b": float}


def test_only_keywords_are_options():
    def scaled(space, first: float, *, second: float = 1.0): ...

    assert list(options_of(scaled)) == ["second"]


def test_wrong_options_are_refused(ball):
    with pytest.raises(md.MeshdepictError, match=r"stripes: count=1\.5 is not a whole number"):
        md.bake(ball, stripes, count=1.5)
    with pytest.raises(md.MeshdepictError, match="stripes has no option 'cuont'; did you mean"):
        md.bake(ball, stripes, cuont=3)


def test_its_docstring_is_completed():
    assert inspect.getdoc(stripes) == inspect.cleandoc(
        """Shade by height alone: bright and dark in turn.

        Parameters
        ----------
        space : ScaleSpace
        light : str, (3,) array_like, (azimuth, elevation) or Light
        count : int
            Count.
        blur : float
            How soft the stripes are.
        view : View or str
            Where the eye is.
        exposure : float
            Factor on the result before it is clipped.

        Returns
        -------
        (n,) array of float32
            Display values in [0, 1].

        Raises
        ------
        MeshdepictError
            Never."""
    )


def test_a_function_without_a_docstring_stays_without():
    @md.method(source="a try")
    def silent(space, light):
        return np.zeros(len(space.points))

    assert silent.__doc__ is None


def test_annotations_that_cannot_be_read_yet_wait(ball):
    def late(space, light, *, amount: "Nowhere" = 1.0):  # noqa: F821
        """Shade by what is not there."""
        return np.zeros(len(space.points))

    made = md.method(source="a try")(late)
    assert made.__doc__ == "Shade by what is not there."
    with pytest.raises(md.MeshdepictError, match=r"annotations of late can't be read.*'Nowhere'"):
        md.bake(ball, made)


# --- what is refused ------------------------------------------------------------------------------


def test_a_function_that_was_not_declared_is_told_how(ball):
    def mine(space, light): ...

    for wrong, name in ((mine, "mine"), (dict, "dict")):
        with pytest.raises(md.MeshdepictError, match=rf"^{name} is no shading method.*md\.method"):
            md.bake(ball, wrong)
    with pytest.raises(md.MeshdepictError, match="no method is called 5"):
        md.bake(ball, 5)


def test_an_unknown_need_is_refused():
    with pytest.raises(md.MeshdepictError, match="can't need 'ray'; did you mean 'rays'"):
        md.method(source="a try", needs=("ray",))


def _none(): ...
def _space(space): ...
def _third(space, light, strength): ...
def _required(space, light, *, strength): ...
def _any(space, *light): ...


@pytest.mark.parametrize("function", [_none, _space, _third, _required, _any])
def test_a_function_of_another_form_is_refused(function):
    with pytest.raises(md.MeshdepictError, match=f"{function.__name__} can't be a method as it is"):
        md.method(source="a try")(function)


def test_only_functions_become_methods():
    with pytest.raises(md.MeshdepictError, match="methods of functions, not of 3"):
        md.method(source="a try")(3)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (lambda n: None, r"object \(\) for"),
        (lambda n: np.zeros(n + 1), "let it return numbers"),
        (lambda n: np.zeros((n, 1)), "let it return numbers"),
        (lambda n: np.full(n, "x"), "let it return numbers"),
        (lambda n: np.full(n, np.nan), r"not in \[0, 1\], or no numbers"),
        (lambda n: np.full((n, 3), 1.5), r"np\.clip"),
    ],
)
def test_values_that_cannot_be_shown_are_refused(ball, values, sentence):
    @md.method(source="a try")
    def odd(space, light):
        return values(len(space.points))

    with pytest.raises(md.MeshdepictError, match=f"^odd returned .*{sentence}"):
        md.bake(ball, odd)


def test_whole_numbers_and_truths_are_values(ball):
    @md.method(source="a try")
    def lit(space, light):
        return space.normals[0][:, 0] > 0

    found = md.bake(ball, lit)
    assert found.intensity.dtype == np.float32
    assert set(np.unique(found.colors)) == {0, 255}


def test_what_compare_shows_it_with_cannot_be_spoilt():
    made = md.method(source="a try", compared={"count": 3})(
        lambda space, light, *, count=3: np.zeros(len(space.points))
    )
    with pytest.raises(TypeError):
        made.declaration.compared["count"] = 4


def test_numbers_in_a_range_stay_options_of_their_own():
    def both(space, light, *, a: Annotated[float, Range(0, 1)] = 0.5, b: float = 2.0): ...

    found = options_of(both)
    assert [str(option.accepts) for option in found.values()] == ["0 … 1", "any number"]
