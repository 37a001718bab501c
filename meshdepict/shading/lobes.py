"""Highlights under an environment: lobes sampled where they are, at every point.

Lights that stand for an environment are chosen for what is matt, and a lobe may fall between them.
So a lobe is sampled instead: half vectors, or directions about the mirrored line of sight, in a
spiral of low discrepancy that follows the lobe's profile; each looks up the environment at a blur
that fits the solid angle it stands for.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.blurs import WIDEST
from meshdepict.scene.environment import Environment
from meshdepict.scene.upright import upright
from meshdepict.shading.features import Frames, Scaling
from meshdepict.shading.lobe_tables import (
    LobeTables,
    aligned_tables,
    half_vector_axis,
    lobe_tables,
)
from meshdepict.threads import each, spans, thread_count

__all__ = ["aligned_lobes", "lobes"]

Single = NDArray[np.float32]

# The blur's variance over a sample's solid angle. An even disc has 0.08; at 0.2 the sum over a
# lattice of samples ripples by a tenth where one pixel has all the light, and the lobe is widened
# by a 1/(15 count) of its own variance or so.
_SPREAD = 0.2
_MORE = 4


def lobes(
    normals: Single,
    eyes: Single,
    environment: Environment,
    kind: int,
    parameters: Single,
    *,
    count: int,
    frames: Frames | None = None,
    warping: float = 0.0,
    scaling: Scaling = Scaling(),  # noqa: B008 (immutable)
) -> Single:
    """Return Σ ρ_s scaling L over the lobe of every point.

    Parameters
    ----------
    normals : (S, 3, n) array
    eyes : (3, n) or (3, 1) array
    environment : Environment
    kind, parameters
        As `meshdepict.shading.direct.kernel_parameters` returns them.
    count : int
        Samples in each lobe.
    frames, warping, scaling
        As for `meshdepict.shading.many_lights_kernel.sum_lights`.

    Returns
    -------
    (n, 3) array, (n, 1) where the environment is gray
    """
    tables = lobe_tables(kind, parameters, scaling, count)
    return _summed(
        normals[:1], eyes, environment, kind, parameters, tables,
        halves=half_vector_axis(kind), frames=frames, warping=warping, scaling=scaling,
    )  # fmt: skip


def aligned_lobes(
    normals: Single,
    eyes: Single,
    environment: Environment,
    kind: int,
    parameters: Single,
    *,
    count: int,
    strengths: NDArray[np.float64],
    sharpness: float,
) -> Single:
    """Return Σ ρ_s L over the lobe of every point, each sample a light that is aligned first.

    Parameters
    ----------
    normals : (S, 3, n) array
        Of every scale.
    count : int
        A quarter of the samples: lobes are wider before alignment.
    strengths : (S − 1,) array
        Finest first.
    sharpness : float
        γ.
    """
    tables = aligned_tables(kind, parameters, strengths, _MORE * count)
    return _summed(
        normals, eyes, environment, kind, parameters, tables,
        halves=False, strengths=strengths, sharpness=sharpness,
    )  # fmt: skip


def _summed(
    normals: Single,
    eyes: Single,
    environment: Environment,
    kind: int,
    parameters: Single,
    tables: LobeTables,
    *,
    halves: bool,
    frames: Frames | None = None,
    warping: float = 0.0,
    scaling: Scaling = Scaling(),  # noqa: B008 (immutable)
    strengths: NDArray[np.float64] | None = None,
    sharpness: float = 0.0,
) -> Single:
    """Return the sum over given samples; with strengths, each is aligned before it is shaded."""
    from meshdepict.shading.alignment_kernel import SINGLE
    from meshdepict.shading.lobe_kernel import sum_lobes

    count = normals.shape[2]
    out = np.zeros((count, 3), np.float32)
    if frames is None:
        none, frame = np.empty(0, np.float32), np.empty((0, 3), np.float32)
        frames = Frames(none, none, frame, frame, frame)
    exact = sharpness > SINGLE
    precision = np.float64 if exact else np.float32
    widest = np.float32(WIDEST**2 / _SPREAD)
    blurs = environment.blurs(math.sqrt(_SPREAD * float(tables.solids.min())))
    arguments = (
        normals, eyes, kind, parameters, halves, *frames,
        np.array([warping, *scaling], np.float32),
        np.zeros(0, precision) if strengths is None else strengths.astype(precision),
        precision(math.exp(-sharpness)), exact, *tables, *blurs[:4],
        np.ascontiguousarray(upright(environment.up).T, np.float32), widest,
    )  # fmt: skip
    pieces = 4 * thread_count() if count * tables.cosines.shape[1] > 20_000 else 1
    each(lambda a, b: sum_lobes(*arguments, out, a, b), spans(count, pieces))
    return out[:, :1] if environment.gray else out
