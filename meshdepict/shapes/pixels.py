"""Pixels: where in the world the pixels of a view look, and how large they are there.

A pixel's centre has whole numbers (column, row), and (0, 0) is the top left one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from meshdepict.scene.view import View
    from meshdepict.shapes.mesh import Mesh

__all__ = ["depth_ratio", "depth_steps", "pixel_sizes", "positions", "projected"]

Floats = NDArray[np.float64]

# A parallel view has no distance that a depth could be compared with. It is looked at as if from
# where an eye with a view's usual 30° sees as much.
_USUAL_FIELD = 30.0


def positions(
    view: View, width: int, columns: NDArray[Any], rows: NDArray[Any], depths: Floats
) -> Floats:
    """Return the world positions (n, 3) that pixels show at depths along the view's axis.

    Parameters
    ----------
    view : View
        Of a picture ``height_px`` high and ``width`` wide.
    columns, rows, depths : (n,) array
    """
    right, up, axis = view.frame
    size = pixel_sizes(view, depths)
    x = size * (columns + 0.5 - width / 2)
    y = size * (view.height_px / 2 - 0.5 - rows)
    across: Floats = x[:, None] * right + y[:, None] * up
    return view.position + across - depths[:, None] * axis


def projected(mesh: Mesh, view: View, width: int) -> tuple[Floats, Floats]:
    """Return a mesh's vertices in a picture, and their depths in diagonals of the mesh.

    Returns
    -------
    corners : (n, 3) array
        As (P, Q, W), shown at column P/W and row Q/W: W is 1 in a parallel view and the depth in a
        perspective one.
    depth : (n,) array
        Along the view's axis, positive in front of the eye.
    """
    unit = mesh.diagonal or 1.0
    x, y, z = view.frame @ (mesh._unit_points - mesh.recentred(view.position)).T
    depth = -z
    if view.parallel_scale is None:
        weight, pixel = depth, _step(view)
    else:
        weight, pixel = np.ones_like(depth), 2 * (view.parallel_scale / unit) / view.height_px
    columns = x / pixel + (width / 2 - 0.5) * weight
    rows = (view.height_px / 2 - 0.5) * weight - y / pixel
    return np.stack([columns, rows, weight], axis=1), depth


def pixel_sizes(view: View, depths: Floats) -> Floats:
    """Return the world size (n,) of a pixel at depths."""
    if view.parallel_scale is None:
        return depths * _step(view)
    return np.full(depths.shape, 2 * view.parallel_scale / view.height_px)


def depth_steps(view: View, depths: Floats) -> Floats:
    """Return depths (n,) with the pixel as their unit, from any zero: differences are what counts.

    In a perspective view the logarithm of the depth, in units of its change over one pixel: to
    first order the same, and for near and far parts alike.
    """
    if view.parallel_scale is None:
        steps = np.log(depths) / _step(view)
    else:
        steps = depths / pixel_sizes(view, depths)
    return steps - np.median(steps)


def depth_ratio(view: View, steps: ArrayLike) -> Floats:
    """Return |Δ ln depth| of differences of `depth_steps`.

    A parallel view's eye may be anywhere on its axis: its depths are taken as if from where a
    field of view of 30°, which a view has unless it says otherwise, shows the same height.
    """
    return np.abs(np.asarray(steps, np.float64)) * _step(view)


def _step(view: View) -> float:
    """Return the size of a pixel at depth 1."""
    field = _USUAL_FIELD if view.field_of_view is None else view.field_of_view
    return 2 * math.tan(math.radians(field) / 2) / view.height_px
