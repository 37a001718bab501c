"""Bodies given by their signed distance, slice by slice, and unions of them with fillets."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["FAR", "Body", "Plane", "Slice", "cut", "join"]

Plane = NDArray[np.float32]
Place = tuple[float, float, float]

FAR = 1e3
"""Further than anything, in mm."""

_REACH = 16.0  # mm: beyond the widest fillet


class Body(NamedTuple):
    """Distance to a body's surface, negative inside, in a window of a slice that holds it."""

    window: tuple[slice, slice]
    distance: Plane


class Slice:
    """A plane at height z, x (nx,) and y (ny, 1) in mm, and the tissues laid into it.

    `numbers` (ny, nx) begins with a `background`; `border` is as wide as a voxel.
    """

    def __init__(self, x: Plane, y: Plane, z: float, border: float, background: float) -> None:
        self.x, self.y, self.z, self.border = x, y, z, border
        self.numbers = np.full((len(y), len(x)), background, np.float32)

    def lay(self, body: Body | Plane | None, value: float) -> None:
        """Put a tissue where the distance is negative, in parts on the border."""
        if body is None:
            return
        window, distance = body if isinstance(body, Body) else (..., body)
        share = np.clip(0.5 - distance / self.border, 0, 1)
        self.numbers[window] += share * (value - self.numbers[window])

    def window(self, low: Place, high: Place) -> tuple[slice, slice] | None:
        """Return rows and columns that hold a box and the reach of fillets round it."""
        if not low[2] - _REACH < self.z < high[2] + _REACH:
            return None
        left, right = np.searchsorted(self.x, (low[0] - _REACH, high[0] + _REACH))
        front, back = np.searchsorted(self.y[:, 0], (low[1] - _REACH, high[1] + _REACH))
        return slice(int(front), int(back)), slice(int(left), int(right))

    def ellipsoid(self, centre: Place, radii: Place) -> Body | None:
        """Return an ellipsoid; its distance is exact on it, and to first order near it."""
        (cx, cy, cz), (rx, ry, rz) = centre, radii
        window = self.window((cx - rx, cy - ry, cz - rz), (cx + rx, cy + ry, cz + rz))
        if window is None:
            return None
        x, y = (self.x[window[1]] - cx) / rx, (self.y[window[0]] - cy) / ry
        z = (self.z - cz) / rz
        form = np.sqrt(x**2 + (y**2 + z**2))
        slope = np.sqrt((x / rx) ** 2 + ((y / ry) ** 2 + (z / rz) ** 2 + 1e-12))
        return Body(window, form * (form - 1) / slope)

    def rod(self, start: Place, end: Place, radius: float) -> Body | None:
        """Return a rod with round ends."""
        ends = np.array((start, end))
        low, high = ends.min(axis=0) - radius, ends.max(axis=0) + radius
        window = self.window(tuple(low.tolist()), tuple(high.tolist()))
        if window is None:
            return None
        a, b, c = (ends[1] - ends[0]).tolist()
        x, y = self.x[window[1]] - start[0], self.y[window[0]] - start[1]
        z = self.z - start[2]
        share = np.clip((x * a + (y * b + z * c)) / (a * a + b * b + c * c), 0, 1)
        far = np.sqrt((x - share * a) ** 2 + (y - share * b) ** 2 + (z - share * c) ** 2)
        return Body(window, far - radius)

    def tube(self, cy: float, radius: float, top: float) -> Body | None:
        """Return an upright cylinder in the middle plane, from below up to its top."""
        window = self.window((-radius, cy - radius, -FAR), (radius, cy + radius, top))
        if window is None:
            return None
        far = np.hypot(self.x[window[1]], self.y[window[0]] - cy) - radius
        return Body(window, np.maximum(far, self.z - top))

    def nothing(self) -> Plane:
        """Return the distance to no body at all."""
        return np.full(self.numbers.shape, FAR, np.float32)

    def joined(self, *bodies: tuple[Body | None, float]) -> Plane | None:
        """Return the union of bodies, each joined to the earlier ones by a fillet of a radius."""
        found = [(body, radius) for body, radius in bodies if body is not None]
        if not found:
            return None
        union = self.nothing()
        for (window, distance), radius in found:
            union[window] = _union(union[window], distance, radius)
        return union


def _union(a: Plane, b: Plane, radius: float) -> Plane:
    """Return the distance to two bodies joined by a fillet."""
    blend = np.clip(radius - np.abs(a - b), 0, None)
    return np.minimum(a, b) - blend * blend * (0.25 / radius)


def join(bodies: Plane | None, body: Body | None, radius: float) -> None:
    """Join a body to others, in place."""
    if bodies is not None and body is not None:
        bodies[body.window] = _union(bodies[body.window], body.distance, radius)


def cut(bodies: Plane, body: Body | None, radius: float) -> None:
    """Take a body out of others, the edge rounded, in place."""
    if body is not None:
        bodies[body.window] = -_union(-bodies[body.window], body.distance, radius)
