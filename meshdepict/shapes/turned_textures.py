"""Textures of a mesh whose polygons run the other way round: each corner keeps its own place."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["turned_textures"]

Floats = NDArray[np.float64]


def turned_textures(before: Mesh, after: Mesh, corner: NDArray[np.int64]) -> Textures | None:
    """Return the textures of a mesh for one with the same polygons from other corners.

    Parameters
    ----------
    before, after : Mesh
        How they are split into triangles may differ.
    corner : (c,) array
        Which corner of the polygons of the one each corner of the other's is.
    """
    textures = before.textures
    if textures is None:
        return None
    wanted = corner[after.triangle_corners]

    def handed(uv: Floats) -> Floats:
        each = np.zeros((len(corner), 2))
        each[before.triangle_corners] = uv
        return each[wanted]

    material = np.full(int(before._owner.max()) + 1, -1)
    material[before._owner] = textures.material
    own = textures.normal_texcoords
    return replace(
        textures,
        texcoords=handed(textures.texcoords),
        material=material[after._owner],
        normal_texcoords=None if own is None else handed(own),
    )
