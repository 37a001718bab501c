"""The numbers of a DICOM file's pixels as they are stored: nothing inverted, nothing rescaled.

What isn't compressed is read here; GDCM, through SimpleITK, unpacks the rest. It is handed the bare
pixels, so that it has nothing to interpret.
"""

from __future__ import annotations

import struct
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.library_noise import library_noise
from meshdepict.files.limits import check_claim
from meshdepict.io.dicom_fragments import RLE, check_jpeg, fragments_of, unpacked_runs
from meshdepict.io.dicom_header import Slice
from meshdepict.io.itk import array_of, reason, simpleitk

__all__ = ["stored_numbers"]

_PLAIN = (
    "1.2.840.10008.1.2", "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.2", "1.2.840.10008.1.2.1.99",
)  # fmt: skip
_LEAST = 64 << 20  # bytes that the smallest file may unpack to: a picture of 5,800² in 16 bits
_WHOLE = (8, 16, 32)  # bits that a number takes
_CAPTURE = "1.2.840.10008.5.1.4.1.1.7.3"  # of many frames, in 16 bits: no meaning but its numbers


def stored_numbers(one: Slice, notes: list[str]) -> tuple[NDArray[Any], NDArray[np.bool_] | None]:
    """Return all frames' stored numbers (frames, rows, columns), and where they are padding.

    Parameters
    ----------
    one : Slice
    notes : list of str
        Gets a clause where unpacking met something odd.

    Raises
    ------
    MeshdepictError
        For colours, pixels of odd sizes, more or fewer pixels than the header claims, and damaged
        ones: one clause whose subject is the file or its folder.
    """
    columns, rows, frames = one.size
    name = one.path.name
    samples = int(one.number("0028|0002", 1))
    if samples != 1:
        raise MeshdepictError(f"holds colours ({samples} values in a pixel), not CT: {name}")
    look = one.tag("0028|0004")
    if not look.startswith("MONOCHROME") and look:
        raise MeshdepictError(f"holds colours ({look.lower()}), not CT: {name}")
    bits = int(one.number("0028|0100", 16))
    kind = one.file.kind
    if not kind and bits not in _WHOLE:
        raise MeshdepictError(f"has {bits} bits in a pixel, not 8, 16 or 32: {name}")
    itemsize = int(kind[1]) if kind else bits // 8
    if not kind:
        _bits(one)
    assert one.file.pixels is not None  # `headers` left out what has none
    start, length = one.file.pixels
    if one.file.syntax in _PLAIN and length >= 0:
        _check_length(one, length, columns * rows * itemsize)
        raw = _plain(one, start, kind or f"u{itemsize}", (frames, rows, columns))
    else:
        needed = columns * rows * frames * itemsize
        check_claim(needed, one.path.stat().st_size, "pixels", least=_LEAST)
        raw = _unpacked(one, start, f"u{itemsize}", notes)
    if kind:
        return raw, None
    return _meaning(one, raw)


def _check_length(one: Slice, length: int, frame: int) -> None:
    """Refuse a file that holds other pixels than its header claims."""
    name = one.path.name
    if length < frame * one.frames:
        raise MeshdepictError(
            f"is cut off: {name} holds fewer pixels than the {one.frames:,} frames of "
            f"{one.size[0]:,} x {one.size[1]:,} that its header claims"
        )
    if length - frame * one.frames >= frame:
        raise MeshdepictError(
            f"holds {length // frame:,} frames in {name}, but the header claims {one.frames:,}: "
            "correct the header"
        )


def _plain(one: Slice, start: int, kind: str, shape: tuple[int, ...]) -> NDArray[Any]:
    dtype = np.dtype(kind).newbyteorder(one.file.order)  # type: ignore[arg-type]
    count = int(np.prod(shape))
    if len(one.file.data):  # deflated
        return np.frombuffer(one.file.data, dtype, count, start).reshape(shape)
    return np.fromfile(one.path, dtype, count, offset=start).reshape(shape)


def _meaning(one: Slice, raw: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.bool_] | None]:
    """Return bits as numbers: those stored, with their sign; and where these are padding."""
    bits, used, high = _bits(one)
    signed = one.tag("0028|0103") == "1"
    kind = np.dtype(f"{'i' if signed else 'u'}{bits // 8}")
    whole = raw.astype(raw.dtype.newbyteorder("="), copy=False)
    numbers = whole.view(kind)
    padded = _padded(one, numbers)  # often beyond the bits that are used
    if used < bits:
        up = bits - 1 - high
        numbers = (whole << up).view(kind) >> (bits - used)
        if one.stored_padding is not None:
            padded = _padded(one, numbers) if padded is None else padded | _padded(one, numbers)
    return numbers, padded


def _bits(one: Slice) -> tuple[int, int, int]:
    """Return how many bits a number takes, how many of them are used, and the highest of these."""
    bits = int(one.number("0028|0100", 16))
    used = int(one.number("0028|0101", bits))
    high = int(one.number("0028|0102", used - 1))
    if not 0 < used <= bits or not used - 1 <= high < bits:
        raise MeshdepictError(
            f"says that {used:g} of {bits} bits are used, up to bit {high:g}, in {one.path.name}: "
            "that can't be"
        )
    return bits, used, high


def _padded(one: Slice, numbers: NDArray[Any]) -> Any:
    if one.stored_padding is None:
        return None
    low, high = one.stored_padding
    return (numbers >= low) & (numbers <= high)


def _unpacked(one: Slice, start: int, kind: str, notes: list[str]) -> NDArray[Any]:
    """Unpack a file's fragments, or let GDCM do so."""
    shape, name = one.size[::-1], one.path.name
    fragments, packed = _fragments(one, start)
    if one.file.syntax == RLE:
        return unpacked_runs(fragments[1:], shape, np.dtype(kind).itemsize, name)
    check_jpeg(fragments[1:], shape[1], shape[2], 8 * np.dtype(kind).itemsize, name)
    noise: list[str] = []
    with simpleitk([]) as sitk, tempfile.TemporaryDirectory() as folder:
        bare = Path(folder, "bare.dcm")
        bare.write_bytes(_bare(one, packed))
        try:
            with library_noise(noise):
                image = sitk.ReadImage(str(bare), imageIO="GDCMImageIO")
        except RuntimeError as error:
            why = noise[0] if noise else reason(error)
            raise MeshdepictError(f"holds a damaged file, {name}: {why}") from error
        if noise:
            notes.append(f"unpacking {name} met damage: {noise[0]}")
        found = array_of(image)
        if found.shape != shape or found.dtype.kind not in "iu":
            raise MeshdepictError(
                f"holds a damaged file, {name}: its pixels unpack to another size than "
                "the header claims"
            )
        return found.astype(kind)  # negative numbers wrap to the bits that were stored


def _bare(one: Slice, fragments: bytes) -> bytes:
    """Return a file of nothing but pixels and what it takes to unpack them."""

    def element(tag: int, vr: bytes, value: bytes) -> bytes:
        value += (b"\0" if vr in (b"UI", b"OB") else b" ") * (len(value) % 2)
        long = vr == b"OB"
        head = struct.pack("<HH2s", tag >> 16, tag & 0xFFFF, vr)
        return head + struct.pack("<xxI" if long else "<H", len(value)) + value

    def short(tag: int, number: float) -> bytes:
        return element(tag, b"US", struct.pack("<H", int(number)))

    bits, used, high = _bits(one)
    uid = b"2.25.1"
    meta = (
        element(0x00020001, b"OB", b"\0\1")
        + element(0x00020002, b"UI", _CAPTURE.encode())
        + element(0x00020003, b"UI", uid)
        + element(0x00020010, b"UI", one.file.syntax.encode("ascii", "replace"))
        + element(0x00020012, b"UI", uid)
    )
    body = (
        element(0x00080016, b"UI", _CAPTURE.encode())
        + element(0x00080018, b"UI", uid)
        + element(0x0020000D, b"UI", uid)
        + element(0x0020000E, b"UI", uid)
        + short(0x00280002, 1)
        + element(0x00280004, b"CS", b"MONOCHROME2")
        + element(0x00280008, b"IS", str(one.frames).encode())
        + short(0x00280010, min(one.size[1], 65535))
        + short(0x00280011, min(one.size[0], 65535))
        + short(0x00280100, bits)
        + short(0x00280101, used)
        + short(0x00280102, high)
        + short(0x00280103, one.tag("0028|0103") == "1")
    )
    pixels = struct.pack("<HH2sxxI", 0x7FE0, 0x0010, b"OB", 0xFFFFFFFF) + fragments
    length = element(0x00020000, b"UL", struct.pack("<I", len(meta)))
    return bytes(128) + b"DICM" + length + meta + body + pixels


def _fragments(one: Slice, start: int) -> tuple[list[bytes], bytes]:
    """Return compressed fragments, and their bytes up to the mark at their end."""
    data: Any = one.file.data
    if not len(data):
        with one.path.open("rb") as file:
            file.seek(start)
            data, start = file.read(), 0
    found, end = fragments_of(data, start, one.path.name)
    return found, bytes(data[start:end])
