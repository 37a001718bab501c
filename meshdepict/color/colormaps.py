"""Colour maps of one value: this package's own, and those of installed packages by name."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import quantise, srgb_to_linear
from meshdepict.errors import MeshdepictError
from meshdepict.options import nearest

__all__ = ["BUILT_IN", "colormap", "table_of"]

Floats = NDArray[np.floating[Any]]
Bytes = NDArray[np.uint8]

# Colours from dark to light (0 … 255), placed by their lightness so that equal steps look equal.
BUILT_IN = {
    "gray": ((0, 0, 0), (255, 255, 255)),
    "sepia": ((24, 15, 8), (88, 56, 32), (150, 109, 72), (206, 174, 134), (252, 243, 226)),
    "stone": ((22, 23, 28), (84, 83, 86), (142, 136, 130), (199, 190, 178), (252, 249, 243)),
    "gooch": ((10, 16, 84), (48, 70, 138), (118, 128, 140), (196, 182, 108), (255, 243, 140)),
}

# Import name, the prefix under which the package enters its maps in matplotlib, where it has them.
_PACKAGES = (
    ("matplotlib", "mpl.", "colormaps"),
    ("cmcrameri.cm", "cmc.", "cmaps"),
    ("colorcet", "cet_", "palette"),
    ("cmocean.cm", "cmo.", "cmap_d"),
)


def colormap(name: str) -> Bytes:
    """Return a colour map as a table of 256 display colours, first for 0, last for 1.

    Parameters
    ----------
    name : str
        "gray" (the values as they are), "sepia", "stone", "gooch" (dark blue to bright yellow, as
        in ES fig. 1); or a map of matplotlib, cmcrameri, colorcet or cmocean where installed,
        with or without the prefix that they use in matplotlib ("cmc.batlow", "batlow"). With
        "_r" behind it, the other way round.

    Returns
    -------
    (256, 3) array of uint8, read-only

    Raises
    ------
    MeshdepictError
        For an unknown name; the sentence has the nearest known one.
    """
    return table_of(name)


def table_of(name: str) -> Bytes:
    """Return the 256 display colours of a map that `colormap` knows."""
    if not isinstance(name, str):
        raise MeshdepictError(f"a colour map is given by its name, not as {name!r}")
    return _table(name)


@cache
def _table(name: str) -> Bytes:
    forward = name.removesuffix("_r")
    if forward in BUILT_IN:
        table = _between(np.array(BUILT_IN[forward]) / 255)
    else:
        table = _sampled(_installed_map(forward))
    table = table if forward == name else table[::-1]
    table.setflags(write=False)
    return table


def _between(anchors: Floats) -> Bytes:
    """Interpolate display colours (k, 3) to 256, evenly in CIE lightness."""
    luminance = srgb_to_linear(anchors) @ (0.2126, 0.7152, 0.0722)
    lightness = np.where(
        luminance > 216 / 24389, np.cbrt(luminance) * 1.16 - 0.16, luminance * 9.033
    )
    place = (lightness - lightness[0]) / (lightness[-1] - lightness[0])
    steps = np.linspace(0, 1, 256)
    return quantise(np.stack([np.interp(steps, place, channel) for channel in anchors.T], axis=1))


def _installed_map(name: str) -> Any:
    known = list(BUILT_IN)
    named = [package for package in _PACKAGES if name.startswith(package[1])]
    for prefix, maps in _installed(named or _PACKAGES):
        for key in (name, name.removeprefix(prefix)):
            if key in maps:
                return maps[key]
        known += maps
    raise MeshdepictError(
        f"no colour map {name!r}{nearest(name, known)} (built in: {', '.join(BUILT_IN)}; more "
        "from matplotlib, cmcrameri, colorcet and cmocean where installed)"
    )


def _installed(packages: Iterable[tuple[str, str, str]]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Import the packages of colour maps one by one, as long as the caller keeps asking."""
    for module, prefix, attribute in packages:
        try:
            with warnings.catch_warnings():  # theirs, about one another's versions
                warnings.simplefilter("ignore")
                maps = getattr(importlib.import_module(module), attribute)
        except ImportError:
            continue
        yield prefix, maps


def _sampled(found: Any) -> Bytes:
    """Take 256 colours of a matplotlib colour map or of a list of "#rrggbb"."""
    if callable(found):
        return quantise(found(np.linspace(0, 1, 256))[:, :3])
    colors = np.array([list(bytes.fromhex(color[1:])) for color in found], np.uint8)
    return colors[np.linspace(0, len(colors) - 1, 256).round().astype(np.intp)]
