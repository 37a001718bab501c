"""DICOM files written byte by byte, so that every header can be as right or as wrong as wanted."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

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
    } | tags
    stored = np.ascontiguousarray(stored)
    signed = stored.dtype.kind == "i"
    rows, columns = stored.shape[-2:]
    bits = 8 * stored.dtype.itemsize
    names = {
        "modality": (0x00080060, "CS"),
        "description": (0x0008103E, "LO"),
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
    }
    kind = "1.2.840.10008.5.1.4.1.1.2"
    elements = {
        0x00080016: element(0x00080016, "UI", kind),
        0x00080018: element(0x00080018, "UI", given["uid"]),
        0x0020000D: element(0x0020000D, "UI", "1.2.3"),
        0x00280002: element(0x00280002, "US", 1),
        0x00280004: element(0x00280004, "CS", "MONOCHROME2"),
        0x00280010: element(0x00280010, "US", rows),
        0x00280011: element(0x00280011, "US", columns),
        0x00280100: element(0x00280100, "US", bits),
        0x00280101: element(0x00280101, "US", bits),
        0x00280102: element(0x00280102, "US", bits - 1),
        0x00280103: element(0x00280103, "US", int(signed)),
        0x7FE00010: element(0x7FE00010, "OW", stored.tobytes()),
    }
    if stored.ndim == 3:
        elements[0x00280008] = element(0x00280008, "IS", len(stored))
    for name, (tag, vr) in names.items():
        value = given.get(name)
        if value is not None:
            text = numbers(value) if vr == "DS" else value
            elements[tag] = element(tag, vr, text)
    body = b"".join(data for _, data in sorted(elements.items()))
    meta = (
        element(0x00020001, "OB", b"\0\1")
        + element(0x00020002, "UI", kind)
        + element(0x00020003, "UI", given["uid"])
        + element(0x00020010, "UI", "1.2.840.10008.1.2.1")
        + element(0x00020012, "UI", "1.2.3.4.5")
    )
    head = element(0x00020000, "UL", len(meta)) + meta
    path.write_bytes(bytes(128) + b"DICM" + head + body)
    return path


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
