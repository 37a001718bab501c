"""Highlights of skies that are hidden in part, and of light that bounced: limits; what is kept."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.files import limits
from meshdepict.scene.environment import Environment
from meshdepict.scene.material import AshikhminShirley, CookTorrance, Phong
from meshdepict.scene.view import View
from meshdepict.shading import cook_torrance, phong, radiance_scaling
from meshdepict.shading.direct import kernel_parameters
from meshdepict.shading.features import eyes
from meshdepict.shading.hidden_lobes import hidden_lobes
from meshdepict.shading.lobes import lobe_samples, lobes
from meshdepict.transport import paths

EYE = View((0, -4, 3), (0, 0, 0), (0, 1, 0), parallel_scale=1.3)
GLOSS = [CookTorrance(0.3, 0.5, 0.2), AshikhminShirley(0.3, 0.4, 80), Phong(0, 0.3, 0.5, 40)]
glossy = pytest.mark.parametrize("material", GLOSS, ids=lambda one: type(one).__name__)


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(2_000)


@pytest.fixture
def space(torus):
    return md.scale_space(torus, scales=1)


@pytest.fixture(scope="module")
def sky():
    return Environment(np.random.default_rng(8).uniform(0, 0.6, (16, 32, 3)).astype(np.float32))


def white(brightness=1.0):
    return Environment(np.full((16, 32, 3), brightness, np.float32))


def inward(count=2_000):
    outside = md.samples.sphere(count)
    return md.Mesh(outside.vertices, outside.faces[:, ::-1], winding="keep")


def found(space, material, environments, sent=None, count=64):
    """Highlights, hidden; and what the lobes would show of a white sky."""
    kind, parameters = kernel_parameters(material)
    eye = eyes(space, EYE)

    def sampled(environment):
        return lobe_samples(space.planes_of((0,)), eye, environment, kind, parameters, count=count)

    hidden = hidden_lobes(
        space, environments, sampled, sent=sent, question=(kind, parameters, count, eye)
    )
    return hidden, lobes(
        space.planes_of((0,)), eye, white(), kind, parameters, count=count
    )[:, 0]  # fmt: skip


# --- limits -----------------------------------------------------------------------------------


@glossy
def test_on_a_convex_object_highlights_are_what_they_were(sphere, sky, material):
    space = md.scale_space(sphere, scales=0)
    kind, parameters = kernel_parameters(material)
    hidden, _ = found(space, material, [sky])
    plain = lobes(space.planes_of((0,)), eyes(space, EYE), sky, kind, parameters, count=64)
    # Seen steeply enough none of a lobe lies below the horizon, where Phong's has light, too.
    facing = np.abs(sphere.normals @ EYE.towards_eye) > 0.6
    np.testing.assert_allclose(hidden[facing], plain[facing], atol=2e-3)


@glossy
def test_in_a_closed_hollow_no_highlight_of_the_sky_is_left(material):
    space = md.scale_space(inward(), scales=0)
    hidden, plain = found(space, material, [white()])
    assert plain.min() > 0.01
    assert not hidden.any()


@glossy
def test_there_highlights_are_of_what_the_walls_send(material, rng):
    space = md.scale_space(inward(), scales=0)
    colors = rng.uniform(0, 1, 3).astype(np.float32)
    sent = np.broadcast_to(colors, (len(space.points), 3))
    hidden, plain = found(space, material, [], sent)
    facing = np.abs(space.normals_at(0) @ EYE.towards_eye.astype(np.float32)) > 0.6
    np.testing.assert_allclose(
        hidden[facing], (plain[:, None] * colors)[facing], rtol=1e-3, atol=1e-5
    )


@glossy
def test_light_that_is_even_everywhere_does_not_tell_what_is_hidden(space, material):
    """Where the surface sends as much as the sky it does not matter what a sample meets."""
    hidden, plain = found(space, material, [white()], np.ones(len(space.points), np.float32))
    facing = np.abs(space.normals_at(0) @ EYE.towards_eye.astype(np.float32)) > 0.6
    np.testing.assert_allclose(hidden[facing], plain[facing], rtol=1e-3, atol=1e-5)


def test_highlights_of_a_sky_vanish_in_a_deep_hole():
    """A shaft, closed below: deep inside only a small disc of the sky is left, straight up."""
    angle, depth = np.meshgrid(np.linspace(0, 2 * np.pi, 48, endpoint=False), np.linspace(0, 6, 40))
    wall = np.stack([np.cos(angle), np.sin(angle), -depth], axis=-1).reshape(-1, 3)
    at = np.arange(48 * 40).reshape(40, 48)
    a, b = at[:-1], np.roll(at, -1, axis=1)[:-1]
    c, d = np.roll(at, -1, axis=1)[1:], at[1:]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    floor = np.stack([at[-1], np.roll(at[-1], -1), np.full(48, 48 * 40)], axis=1)
    shaft = md.Mesh(np.vstack([wall, [[0, 0, -6]]]), np.vstack([faces, floor]), winding="keep")
    inside = shaft.normals[48 * 20] @ [-np.cos(0), 0, 0]
    assert inside > 0.9  # walls face the axis
    space = md.scale_space(shaft, scales=0)
    options = {"view": View((1, 0, 9), (0, 0, -3), (0, 1, 0), parallel_scale=3), "diffuse": 0.0}
    shown = cook_torrance(space, white(), **options, roughness=0.3, reflectance=0.5, shadows=True)
    plain = cook_torrance(space, white(), **options, roughness=0.3, reflectance=0.5)
    rows = shown[:-1].reshape(40, 48).mean(axis=1)
    before = plain[:-1].reshape(40, 48).mean(axis=1)
    assert rows[20:38].max() < 0.1 * before[20:38].min()
    # The floor sees the sky within 9° of straight up, and the eye is 5° off.
    narrow = {**options, "roughness": 0.03, "reflectance": 0.5}
    floors = [cook_torrance(space, white(), **narrow, shadows=each)[-1] for each in (False, True)]
    np.testing.assert_allclose(*floors, rtol=0.05)
    assert floors[0] > 0.1


def test_what_bounces_has_highlights(space):
    matt = {"shadows": True, "bounces": 2, "rays": 32, "view": EYE, "ambient": 0.0, "diffuse": 0.5}
    light = (-1.0, 0.2, 0.3)
    plain = phong(space, light, **matt, specular=0.0)
    shiny = phong(space, light, **matt, specular=0.5)
    once = phong(space, light, **{**matt, "bounces": 0}, specular=0.5)
    alone = phong(space, light, **{**matt, "bounces": 0}, specular=0.0)
    gloss = shiny - plain - (once - alone)
    lit = (shiny < 1) & (once < 1)
    assert gloss[lit].min() > -1e-6
    assert (gloss[lit] > 1e-3).mean() > 0.05
    few = radiance_scaling(
        space, light, **{k: v for k, v in matt.items() if k not in ("ambient", "diffuse")},
        material=Phong(0, 0.5, 0.5, 20), magnitude=0,
    )  # fmt: skip
    np.testing.assert_allclose(few, shiny, atol=1e-5)


# --- what is kept -----------------------------------------------------------------------------


@pytest.fixture
def followed(monkeypatch):
    """How many rays were followed, call by call."""
    calls = []
    real = paths.mirrored_paths
    monkeypatch.setattr(
        paths, "mirrored_paths", lambda *a, **k: calls.append(len(a[1])) or real(*a, **k)
    )
    return calls


def test_a_new_light_follows_no_ray_and_a_new_view_does(space, sky, followed):
    options = {"shadows": True, "bounces": 1, "rays": 16, "lights": 16}
    first = cook_torrance(space, sky, view=EYE, **options)
    assert followed
    rays = sum(followed)
    assert rays > 2_000
    followed.clear()
    other = cook_torrance(space, white(0.3), view=EYE, **options)
    cook_torrance(space, (0, 0, 1), view=EYE, **options)
    assert not followed
    again = cook_torrance(md.scale_space(space.shape, scales=1), white(0.3), view=EYE, **options)
    np.testing.assert_array_equal(again, other)
    followed.clear()
    cook_torrance(space, sky, view="front", **options)
    assert followed
    np.testing.assert_array_equal(cook_torrance(space, sky, view=EYE, **options), first)


def test_what_memory_does_not_hold_is_asked_again_with_the_same_result(space, sky, followed):
    options = {"view": EYE, "shadows": True, "rays": 16, "lights": 16}
    kept = cook_torrance(space, sky, **options)
    fresh = md.scale_space(space.shape, scales=1)
    limits.set_max_memory(2**19)
    try:
        followed.clear()
        first = cook_torrance(fresh, sky, **options)
        count = len(followed)
        second = cook_torrance(fresh, sky, **options)
    finally:
        limits.set_max_memory(None)
    assert len(followed) == 2 * count > 0
    np.testing.assert_array_equal(first, kept)
    np.testing.assert_array_equal(second, kept)


def test_without_shadows_and_bounces_no_sample_is_asked(space, sky, followed):
    cook_torrance(space, sky, view=EYE)
    phong(space, [sky, (0, 0, 1)], view=EYE, specular=0.9, shininess=300)
    phong(space, (0, 0, 1), view=EYE, shadows=True)
    assert not followed
