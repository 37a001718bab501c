"""Anisotropic diffusion of a picture's slopes (Light Warping, §4.3, alg. 1; Perona and Malik 1990).

    g ← g + dt Σ_{4 neighbours} min(c_p, c_q)(g_q − g_p)

c is the conductance, 0 on silhouettes and creases. Where it is 1, k steps are a Gaussian of
width √(2·dt·k) pixels.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.shapes.gbuffer import GBuffer

__all__ = ["MOST_STEPS", "STEP", "diffuse", "diffusion_steps", "diffusion_width", "step_count"]

Singles = NDArray[np.float32]

MOST_STEPS = 20_000  # a width of 89 pixels: half a minute for a picture of 800 × 600
STEP = 0.2  # dt: below ¼, above which the scheme is unstable
_STEEPEST = 0.01  # n_z is held at this where the surface turns away from the eye


def diffusion_width(iterations: int) -> float:
    """Return the width in pixels of the Gaussian that so many steps of 0.2 are."""
    return math.sqrt(2 * STEP * iterations)


def step_count(width: float) -> int:
    """Return the number of steps, of 0.2 at most, that make a width in pixels."""
    return max(1, math.ceil(width**2 / 2 / STEP - 1e-9))


def diffusion_steps(
    gbuffer: GBuffer,
    own: Singles,
    widths: NDArray[np.float64],
    conductance: Singles,
    *,
    importance: Singles | None = None,
) -> Callable[[int, Singles], Singles]:
    """Return what makes a scale's normals (3, n) of diffused slopes, one scale after the other.

    Parameters
    ----------
    gbuffer : GBuffer
        In the frame of whose view slopes are.
    own : (3, n) array of float32
        The unsmoothed normals.
    widths : (scales + 1,) array
        In pixels, the first one 0.
    conductance, importance : (n,) array of float32
    """
    frame = gbuffer.view.frame.astype(np.float32)
    x, y, z = frame @ own
    original = gbuffer.cropped(np.stack([-x, -y]) / np.maximum(z, np.float32(_STEEPEST)))
    stops = gbuffer.cropped(conductance)
    share = None if importance is None else gbuffer.cropped(importance)
    coarsest = 0, original  # slopes, which normals have rounded

    def step(scale: int, before: Singles) -> Singles:
        nonlocal coarsest
        if share is None:  # on from the next finer scale
            known, slopes = coarsest
            if known < scale:
                missing = math.sqrt(widths[scale] ** 2 - widths[known] ** 2)
                slopes = diffuse(slopes, stops, missing)
                coarsest = scale, slopes
        else:
            slopes = diffuse(original, stops, float(widths[scale]), importance=share)
        gx, gy = gbuffer.uncropped(slopes)
        normals = np.stack([-gx, -gy, np.ones_like(gx)])
        return np.asarray(frame.T @ (normals / np.sqrt(gx * gx + gy * gy + 1)))

    return step


def diffuse(
    slopes: Singles,
    conductance: Singles,
    width: float,
    *,
    importance: Singles | None = None,
) -> Singles:
    """Return slopes diffused to a width.

    Parameters
    ----------
    slopes : (c, h, w) array of float32
    conductance : (h, w) array of float32
        In [0, 1]; 0 where there is no surface.
    width : float
        √(2t) in pixels, in steps as equal as they can be, and at most 0.2.
    importance : (h, w) array of float32, optional
        I(p) in [0, 1]: 0 diffuses a pixel all the way, 1 not at all, between them it has the slope
        that all had after the share 1 − I of the steps.

    Returns
    -------
    (c, h, w) array of float32
    """
    count = step_count(width)
    step_size = np.float32(width**2 / 2 / count)
    # A frame of zero conductance, so that every pixel has four neighbours.
    now = np.pad(slopes, ((0, 0), (1, 1), (1, 1)))
    frame = np.pad(conductance, 1)
    after = now.copy()
    result = now.copy() if importance is not None else now
    wanted = None if importance is None else np.rint((1 - importance) * count)
    pieces = [(a + 1, b + 1) for a, b in spans(slopes.shape[1], thread_count())]
    for step in range(1, count + 1):
        pair = now, after  # bound here: the threads end before they change
        each(lambda a, b, pair=pair: _rows(*pair, frame, step_size, a, b), pieces)
        now, after = after, now
        if wanted is not None:
            inner = result[:, 1:-1, 1:-1]
            np.copyto(inner, now[:, 1:-1, 1:-1], where=step <= wanted)
    found = now if wanted is None else result
    return np.ascontiguousarray(found[:, 1:-1, 1:-1])


@kernel("contracted")
def _rows(slopes, after, conductance, step, first, last):  # type: ignore[no-untyped-def]
    for row in range(first, last):
        c = conductance[row]
        up, down = conductance[row - 1], conductance[row + 1]
        for channel in range(len(slopes)):
            g = slopes[channel, row]
            above, below = slopes[channel, row - 1], slopes[channel, row + 1]
            out = after[channel, row]
            for i in range(1, len(c) - 1):
                flow = (
                    min(c[i], up[i]) * (above[i] - g[i])
                    + min(c[i], down[i]) * (below[i] - g[i])
                    + min(c[i], c[i - 1]) * (g[i - 1] - g[i])
                    + min(c[i], c[i + 1]) * (g[i + 1] - g[i])
                )
                out[i] = g[i] + step * flow
