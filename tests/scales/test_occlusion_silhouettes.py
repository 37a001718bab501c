"""Silhouettes by an occlusion map: RGBN images, which have no depth (Light Warping, §4.4)."""

import numpy as np
import pytest

from meshdepict import GBuffer, MeshdepictError, bake, scale_space, shading
from meshdepict.scales.image_scales import image_space

SIZE = 48


def bumpy(seed=1):
    """Gentle normals (h, w, 3) without any crease."""
    rows, columns = np.mgrid[0:SIZE, 0:SIZE]
    x, y = 0.15 * np.sin(columns / 4), 0.15 * np.cos(rows / 5)
    return np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=-1)


def buffer(occlusion, **more):
    return GBuffer.from_images(
        bumpy(), occlusion=np.asarray(occlusion, float), silhouettes="occlusion", **more
    )


def seen(shape, scale=0):
    return image_space(shape, filter="none").view_curvature(shape.view, scale)


def inner(shape, values):
    """Of pixels that are not beside the picture's border."""
    return shape.image(np.asarray(values, float))[2:-2, 2:-2]


def test_where_all_is_open_the_inside_has_no_silhouette():
    shape = buffer(np.ones((SIZE, SIZE)))
    np.testing.assert_array_equal(inner(shape, seen(shape).weight), 1)
    flat = GBuffer.from_images(bumpy())
    np.testing.assert_array_equal(seen(shape).weight, seen(flat).weight)


def test_the_weight_is_the_occlusion_map():
    share = np.tile(np.linspace(0, 1, SIZE), (SIZE, 1))
    shape = buffer(share)
    np.testing.assert_allclose(inner(shape, seen(shape).weight), share[2:-2, 2:-2], atol=1e-6)
    # Curvature itself is not blended by it.
    plain = GBuffer.from_images(bumpy(), occlusion=share)
    np.testing.assert_array_equal(seen(shape).ku, seen(plain).ku)
    np.testing.assert_array_equal(inner(plain, seen(plain).weight), 1)


def test_the_border_of_the_mask_stays_a_silhouette():
    mask = np.ones((SIZE, SIZE), bool)
    mask[:, 30:] = False
    shape = buffer(np.ones((SIZE, SIZE)), mask=mask)
    weight = shape.image(seen(shape).weight)
    assert not weight[:, 29].any()
    assert (weight[2:-2, 2:28] == 1).all()


def test_depth_has_no_say_then():
    depth = np.where(np.arange(SIZE) < 24, 100.0, 200.0) * np.ones((SIZE, 1))
    shape = buffer(np.ones((SIZE, SIZE)), depth=depth)
    np.testing.assert_array_equal(inner(shape, seen(shape).weight), 1)
    other = GBuffer.from_images(bumpy(), depth=depth, occlusion=np.ones((SIZE, SIZE)))
    assert not other.image(seen(other).weight)[:, 23:25].any()


def test_nothing_diffuses_over_a_dark_line():
    share = np.ones((SIZE, SIZE))
    share[:, 24] = 0
    normals = bumpy()
    normals[:, 24:] = [0, 0, 1]
    both = [
        GBuffer.from_images(normals, occlusion=share, silhouettes=silhouettes)
        for silhouettes in ("depth", "occlusion")
    ]
    mixed, parted = (
        shape.image(image_space(shape, filter="diffusion", iterations=60).normals[1])[:, 25:]
        for shape in both
    )
    np.testing.assert_allclose(parted, np.broadcast_to([0, 0, 1], parted.shape), atol=1e-6)
    assert np.abs(mixed - [0, 0, 1]).max() > 0.01


@pytest.mark.parametrize("method", ["light_warping", "radiance_scaling", "mean_curvature"])
def test_methods_and_bakes_follow(method):
    share = np.ones((SIZE, SIZE))
    share[:, :24] = 0
    dark, bright = (bake(buffer(o), method).intensity for o in (share, np.ones((SIZE, SIZE))))
    shape = buffer(share)
    off = shape.image(np.abs(dark - bright).reshape(len(dark), -1).max(axis=1))
    assert off[2:-2, 26:-2].max() < 1e-6
    assert off[2:-2, 2:22].max() > 0.01
    space = scale_space(shape, scales=1)
    flat = shading.mean_curvature(space, None, curvature="view")
    np.testing.assert_allclose(shape.image(flat)[2:-2, 2:22], 0.5, atol=1e-6)


def test_what_makes_no_sense_is_refused():
    with pytest.raises(MeshdepictError, match="silhouettes='outline' is not one of depth, occ"):
        GBuffer.from_images(bumpy(), silhouettes="outline")
    with pytest.raises(MeshdepictError, match="needs an occlusion image"):
        GBuffer.from_images(bumpy(), silhouettes="occlusion")
