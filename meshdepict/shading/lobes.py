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

# The blur's variance over a sample's solid angle. An even disc has 0.08. Measured on four
# panoramas: at 0.1 the sum over a lattice of samples ripples where one pixel has most of the light
# (4 grey levels), at 0.25 that is gone and the widening of the lobe hardly shows.
_SPREAD = 0.25
# Points that are seen at a smaller cosine have more samples: half vectors crowd round the horizon
# there and half of them fall below it. Chosen by error and cost on the bunny.
_RIM = 0.3
_MORE_AT_RIM = 3
_NARROWER = 0.3  # copies than the narrowest cell head-on needs, for those cells
_MORE_ALIGNED = 4  # lobes are wider before lights are aligned


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
    total = np.zeros((normals.shape[2], 1), np.float32)
    for between, samples in _parts(kind, count):
        total = total + _summed(
            normals[:1], eyes, environment, kind, parameters,
            lobe_tables(kind, parameters, scaling, samples), between=between,
            frames=frames, warping=warping, scaling=scaling,
        )  # fmt: skip
    return total


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
    total = np.zeros((normals.shape[2], 1), np.float32)
    for between, samples in _parts(kind, _MORE_ALIGNED * count):
        total = total + _summed(
            normals, eyes, environment, kind, parameters,
            aligned_tables(kind, parameters, strengths, samples), between=between,
            strengths=strengths, sharpness=sharpness,
        )  # fmt: skip
    return total


def _parts(kind: int, count: int) -> list[tuple[tuple[float, float], int]]:
    """Return how many samples points have, by their cosine to the eye."""
    if not half_vector_axis(kind):
        return [((-1.0, 2.0), count)]
    return [((_RIM, 2.0), count), ((-1.0, _RIM), _MORE_AT_RIM * count)]


def _summed(
    normals: Single,
    eyes: Single,
    environment: Environment,
    kind: int,
    parameters: Single,
    tables: LobeTables,
    *,
    between: tuple[float, float],
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
    halves = half_vector_axis(kind) and strengths is None
    exact = sharpness > SINGLE
    precision = np.float64 if exact else np.float32
    widest = np.float32(WIDEST**2 / _SPREAD * math.sqrt(2))
    finest = math.sqrt(_SPREAD * float(tables.solids.min()))
    blurs = environment.blurs(finest * (_NARROWER if halves else 1))
    arguments = (
        normals, eyes, kind, parameters, halves, *frames,
        np.array([warping, *scaling], np.float32),
        np.zeros(0, precision) if strengths is None else strengths.astype(precision),
        precision(math.exp(-sharpness)), exact, *tables, *blurs,
        np.ascontiguousarray(upright(environment.up).T, np.float32), widest,
        np.array(between, np.float32),
    )  # fmt: skip
    pieces = 4 * thread_count() if count * tables.cosines.shape[1] > 20_000 else 1
    each(lambda a, b: sum_lobes(*arguments, out, a, b), spans(count, pieces))
    return out[:, :1] if environment.gray else out
