"""Radiance Scaling on meshes: its terms, its precomputed light, and its limits."""

import warnings

import numpy as np
import pytest

import meshdepict as md
from meshdepict import Environment, MeshdepictError, View, samples, scale_space, shading
from meshdepict.scene.light import Light
from meshdepict.scene.material import (
    AshikhminShirley,
    LitSphere,
    Mirror,
    Phong,
    Refractive,
    Toon,
    specular_term,
    towards_visible,
)
from meshdepict.shading.radiance_scaling import scaling

GRAYS = ["lambert", "half_lambert", "sub_lambert", "phong", "cook_torrance", "ashikhmin_shirley"]


@pytest.fixture(scope="module")
def space():
    return scale_space(samples.golf_ball(3_000, dimples=42, depth=0.05), scales=2)


@pytest.fixture(scope="module")
def ball_space():
    return scale_space(samples.sphere(3_000), scales=1)


@pytest.fixture(scope="module")
def light():
    pixels = np.random.default_rng(5).uniform(0, 1, (16, 32, 3)) ** 2
    return Environment(pixels)


def kappa(space, gain=0.7, scale=1):
    own = space.curvature(scale)
    return np.tanh(gain * space.widths[scale] * (own.k1 + own.k2))


def test_phong_is_the_formula_term_by_term(space):
    light = Light((-1, 1, 1)).direction
    found = shading.radiance_scaling(
        space, light, magnitude=3, invariant=0.3, exposure=0.2, ambient_magnitude=1,
        specular_magnitude=2, material=Phong(0.1, 0.5, 0.3, 12),
    )  # fmt: skip
    n, e = space.normals[0].astype(float), np.array([0, 0, 1.0])
    k, d = kappa(space), np.clip(n @ light, 0, 1)
    e = e - 2 * np.minimum(n @ e, 0)[:, None] * n
    r = 2 * (n * e).sum(axis=1)[:, None] * n - e
    s = np.clip(r @ light, 0, 1) ** 12
    expected = (
        0.1 * np.exp(1 * k)
        + 0.5 * d * scaling(k, d, invariant=0.3, magnitude=3)
        + 0.3 * s * scaling(k, s, invariant=0.3, magnitude=2)
    )
    np.testing.assert_allclose(found, np.clip(0.2 * expected, 0, 1), atol=2e-5)


@pytest.mark.parametrize("material", [Phong(0, 0, 0.3, 60), AshikhminShirley(0, 0.3, 60)], ids=repr)
@pytest.mark.parametrize("magnitude", [4.0, 20.0, 50.0])
def test_what_is_faint_is_judged_after_scaling(space, material, magnitude):
    """In hollows δ · scaling is near 1 down to δ = e^−γ: a power that looks like nothing."""
    light, gain = Light((-1, 1, 1)).direction, 10.0
    found = shading.radiance_scaling(
        space, light, material=material, magnitude=magnitude, gain=gain, exposure=0.1
    )
    n, k = space.normals[0].astype(float), kappa(space, gain)
    e = np.broadcast_to([0, 0, 1.0], n.shape)
    term = specular_term(material, n, light, e)
    if isinstance(material, Phong):
        delta = term / material.specular
    else:
        h = light + towards_visible(n, e)
        delta = np.einsum("ij,ij->i", n, h / np.linalg.norm(h, axis=1, keepdims=True))
    expected = 0.1 * term * scaling(k, delta, magnitude=magnitude)
    # The steepest slope of δ · scaling over ln δ is γ/4 or so, and ln δ is 60 ln cos: single
    # precision leaves 60 · 1e-7 · γ.
    np.testing.assert_allclose(found, np.clip(expected, 0, 1), atol=1e-4, rtol=3e-5 * magnitude)
    if isinstance(material, Phong) and magnitude > 20:
        assert ((term < np.exp(-20)) & (expected > 0.01)).any()


@pytest.mark.parametrize("material", GRAYS)
@pytest.mark.parametrize("curvature", ["object", "view"])
def test_without_magnitude_or_gain_it_is_plain_rendering(space, material, curvature):
    settings = {"material": material, "curvature": curvature}
    plain = shading.radiance_scaling(space, "northwest", magnitude=0, **settings)
    flat = shading.radiance_scaling(space, "northwest", gain=0, **settings)
    # Without magnitude it goes by arrays, without gain through the kernel: single precision twice.
    np.testing.assert_allclose(plain, flat, atol=4e-6)
    if material in ("lambert", "phong"):
        other = getattr(shading, material)(space, "northwest")
        np.testing.assert_allclose(plain, other, atol=1e-6)
    if material == "half_lambert":
        np.testing.assert_allclose(plain, shading.half_lambert(space, "northwest"), atol=1e-6)


def test_convexities_are_bright_and_concavities_dark(space):
    facing = shading.lambert(space, "front") > 0.8
    change = shading.radiance_scaling(space, "front", material="lambert", exposure=0.3) - (
        0.3 * shading.lambert(space, "front")
    )
    k = kappa(space)
    assert change[facing & (k > 0.02)].min() > 0
    assert (facing & (k < -0.02)).any()
    assert change[facing & (k < -0.02)].max() < 0


def test_anisotropy_is_nothing_on_a_sphere_and_something_on_a_cylinder(ball_space):
    isotropic = shading.radiance_scaling(ball_space, "northwest", material="lambert")
    slanted = shading.radiance_scaling(ball_space, "northwest", material="lambert", anisotropy=1)
    np.testing.assert_allclose(slanted, isotropic, atol=0.01)
    torus = scale_space(samples.torus(2_000), scales=1)
    kinds = [shading.radiance_scaling(torus, "north", anisotropy=a, gain=3) for a in (-1, 0, 1)]
    assert np.abs(kinds[0] - kinds[1]).max() > 0.05
    assert np.abs(kinds[2] - kinds[1]).max() > 0.05


def test_irradiance_times_occlusion(space, light):
    found = shading.radiance_scaling(
        space, light, material="lambert", illumination="irradiance", rays=16, exposure=0.1
    )
    irradiance = light.irradiance(space.normals[0])
    luminance = irradiance @ [0.2126, 0.7152, 0.0722]
    delta = luminance / light.largest_irradiance
    factor = scaling(kappa(space), np.clip(delta, 0, 1)) * space.occlusion(16) / np.pi
    np.testing.assert_allclose(found, 0.1 * irradiance * factor[:, None], rtol=2e-4)
    alone = shading.radiance_scaling(space, light, illumination="occlusion", rays=16)
    a = space.occlusion(16)
    np.testing.assert_allclose(alone, np.clip(a * scaling(kappa(space), a), 0, 1), rtol=1e-4)


@pytest.mark.parametrize("material", [Mirror(), Mirror(0.3), Refractive()], ids=repr)
def test_mirrors_show_the_environment_scaled(space, light, material):
    plain = shading.radiance_scaling(space, light, material=material, magnitude=0)
    n, e = space.normals[0].astype(float), np.array([0, 0, 1.0])
    front = n @ e > 0.05
    if isinstance(material, Mirror):
        looks = 2 * (n @ e)[:, None] * n - e
        expected = light.lookup(looks, blur=material.roughness)
        np.testing.assert_allclose(plain[front], expected[front], atol=2e-4)
    scaled = shading.radiance_scaling(space, light, material=material)
    delta = plain @ np.array([0.2126, 0.7152, 0.0722]) / light.brightest
    factor = scaling(kappa(space), delta)[:, None]
    np.testing.assert_allclose(scaled, np.clip(plain * factor, 0, 1), atol=1e-4)


def test_lit_spheres_one_and_two(space):
    from meshdepict.color.srgb import linear_to_srgb

    plain = shading.radiance_scaling(space, "north", material="lit_sphere", magnitude=0)
    np.testing.assert_allclose(linear_to_srgb(plain), shading.lit_sphere(space, "north"), atol=1e-5)
    two = shading.radiance_scaling(
        space, "north", material=LitSphere("clay", "metal"), magnitude=0, gain=50
    )
    metal = shading.radiance_scaling(space, "north", material=LitSphere("metal"), magnitude=0)
    k = kappa(space, 50)
    np.testing.assert_allclose(two[k > 0.41], plain[k > 0.41], atol=1e-6)
    np.testing.assert_allclose(two[k < -0.41], metal[k < -0.41], atol=1e-6)


def test_toon_quantises_what_was_scaled(space):
    scaled = shading.radiance_scaling(space, "northwest", material="lambert", exposure=0.8)
    toon = shading.radiance_scaling(space, "northwest", material=Toon(5, 9), exposure=0.8)
    expected = md.scene.material.soft_steps(scaled, bins=5, sharpness=9)
    np.testing.assert_allclose(toon, expected, atol=1e-5)
    fewer = shading.radiance_scaling(space, "northwest", material="toon", bins=2)
    same = shading.radiance_scaling(space, "northwest", material=Toon(bins=2))
    np.testing.assert_array_equal(fewer, same)


def test_together_with_light_warping(space, light):
    both = shading.radiance_scaling(space, light, material="lambert", warping=4, magnitude=0)
    warped = shading.light_warping(space, light, magnitude=4)
    np.testing.assert_allclose(both, warped, atol=1e-6)


def test_mean_curvature_is_its_ambient_case(space):
    ambient = shading.radiance_scaling(
        space, "north", material=Phong(0.5, 0, 0), magnitude=np.log(2), gain=2.8
    )
    found = shading.mean_curvature(space, "north")
    np.testing.assert_allclose(found, ambient, atol=1e-6)
    np.testing.assert_allclose(found, 0.5 * 2 ** kappa(space, 2.8), rtol=1e-4)
    flat = shading.mean_curvature(space, "north", gain=0)
    np.testing.assert_array_equal(flat, np.float32(0.5))


@pytest.mark.parametrize("material", GRAYS)
@pytest.mark.parametrize("curvature", ["object", "view"])
@pytest.mark.parametrize(
    "extreme",
    [
        {"magnitude": 1e4},
        {"magnitude": 1e30, "gain": 1e30, "anisotropy": 1},
        {"invariant": 0.0},
        {"invariant": 1.0, "magnitude": 1e4},
        {"warping": 1e30},
        {"warping": -1e30, "gain": 1e30, "anisotropy": -1},
        {"exposure": 1e6},
    ],
    ids=repr,
)
def test_finite_at_extremes_and_special_lights(space, material, curvature, extreme):
    n = space.normals[0]
    specials = [n[0], -n[0], n[7], (0, 0, 1), (0, 0, -1), (1, 0, 0), (0, 1e-9, 1)]
    for direction in specials:
        found = shading.radiance_scaling(
            space, direction, material=material, curvature=curvature, **extreme
        )
        assert found.dtype == np.float32
        assert np.isfinite(found).all()
        assert found.min() >= 0
        assert found.max() <= 1


@pytest.mark.parametrize("material", GRAYS)
def test_colours_are_continuous_in_the_light(space, material):
    # The steepest material is Ashikhmin and Shirley's lobe, of slope below (n + 1)/8·√n ≈ 45 per
    # radian of the half vector at grazing angles: 0.1° moves no vertex by more than 0.08.
    before = shading.radiance_scaling(space, (40, 30), material=material)
    after = shading.radiance_scaling(space, (40.1, 30), material=material)
    bound = 0.08 if material in ("ashikhmin_shirley", "cook_torrance") else 0.03
    if material == "sub_lambert":  # (n·l)^½ is vertical at the terminator: √0.00175 there
        bound = 0.06
    assert np.abs(after - before).max() < bound


def test_refusals(space):
    with pytest.raises(MeshdepictError, match="Mirror shows an environment"):
        shading.radiance_scaling(space, "north", material="mirror")
    with pytest.raises(MeshdepictError, match="irradiance shows an environment"):
        shading.radiance_scaling(space, "north", illumination="irradiance")
    with pytest.raises(MeshdepictError, match="scale=3 is not one of"):
        shading.radiance_scaling(space, "north", scale=3)
    with pytest.raises(MeshdepictError, match="Lambert has no shininess"):
        shading.radiance_scaling(space, "north", material="lambert", shininess=3)
    with pytest.raises(MeshdepictError, match="material='fong' is not one of"):
        shading.radiance_scaling(space, "north", material="fong")
    shiny = shading.radiance_scaling(space, "north", material=AshikhminShirley(shininess=7))
    same = shading.radiance_scaling(space, "north", material="ashikhmin_shirley", shininess=7)
    np.testing.assert_array_equal(shiny, same)


def test_it_is_finite_on_real_meshes(data):
    for path in sorted((data / "mesh").glob("*.ply"), key=lambda p: p.stat().st_size)[:5]:
        with warnings.catch_warnings():  # about windings that were turned
            warnings.simplefilter("ignore", md.MeshdepictWarning)
            real = scale_space(md.read(path), scales=1)
        for curvature in ("object", "view"):
            found = shading.radiance_scaling(real, "northwest", curvature=curvature)
            assert np.isfinite(found).all()
            assert np.isfinite(shading.light_warping(real, "north", curvature=curvature)).all()


@pytest.mark.parametrize("curvature", ["object", "view"])
@pytest.mark.parametrize("name", ["radiance_scaling", "light_warping", "mean_curvature", "phong"])
def test_turning_and_scaling_everything_together_changes_nothing(space, rng, name, curvature):
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    view = View((3, 2, 6), (0, 0, 0), (0, 1, 0), parallel_scale=1.1)
    size = 7.0
    other_view = View(
        size * turn @ view.position, (0, 0, 0), turn @ view.up, parallel_scale=1.1 * size
    )
    mesh = md.Mesh(size * space.shape.vertices @ turn.T, space.shape.faces)
    other = scale_space(mesh, scales=2, width=size * space.widths[1])
    light = Light((-1, 2, 2)).direction
    settings = {} if name == "phong" else {"curvature": curvature}
    before = getattr(shading, name)(space, light, view=view, **settings)
    after = getattr(shading, name)(other, turn @ light, view=other_view, **settings)
    # Smoothed normals are within their tolerance of 1e-4, which magnitudes and curvature enlarge;
    # a light on the horizon of a point may fall on either side of it.
    assert (np.abs(before - after) < 5e-3).mean() > 0.995
    assert np.abs(before - after).mean() < 5e-4
