"""Lights that stand together: where they are, how they turn, and how they are written down."""

import copy
import pickle

import numpy as np
import pytest
from conftest import rotation

import meshdepict as md
from meshdepict import samples, shading
from meshdepict.color import linear_to_srgb
from meshdepict.scene.light import Light
from meshdepict.scene.names import as_light, as_lighting, as_lights
from meshdepict.scene.rig import RIGS, Rig
from meshdepict.scene.view import View

every_rig = pytest.mark.parametrize("name", RIGS)


@pytest.fixture(scope="module")
def globe():
    return md.scale_space(samples.sphere(2_500), scales=0)


@every_rig
def test_a_rig_stands_in_the_frame_of_the_view(name, rng):
    turn = rotation(rng)
    view = View(5 * turn[2], (0, 0, 0), turn[1], parallel_scale=1)
    rig = as_lighting(name, view)
    np.testing.assert_allclose(rig.frame, view.frame, atol=1e-15)
    front = as_lighting(name)
    for seen, plain in zip(rig, front, strict=True):
        np.testing.assert_allclose(view.frame @ seen.direction, plain.direction, atol=1e-12)
        np.testing.assert_array_equal(seen.color, plain.color)
    for one, other in zip(as_lights(name, view), rig, strict=True):
        np.testing.assert_array_equal(one.direction, other.direction)
    np.testing.assert_allclose(rig.lamps[0].direction, as_light("northwest", view).direction)


@every_rig
def test_no_place_on_a_sphere_is_burnt_out_and_hardly_any_black(name, globe):
    shown = linear_to_srgb(
        sum(one.color[0] * shading.lambert(globe, one) for one in as_lights(name))
    )
    assert shown.max() < 1
    assert (shown < 8 / 255).mean() < 0.03
    lambert = linear_to_srgb(shading.lambert(globe, "northwest"))
    assert (lambert < 8 / 255).mean() > 0.45  # what one light leaves black


@every_rig
def test_a_rig_turns_as_a_whole(name, rng):
    rig, turn = as_lighting(name), rotation(rng)
    there = rig.turned(turn)
    for one, other in zip(there, rig, strict=True):
        np.testing.assert_allclose(one.direction, turn @ other.direction, atol=1e-12)
    for wanted in (*rng.normal(size=(5, 3)), *np.eye(3), -rig.lamps[0].direction):
        aimed = rig.aimed(Light(wanted))
        np.testing.assert_allclose(aimed.lamps[0].direction, Light(wanted).direction, atol=1e-7)
        np.testing.assert_allclose(aimed.frame @ aimed.frame.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(aimed.frame) == pytest.approx(1)


@every_rig
def test_a_rig_is_made_again_from_its_words(name, rng):
    rig = Rig(name, rotation(rng))
    for again in (Rig.of(rig.words()), pickle.loads(pickle.dumps(rig)), copy.copy(rig)):
        assert again.name == name
        for one, other in zip(again, rig, strict=True):
            np.testing.assert_allclose(one.direction, other.direction, atol=1e-12)
    assert str(rig).startswith(f"{name} (up ")


def test_light_warping_under_the_studio_is_as_smooth_as_under_many_lights():
    space = md.scale_space(samples.golf_ball(4_000), scales=1)
    few = linear_to_srgb(shading.light_warping(space, "studio"))
    lamps = [
        ((-1, 1, 1), 25, 900, 0.82), ((1, 0.1, 0.4), 50, 300, 0.06), ((0.3, 0.6, -1), 50, 300, 0.18)
    ]  # fmt: skip
    crowd = [
        one
        for direction, radius, count, bright in lamps
        for one in Light(direction, color=np.full(3, bright), spread=radius).disc(count)
    ]
    many = linear_to_srgb(shading.light_warping(space, crowd))
    assert np.sqrt(np.mean((few - many) ** 2)) < 2 / 255


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"name": "studjo", "up": (0, 1, 0), "eye": (0, 0, 1)}, "did you mean 'studio'"),
        ({"name": 3, "up": (0, 1, 0), "eye": (0, 0, 1)}, "no lights are called 3"),
        ({"name": "studio"}, "have a name, an up and an eye"),
        ({"name": "studio", "up": (0, 1), "eye": (0, 0, 1)}, "are three numbers each"),
        ({"name": "studio", "up": (0, 0, 1), "eye": (0, 0, 1)}, "up across the eye of lights"),
        ({"name": "studio", "up": (0, 1, 0), "eye": (0, 0, 0)}, "the eye of lights must be"),
    ],
)
def test_wrong_words_are_refused(words, message):
    with pytest.raises(md.MeshdepictError, match=message):
        Rig.of(words)


@every_rig
def test_where_one_light_is_needed_a_rig_is_refused(name, globe):
    with pytest.raises(md.MeshdepictError, match="one light is needed here, not several"):
        as_light(name)
    with pytest.raises(md.MeshdepictError, match="one light is needed here, not several"):
        md.bake(globe, "lambert", light=name)
