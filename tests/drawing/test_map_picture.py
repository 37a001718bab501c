"""The map of terrain: its raster is the picture, however it lies; other pictures show its cells."""

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict.drawing import map_picture, picture
from meshdepict.drawing.canvas import canvas
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.heights.cells import METRES_PER_DEGREE
from meshdepict.scene.view import View

pytest.importorskip("pyvista")

# How rows and columns may run, and what turns the raster so that north is up and east to the right.
LYING = {
    "north up": ((1, 0, 5, 0, -1, 9), lambda raster: raster),
    "south up": ((1, 0, 5, 0, 1, 9), lambda raster: raster[::-1]),
    "east to west": ((-2, 0, 5, 0, -2, 9), lambda raster: raster[:, ::-1]),
    "columns north": ((0, 1, 0, 1, 0, 0), lambda raster: raster.swapaxes(0, 1)[::-1]),
    "columns south": ((0, -1, 0, -1, 0, 0), lambda raster: raster.swapaxes(0, 1)[:, ::-1]),
}


def hills(rows=60, columns=80, *, hole=True, **given):
    y, x = np.mgrid[:rows, :columns] + 0.0
    z = 9 * np.exp(-((x - columns / 3) ** 2 + (y - rows / 2) ** 2) / 150) + np.sin(x / 3)
    if hole:
        z[10:20, 30:45] = np.nan
    return md.HeightField(z, **given)


def pixels(baked, path, **layout):
    baked.picture(path, **layout)
    with Image.open(path) as image:
        return np.asarray(image.convert("RGBA" if image.mode == "RGBA" else "RGB"))


@pytest.mark.parametrize("name", LYING)
def test_a_pixel_is_a_cell(tmp_path, name):
    transform, turned = LYING[name]
    field = hills(320, 510, transform=transform)
    baked = md.bake(field, "lambert")
    shown = pixels(baked, tmp_path / "a.png", background="transparent")
    expected = turned(field.image(np.column_stack([baked.colors, np.full(field.count, 255)])))
    np.testing.assert_array_equal(shown, expected)


def test_cells_of_small_rasters_are_squares_of_pixels(tmp_path):
    field = hills()
    baked = md.bake(field, "lambert")
    shown = pixels(baked, tmp_path / "a.png")
    assert shown.shape == (360, 480, 3)  # six pixels along a side: 480 of 500
    blocks = shown.reshape(60, 6, 80, 6, 3)
    expected = field.image(baked.colors, background=255)
    np.testing.assert_array_equal(blocks, np.broadcast_to(expected[:, None, :, None], blocks.shape))


def test_a_caption_stands_below_the_raster(tmp_path):
    baked = md.bake(hills(), "lambert")
    plain = pixels(baked, tmp_path / "a.png")
    shown = pixels(baked, tmp_path / "b.png", caption="two words")
    assert shown.shape[0] > plain.shape[0]
    np.testing.assert_array_equal(shown[: len(plain)], plain)


@pytest.mark.parametrize("transform", [LYING["south up"][0], (0.8, 0.6, 0, 0.6, -0.8, 0)])
def test_a_map_of_a_size_shows_what_the_mesh_does(transform):
    baked = md.bake(hills(transform=transform), "lambert")
    framing = frame(baked.view, baked.shape, Figure(size=(400, 300)))
    cells = picture.drawn(baked, framing.view, framing.drawn).astype(int)
    with canvas(baked, framing.drawn) as drawing:
        mesh = drawing.draw(framing.view).astype(int)
    both = (cells[..., 3] == 255) & (mesh[..., 3] == 255)
    assert both.mean() > 0.3
    # The mesh's colours change along an edge, the cells' at its middle.
    change = np.abs(np.diff(baked.shape.image(baked.colors[:, 0]).astype(int), axis=1)).mean()
    assert np.abs(cells - mesh)[both].mean() < change
    # Half a cell more at each border, and the cells round the hole.
    assert (cells[..., 3] > 0).mean() - (mesh[..., 3] > 0).mean() < 0.03


def test_cells_that_share_a_pixel_are_averaged():
    rng = np.random.default_rng(3)
    field = hills(64, 64, hole=False)
    baked = md.bake(field, "lambert")
    baked.colors = rng.integers(0, 256, baked.colors.shape, dtype=np.uint8)
    middle = (*field.points.mean(axis=0)[:2], 0)
    view = View((*middle[:2], 99), middle, (0, 1, 0), parallel_scale=32)
    shown = map_picture.draw_map(baked, view, (16, 16))  # four cells along a pixel's side
    means = field.image(baked.colors).reshape(16, 4, 16, 4, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(shown[..., :3], means, rtol=0, atol=0.5)
    assert (shown[..., 3] == 255).all()


def test_rows_of_degrees_are_as_wide_as_they_are():
    field = hills(40, 40, hole=False, transform=(0.5, 0, -10, 0, -0.5, 79), degrees=True)
    baked = md.bake(field, "lambert")
    framing = frame(baked.view, field, Figure(size=(200, 200)))
    covered = picture.drawn(baked, framing.view, framing.drawn)[..., 3] > 127
    low, high = framing.view.focus[1] + np.array([-1, 1]) * framing.view.parallel_scale
    north = high - (np.arange(200) + 0.5) * (high - low) / 200
    wide = covered.sum(axis=1) * (high - low) / 200
    latitude = np.round((north / METRES_PER_DEGREE - 0.25) * 2) / 2 + 0.25  # of the row there
    inside = (latitude > 59.5) & (latitude < 78.5)
    expected = 20 * METRES_PER_DEGREE * np.cos(np.radians(latitude))
    assert inside.sum() > 100
    pixel = (high - low) / 200  # one at each end, and lines that two rows share
    assert np.abs(wide - expected)[inside].max() <= 2 * pixel


@pytest.mark.parametrize("shape", [(1, 12), (12, 1), (1, 1)])
def test_a_single_row_has_a_picture_though_it_is_no_surface(tmp_path, shape):
    z = np.sin(np.arange(12.0))[: max(shape)].reshape(shape)
    baked = md.bake(md.HeightField(z), "lambert")
    side = 500 // max(shape)
    assert pixels(baked, tmp_path / "a.png").shape == (side * shape[0], side * shape[1], 3)
    assert pixels(baked, tmp_path / "b.png", size=(60, 40)).shape == (40, 60, 3)
    assert baked._repr_png_()[:4] == b"\x89PNG"


def test_other_views_and_scale_bars_are_drawn_as_of_any_object(tmp_path):
    field = hills()
    assert pixels(md.bake(field, "lambert", view="isometric"), tmp_path / "a.png").shape == (
        1000, 1000, 3
    )  # fmt: skip
    baked = md.bake(field, "lambert")
    barred = pixels(baked, tmp_path / "b.png", scale_bar=True)
    assert barred.shape == (1000, 1000, 3)
    scaled = pixels(baked, tmp_path / "c.png", pixels_per_unit=2)
    assert abs(scaled.shape[1] - 2 * 79 * 1.05) <= 4
    turned = md.bake(hills(transform=(0.8, 0.6, 0, 0.6, -0.8, 0)), "lambert")
    assert pixels(turned, tmp_path / "d.png").shape == (1000, 1000, 3)


def test_rasters_wider_than_pictures_can_be_are_made_smaller(tmp_path):
    baked = md.bake(md.HeightField(np.zeros((1, 16385))), "lambert")
    assert pixels(baked, tmp_path / "a.png").shape == (1000, 1000, 3)


def test_pixels_that_a_width_counts_are_the_picture_s(tmp_path):
    from meshdepict.baking.pixel_widths import measured

    field = hills(transform=(2, 0, 0, 0, -2, 0))
    look = md.Look("exaggerated", width="3px")
    assert measured(look, field, Figure()).width == pytest.approx(3 * 2 / 6)  # six to a cell of 2 m
