"""Where in a lobe the samples lie, and what solid angle each stands for.

A lobe has an axis: the normal, about which half vectors lie, or the mirrored line of sight, about
which directions do. Samples follow the lobe's own profile, scaled as Radiance Scaling scales it,
by inverting its integral; round the axis they turn by the golden angle.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.shading.features import Scaling
from meshdepict.shading.material_kinds import COOK_TORRANCE, PHONG
from meshdepict.shading.scaling_equation import scaling as scaled

__all__ = [
    "MOST_PARTS",
    "WIDE",
    "LobeTables",
    "aligned_tables",
    "half_vector_axis",
    "lobe_tables",
]

Floats = NDArray[np.float64]

MOST_PARTS = 2
"""Into how many the sample of a half vector is parted at a grazing angle."""
WIDE = 16
"""Samples that go through vector registers together; those left over take ten times as long."""

_ROWS = 33  # values of κ from −1 to 1 that have samples of their own
_NODES = 512  # of the profile, evenly spread over the logarithm of 1 − cos
_NARROWEST = 1e-9
_EVERYWHERE = 0.02  # of the samples lie beyond the profile: what it does not know of is met, too
# The samples' density is the profile's power: even in energy, those in the tail would be so large
# that they smear bright things into what is dark (studio: 2.7 grey levels, now 1.7).
_FLATTER = 0.65
_GOLDEN = math.pi * (3 - math.sqrt(5))


class LobeTables(NamedTuple):
    """Samples of a lobe, a row for each κ.

    Attributes
    ----------
    cosines : (rows, count) array
        To the axis.
    solids : (rows, count) array
        Solid angles about the axis that they stand for.
    turns : (2, count) array
        Cosine and sine of the angle round the axis.
    lobe : (rows, count) array
        What `meshdepict.shading.material_kernel.specular_of_halves` wants to know of them.
    """

    cosines: NDArray[np.float32]
    solids: NDArray[np.float32]
    turns: NDArray[np.float32]
    lobe: NDArray[np.float32]


def half_vector_axis(kind: int) -> bool:
    """Whether a material's lobe is one of half vectors about the normal."""
    return kind != PHONG


def lobe_tables(
    kind: int, parameters: NDArray[np.float32], scaling: Scaling, count: int
) -> LobeTables:
    """Return samples of a material's lobe, in a row for every κ where it is scaled.

    Parameters
    ----------
    kind : int
        One of `material_kinds` that have highlights.
    parameters : (3,) array
        Of `kernel_parameters`.
    scaling : Scaling
    count : int
    """
    away = np.append(0, np.geomspace(_NARROWEST, 1, _NODES))
    lobe = _lobe(kind, float(parameters[2]), 1 - away)
    found = lobe[None]
    if scaling.specular:
        delta = lobe if kind == PHONG else 1 - away
        kappa = np.linspace(-1, 1, _ROWS)[:, None]
        factor = scaled(kappa, delta, invariant=scaling.invariant, magnitude=scaling.specular)
        found = lobe * factor
    tables = _tables(away, found, count)
    power = float(parameters[2])
    size = power**-2 if kind == COOK_TORRANCE else (power + 1) / 8
    known = size * _lobe(kind, power, tables.cosines.astype(np.float64))
    return tables._replace(lobe=known.astype(np.float32))


def aligned_tables(
    kind: int, parameters: NDArray[np.float32], strengths: Floats, count: int
) -> LobeTables:
    """Return samples about the mirrored line of sight for lights that are then aligned with it.

    Alignment turns lights towards the guides, so a lobe collects them from further off: a light
    within angle θ of it was, before, within θ / Π (1 − strength_i) of it at most. Where and how far
    depends on the light: samples follow lobes of all widths in between alike.
    """
    away = np.append(0, np.geomspace(_NARROWEST, 2, _NODES))
    angle = np.arccos(np.clip(1 - away, -1, 1))
    least = max(float(np.prod(1 - np.clip(strengths, 0, 0.9))), 0.05)
    profile = np.zeros_like(away)
    for share in np.geomspace(1, least, 8):
        within = angle * share / (2 if half_vector_axis(kind) else 1)
        lobe = _lobe(kind, float(parameters[2]), np.maximum(np.cos(within), 0))
        profile += lobe / max(float(np.trapezoid(lobe, away)), 1e-300)
    return _tables(away, profile[None], count)


def _lobe(kind: int, parameter: float, cosine: Floats) -> Floats:
    """Return the profile over the cosine to the axis, 1 at the axis."""
    if kind == COOK_TORRANCE:
        squared = np.maximum(cosine**2, 1e-4)
        return np.exp((squared - 1) / (squared * parameter**2)) / squared**2
    return np.asarray(cosine**parameter)


def _tables(away: Floats, profiles: Floats, count: int) -> LobeTables:
    """Invert the integrals of profiles (rows, nodes) over 1 − cos."""
    shares = (np.arange(count) + 0.5) / count
    cosines, solids = np.empty((2, len(profiles), count))
    for row, profile in enumerate(profiles**_FLATTER):
        steps = (profile[1:] + profile[:-1]) / 2 * np.diff(away)
        total = float(steps.sum())
        density = (1 - _EVERYWHERE) * profile / total + _EVERYWHERE / away[-1]
        steps = (density[1:] + density[:-1]) / 2 * np.diff(away)
        before = np.append(0, np.cumsum(steps))
        place = np.interp(shares, before / before[-1], away)
        cosines[row] = 1 - place
        solids[row] = 2 * math.pi / (count * np.interp(place, away, density))
    angle = _GOLDEN * np.arange(count)
    turns: Any = np.stack([np.cos(angle), np.sin(angle)])
    none = np.empty((len(profiles), 0))
    return LobeTables(*(part.astype(np.float32) for part in (cosines, solids, turns, none)))
