"""Rough transmission: Snell's law, Fresnel's reflection, and energy."""

import numpy as np
import pytest

from meshdepict.shading.transmission import fresnel, refracted, rough_transmission

UP = np.array([0.0, 0.0, 1.0])[:, None]


def at(angle):
    """Unit vectors (3, n) at angles from +z, in the plane of x and z."""
    angle = np.atleast_1d(angle)
    return np.stack([np.sin(angle), 0 * angle, np.cos(angle)])


def test_refraction_follows_snells_law():
    angle = np.radians(np.linspace(0, 89, 30))
    for ratio in (1.0, 1 / 1.5, 0.5):
        through = refracted(UP, at(angle), ratio)
        np.testing.assert_allclose(np.linalg.norm(through, axis=0), 1)
        np.testing.assert_allclose(-through[0], ratio * np.sin(angle), atol=1e-12)
        assert (through[2] < 0).all()


def test_no_refraction_from_behind_or_at_total_reflection():
    assert not refracted(UP, at(np.radians([90.1, 120, 180])), 0.7).any()
    critical = np.arcsin(1 / 1.5)
    through = refracted(UP, at([critical - 0.01, critical + 0.01]), 1.5)
    np.testing.assert_allclose(np.linalg.norm(through, axis=0), [1, 0])


def test_fresnel_limits():
    assert fresnel(np.array(1.0), 1.5) == pytest.approx(0.04)
    assert fresnel(np.array(0.0), 1.5) == pytest.approx(1)
    np.testing.assert_array_equal(fresnel(np.array([0.0, 0.5, 1.0]), 1.0), 0)


def test_a_rough_pane_lets_through_no_more_than_arrives():
    # f_t |n·l| integrated over the lights behind, for an eye at 30°: the share that is not
    # reflected, but for what Smith's shadowing loses. Radiance in the denser medium is η² denser.
    theta, phi = np.meshgrid(
        (np.arange(400) + 0.5) / 400 * np.pi / 2, (np.arange(400) + 0.5) / 400 * 2 * np.pi
    )
    light = np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), -np.cos(theta)]
    ).reshape(3, -1)
    solid = np.sin(theta).ravel() * (np.pi / 2 / 400) * (2 * np.pi / 400)
    for refraction, roughness in ((1.2, 0.2), (1.5, 0.3), (1.5, 0.5)):
        eye = at(np.radians(30.0))
        f = rough_transmission(UP, eye, light, refraction=refraction, roughness=roughness)
        let_through = float((f * solid).sum()) * refraction**2
        smooth = float(1 - fresnel(np.cos(np.radians(30.0)), refraction))
        assert 0.8 * smooth < let_through <= smooth * 1.01


def test_the_lobe_peaks_along_the_refracted_view():
    eye = at(np.radians(20.0))
    light = at(np.radians(np.linspace(95, 265, 3401)))
    f = rough_transmission(UP, eye, light, refraction=1.4, roughness=0.05)
    peak = light[:, f.argmax()]
    assert peak @ refracted(UP, eye, 1 / 1.4)[:, 0] > np.cos(np.radians(2))


@pytest.mark.parametrize("refraction", [1.0, 1.5, 10.0])
@pytest.mark.parametrize("roughness", [0.01, 1.0])
def test_finite_everywhere(refraction, roughness):
    angle = np.radians(np.linspace(0, 360, 37))
    for eye in at(angle).T.astype(np.float32):
        f = rough_transmission(
            UP.astype(np.float32), eye[:, None], at(angle).astype(np.float32),
            refraction=refraction, roughness=roughness,
        )  # fmt: skip
        assert np.isfinite(f).all()
        assert (f >= 0).all()
        assert not f[at(angle)[2] > 0].any()
