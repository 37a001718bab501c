"""How Local Light Alignment gathers light at the vertices of a surface: every direction aligned.

Light that comes from d is shaded as if it came from where d is turned to; who sees it, and how
bright it is, stay those of d. Alignment brings up light that grazes a surface, where rays are few
if they are cosine-weighted: half of them are evenly spread, and each weighs ⟨n·d'⟩ / (½⟨n·d⟩ + ¼).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.sharpness import SINGLE
from meshdepict.threads import each, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.scene.light import Light
    from meshdepict.shading.weighed_transfer import WeighedTransfer
    from meshdepict.transport.transfer import Transfer

__all__ = ["Alignment", "alignment"]

Single = NDArray[np.float32]
Pair = tuple["WeighedTransfer", "WeighedTransfer"]


class Alignment(NamedTuple):
    """Light that is aligned before it falls: a `Gathering`.

    Attributes
    ----------
    planes : (S, 3, n) array
        Normals of the samples, fine to coarse.
    strengths : (S − 1,) array
        Finest first.
    sharpness : float
        γ.
    traced : callable
        Returns the weighed rays by their number, and the second set that tells their error.
    everywhere : bool
        False: only the light that the eye sees is aligned.
    """

    planes: Single
    strengths: NDArray[np.float64]
    sharpness: float
    traced: Callable[[int], Pair]
    everywhere: bool = False

    def falls(self, normals: NDArray[Any], light: Light) -> Single:
        """Return ⟨n·l'⟩."""
        from meshdepict.shading.alignment_kernel import align_chain

        turned = align_chain(self.planes, light.direction, self.strengths, self.sharpness)
        return np.asarray(np.maximum((self.planes[0] * turned).sum(axis=0), 0), np.float32)

    def along(self, transfer: Transfer, *, again: bool = False) -> WeighedTransfer:
        """Return as many rays of which half are evenly spread, weighed."""
        return self.traced(transfer.rays)[int(again)]

    def at(self, chosen: NDArray[np.int64]) -> Alignment:
        """Return that of some of the samples."""
        return self._replace(planes=np.ascontiguousarray(self.planes[:, :, chosen]))


def alignment(
    space: ScaleSpace, scales: Sequence[int], strengths: NDArray[np.float64], sharpness: float
) -> Alignment:
    """Return how samples at the vertices of a surface gather light.

    Parameters
    ----------
    space : ScaleSpace
    scales : sequence of int
        Which normals light is aligned with, finest first.
    strengths : (S − 1,) array
        Of their pairs.
    sharpness : float
        γ.
    """
    planes = space.planes_of(scales)

    def traced(rays: int) -> Pair:
        key = (rays, *scales, *strengths.tolist(), sharpness)
        found: Pair = space.kept("aligned weights", key, lambda: _weighed(rays))
        return found

    def _weighed(rays: int) -> Pair:
        own: Transfer = space.kept("aligned rays", (rays,), lambda: _traced(space, rays))
        assert own.probes is not None  # as every set that leaves the vertices has them
        again = np.ascontiguousarray(planes[:, :, own.probes.chosen])
        return (
            weighed(own, planes, strengths, sharpness),
            weighed(own.probes.transfer, again, strengths, sharpness),
        )

    return Alignment(planes, strengths, sharpness, traced)


def _traced(space: ScaleSpace, rays: int) -> Transfer:
    from meshdepict.transport.rays import half_even
    from meshdepict.transport.transfer import traced_transfer

    return traced_transfer(space.surface, normals=space.normals_at(0), rays=rays, height=half_even)


def weighed(
    transfer: Transfer, planes: Single, strengths: NDArray[np.float64], sharpness: float
) -> WeighedTransfer:
    """Return rays of `rays.half_even` heights, each as much as it counts once it is aligned."""
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
