"""Pictures as bytes: every kind and depth there and back, by others, and what is none."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import set_max_memory
from meshdepict.images.encoded import KINDS, decode, encode, is_color, kind_of


def picture(
    channels: int = 3, kind: type = np.uint8, size: tuple[int, int] = (13, 17)
) -> np.ndarray:
    shape = (*size, channels) if channels > 1 else size
    rng = np.random.default_rng(channels)
    return rng.integers(0, np.iinfo(kind).max, shape, endpoint=True).astype(kind)


def smooth() -> np.ndarray:
    x, y = np.meshgrid(np.linspace(0, 255, 64), np.linspace(0, 255, 48))
    return np.stack([x, y, 255 - x], axis=2).astype(np.uint8)


def in_colour(pixels: np.ndarray) -> np.ndarray:
    return pixels if pixels.ndim == 3 else np.repeat(pixels[..., None], 3, axis=2)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_png_comes_back_as_it_was(channels, kind):
    pixels = picture(channels, kind)
    data = encode(pixels)
    assert kind_of(data) == "png"
    found = decode(data)
    assert found.dtype == kind
    np.testing.assert_array_equal(found, in_colour(pixels))


@pytest.mark.parametrize("laced", [False, True])
@pytest.mark.parametrize("channels", [2, 3, 4])
def test_png_of_16_bits_in_every_filter(channels, laced):
    """Row after row another one, undone by its definition; in one pass, or in Adam7's seven."""
    width, height = 21, 11
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 65536, (height, width, channels)).astype(np.uint16)
    passes = [(0, 0, 1, 1)]
    if laced:
        passes = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4),
                  (1, 0, 2, 2), (0, 1, 1, 2)]  # fmt: skip
    raw = b""
    for x, y, dx, dy in passes:
        part = pixels[y::dy, x::dx].astype(">u2")
        raw += b"".join(filtered(part.reshape(len(part), -1).view(np.uint8), 2 * channels))
    kind = {2: 4, 3: 2, 4: 6}[channels]
    data = png_of(struct.pack(">IIBBBBB", width, height, 16, kind, 0, 0, laced), raw)
    colour = pixels if channels > 2 else pixels[..., [0, 0, 0, 1]]
    np.testing.assert_array_equal(decode(data), colour)
    if channels > 2:  # Pillow, which keeps the upper half
        np.testing.assert_array_equal(np.asarray(Image.open(io.BytesIO(data))), pixels >> 8)
    packed = png_of(struct.pack(">IIBBBBB", width, height, 16, kind, 0, 0, laced), b"\7" + raw[1:])
    with pytest.raises(MeshdepictError, match="rows of an unknown kind"):
        decode(packed)


def filtered(lines: np.ndarray, wide: int) -> list[bytes]:
    """Rows of bytes less what the five filters guess of them, one after the other."""
    found = []
    above = np.zeros(lines.shape[1], int)
    for number, line in enumerate(lines.astype(int)):
        left = np.concatenate([np.zeros(wide, int), line[:-wide]])
        corner = np.concatenate([np.zeros(wide, int), above[:-wide]])
        near = np.stack([left, above, corner])
        paeth = near[np.abs(near - (left + above - corner)).argmin(axis=0), np.arange(len(line))]
        guess = (0 * line, left, above, (left + above) // 2, paeth)[number % 5]
        found.append(bytes([number % 5]) + ((line - guess) % 256).astype(np.uint8).tobytes())
        above = line
    return found


def png_of(head: bytes, raw: bytes) -> bytes:
    written = b"\x89PNG\r\n\x1a\n"
    packed = zlib.compress(raw)
    for name, body in (
        (b"IHDR", head), (b"IDAT", packed[:40]), (b"IDAT", packed[40:]), (b"IEND", b"")
    ):  # fmt: skip
        written += struct.pack(">I", len(body)) + name + body
        written += struct.pack(">I", zlib.crc32(name + body))
    return written


def test_others_read_16_bits(tmp_path):
    """VTK all of them, Pillow their upper half."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader

    pixels = picture(3, np.uint16)
    data = encode(pixels)
    (tmp_path / "deep.png").write_bytes(data)
    reader = vtkPNGReader()
    reader.SetFileName(str(tmp_path / "deep.png"))
    reader.Update()
    theirs = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    np.testing.assert_array_equal(theirs.reshape(pixels.shape)[::-1], pixels)
    np.testing.assert_array_equal(np.asarray(Image.open(io.BytesIO(data))), pixels >> 8)


@pytest.mark.parametrize("kind", ["jpeg", "webp"])
def test_quality_is_a_trade_of_size_for_accuracy(kind):
    pixels = smooth()
    rough, fine = (encode(pixels, kind, quality=quality) for quality in (20, 95))
    assert kind_of(fine) == kind
    assert len(rough) < len(fine)
    errors = [np.abs(decode(data).astype(int) - pixels).mean() for data in (rough, fine)]
    assert errors[1] < errors[0]
    assert errors[1] < 1.5


@pytest.mark.parametrize("channels", [3, 4])
def test_webp_of_full_quality_is_exact(channels):
    pixels = picture(channels)
    np.testing.assert_array_equal(decode(encode(pixels, "webp", quality=100)), pixels)


def test_jpeg_leaves_alpha_out():
    assert decode(encode(picture(4), "jpeg")).shape == (13, 17, 3)


@pytest.mark.parametrize("packing", [None, "tiff_lzw", "tiff_deflate", "jpeg"])
def test_tiff_of_8_bits(packing):
    written = io.BytesIO()
    Image.fromarray(smooth()).save(written, "TIFF", compression=packing)
    found = decode(written.getvalue())
    assert np.abs(found.astype(int) - smooth()).mean() < (2 if packing == "jpeg" else 1e-9)


def deep_tiff(
    pixels: np.ndarray, order: str, *, rows: int, deflate: bool, predictor: int = 1, tile: int = 0
) -> bytes:
    """A TIFF of 16 bits a channel, put together by hand."""
    height, width, samples = pixels.shape
    across, down = (tile, tile) if tile else (width, rows)
    pieces = []
    for top in range(0, height, down):
        for left in range(0, width, across):
            piece = pixels[top : top + down, left : left + across]
            if tile:
                piece = np.pad(
                    piece, [(0, tile - piece.shape[0]), (0, tile - piece.shape[1]), (0, 0)]
                )
            if predictor == 2:
                piece = np.diff(piece, axis=1, prepend=np.zeros_like(piece[:, :1]))
            raw = piece.astype(f"{order}u2").tobytes()
            pieces.append(zlib.compress(raw) if deflate else raw)
    lists = {
        256: [width], 257: [height], 258: [16] * samples, 259: [8 if deflate else 1], 262: [2],
        277: [samples], 317: [predictor],
        **({322: [tile], 323: [tile]} if tile else {278: [rows]}),
    }  # fmt: skip
    starts, lengths = (324, 325) if tile else (273, 279)
    lists |= {starts: [0] * len(pieces), lengths: [len(piece) for piece in pieces]}
    size = 8 + 2 + 12 * len(lists) + 4
    at = size + sum(4 * len(values) for values in lists.values() if len(values) > 1)
    lists[starts] = [at + sum(map(len, pieces[:k])) for k in range(len(pieces))]
    head, more = b"", b""
    for tag, values in sorted(lists.items()):
        if len(values) > 1:
            value = struct.pack(f"{order}I", size + len(more))
            more += struct.pack(f"{order}{len(values)}I", *values)
        else:
            value = struct.pack(f"{order}I", *values)
        head += struct.pack(f"{order}HHI", tag, 4, len(values)) + value
    start = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(f"{order}I", 8)
    return start + struct.pack(f"{order}H", len(lists)) + head + b"\0" * 4 + more + b"".join(pieces)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(
    "how",
    [
        {"rows": 13, "deflate": False},
        {"rows": 5, "deflate": True},
        {"rows": 4, "deflate": True, "predictor": 2},
        {"rows": 1, "deflate": True, "tile": 16},
    ],
)
def test_tiff_of_16_bits_keeps_them(order, how):
    for channels in (3, 4):
        pixels = picture(channels, np.uint16, (13, 33))
        found = decode(deep_tiff(pixels, order, **how))
        assert found.dtype == np.uint16
        np.testing.assert_array_equal(found, pixels)


def test_rasterio_agrees_about_tiff_of_16_bits(recwarn):
    memory = pytest.importorskip("rasterio.io").MemoryFile
    pixels = picture(3, np.uint16)
    for how in (
        {"rows": 5, "deflate": True, "predictor": 2},
        {"rows": 1, "deflate": False, "tile": 16},
    ):
        with memory(deep_tiff(pixels, "<", **how)) as file, file.open() as raster:
            np.testing.assert_array_equal(np.moveaxis(raster.read(), 0, 2), pixels)
    recwarn.clear()  # that it lies nowhere on a map


@pytest.mark.parametrize("how", [{"predictor": 1}, {"predictor": 2}, {"tiled": True}])
@pytest.mark.parametrize("packing", ["lzw", "packbits"])
@pytest.mark.parametrize("endian", ["little", "big"])
def test_packed_tiff_of_16_bits_as_rasterio_writes_it(packing, how, endian, recwarn):
    memory = pytest.importorskip("rasterio.io").MemoryFile
    pixels = picture(3, np.uint16, (37, 53))
    pixels[:9] = 1234  # what can be packed
    words = {"driver": "GTiff", "count": 3, "dtype": "uint16", "height": 37, "width": 53}
    words |= {"compress": packing, "endianness": endian, "interleave": "pixel"} | how
    if how.get("tiled"):
        words |= {"blockxsize": 16, "blockysize": 16}
    with memory() as file:
        with file.open(**words) as raster:
            raster.write(np.moveaxis(pixels, 2, 0))
        data = file.read()
    found = decode(data)
    assert found.dtype == np.uint16
    np.testing.assert_array_equal(found, pixels)
    with pytest.raises(MeshdepictError, match="can't be read as a picture"):
        decode(data[: len(data) - 400])
    recwarn.clear()  # that it lies nowhere on a map


def test_grey_of_16_bits_floats_and_palettes():
    grey = picture(1, np.uint16)
    written = io.BytesIO()
    Image.fromarray(grey).save(written, "TIFF")
    np.testing.assert_array_equal(decode(written.getvalue()), in_colour(grey))
    fractions = np.array([[0, 0.5, 1, 7, np.nan]], np.float32)
    written = io.BytesIO()
    Image.fromarray(fractions).save(written, "TIFF")
    assert decode(written.getvalue())[0, :, 0].tolist() == [0, 32768, 65535, 65535, 0]
    written = io.BytesIO()
    Image.fromarray(smooth() // 64 * 64).quantize(64).save(written, "PNG")
    assert np.abs(decode(written.getvalue()).astype(int) - smooth() // 64 * 64).max() < 3


def test_colour_is_told_from_grey_without_reading_pixels():
    assert is_color(encode(picture()))
    assert is_color(encode(picture(), "jpeg")[:700])
    assert not is_color(encode(picture(1)))
    with pytest.raises(MeshdepictError, match="can't be read as a picture"):
        is_color(b"no")


def test_what_is_no_picture_is_one_sentence():
    whole = [encode(picture()), encode(picture(3, np.uint16)), encode(smooth(), "jpeg")]
    cut = [data[: len(data) // 2] for data in whole]
    deep = deep_tiff(picture(3, np.uint16), "<", rows=5, deflate=True)
    packings = [struct.pack("<HHII", 259, 4, 1, packing) for packing in (8, 7)]
    odd = [deep[:-40], deep[:30], deep.replace(*packings)]
    for data in (b"", b"GIF8", *cut, *odd):
        with pytest.raises(MeshdepictError, match=r"^(can't be read as a picture \(|is a TIFF)"):
            decode(data)


def test_a_picture_of_absurd_size_is_refused_before_it_is_unpacked():
    assert not is_color(encode(np.zeros((14_000, 14_000), np.uint8)))  # more than Pillow opens
    claim = b"\x89PNG\r\n\x1a\n"
    for name, body in (
        (b"IHDR", struct.pack(">IIBBBBB", 60_000, 60_000, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(b"")),
        (b"IEND", b""),
    ):
        claim += (
            struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        )
    with pytest.raises(MeshdepictError, match="claims more pixels"):
        decode(claim)
    set_max_memory("1kB")
    try:
        with pytest.raises(MeshdepictError, match="claims more pixels"):
            decode(encode(smooth()))
    finally:
        set_max_memory(None)


@pytest.mark.parametrize(
    ("pixels", "words", "said"),
    [
        (np.zeros((2, 2, 2), np.uint8), {}, "a picture is"),
        (np.zeros((0, 2, 3), np.uint8), {}, "a picture is"),
        (np.zeros((2, 2, 3)), {}, "not float64 of shape"),
        (np.zeros((2, 2, 3), np.uint8), {"kind": "gif"}, "not as 'gif'"),
        (np.zeros((2, 2, 3), np.uint16), {"kind": "jpeg"}, "jpeg holds 8 bits a channel"),
        (np.zeros((2, 2, 3), np.uint8), {"kind": "jpeg", "quality": 0}, "quality=0 is no whole"),
        (np.zeros((2, 2, 3), np.uint8), {"kind": "webp", "quality": 7.5}, "quality=7.5 is no"),
        (np.zeros((1, 16_384, 3), np.uint8), {"kind": "webp"}, "16,383 pixels across at most"),
    ],
)
def test_what_cannot_be_written_is_one_sentence(pixels, words, said):
    with pytest.raises(MeshdepictError, match=said):
        encode(pixels, **words)


def test_kinds_have_a_name_in_gltf_and_a_suffix():
    assert {kind_of(encode(picture(), kind)) for kind in ("png", "jpeg", "webp")} < set(KINDS)
    assert kind_of(b"BM....") == "bmp"
    assert kind_of(b"?") == ""
