"""Open sheets: whether one lies like a terrain, and whether the eye looks at its back."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictWarning
from meshdepict.scales.seen_side import towards_eye
from meshdepict.scene.shape import Shape
from meshdepict.scene.view import View, named_directions
from meshdepict.shapes.mesh import Mesh

__all__ = ["automatic_view", "warn_of_backs"]

# Of the area-weighted mean normal's length: 1 for a plane, ½ for a half sphere, 0 for what is
# closed. St Helens has 0.91, a steep gorge 0.8.
_FLAT = 0.7
_SIDES = ("front", "top", "right")
_FACING = 0.02  # share of the samples: a rim may be bent


def automatic_view(shape: Shape, up: str) -> str:
    """Return the view from above of a sheet that lies like a terrain, else "front".

    A terrain's heights are measured along the axis that its faces look along, either way: an eye
    above looks down on it. Anything else is seen from the front.
    """
    if not isinstance(shape, Mesh):
        return "front"
    areas = shape.areas / (shape.areas.max() or 1.0)
    mean = areas @ shape.normals / (areas.sum() or 1.0)
    if np.linalg.norm(mean) < _FLAT:
        return "front"
    return max(_SIDES, key=lambda name: abs(float(named_directions(name, up)[0] @ mean)))


def warn_of_backs(points: NDArray[np.float64], normals: NDArray[np.float32], view: View) -> None:
    """Warn where every normal looks away from the eye: nothing but backs is seen."""
    cosine = (normals * towards_eye(points, view)).sum(axis=1)
    if np.mean(cosine > 0) < _FACING:
        warnings.warn(
            "every face looks away from the eye and is dark for most methods: two_sided=True "
            "(--two-sided) shades the side that is seen; or look from the other side",
            MeshdepictWarning,
            stacklevel=4,
        )
