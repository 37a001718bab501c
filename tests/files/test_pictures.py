"""Pictures and arrays of every kind of wrongness: one kind of exception, no warning."""

from __future__ import annotations

import io
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from meshdepict.errors import MeshdepictError
from meshdepict.files.pictures import mapped_array, opened_picture
from meshdepict.images.image_files import read_image
from meshdepict.scene.equirectangular import read_radiance
from meshdepict.shading.painted import sphere_picture

posix = pytest.mark.skipif(os.name != "posix", reason="needs a named pipe")


def png(width: int, height: int) -> bytes:
    """A PNG whose header claims a size and whose data are one row of zeros."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(bytes(1000))), (b"IEND", b""))
    body = b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in parts
    )
    return b"\x89PNG\r\n\x1a\n" + body


@pytest.mark.parametrize("size", [(10_000, 10_000), (60_000, 60_000), (2**31 - 1, 2**31 - 1)])
def test_a_picture_of_more_pixels_than_it_can_hold(tmp_path, size):
    """Between Pillow's warning, its error and all bounds."""
    path = tmp_path / "bomb.png"
    path.write_bytes(png(*size))
    for read in (read_image, sphere_picture):
        with pytest.raises(
            MeshdepictError, match=r"bomb.png: .*(claims more pixels|exceeds limit)"
        ):
            read(path)


@posix
@pytest.mark.parametrize("read", [read_image, read_radiance, sphere_picture, mapped_array])
def test_a_pipe_is_refused_before_it_is_opened(tmp_path, read):
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(MeshdepictError, match="is a named pipe, not a file"):
        read(tmp_path / "pipe.png")


def test_a_panorama_of_more_pixels_than_it_can_hold(tmp_path):
    path = tmp_path / "sky.hdr"
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999999 +X 99999999\n" + bytes(99))
    with pytest.raises(MeshdepictError, match="pixels, which a file of"):
        read_radiance(path)


def saved(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def with_header(text: bytes) -> bytes:
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + bytes(64)


@pytest.mark.parametrize(
    "content",
    [
        b"", b"\x93NUMPY", saved(np.zeros(9))[:-5],
        with_header(b"{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000000,), }"),
        with_header(b"{'descr': '<f8', 'fortran_order': False, 'shape': (3"),  # ends in a bracket
        with_header(b"(" * 5000), with_header(b"'" * 3), with_header(b"\n  x\n y"),
        with_header(b"{'descr': 'what', 'fortran_order': False, 'shape': (3,), }"),
        with_header(b"{'descr': '<f8', 'fortran_order': False, 'shape': (-3,), }"),
        with_header(b"{'descr': '|O', 'fortran_order': False, 'shape': (3,), }"),
        with_header(b"9" * 6000), saved(np.array([{}], object)),
    ],
)  # fmt: skip
def test_wrong_arrays_are_one_sentence(tmp_path, content):
    path = tmp_path / "a.npy"
    path.write_bytes(content)
    with pytest.raises(MeshdepictError, match=r"a\.npy: not an image that can be read") as caught:
        read_image(path)
    assert len(str(caught.value).splitlines()) == 1


def test_an_archive_is_no_array(tmp_path):
    with (tmp_path / "a.npy").open("wb") as file:
        np.savez(file, a=np.zeros(3))
    with pytest.raises(MeshdepictError, match="an archive of several arrays"):
        read_image(tmp_path / "a.npy")


@pytest.mark.parametrize("suffix", [".png", ".tif", ".bmp", ".jpg", ".gif", ".npy"])
def test_mutated_files_are_values_or_one_sentence(tmp_path, suffix):
    rng = np.random.default_rng(7)
    path = tmp_path / f"a{suffix}"
    pixels = rng.integers(0, 256, (9, 8, 3), dtype=np.uint8)
    if suffix == ".npy":
        np.save(path, pixels)
    else:
        Image.fromarray(pixels).save(path)
    whole = path.read_bytes()
    sentences, values = [], 0
    for _ in range(150):
        data = bytearray(whole)
        for at in rng.integers(0, len(data), rng.integers(1, 5)):
            data[at] = rng.integers(0, 256)
        path.write_bytes(data[: rng.integers(len(data) // 2, len(data) + 1)])
        try:
            values += read_image(path).ndim >= 0
        except MeshdepictError as error:
            sentences.append(str(error))
    assert values + len(sentences) == 150
    assert sentences
    assert all(len(sentence.splitlines()) == 1 for sentence in sentences)


def test_a_picture_is_read(tmp_path):
    path: Path = tmp_path / "a.png"
    Image.fromarray(np.zeros((4, 5, 3), np.uint8)).save(path)
    with opened_picture(path) as image:
        assert image.size == (5, 4)
