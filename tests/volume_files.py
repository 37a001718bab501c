"""NRRD, MetaImage, NIfTI, VTI and TIFF files written word by word, as right or wrong as wanted."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

NRRD = {
    "type": "short",
    "dimension": "3",
    "space": "left-posterior-superior",
    "sizes": "5 6 7",
    "space directions": "(0.5,0,0) (0,0.75,0) (0,0,2.5)",
    "endian": "little",
    "encoding": "raw",
    "space origin": "(10,-20,30)",
}

METAIMAGE = {
    "NDims": "3",
    "DimSize": "5 6 7",
    "ElementType": "MET_SHORT",
    "ElementSpacing": "0.5 0.75 2.5",
    "Offset": "10 -20 30",
    "ElementDataFile": "LOCAL",
}


def write_nrrd(path: Path, data: bytes, **fields: str | None) -> Path:
    """Write a header of the usual fields, and those given (None: left out), and data behind it."""
    given = {name.replace("_", " "): value for name, value in fields.items()}
    lines = [f"{k}: {v}" for k, v in (NRRD | given).items() if v is not None]
    path.write_bytes("\n".join(["NRRD0004", *lines, "", ""]).encode() + data)
    return path


def write_metaimage(path: Path, data: bytes, **lines: str | None) -> Path:
    """Write a header of the usual lines, and those given (None: left out), and data behind it."""
    last = lines.pop("ElementDataFile", METAIMAGE["ElementDataFile"])
    every = {k: v for k, v in (METAIMAGE | lines).items() if v is not None}
    every.pop("ElementDataFile")
    head = "".join(f"{k} = {v}\n" for k, v in every.items())
    path.write_bytes((head + f"ElementDataFile = {last}\n").encode() + data)
    return path


def tiff(pages: np.ndarray, *, order: str = "<", first: dict | None = None, **entries) -> bytes:
    """Write pages as a TIFF of one strip each; entries such as t256 = (type, values) come first."""
    mark = b"II*\0" if order == "<" else b"MM\0*"
    pages = pages.astype(pages.dtype.newbyteorder(order))
    body, directories = bytearray(mark + bytes(4)), []
    strips = []
    for page in pages:
        strips.append(len(body))
        body += page.tobytes() + bytes(page.nbytes % 2)
    letters = {1: "B", 2: "s", 3: "H", 4: "I", 5: "I"}
    kind = {"u": 1, "i": 2, "f": 3}[pages.dtype.kind]
    link = 4
    for number, (page, strip) in enumerate(zip(pages, strips, strict=True)):
        rows, columns = page.shape
        table = {
            256: (4, [columns]), 257: (4, [rows]), 258: (3, [8 * page.itemsize]), 259: (3, [1]),
            262: (3, [1]), 273: (4, [strip]), 277: (3, [1]), 278: (4, [rows]),
            279: (4, [page.nbytes]), 339: (3, [kind]),
        }  # fmt: skip
        table |= {int(tag.removeprefix("t")): value for tag, value in entries.items()}
        if number == 0:
            table |= first or {}
        packed = []
        for tag, (type_, values) in sorted(table.items()):
            if type_ == 2:
                data, count = values + b"\0", len(values) + 1
            else:
                data = struct.pack(f"{order}{len(values)}{letters[type_]}", *values)
                count = len(values) // (2 if type_ == 5 else 1)
            if len(data) > 4:
                place = len(body)
                body += data + bytes(len(data) % 2)
                data = struct.pack(order + "I", place)
            packed.append(struct.pack(order + "HHI", tag, type_, count) + data.ljust(4, b"\0"))
        at = len(body)
        body[link : link + 4] = struct.pack(order + "I", at)
        body += struct.pack(order + "H", len(packed)) + b"".join(packed)
        link = len(body)
        body += bytes(4)
        directories.append(at)
    return bytes(body)
