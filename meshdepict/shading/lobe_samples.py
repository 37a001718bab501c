"""Samples in the lobes of points: summed as they are, or told one by one."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.environment import Environment
from meshdepict.shading.lobe_tables import WIDE
from meshdepict.threads import each, spans, thread_count

__all__ = ["LobeSamples", "summed"]

Single = NDArray[np.float32]

_UNTOLD = (
    np.empty((0, 0, 3), np.float32), np.empty((0, 0), np.float32), np.empty((0, 0), np.int32),
)  # fmt: skip


class LobeSamples(NamedTuple):
    """Samples of the lobes of some points.

    Attributes
    ----------
    arguments : tuple
        Of `lobe_kernel.sum_lobes`.
    points, samples : int
        How many points there are, and how many samples of each.
    parts : int
        Into how many a sample may be parted.
    texels : (k, 3) array
        What is looked up.
    """

    arguments: tuple[Any, ...]
    points: int
    samples: int
    parts: int
    texels: Single

    def told(self, begin: int, end: int) -> tuple[Single, Single, NDArray[np.int32]]:
        """Return where the light of points [begin, end) comes from, its weights, and its texels.

        Each weight is what radiance there counts, times π.
        """
        from meshdepict.shading.lobe_kernel import sum_lobes

        shape = end - begin, -(-self.samples * self.parts // WIDE) * WIDE
        told = np.zeros((*shape, 3), np.float32), np.empty(shape, np.float32)
        places = np.zeros(shape, np.int32)
        sum_lobes(*self.arguments, np.empty((0, 3), np.float32), *told, places, begin, end)
        return *told, places


def summed(parts: list[LobeSamples], environment: Environment) -> Single:
    """Return the sum over samples."""
    from meshdepict.shading.lobe_kernel import sum_lobes

    total = np.zeros((parts[0].points, 1), np.float32)
    for part in parts:
        out, work = np.zeros((part.points, 3), np.float32), part.points * part.samples
        each(
            lambda a, b, part=part, out=out: sum_lobes(*part.arguments, out, *_UNTOLD, a, b),
            spans(part.points, 4 * thread_count() if work > 20_000 else 1),
        )
        total = total + (out[:, :1] if environment.gray else out)
    return total
