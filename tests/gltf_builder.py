"""Put together glTF files by hand, right and wrong ones."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from conftest import tetrahedron

from meshdepict.io import read_mesh
from meshdepict.shapes.mesh import Mesh

__all__ = ["FACES", "KINDS", "POINTS", "Builder", "colors_of"]

KINDS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
POINTS, FACES = tetrahedron()


class Builder:
    """A glTF header and its buffer, put together by hand."""

    def __init__(self) -> None:
        self.chunk = b""
        self.header: dict[str, Any] = {
            "asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "meshes": [],
            "nodes": [], "buffers": [{}],
        }  # fmt: skip

    def view(self, raw: bytes, **more: Any) -> int:
        views = self.header["bufferViews"]
        views.append({"buffer": 0, "byteOffset": len(self.chunk), "byteLength": len(raw)} | more)
        self.chunk += raw + b"\0" * (-len(raw) % 4)
        return len(views) - 1

    def accessor(self, values: Any, kind: str, **more: Any) -> int:
        array = np.asarray(values, "<" + kind)
        array = array.reshape(len(array), -1)
        accessor = {
            "bufferView": self.view(array.tobytes()),
            "componentType": KINDS[kind],
            "type": SHAPES[array.shape[1]],
            "count": len(array),
        }
        self.header["accessors"].append(accessor | more)
        return len(self.header["accessors"]) - 1

    def mesh(self, *primitives: dict[str, Any]) -> int:
        self.header["meshes"].append({"primitives": list(primitives)})
        return len(self.header["meshes"]) - 1

    def tetrahedron(self, **more: Any) -> dict[str, Any]:
        indices = self.accessor(FACES.reshape(-1), "u2")
        return {"attributes": {"POSITION": self.accessor(POINTS, "f4")}, "indices": indices} | more

    def glb(self) -> bytes:
        self.header["buffers"][0]["byteLength"] = len(self.chunk)
        text = json.dumps(self.header).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<I4s", len(text), b"JSON") + text
        body += struct.pack("<I4s", len(self.chunk), b"BIN\0") + self.chunk
        return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body

    def read(self, folder: Path) -> Mesh:
        (folder / "built.glb").write_bytes(self.glb())
        return read_mesh(folder / "built.glb", winding="keep")


def colors_of(mesh: Mesh) -> np.ndarray:
    return np.stack([mesh.attributes["vertex"][name] for name in ("red", "green", "blue")], axis=1)
