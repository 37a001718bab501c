"""The baselines against exact answers, slow twins and their limits."""

import numpy as np
import pytest
from conftest import rotation
from method_families import ON_MESHES

import meshdepict as md
from meshdepict import shading
from meshdepict.errors import MeshdepictError
from meshdepict.options import options_of
from meshdepict.shading.accessibility import accessible_radii
from meshdepict.shading.gooch import tones
from meshdepict.shading.normal_enhancement import enhanced_normals

NORTHWEST = np.array([-1, 1, 1]) / np.sqrt(3)


@pytest.fixture(scope="module")
def space(ball):
    return md.scale_space(ball, scales=5)


# --- Gooch ----------------------------------------------------------------------------------


def test_gooch_ends_at_its_two_tones(sphere):
    space = md.scale_space(sphere, scales=0)
    direction = sphere.normals[7]
    colors = shading.gooch(space, direction, surface=0.9)
    cool, warm = tones(0.9, blue=0.4, yellow=0.4, cool=0.2, warm=0.6)
    np.testing.assert_allclose(colors[7], warm, atol=1e-6)
    opposite = np.argmin(sphere.normals @ direction)
    share = (1 + sphere.normals[opposite] @ direction) / 2
    np.testing.assert_allclose(colors[opposite], share * warm + (1 - share) * cool, atol=1e-6)
    assert cool[2] > cool[0]
    assert warm[0] > warm[2]


# --- aspect ---------------------------------------------------------------------------------


def test_aspect_is_the_limit_of_growing_heights(space):
    n = space.normals[0].astype(float)
    for exaggeration, tolerance in ((1e2, 0.6), (1e4, 0.02)):
        steep = n * [exaggeration, exaggeration, 1]
        steep /= np.linalg.norm(steep, axis=1, keepdims=True)
        relief = (1 + steep @ [-np.sqrt(0.5), np.sqrt(0.5), 0]) / 2
        assert np.abs(shading.aspect(space, "northwest") - relief).max() < tolerance


def test_aspect_is_half_where_it_has_no_direction(space):
    c = shading.aspect(space, "front")  # a light that stands at the eye
    np.testing.assert_array_equal(c, 0.5)
    flat = md.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], winding="keep")
    np.testing.assert_array_equal(shading.aspect(md.scale_space(flat, scales=0), "north"), 0.5)


def test_aspect_turns_with_the_view(space):
    front = shading.aspect(space, NORTHWEST)
    right = shading.aspect(space, NORTHWEST, view="right")
    assert np.abs(front - right).max() > 0.5
    np.testing.assert_array_equal(
        md.bake(space, "aspect", view="right", light=NORTHWEST).intensity, right
    )


# --- accessibility --------------------------------------------------------------------------


def brute_radii(points, normals, cap):
    """Every pair: the definition."""
    radii = np.full(len(points), cap)
    for i in range(len(points)):
        d = points - points[i]
        above = d @ normals[i]
        near = above > 0
        if near.any():
            radii[i] = min(cap, ((d[near] ** 2).sum(1) / (2 * above[near])).min())
    return radii


@pytest.mark.parametrize("cap", [0.001, 0.05, 0.5, 10.0])
def test_shrinking_balls_find_the_exact_radius(ball, cap):
    points, normals = ball.unit_points[::3], ball.normals[::3]
    np.testing.assert_allclose(
        accessible_radii(points, normals, cap), brute_radii(points, normals, cap), rtol=1e-8
    )


def test_the_inside_of_a_sphere_takes_a_ball_of_its_radius(sphere):
    radii = accessible_radii(sphere.vertices, -sphere.normals, 5.0)
    np.testing.assert_allclose(radii, 1, rtol=1e-6)
    outside = accessible_radii(sphere.vertices, sphere.normals, 5.0)
    np.testing.assert_array_equal(outside, 5.0)


def test_points_at_one_place_do_not_hide_each_other():
    points = np.zeros((4, 3))
    np.testing.assert_array_equal(accessible_radii(points, np.tile([0, 0, 1.0], (4, 1)), 2.0), 2.0)


def test_dimples_are_less_accessible_than_the_ground_between(ball):
    space = md.scale_space(ball, scales=0)
    c = shading.accessibility(space, None, cap=0.1)
    height = np.linalg.norm(ball.vertices, axis=1)
    assert c[height > np.quantile(height, 0.9)].mean() > c[height < np.quantile(height, 0.5)].mean()


# --- ambient occlusion, sky view ------------------------------------------------------------


def test_ambient_occlusion_is_what_the_space_has(ball):
    space = md.scale_space(ball, scales=0)
    c = shading.ambient_occlusion(space, None, rays=32, darkest=0)
    np.testing.assert_array_equal(c, space.occlusion(32))
    np.testing.assert_allclose(
        shading.ambient_occlusion(space, None, rays=32, darkest=0, exposure=0.5), c / 2, atol=1e-7
    )


def test_sky_view_follows_the_light(ball):
    space = md.scale_space(ball, scales=0)
    c = shading.sky_view(space, (0, 1, 0), rays=32)
    assert c[ball.normals[:, 1] > 0.9].mean() > 0.8
    assert c[ball.normals[:, 1] < -0.95].max() < 0.2
    lamp = shading.sky_view(space, (0, 1, 0), rays=32, spread=5.0)
    assert lamp[ball.normals[:, 1] < -0.2].max() == 0


# --- normal enhancement ---------------------------------------------------------------------


def test_enhanced_normals(rng):
    n = rng.normal(size=(100, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    np.testing.assert_allclose(enhanced_normals(n, n, 3.0), n, atol=1e-15)
    s = np.roll(n, 1, axis=0)
    np.testing.assert_allclose(enhanced_normals(n, s, 0.0), n, atol=1e-15)
    away = enhanced_normals(n, s, 1.0)
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), 1)
    # Every normal moves away from its smoothed one.
    assert ((away * s).sum(1) < (n * s).sum(1)).all()
    # 1 + k = k cos … the sum vanishes for n = s/(…): here n + k(n − n_σ) = 0 with k = −½, n_σ = −n.
    np.testing.assert_array_equal(enhanced_normals(n, -n, -0.5), n)


def test_amount_zero_is_lambert(space):
    plain = shading.lambert(space, NORTHWEST)
    for method in (shading.normal_enhancement, shading.unsharp_masking):
        np.testing.assert_allclose(method(space, NORTHWEST, amount=0.0), plain, atol=1e-6)
        assert np.abs(method(space, NORTHWEST, amount=2.0) - plain).max() > 0.1


# --- unsharp masking ------------------------------------------------------------------------


def test_the_surface_mean_is_the_direct_sum(space, rng):
    c, width = rng.uniform(size=len(space.points)), float(space.widths[3])
    x, areas = space.points, space.shape.areas
    for i in (0, 17, 901):
        weight = areas * np.exp(-((x - x[i]) ** 2).sum(1) / (2 * width**2))
        expected = (weight * c).sum() / weight.sum()
        assert space.mean(c, width)[i] == pytest.approx(expected, abs=1e-3)


def test_the_mean_of_a_constant_is_the_constant(space):
    mean = space.mean(np.full(len(space.points), 0.7), float(space.widths[-1]))
    np.testing.assert_allclose(mean, 0.7, atol=2e-3)


def test_points_without_area_keep_their_shading():
    mesh = md.Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    space = md.scale_space(mesh, scales=2)
    np.testing.assert_allclose(space.mean(np.array([0.1, 0.5, 0.9]), 0.5), [0.1, 0.5, 0.9])


@pytest.mark.parametrize("name", ["normal_enhancement", "unsharp_masking"])
def test_a_space_without_scales_is_refused(ball, name):
    with pytest.raises(MeshdepictError, match="needs at least one scale; make more with scales=5"):
        shading.METHODS[name](md.scale_space(ball, scales=0), "north")


# --- as a family ----------------------------------------------------------------------------


def few_rays(name):
    return {"rays": 8} if "rays" in options_of(shading.METHODS[name]) else {}


@pytest.mark.parametrize("name", ON_MESHES)
def test_degenerate_meshes_get_finite_colours(name):
    shapes = [
        md.Mesh(np.zeros((3, 3)), [[0, 1, 2]]),
        md.Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [5, 5, 5]], [[0, 1, 2]]),
        md.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]], [[0, 1, 2], [3, 2, 1]]),
    ]
    for mesh in shapes:
        space = md.scale_space(mesh, scales=2)
        for light in ("northwest", (0, 0, 1), (0, 0, -1), (1, 0, 0)):
            c = shading.METHODS[name](space, light, **few_rays(name))
            assert ((c >= 0) & (c <= 1)).all()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")  # about the files' windings
def test_every_real_mesh_gets_finite_colours(data):
    for path in sorted((data / "mesh").glob("*.ply")):
        if path.stat().st_size > 3_000_000:
            continue  # for the time that it takes
        space = md.scale_space(md.read_mesh(path), scales=2)
        for name in ON_MESHES:
            c = shading.METHODS[name](space, "northwest", **few_rays(name))
            assert ((c >= 0) & (c <= 1)).all(), (path, name)


@pytest.mark.parametrize("name", ["gooch", "unsharp_masking", "accessibility", "light_alignment"])
def test_turning_mesh_and_light_together_changes_nothing(name, ball, rng):
    turn = rotation(rng)
    turned = md.Mesh(ball.vertices @ turn.T, ball.faces)
    here = shading.METHODS[name](md.scale_space(ball, scales=3), NORTHWEST)
    there = shading.METHODS[name](md.scale_space(turned, scales=3), turn @ NORTHWEST)
    np.testing.assert_allclose(there, here, atol=0.01)


def test_accessibility_sees_no_obstacle_in_a_point_at_the_same_place():
    """Along seams, closed to the last bit but not welded, twins are no walls."""
    sphere = md.samples.sphere(500)
    points = np.vstack([sphere.vertices, sphere.vertices[:50] * (1 + 3e-16)])
    normals = np.vstack([sphere.normals, sphere.normals[:50]])
    np.testing.assert_array_equal(accessible_radii(points, normals, 2.0), 2.0)
