"""Which transfer function a volume gets: the presets, and the way from raw to Hounsfield units."""

from __future__ import annotations

import functools
import math
import os
import tomllib
import warnings
from collections.abc import Mapping
from importlib import resources
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.hounsfield import AIR
from meshdepict.color.transfer_function import TransferFunction
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.options import nearest

__all__ = ["PRESETS", "TransferFunction", "for_volume", "landmarks", "preset"]

PRESETS = ("bone", "skin", "muscle", "lung", "micro-ct")
"""Names of the transfer functions in Hounsfield units that come with the program."""


class Measured(Protocol):
    """A volume as far as its numbers tell what they mean."""

    hounsfield: bool
    values: NDArray[Any]

    @property
    def unit(self) -> str:
        """Return "HU" or "raw"."""

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest value."""

    @property
    def n_samples(self) -> int:
        """Number of voxels."""


_SAMPLE = 1 << 20  # voxels that the median of air and object is taken from
_SOFT = 500.0  # HU: presets of a denser material are for what has no soft tissue
_DENSER = 1.5  # times as far above air has the densest hundredth: an engine 1.2, heads 1.8 and 2.2
_SEEN = 0.1  # opacity that counts as shown
_NEARLY_ALL = 0.9  # of all voxels, air and table among them


def preset(name: str) -> TransferFunction:
    """Return the preset of a name, in Hounsfield units.

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """
    if not isinstance(name, str) or name not in PRESETS:
        raise MeshdepictError(
            f"no transfer function is called {name!r}{nearest(name, PRESETS)} (there are "
            f"{', '.join(PRESETS)}, and files that end in .toml)"
        )
    return _presets()[name]


@functools.cache
def _presets() -> Mapping[str, TransferFunction]:
    text = resources.files("meshdepict.color").joinpath("presets.toml").read_text(encoding="utf-8")
    tables = tomllib.loads(text)
    return {name: TransferFunction.of_table(table, name) for name, table in tables.items()}


def for_volume(
    transfer: str | os.PathLike[str] | TransferFunction,
    volume: Measured,
    *,
    slope: float | None = None,
    intercept: float | None = None,
) -> TransferFunction:
    """Return a transfer function in the unit of a volume.

    CT numbers are linear in what they measure, so two landmarks take raw numbers to Hounsfield
    units: the median of air (−1000) and the median of the object (`material`), on either side of
    Otsu's threshold. A warning says which were found.

    Parameters
    ----------
    transfer : str, path-like or TransferFunction
        A preset's name, the path of a .toml file, or a function.
    volume : Volume
    slope, intercept : float, optional
        HU = slope · raw + intercept, where known; one alone takes 1 or 0 for the other.

    Raises
    ------
    MeshdepictError
        For an unknown name, a function of raw numbers with a volume in Hounsfield units, and a
        slope or intercept with either.
    """
    if not isinstance(transfer, (TransferFunction, str, os.PathLike)):
        raise MeshdepictError(
            f"transfer={transfer!r} is no transfer function: give a preset's name, a .toml file, "
            "or a TransferFunction"
        )
    if not hasattr(volume, "hounsfield"):
        raise MeshdepictError(f"a {type(volume).__name__} is no Volume")
    if not isinstance(transfer, TransferFunction):
        name = os.fsdecode(transfer)
        is_file = name.lower().endswith(".toml")
        transfer = TransferFunction.from_toml(name) if is_file else preset(name)
    given = slope is not None or intercept is not None
    if given and (volume.hounsfield or transfer.unit == "raw"):
        what = "volume" if volume.hounsfield else "transfer function"
        raise MeshdepictError(
            "slope and intercept turn raw numbers into Hounsfield units, but the "
            f"{what} is in {'Hounsfield units already' if volume.hounsfield else 'raw numbers'}"
        )
    if volume.hounsfield and transfer.unit == "raw":
        raise MeshdepictError(
            f"the transfer function {transfer.name!r} is one of raw numbers, but the volume is in "
            "Hounsfield units"
        )
    if volume.unit == transfer.unit:
        _note_block(transfer, volume)
        return transfer
    if given:
        return transfer.in_raw_numbers(1.0 if slope is None else slope, intercept or 0.0)
    if volume.range[0] <= -900:  # no raw number is negative but by such an offset
        warnings.warn(
            f"the volume doesn't say its unit; with numbers from {volume.range[0]:g} on they are "
            "taken as Hounsfield units",
            MeshdepictWarning,
            stacklevel=2,
        )
        return transfer.in_raw_numbers(1.0, 0.0)
    if volume.values is None:
        raise MeshdepictError(
            "the volume doesn't say its unit, and its numbers aren't at hand, but "
            f"{transfer.name!r} is in Hounsfield units: say hounsfield=True, or take a function of "
            "raw numbers"
        )
    air, material = landmarks(volume)
    slope = (transfer.material - AIR) / (material - air)
    intercept = AIR - slope * air
    found = transfer.in_raw_numbers(slope, intercept)
    warnings.warn(
        f"the volume is not in Hounsfield units: for {transfer.name!r} air is taken as {air:g} and "
        f"what fills most of the object ({transfer.material:g} HU) as {material:g}, that is slope "
        f"{slope:.4g} and intercept {intercept:.4g}; give both if you know them"
        + _soft(transfer, volume, (air, material)),
        MeshdepictWarning,
        stacklevel=2,
    )
    return found


def _soft(transfer: TransferFunction, volume: Measured, ends: tuple[float, float]) -> str:
    """Say where a function for dry bone and stone meets an object that is mostly softer tissue.

    Then what fills most of it isn't the densest that it has by far: bone is twice as far above air
    as tissue is.
    """
    if transfer.material <= _SOFT or transfer.name not in PRESETS:
        return ""
    air, material = ends
    dense = np.percentile(_sampled(volume), 99) - air
    if dense < _DENSER * (material - air):
        return ""
    return (
        f"; denser things than that are in it: if it is soft tissue with bones, {transfer.name!r} "
        "shows nearly all of it as a block, and 'bone' or 'skin' suit it better"
    )


def _note_block(transfer: TransferFunction, volume: Measured) -> None:
    """Say where a preset shows nearly everything, and which one doesn't."""
    if transfer.name not in PRESETS or volume.values is None:
        return
    sample = _sampled(volume)
    shares = {
        name: float((preset(name).opacity(sample) > _SEEN).mean())
        for name in dict.fromkeys((transfer.name, *PRESETS))
    }
    share = shares.pop(transfer.name)
    if share <= _NEARLY_ALL:
        return
    fitting = [name for name, other in shares.items() if 0.001 < other < 0.5]
    advice = f"; {fitting[0]!r} shows {shares[fitting[0]]:.0%}" if fitting else ""
    warnings.warn(
        f"{transfer.name!r} shows nearly everything, {share:.0%} of all voxels, as a block{advice}",
        MeshdepictWarning,
        stacklevel=4,
    )


def _sampled(volume: Measured) -> NDArray[Any]:
    """Return every k-th voxel along each axis, about a million in all."""
    step = math.ceil((volume.n_samples / _SAMPLE) ** (1 / 3))
    values: NDArray[Any] = volume.values[::step, ::step, ::step]
    return values


def landmarks(volume: Measured) -> tuple[float, float]:
    """Return the median values of air and of the object: below and above Otsu's threshold.

    Taken from every k-th voxel along each axis, about a million in all.
    """
    sample = np.sort(_sampled(volume), axis=None).astype(np.float64)
    # Times a power of two, which changes no digit: squares then neither overflow nor vanish.
    scale = math.frexp(max(-sample[0], sample[-1]))[1]
    sample = np.ldexp(sample, -scale)
    cumulated = np.cumsum(sample)
    below = np.arange(1, len(sample))
    above = len(sample) - below
    low, high = cumulated[:-1] / below, (cumulated[-1] - cumulated[:-1]) / above
    between = below * above * (high - low) ** 2.0  # Otsu 1979: the variance between two classes
    between[sample[1:] == sample[:-1]] = -1  # equal values stay together
    cut = int(between.argmax()) + 1
    air, material = (float(np.median(part)) for part in (sample[:cut], sample[cut:]))
    return math.ldexp(air, scale), math.ldexp(material, scale)
