"""Curvature at pixels: exact on spheres and cylinders, the mesh's elsewhere, stops at edges."""

import numpy as np
import pytest
from scipy.ndimage import binary_erosion, sobel

from meshdepict import scale_space
from meshdepict.errors import MeshdepictError
from meshdepict.scales.image_scales import image_space
from meshdepict.scene.view import View
from meshdepict.shapes.gbuffer import GBuffer

N, R = 101, 40.0
y, x = N // 2 - np.mgrid[:N, :N][0], np.mgrid[:N, :N][1] - N // 2


def globe(hollow=1):
    """A sphere of radius 40 pixels around the middle pixel, or the hollow of one."""
    height = np.sqrt(np.maximum(R**2 - x**2 - y**2, 0))
    normals = np.stack([hollow * x, hollow * y, height], axis=-1) / R
    mask = x**2 + y**2 < 0.95 * R**2
    return GBuffer.from_images(normals, 100 - hollow * height, mask)


def cylinder():
    """Around the line y = x in the picture."""
    across = (x - y) / np.sqrt(2)
    mask = np.abs(across) < 0.9 * R
    height = np.sqrt(np.maximum(R**2 - across**2, 1))
    slope = across / np.sqrt(2)
    normals = np.stack([slope, -slope, height], axis=-1) / np.hypot(across, height)[..., None]
    return GBuffer.from_images(normals, 100 - height, mask)


def pixel(buffer, row, column):
    """The number of the sample at a pixel."""
    return int(buffer.mask.ravel()[: row * buffer.size[0] + column].sum())


@pytest.mark.parametrize("hollow", [1, -1])
@pytest.mark.parametrize("f", [0, 0.4, 1])
def test_the_middle_of_a_sphere_has_the_hessian_one_over_its_radius(hollow, f):
    buffer = globe(hollow)
    seen = image_space(buffer, filter="none").view_curvature(buffer.view, 0, foreshortening=f)
    middle = pixel(buffer, N // 2, N // 2)
    # A difference over two pixels: relative error ½ (1/R)² and less.
    np.testing.assert_allclose(seen.ku[middle], -hollow / R, rtol=1e-3)
    np.testing.assert_allclose(seen.kv[middle], -hollow / R, rtol=1e-3)
    assert seen.weight[middle] == 1


@pytest.mark.parametrize("f", [0, 0.4, 1])
def test_the_hessian_is_sobels_filter_of_the_slope(f):
    buffer = globe()
    seen = image_space(buffer, filter="none").view_curvature(buffer.view, 0, foreshortening=f)
    nx, ny, nz = np.moveaxis(buffer.image(buffer.normals, background=(0, 0, 1)), -1, 0)
    gx, gy = -nx / nz**f, -ny / nz**f
    xx, yy = sobel(gx, axis=1) / 8, -sobel(gy, axis=0) / 8
    xy = (sobel(gy, axis=1) - sobel(gx, axis=0)) / 16
    inner = x**2 + y**2 < 0.8 * R**2
    trace = buffer.image(seen.ku + seen.kv)
    np.testing.assert_allclose(trace[inner], (xx + yy)[inner], atol=1e-6)
    determinant = buffer.image(seen.ku * seen.kv)
    np.testing.assert_allclose(determinant[inner], (xx * yy - xy**2)[inner], atol=1e-6)


def test_directions_are_the_hessians():
    buffer = cylinder()
    seen = image_space(buffer, filter="none").view_curvature(buffer.view, 0)
    middle = pixel(buffer, N // 2, N // 2)
    np.testing.assert_allclose(seen.ku[middle], -1 / R, rtol=1e-3)
    np.testing.assert_allclose(seen.kv[middle], 0, atol=1e-6)
    across = np.array([1, -1, 0]) / np.sqrt(2)
    assert abs(seen.u[middle] @ across) == pytest.approx(1, abs=1e-6)
    np.testing.assert_allclose(
        np.cross(seen.u, seen.v), np.tile([0, 0, 1], (len(seen.u), 1)), atol=1e-6
    )


@pytest.mark.parametrize(("hollow", "sign"), [(1, 1), (-1, -1)])
def test_a_spheres_principal_curvatures_do_not_depend_on_the_slope(hollow, sign):
    buffer = globe(hollow)
    found = image_space(buffer, filter="none").curvature(0)
    r = np.hypot(*buffer.points[:, :2].T) / R
    inner = r < 0.9
    # Differences over a pixel, on a slope of up to 2.
    np.testing.assert_allclose(found.k1[inner], sign / R, rtol=0.01)
    np.testing.assert_allclose(found.k2[inner], sign / R, rtol=0.01)
    np.testing.assert_allclose(np.einsum("ij,ij->i", found.d1, found.d2), 0, atol=1e-6)
    np.testing.assert_allclose(np.einsum("ij,ij->i", found.d1, buffer.normals), 0, atol=1e-6)


def test_a_cylinder_bends_one_way():
    buffer = cylinder()
    found = image_space(buffer, filter="none").curvature(0)
    inside = binary_erosion(buffer.mask, np.ones((3, 3), bool))[buffer.mask]
    np.testing.assert_allclose(found.k1[inside], 1 / R, rtol=0.03)
    np.testing.assert_allclose(found.k2[inside], 0, atol=1e-6)
    along = np.array([1, 1, 0]) / np.sqrt(2)
    np.testing.assert_allclose(np.abs(found.d2[inside] @ along), 1, atol=1e-4)


def test_a_perspective_sphere_has_its_curvature(sphere):
    eye = View((0.4, 0.6, 2.2), (0, 0, 0), (0, 1, 0), field_of_view=60)
    buffer = GBuffer.of(sphere, eye, size=(200, 200))
    normals = buffer.points / np.linalg.norm(buffer.points, axis=1, keepdims=True)
    buffer = GBuffer(eye, buffer.mask, normals, buffer.depths)
    found = image_space(buffer, filter="none").curvature(0)
    away = eye.position - buffer.points
    facing = (buffer.normals * away).sum(axis=1) / np.linalg.norm(away, axis=1) > 0.4
    np.testing.assert_allclose(found.mean[facing], 1, rtol=0.02)


def test_a_flat_wall_is_flat_in_perspective():
    normals = np.broadcast_to([0.0, 0, 1], (40, 60, 3))
    eye = View((0, 0, 0), (0, 0, -1), (0, 1, 0), field_of_view=70)
    buffer = GBuffer.from_images(normals, np.ones((40, 60)), view=eye)
    seen = image_space(buffer, filter="none").view_curvature(eye, 0)
    np.testing.assert_allclose(seen.ku, 0, atol=1e-12)
    np.testing.assert_allclose(image_space(buffer, filter="none").curvature(0).k1, 0, atol=1e-12)


@pytest.mark.parametrize("eye", ["front", None])
def test_pixels_and_vertices_see_the_same_curvature(bunny, eye):
    if eye is None:
        front = View.fitted("front", bunny)
        eye = View(
            front.focus + 1.5 * bunny.diagonal * front.towards_eye, front.focus, front.up,
            field_of_view=40,
        )  # fmt: skip
    buffer = GBuffer.of(bunny, eye, size=(400, 400))
    space = image_space(buffer, scales=1, width=3 * buffer.edge_length)
    mesh = scale_space(bunny, scales=1, width=float(space.widths[1]), tolerance=1e-3)
    there, here = mesh.view_curvature(buffer.view, 1), space.view_curvature(buffer.view, 1)
    facing = buffer.normals @ buffer.view.towards_eye > 0.5
    inner = facing & (here.weight > 0.99) & (buffer.sample(there.weight) > 0.99)
    assert inner.mean() > 0.5
    a, b = buffer.sample(there.mean)[inner], here.mean[inner]
    # Smoothed by other means; compared on what faces the eye by at least 60°.
    assert np.corrcoef(a, b)[0, 1] > 0.9
    assert np.median(np.abs(a - b)) < 0.15 * np.median(np.abs(a))
    own, others = space.curvature(1).mean[inner], buffer.sample(mesh.curvature(1).mean)[inner]
    assert np.corrcoef(own, others)[0, 1] > 0.9


# --- silhouettes and creases ------------------------------------------------------------------


def steps(size, **given):
    """Two plates, one ``size`` nearer than the other."""
    depth = np.where(np.arange(40) < 20, 100.0, 100.0 + size)[None].repeat(30, axis=0)
    return GBuffer.from_images(np.broadcast_to([0.0, 0, 1], (30, 40, 3)), depth, **given)


@pytest.mark.parametrize(("ratio", "weight"), [(0.029, 1), (0.035, 0.5), (0.041, 0)])
@pytest.mark.parametrize("perspective", [False, True])
def test_a_silhouette_is_a_step_of_three_to_four_per_cent(ratio, weight, perspective):
    if perspective:
        eye = View((0, 0, 0), (0, 0, -1), (0, 1, 0), field_of_view=50)
        buffer = steps(100 * np.expm1(ratio), view=eye)
    else:
        # As from where 30° show these 30 pixels.
        buffer = steps(ratio * 15 / np.tan(np.radians(15)))
    seen = image_space(buffer, filter="none").view_curvature(buffer.view, 0)
    picture = buffer.image(seen.weight)
    np.testing.assert_allclose(picture[:, 19:21], weight, atol=1e-3)
    np.testing.assert_allclose(picture[:, :19], 1)
    np.testing.assert_allclose(picture[:, 21:], 1)


def test_the_border_of_the_mask_is_a_silhouette_and_the_pictures_is_not():
    mask = np.ones((20, 20), bool)
    mask[:, 10:] = False
    buffer = GBuffer.from_images(np.broadcast_to([0.0, 0, 1], (20, 20, 3)), mask=mask)
    weight = buffer.image(image_space(buffer, filter="none").view_curvature(buffer.view, 0).weight)
    np.testing.assert_array_equal(weight[:, 9], 0)
    np.testing.assert_array_equal(weight[:, :9], 1)


@pytest.mark.parametrize(("angle", "weight"), [(29, 1), (45, 0.5), (61, 0)])
def test_a_crease_is_a_turn_of_30_to_60_degrees(angle, weight):
    half = np.radians(angle / 2)
    side = np.where(np.arange(40) < 20, -1, 1)
    normals = np.stack([side * np.sin(half), 0 * side, np.cos(half) + 0 * side], axis=-1)
    buffer = GBuffer.from_images(normals[None].repeat(30, axis=0))
    seen = image_space(buffer, filter="none").view_curvature(buffer.view, 0)
    np.testing.assert_allclose(buffer.image(seen.weight)[:, 19:21], weight, atol=1e-3)


def test_derivatives_are_taken_on_one_side_of_a_step():
    buffer = steps(50.0)
    normals = np.array(buffer.normals)
    normals[buffer.depths > 120] = (0.8, 0, 0.6)
    other = GBuffer(buffer.view, buffer.mask, normals, buffer.depths)
    space = image_space(other, filter="none")
    np.testing.assert_allclose(space.curvature(0).k1, 0, atol=1e-12)
    np.testing.assert_allclose(space.view_curvature(other.view, 0).ku, 0, atol=1e-12)


# --- the door ---------------------------------------------------------------------------------


def test_only_its_own_view_is_known(ball):
    buffer = GBuffer.of(ball, "front", size=(40, 40))
    space = image_space(buffer, scales=1)
    with pytest.raises(
        MeshdepictError, match=r"the G-buffer was made for the view front .* know no"
    ):
        space.view_curvature(View.fitted("left", ball))
    with pytest.raises(MeshdepictError, match="pixels know no other"):
        space.view_curvature("left")
    assert space.view_curvature("front") is space.view_curvature(buffer.view)
    left = image_space(GBuffer.of(ball, "left", size=(40, 40)), scales=1)
    assert left.view_curvature("left") is left.view_curvature("front")
    # How many pixels a view has is the buffer's affair.
    seen = space.view_curvature(View.fitted("front", ball, height_px=999))
    assert space.view_curvature(buffer.view) is seen


def test_wrong_scales_and_exponents_are_refused(ball):
    buffer = GBuffer.of(ball, "front", size=(40, 40))
    space = image_space(buffer, scales=1)
    with pytest.raises(MeshdepictError, match="scale=2 is not one of the scale space's"):
        space.view_curvature(buffer.view, 2)
    with pytest.raises(MeshdepictError, match="foreshortening=11 is not a number from 0 to 10"):
        space.view_curvature(buffer.view, 1, foreshortening=11)
