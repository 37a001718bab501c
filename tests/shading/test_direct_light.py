"""Direct light: the compiled kernel against the plain formulas of its parts."""

import numpy as np
import pytest

from meshdepict import Environment, MeshdepictError, samples, scale_space, shading
from meshdepict.scene.light import Light
from meshdepict.scene.material import (
    AshikhminShirley,
    CookTorrance,
    HalfLambert,
    Lambert,
    Mirror,
    Phong,
    SubLambert,
    Toon,
    diffuse_term,
    reflected,
    specular_term,
    towards_visible,
)
from meshdepict.scene.names import as_lights, as_view
from meshdepict.shading.direct import direct
from meshdepict.shading.features import Frames, Scaling, eyes, features
from meshdepict.shading.light_warping import jacobian, unwarp, warp_scale
from meshdepict.shading.radiance_scaling import scaling

MATERIALS = [
    Lambert(0.8),
    HalfLambert(),
    SubLambert(0.4),
    Phong(),
    Phong(shininess=0),
    CookTorrance(),
    AshikhminShirley(),
    Toon(),
]


@pytest.fixture(scope="module")
def space():
    return scale_space(samples.golf_ball(1_500, dimples=12, depth=0.05), scales=2)


def plain(space, lights, eye, material, frames, warping, terms):
    """Σ ρ scaling L, light by light, in double precision."""
    n, e = space.normals[0].astype(float), eye.T.astype(float)
    axes = np.stack([frames.u, frames.v, frames.z], axis=1).astype(float)
    ku, kv = frames.ku.astype(float), frames.kv.astype(float)
    seen = towards_visible(n, e)
    total = np.zeros((len(n), 3))
    for light in lights:
        local = axes @ light.direction
        weight = np.ones(len(n))
        if warping:
            scale_u, scale_v = warp_scale(ku, warping), warp_scale(kv, warping)
            weight = jacobian(local, scale_u, scale_v) * (n @ light.direction > 0)
            local = unwarp(local, scale_u, scale_v)
        d = np.einsum("nij,ni->nj", axes, local)
        if warping:
            weight = weight * ((n * d).sum(axis=1) > 0)
        h = d + seen
        h /= np.linalg.norm(h, axis=1, keepdims=True)
        nl, nh = (n * d).sum(axis=1), (n * h).sum(axis=1)
        diffuse = {HalfLambert: (1 + nl) / 2, SubLambert: np.clip(nl, 0, 1) ** 0.4}
        delta = diffuse.get(type(material), nl)
        lobe = np.clip((reflected(n, seen) * d).sum(axis=1), 0, 1)
        shine = lobe**material.shininess if isinstance(material, Phong) else nh
        tensor = terms.anisotropy * (ku - kv) * (local[:, 0] ** 2 - local[:, 1] ** 2)
        kappa = np.tanh(-(ku + kv + tensor))
        factors = [
            scaling(kappa, x, invariant=terms.invariant, magnitude=m)
            for x, m in ((delta, terms.diffuse), (shine, terms.specular))
        ]
        value = diffuse_term(material, n, d, e) * factors[0]
        value = value + specular_term(material, n, d, e) * factors[1]
        total += (value * weight)[:, None] * light.color
    return total


@pytest.mark.parametrize("material", MATERIALS, ids=repr)
@pytest.mark.parametrize("warping", [0.0, 8.0, -3.0])
@pytest.mark.parametrize("anisotropy", [0.0, 0.7])
@pytest.mark.parametrize("view", ["isometric", "perspective"])
def test_the_kernel_is_the_sum_of_its_parts(space, rng, material, warping, anisotropy, view):
    eye = as_view(view, space.shape) if view == "isometric" else _perspective()
    towards = eyes(space, eye)
    frames = features(space, eye, curvature="object", scale=1, gain=None)
    directions = rng.normal(size=(7, 3))
    lights = [Light(d, color=rng.uniform(0, 1, 3)) for d in directions]
    terms = Scaling(3.0, 5.0, 0.4, anisotropy)
    found = direct(space, lights, towards, material, frames=frames, warping=warping, scaling=terms)
    expected = plain(space, lights, towards, material, frames, warping, terms)
    # A light on the very horizon may fall on either side of it in single precision.
    close = np.isclose(found, expected, rtol=2e-4, atol=1 / 1024).all(axis=1)
    assert close.mean() > 0.995


def _perspective():
    from meshdepict import View

    return View((2, 1, 4), (0, 0, 0), (0, 1, 0), field_of_view=40)


def test_gray_lights_give_one_channel_and_white_ones_the_sum(space):
    eye = eyes(space, as_view("front", space.shape))
    lights = as_lights(["north", "west"])
    together = direct(space, lights, eye, Phong())
    apart = sum(direct(space, [light], eye, Phong()) for light in lights)
    assert together.shape == (len(space.points),)
    np.testing.assert_allclose(together, apart, atol=1e-6)
    tinted = [Light(light.direction, color=(1, 0.5, 0)) for light in lights]
    np.testing.assert_allclose(direct(space, tinted, eye, Phong())[:, 1], together / 2, atol=1e-6)


@pytest.mark.parametrize("material", MATERIALS, ids=repr)
@pytest.mark.parametrize("warping", [0.0, 6.0])
def test_few_lights_by_arrays_are_many_by_the_kernel(space, rng, material, warping):
    eye = eyes(space, _perspective())
    frames = features(space, _perspective(), curvature="object", scale=1, gain=None)
    warped = {"frames": frames, "warping": warping}
    lights = [Light(d, color=rng.uniform(0, 1, 3)) for d in rng.normal(size=(6, 3))]
    by_arrays = sum(direct(space, [light], eye, material, **warped) for light in lights)
    by_kernel = direct(space, lights, eye, material, **warped)
    # Points whose light is on the horizon may fall on either side of it.
    close = np.isclose(by_kernel, by_arrays, rtol=2e-4, atol=1e-3)
    assert close.all(axis=1).mean() > 0.995


def test_lights_do_not_shine_on_a_mirror(space):
    eye = eyes(space, as_view("front", space.shape))
    with pytest.raises(MeshdepictError, match="don't shine on Mirror"):
        direct(space, as_lights("north"), eye, Mirror())


def test_lambert_under_an_environments_lights_is_its_irradiance(space, rng):
    environment = Environment(1 + rng.uniform(0, 1, (32, 64, 3)))
    lights = environment.lights(400)
    found = direct(space, lights, np.array([[0], [0], [1]], np.float32), Lambert())
    expected = environment.irradiance(space.normals[0]) / np.pi
    # 400 lights stand 10° apart; with hardly any variation the rest is their spacing at the rim.
    np.testing.assert_allclose(found, expected, rtol=0.03)


def test_frames_are_orthonormal_and_signed(space):
    eye = as_view("front", space.shape)
    for curvature in ("object", "view"):
        frames = features(space, eye, curvature=curvature, scale=1, gain=None)
        axes = np.stack([frames.u, frames.v, frames.z], axis=1).astype(float)
        products = axes @ axes.transpose(0, 2, 1) - np.eye(3)
        assert np.abs(products).max() < 1e-5
        assert isinstance(frames, Frames)
    sphere = scale_space(samples.sphere(500), scales=1)
    outside = features(sphere, eye, curvature="object", scale=1, gain=1)
    assert (outside.ku < 0).all()  # convex is negative here


def test_points_that_face_away_take_object_curvature(space):
    eye = as_view("front", space.shape)
    own = features(space, eye, curvature="object", scale=1, gain=0.7)
    seen = features(space, eye, curvature="view", scale=1, gain=None)
    behind = space.normals[1] @ eye.towards_eye < 0
    np.testing.assert_allclose(seen.ku[behind], own.ku[behind], rtol=1e-6)
    # Elsewhere z is the line of sight.
    np.testing.assert_allclose(seen.z[~behind] @ eye.towards_eye, 1, atol=1e-5)


def test_importance_chooses_the_scale(space):
    eye = as_view("front", space.shape)
    fine = features(space, eye, curvature="object", scale=1, gain=None)
    coarse = features(space, eye, curvature="object", scale=2, gain=None)
    share = np.zeros(len(space.points))
    share[::2] = 1
    mixed = features(space, eye, curvature="object", scale=1, gain=None, importance=share)
    np.testing.assert_array_equal(mixed.ku[::2], fine.ku[::2])
    np.testing.assert_array_equal(mixed.u[1::2], coarse.u[1::2])
    for wrong in (share[1:], share + 0.5, share * np.nan):
        with pytest.raises(MeshdepictError, match="importance must be"):
            features(space, eye, curvature="object", scale=1, gain=None, importance=wrong)


def test_spread_lights_are_even_and_several_kinds_are_told_apart():
    disc = Light((1, 2, 3), color=(2, 1, 0.5), spread=30).disc(100)
    np.testing.assert_allclose(sum(light.color for light in disc), (2, 1, 0.5))
    axis = np.array([1, 2, 3]) / np.sqrt(14)
    cosine = [light.direction @ axis for light in disc]
    assert min(cosine) >= np.cos(np.radians(30))
    # Even by solid angle: the mean cosine is half-way between the rim's and 1.
    assert np.mean(cosine) == pytest.approx((1 + np.cos(np.radians(30))) / 2, abs=1e-6)
    mean = np.mean([light.direction for light in disc], axis=0)
    assert mean / np.linalg.norm(mean) @ axis == pytest.approx(1, abs=1e-3)
    assert len(as_lights("north")) == len(as_lights((30, 40))) == len(as_lights((1, 2, 3))) == 1
    assert len(as_lights(np.eye(3))) == len(as_lights(["north", (30, 40), Light((1, 0, 0))])) == 3
    assert len(as_lights(Environment(np.ones((8, 16, 3))), count=5)) == 5
    assert len(as_lights([*disc, "north"])) == 101


def test_light_refusals():
    for wrong in (-1, 181, np.nan):
        with pytest.raises(MeshdepictError, match="half the opening of its disc"):
            Light((0, 0, 1), spread=wrong)
    for wrong in (0, 1.5, True):
        with pytest.raises(MeshdepictError, match="not a number of lights"):
            Light((0, 0, 1), spread=10).disc(wrong)
    for color in ((1, 2), (1, -1, 0), "red"):
        with pytest.raises(MeshdepictError, match="color must be three numbers"):
            Light((0, 0, 1), color=color)
    with pytest.raises(MeshdepictError, match="empty sequence of lights"):
        as_lights([])
    with pytest.raises(MeshdepictError, match="neither a name"):
        as_lights([[1.0, 2.0, 3.0, 4.0]])


def test_a_bake_under_several_lights_or_an_environment(tmp_path, space):
    import meshdepict as md

    several = md.bake(space, "phong", light=["north", (90, 20)])
    assert several.provenance["light"].count(";") == 1
    one = md.bake(
        space, "radiance_scaling", light=Environment(np.full((8, 16, 3), 0.5), name="white")
    )
    assert one.provenance["light"] == "white (16 x 8, up y)"
    assert one.intensity.shape == (len(space.points),)
    with pytest.raises(MeshdepictError, match="one light is needed here, not several"):
        md.bake(space, "lambert", light=["north", "east"])
    with pytest.raises(MeshdepictError, match=r"none\.hdr: cannot be read"):
        md.bake(space, "phong", light=str(tmp_path / "none.hdr"))


def test_a_bakes_view_and_material_reach_the_method(space):
    import meshdepict as md

    top = md.bake(space, "phong", light=(0, 1, 0), view="top").intensity
    np.testing.assert_array_equal(top, md.shading.phong(space, (0, 1, 0), view="top"))
    gloss = md.bake(space, "radiance_scaling", material=AshikhminShirley(shininess=9))
    assert "shininess=9" in gloss.provenance["options"]
    with pytest.raises(MeshdepictError, match="material=3 is not one of"):
        md.bake(space, "radiance_scaling", material=3)


def test_cook_torrance_is_radiance_scaling_s_material_without_scaling(ball):
    space = scale_space(ball, scales=1)
    plain = shading.cook_torrance(space, "northwest")
    scaled = shading.radiance_scaling(space, "northwest", material="cook_torrance", magnitude=0)
    # The kernel and the arrays round differently.
    np.testing.assert_allclose(plain, scaled, atol=1e-5)
