"""How much each ray counts once it is aligned, compiled: all rays of a sample at once."""

from __future__ import annotations

import math

import numpy as np

from meshdepict.shading.lobe_alignment_kernel import align_samples
from meshdepict.shading.weighed_transfer import WHOLE
from meshdepict.threads import kernel

__all__ = ["ray_weights"]

_ZERO, _ONE = np.float32(0), np.float32(1)
_UNIT = np.float32(1 / 65_535)  # of a barycentric coordinate
_TINY = np.float32(1e-30)


@kernel("contracted")
def ray_weights(  # type: ignore[no-untyped-def]
    planes, strengths, fade, exact, rays, hits, triangle, weights, misses, sky, faces, surface,
    points, cells, begin, end, met, away,
):  # fmt: skip
    """Write ⟨n·d'⟩ / (½⟨n·d⟩ + ¼) of the rays of samples [begin, end), as `WeighedTransfer` has it.

    Parameters
    ----------
    planes : (S, 3, n) array
        Normals, fine to coarse.
    strengths : (S − 1,) array
        Of the precision that the chain runs in, as ``fade``.
    fade : float
        e^−γ.
    exact : bool
    rays, hits, triangle, weights, misses, sky, faces, surface, points
        Of a `Transfer`.
    cells : (cells, 3) array
        The directions of the sky's cells.
    met, away : arrays
        Of the rays that meet a face, and of those that get away.
    """
    x, y, z = np.empty(rays, np.float32), np.empty(rays, np.float32), np.empty(rays, np.float32)
    density, guide, base = (
        np.empty(rays, np.float32), np.empty(3, np.float32), np.empty(3, np.float32),
    )  # fmt: skip
    for i in range(begin, end):
        nx, ny, nz = planes[0, 0, i], planes[0, 1, i], planes[0, 2, i]
        count = 0
        for k in range(hits[i], hits[i + 1]):
            f = triangle[k]
            second, third = weights[k, 0] * _UNIT, weights[k, 1] * _UNIT
            first = max(_ONE - second - third, _ZERO)
            a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
            dx = first * surface[a, 0] + second * surface[b, 0] + third * surface[c, 0]
            dy = first * surface[a, 1] + second * surface[b, 1] + third * surface[c, 1]
            dz = first * surface[a, 2] + second * surface[b, 2] + third * surface[c, 2]
            dx, dy, dz = dx - points[i, 0], dy - points[i, 1], dz - points[i, 2]
            size = math.sqrt(dx * dx + dy * dy + dz * dz)
            if size > 0:
                x[count], y[count], z[count] = dx / size, dy / size, dz / size
            else:
                x[count], y[count], z[count] = nx, ny, nz
            count += 1
        through = count
        for k in range(misses[i], misses[i + 1]):
            cell = sky[k]
            x[count], y[count], z[count] = cells[cell, 0], cells[cell, 1], cells[cell, 2]
            count += 1
        for k in range(count):
            cosine = max(nx * x[k] + ny * y[k] + nz * z[k], _ZERO)
            density[k] = np.float32(0.5) * cosine + np.float32(0.25)
        for scale in range(len(strengths) - 1, -1, -1):
            if strengths[scale] > 0:
                for axis in range(3):
                    guide[axis], base[axis] = planes[scale, axis, i], planes[scale + 1, axis, i]
                align_samples(
                    guide, base, strengths[scale], fade, exact, x[:count], y[:count], z[:count]
                )
        for k in range(count):
            cosine = min(max(nx * x[k] + ny * y[k] + nz * z[k], _ZERO), _ONE)
            weight = np.uint16(cosine / density[k] * np.float32(WHOLE) + np.float32(0.5))
            if k < through:
                met[hits[i] + k] = weight
            else:
                away[misses[i] + k - through] = weight
