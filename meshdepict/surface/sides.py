"""The surface as it is shaded: gaps of rounding closed, one side of doubled faces, and outwards."""

from __future__ import annotations

import copy
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.edges import is_balanced

__all__ = ["Sides"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Sides:
    """Which way the faces of a mesh look, once its surface hangs together.

    Parameters
    ----------
    points : (n, 3) array
        In a box with a diagonal of one.
    faces : (m, 3) array of int
    turn : bool
        Whether faces may be turned to agree, and to look outwards.
    rounding : float
        How far off points are by the type of their coordinates.
    unit : float
        The diagonal, for what is said.
    """

    def __init__(
        self, points: Floats, faces: Ints, *, turn: bool, rounding: float, unit: float
    ) -> None:
        from meshdepict.surface.doubling import other_sides
        from meshdepict.surface.gaps import closed_gaps
        from meshdepict.surface.orientation import orient

        balanced: bool | None = is_balanced(faces, len(points))
        gaps = None if balanced else closed_gaps(points, faces, rounding=rounding)
        self.points = points if gaps is None else gaps.points  # closed ones at one position
        others = other_sides(self.points, faces)
        self._given, self._others = faces, others
        said = []
        self.flipped = np.zeros(len(faces), bool)  # to look outwards; both of two sides together
        if turn:
            known = balanced if others is None else None
            found = orient(self.points, self._turned(others), balanced=known)
            self.flipped = found.flipped
            said += [found.message] if found.message else []
        if gaps is not None:
            said.append(
                f"{gaps.corners:,} corners at open edges differ from their neighbours' by "
                f"rounding ({gaps.widest * unit:.2g} at most): each such gap is closed for shading"
            )
        if others is not None:
            said.append(
                f"{int(others.sum()):,} faces are there twice, with both windings: "
                "one side of them is shaded"
            )
        self.message = "; ".join(said) or None

    @cached_property
    def faces(self) -> Ints:
        """(m, 3) faces, outwards, both of two sides as the one that is shaded."""
        others = self._others
        return self._turned(self.flipped if others is None else self.flipped ^ others)

    def renumbered(self, faces: Ints, source: Ints) -> Sides:
        """Return the same surface with other vertices, each standing for one of these.

        Parameters
        ----------
        faces : (m, 3) array
            In the other vertices.
        source : (n,) array
            The vertex that each stands for.
        """
        other = copy.copy(self)
        other.__dict__.pop("faces", None)
        other.points, other._given = self.points[source], faces
        return other

    def _turned(self, which: Bools | None) -> Ints:
        if which is None or not which.any():
            return self._given
        return np.where(which[:, None], self._given[:, ::-1], self._given)
