"""GLB and glTF: every triangle of the scene as one mesh; colours linear, as the standard wants."""

from __future__ import annotations

import copy
import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.gltf_buffers import Buffers
from meshdepict.io.gltf_depiction import Additions, Laid, depict, undepicted
from meshdepict.io.gltf_document import GltfDocument, joined_faces, joined_points, wrong_as_gltf
from meshdepict.io.gltf_materials import image_faults, is_textured
from meshdepict.io.gltf_package import BIN, JSON, embed_pictures, write_glb, write_gltf
from meshdepict.io.gltf_scene import Part, Scene
from meshdepict.io.texture_files import texture_notes
from meshdepict.shapes.document import COLOR, Contents, Document, Saving, as_bytes, only_colors
from meshdepict.surface.polygons import as_polygons

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["decode", "encode", "provenance"]

_ABSURD = 100  # times the bytes that are there: no download stops so early
_GENERATOR = "meshdepict"
_TITLE = "depiction"


_SINGLE = 1e-6  # relative, of positions that were written in single precision


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
    folder, size = path.parent, len(data)
    bare = undepicted(header, chunk)
    own = Buffers(header, chunk, folder, size)
    with wrong_as_gltf():
        scene = Scene(header, own)
        parts, faults = scene.parts(), image_faults(header, own)
    contents = _joined(parts)
    lines = _lines(header)
    document: Document = Document(provenance=lines, up="y")
    if bare is not None:
        document = GltfDocument(
            provenance=lines, up="y", header=bare[0],
            depicted=set(COLOR) <= set(contents.attributes["vertex"]),
            buffers=Buffers(*bare, folder, size),
        )  # fmt: skip
        held = _with_former(contents, document) or _without_texture(contents, document)
        contents = held or contents
    elif (  # not all of it is ours, or it has a texture that textures tell of
        not lines or header["asset"].get("generator") != _GENERATOR or is_textured(header)
    ):
        document = GltfDocument(provenance=lines, up="y", header=header, buffers=own)
    said = texture_notes(faults)
    if len(parts) > 1:
        said = [*said, f"its {len(parts)} parts become one mesh"]
    if said:
        joint = " " if faults and texture_notes(faults) else ": "
        warnings.warn(f"{path}{joint}{'; '.join(said)}", MeshdepictWarning, stacklevel=2)
    return contents._replace(document=document)


def _with_former(depicted: Contents, document: GltfDocument) -> Contents | None:
    """Return what a file held before it was depicted, with the depiction as its colours.

    None where the two don't have the same triangles: another program has been at work.
    """
    try:
        former = _joined(document.parts())
    except MeshdepictError:
        return None
    own, colors = former.attributes["vertex"], depicted.attributes["vertex"]
    same = np.array_equal(np.asarray(former.faces), np.asarray(depicted.faces))
    if not same or len(former.vertices) != len(depicted.vertices) or not set(COLOR) <= set(colors):
        return None
    renamed = {(f"original_{name}" if name in COLOR else name): own[name] for name in own}
    renamed |= {name: colors[name] for name in COLOR}
    return former._replace(attributes={"vertex": renamed})


def _without_texture(depicted: Contents, document: GltfDocument) -> Contents | None:
    """Return what a file held before a depiction in a texture was put beside it, None if it wasn't.

    A texture has vertices of its own, and the same triangles.
    """
    try:
        former = _joined(document.parts())
    except MeshdepictError:
        return None
    (points, faces, *_), (others, theirs, *_) = depicted, former
    faces, theirs = np.asarray(faces), np.asarray(theirs)
    if set(COLOR) & set(depicted.attributes["vertex"]) or faces.shape != theirs.shape:
        return None
    near = np.abs(others).max(initial=0.0) * _SINGLE
    return former if np.abs(points[faces] - others[theirs]).max(initial=0.0) <= near else None


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
    return _parsed(chunks.get(JSON, b"")), chunks.get(BIN, b"")


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


def _joined(parts: list[Part]) -> Contents:
    from meshdepict.color.srgb import linear_to_srgb

    points, faces = joined_points(parts), joined_faces(parts)
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
    return Contents(points, faces, {"vertex": vertex}, Document(up="y"), "m")


# --- writing ----------------------------------------------------------------------------------


def encode(
    file: BinaryIO, mesh: Mesh, saving: Saving, *, laid: tuple[Part, Laid] | None = None
) -> None:
    """Write a mesh as a scene of triangles in unlit colours, which viewers show as they are.

    Beside the scenes of the glTF file that it was read from, which stay as they were (see
    `gltf_depiction`), or alone.

    Parameters
    ----------
    file, mesh, saving
        As for every format.
    laid : (Part, Laid), optional
        The mesh's triangles with a texture, in place of colours.
    """
    former = _former(mesh)
    fresh: dict[int, bytes] = {}
    if former is None:
        header: dict[str, Any] = {"asset": {"version": "2.0", "generator": _GENERATOR}}
        buffers, parts = None, [Part(mesh.vertices, mesh.faces, None, None)]
        lines: tuple[str, ...] = ()
    else:
        header, buffers = copy.deepcopy(former.header), former.buffers
        parts, lines = former.parts(), former.provenance
        if saving.suffix == ".glb":
            embed_pictures(header, fresh, buffers)
    if former is None or saving.colors is not None or former.depicted or laid is not None:
        additions = Additions(header)
        colors = _linear(mesh, saving, former) if laid is None else None
        title = "" if former is None else _TITLE
        texture = None
        if laid is not None:
            parts, texture = [laid[0]], laid[1]
        depict(additions, parts, colors, quantize=saving.quantize, title=title, texture=texture)
        fresh[additions.buffer] = b"".join(additions.parts)
    _sign(
        header["asset"], saving.comments if saving.colors is not None else saving.comments or lines
    )
    if saving.suffix == ".gltf":
        write_gltf(file, header, fresh, buffers, saving.companions)
    else:
        write_glb(file, header, fresh, buffers)


def _former(mesh: Mesh) -> GltfDocument | None:
    """Return the document of the glTF file that a mesh was read from, if it is still that mesh."""
    document = mesh.document
    if not isinstance(document, GltfDocument):
        return None
    polygons = mesh.polygons or as_polygons(mesh.faces)
    return document if document.describes(mesh.vertices, polygons) else None


def _linear(mesh: Mesh, saving: Saving, former: GltfDocument | None) -> NDArray[np.uint16] | None:
    """Return the depiction's colours (n, 4) as the standard wants them, None without any."""
    from meshdepict.color.srgb import srgb_to_linear

    vertex = mesh.attributes["vertex"]
    if former is None or saving.colors is None:
        colors = only_colors(vertex, mesh.document, saving, "glTF")
    else:  # the file's own stay in its own scene
        colors = saving.colors
    if colors is None:
        return None
    linear = np.full((len(colors), 4), 65535, "<u2")  # four, so that rows start at words
    linear[:, :3] = np.rint(65535 * srgb_to_linear(colors / 255))
    if "alpha" in vertex:  # kept, though the material is opaque
        linear[:, 3] = 257 * as_bytes(vertex["alpha"]).astype("<u2")
    return linear


def _sign(asset: dict[str, Any], lines: tuple[str, ...]) -> None:
    """Write lines of provenance, or none, in place of earlier ones."""
    extras = asset.get("extras")
    kept = (
        {key: value for key, value in extras.items() if key != _GENERATOR}
        if isinstance(extras, dict)
        else {}
    )
    if lines:
        kept[_GENERATOR] = list(lines)
    if kept:
        asset["extras"] = kept
    elif isinstance(extras, dict):
        del asset["extras"]
