"""Foreshortening: the power of n·z in the view's curvature, in every method that shades by it."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import samples, scale_space, shading
from meshdepict.options import options_of
from meshdepict.scene.names import as_view
from meshdepict.scene.view import View
from meshdepict.shading import METHODS
from meshdepict.shading.light_warping import warp_scale
from meshdepict.shading.radiance_scaling import scaling
from meshdepict.viewer.live import LiveShading

SHADING = [
    name
    for name, function in METHODS.items()
    if {"curvature", "foreshortening"} <= set(options_of(function))
]
every_method = pytest.mark.parametrize("method", SHADING)

VIEW = View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=1.3)
PIXEL = 2 * 1.3 / VIEW.height_px

# What the curvature estimated on a sphere of 4,000 vertices may be off, relative.
ESTIMATED = 0.02


@pytest.fixture(scope="module")
def ball():
    mesh = samples.sphere(4_000)
    return scale_space(mesh, scales=1, width=mesh.edge_length / 10)


def trace_seen(ball, power):
    """−tr H of the unit sphere: 2 per radius without foreshortening, 1/z³ + 1/z with the first."""
    z = ball.points[:, 2]
    clear = z > 0.3  # no silhouette
    bend = {0: np.full(clear.sum(), 2.0), 1: z[clear] ** -3 + 1 / z[clear]}[power]
    return clear, PIXEL * bend


def test_the_methods_are_the_three_that_shade_by_curvature():
    assert set(SHADING) == {"light_warping", "radiance_scaling", "mean_curvature"}


@pytest.mark.parametrize("power", [0, 1])
def test_mean_curvature_of_a_sphere_has_both_limits(ball, power):
    clear, bend = trace_seen(ball, power)
    found = shading.mean_curvature(
        ball, None, view=VIEW, curvature="view", gain=100, foreshortening=power
    )
    expected = 0.5 * 2 ** np.tanh(100 * bend)
    np.testing.assert_allclose(found[clear], expected, rtol=ESTIMATED)


@pytest.mark.parametrize("power", [0, 1])
def test_radiance_scaling_of_a_sphere_has_both_limits(ball, power):
    clear, bend = trace_seen(ball, power)
    options = {"view": VIEW, "material": "lambert", "curvature": "view", "exposure": 0.2}
    found = shading.radiance_scaling(
        ball, "front", **options, gain=50, magnitude=2, foreshortening=power
    )
    cosine = ball.normals[0][clear, 2]
    expected = 0.2 * cosine * scaling(np.tanh(50 * bend), cosine, magnitude=2)
    np.testing.assert_allclose(found[clear], expected, rtol=ESTIMATED)


@pytest.mark.parametrize("power", [0, 1])
def test_light_warping_of_a_sphere_has_both_limits(ball, power):
    options = {
        "view": VIEW, "curvature": "view", "gain": 100, "foreshortening": power, "exposure": 0.1,
        "magnitude": 6.0,
    }  # fmt: skip
    plain, brighter = (
        shading.light_warping(ball, "front", **options, contrast=contrast) for contrast in (0, -1)
    )
    z = ball.points[:, 2]
    clear = (z > 0.3) & (plain > 1e-3)
    bends = (1, 1) if power == 0 else (z[clear] ** -3, 1 / z[clear])
    area = np.prod([warp_scale(-100 * PIXEL * b, 6.0) for b in np.broadcast_arrays(*bends)], axis=0)
    np.testing.assert_allclose(plain[clear] / brighter[clear], area, rtol=2 * ESTIMATED)


@every_method
def test_curvature_of_the_object_itself_has_none(method):
    space = scale_space(samples.golf_ball(600, dimples=12, depth=0.05), scales=1)
    one, other = (
        METHODS[method](space, "northwest", curvature="object", foreshortening=f) for f in (1, 0.4)
    )
    np.testing.assert_array_equal(one, other)


@every_method
def test_pixels_take_it_too(method):
    mesh = samples.golf_ball(3_000, dimples=12, depth=0.05)
    space = scale_space(md.GBuffer.of(mesh, as_view("front", mesh), size=(80, 80)), scales=1)
    first, again, other = (
        METHODS[method](space, "northwest", curvature="view", **power)
        for power in ({}, {"foreshortening": 1.0}, {"foreshortening": 0.0})
    )
    np.testing.assert_array_equal(first, again)
    assert np.abs(other - first).max() > 0.01


@pytest.mark.parametrize("method", ["light_warping", "radiance_scaling"])
def test_a_live_picture_passes_over_the_vertices_again_only_where_it_counts(method, monkeypatch):
    space = scale_space(samples.golf_ball(600, dimples=12, depth=0.05), scales=1)
    live = LiveShading(space, method, options={"curvature": "object"}, view="front")
    passes = []
    upload = live._upload
    monkeypatch.setattr(live, "_upload", lambda *found: passes.append(1) or upload(*found))
    live.set_options(foreshortening=0.4)
    assert not passes
    live.set_options(curvature="view")
    live.set_options(foreshortening=0.5)
    assert len(passes) == 2
