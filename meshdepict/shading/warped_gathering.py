"""How Light Warping gathers light at the vertices of a surface: lights by eq. 2, rays by eq. 1.

Rays of its own leave along W(d), d cosine-weighted, and bring what they meet there. They are traced
anew where curvature, view or magnitude are others, and serve every light.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.direct import unwarped
from meshdepict.shading.features import Frames
from meshdepict.shading.warp_equations import warp_scale

if TYPE_CHECKING:
    from meshdepict.scene.light import Light
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Leaving, Transfer

__all__ = ["Warping"]

Single = NDArray[np.float32]


class Warping(NamedTuple):
    """Light that is warped before it falls: a `Gathering`.

    Attributes
    ----------
    frames : Frames
        Curvature of the samples.
    magnitude : float
        α.
    key : tuple
        All that the frames depend on beside the samples; see `features.frames_key`.
    everywhere : bool
        False: only the light that the eye sees is warped (the paper's first bounce).
    """

    frames: Frames
    magnitude: float
    key: tuple[Any, ...]
    everywhere: bool = False

    def falls(self, normals: NDArray[Any], light: Light) -> Single:
        """Return ⟨n·W⁻¹(l)⟩ J."""
        towards = light.direction.astype(np.float32)
        back, weight = unwarped(np.asarray(normals), towards, self.frames, self.magnitude)
        cosine = np.einsum("ni,ni->n", normals, back)
        return np.asarray(np.maximum(cosine, 0) * weight, np.float32)

    def traced(self, space: ScaleSpace, rays: int) -> Transfer | Retraced:
        """Return rays along warped directions."""
        return space.vertex_space.traced_once(
            "warped rays", (self.magnitude, *self.key), rays,
            lambda: _leaving(self.frames, self.magnitude),
        )  # fmt: skip

    def along(self, transfer: Transfer, *, again: bool = False) -> Transfer:
        """Return the rays as they are: warped."""
        return transfer

    def at(self, chosen: NDArray[np.int64]) -> Warping:
        """Return that of some of the samples."""
        return self._replace(frames=Frames(*(part[chosen] for part in self.frames)))


@dataclass(frozen=True, eq=False)
class _WarpedRays:
    """What turns directions d to W(d): frames and λ of all samples."""

    u: Single
    v: Single
    z: Single
    scale_u: Single
    scale_v: Single

    def __call__(self, directions: Single, which: NDArray[np.int64]) -> None:
        from meshdepict.shading.warping_kernel import warp_rays

        warp_rays(
            directions, which, self.u, self.v, self.z, self.scale_u, self.scale_v
        )  # fmt: skip


def _leaving(frames: Frames, magnitude: float) -> Leaving:
    from meshdepict.transport.transfer import Leaving

    stretch = (warp_scale(k, magnitude) for k in (frames.ku, frames.kv))
    arrays = (frames.u, frames.v, frames.z, *stretch)
    return Leaving(bend=_WarpedRays(*(np.ascontiguousarray(a, np.float32) for a in arrays)))
