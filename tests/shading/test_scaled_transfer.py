"""Radiance Scaling with shadows and bounces: the sums by hand, and what must not change."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import shading
from meshdepict.errors import MeshdepictError
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.material import HalfLambert, Lambert, LitSphere
from meshdepict.scene.view import View
from meshdepict.shading.enhancement import Enhancement
from meshdepict.shading.features import features
from meshdepict.shading.radiance_scaling import radiance_scaling, scaling
from meshdepict.transport.sky_cells import cell_directions

SIDE = (-1.0, 0.2, 0.3)
RAYS = {"shadows": True, "rays": 16}
PLAIN = {"material": "lambert", "magnitude": 4.0, **RAYS}


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(700)


@pytest.fixture
def space(torus):
    return md.scale_space(torus, scales=1)


def bends(space):
    eye = View((0, 0, 5), (0, 0, 0), (0, 1, 0), parallel_scale=1.3)
    frames = features(space, eye, curvature="object", scale=1, gain=None)
    return np.tanh(-(frames.ku + frames.kv))


def dense(transfer, mesh, kappa, gamma, alpha):
    """The scaled operator as a matrix, ray by ray."""
    count = len(transfer)
    matrix = np.zeros((count, count))
    for i in range(count):
        for k in range(transfer.hits[i], transfer.hits[i + 1]):
            corners = mesh.faces[transfer.triangle[k]]
            second, third = transfer.weights[k] / 65_535
            weights = np.array([1 - second - third, second, third])
            along = weights @ mesh.unit_points[corners] - mesh.unit_points[i]
            delta = along @ transfer.normals[i] / np.linalg.norm(along)
            factor = scaling(kappa[i], delta, invariant=alpha, magnitude=gamma)
            matrix[i, corners] += factor * weights / transfer.rays
    return matrix


@pytest.mark.parametrize("enhance", ["first", "all"])
@pytest.mark.parametrize("bounces", [1, 3])
def test_bounces_are_scaled_ray_by_ray(space, torus, enhance, bounces):
    gamma, alpha, light = 3.0, 0.3, Light(SIDE)
    kappa, transfer = bends(space), space.transport(16)
    assert np.abs(kappa).max() > 0.3
    cosine = np.maximum(space.normals_at(0) @ light.direction, 0) * space.seen_share(light)
    plain, scaled = (
        dense(transfer, torus, 0 * kappa, gamma, alpha),
        dense(transfer, torus, kappa, gamma, alpha),
    )
    direct = cosine * scaling(kappa, cosine, invariant=alpha, magnitude=gamma)
    inner, sent = (scaled, direct) if enhance == "all" else (plain, cosine)
    start = sent
    for _ in range(bounces - 1):
        sent = start + inner @ sent
    found = radiance_scaling(
        space, light, material=Lambert(), magnitude=gamma, invariant=alpha, bounces=bounces,
        enhance=enhance, **RAYS,
    )  # fmt: skip
    np.testing.assert_allclose(found, np.clip(direct + scaled @ sent, 0, 1), atol=2e-4)


def test_a_sky_is_scaled_ray_by_ray(space):
    kappa, transfer = bends(space), space.transport(16)
    pixels = np.random.default_rng(3).random((8, 16, 3)).astype(np.float32)
    environment = Environment(pixels)
    found = Enhancement(kappa, 4.0, 0.5).along(transfer).from_sky(environment)
    from meshdepict.transport.sky_cells import sky_colors

    colors, directions = sky_colors(environment, 16), cell_directions()
    for i in range(0, len(transfer), 29):
        cells = transfer.sky[transfer.misses[i] : transfer.misses[i + 1]]
        delta = np.clip(directions[cells] @ transfer.normals[i], 0, 1)
        factor = scaling(kappa[i], delta, invariant=0.5, magnitude=4.0)
        np.testing.assert_allclose(found[i], factor @ colors[cells] / 16, rtol=1e-4)


@pytest.mark.parametrize("enhance", ["first", "all"])
@pytest.mark.parametrize("light", [Light(SIDE), Light(SIDE, spread=20)])
def test_without_magnitude_it_is_phong_bit_for_bit(space, light, enhance):
    options = {"bounces": 2, **RAYS}
    found = radiance_scaling(space, light, magnitude=0, enhance=enhance, **options)
    np.testing.assert_array_equal(found, shading.phong(space, light, **options))


def test_a_half_lambertian_material_is_that_method(space):
    options = {"bounces": 2, **RAYS}
    found = radiance_scaling(space, SIDE, material=HalfLambert(), magnitude=0, **options)
    np.testing.assert_allclose(found, shading.half_lambert(space, SIDE, **options), atol=1e-6)


def test_scaling_is_told_apart_at_the_first_bounce_and_at_all(space):
    shown = {
        enhance: radiance_scaling(space, SIDE, bounces=3, enhance=enhance, **PLAIN)
        for enhance in ("first", "all")
    }
    assert np.abs(shown["first"] - shown["all"]).max() > 0.01
    once = [
        radiance_scaling(space, SIDE, bounces=0, enhance=enhance, **PLAIN)
        for enhance in ("first", "all")
    ]
    np.testing.assert_array_equal(*once)


def test_what_grows_with_every_bounce_stays_finite(space):
    found = radiance_scaling(
        space, SIDE, material="lambert", magnitude=1e30, bounces=200, enhance="all", **RAYS
    )
    assert np.isfinite(found).all()
    assert ((found >= 0) & (found <= 1)).all()


def test_some_samples_have_the_light_of_the_whole(space):
    some = np.arange(0, len(space.points), 5)
    whole = radiance_scaling(space, SIDE, bounces=2, **PLAIN)
    few = radiance_scaling(ChosenSamples(space, some), SIDE, bounces=2, **PLAIN)
    np.testing.assert_allclose(few, whole[some], atol=1e-6)


def test_refined_meshes_and_views_have_bounces_too(torus):
    baked = md.bake(
        torus, "radiance_scaling", light="northwest", bounces=1, rays=8, refine=20, width=0.1
    )
    assert len(baked.colors) >= len(torus.vertices)
    seen = radiance_scaling(md.scale_space(torus), SIDE, curvature="view", bounces=1, **PLAIN)
    assert ((seen >= 0) & (seen <= 1)).all()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"material": LitSphere()}, "LitSphere shows no lights that could cast shadows"),
        ({"illumination": "occlusion"}, "illumination='occlusion' has light from all around"),
        (
            {"curvature": "view", "enhance": "all"},
            "enhance='all' is of the surface's own curvature",
        ),
    ],
)
def test_what_has_no_shadows_and_no_bounces(space, options, sentence):
    for asked in ({"shadows": True}, {"bounces": 1}):
        with pytest.raises(MeshdepictError, match=sentence):
            radiance_scaling(space, SIDE, **options, **asked)


def test_pixels_have_shadows_but_no_scaled_bounces(torus):
    buffer = md.GBuffer.of(torus, View.fitted("front", torus), size=(60, 60))
    pixels = md.scale_space(buffer, scales=1)
    assert radiance_scaling(pixels, SIDE, shadows=True).max() > 0
    with pytest.raises(MeshdepictError, match="shade the mesh itself, or set bounces=0"):
        radiance_scaling(pixels, SIDE, bounces=1)
