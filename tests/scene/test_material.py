"""Materials: reciprocity, energy, limits, and the soft steps of toon shading."""

import numpy as np
import pytest

from meshdepict import MeshdepictError
from meshdepict.scene.material import (
    MATERIALS,
    AshikhminShirley,
    CookTorrance,
    HalfLambert,
    Lambert,
    Mirror,
    Phong,
    Refractive,
    SubLambert,
    Toon,
    ambient_term,
    as_material,
    diffuse_term,
    reflected,
    refracted,
    soft_steps,
    specular_term,
    towards_visible,
)

UP = np.array([0.0, 0.0, 1.0])
PHYSICAL = [
    Lambert(),
    CookTorrance(),
    CookTorrance(diffuse=1, reflectance=0.04, roughness=0.1),
    CookTorrance(diffuse=1, reflectance=1, roughness=0.6),
    AshikhminShirley(),
    AshikhminShirley(diffuse=1, reflectance=0.05, shininess=1000),
    AshikhminShirley(diffuse=0, reflectance=1, shininess=10),
]


def hemisphere(rng, count):
    """Cosine-weighted directions about z."""
    radius, angle = np.sqrt(rng.uniform(size=count)), rng.uniform(0, 2 * np.pi, count)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    return np.stack([x, y, np.sqrt(np.maximum(1 - radius**2, 1e-12))], axis=1)


def both(material, normal, light, eye):
    return diffuse_term(material, normal, light, eye) + specular_term(material, normal, light, eye)


@pytest.mark.parametrize("material", PHYSICAL, ids=repr)
def test_reciprocity(rng, material):
    light, eye = hemisphere(rng, 300), hemisphere(rng, 300)
    there = both(material, UP, light, eye) / light[:, 2]
    back = both(material, UP, eye, light) / eye[:, 2]
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("material", PHYSICAL, ids=repr)
@pytest.mark.parametrize("elevation", [5, 20, 45, 70, 90])
def test_no_more_light_leaves_than_comes(material, elevation):
    # ∫ρ⟨n·l⟩dl over a fine grid of the hemisphere. Beyond the specular peak's resolution (half a
    # degree against lobes of some degrees) the midpoint rule errs by less than 1 %.
    theta = (np.arange(360) + 0.5) * np.pi / 720
    azimuth = (np.arange(720) + 0.5) * np.pi / 360
    t, a = np.meshgrid(theta, azimuth, indexing="ij")
    light = np.stack([np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t)], axis=-1)
    angle = np.radians(elevation)
    eye = np.array([np.cos(angle), 0, np.sin(angle)])
    weights = np.sin(t) * (np.pi / 720) * (np.pi / 360)
    albedo = (both(material, UP, light, eye) * weights).sum() / np.pi
    assert 0 < albedo <= 1.01
    if material == Lambert():
        assert albedo == pytest.approx(1, abs=1e-4)


def test_phong_is_the_textbooks(rng):
    normal, light, eye = (hemisphere(rng, 200) for _ in range(3))
    seen = (normal * eye).sum(axis=1) > 0
    mirror = 2 * (normal * eye).sum(axis=1)[:, None] * normal - eye
    along = np.maximum((mirror * light).sum(axis=1), 0)
    material = Phong(diffuse=0.6, specular=0.3, shininess=12)
    specular = specular_term(material, normal, light, eye)
    np.testing.assert_allclose(specular[seen], (0.3 * along**12)[seen])
    cosine = np.maximum((normal * light).sum(axis=1), 0)
    np.testing.assert_allclose(diffuse_term(material, normal, light, eye), 0.6 * cosine)
    assert ambient_term(material) == 0.1
    assert ambient_term(Lambert()) == 0


def test_diffuse_kinds_at_known_angles():
    light = np.array([[0, 0, 1.0], [np.sqrt(0.75), 0, 0.5], [0, 0, -1.0]])
    for material, expected in (
        (Lambert(0.5), [0.5, 0.25, 0]),
        (HalfLambert(), [1, 0.75, 0]),
        (SubLambert(0.5), [1, np.sqrt(0.5), 0]),
        (SubLambert(0), [1, 1, 0]),
        (Toon(), [1, 0.5, 0]),
        (Mirror(), [0, 0, 0]),
    ):
        np.testing.assert_allclose(diffuse_term(material, UP, light, UP), expected, atol=1e-12)
        assert not specular_term(material, UP, light, UP).any()


@pytest.mark.parametrize("name", sorted(set(MATERIALS) - {"lit_sphere", "mirror", "refractive"}))
def test_terms_are_finite_at_every_extreme(name):
    edge = [UP, -UP, [1, 0, 0], [-1, 0, 0], [1, 0, 1e-8], [-1, 0, -1e-8], [0.6, 0, 0.8]]
    edge = np.array(edge) / np.linalg.norm(edge, axis=1, keepdims=True)
    light, eye = edge[:, None], edge[None]
    for dtype in (np.float32, np.float64):
        for term in (diffuse_term, specular_term):
            value = term(
                as_material(name), UP.astype(dtype), light.astype(dtype), eye.astype(dtype)
            )
            assert np.isfinite(value).all()
            assert (value >= 0).all()


@pytest.mark.parametrize("material", [Phong(), CookTorrance(), AshikhminShirley()], ids=repr)
def test_a_point_seen_from_behind_is_shaded_for_the_mirrored_eye(rng, material):
    light, eye = hemisphere(rng, 50), hemisphere(rng, 50)
    behind = eye * [1, 1, -1]
    np.testing.assert_allclose(both(material, UP, light, behind), both(material, UP, light, eye))
    np.testing.assert_allclose(towards_visible(UP, behind), eye)
    np.testing.assert_array_equal(towards_visible(UP, eye), eye)


def test_reflection_and_refraction(rng):
    normal, eye = hemisphere(rng, 100), hemisphere(rng, 100)
    cosine = (normal * eye).sum(axis=1)
    r = reflected(normal, eye)
    np.testing.assert_allclose((r * normal).sum(axis=1), cosine)
    np.testing.assert_allclose(np.linalg.norm(r, axis=1), 1)
    normal, eye, cosine = normal[cosine > 0], eye[cosine > 0], cosine[cosine > 0]
    t = refracted(normal, eye, refraction=1.5)
    np.testing.assert_allclose(np.linalg.norm(t, axis=1), 1)
    into = -(t * normal).sum(axis=1)
    np.testing.assert_allclose(np.sqrt(1 - into**2) * 1.5, np.sqrt(1 - cosine**2), atol=1e-7)
    np.testing.assert_allclose(refracted(normal, eye, refraction=1.0), -eye, atol=1e-7)


@pytest.mark.parametrize("bins", [1, 3, 8, 10])
@pytest.mark.parametrize("sharpness", [0.01, 3, 14, 200])
def test_soft_steps(bins, sharpness):
    x = np.linspace(0, 1, 20_001)
    q = soft_steps(x, bins=bins, sharpness=sharpness)
    assert q[0] == 0
    assert q[-1] == 1
    assert (np.diff(q) >= -1e-15).all()
    # The steepest slope, φ/(2 tanh(φ/2)), bounds the change from sample to sample: no jumps.
    assert np.diff(q).max() <= sharpness / (2 * np.tanh(sharpness / 2)) / 20_000 * 1.001
    # The edges between bins stay, and small φ is the identity.
    edges = np.arange(bins + 1) / bins
    np.testing.assert_allclose(soft_steps(edges, bins=bins, sharpness=sharpness), edges, atol=1e-12)
    if sharpness == 0.01:
        np.testing.assert_allclose(q, x, atol=1e-5)
    assert soft_steps(x.astype(np.float32), bins=bins, sharpness=sharpness).dtype == np.float32


def test_names_and_refusals():
    assert as_material("phong") == Phong()
    assert as_material(Refractive(1.3)).refraction == 1.3
    for wrong in ("fong", 3):
        with pytest.raises(MeshdepictError, match="no material is called"):
            as_material(wrong)
    with pytest.raises(MeshdepictError, match="CookTorrance: roughness=0"):
        CookTorrance(roughness=0)
    with pytest.raises(MeshdepictError, match=r"Toon: bins=2\.5 is not a whole number"):
        Toon(bins=2.5)
