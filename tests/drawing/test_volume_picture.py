"""Pictures of volumes: grounds, sizes, what they say, and what is refused."""

import dataclasses

import numpy as np
import pytest
from PIL import Image
from volume_shapes import SOLID, blobs

from meshdepict.baking.look import bake_volume
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.picture_files import read_picture_provenance
from meshdepict.drawing.volume_picture import draw_volume, save_volume_picture
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.windows.clipping_box import ClippingBox

pytest.importorskip("pyvista")


@pytest.fixture(scope="module")
def baked():
    return bake_volume(blobs(), "lambert", transfer=SOLID, light="front", up="y")


@pytest.mark.parametrize(
    ("background", "ground"), [("white", (255, 255, 255)), ("#102030", (16, 32, 48))]
)
def test_round_the_volume_is_the_ground(baked, background, ground):
    image = np.asarray(draw_volume(baked, Figure(size=(90, 80), background=background)))
    assert image.shape == (80, 90, 3)
    assert (image[:3] == ground).all()
    assert (image[30:50, 30:60] != ground).any()


def test_a_transparent_ground_changes_no_colour(baked):
    clear = np.asarray(draw_volume(baked, Figure(size=(90, 90), background="transparent")))
    white = np.asarray(draw_volume(baked, Figure(size=(90, 90))))
    whole = clear[..., 3] == 255
    assert whole.any()
    np.testing.assert_array_equal(clear[whole][:, :3], white[whole])
    assert (clear[0, 0] == 0).all()


def test_at_a_scale_the_picture_is_as_large_as_the_volume(baked):
    image = draw_volume(baked, Figure(pixels_per_unit=10.0))
    extent = np.ptp(baked.shape.outline, axis=0)[:2] * 10 * 1.05  # the margin
    assert abs(np.array(image.size) - extent).max() <= 3


def test_a_scale_bar_lies_below(baked):
    figure = Figure(size=(120, 120), scale_bar=True, unit="mm")
    image = np.asarray(draw_volume(baked, figure).convert("L"))
    assert (image[-20:] < 128).any()


def test_files_say_how_they_came_about(baked, tmp_path):
    path = save_volume_picture(baked, tmp_path / "a.png", Figure(size=(40, 40), dpi=200))
    lines = read_picture_provenance(path)
    assert "meshdepict method: lambert" in lines
    with Image.open(path) as image:
        assert image.size == (40, 40)
        assert image.info["dpi"] == pytest.approx((200, 200), abs=0.1)
    path = save_volume_picture(baked, tmp_path / "b.png", Figure(size=(40, 40)), plain=True)
    assert "meshdepict method: plain volume rendering" in read_picture_provenance(path)


def test_plain_pictures_are_vtks(baked):
    figure = Figure(size=(90, 90))
    plain = np.asarray(draw_volume(baked, figure, plain=True)).astype(int)
    ours = np.asarray(draw_volume(baked, figure)).astype(int)
    there = (ours < 250).any(axis=2)
    assert np.abs(plain - ours)[there].mean() > 5


def test_planes_cut_off(baked):
    box = ClippingBox(baked.shape)
    for _ in range(10):
        box.cut(0, (1, 0, 0))
    figure = Figure(size=(90, 90), background="transparent")
    for plain in (False, True):
        whole = np.asarray(draw_volume(baked, figure, plain=plain))[..., 3] > 128
        half = draw_volume(baked, figure, plain=plain, planes=box.planes())
        half = np.asarray(half)[..., 3] > 128
        assert whole[:, 48:].any()
        assert not half[:, 48:].any()
        assert (half[:, :43] == whole[:, :43]).mean() > 0.99


def test_what_can_t_be_drawn_is_refused(baked, tmp_path):
    with pytest.raises(MeshdepictError, match=r"end the name with \.png"):
        save_volume_picture(baked, tmp_path / "a.tif")
    bare = bake_volume(baked.space, "lambert")
    bare._shading = dataclasses.replace(bare._shading, transfer=None)
    with pytest.raises(MeshdepictError, match="needs a transfer function, and this bake has none"):
        draw_volume(bare, plain=True)


def test_the_real_head_shows_its_face(data):
    from meshdepict.io.volumes import read_volume

    head = read_volume(data / "ct" / "ct_headsq_64x64x93.nrrd")
    with pytest.warns(UserWarning, match="not in Hounsfield units"):
        baked = bake_volume(head, "lambert", transfer="skin", up="-z", light="north")
    image = np.asarray(draw_volume(baked, Figure(size=(200, 200), background="transparent")))
    there = image[..., 3] > 200
    assert 0.3 < there.mean() < 0.9
    # +z points to the feet: with up = "-z" the ears, the widest place, are in the upper half.
    widths = there.sum(axis=1)
    rows = np.flatnonzero(widths)
    assert rows[0] < widths.argmax() < rows.mean()
