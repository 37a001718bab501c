"""GLB and glTF: every triangle of the scene as one mesh; colours linear, as the standard wants."""

from __future__ import annotations

import base64
import json
import struct
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.gltf_buffers import COMPONENTS
from meshdepict.io.gltf_scene import Part, Scene
from meshdepict.io.ply_properties import exact_float
from meshdepict.shapes.document import COLOR, Contents, Document, Saving, as_bytes, only_colors

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["decode", "encode", "provenance"]

_JSON, _BIN = b"JSON", b"BIN\0"
_COMPONENT_TYPES = {kind: number for number, kind in COMPONENTS.items()}
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_ABSURD = 100  # times the bytes that are there: no download stops so early
_UNLIT = "KHR_materials_unlit"


def provenance(file: BinaryIO) -> tuple[str, ...]:
    """Return the lines that this program wrote, reading no geometry from a GLB file."""
    start = file.read(20)
    if start.startswith(b"glTF"):
        return _lines(_parsed(file.read(int.from_bytes(start[12:16], "little"))))
    return _lines(_parsed(start + file.read()))


def _lines(header: dict[str, Any]) -> tuple[str, ...]:
    extras = header.get("asset", {}).get("extras")
    lines = extras.get("meshdepict") if isinstance(extras, dict) else None
    return tuple(map(str, lines)) if isinstance(lines, list) else ()


# --- reading ----------------------------------------------------------------------------------


def decode(data: bytes, path: Path) -> Contents:
    """Read all triangles of a scene, moved to where its nodes put them.

    Colours are the vertices' times their material's, as sRGB; what is transparent has an alpha,
    too. The standard's unit is the metre.

    Raises
    ------
    MeshdepictError
        For a file that is cut off, wrong, or in need of an extension that isn't known.
    """
    header, chunk = _unpacked(data)
    try:
        scene = Scene(header, chunk, path.parent, len(data))
        parts, lost = scene.parts(), scene.losses()
    except MeshdepictError:
        raise
    except (LookupError, ValueError) as error:
        said = " ".join(f"{type(error).__name__}: {error}".split())
        raise MeshdepictError(f"is wrong as glTF ({said:.200})") from error
    except (ArithmeticError, AttributeError, TypeError) as error:
        raise MeshdepictError(
            "is wrong as glTF: its JSON part holds a value of the wrong kind"
        ) from error
    joined = [f"its {len(parts)} parts become one mesh"] if len(parts) > 1 else []
    if joined or lost:
        said = ", ".join(joined + [f"its {what} are not kept" for what in lost])
        warnings.warn(f"{path}: {said}", MeshdepictWarning, stacklevel=2)
    return _joined(parts, Document(provenance=_lines(header), up="y"))


def _unpacked(data: bytes) -> tuple[dict[str, Any], bytes]:
    """Return the JSON and the binary chunk of GLB or glTF."""
    if not data.startswith(b"glTF"):
        return _parsed(data), b""
    version, length = (int.from_bytes(data[at : at + 4], "little") for at in (4, 8))
    if version != 2:
        raise MeshdepictError(f"is GLB of version {version}; only version 2 is read")
    if length < 20 and len(data) >= 20:
        raise MeshdepictError("is wrong as GLB: its header claims that nothing comes after it")
    if length > _ABSURD * len(data):
        raise MeshdepictError(
            f"is damaged or cut off: its header claims far more than the {len(data):,} bytes there"
        )
    if length > len(data) or length < 20:
        raise MeshdepictError(f"is cut off: {length:,} bytes are due, but {len(data):,} are there")
    chunks: dict[bytes, bytes] = {}
    at = 12
    while at + 8 <= length:
        size = int.from_bytes(data[at : at + 4], "little")
        if size > length - at - 8:
            raise MeshdepictError("is wrong as GLB: a part of it claims to reach beyond its end")
        chunks.setdefault(data[at + 4 : at + 8], data[at + 8 : at + 8 + size])
        at += 8 + size
    return _parsed(chunks.get(_JSON, b"")), chunks.get(_BIN, b"")


def _parsed(text: bytes) -> dict[str, Any]:
    try:
        header = json.loads(text)
    except RecursionError:
        raise MeshdepictError("is wrong as glTF: its JSON part is nested too deep") from None
    except ValueError:
        header = None
    if not isinstance(header, dict) or not isinstance(header.get("asset"), dict):
        raise MeshdepictError("is cut off or wrong as glTF: its JSON part can't be read")
    return header


def _joined(parts: list[Part], document: Document) -> Contents:
    from meshdepict.color.srgb import linear_to_srgb

    counts = [len(part.points) for part in parts]
    before = np.cumsum([0, *counts])
    points = np.concatenate([np.empty((0, 3)), *(part.points for part in parts)])
    faces = np.concatenate(
        [np.empty((0, 3), np.int64)]
        + [part.faces + first for part, first in zip(parts, before, strict=False)]
    )
    used = points[faces.reshape(-1)]
    if len(used) and (used == used[0]).all():
        raise MeshdepictError(
            f"has no size: the corners of its {len(faces):,} triangles all lie at one point; is "
            "the scale of a node 0?"
        )
    vertex: dict[str, NDArray[Any]] = {}
    if any(part.color is not None for part in parts):
        given = [np.ones((len(p.points), 4)) if p.color is None else p.color for p in parts]
        color = np.clip(np.nan_to_num(np.concatenate(given)), 0, 1)
        srgb = np.rint(255 * linear_to_srgb(color[:, :3])).astype(np.uint8)
        vertex |= dict(zip(COLOR, srgb.T, strict=True))
        alpha = np.rint(255 * color[:, 3]).astype(np.uint8)
        if (alpha < 255).any():
            vertex["alpha"] = alpha
    if parts and all(part.texture is not None for part in parts):
        texture = np.concatenate([part.texture for part in parts if part.texture is not None])
        vertex |= {"s": texture[:, 0], "t": texture[:, 1]}
    if parts and all(part.normal is not None for part in parts):
        normal = np.concatenate([part.normal for part in parts if part.normal is not None])
        vertex |= dict(zip(("nx", "ny", "nz"), normal.T, strict=True))
    return Contents(points, faces, {"vertex": vertex}, document, "m")


# --- writing ----------------------------------------------------------------------------------


def encode(file: BinaryIO, mesh: Mesh, saving: Saving) -> None:
    """Write one mesh of triangles with an unlit material, so that viewers show baked colours.

    Positions are 32-bit floats, as the standard wants: relative to the node's translation where
    they would lose digits otherwise.
    """
    header, chunk = _built(mesh, saving)
    if saving.suffix == ".gltf":
        inline = base64.b64encode(chunk).decode()
        header["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{inline}"
        file.write(json.dumps(header).encode())
        return
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    file.write(b"glTF" + struct.pack("<II", 2, 12 + 8 + len(text) + 8 + len(chunk)))
    file.write(struct.pack("<I", len(text)) + _JSON + text)
    file.write(struct.pack("<I", len(chunk)) + _BIN + chunk)


def _built(mesh: Mesh, saving: Saving) -> tuple[dict[str, Any], bytes]:
    """Return the JSON and the binary part of a file."""
    from meshdepict.color.srgb import srgb_to_linear

    node: dict[str, Any] = {"mesh": 0}
    points = mesh.vertices
    if exact_float(points) != "f4":
        centre = points.min(axis=0) / 2 + points.max(axis=0) / 2
        node["translation"] = centre.tolist()
        points = points - centre
    single = points.astype("<f4")
    box = {"min": single.min(axis=0).tolist(), "max": single.max(axis=0).tolist()}
    arrays = [
        (single, "VEC3", _ARRAY_BUFFER, box),
        (mesh.faces.astype("<u4").reshape(-1, 1), "SCALAR", _ELEMENT_BUFFER, {}),
    ]
    attributes = {"POSITION": 0}
    colors = only_colors(mesh.attributes["vertex"], mesh.document, saving, "glTF")
    if colors is not None:
        linear = np.full((len(colors), 4), 65535, "<u2")  # four, so that rows start at words
        linear[:, :3] = np.rint(65535 * srgb_to_linear(colors / 255))
        if "alpha" in mesh.attributes["vertex"]:  # kept, though the material is opaque
            linear[:, 3] = 257 * as_bytes(mesh.attributes["vertex"]["alpha"]).astype("<u2")
        attributes["COLOR_0"] = len(arrays)
        arrays.append((linear, "VEC4", _ARRAY_BUFFER, {"normalized": True}))
    accessors, views, at = [], [], 0
    for number, (array, kind, target, more) in enumerate(arrays):
        component = _COMPONENT_TYPES[array.dtype.str[1:]]
        described = {"bufferView": number, "componentType": component, "type": kind}
        accessors.append(described | {"count": len(array)} | more)
        view = {"buffer": 0, "byteOffset": at, "byteLength": array.nbytes, "target": target}
        views.append(view)
        at += array.nbytes
    asset: dict[str, Any] = {"version": "2.0", "generator": "meshdepict"}
    if saving.comments:
        asset["extras"] = {"meshdepict": list(saving.comments)}
    header = {
        "asset": asset,
        "extensionsUsed": [_UNLIT],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 1, "material": 0}]}],
        "materials": [{"extensions": {_UNLIT: {}}, "doubleSided": True}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": at}],
    }
    return header, b"".join(array.tobytes() for array, *_ in arrays)
