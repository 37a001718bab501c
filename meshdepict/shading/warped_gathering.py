"""How Light Warping gathers light at the vertices of a surface: lights by eq. 2, rays by eq. 1.

Rays of its own leave along W(d), d cosine-weighted, and bring what they meet there. They are traced
anew where curvature, view or magnitude are others, and serve every light.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.direct import unwarped
from meshdepict.shading.features import Frames
from meshdepict.shading.warp_equations import warp_scale

if TYPE_CHECKING:
    from meshdepict.scene.light import Light
    from meshdepict.transport.transfer import Transfer

__all__ = ["Warping", "warping"]

Single = NDArray[np.float32]


class Warping(NamedTuple):
    """Light that is warped before it falls: a `Gathering`.

    Attributes
    ----------
    frames : Frames
        Curvature of the samples.
    magnitude : float
        α.
    warped : callable
        Returns the rays along warped directions, by their number.
    everywhere : bool
        False: only the light that the eye sees is warped (the paper's first bounce).
    """

    frames: Frames
    magnitude: float
    warped: Callable[[int], Transfer]
    everywhere: bool = False

    def falls(self, normals: NDArray[Any], light: Light) -> Single:
        """Return ⟨n·W⁻¹(l)⟩ J."""
        towards = light.direction.astype(np.float32)
        back, weight = unwarped(np.asarray(normals), towards, self.frames, self.magnitude)
        cosine = np.einsum("ni,ni->n", normals, back)
        return np.asarray(np.maximum(cosine, 0) * weight, np.float32)

    def traced(self, space: ScaleSpace, rays: int) -> Transfer:
        """Return rays along warped directions."""
        return self.warped(rays)

    def along(self, transfer: Transfer, *, again: bool = False) -> Transfer:
        """Return the rays as they are: warped."""
        return transfer

    def at(self, chosen: NDArray[np.int64]) -> Warping:
        """Return that of some of the samples."""
        return self._replace(frames=Frames(*(part[chosen] for part in self.frames)))


def warping(
    space: ScaleSpace, frames: Frames, magnitude: float, *, key: tuple[Any, ...]
) -> Warping:
    """Return how samples at the vertices of a surface gather light.

    Parameters
    ----------
    space : ScaleSpace
    frames : Frames
        Their curvature.
    magnitude : float
        α.
    key : tuple
        All that the frames depend on beside the samples.
    """

    def warped(rays: int) -> Transfer:
        found: Transfer = space.kept("warped rays", (rays, magnitude, *key), lambda: traced(rays))
        return found

    def traced(rays: int) -> Transfer:
        from meshdepict.shading.warping_kernel import warp_rays

        axes = (np.ascontiguousarray(axis, np.float32) for axis in (frames.u, frames.v, frames.z))
        stretch = (
            np.ascontiguousarray(warp_scale(k, magnitude), np.float32)
            for k in (frames.ku, frames.kv)
        )
        given = (*axes, *stretch)
        return space.traced(
            rays, bend=lambda directions, which: warp_rays(directions, which, *given)
        )

    return Warping(frames, magnitude, warped)
