"""DICOM files written byte by byte, so that every header can be as right or as wrong as wanted."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np

EXPLICIT, DEFLATED = "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.1.99"
RLE = "1.2.840.10008.1.2.5"
ENHANCED, DIRECTORY = "1.2.840.10008.5.1.4.1.1.2.1", "1.2.840.10008.1.3.10"

LONG = ("OB", "OW", "SQ", "UN", "UT")  # types whose length takes four bytes


def element(tag: int, vr: str, value: object) -> bytes:
    if vr in ("US", "SS", "UL"):
        data = struct.pack({"US": "<H", "SS": "<h", "UL": "<I"}[vr], value)
    else:
        data = value if isinstance(value, bytes) else str(value).encode()
        data += (b"\0" if vr in ("UI", "OB", "OW") else b" ") * (len(data) % 2)
    start = struct.pack("<HH", tag >> 16, tag & 0xFFFF) + vr.encode()
    if vr in LONG:
        return start + struct.pack("<xxI", len(data)) + data
    return start + struct.pack("<H", len(data)) + data


def numbers(values) -> str:
    return "\\".join(f"{value:.10g}" for value in np.ravel(values))


def write_dicom(path: Path, stored: np.ndarray, **tags: object) -> Path:
    """Write stored numbers (ny, nx), or (frames, ny, nx), as CT; tags by name replace the usual."""
    given = {
        "uid": f"1.2.3.{abs(hash(path.name)) % 10**9}",
        "modality": "CT",
        "series": "1.2.3.4",
        "description": "asymmetric",
        "series_number": 1,
        "position": (0, 0, 0),
        "orientation": (1, 0, 0, 0, 1, 0),
        "spacing": (1, 1),  # between rows, between columns
        "slope": 1,
        "intercept": -1024,
        "rescale_type": None,
        "padding": None,
        "photometric": "MONOCHROME2",
        "samples": 1,
        "kind": "1.2.840.10008.5.1.4.1.1.2",
        "bits_stored": None,
        "syntax": EXPLICIT,
        "pixels": None,  # bytes, compressed
        "groups": b"",  # functional groups
        "preamble": True,
    } | tags
    stored = np.ascontiguousarray(stored)
    signed = stored.dtype.kind == "i"
    rows, columns = stored.shape[-2:]
    bits = 8 * stored.dtype.itemsize
    names = {
        "modality": (0x00080060, "CS"),
        "image_type": (0x00080008, "CS"),
        "description": (0x0008103E, "LO"),
        "thickness": (0x00180050, "DS"),
        "between": (0x00180088, "DS"),
        "series": (0x0020000E, "UI"),
        "series_number": (0x00200011, "IS"),
        "position": (0x00200032, "DS"),
        "orientation": (0x00200037, "DS"),
        "spacing": (0x00280030, "DS"),
        "padding": (0x00280120, "SS" if signed else "US"),
        "padding_end": (0x00280121, "SS" if signed else "US"),
        "intercept": (0x00281052, "DS"),
        "slope": (0x00281053, "DS"),
        "rescale_type": (0x00281054, "LO"),
        "offsets": (0x3004000C, "DS"),
        "concatenation": (0x00209161, "UI"),
        "part": (0x00209162, "US"),
        "parts": (0x00209163, "US"),
    }
    kind, used = given["kind"], given["bits_stored"] or bits
    elements = {
        0x00080016: element(0x00080016, "UI", kind),
        0x00080018: element(0x00080018, "UI", given["uid"]),
        0x0020000D: element(0x0020000D, "UI", "1.2.3"),
        0x00280002: element(0x00280002, "US", given["samples"]),
        0x00280004: element(0x00280004, "CS", given["photometric"]),
        0x00280010: element(0x00280010, "US", rows),
        0x00280011: element(0x00280011, "US", columns),
        0x00280100: element(0x00280100, "US", bits),
        0x00280101: element(0x00280101, "US", used),
        0x00280102: element(0x00280102, "US", used - 1),
        0x00280103: element(0x00280103, "US", int(signed)),
        0x7FE00010: element(0x7FE00010, "OW", stored.tobytes()),
    }
    if stored.ndim == 3:
        elements[0x00280008] = element(0x00280008, "IS", len(stored))
    for name, (tag, vr) in names.items():
        value = given.get(name)
        if value is not None:
            text = numbers(value) if vr == "DS" and not isinstance(value, str) else value
            elements[tag] = element(tag, vr, text)
    if given["pixels"] is not None:
        start = struct.pack("<HH2sxxI", 0x7FE0, 0x0010, b"OB", 0xFFFFFFFF)
        elements[0x7FE00010] = start + given["pixels"]
    elements[0x52009229] = given["groups"]
    body = b"".join(data for _, data in sorted(elements.items()))
    if given["syntax"] == DEFLATED:
        packing = zlib.compressobj(wbits=-15)
        body = packing.compress(body) + packing.flush()
    meta = (
        element(0x00020001, "OB", b"\0\1")
        + element(0x00020002, "UI", kind)
        + element(0x00020003, "UI", given["uid"])
        + element(0x00020010, "UI", given["syntax"])
        + element(0x00020012, "UI", "1.2.3.4.5")
    )
    head = element(0x00020000, "UL", len(meta)) + meta
    path.write_bytes(bytes(128) + b"DICM" + head + body if given["preamble"] else body)
    return path


def sequence(tag: int, *items: bytes, open_end: bool = False) -> bytes:
    """A sequence of items, each with its length or, open, with a mark at its end."""
    if open_end:
        parts = [
            struct.pack("<HHI", 0xFFFE, 0xE000, 0xFFFFFFFF) + item
            + struct.pack("<HHI", 0xFFFE, 0xE00D, 0) for item in items
        ]  # fmt: skip
        start = struct.pack("<HH2sxxI", tag >> 16, tag & 0xFFFF, b"SQ", 0xFFFFFFFF)
        return start + b"".join(parts) + struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)
    parts = [struct.pack("<HHI", 0xFFFE, 0xE000, len(item)) + item for item in items]
    return element(tag, "SQ", b"".join(parts))


def write_enhanced(
    path: Path,
    stored: np.ndarray,
    positions,
    *,
    slopes=1.0,
    intercepts=-1024.0,
    spacing=(1, 1),
    orientation=(1, 0, 0, 0, 1, 0),
    open_end: bool = False,
    told: int | None = None,
    **tags: object,
) -> Path:
    """Write stored numbers (frames, ny, nx) as enhanced CT: places and rescaling of each frame."""
    count = len(stored)
    slopes, intercepts = np.broadcast_to(slopes, count), np.broadcast_to(intercepts, count)
    shared = sequence(0x00289110, element(0x00280030, "DS", numbers(spacing)), open_end=open_end)
    shared += sequence(
        0x00209116, element(0x00200037, "DS", numbers(orientation)), open_end=open_end
    )
    frames = []
    for position, slope, intercept in zip(positions, slopes, intercepts, strict=True):
        place = sequence(
            0x00209113, element(0x00200032, "DS", numbers(position)), open_end=open_end
        )
        rescaling = (
            element(0x00281052, "DS", f"{intercept:g}")
            + element(0x00281053, "DS", f"{slope:g}")
            + element(0x00281054, "LO", "HU")
        )
        other = sequence(0x00089124, element(0x00200032, "DS", "9\\9\\9"), open_end=open_end)
        frames.append(other + place + sequence(0x00289145, rescaling, open_end=open_end))
    groups = sequence(0x52009229, shared, open_end=open_end)
    groups += sequence(0x52009230, *frames[:told], open_end=open_end)
    nothing = dict.fromkeys(("position", "orientation", "spacing", "slope", "intercept"))
    return write_dicom(path, stored, **nothing, groups=groups, kind=ENHANCED, **tags)


def write_dicomdir(path: Path, names: list[str]) -> Path:
    """Write the directory of a CD, which lists files by their folders and names."""
    records = [
        element(0x00041430, "CS", "IMAGE") + element(0x00041500, "CS", name) for name in names
    ]
    patient = element(0x00041430, "CS", "PATIENT")
    body = element(0x00041130, "CS", "CD") + sequence(0x00041220, patient, *records)
    meta = element(0x00020002, "UI", DIRECTORY) + element(0x00020010, "UI", EXPLICIT)
    head = element(0x00020000, "UL", len(meta)) + meta
    path.write_bytes(bytes(128) + b"DICM" + head + body)
    return path


def run_lengths(stored: np.ndarray) -> bytes:
    """Frames of 16-bit numbers as DICOM's RLE: high bytes and low bytes, in runs and literals."""
    fragments = [b""]  # an empty table of offsets
    for frame in stored.astype("<u2"):
        segments = [_packed_bits(frame.view(np.uint8).ravel()[at::2]) for at in (1, 0)]
        head = struct.pack("<16I", 2, 64, 64 + len(segments[0]), *[0] * 13)
        fragments.append(head + b"".join(segments))
    parts = [struct.pack("<HHI", 0xFFFE, 0xE000, len(part)) + part for part in fragments]
    return b"".join(parts) + struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)


def _packed_bits(data: np.ndarray) -> bytes:
    parts, at = [], 0
    values = data.tolist()
    while at < len(values):
        run = 1
        while run < 128 and at + run < len(values) and values[at + run] == values[at]:
            run += 1
        if run > 1:
            parts.append(bytes([257 - run, values[at]]))
        else:
            parts.append(bytes([0, values[at]]))
        at += run
    packed = b"".join(parts)
    return packed + bytes(len(packed) % 2)


def write_series(folder: Path, stored: np.ndarray, volume, **tags: object) -> Path:
    """Write stored numbers (nz, ny, nx) as a series of slices that lie as a volume's do."""
    folder.mkdir(exist_ok=True, parents=True)
    columns, rows = volume.direction[:, 0], volume.direction[:, 1]
    prefix = tags.pop("prefix", "")
    for z, plane in enumerate(stored):
        name = f"{prefix}{(7 * z) % 101:03}.dcm"  # names in another order than places
        placed = {
            "position": volume.to_world((0, 0, z)),
            "orientation": (*columns, *rows),
            "spacing": volume.spacing[[1, 0]],
        } | tags
        write_dicom(folder / name, plane, **placed)
    return folder
