"""G-buffers from normal maps, depth, masks and occlusion: arrays and files of every depth."""

import warnings

import numpy as np
import pytest
from PIL import Image

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.images.image_files import read_image
from meshdepict.scales.image_scales import image_space
from meshdepict.scene.view import View
from meshdepict.shading import ambient_occlusion
from meshdepict.shapes.gbuffer import GBuffer

H, W = 30, 40


@pytest.fixture(scope="module")
def cap():
    """(normals, depth, mask) of a sphere of radius 12 pixels, seen from the front."""
    y, x = np.mgrid[:H, :W]
    x, y = x + 0.5 - W / 2, H / 2 - 0.5 - y
    squared = (x**2 + y**2) / 144
    mask = squared < 0.95
    z = np.sqrt(np.maximum(1 - squared, 0))
    normals = np.where(mask[..., None], np.stack([x / 12, y / 12, z], axis=-1), 0)
    return normals, np.where(mask, 50 - 12 * z, 0), mask


def encoded(normals, kind):
    most = np.iinfo(kind).max
    there = normals.any(axis=-1, keepdims=True)
    return np.where(there, np.rint((normals + 1) / 2 * most), 0).astype(kind)


# --- arrays -----------------------------------------------------------------------------------


def test_floats_are_taken_as_they_are(cap):
    normals, depth, mask = cap
    buffer = GBuffer.from_images(normals, depth)
    np.testing.assert_array_equal(buffer.mask, mask)
    np.testing.assert_allclose(buffer.normals, normals[mask], atol=1e-12)
    np.testing.assert_allclose(buffer.depth, depth, atol=1e-12)
    assert buffer.edge_length == 1
    assert buffer.mesh is None
    # One world unit a pixel, seen from the front: the sphere stands in space as in the picture.
    centre = buffer.points - 12 * buffer.normals
    np.testing.assert_allclose(centre - centre[0], 0, atol=1e-9)
    np.testing.assert_allclose(centre[0, :2], 0, atol=1e-9)


def test_normals_are_turned_from_view_space_to_the_world(cap):
    normals, _, mask = cap
    view = View((3, 0, 0), (0, 0, 0), (0, 0, 1), parallel_scale=1)
    buffer = GBuffer.from_images(normals, view=view)
    np.testing.assert_allclose(buffer.normals @ view.frame.T, normals[mask], atol=1e-12)
    np.testing.assert_allclose(buffer.normals[:, 0], normals[mask][:, 2], atol=1e-12)
    np.testing.assert_allclose(buffer.points[:, 0], 0, atol=1e-12)  # without depth: one plane
    assert buffer.edge_length == pytest.approx(2 / H)


def test_signed_numbers_and_lists_are_taken_as_they_are():
    buffer = GBuffer.from_images([[[0, 0, 1], [0, -1, 0]]])
    np.testing.assert_array_equal(buffer.normals, [[0, 0, 1], [0, -1, 0]])


def test_green_may_point_down(cap):
    normals, _, _ = cap
    down = normals * (1, -1, 1)
    np.testing.assert_array_equal(
        GBuffer.from_images(down, green="down").normals, GBuffer.from_images(normals).normals
    )


def test_a_mask_chooses_and_alpha_does(cap):
    normals, _, mask = cap
    left = mask & (np.arange(W) < 20)
    np.testing.assert_array_equal(GBuffer.from_images(normals, mask=left).mask, left)
    alpha = np.dstack([normals, left])
    np.testing.assert_array_equal(GBuffer.from_images(alpha).mask, left)


def test_perspective_views_put_points_on_rays(cap):
    normals, depth, _ = cap
    view = View((0, 0, 0), (0, 0, -1), (0, 1, 0), field_of_view=40)
    buffer = GBuffer.from_images(normals, depth, view=view)
    rows, columns = np.nonzero(buffer.mask)
    tangent = np.tan(np.radians(20))
    x, y, _ = (buffer.points / -buffer.points[:, 2:]).T
    np.testing.assert_allclose(x, (columns + 0.5 - W / 2) / (H / 2) * tangent, atol=1e-12)
    np.testing.assert_allclose(y, (H / 2 - 0.5 - rows) / (H / 2) * tangent, atol=1e-12)
    np.testing.assert_allclose(buffer.depths, -buffer.points[:, 2])


@pytest.mark.parametrize(("factor", "offset"), [(1, 0), (0.37, 5), (-2.5, 300)])
def test_the_depths_unit_can_be_found_from_the_normals(cap, factor, offset):
    normals, depth, _ = cap
    image = (depth - offset) / factor
    fitted = GBuffer.from_images(normals, image, depth_scale="fit")
    plain = GBuffer.from_images(normals, depth)
    # Differences over a pixel against slopes at its ends: a few per cent on so small a sphere.
    relief, exact = np.ptp(fitted.depths), np.ptp(plain.depths)
    assert relief == pytest.approx(exact, rel=0.03)
    assert np.corrcoef(fitted.depths, plain.depths)[0, 1] > 0.9999
    given = GBuffer.from_images(normals, image, depth_scale=factor)
    assert np.ptp(given.depths) == pytest.approx(exact)


def test_a_coarse_depth_image_with_steps_gets_the_scale_of_its_normals(cap):
    # Two caps side by side, one further away, in 8 bits: a level is half a pixel.
    normals, depth, mask = cap
    far = np.where(mask, depth + 60, 0)
    image = np.hstack([depth, far])
    levels = np.rint(2 * image).astype(np.uint8)
    buffer = GBuffer.from_images(np.hstack([normals, normals]), levels, depth_scale="fit")
    assert np.ptp(buffer.depths) == pytest.approx(np.ptp(image[image > 0]), rel=0.05)


def test_lengths_are_made_one_with_a_word(cap):
    normals, _, mask = cap
    with pytest.warns(MeshdepictWarning, match=rf"{mask.sum()} of {mask.sum()} normals were not"):
        buffer = GBuffer.from_images(normals * 0.9)
    np.testing.assert_allclose(buffer.normals, normals[mask], atol=1e-12)


def test_pixels_of_the_mask_without_normals_are_left_out_with_a_word(cap):
    normals, _, mask = cap
    wider = mask.copy()
    wider[0, :5] = True
    with pytest.warns(MeshdepictWarning, match="5 pixels of the mask have no normal"):
        buffer = GBuffer.from_images(normals, mask=wider)
    np.testing.assert_array_equal(buffer.mask, mask)


def test_an_occlusion_image_is_the_occlusion(cap):
    normals, _, mask = cap
    occlusion = np.linspace(0, 255, H * W).reshape(H, W).astype(np.uint8)
    buffer = GBuffer.from_images(normals, occlusion=occlusion)
    space = image_space(buffer, scales=0)
    expected = occlusion[mask] / 255
    np.testing.assert_allclose(space.occlusion(), expected, atol=1e-6)
    assert space.occlusion_errors == {256: 0.0}
    np.testing.assert_allclose(ambient_occlusion(space, darkest=0), expected, atol=1e-6)


def test_images_are_not_changed(cap):
    normals, depth, mask = (array.copy() for array in cap)
    GBuffer.from_images(normals, depth, mask, green="down")
    for array, old in zip((normals, depth, mask), cap, strict=True):
        np.testing.assert_array_equal(array, old)


# --- files ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "error"), [(np.uint8, 1 / 127), (np.uint16, 1 / 32767)])
def test_normal_maps_of_8_and_16_bits(cap, tmp_path, kind, error):
    normals, _, mask = cap
    path = tmp_path / "normals.png"
    write_png(path, encoded(normals, kind))
    np.testing.assert_array_equal(read_image(path), encoded(normals, kind))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        buffer = GBuffer.from_images(path)
    np.testing.assert_array_equal(buffer.mask, mask)
    np.testing.assert_allclose(buffer.normals, normals[mask], atol=error)


def write_png(path, image):
    """Colours of 8 or 16 bits: Pillow knows the first alone, so chunk by chunk."""
    import struct
    import zlib

    def chunk(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    height, width, channels = image.shape
    bits = 8 * image.dtype.itemsize
    rows = image.astype(image.dtype.newbyteorder(">")).reshape(height, -1)
    raw = b"".join(b"\0" + row.tobytes() for row in rows)
    head = struct.pack(">IIBBBBB", width, height, bits, {3: 2, 4: 6}[channels], 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(raw))
        + chunk(b"IEND", b"")
    )


def test_alpha_of_16_bits(cap, tmp_path):
    normals, _, mask = cap
    alpha = np.where(mask, 65535, 0).astype(np.uint16)
    write_png(tmp_path / "n.png", np.dstack([encoded(normals, np.uint16), alpha]))
    np.testing.assert_array_equal(GBuffer.from_images(str(tmp_path / "n.png")).mask, mask)


@pytest.mark.parametrize("suffix", ["tif", "npy"])
def test_depth_in_floats(cap, tmp_path, suffix):
    normals, depth, _ = cap
    path = tmp_path / f"depth.{suffix}"
    if suffix == "npy":
        np.save(path, depth)
    else:
        Image.fromarray(depth.astype(np.float32)).save(path)
    np.testing.assert_allclose(GBuffer.from_images(normals, path).depth, depth, atol=1e-5)


@pytest.mark.parametrize(
    ("image", "mode"),
    [
        (np.arange(12, dtype=np.uint8).reshape(3, 4), "L"),
        (1000 * np.arange(12, dtype=np.uint16).reshape(3, 4), "I;16"),
        (np.eye(3, 4) > 0, "1"),
        (np.arange(24, dtype=np.uint8).reshape(3, 4, 2), "LA"),
    ],
)
def test_grey_pngs_keep_their_values(tmp_path, image, mode):
    path = tmp_path / "grey.png"
    picture = Image.fromarray(image)
    assert picture.mode == mode
    picture.save(path)
    expected = 255 * image.astype(np.uint8) if mode == "1" else image
    found = read_image(path)
    np.testing.assert_array_equal(found, expected)
    assert found.dtype == expected.dtype


def test_palettes_become_colours(tmp_path):
    path = tmp_path / "palette.png"
    Image.fromarray(np.full((2, 2, 3), (200, 10, 30), np.uint8)).quantize(4).save(path)
    np.testing.assert_array_equal(read_image(path)[0, 0], (200, 10, 30, 255))


def test_masks_and_occlusion_may_be_colour_images(cap):
    normals, _, mask = cap
    colours = np.where(mask, 255, 0).astype(np.uint8)[..., None].repeat(3, axis=2)
    np.testing.assert_array_equal(GBuffer.from_images(normals, mask=colours).mask, mask)


# --- small and odd ones -----------------------------------------------------------------------


def test_one_pixel_is_enough():
    buffer = GBuffer.from_images(np.array([[[0.6, 0, 0.8]]]), np.array([[3.0]]))
    assert len(buffer.normals) == 1
    assert buffer.diagonal == 0
    assert buffer.edge_length == 1


def test_constant_depth_is_a_relief_without_steps(cap):
    normals, _, mask = cap
    buffer = GBuffer.from_images(normals, np.full((H, W), 7.0))
    np.testing.assert_array_equal(buffer.depth[mask], 7)
    np.testing.assert_array_equal(buffer.depth_steps, 0)


# --- wrong input ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"depth": np.zeros((H, W + 1))}, r"images of different sizes: depth .* normal map"),
        ({"mask": np.zeros((H + 1, W))}, "images of different sizes: mask"),
        ({"occlusion": np.zeros((2, 2))}, "images of different sizes: occlusion"),
        ({"mask": np.zeros((H, W))}, "the mask is empty: no pixel shows a surface with a normal"),
        ({"depth": np.full((H, W), np.nan)}, r"depth is not finite at \d+ pixels of the mask"),
        ({"normals": np.zeros((H, W))}, r"three channels and perhaps alpha, not the shape"),
        ({"normals": np.zeros((H, W, 3))}, "the mask is empty"),
        ({"normals": np.full((H, W, 3), np.nan)}, "the mask is empty"),
        ({"normals": np.zeros((H, W, 3), complex)}, "normals: real numbers are needed"),
        ({"green": "left"}, "green='left' is neither 'up' nor 'down'"),
        ({"depth_scale": 0}, "depth_scale=0 is neither 'fit' nor a number other than 0"),
        ({"depth_scale": "big"}, "depth_scale='big' is neither"),
        ({"depth_scale": [1, 2]}, r"depth_scale=\[1, 2\] is neither"),
        ({"depth": np.ones((H, W)), "depth_scale": "fit"}, "doesn't vary as its normals do"),
        (
            {"depth_scale": "fit", "view": View((0, 0, 9), (0, 0, 0), (0, 1, 0))},
            "depth_scale='fit' needs a parallel view",
        ),
        (
            {"depth_scale": -1.0, "view": View((0, 0, 9), (0, 0, 0), (0, 1, 0))},
            "depths are not positive, so behind the eye",
        ),
    ],
)
def test_wrong_images_are_refused(cap, change, words):
    normals, depth, _ = cap
    given = {"normals": normals, "depth": depth} | change
    with pytest.raises(MeshdepictError, match=words):
        GBuffer.from_images(given.pop("normals"), **given)


def test_images_have_no_vertices_to_interpolate(cap):
    with pytest.raises(MeshdepictError, match="no vertices to interpolate: this came from images"):
        GBuffer.from_images(cap[0]).sample(np.zeros(3))


def test_pictures_that_are_too_large_are_refused():
    wide = np.zeros((1, 20_000, 3))
    wide[..., 2] = 1
    with pytest.raises(MeshdepictError, match="is not a width and a height from 1 to 16,384"):
        GBuffer.from_images(wide)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("none.png", None, "no such file"),
        ("text.png", b"not an image", "not an image that can be read"),
        ("cut.npy", b"\x93NUMPY", "not an image that can be read"),
    ],
)
def test_files_that_are_no_images_are_refused(tmp_path, name, content, words):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(MeshdepictError, match=words):
        GBuffer.from_images(path)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_truncated_pngs_are_refused(cap, tmp_path, kind):
    path = tmp_path / "cut.png"
    write_png(path, encoded(cap[0], kind))
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(MeshdepictError, match="not an image that can be read"):
        read_image(path)
