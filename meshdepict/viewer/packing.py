"""A mesh in few bytes for a page: positions in 16 bits, and differences, which deflate packs well.

``web/mesh_view.js`` undoes what is done here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdepict.scene.view import View
    from meshdepict.shapes.mesh import Mesh

__all__ = ["differences", "pack_mesh", "raised", "sight"]

_STEPS = 65535  # along the longest side of the box: 0.02 pixels where it fills 1,000


def pack_mesh(mesh: Mesh) -> tuple[bytes, dict[str, Any]]:
    """Return a mesh's positions and triangles as bytes, and what a reader must know about them.

    Returns
    -------
    bytes
        (n, 3) uint16 positions as differences from vertex to vertex, then the corners of all
        triangles, uint16 or uint32, as differences from corner to corner; little endian, both
        modulo their type's range.
    dict
        ``vertices``, ``faces``: how many; ``wide``: whether corners are uint32; ``low``: the
        box's corner, world units; ``span``: what 65535 stands for along each axis.
    """
    low = mesh.vertices.min(axis=0)
    longest = float((mesh.vertices.max(axis=0) / 2 - low / 2).max()) * 2 or 1.0  # no overflow
    positions = np.rint((mesh.vertices - low) * (_STEPS / longest)).astype("<u2")
    wide = len(mesh.vertices) > _STEPS + 1
    corners = mesh.faces.ravel().astype("<u4" if wide else "<u2")
    packed = differences(positions).tobytes() + differences(corners).tobytes()
    return packed, {
        "vertices": len(positions),
        "faces": len(mesh.faces),
        "wide": wide,
        "low": low.tolist(),
        "span": [longest] * 3,
    }


def raised(info: Mapping[str, Any], times: float) -> dict[str, Any]:
    """Return what `pack_mesh` says about a mesh with its heights (z) multiplied.

    Its bytes are the same: they stand for other heights.
    """
    (*low, z), (*span, high) = info["low"], info["span"]
    return {**info, "low": [*low, z * times], "span": [*span, high * times]}


def sight(view: View) -> dict[str, Any]:
    """Return a view as pages take it; one in perspective becomes the parallel one of its focus."""
    scale = view.parallel_scale
    if scale is None:
        distance = float(np.linalg.norm(view.position - view.focus))
        scale = distance * float(np.tan(np.radians(view.field_of_view or 0.0) / 2))
    return {"frame": view.frame.tolist(), "focus": view.focus.tolist(), "scale": scale}


def differences(rows: NDArray[Any]) -> NDArray[Any]:
    """Return what each row (or number) is more than the one before, modulo its type's range."""
    return np.diff(rows, axis=0, prepend=np.zeros_like(rows[:1]))
