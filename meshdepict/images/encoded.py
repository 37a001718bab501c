"""Pictures as bytes: what a texture's file, or a part of another file, holds; and back."""

from __future__ import annotations

import io
import threading
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.files.pictures import ODD
from meshdepict.images.deep_tiff import deep_tiff

__all__ = ["KINDS", "decode", "encode", "is_color", "kind_of"]

KINDS = {
    "png": ("image/png", ".png"),
    "jpeg": ("image/jpeg", ".jpg"),
    "webp": ("image/webp", ".webp"),
    "tiff": ("image/tiff", ".tif"),
}
"""What pictures are called in glTF and as files, by kind."""

_LEAST = 4 * 16_384**2  # bytes: the largest textures there are may be all of one colour
_LIMIT = threading.Lock()
_QUALITY = 90  # of JPEG and WebP where nobody says: about a grey level


def kind_of(data: bytes) -> str:
    """Return which kind of picture some bytes begin like: one of `KINDS`, "bmp" …, or ""."""
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        return "png"
    if data.startswith(b"\xff\xd8\xff"):
        return "jpeg"
    if data[:4] == b"RIFF" and data[8:12] == b"WEBP":
        return "webp"
    if data[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
        return "tiff"
    others = ((b"BM", "bmp"), (b"GIF8", "gif"), (b"DDS ", "dds"), (b"\xabKTX", "ktx"))
    return next((kind for start, kind in others if data.startswith(start)), "")


def decode(data: bytes) -> NDArray[Any]:
    """Return a picture's pixels, (h, w, 3 or 4) of uint8 or uint16, row 0 on top.

    Grey becomes three equal channels, palettes their colours.

    Raises
    ------
    MeshdepictError
        For bytes that are no picture that can be read, and for one of an absurd size: a clause
        whose subject is the picture.
    """
    from meshdepict.images.deep_png import deep_png, deep_size

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Pillow's, of odd metadata
        try:
            if (size := deep_size(data)) is not None:
                _check_size(size, len(data) // 2)
                return _in_colour(deep_png(data))
            if (deep := deep_tiff(data)) is not None:
                return deep
            with _opened(data) as image:
                _check_size(image.size, len(data))
                return _pixels(image)
        except MeshdepictError:
            raise
        except (*ODD, OSError, ValueError) as error:
            said = " ".join(str(error).split()) or type(error).__name__
            said = "no kind of picture that is known" if "BytesIO" in said else said
            raise MeshdepictError(f"can't be read as a picture ({said:.120})") from None


def is_color(data: bytes) -> bool:
    """Whether a picture has three channels or more; its pixels aren't read.

    Raises
    ------
    MeshdepictError
        As `decode`, as far as the beginning tells.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with _opened(data) as image:
                return image.mode in ("RGB", "RGBA", "RGBX", "YCbCr", "CMYK", "LAB", "HSV")
        except (*ODD, OSError, ValueError):
            raise MeshdepictError("can't be read as a picture") from None


def _opened(data: bytes) -> Any:
    """Open a picture whose size `_check_size` judges, not Pillow, which stops at 179 megapixels."""
    from PIL import Image

    with _LIMIT:
        usual, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
        try:
            return Image.open(io.BytesIO(data))
        finally:
            Image.MAX_IMAGE_PIXELS = usual


def _check_size(size: tuple[int, int], length: int) -> None:
    width, height = size
    if width < 1 or height < 1:
        raise MeshdepictError("has no pixels")
    check_claim(4 * width * height, length, "pixels", least=_LEAST)


def _pixels(image: Any) -> NDArray[Any]:
    mode = image.mode
    if mode.startswith("I") or mode == "F":
        values = np.asarray(image)
        if mode == "F":
            values = np.rint(65535 * np.clip(np.nan_to_num(values), 0, 1))
        deep = np.clip(values, 0, 65535).astype(np.uint16)
        return _in_colour(deep[..., None])
    clear = mode in ("LA", "PA", "RGBA", "RGBa", "La") or "transparency" in image.info
    return np.array(image.convert("RGBA" if clear else "RGB"))


def _in_colour(pixels: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Return grey, and grey with alpha, as three equal channels, and alpha."""
    if pixels.shape[2] > 2:
        return pixels
    return np.ascontiguousarray(pixels[..., [0, 0, 0, *range(1, pixels.shape[2])]])


def encode(pixels: NDArray[Any], kind: str = "png", *, quality: int | None = None) -> bytes:
    """Return pixels as the bytes of a picture's file.

    Parameters
    ----------
    pixels : (h, w), (h, w, 3) or (h, w, 4) array of uint8; of uint16, too, as PNG
    kind : {"png", "jpeg", "webp"}
        PNG and, at the quality 100, WebP are exact. JPEG has no alpha: it is left out.
    quality : int, optional
        Of JPEG and WebP, 1 … 100; 90 unless given.

    Raises
    ------
    MeshdepictError
        For another kind or quality, and for pixels that the kind can't hold.
    """
    from PIL import Image

    array = np.ascontiguousarray(pixels)
    shaped = array.ndim == 2 or (array.ndim == 3 and array.shape[2] in (3, 4))
    if not shaped or array.size == 0 or array.dtype not in (np.uint8, np.uint16):
        raise MeshdepictError(
            "a picture is (h, w), (h, w, 3) or (h, w, 4) pixels of uint8 or uint16, not "
            f"{array.dtype} of shape {array.shape}"
        )
    if kind not in ("png", "jpeg", "webp"):
        raise MeshdepictError(f"pictures are written as png, jpeg or webp, not as {kind!r}")
    if array.dtype == np.uint16:
        if kind != "png":
            raise MeshdepictError(f"{kind} holds 8 bits a channel: write 16 as png")
        return _encoded_deep(array)
    level = _QUALITY if quality is None else quality
    if isinstance(level, bool) or not isinstance(level, int) or not 1 <= level <= 100:
        raise MeshdepictError(f"quality={quality!r} is no whole number from 1 to 100")
    limit = {"jpeg": 65_535, "webp": 16_383}.get(kind)
    if limit is not None and max(array.shape[:2]) > limit:
        raise MeshdepictError(f"{kind} holds {limit:,} pixels across at most: write png")
    if kind == "jpeg" and array.ndim == 3:
        array = np.ascontiguousarray(array[..., :3])
    written = io.BytesIO()
    image = Image.fromarray(array)
    if kind == "png":
        image.save(written, "PNG")
    elif kind == "jpeg":
        # Colours as fine as brightness: a depiction's lines are in both.
        image.save(written, "JPEG", quality=level, subsampling=0)
    else:
        image.save(written, "WEBP", quality=level, lossless=level == 100, exact=True)
    return written.getvalue()


def _encoded_deep(array: NDArray[np.uint16]) -> bytes:
    """Return 16 bits a channel as PNG, which Pillow doesn't write in colour."""
    import struct
    import zlib

    height, width = array.shape[:2]
    channels = array.shape[2] if array.ndim == 3 else 1
    rows = np.zeros((height, 1 + 2 * channels * width), np.uint8)  # first of each: no filter
    rows[:, 1:] = array.astype(">u2").reshape(height, -1).view(np.uint8)
    kind = {1: 0, 3: 2, 4: 6}[channels]
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 16, kind, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows.tobytes(), 6)),
        (b"IEND", b""),
    )
    written = b"\x89PNG\r\n\x1a\n"
    for name, body in chunks:
        written += struct.pack(">I", len(body)) + name + body
        written += struct.pack(">I", zlib.crc32(name + body))
    return written
