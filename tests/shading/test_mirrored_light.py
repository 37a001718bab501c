"""Mirrors in which a surface shows itself: limits, what scales on the way, and what is refused."""

from itertools import pairwise

import numpy as np
import pytest

import meshdepict as md
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scene.environment import Environment
from meshdepict.scene.material import LitSphere, Mirror, reflected, towards_visible
from meshdepict.scene.view import View
from meshdepict.shading import radiance_scaling
from meshdepict.shading.features import convexity
from meshdepict.shading.mirrored_light import Matt, lobe_height, mirrored_light
from meshdepict.transport import paths as transport_paths
from meshdepict.transport.paths import mirrored_paths, starting
from meshdepict.transport.rays import lifted
from meshdepict.transport.walls import between

EYE = View((0, -4, 3), (0, 0, 0), (0, 1, 0), parallel_scale=1.3)
PLAIN = {"material": "mirror", "magnitude": 0.0, "view": EYE}


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(3_000)


@pytest.fixture
def space(torus):
    return md.scale_space(torus, scales=1)


@pytest.fixture(scope="module")
def sky():
    return Environment(np.random.default_rng(8).uniform(0, 0.9, (16, 32, 3)).astype(np.float32))


def white(brightness=0.5):
    return Environment(np.full((16, 32, 3), brightness, np.float32))


def looks(space):
    normals = space.normals_at(0)
    return reflected(normals, towards_visible(normals, EYE.towards_eye.astype(np.float32)))


def seen_again(space):
    """The samples whose mirrors show a mirror, and where."""
    mesh, own = space.surface, space.normals_at(0)
    directions = looks(space).astype(np.float32)
    starts = starting(mesh.unit_points, lifted(mesh.unit_points, own), directions)
    paths = mirrored_paths(mesh, starts, directions, normals=own, bounces=1)
    return paths.mirrored[0]


@pytest.mark.parametrize("roughness", [0.0, 0.2])
def test_without_bounces_and_shadows_a_mirror_is_what_it_was(space, sky, roughness, monkeypatch):
    monkeypatch.setattr(transport_paths, "mirrored_paths", None)
    found = radiance_scaling(space, sky, **PLAIN, roughness=roughness, shadows=False, bounces=0)
    expected = sky.lookup(looks(space), blur=roughness)
    np.testing.assert_array_equal(found, expected)


def test_a_convex_mirror_is_what_it_was(sphere, sky):
    space = md.scale_space(sphere, scales=1)
    plain = radiance_scaling(space, sky, **PLAIN)
    for options in ({"bounces": 3}, {"shadows": True}, {"shadows": True, "bounces": 1}):
        np.testing.assert_allclose(
            radiance_scaling(space, sky, **PLAIN, **options), plain, atol=1e-6
        )


def test_rays_of_a_rough_convex_mirror_are_the_blur_that_it_was(sphere):
    row, column = np.mgrid[:64, :128] / 64 * np.pi
    waves = 0.4 + 0.3 * np.sin(5 * row) * np.sin(4 * column) + 0.1 * np.cos(row)
    sky = Environment(np.repeat(waves[..., None], 3, axis=2))
    space = md.scale_space(sphere, scales=1)
    for roughness in (0.05, 0.3):
        options = {**PLAIN, "roughness": roughness}
        plain = radiance_scaling(space, sky, **options)
        facing = np.abs(sphere.normals @ EYE.towards_eye) > 0.8  # the lobe is above the horizon
        for rays in (64, 512):
            found = radiance_scaling(space, sky, **options, bounces=2, rays=rays)
            error = np.sqrt(np.mean((found - plain)[facing] ** 2))
            assert error < 0.01  # two and a half of 255 tones, of a sky that is all noise


def test_a_lobe_ends_somewhere_however_its_rays_are_shifted():
    for width in (1e-6, 0.01, 0.3, 1.5):
        share = np.array([0, 0.5, 1 - 2**-24, 1], np.float32)
        found = lobe_height(share, width)
        assert (np.diff(found) <= 0).all()
        assert ((found >= -1) & (found <= 1)).all()
        assert found[0] == 1
        # Half of a narrow lobe is within σ √(2 ln 2).
        assert width > 0.1 or found[1] == pytest.approx(1 - width**2 * np.log(2), rel=1e-12)


def test_even_light_stays_as_bright_in_any_number_of_mirrors(space):
    for roughness in (0.0, 0.3):
        for bounces in (1, 2, 6):
            found = radiance_scaling(
                space, white(), **PLAIN, bounces=bounces, roughness=roughness, rays=8
            )
            np.testing.assert_allclose(found, 0.5, atol=1e-5)


def test_shadows_hide_what_is_not_mirrored_on_and_more_bounces_show_more(space):
    shown = [
        radiance_scaling(space, white(), **PLAIN, bounces=k, shadows=True) for k in (0, 1, 2, 8)
    ]
    for fewer, more in pairwise(shown):
        assert (more >= fewer - 1e-6).all()
    inner = seen_again(space).ray
    assert 20 < len(inner) < space.count / 2
    assert not shown[0][inner].any()
    np.testing.assert_allclose(np.delete(shown[0], inner, axis=0), 0.5, atol=1e-6)
    np.testing.assert_allclose(shown[-1].mean(), 0.5, atol=5e-3)


def test_a_mirror_shows_what_is_matt_beside_it(space, sky):
    """All of the torus is matt: what a mirror there would show is what its vertices send."""
    mesh = space.surface
    sent = mesh.unit_points.astype(np.float32)  # linear: exact between vertices
    found = mirrored_light(
        space, sky, looks(space), roughness=0.0, shadows=False, bounces=1, rays=64,
        matt=Matt(np.zeros(len(mesh.faces), bool), sent),
    )  # fmt: skip
    met = seen_again(space)
    towards = found[met.ray] - sent[met.ray]
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    far = np.linalg.norm(found[met.ray] - sent[met.ray], axis=1) > 0.05
    # What is seen lies where the mirror looks; starts are a hundred-thousandth off.
    np.testing.assert_allclose(towards[far], looks(space)[met.ray][far], atol=2e-3)
    others = np.setdiff1d(np.arange(space.count), met.ray)
    np.testing.assert_allclose(found[others], sky.lookup(looks(space)[others]), atol=1e-6)


def test_every_mirror_on_the_way_scales_if_all_are_to(space):
    options = {**PLAIN, "magnitude": 2.0, "exposure": 0.01, "bounces": 1}
    first, every = (
        radiance_scaling(space, white(1.0), **options, enhance=enhance)
        for enhance in ("first", "all")
    )
    kappa = convexity(space, EYE, curvature="object", scale=1, gain=None, foreshortening=1.0)
    met = seen_again(space)
    bend = between(kappa, space.surface.faces[met.triangle], met.weights)
    # Under even light δ is 1, and scaling e^γκ; on hollows the next mirror's δ is then below 1.
    bumps = bend > 0
    assert bumps.sum() > 20
    ratio = every[met.ray] / first[met.ray]
    np.testing.assert_allclose(ratio[bumps, 0], np.exp(2 * bend[bumps]), rtol=1e-4)
    others = np.setdiff1d(np.arange(space.count), met.ray)
    np.testing.assert_array_equal(every[others], first[others])


def test_without_magnitude_all_mirrors_are_as_the_first(space, sky):
    found = [
        radiance_scaling(space, sky, **PLAIN, bounces=3, enhance=each) for each in ("first", "all")
    ]
    np.testing.assert_array_equal(*found)


def test_what_mirrors_scale_again_and_again_stays_finite(space, sky):
    options = {**PLAIN, "magnitude": 1e30, "bounces": 30, "enhance": "all"}
    found = radiance_scaling(space, sky, **options)
    assert ((found >= 0) & (found <= 1)).all()


def test_samples_of_every_kind_have_mirrors_that_show_the_surface(torus, space, sky):
    options = {**PLAIN, "bounces": 2}
    whole = radiance_scaling(space, sky, **options)
    some = np.arange(0, space.count, 7)
    few = radiance_scaling(ChosenSamples(space, some), sky, **options)
    np.testing.assert_allclose(few, whole[some], atol=1e-5)
    buffer = md.GBuffer.of(torus, EYE, size=(80, 80))
    pixels = radiance_scaling(md.scale_space(buffer, scales=1), sky, **options)
    plain = radiance_scaling(md.scale_space(buffer, scales=1), sky, **PLAIN)
    changed = np.abs(pixels - plain).max(axis=1) > 1e-3
    assert 0.02 < changed.mean() < 0.6


def test_where_a_mesh_lies_and_how_large_it_is_changes_nothing(torus, sky):
    shown = []
    for factor, move in ((1.0, 0.0), (1e-9, 0.0), (2.0**20, 2.0**40)):
        mesh = md.Mesh(torus.vertices * factor + move, torus.faces)
        shown.append(radiance_scaling(md.scale_space(mesh, scales=0), sky, **PLAIN, bounces=2))
    np.testing.assert_allclose(shown[1], shown[0], atol=1e-4)
    # Far away vertices are rounded to a sixteen-thousandth, and so are the normals.
    assert np.median(np.abs(shown[2] - shown[0])) < 1e-3


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"material": LitSphere()}, "LitSphere shows no lights that could cast shadows"),
        ({"material": Mirror(), "illumination": "occlusion"}, "illumination='occlusion' has light"),
    ],
)
def test_what_shows_no_surroundings_has_none_hidden(space, options, sentence):
    with pytest.raises(md.MeshdepictError, match=sentence):
        radiance_scaling(space, white(), **options, bounces=1)
