"""PNG files that are packed strip by strip: Pillow reads them."""

import io

import numpy as np
import pytest
from PIL import Image

from meshdepict.images.png_files import write_png


def read(data):
    image = Image.open(io.BytesIO(data))
    image.load()
    return image


@pytest.mark.parametrize("shape", [(1, 1), (7, 5), (40, 3000), (3000, 501)])
@pytest.mark.parametrize("gray", [False, True])
def test_pillow_reads_what_was_written(shape, gray):
    pixels = np.random.default_rng(0).integers(0, 256, (*shape, 3)).astype(np.uint8)
    if gray:
        pixels[..., 1:] = pixels[..., :1]
    stream = io.BytesIO()
    write_png(stream, pixels, {"meshdepict mesh": "größer → 3"})
    found = read(stream.getvalue())
    assert found.mode == ("L" if gray or shape == (0, 0) else "RGB")
    assert np.array_equal(np.asarray(found.convert("RGB")), pixels)
    assert found.text == {"meshdepict mesh": "größer → 3"}


def test_one_coloured_texel_in_the_last_row_keeps_all_colours():
    pixels = np.full((900, 2000, 3), 77, np.uint8)
    pixels[-1, -1, 2] = 78
    stream = io.BytesIO()
    write_png(stream, pixels)
    assert np.array_equal(np.asarray(read(stream.getvalue())), pixels)


def test_numbers_are_not_called_colours():
    pixels = np.zeros((4, 4, 3), np.uint8)
    files = []
    for srgb in (True, False):
        stream = io.BytesIO()
        write_png(stream, pixels, srgb=srgb)
        files.append(stream.getvalue())
    assert b"sRGB" in files[0]
    assert b"sRGB" not in files[1]


def test_the_same_picture_becomes_the_same_bytes_whatever_the_threads(monkeypatch):
    from meshdepict import threads

    pixels = np.random.default_rng(1).integers(0, 256, (1500, 2000, 3)).astype(np.uint8)
    files = []
    for count in (1, 3):
        monkeypatch.setattr(threads, "_limit", count)
        stream = io.BytesIO()
        write_png(stream, pixels)
        files.append(stream.getvalue())
    assert files[0] == files[1]
