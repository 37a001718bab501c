"""What is computed of a surface's vertices and triangles: size, sides, normals, areas."""

from __future__ import annotations

import warnings
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictWarning
from meshdepict.scene.vectors import frozen
from meshdepict.surface import triangles
from meshdepict.surface.welding import normal_groups, same_position

if TYPE_CHECKING:
    from meshdepict.surface.orientation import Orientation
    from meshdepict.surface.sides import Sides

__all__ = ["Geometry"]

Floats = NDArray[np.float64]

_STEPS = 64  # of single precision: what a handful of operations on coordinates leaves


class Geometry:
    """A surface of triangles; each quantity is computed on first use, once.

    Attributes
    ----------
    vertices : (n, 3) array
    faces : (m, 3) array of int
        Both checked and read-only: a `Mesh` sees to that.
    winding : {"auto", "keep"}
        Whether triangles that point inwards are turned before normals are computed.
    """

    vertices: Floats
    faces: NDArray[np.int64]
    winding: str
    _groups: NDArray[np.int64] | None

    # --- size -------------------------------------------------------------------------------

    @property
    def outline(self) -> Floats:
        """World positions (n, 3) that a fitted view has to show: the vertices."""
        return self.vertices

    @cached_property
    def centre(self) -> Floats:
        """(3,) middle of the bounding box."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return low / 2 + high / 2

    @cached_property
    def diagonal(self) -> float:
        """Diagonal of the bounding box, in world units."""
        extent = self.vertices.max(axis=0) - self.vertices.min(axis=0)
        largest = float(extent.max())
        return largest and largest * float(np.linalg.norm(extent / largest))

    @cached_property
    def unit_points(self) -> Floats:
        """The vertices moved to the origin and scaled to a diagonal of one.

        All geometry is computed on these, so that neither survey coordinates nor metres in
        nanometres cost digits, and squares of squares of lengths neither overflow nor vanish.
        """
        return frozen(self.recentred(self.vertices))

    def recentred(self, points: Floats) -> Floats:
        """Return world positions (…, 3) relative to the mesh's centre, in its diagonals."""
        moved: Floats = points - self.centre
        moved /= self.diagonal or 1.0
        return moved

    @cached_property
    def edge_length(self) -> float:
        """Median length of the edges that have a length, in world units."""
        lengths = triangles.edge_lengths(self.unit_points, self.faces)
        lengths = lengths[lengths > 0]
        return float(np.median(lengths)) * self.diagonal if len(lengths) else self.diagonal or 1.0

    # --- orientation ------------------------------------------------------------------------

    @cached_property
    def _sides(self) -> Sides:
        from meshdepict.surface.sides import Sides

        found = Sides(
            self.unit_points,
            self.faces,
            turn=self.winding == "auto",
            rounding=self._rounding / (self.diagonal or 1.0),
            unit=self.diagonal or 1.0,
        )
        if found.message:
            warnings.warn(found.message, MeshdepictWarning, stacklevel=4)
        return found

    @property
    def _rounding(self) -> float:
        """How far off coordinates are in single precision: far from the origin, visibly so."""
        with np.errstate(over="ignore"):
            if not np.array_equal(self.vertices.astype(np.float32), self.vertices):
                return 0.0
        return _STEPS * float(np.finfo(np.float32).eps * np.abs(self.vertices).max())

    @cached_property
    def orientation(self) -> Orientation:
        """Which faces had to be turned to point outwards, and what shading makes of the surface.

        A face that is there with both windings turns with the side that is shaded.
        """
        from meshdepict.surface.orientation import Orientation

        return Orientation(self._sides.flipped, self._sides.message)

    @cached_property
    def outward_faces(self) -> NDArray[np.int64]:
        """The triangles, all turned outwards."""
        return frozen(self._sides.faces)

    @cached_property
    def open_faces(self) -> NDArray[np.bool_]:
        """Of each triangle, whether its part of the surface has a boundary; see `openings`."""
        from meshdepict.surface.openings import open_faces

        return frozen(open_faces(self.unit_points, self.faces))

    # --- what shading needs -----------------------------------------------------------------

    @cached_property
    def normals(self) -> Floats:
        """(n, 3) unit normals, outward; weighted after Max 1999, so exact on a sphere.

        Vertices at bit-identical positions share one normal unless their own differ by more than
        90°. A vertex that no proper face meets has +z.
        """
        sums = triangles.normal_sums(self.unit_points, self.outward_faces)
        sums = self._shared(sums)
        scale = np.abs(sums).max(axis=1, keepdims=True)
        sums /= np.where(scale > 0, scale, 1.0)  # before squaring: a needle's weights overflow
        length = np.linalg.norm(sums, axis=1, keepdims=True)
        return frozen(
            np.where(length > 0, sums / np.where(length > 0, length, 1.0), (0.0, 0.0, 1.0))
        )

    @cached_property
    def areas(self) -> Floats:
        """(n,) mixed Voronoi areas after Meyer et al. 2002, in squared world units."""
        return frozen(self.unit_areas * self.diagonal**2)

    @cached_property
    def unit_areas(self) -> Floats:
        """The areas of a mesh whose diagonal is 1."""
        areas = triangles.mixed_voronoi_areas(self.unit_points, self.faces)
        return frozen(self._shared(areas, mean=True))

    @cached_property
    def groups(self) -> NDArray[np.int64] | None:
        """For each vertex the group it shares normal and curvature with; None: all alone.

        Groups are numbered from 0 without gaps.
        """
        if self._groups is not None:
            return self._groups
        position = same_position(self._sides.points)
        if position is None:
            return None
        return normal_groups(position, triangles.normal_sums(self.unit_points, self.outward_faces))

    def _shared(self, values: Floats, *, mean: bool = False) -> Floats:
        """Sum (or average) per-vertex values over the vertices at one position."""
        group = self.groups
        if group is None:
            return values
        columns = values.reshape(len(values), -1).T
        total: Floats = np.stack([np.bincount(group, column) for column in columns], axis=1)
        count = np.bincount(group)[:, None] if mean else 1
        return (total / count)[group].reshape(values.shape)
