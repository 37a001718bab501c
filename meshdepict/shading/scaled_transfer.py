"""Radiance Scaling inside the sums of light that comes by rays: each ray is scaled, δ = n·d.

An equal of `Transfer` that gathers light as an enhanced surface reflects it: eq. 2 of the paper for
every direction that light comes from, whether a surface or the sky sends it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count
from meshdepict.transport.sky_cells import cell_directions, sky_colors

if TYPE_CHECKING:
    from meshdepict.scene.environment import Environment
    from meshdepict.transport.transfer import Transfer

__all__ = ["ScaledTransfer"]

Single = NDArray[np.float32]

_WEIGHTS = 65_535  # of a barycentric coordinate of 1, as `Transfer` has them


class ScaledTransfer:
    """What arrives at samples along the rays of a transfer, each ray scaled.

    Parameters
    ----------
    transfer : Transfer
    faded : (n,) array of float32
        The scaling of its samples where the reflectance mapping δ is 0.
    invariant : float
        α.
    """

    def __init__(self, transfer: Transfer, faded: Single, invariant: float) -> None:
        self._transfer = transfer
        self._faded, self._alpha = faded, np.float32(invariant)
        self._share = np.float32(1 / transfer.rays)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self._transfer)

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return what arrives of light that the surface sends; see `Transfer.from_surface`."""
        t = self._transfer
        columns = np.ascontiguousarray(values.reshape(len(values), -1), np.float32)
        out = np.empty((len(t), columns.shape[1]), np.float32)
        each(
            lambda a, b: _scaled_surface(
                t.hits, t.triangle, t.weights, t.faces, columns, t.points, t.normals,
                t.surface, self._faded, self._alpha, self._share, a, b, out,
            ),
            spans(len(t), thread_count()),
        )  # fmt: skip
        return out.reshape(len(t), *values.shape[1:])

    def from_sky(self, environment: Environment) -> Single:
        """Return what arrives (n, 3) of an environment."""
        t = self._transfer
        colors = sky_colors(environment, t.rays)
        directions = cell_directions().astype(np.float32)
        out = np.empty((len(t), 3), np.float32)
        each(
            lambda a, b: _scaled_sky(
                t.misses, t.sky, colors, directions, t.normals, self._faded, self._alpha,
                self._share, a, b, out,
            ),
            spans(len(t), thread_count()),
        )  # fmt: skip
        return out


@kernel("contracted", inline=True)
def _factor(cosine, faded, alpha):  # type: ignore[no-untyped-def]
    """Return the scaling at δ = a cosine, held between 0 and 1."""
    delta = min(max(cosine, np.float32(0)), np.float32(1))
    low = alpha * (np.float32(1) - delta)
    high = (np.float32(1) - alpha) * delta
    return (low * faded + high) / (low + high * faded)


@kernel("contracted")
def _scaled_surface(  # type: ignore[no-untyped-def]
    hits, triangle, weights, faces, values, points, normals, surface, faded, alpha, share,
    begin, end, out,
):  # fmt: skip
    """Sum what the rays of samples [begin, end) meet, each scaled."""
    unit = np.float32(1 / _WEIGHTS)
    for i in range(begin, end):
        out[i] = np.float32(0)
        for k in range(hits[i], hits[i + 1]):
            f = triangle[k]
            a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
            second, third = weights[k, 0] * unit, weights[k, 1] * unit
            first = max(np.float32(1) - second - third, np.float32(0))
            along = square = 0.0
            for axis in range(3):
                step = (
                    first * surface[a, axis] + second * surface[b, axis]
                    + third * surface[c, axis] - points[i, axis]
                )  # fmt: skip
                along += step * normals[i, axis]
                square += step * step
            cosine = np.float32(along / np.sqrt(square)) if square > 0 else np.float32(0)
            factor = share * _factor(cosine, faded[i], alpha)
            for channel in range(values.shape[1]):
                out[i, channel] += factor * (
                    first * values[a, channel] + second * values[b, channel]
                    + third * values[c, channel]
                )  # fmt: skip


@kernel("contracted")
def _scaled_sky(  # type: ignore[no-untyped-def]
    misses, sky, colors, directions, normals, faded, alpha, share, begin, end, out,
):  # fmt: skip
    """Sum the sky that the rays of samples [begin, end) see, each scaled."""
    for i in range(begin, end):
        out[i] = np.float32(0)
        for k in range(misses[i], misses[i + 1]):
            c = sky[k]
            cosine = (
                directions[c, 0] * normals[i, 0] + directions[c, 1] * normals[i, 1]
                + directions[c, 2] * normals[i, 2]
            )  # fmt: skip
            factor = share * _factor(cosine, faded[i], alpha)
            for channel in range(3):
                out[i, channel] += factor * colors[c, channel]
