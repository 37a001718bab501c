"""What is to be said of a shape, in rows of two words: for ``info`` and for notebooks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from meshdepict.scene.vectors import Vector

__all__ = ["data_rows", "height_rows", "image_rows", "mesh_rows", "volume_rows"]

Row = tuple[str, str]


def mesh_rows(mesh: Any) -> Iterator[Row]:
    """Yield counts and sizes of a mesh."""
    yield "vertices", f"{len(mesh.vertices):,}"
    faces = f"{len(mesh.faces):,} triangles"
    if mesh.polygons is not None:
        faces = f"{len(mesh.polygons.offsets) - 1:,} polygons ({faces})"
    yield "faces", faces
    yield "box", _spans(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0))
    if mesh.length_unit:
        yield "length unit", mesh.length_unit
    yield "diagonal", f"{mesh.diagonal:.4g}"
    yield "edge length", f"{mesh.edge_length:.4g} (median)"


def data_rows(mesh: Any) -> Iterator[Row]:
    """Yield what else is known at a mesh's vertices and faces."""
    laid = getattr(mesh.document, "texcoords", None) is not None
    textured = bool(getattr(mesh.document, "is_textured", False))
    for element in ("vertex", "face"):
        names = [*mesh.attributes[element]]
        if element == "face":
            names += ["texture coordinates"] * (laid or textured) + ["textures"] * textured
        if names:
            yield f"{element} data", ", ".join(names)


def volume_rows(volume: Any) -> Iterator[Row]:
    """Yield size, values and place of a volume, and what its file says of it."""
    nz, ny, nx = volume.counts
    low, high = volume.range
    yield "voxels", f"{nx} x {ny} x {nz}"
    yield "values", f"{low:g} … {high:g} {volume.unit} ({volume.values.dtype})"
    yield "length unit", volume.length_unit or "not said"
    steps = zip("xyz", volume.spacing, strict=True)
    yield "spacing", "  ".join(f"{axis} {step:.6g}" for axis, step in steps)
    yield "box", _spans(volume.outline.min(axis=0), volume.outline.max(axis=0))
    for key, text in volume.attributes.items():
        yield str(key).replace("_", " "), str(text)


def image_rows(image: Any) -> Iterator[Row]:
    """Yield size and view of an image of normals."""
    width, height = image.size
    yield "pixels", f"{width} x {height}"
    yield "samples", f"{len(image.normals):,}"
    yield "view", str(image.view)
    yield "diagonal", f"{image.diagonal:.4g}"
    known = [name for name in ("openness", "colors", "mesh") if getattr(image, name) is not None]
    if known:
        yield "with", ", ".join(known)


def height_rows(field: Any) -> Iterator[Row]:
    """Yield size, heights and place of a height field."""
    columns, rows = field.size
    yield "cells", f"{columns} x {rows}"
    missing = columns * rows - field.count
    if missing:
        yield "without a height", f"{missing:,} ({missing / (columns * rows):.1%})"
    low, high = field.outline.min(axis=0), field.outline.max(axis=0)
    yield "heights", f"{low[2]:.6g} … {high[2]:.6g} m"
    along, down = field.spacing
    yield "cell", f"{along:.6g} x {down:.6g} m" + (" (in the middle row)" if field.degrees else "")
    yield "box", _spans(low, high)
    yield "reference system", _system(field.crs) or "not said"
    for key, text in field.attributes.items():
        yield str(key).replace("_", " "), str(text)


def _system(crs: str) -> str:
    """Return the name of a reference system: what WKT has in its first quotes."""
    quoted = crs.split('"')
    return quoted[1] if len(quoted) > 2 else crs[:60]


def _spans(low: Vector, high: Vector) -> str:
    spans = zip("xyz", low, high, strict=True)
    return "  ".join(f"{axis} {least:.6g} … {most:.6g}" for axis, least, most in spans)
