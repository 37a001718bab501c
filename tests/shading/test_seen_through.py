"""Transmitted light without borders, and the background that a surface lets through."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import Environment, MeshdepictError, samples, scale_space
from meshdepict.shading import light_alignment
from meshdepict.shading.seen_through import background_light, transmitted_guides
from meshdepict.shading.transmission import facet_density, fresnel, refracted, rough_transmission
from meshdepict.viewer.live import LiveShading

EYE = np.array([[0], [0], [1.0]])
ETA = 1.5
BEHIND = md.Light((-0.4, 0.3, -0.85)).direction
CLEAR = {"diffuse": 0.0, "transmitted": 0.0, "background": 1.0}


@pytest.fixture(scope="module")
def sky():
    pixels = np.random.default_rng(3).uniform(0, 1, (16, 32, 3))
    return Environment(pixels)


@pytest.fixture(scope="module")
def space():
    return scale_space(samples.golf_ball(3_000, dimples=42, depth=0.05), scales=4, ratio=1.7)


def arc(count, across=0.0):
    """Unit normals (3, count) along a circle over a sphere, from rim to rim."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, count)
    x, z = np.sin(angle), np.cos(angle)
    return np.stack([x * np.cos(across), x * np.sin(across), z])


# --- the model ------------------------------------------------------------------------------


@pytest.mark.parametrize("roughness", [0.05, 0.3, 0.7, 1.0])
def test_facets_cover_the_surface_once_and_none_stands_upright(roughness):
    cosine = (np.arange(200_000) + 0.5) / 200_000
    density = facet_density(cosine, roughness**2)
    assert 2 * np.pi * (density * cosine).mean() == pytest.approx(1, abs=1e-5)
    assert facet_density(np.array(0.0), roughness**2) == 0
    peak = (1 + roughness**2) / (np.pi * roughness**2)
    assert facet_density(np.array(1.0), roughness**2) == pytest.approx(peak)
    # Otherwise it is GGX less its density at a right angle, made up to the same whole.
    ggx = roughness**2 / (np.pi * (cosine**2 * (roughness**2 - 1) + 1) ** 2)
    if roughness < 1:
        made_up = (ggx - roughness**2 / np.pi) / (1 - roughness**2)
        np.testing.assert_allclose(density, made_up, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("across", [0.0, 0.7, 2.2])
@pytest.mark.parametrize("roughness", [0.1, 0.25, 1.0])
def test_no_border_runs_over_a_sphere(across, roughness):
    """Where samples lie twice as close the largest step halves; a border's would stay."""
    steps = []
    for count in (20_000, 40_000):
        shown = rough_transmission(
            arc(count, across), EYE, BEHIND[:, None], refraction=ETA, roughness=roughness
        )
        assert shown.min() < 1e-6 < 1e-3 < shown.max()  # from lit to where no facet lights
        steps.append(np.abs(np.diff(shown)).max() / shown.max())
    assert steps[1] < 0.55 * steps[0]
    assert steps[1] < 1e-3


# --- the guides -----------------------------------------------------------------------------


def test_a_scale_that_faces_the_eye_has_the_refracted_view_for_its_guide():
    normals = np.stack([arc(200, 0.3), arc(200, 0.5)]).astype(np.float32)
    facing = (normals * EYE).sum(axis=1).min(axis=0) > 0.2
    guides = transmitted_guides(normals, EYE.astype(np.float32), ETA)
    for normal, guide in zip(normals, guides, strict=True):
        expected = refracted(normal, EYE.astype(np.float32), 1 / ETA)
        np.testing.assert_allclose(guide[:, facing], expected[:, facing], atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(guides, axis=1), 1, atol=1e-6)


def test_a_scale_that_turns_away_is_skipped():
    fine = arc(50)
    away = np.stack([fine, np.broadcast_to([[0.6], [0], [-0.8]], fine.shape)]).astype(np.float32)
    guides = transmitted_guides(away, EYE.astype(np.float32), ETA)
    np.testing.assert_allclose(guides[1], guides[0], atol=1e-6)


@pytest.mark.parametrize("refraction", [1.0, 1.5, 10.0])
def test_guides_go_on_over_a_coarse_silhouette(refraction):
    steps = []
    for count in (4_000, 8_000):
        turn = np.linspace(-1.2, 1.2, count)  # of the coarse normal, over its silhouette
        coarse = np.stack([np.cos(turn), 0 * turn, np.sin(turn)])
        fine = np.broadcast_to([[0.6], [0], [0.8]], coarse.shape)
        guides = transmitted_guides(
            np.stack([fine, coarse]).astype(np.float32), EYE.astype(np.float32), refraction
        )
        assert np.isfinite(guides).all()
        np.testing.assert_allclose(np.linalg.norm(guides, axis=1), 1, atol=1e-5)
        steps.append(np.abs(np.diff(guides[1])).max())
    # At the refraction of 1 there is nothing to turn: rounding alone.
    assert steps[1] < max(0.55 * steps[0], 1e-6)


# --- the background -------------------------------------------------------------------------


def test_glass_of_no_refraction_is_not_there(space, sky):
    """Every point that faces the eye shows the one pixel behind it, and nothing else."""
    found = light_alignment(space, sky, **CLEAR, refraction=1.0, frosting=0.01)
    front = space.normals[0][:, 2] > 0.01
    behind = np.broadcast_to(sky.lookup([[0, 0, -1]]), found[front].shape)
    # Directions in single precision, pixels 0.2 rad wide, up to 1 brighter than their neighbours.
    np.testing.assert_allclose(found[front], behind, atol=1e-5)


def test_the_background_is_refracted_and_dimmed_by_what_is_reflected(sky):
    normals = arc(60, 0.4).astype(np.float32)
    found = background_light(normals, EYE.astype(np.float32), sky, refraction=ETA, frosting=0.2)
    through = refracted(normals, EYE.astype(np.float32), 1 / ETA)
    share = 1 - fresnel(np.clip(normals[2], 0, 1), ETA)
    # A facet that leans by α bends the view by α − α/η.
    expected = share[:, None] * sky.lookup(through.T, blur=0.2 * (1 - 1 / ETA))
    inner = normals[2] > 1e-3
    np.testing.assert_allclose(found[inner], expected[inner], atol=1e-5)


def test_other_lights_have_white_behind_them(space):
    found = light_alignment(space, "northwest", **CLEAR)
    cosine = np.abs(space.normals[0][:, 2].astype(float))
    np.testing.assert_allclose(found, 1 - fresnel(cosine, ETA), atol=1e-4)
    assert found.max() == pytest.approx(0.96, abs=1e-3)  # 4 % of a pane's light is reflected


def test_the_background_adds_up_with_the_rest_and_is_left_alone_by_strengths(space, sky):
    dim = {"exposure": 0.2, "material": "phong", "transmitted": 0.5, "lights": 4}
    plain, over = (light_alignment(space, sky, **dim, background=b) for b in (0.0, 0.7))
    behind = light_alignment(space, sky, **CLEAR, exposure=0.2 * 0.7)
    both = plain + behind
    np.testing.assert_allclose(over[both < 0.99], both[both < 0.99], atol=2e-6)
    turned = light_alignment(space, sky, **CLEAR, strength=0.9, transmitted_strength=0.9)
    np.testing.assert_array_equal(turned, light_alignment(space, sky, **CLEAR))


def test_a_background_is_baked_and_not_live(space, sky):
    baked = md.bake(space, "light_alignment", light=sky, **CLEAR)
    np.testing.assert_array_equal(
        baked.intensity, light_alignment(space, sky, view=baked.view, **CLEAR)
    )
    with pytest.raises(MeshdepictError, match=r"background=0.5, only with 0.0; bake it instead"):
        LiveShading(space, "light_alignment", options={"background": 0.5}, view="front")
