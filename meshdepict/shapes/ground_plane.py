"""A level ground under objects, which catches their shadows and sends light up to them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scene.upright import upright
from meshdepict.shapes.mesh import Mesh

__all__ = ["GroundPlane", "ground_under"]

Floats = NDArray[np.float64]

_RINGS = 110
_EVEN = 0.8  # of the rings: evenly apart, as far as pictures show the ground; then ever further
_BELOW = 4e-5  # of its radius: rays of what stands on it start above it
_FADES, _ENDS = 0.45, 0.85  # diagonals from the middle: where pictures show less of it, and no more


class GroundPlane(Mesh):
    """A disc in a level plane, finer in the middle; see `ground_under`.

    Parameters
    ----------
    middle : (3,) array
    up : (3,) array
        Unit.
    unit : float
        Diagonal of what stands on it.
    size : float
        The disc's radius in these.
    mirror : bool
        Whether it is a mirror, and not matt.
    """

    def __init__(
        self,
        middle: Floats,
        up: Floats,
        unit: float,
        size: float,
        *,
        mirror: bool = False,
        length_unit: str = "",
    ) -> None:
        number, turn, faces = _disc(_RINGS)
        near = number / (_EVEN * _RINGS)
        far = np.maximum(near - 1, 0) * _EVEN / (1 - _EVEN)
        radius = np.where(far > 0, _ENDS + (size - _ENDS) * far**2, near * _ENDS)
        across = np.eye(3)[np.abs(up).argmin()]
        x = np.cross(across, up)
        x /= np.linalg.norm(x)
        y = np.cross(up, x)
        flat = np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * y
        self.middle, self.up, self.mirror = middle, up, mirror
        self.unit, self.radius = unit, radius
        points = middle + unit * radius[:, None] * flat
        super().__init__(points, faces, winding="keep", length_unit=length_unit)

    @cached_property
    def coverage(self) -> NDArray[np.float32]:
        """How much (n,) a picture shows of each vertex, in [0, 1]: it has a soft edge."""
        return self.share_at(self.vertices)

    def share_at(self, points: Floats) -> NDArray[np.float32]:
        """Return how much (n,) a picture shows of places on it."""
        away = np.linalg.norm(points - self.middle, axis=1) / self.unit
        share = np.clip((_ENDS - away) / (_ENDS - _FADES), 0, 1)
        return (share * share * (3 - 2 * share)).astype(np.float32)

    @cached_property
    def outline(self) -> Floats:
        """The part (k, 3) of it that pictures show."""
        return self.vertices[self.radius <= (_FADES + _ENDS) / 2]


def ground_under(
    mesh: Mesh | Sequence[Mesh], *, up: str = "y", size: float = 3.0, mirror: bool = False
) -> GroundPlane:
    """Return a level ground under a mesh or several, at the lowest point: a disc about the middle.

    Pictures show its middle, with a soft edge; shadows and light that bounces go as far as it is.

    Parameters
    ----------
    mesh : Mesh or sequence of Mesh
        What stands on it.
    up : {"y", "z", "-y", "-z", "x", "-x"}
        Which axis points up.
    size : float
        Its radius, in diagonals of the box about them all, 1 … 100.
    mirror : bool
        Whether it is a mirror. What is matt is shaded as objects are.

    Raises
    ------
    MeshdepictError
        For anything else, and without a mesh.
    """
    several = [mesh] if isinstance(mesh, Mesh) or not np.iterable(mesh) else [*mesh]
    if not several or not all(isinstance(each, Mesh) for each in several):
        raise MeshdepictError("ground_under needs the mesh that stands on it, or several")
    if not 1 <= (real(size) or 0) <= 100:
        raise MeshdepictError(f"size={size!r} is not a number of diagonals from 1 to 100")
    if not isinstance(mirror, bool):
        raise MeshdepictError(f"mirror={mirror!r} is neither True nor False")
    axis = upright(up)[:, 1]
    low = np.min([each.vertices.min(axis=0) for each in several], axis=0)
    high = np.max([each.vertices.max(axis=0) for each in several], axis=0)
    centre = low / 2 + high / 2
    unit = float(np.linalg.norm(high - low)) or float(np.abs(centre).max()) or 1.0
    down = float(np.abs((high - low) @ axis)) / 2 + _BELOW * float(size) * unit
    units = {each.length_unit for each in several}
    return GroundPlane(
        centre - down * axis, axis, unit, float(size), mirror=mirror,
        length_unit=units.pop() if len(units) == 1 else "",
    )  # fmt: skip


def _disc(rings: int) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Return the ring and the angle of points on a disc, six more on each ring, and triangles."""
    number = np.repeat(np.arange(rings + 1), np.maximum(6 * np.arange(rings + 1), 1))
    first = np.concatenate([[0], 1 + 3 * np.arange(rings + 1) * np.arange(1, rings + 2)])
    place = np.arange(len(number)) - first[number]
    turn = 2 * np.pi * place / np.maximum(6 * number, 1)
    parts = []
    for ring in range(1, rings + 1):
        # A sixth of a ring has one place more than that of the ring within.
        sixth, along = (part.ravel() for part in np.meshgrid(range(6), range(ring), indexing="ij"))
        inner = max(6 * (ring - 1), 1)
        outer = first[ring] + (sixth * ring + along) % (6 * ring)
        after = first[ring] + (sixth * ring + along + 1) % (6 * ring)
        within = first[ring - 1] + (sixth * (ring - 1) + along) % inner
        parts.append(np.stack([within, outer, after], axis=1))
        more = along > 0
        before = first[ring - 1] + (sixth * (ring - 1) + along - 1) % inner
        parts.append(np.stack([before, outer, within], axis=1)[more])
    return number.astype(np.float64), turn, np.concatenate(parts)
