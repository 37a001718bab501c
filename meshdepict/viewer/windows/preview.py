"""Previews of big shapes: a coarse stand-in while something moves, the whole when it rests.

A `Proxy` joins the vertices of a mesh that share a cell of a grid; its vertices are some of the
mesh's own, so that their normals and curvature are the mesh's, at every scale.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.chosen_samples import ChosenSamples

if TYPE_CHECKING:
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.shapes.mesh import Mesh

__all__ = ["BUDGET", "Pace", "Proxy"]

BUDGET = 0.05
"""Seconds that a frame may take while something moves: 20 a second still look like motion."""

_MOST = 20_000  # vertices of a proxy: software OpenGL draws them in about that time
_FIRST_GRID = 128  # cells across the diagonal


class Pace:
    """Whether whole frames keep up with a moving hand, from how long the last ones took.

    Parameters
    ----------
    budget : float
        Seconds.
    """

    def __init__(self, budget: float = BUDGET) -> None:
        self.budget = budget
        self.shading = 0.0
        self.drawing = 0.0
        self.coarse_shading = 0.0

    @property
    def keeps_up(self) -> bool:
        """Whether a whole frame with new colours takes no longer than the budget."""
        return self.shading + self.drawing <= self.budget

    @property
    def shades_in_time(self) -> bool:
        """Whether what has no stand-in can be shaded without the hand's noticing a halt."""
        return self.shading <= 3 * self.budget

    @property
    def coarse_keeps_up(self) -> bool:
        """Whether a coarse stand-in can be shaded without the hand's noticing a halt."""
        return self.coarse_shading <= 3 * self.budget

    @property
    def draws_in_time(self) -> bool:
        """Whether a whole frame with old colours takes no longer than the budget."""
        return self.drawing <= self.budget


class Proxy:
    """A coarse stand-in for a mesh.

    Parameters
    ----------
    mesh : Mesh
    most : int
        Vertices at most.

    Attributes
    ----------
    chosen : (k,) array of int
        Which of the mesh's vertices it has.
    faces : (m, 3) array of int
        Into the chosen ones.
    """

    def __init__(self, mesh: Mesh, *, most: int = _MOST) -> None:
        points = mesh.recentred(mesh.vertices)
        cells = points - points.min(axis=0)
        cells *= _FIRST_GRID / (float(np.linalg.norm(cells.max(axis=0))) or 1.0)
        while True:
            key = np.floor(cells).astype(np.int64) @ np.array([1 << 40, 1 << 20, 1])
            filled, joined = np.unique(key, return_inverse=True)
            if len(filled) <= most:
                break
            cells *= math.sqrt(most / len(filled)) * 0.95  # cells on a surface grow as a square
        joined = joined.reshape(-1)
        chosen = _nearest_to_mean(cells, joined, len(filled))
        faces = joined[mesh.faces]
        a, b, c = faces.T
        faces = faces[(a != b) & (b != c) & (c != a)]
        self.chosen: NDArray[np.int64] = chosen
        self.faces: NDArray[np.int64] = np.unique(faces, axis=0)
        self._spaces: dict[int, tuple[ScaleSpace, ChosenSamples]] = {}

    def space(self, space: ScaleSpace) -> ChosenSamples:
        """Return the samples of a scale space that the proxy has; made once for each."""
        if id(space) not in self._spaces:
            self._spaces[id(space)] = space, ChosenSamples(space, self.chosen)
        return self._spaces[id(space)][1]

    @staticmethod
    def worth(shape: Mesh) -> bool:
        """Whether a shape is so big that a proxy would be much smaller."""
        return len(shape.vertices) > 2 * _MOST


def _nearest_to_mean(
    points: NDArray[np.float64], group: NDArray[np.int64], groups: int
) -> NDArray[np.int64]:
    """Return for each group of points the number of the one nearest to the group's mean."""
    counts = np.bincount(group, minlength=groups)
    means = np.stack([np.bincount(group, axis, groups) / counts for axis in points.T], axis=1)
    off = np.linalg.norm(points - means[group], axis=1)
    ordered = np.lexsort((off, group))
    return ordered[np.cumsum(counts) - counts]
