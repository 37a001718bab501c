"""Charts of a surface, cut and laid out by xatlas: an extra package, and minutes of work."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

__all__ = ["charted"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def charted(points: Floats, faces: Ints, size: int, *, gutter: int) -> Floats:
    """Return texture coordinates (m, 3, 2) of charts.

    Parameters
    ----------
    points : (n, 3) array
    faces : (m, 3) array of int
    size : int
        Texels along the side of the square.
    gutter : int
        Texels between charts.

    Raises
    ------
    MeshdepictError
        Where xatlas isn't installed, and where it finds no charts.
    """
    try:
        import xatlas
    except ImportError:
        raise MeshdepictError(
            "charts need xatlas: pip install 'meshdepict[atlas]', or take --atlas new"
        ) from None
    atlas, packing = xatlas.Atlas(), xatlas.PackOptions()
    packing.resolution, packing.padding = size, gutter
    atlas.add_mesh(points.astype(np.float32), faces.astype(np.uint32))
    atlas.generate(pack_options=packing)
    if atlas.atlas_count != 1:
        raise MeshdepictError(
            f"xatlas lays the charts on {atlas.atlas_count} squares of {size:,} texels: take a "
            "larger --size, or --atlas new"
        )
    _, corners, coordinates = atlas[0]
    side = np.array([atlas.width, atlas.height]) / max(atlas.width, atlas.height)
    return np.asarray(coordinates, np.float64)[corners] * side
