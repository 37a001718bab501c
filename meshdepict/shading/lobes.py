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
from meshdepict.shading.lobe_samples import LobeSamples, summed
from meshdepict.shading.lobe_tables import (
    MOST_PARTS,
    LobeTables,
    aligned_tables,
    half_vector_axis,
    lobe_tables,
)
from meshdepict.shading.material_kinds import PHONG
from meshdepict.shading.sharpness import SINGLE

__all__ = [
    "aligned_lobes",
    "aligned_samples",
    "lobe_samples",
    "lobes",
    "needs_samples",
]

Single = NDArray[np.float32]

# The blur's variance over a sample's solid angle. An even disc has 0.08. Measured on four
# panoramas: at 0.1 the sum over a lattice of samples ripples where one pixel has most of the light
# (4 grey levels), at 0.25 that is gone and the widening of the lobe hardly shows.
_SPREAD = 0.25
# Points that are seen at a smaller cosine have more samples: half vectors crowd round the horizon
# there and half of them fall below it. Chosen by error and cost on the bunny.
_RIM = 0.3
_MORE_AT_RIM = 3.0
# Exponents of Phong's lobe that lights serve: at 20 it is half as bright at 15°, below 1 it ends in
# an edge. Measured on four panoramas, docs/environments.md.
_WIDE = (1.0, 20.0)
_NARROWER = 0.3  # copies than the narrowest cell head-on needs, for those cells
# Lobes are wider before lights are aligned. Where alignment is mild it is undone from samples in
# the lobe; a strong one leads so many lights to one place that those about the lobe are aligned.
_MORE_UNDONE, _MORE_UNDONE_AT_RIM = 1.78, 1.67  # 96 and 160 of 54: whole registers
_MORE_ALIGNED = 4
_MILD = 0.1  # of an angle to the guide is left by all strengths together


def needs_samples(environment: Environment, kind: int, parameters: Single) -> bool:
    """Whether highlights are sampled; else the lights that stand for the environment serve them.

    That is a question of the lobe's width where it is narrowest. Phong's is the same everywhere:
    up to an exponent of 20 lights are within a grey level if the matt term has as much weight, and
    below 1 it ends in an edge. Those of facets get as narrow as the line of sight gets flat,
    however rough they are.

    Parameters
    ----------
    environment : Environment
    kind, parameters
        As `meshdepict.shading.direct.kernel_parameters` returns them.
    """
    if environment.sampling == "lights" or kind < PHONG or not parameters[1] > 0:
        return False
    diffuse, specular, exponent = parameters.tolist()
    return kind != PHONG or specular > diffuse or not _WIDE[0] <= exponent <= _WIDE[1]


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
    parts = lobe_samples(
        normals, eyes, environment, kind, parameters, count=count, frames=frames, warping=warping,
        scaling=scaling,
    )  # fmt: skip
    return summed(parts, environment)


def lobe_samples(
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
) -> list[LobeSamples]:
    """Return the samples that `lobes` sums: of points seen head-on, and of those near the rim."""
    return [
        _samples(
            normals[:1], eyes, environment, kind, parameters,
            lobe_tables(kind, parameters, scaling, samples), between=between,
            frames=frames, warping=warping, scaling=scaling,
        )
        for between, samples in _parts(kind, count)
    ]  # fmt: skip


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
    """Return Σ ρ_s L over the lobe of every point, whose light is aligned before.

    Parameters
    ----------
    normals : (S, 3, n) array
        Of every scale.
    count : int
        Half of the samples or a quarter: lobes are wider before alignment.
    strengths : (S − 1,) array
        Finest first.
    sharpness : float
        γ.
    """
    parts = aligned_samples(
        normals, eyes, environment, kind, parameters, count=count, strengths=strengths,
        sharpness=sharpness,
    )  # fmt: skip
    return summed(parts, environment)


def aligned_samples(
    normals: Single,
    eyes: Single,
    environment: Environment,
    kind: int,
    parameters: Single,
    *,
    count: int,
    strengths: NDArray[np.float64],
    sharpness: float,
) -> list[LobeSamples]:
    """Return the samples that `aligned_lobes` sums."""
    undone = sharpness <= SINGLE and float(np.prod(1 - strengths)) >= _MILD
    parts = (
        _parts(kind, _MORE_UNDONE * count, _MORE_UNDONE_AT_RIM)
        if undone
        else _parts(kind, _MORE_ALIGNED * count)
    )
    found = []
    for between, samples in parts:
        tables = (
            lobe_tables(kind, parameters, Scaling(), samples)
            if undone
            else aligned_tables(kind, parameters, strengths, samples)
        )
        found.append(
            _samples(
                normals, eyes, environment, kind, parameters, tables, between=between,
                strengths=strengths, sharpness=sharpness, undone=undone,
            )
        )  # fmt: skip
    return found


def _parts(
    kind: int, count: float, at_rim: float = _MORE_AT_RIM
) -> list[tuple[tuple[float, float], int]]:
    """Return how many samples points have, by their cosine to the eye."""
    if not half_vector_axis(kind):
        return [((-1.0, 2.0), int(count))]
    return [((_RIM, 2.0), int(count)), ((-1.0, _RIM), int(at_rim * count))]


def _samples(
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
    undone: bool = False,
) -> LobeSamples:
    """Return given samples; with strengths, each is aligned before it is shaded.

    Or it is shaded where it lies, and alignment is undone.
    """
    if frames is None:
        none, frame = np.empty(0, np.float32), np.empty((0, 3), np.float32)
        frames = Frames(none, none, frame, frame, frame)
    halves = half_vector_axis(kind) and (strengths is None or undone)
    exact = sharpness > SINGLE
    precision = np.float64 if exact else np.float32
    widest = np.float32(WIDEST**2 / _SPREAD * math.sqrt(2))
    finest = math.sqrt(_SPREAD * float(tables.solids.min()))
    blurs = environment.blurs(finest * (_NARROWER if halves else 1))
    arguments = (
        normals, eyes, kind, parameters, halves, *frames,
        np.array([warping, *scaling], np.float32),
        np.zeros(0, precision) if strengths is None else strengths.astype(precision),
        precision(math.exp(-sharpness)), exact, undone, *tables, *blurs,
        np.ascontiguousarray(upright(environment.up).T, np.float32), widest,
        np.array(between, np.float32),
    )  # fmt: skip
    parts = MOST_PARTS if halves else 1
    return LobeSamples(arguments, normals.shape[2], tables.cosines.shape[1], parts, blurs.texels)
