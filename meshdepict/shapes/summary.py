"""What is to be said of a shape, in rows of two words: for ``info`` and for notebooks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from meshdepict.scene.vectors import Vector

__all__ = ["data_rows", "image_rows", "mesh_rows", "volume_rows"]

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
    textured = getattr(mesh.document, "texcoords", None) is not None
    for element in ("vertex", "face"):
        names = [*mesh.attributes[element]]
        names += ["texture coordinates"] * (textured and element == "face")
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


def _spans(low: Vector, high: Vector) -> str:
    spans = zip("xyz", low, high, strict=True)
    return "  ".join(f"{axis} {least:.6g} … {most:.6g}" for axis, least, most in spans)
