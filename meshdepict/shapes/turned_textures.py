"""Textures of a mesh whose polygons run the other way round: each corner keeps its own place."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.shapes.textures import Textures

__all__ = ["Split", "turned_textures"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Split(NamedTuple):
    """How polygons were split into triangles: from which corners, and from which polygon each."""

    corners: Ints  # (m, 3), of all polygons' corners
    owner: Ints  # (m,)


def turned_textures(
    textures: Textures | None, before: Split, after: Split, corner: Ints
) -> Textures | None:
    """Return the textures of a mesh for one with the same polygons from other corners.

    Parameters
    ----------
    textures : Textures or None
    before, after : Split
        Of the one and of the other; as many triangles.
    corner : (c,) array
        Which corner of the polygons of the one each corner of the other's is.
    """
    if textures is None:
        return None
    wanted = corner[after.corners]

    def handed(uv: Floats) -> Floats:
        each = np.zeros((len(corner), 2))
        each[before.corners] = uv
        return each[wanted]

    material = np.full(int(before.owner.max()) + 1, -1)
    material[before.owner] = textures.material
    own = textures.normal_texcoords
    return replace(
        textures,
        texcoords=handed(textures.texcoords),
        material=material[after.owner],
        normal_texcoords=None if own is None else handed(own),
    )
