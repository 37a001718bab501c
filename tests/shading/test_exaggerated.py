"""Exaggerated Shading: the compiled sum against equations 3 to 5 written out, and their limits."""

import numpy as np
import pytest

from meshdepict import samples, scale_space, threads
from meshdepict.errors import MeshdepictError
from meshdepict.shading import exaggerated
from meshdepict.shading.bands import SINGULAR_LIGHT, band_weights
from meshdepict.shading.exaggerated import local_light, soft_toon

DEFAULT = 15.0  # exaggeration
ROUNDING = 2.0**-24  # of single precision
AXES = np.vstack([np.eye(3), -np.eye(3)])


@pytest.fixture(scope="module")
def space(ball):
    return scale_space(ball, scales=5)


@pytest.fixture(scope="module")
def relief():
    """A nearly flat relief: under a frontal light every smoothed normal is close to the light."""
    return scale_space(samples.radiating_ridges(4_000, hill=0.001, relief=0.004), scales=5)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def paper(space, light, **options):
    """The equations as the paper has them: one exaggeration, and the base coat as it is."""
    return exaggerated(space, light, **{"exaggeration": DEFAULT, **options})


def lights_for(space, rng, count=20):
    """Any lights, those along axes, and those along some smoothed normals, either way."""
    some = space.normals[1:].reshape(-1, 3)[rng.integers(0, len(space.points), count)]
    return unit(np.vstack([rng.normal(size=(count, 3)), AXES, some, -some]).astype(float))


def written_out(space, light, exaggeration=DEFAULT, emphasis=-0.5, contrast=1.0):
    """Equations 3 to 5 in double precision."""
    normals = space.normals.astype(float)
    k = band_weights(space.widths, space.ratio, emphasis=emphasis, contrast=contrast)
    cosines = np.einsum("sni,sni->sn", normals[:-1], local_light(light, normals[1:]))
    detail = k[:-1] @ soft_toon(cosines, exaggeration)
    return np.clip(0.5 + 0.5 * (k[-1] * (normals[-1] @ light) + detail), 0, 1)


def length_of_local_light(space, light):
    """(scales, n) lengths of the projected light of eq. 4, before normalisation."""
    normals = space.normals[1:].astype(float)
    return np.linalg.norm(light - normals * (normals @ light)[..., None], axis=-1)


def rounding_bound(space, light, exaggeration=DEFAULT, emphasis=-0.5, contrast=1.0):
    """How far single precision may be off at each sample.

    Light, cosine and projected light carry some ten roundings, their product with the finer normal
    as many again. Dividing by the projected light's length (at least ε) magnifies them, and so does
    the exaggeration.
    """
    k = band_weights(space.widths, space.ratio, emphasis=emphasis, contrast=contrast)
    length = np.hypot(length_of_local_light(space, light), SINGULAR_LIGHT)
    detail = 24 * ROUNDING * exaggeration / length
    return 0.5 * (k[:-1] @ detail) + 20 * ROUNDING * max(contrast, 1)


# --- the equations ----------------------------------------------------------------------------


@pytest.mark.parametrize("shape", ["space", "relief"])
@pytest.mark.parametrize("exaggeration", [1.0, DEFAULT, 60.0])
def test_the_kernel_is_the_equations(request, shape, exaggeration, rng):
    space = request.getfixturevalue(shape)
    for light in lights_for(space, rng):
        found = exaggerated(space, light, exaggeration=exaggeration)
        off = np.abs(found - written_out(space, light, exaggeration))
        assert (off <= rounding_bound(space, light, exaggeration)).all()


def test_single_precision_does_not_show(space, relief, rng):
    # 30° and more off all smoothed normals 1e-5, which is 0.003 grey levels; along one a fifth of
    # a level, where the light's own direction in the plane is as uncertain as the normals are.
    for shape in (space, relief):
        for light in lights_for(shape, rng):
            off = np.abs(paper(shape, light) - written_out(shape, light))
            aside = (length_of_local_light(shape, light) > 0.5).all(axis=0)
            assert off[aside].max(initial=0) < 1e-5
            assert off.max() < 0.2 / 255


@pytest.mark.parametrize("emphasis", [-1.0, 0.0, 2.0])
@pytest.mark.parametrize("contrast", [0.0, 0.7, 3.0])
def test_weights_enter_as_written(space, emphasis, contrast):
    light = unit(np.array([-1.0, 2.0, 0.5]))
    options = {"emphasis": emphasis, "contrast": contrast}
    off = np.abs(paper(space, light, **options) - written_out(space, light, **options))
    assert (off <= rounding_bound(space, light, **options)).all()


def test_many_samples_on_several_threads_are_no_different(monkeypatch):
    ball = samples.golf_ball(25_000)
    space = scale_space(ball, scales=1, tolerance=1e-2)
    threads.limit(3)
    try:
        found = exaggerated(space, "northwest")
    finally:
        threads.limit(1)
    try:
        np.testing.assert_allclose(found, exaggerated(space, "northwest"), atol=1e-6)
    finally:
        threads.limit(None)


def test_soft_toon_clamps_at_one_over_the_exaggeration():
    np.testing.assert_array_equal(
        soft_toon([-1, -0.25, 0, 0.125, 0.25, 1], 4), [-1, -1, 0, 0.5, 1, 1]
    )


def test_the_local_light_is_the_unit_projection(rng):
    normals, light = unit(rng.normal(size=(500, 3))), unit(rng.normal(size=3))
    local = local_light(light, normals)
    np.testing.assert_allclose(np.einsum("ni,ni->n", local, normals), 0, atol=1e-14)
    length = np.linalg.norm(light - normals * (normals @ light)[:, None], axis=1)
    expected = (light - normals * (normals @ light)[:, None]) / length[:, None]
    # METHODS §2: relative difference from eq. 3 ε²/(2‖l‖²).
    off = np.linalg.norm(local - expected, axis=1)
    assert (off <= SINGULAR_LIGHT**2 / (2 * length**2) + 1e-15).all()
    assert (np.linalg.norm(local, axis=1) <= 1).all()


def test_a_light_along_the_normal_has_no_direction_in_its_plane():
    normals = unit(np.array([[1.0, 2, 3], [-1, -2, -3], [3, 2, 1]]))
    local = local_light(normals[0], normals)
    np.testing.assert_allclose(local[:2], 0, atol=1e-12)
    assert np.linalg.norm(local[2]) == pytest.approx(1, abs=1e-5)


# --- weights ----------------------------------------------------------------------------------


@pytest.mark.parametrize("unit_length", [1e-300, 1e-10, 1.0, 1e280])
@pytest.mark.parametrize("emphasis", [-4, -0.5, 0, 4])
def test_weights_are_powers_of_the_widths(unit_length, emphasis):
    ratio = 1.7
    widths = np.concatenate(([0], unit_length * ratio ** np.arange(8)))
    weights = band_weights(widths, ratio, emphasis=emphasis, contrast=0.8)
    assert weights.sum() == pytest.approx(0.8)
    np.testing.assert_allclose(weights[1:] / weights[:-1], ratio**emphasis)


def test_without_scales_the_base_has_all_the_weight():
    np.testing.assert_array_equal(band_weights(np.zeros(1), 2, emphasis=-1, contrast=0.8), [0.8])


# --- limits -----------------------------------------------------------------------------------


def test_without_exaggeration_only_the_base_coat_is_left(space, rng):
    k = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)[-1]
    for light in lights_for(space, rng, 5):
        base = 0.5 + 0.5 * k * (space.normals[-1].astype(float) @ light)
        np.testing.assert_allclose(exaggerated(space, light, exaggeration=0), base, atol=1e-6)


def test_one_scale_is_detail_and_base(ball, rng):
    space = scale_space(ball, scales=1)
    light = unit(rng.normal(size=3))
    fine, coarse = space.normals.astype(float)
    along = coarse @ light
    local = light - coarse * along[:, None]
    cosine = np.einsum("ni,ni->n", fine, local) / np.linalg.norm(local, axis=1)
    expected = 0.5 + 0.25 * (along + np.clip(DEFAULT * cosine, -1, 1))  # two equal weights
    away = np.linalg.norm(local, axis=1) > 0.1
    np.testing.assert_allclose(paper(space, light, emphasis=0)[away], expected[away], atol=1e-3)


def test_a_light_along_a_smoothed_normal_leaves_that_vertex_its_base(ball):
    space = scale_space(ball, scales=1)
    k = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)[-1]
    for vertex in (0, 100, 2000):
        light = unit(space.normals[1, vertex].astype(float))
        for sign in (1, -1):
            found = paper(space, sign * light)[vertex]
            bound = rounding_bound(space, light)[vertex]
            assert found == pytest.approx(0.5 + sign * 0.5 * k, abs=bound)


@pytest.mark.parametrize("light", [*AXES, np.ones(3), np.array([-1, 1, 1])])
def test_a_plane_is_evenly_shaded(light):
    space = scale_space(samples.wavy_sheet(400, amplitude=0), scales=4)
    light = unit(light.astype(float))
    k = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)[-1]
    expected = 0.5 + 0.5 * k * light[2]
    assert np.abs(paper(space, light) - expected).max() <= rounding_bound(space, light).max()


def test_the_steepest_toon_is_a_sign(space, rng):
    k = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
    normals = space.normals.astype(float)
    for light in lights_for(space, rng, 5):
        found = exaggerated(space, light, exaggeration=1e30)
        assert np.isfinite(found).all()
        assert found.min() >= 0
        assert found.max() <= 1
        cosines = np.einsum("sni,sni->sn", normals[:-1], local_light(light, normals[1:]))
        sure = (np.abs(cosines) > 1e-3).all(axis=0)  # elsewhere rounding decides the sign
        expected = 0.5 + 0.5 * (k[-1] * (normals[-1] @ light) + k[:-1] @ np.sign(cosines))
        np.testing.assert_allclose(found[sure], expected[sure], atol=1e-5)


def test_the_opposite_light_gives_the_negative(space, relief, rng):
    for shape in (space, relief):
        for light in lights_for(shape, rng, 5):
            both = paper(shape, light) + paper(shape, -light)
            np.testing.assert_allclose(both, 1, atol=3 * ROUNDING)  # each step is odd


def test_turning_the_light_a_little_changes_little(space, relief, rng):
    # With p the projected light, l̂ = p/√(‖p‖² + ε²) changes by at most ‖dp‖/√(‖p‖² + ε²), and the
    # finer normal sees of that sin θ, θ being the angle between the two. So a light turned by the
    # chord dl moves the detail by a sin θ dl/√(‖p‖² + ε²), with the least ‖p‖ on the way. Where the
    # light stands along a normal this is a·sin θ·1.7 for 0.1°: there alone the light may jump.
    for shape in (space, relief):
        normals = shape.normals.astype(float)
        sine = np.linalg.norm(np.cross(normals[:-1], normals[1:]), axis=-1)
        k = band_weights(shape.widths, shape.ratio, emphasis=-0.5, contrast=1.0)
        bounds = []
        for light in lights_for(shape, rng, 10):
            aside = unit(np.cross(light, rng.normal(size=3)))
            turned = unit(light + np.tan(np.radians(0.1)) * aside)
            chord = np.linalg.norm(turned - light)
            least = np.maximum(length_of_local_light(shape, light) - chord, 0)
            detail = DEFAULT * sine * chord / np.hypot(least, SINGULAR_LIGHT)
            bound = 0.5 * (k[-1] * chord + k[:-1] @ np.minimum(detail, 2))
            bounds.append(bound)
            rounding = rounding_bound(shape, light) + rounding_bound(shape, turned)
            moved = np.abs(paper(shape, turned) - paper(shape, light))
            assert (moved <= bound + rounding).all()
        assert np.median(bounds) < 1 / 255  # as a rule less than a grey level


# --- in and out -------------------------------------------------------------------------------


def test_detail_shows_on_the_side_away_from_the_light(ball):
    # The reason for the method: in Lambert's shading that side is one black.
    space = scale_space(ball, scales=9)
    away = space.normals[-1] @ np.array([-1, 1, 1]) / 3**0.5 < -0.3
    assert exaggerated(space, "northwest")[away].std() > 10 / 255


def test_without_a_smoothed_scale_there_is_nothing_to_exaggerate(ball):
    with pytest.raises(MeshdepictError, match="needs at least one scale; make more with scales=9"):
        exaggerated(scale_space(ball, scales=0), "northwest")
