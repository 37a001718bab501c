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

__all__ = ["depth_ratio", "depth_steps", "pixel_sizes", "positions", "step"]

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


def pixel_sizes(view: View, depths: Floats) -> Floats:
    """Return the world size (n,) of a pixel at depths."""
    if view.parallel_scale is None:
        return depths * step(view)
    return np.full(depths.shape, 2 * view.parallel_scale / view.height_px)


def depth_steps(view: View, depths: Floats) -> Floats:
    """Return depths (n,) with the pixel as their unit, from any zero: differences are what counts.

    In a perspective view the logarithm of the depth, in units of its change over one pixel: to
    first order the same, and for near and far parts alike.
    """
    if view.parallel_scale is None:
        steps = np.log(depths) / step(view)
    else:
        steps = depths / pixel_sizes(view, depths)
    return steps - np.median(steps)


def depth_ratio(view: View, steps: ArrayLike) -> Floats:
    """Return |Δ ln depth| of differences of `depth_steps`.

    A parallel view's eye may be anywhere on its axis: its depths are taken as if from where a
    field of view of 30°, which a view has unless it says otherwise, shows the same height.
    """
    return np.abs(np.asarray(steps, np.float64)) * step(view)


def step(view: View) -> float:
    """Return the size of a pixel at depth 1."""
    field = _USUAL_FIELD if view.field_of_view is None else view.field_of_view
    return 2 * math.tan(math.radians(field) / 2) / view.height_px
