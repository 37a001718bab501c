"""Light Warping on meshes: eq. 1 against eq. 2, eq. 3, mirrors, occlusion, and its limits."""

import numpy as np
import pytest

from meshdepict import Environment, MeshdepictError, samples, scale_space, shading
from meshdepict.scene.light import Light
from meshdepict.scene.material import Mirror, Refractive, Toon, soft_steps
from meshdepict.scene.names import as_view
from meshdepict.shading.features import features
from meshdepict.shading.light_warping import warp, warp_scale

MATERIALS = ["lambert", "sub_lambert", "phong", "cook_torrance", "ashikhmin_shirley", "toon"]


@pytest.fixture(scope="module")
def space():
    return scale_space(samples.golf_ball(1_500, dimples=12, depth=0.08), scales=2)


@pytest.fixture(scope="module")
def environment():
    """A bright window, a lamp and a floor, all soft."""
    d = Environment(np.ones((64, 128, 3)))._directions
    window = np.exp(8 * (d @ (np.array([-1, 1, 1]) / np.sqrt(3)) - 1))[..., None] * [3, 2.5, 2]
    lamp = np.exp(20 * (d @ np.array([0.8, 0, 0.6]) - 1))[..., None] * [1, 2, 3]
    return Environment(0.1 + window + lamp)


def scales(space, magnitude, curvature="object"):
    frames = features(space, as_view("front", space.shape), curvature=curvature, scale=1, gain=None)
    return frames, warp_scale(frames.ku, magnitude), warp_scale(frames.kv, magnitude)


@pytest.mark.parametrize("material", MATERIALS)
def test_magnitude_zero_is_plain_rendering(space, environment, material):
    for light in ("northwest", environment):
        plain = shading.light_warping(space, light, material=material, magnitude=0)
        scaled = shading.radiance_scaling(space, light, material=material, magnitude=0)
        if material != "phong":  # whose ambient light depends on nothing here
            np.testing.assert_allclose(plain, scaled, atol=1e-6)
    lit = shading.light_warping(space, "northwest", magnitude=0)
    np.testing.assert_allclose(lit, shading.lambert(space, "northwest"), atol=1e-6)


@pytest.mark.parametrize("curvature", ["object", "view"])
@pytest.mark.parametrize("up", ["y", "z"])
def test_both_equations_agree_as_lights_grow(space, environment, curvature, up):
    light = Environment(environment.pixels, up=up)
    errors = []
    for count in (64, 512, 4096):
        one, two = (
            shading.light_warping(
                space, light, quadrature=q, lights=count, curvature=curvature, exposure=0.3
            )
            for q in ("directions", "lights")
        )
        errors.append(np.abs(one - two).mean())
    assert errors[0] > errors[1] > errors[2]
    assert errors[-1] < 0.003


def test_contrast_is_eq_3(space):
    plain = shading.light_warping(space, "front", magnitude=6, exposure=0.1)
    _, u, v = scales(space, 6)
    for contrast in (-1, 0.5, 1):
        found = shading.light_warping(space, "front", magnitude=6, contrast=contrast, exposure=0.1)
        np.testing.assert_allclose(found, plain * (u * v) ** contrast, rtol=1e-4)
    convex = u * v < 0.98
    brighter = shading.light_warping(space, "front", magnitude=6, contrast=-1, exposure=0.1)
    assert (brighter[convex & (plain > 0)] > plain[convex & (plain > 0)]).all()


def test_a_mirror_looks_along_the_warped_reflection(space, environment):
    found = shading.light_warping(space, environment, material=Mirror(), magnitude=6, exposure=0.2)
    frames, u, v = scales(space, 6)
    n = space.normals[0].astype(float)
    front = n[:, 2] > 0.05
    r = 2 * n[:, 2:] * n - [0, 0, 1]
    axes = np.stack([frames.u, frames.v, frames.z], axis=1).astype(float)
    bent = np.einsum("nij,ni->nj", axes, warp(np.einsum("nij,nj->ni", axes, r), u, v))
    expected = np.clip(0.2 * environment.lookup(bent), 0, 1)
    np.testing.assert_allclose(found[front], expected[front], atol=1e-4)
    glass = shading.light_warping(space, environment, material=Refractive(1.0), magnitude=0)
    through = np.broadcast_to(environment.lookup([[0, 0, -1]]), glass[front].shape)
    np.testing.assert_allclose(glass[front], through, atol=1e-4)


def test_toon_quantises_the_result(space, environment):
    plain = shading.light_warping(space, "northwest")
    toon = shading.light_warping(space, "northwest", material=Toon(4, 8))
    np.testing.assert_allclose(toon, soft_steps(plain, bins=4, sharpness=8), atol=1e-5)


def test_occlusion_is_ambient_occlusion_where_nothing_is_warped():
    # A cup: the inside sees only part of the sky.
    torus = scale_space(samples.torus(1_500), scales=1)
    plain = shading.light_warping(torus, "north", illumination="occlusion", magnitude=0, rays=128)
    # Both have 128 rays of their own: 1/√128 would be pure noise, lattices do better.
    np.testing.assert_allclose(plain, torus.occlusion(512), atol=0.06)
    assert np.abs(plain - torus.occlusion(512)).mean() < 0.015
    warped = shading.light_warping(torus, "north", illumination="occlusion", rays=64)
    assert np.abs(warped - plain).max() > 0.05
    again = shading.light_warping(torus, "north", illumination="occlusion", rays=64)
    np.testing.assert_array_equal(warped, again)


def test_importance_chooses_between_scales(space):
    everywhere = np.ones(len(space.points))
    for share, scale in ((everywhere, 1), (0 * everywhere, 2)):
        found = shading.light_warping(space, "northwest", importance=share)
        np.testing.assert_array_equal(found, shading.light_warping(space, "northwest", scale=scale))


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("curvature", ["object", "view"])
@pytest.mark.parametrize("magnitude", [1e30, -1e30, 1e4, 1e-30])
def test_finite_at_extremes_and_special_lights(space, material, curvature, magnitude):
    n = space.normals[0]
    for direction in (n[0], -n[0], (0, 0, 1), (0, 0, -1), (1, 0, 0), (1e-9, 0, -1)):
        found = shading.light_warping(
            space, direction, material=material, curvature=curvature, magnitude=magnitude,
            contrast=-1,
        )  # fmt: skip
        assert found.dtype == np.float32
        assert np.isfinite(found).all()
        assert found.min() >= 0
        assert found.max() <= 1


def test_turning_a_light_moves_colours_within_the_bound(space):
    disc = Light((0.3, 0.5, 0.8), spread=40).disc(54)
    angle = np.radians(0.1)
    turn = np.array(
        [[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    turned = [Light(turn @ light.direction, color=light.color) for light in disc]
    before, after = (shading.light_warping(space, lights) for lights in (disc, turned))
    # A light that sets takes at most ⟨n·W⁻¹⟩J ≤ 9/8 of its share along (λ_u = √3 towards it, λ_v
    # its inverse); two of 54 may set at once. The rest is Lambert's own change, at most J·√3 an
    # angle.
    assert np.abs(after - before).max() < 2 * 1.2 / 54 + 9 * angle


def test_refusals(space):
    for material in ("half_lambert", "lit_sphere"):
        with pytest.raises(MeshdepictError, match="has no light that could be warped"):
            shading.light_warping(space, "north", material=material)
    with pytest.raises(MeshdepictError, match="quadrature='directions' shows an environment"):
        shading.light_warping(space, "north", quadrature="directions")
    with pytest.raises(MeshdepictError, match="magnitude=nan"):
        shading.light_warping(space, "north", magnitude=float("nan"))
