"""How Radiance Scaling scales light at the vertices of a surface (RS, eq. 2)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.shading.scaling_equation import scaling

__all__ = ["Enhancement"]

Single = NDArray[np.float32]


class Enhancement(NamedTuple):
    """How light is scaled at the vertices of a surface.

    Attributes
    ----------
    convexity : (n,) array of float32
        κ in [−1, 1].
    magnitude, invariant : float
        γ and α.
    everywhere : bool
        Whether surfaces also send on light that is scaled, or only show it.
    """

    convexity: Single
    magnitude: float
    invariant: float
    everywhere: bool = False

    def factor(self, delta: NDArray[Any]) -> Single:
        """Return the scaling (n,) of light for which the reflectance mapping is ``delta``."""
        return np.asarray(
            scaling(self.convexity, delta, invariant=self.invariant, magnitude=self.magnitude),
            np.float32,
        )

    def at(self, chosen: NDArray[np.int64]) -> Enhancement:
        """Return that of some of the vertices."""
        return self._replace(convexity=self.convexity[chosen])
