"""Odd but valid PLY files, and a slow reader to check the fast one against."""

from __future__ import annotations

import re
import struct
from typing import Any

import numpy as np

from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.polygons import as_polygons

CODES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I",
    "float": "f", "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
    "int32": "i", "uint32": "I", "float32": "f", "float64": "d",
}  # fmt: skip
ENCODINGS = ("ascii", "binary_little_endian", "binary_big_endian")
OURS = ["meshdepict 0.1 exaggerated", "meshdepict light=northwest"]

Rows = list[dict[str, Any]]


def slow_read(data: bytes) -> tuple[list[str], dict[str, Rows]]:
    """The comments of a PLY file, and every value of it as the bytes of its type."""
    end = re.search(rb"end_header[ \t]*(\r\n|\n|\r)", data)
    assert end
    header = [line.split() for line in data[: end.start()].decode().splitlines()]
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[
        next(words[1] for words in header if words and words[0] == "format")
    ]
    at = end.end()
    words = data[at:].split() if not order else []

    def value(kind: str) -> bytes:
        nonlocal at
        code = CODES[kind]
        if order:
            size = struct.calcsize(code)
            raw = data[at : at + size]
            at += size
            return raw if order == "<" else raw[::-1]
        word = words.pop(0)
        return struct.pack("<" + code, float(word) if code in "fd" else int(word))

    elements: dict[str, tuple[int, list[list[str]]]] = {}
    for line in header:
        if line[:1] == ["element"]:
            elements[line[1]] = (int(line[2]), [])
        elif line[:1] == ["property"]:
            elements[list(elements)[-1]][1].append(line[1:])
    found: dict[str, Rows] = {}
    for name, (count, properties) in elements.items():
        found[name] = []
        for _ in range(count):
            row: dict[str, Any] = {}
            for item in properties:
                if item[0] == "list":
                    length = int.from_bytes(value(item[1]), "little")
                    row[item[3]] = (item[1:3], [value(item[2]) for _ in range(length)])
                else:
                    row[item[1]] = (item[0], value(item[0]))
            found[name].append(row)
    comments = [" ".join(line) for line in header if line[:1] in (["comment"], ["obj_info"])]
    return comments, found


def odd_file(rng: np.random.Generator, encoding: str, newline: str) -> bytes:
    """A valid PLY file with everything that the format allows and few programs expect."""
    kinds = list(CODES)
    padding = lambda: " " * int(rng.integers(1, 4))  # noqa: E731
    count = int(rng.integers(4, 9))
    faces = int(rng.integers(1, 7))
    ragged = bool(rng.integers(2))

    def extra(names: str) -> list[tuple[str, ...]]:
        found: list[tuple[str, ...]] = []
        for name in names[: rng.integers(0, len(names) + 1)]:
            kind = str(rng.choice(kinds))
            if rng.random() < 0.3:
                found.append(
                    ("list", str(rng.choice(["uchar", "ushort", "int", "uint"])), kind, name)
                )
            else:
                found.append((kind, name))
        return found

    position = [(str(rng.choice(["float", "double", "float32"])), axis) for axis in "xyz"]
    index = ("list", str(rng.choice(["uchar", "int", "uint", "uint8", "short"])),
             str(rng.choice(["int", "uint", "short", "uchar", "int32"])),
             str(rng.choice(["vertex_indices", "vertex_index"])))  # fmt: skip
    elements: list[tuple[str, int, list[tuple[str, ...]]]] = [
        ("camera", int(rng.integers(0, 3)), extra("abc") or [("float", "f")]),
        ("vertex", count, [*extra("pq"), *position, *extra("rst")]),
        ("nothing", 0, [("list", "uchar", "int", "vertex_indices"), ("float", "weight")]),
        ("face", faces, [*extra("uv"), index, *extra("w")]),
        ("edge", int(rng.integers(0, 3)), [("int", "vertex1"), ("int", "vertex2"), *extra("e")]),
    ]
    lines = ["ply", f"format {encoding} 1.0"]
    for name, rows, properties in elements:
        lines.append(f"element{padding()}{name}{padding()}{rows}{padding()}")
        lines += [padding().join(("property", *item)) + padding() for item in properties]
    for number in range(int(rng.integers(0, 5))):
        kind = rng.choice(["comment", "obj_info"])
        lines.insert(int(rng.integers(1, len(lines))), f"{kind} number {number}")
    header = newline.join([*lines, "end_header", ""]).encode()
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[encoding]

    def number(kind: str) -> int | float:
        code = CODES[kind]
        if code in "fd":
            raw = rng.bytes(struct.calcsize(code))
            value = float(struct.unpack("<" + code, raw)[0])
            return value if np.isfinite(value) else 0.5
        size = 8 * struct.calcsize(code)
        low = -(2 ** (size - 1)) if code.islower() else 0
        return int(rng.integers(low, low + 2**size))

    def spell(kind: str, value: float) -> bytes:
        if order:
            return struct.pack(order + CODES[kind], value)
        return (b"%.9g" if CODES[kind] == "f" else b"%r" if CODES[kind] == "d" else b"%d") % value

    body = []
    for name, rows, properties in elements:
        for _ in range(rows):
            row = []
            for item in properties:
                if item == index and name == "face":
                    corners = int(rng.integers(3, 6)) if ragged else 4
                    values: list[int | float] = rng.choice(count, corners).tolist()
                elif item[0] == "list":
                    values = [number(item[2]) for _ in range(int(rng.integers(0, 4)))]
                else:
                    values = [rng.normal() if item[1] in "xyz" else number(item[0])]
                if item[0] == "list":
                    row.append(spell(item[1], len(values)))
                row += [spell(item[-2], value) for value in values]
            body.append((b"" if order else b" ").join(row) + (b"" if order else newline.encode()))
    data = b"".join(body)
    return header + (data.rstrip() if not order and rng.integers(2) else data)


def expected_mesh(rows: dict[str, Rows]) -> tuple[np.ndarray, list[list[int]]]:
    vertices = [
        [struct.unpack("<" + CODES[kind], raw)[0] for kind, raw in (row["x"], row["y"], row["z"])]
        for row in rows["vertex"]
    ]
    faces = []
    for row in rows["face"]:
        (_, kind), items = row.get("vertex_indices") or row["vertex_index"]
        faces.append([struct.unpack("<" + CODES[kind], raw)[0] for raw in items])
    return np.array(vertices), faces


def polygons_of(mesh: Mesh) -> list[list[int]]:
    connectivity, offsets = mesh.polygons or as_polygons(mesh.faces)
    return [part.tolist() for part in np.split(connectivity, offsets[1:-1])]


def random_colors(mesh: Mesh, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)


def colors_of(mesh: Mesh, prefix: str = "") -> np.ndarray:
    vertex = mesh.attributes["vertex"]
    return np.stack([vertex[prefix + name] for name in ("red", "green", "blue")], axis=1)


def without(rows: Rows, names: tuple[str, ...]) -> Rows:
    return [{name: value for name, value in row.items() if name not in names} for row in rows]
