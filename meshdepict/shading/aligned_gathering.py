"""How Local Light Alignment gathers light at the vertices of a surface: every direction aligned.

Light that comes from d is shaded as if it came from where d is turned to; who sees it, and how
bright it is, stay those of d. Alignment brings up light that grazes a surface, where rays are few
if they are cosine-weighted: half of them are evenly spread, and each weighs ⟨n·d'⟩ / (½⟨n·d⟩ + ¼).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.sharpness import SINGLE
from meshdepict.threads import each, spans, thread_count
from meshdepict.transport.rays import half_even

if TYPE_CHECKING:
    from meshdepict.scene.light import Light
    from meshdepict.shading.weighed_transfer import WeighedTransfer
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["Alignment", "weighed"]

Single = NDArray[np.float32]


class Alignment(NamedTuple):
    """Light that is aligned before it falls: a `Gathering`.

    Attributes
    ----------
    planes : (S, 3, n) array
        Normals of the samples, fine to coarse.
    scales : (S,) tuple of int
        Which they are.
    strengths : (S − 1,) array
        Finest first.
    sharpness : float
        γ.
    vertices : ScaleSpace, optional
        Whose vertices the samples are, and where weights are kept; None: they are some of those.
    everywhere : bool
        False: only the light that the eye sees is aligned.
    """

    planes: Single
    scales: tuple[int, ...]
    strengths: NDArray[np.float64]
    sharpness: float
    vertices: ScaleSpace | None = None
    everywhere: bool = False

    def falls(self, normals: NDArray[Any], light: Light) -> Single:
        """Return ⟨n·l'⟩."""
        from meshdepict.shading.alignment_kernel import align_chain

        turned = align_chain(self.planes, light.direction, self.strengths, self.sharpness)
        return np.asarray(np.maximum((self.planes[0] * turned).sum(axis=0), 0), np.float32)

    def traced(self, space: ScaleSpace, rays: int) -> Transfer | Retraced:
        """Return rays of which half are evenly spread."""
        from meshdepict.transport.transfer import Leaving

        return space.vertex_space.traced_once("even rays", (), rays, lambda: Leaving(half_even))

    def along(self, transfer: Transfer, *, again: bool = False) -> WeighedTransfer:
        """Return the rays, each as much as it counts once it is aligned."""

        def find() -> WeighedTransfer:
            return weighed(transfer, self.planes, self.strengths, self.sharpness)

        if self.vertices is None:
            return find()
        key = (transfer.rays, self.scales, *self.strengths.tolist(), self.sharpness, again)
        found: WeighedTransfer = self.vertices.kept("aligned weights", key, find)
        return found

    def at(self, chosen: NDArray[np.int64]) -> Alignment:
        """Return that of some of the samples."""
        some = np.ascontiguousarray(self.planes[:, :, chosen])
        return self._replace(planes=some, vertices=None)


def weighed(
    transfer: Transfer, planes: Single, strengths: NDArray[np.float64], sharpness: float
) -> WeighedTransfer:
    """Return rays of `rays.half_even` heights, each as much as it counts once it is aligned.

    Parameters
    ----------
    transfer : Transfer
    planes : (S, 3, n) array
        Normals of its samples, fine to coarse.
    strengths : (S − 1,) array
        Finest first.
    sharpness : float
        γ.
    """
    from meshdepict.shading.alignment_weights import ray_weights
    from meshdepict.shading.weighed_transfer import WeighedTransfer
    from meshdepict.transport.sky_cells import cell_directions

    exact = sharpness > SINGLE
    precision = np.float64 if exact else np.float32
    t = transfer
    met, away = np.empty(len(t.triangle), np.uint16), np.empty(len(t.sky), np.uint16)
    cells = cell_directions().astype(np.float32)
    given = (
        np.ascontiguousarray(planes), strengths.astype(precision), precision(math.exp(-sharpness)),
        exact, t.rays, t.hits, t.triangle, t.weights, t.misses, t.sky, t.faces, t.surface,
        t.points, cells,
    )  # fmt: skip
    pieces = 4 * thread_count() if len(t) * t.rays > 20_000 else 1
    each(lambda a, b: ray_weights(*given, a, b, met, away), spans(len(t), pieces))
    return WeighedTransfer(transfer, met, away)
