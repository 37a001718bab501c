"""Which samples see which lights: kept, for the next exposure and for lights that stay."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.light import Light

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["SeenLights"]

Single = NDArray[np.float32]

_MOST = 128  # directions that are kept, a bit a sample: four panoramas


class SeenLights:
    """Whether samples see lights, each as one direction; the last ones are kept.

    Parameters
    ----------
    mesh : Mesh
        What casts shadows.
    at : two (n, 3) arrays
        Of the samples: positions in the mesh's unit frame, and unit normals.
    """

    def __init__(self, mesh: Mesh, at: tuple[NDArray[Any], NDArray[Any]]) -> None:
        from meshdepict.transport.rays import lifted

        self._mesh, self._at, self._lifts = mesh, at, lifted(*at)
        self._kept: dict[bytes, NDArray[np.uint8]] = {}  # in the order they were asked for

    def shares(self, lights: Sequence[Light]) -> tuple[Single, ...]:
        """Return the share (n,) of each light that is seen, 0 or 1; new lights at once."""
        from meshdepict.transport.shadows import seen_directions

        keys = [light.direction.tobytes() for light in lights]
        known = {key: self._kept.pop(key) for key in dict.fromkeys(keys) if key in self._kept}
        new = {
            key: light.direction
            for key, light in zip(keys, lights, strict=True)
            if key not in known
        }
        if new:
            found = seen_directions(
                self._mesh, np.array([*new.values()]), at=self._at, lifts=self._lifts
            )
            known.update(zip(new, np.packbits(found, axis=1), strict=True))
        self._kept.update(known)
        for key in [*self._kept][:-_MOST]:
            del self._kept[key]
        count = len(self._at[0])
        return tuple(np.unpackbits(known[key], count=count).astype(np.float32) for key in keys)
