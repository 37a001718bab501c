"""How Radiance Scaling scales light at the vertices of a surface (RS, eq. 2)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.shading.gathering import PLAIN
from meshdepict.shading.scaling_equation import scaling

if TYPE_CHECKING:
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.scene.light import Light
    from meshdepict.shading.scaled_transfer import ScaledTransfer
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["Enhancement"]

Single = NDArray[np.float32]


class Enhancement(NamedTuple):
    """How light is scaled at the vertices of a surface: a `Gathering`.

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

    def falls(self, normals: NDArray[Any], light: Light) -> Single:
        """Return ⟨n·l⟩, scaled."""
        plainly = PLAIN.falls(normals, light)
        return plainly * self.factor(plainly)

    def traced(self, space: ScaleSpace, rays: int) -> Transfer | Retraced:
        """Return the space's own rays."""
        return space.transport(rays)

    def along(self, transfer: Transfer, *, again: bool = False) -> ScaledTransfer:
        """Return what scales each ray."""
        from meshdepict.shading.scaled_transfer import ScaledTransfer

        # E = e^−γκ and its limits are the equation's at δ = 0.
        faded = self.factor(np.zeros(len(self.convexity), np.float32))
        return ScaledTransfer(transfer, faded, self.invariant)

    def at(self, chosen: NDArray[np.int64]) -> Enhancement:
        """Return that of some of the vertices."""
        return self._replace(convexity=self.convexity[chosen])
