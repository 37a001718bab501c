"""An image's own colours under its shading: ``albedo="keep"`` of RGBN images and of views."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import samples
from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.gbuffer import GBuffer

UP = np.tile((0.0, 0.0, 1.0), (4, 6, 1))


@pytest.fixture
def paint(rng) -> np.ndarray:
    return rng.integers(0, 256, (4, 6, 3), dtype=np.uint8)


def kept(shape, **words) -> np.ndarray:
    words = {"light": "front", "scales": 1, **words}
    return md.bake(shape, "lambert", albedo="keep", **words).colors


def test_where_all_light_arrives_an_image_shows_its_own_colours(paint):
    image = GBuffer.from_images(UP, colors=paint)
    np.testing.assert_array_equal(image.colors, paint.reshape(-1, 3))
    np.testing.assert_array_equal(kept(image), paint.reshape(-1, 3))
    np.testing.assert_array_equal(kept(md.scale_space(image, scales=1), scales=None), image.colors)


def test_half_of_the_light_is_half_of_the_linear_colour(paint):
    image = GBuffer.from_images(UP, colors=paint)
    half = linear_to_srgb(0.5 * srgb_to_linear(image.colors / 255))
    found = kept(image, light=(0, np.sqrt(0.75), 0.5))
    # The grey of the shading is rounded to one of 256 levels first.
    assert np.abs(found - 255 * half).max() < 1.5


def test_colours_come_from_files_and_in_any_depth(tmp_path, paint):
    Image.fromarray(paint).save(tmp_path / "rgb.png")
    opaque = np.dstack((paint, np.full((4, 6), 255, np.uint8)))
    for given in (str(tmp_path / "rgb.png"), tmp_path / "rgb.png", paint / 255, opaque,
                  paint.astype(np.uint16) * 257):  # fmt: skip
        image = GBuffer.from_images(UP, colors=given)
        np.testing.assert_array_equal(image.colors, paint.reshape(-1, 3))


def test_a_view_of_a_coloured_mesh_shows_the_meshs_colours():
    ball = samples.sphere(500)
    count = len(ball.vertices)
    red, blue = np.full(count, 200, np.uint8), np.full(count, 30, np.uint8)
    mesh = md.Mesh(ball.vertices, ball.faces,
                   attributes={"vertex": {"red": red, "green": blue, "blue": blue}})  # fmt: skip
    seen = GBuffer.of(mesh, size=(16, 16))
    found, full = kept(seen), md.bake(seen, "lambert", light="front", scales=1)
    own = srgb_to_linear(np.array((200, 30, 30)) / 255)
    # The grey of the shading is rounded to one of 256 levels first.
    assert np.abs(found - 255 * linear_to_srgb(full.intensity[:, None] * own)).max() < 1.5


def test_an_image_without_colours_says_how_to_give_them():
    with pytest.raises(MeshdepictError, match=r"needs the image's own colours: .*colors="):
        kept(GBuffer.from_images(UP))
    with pytest.raises(MeshdepictError, match="the mesh has none"):
        kept(GBuffer.of(samples.sphere(200), size=(8, 8)))


@pytest.mark.parametrize(
    ("colors", "sentence"),
    [
        (np.zeros((4, 6)), "three channels and perhaps alpha"),
        (np.zeros((3, 6, 3)), "images of different sizes: colors"),
        (np.full((4, 6, 3), 1.5), "numbers from 0 to 1"),
        (np.full((4, 6, 3), np.nan), "numbers from 0 to 1"),
        (np.full((4, 6, 3), -1), "numbers from 0 to 1"),
        ("missing.png", "no such file"),
    ],
)
def test_what_is_no_colour_is_refused(colors, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        GBuffer.from_images(UP, colors=colors)


@pytest.mark.parametrize("level", [256, -1, 0.5])
def test_the_samples_colours_are_bytes(level):
    image = GBuffer.from_images(UP)
    with pytest.raises(MeshdepictError, match="whole numbers from 0 to 255"):
        GBuffer(image.view, image.mask, image.normals, image.depths, colors=np.full((24, 3), level))
