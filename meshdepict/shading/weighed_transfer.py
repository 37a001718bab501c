"""Rays that don't count alike: what a transfer brings along each, times the ray's own weight."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count
from meshdepict.transport.sky_cells import sky_colors

if TYPE_CHECKING:
    from meshdepict.scene.environment import Environment
    from meshdepict.transport.transfer import Transfer

__all__ = ["WHOLE", "WeighedTransfer"]

Single = NDArray[np.float32]

WHOLE = 16_383
"""A weight of 1: the largest is 4, in two bytes."""

_WEIGHTS = 65_535  # of a barycentric coordinate of 1, as `Transfer` has them


class WeighedTransfer:
    """What arrives at samples along the rays of a transfer, each as much as it counts.

    Parameters
    ----------
    transfer : Transfer
    met, away : arrays of uint16
        Weights of its rays that meet a face and of those that get away, in 1/`WHOLE`.
    """

    def __init__(
        self, transfer: Transfer, met: NDArray[np.uint16], away: NDArray[np.uint16]
    ) -> None:
        self._transfer, self._met, self._away = transfer, met, away
        for array in (met, away):
            array.setflags(write=False)
        self._share = np.float32(1 / (transfer.rays * WHOLE))

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self._transfer)

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return what arrives of light that the surface sends; see `Transfer.from_surface`."""
        t = self._transfer
        columns = np.ascontiguousarray(values.reshape(len(values), -1), np.float32)
        out = np.empty((len(t), columns.shape[1]), np.float32)
        each(
            lambda a, b: _weighed_surface(
                t.hits, t.triangle, t.weights, t.faces, columns, self._met, self._share, a, b, out
            ),
            spans(len(t), thread_count()),
        )
        return out.reshape(len(t), *values.shape[1:])

    def from_sky(self, environment: Environment) -> Single:
        """Return what arrives (n, 3) of an environment."""
        t = self._transfer
        colors, out = sky_colors(environment, t.rays), np.empty((len(t), 3), np.float32)
        each(
            lambda a, b: _weighed_sky(
                t.misses, t.sky, colors, self._away, self._share, a, b, out
            ),
            spans(len(t), thread_count()),
        )  # fmt: skip
        return out


@kernel("contracted")
def _weighed_surface(hits, triangle, weights, faces, values, counts, share, begin, end, out):  # type: ignore[no-untyped-def]
    """Sum what the rays of samples [begin, end) meet, each as much as it counts."""
    unit = np.float32(1 / _WEIGHTS)
    for i in range(begin, end):
        for channel in range(values.shape[1]):
            total = np.float32(0)
            for k in range(hits[i], hits[i + 1]):
                f = triangle[k]
                second, third = weights[k, 0] * unit, weights[k, 1] * unit
                first = max(np.float32(1) - second - third, np.float32(0))
                total += np.float32(counts[k]) * (
                    first * values[faces[f, 0], channel]
                    + second * values[faces[f, 1], channel]
                    + third * values[faces[f, 2], channel]
                )
            out[i, channel] = total * share


@kernel("contracted")
def _weighed_sky(misses, sky, colors, counts, share, begin, end, out):  # type: ignore[no-untyped-def]
    """Sum the sky that the rays of samples [begin, end) see, each as much as it counts."""
    for i in range(begin, end):
        red = green = blue = np.float32(0)
        for k in range(misses[i], misses[i + 1]):
            c, weight = sky[k], np.float32(counts[k])
            red += weight * colors[c, 0]
            green += weight * colors[c, 1]
            blue += weight * colors[c, 2]
        out[i, 0], out[i, 1], out[i, 2] = red * share, green * share, blue * share
