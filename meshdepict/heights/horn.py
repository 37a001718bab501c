"""Slopes of heights after Horn (1981), and the shades of relief maps that are made of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.heights.map_rules import MARK_AZIMUTHS, MARK_ELEVATION
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["horn_slopes", "mark_relief", "mark_shades", "relief"]

Singles = NDArray[np.float32]
Floats = NDArray[np.float64]

_ROWS = 64  # rows of a piece of work
_STEEPEST = 1e15  # heights a cell; its square is still a number in single precision


def horn_slopes(z: NDArray[Any], valid: NDArray[np.bool_] | None, steps: Floats) -> Singles:
    """Return the slopes of heights: differences weighted 1-2-1 across, as Horn (1981) has them.

    Where a cell is missing, the difference to the other side's is taken, and a row or column of the
    3 × 3 window that has none weighs nothing: a plane has its slope everywhere, at the border and
    beside no-data too. Along an axis that has no neighbour at all, a cell is level.

    Parameters
    ----------
    z : (rows, cols) array of float32 or float64
        Heights in metres; finite, anything where not valid.
    valid : (rows, cols) array of bool, optional
        Which cells hold a height; all of them unless given.
    steps : (rows or 1, 2, 2) array
        Metres (east, north) of a step along [column, row].

    Returns
    -------
    (2, rows, cols) array of float32
        Metres of height a metre to the east and to the north; 0 where not valid.
    """
    out = np.zeros((2, *z.shape), np.float32)
    _swept(_slopes, z, valid, steps, np.zeros(3), out)
    return out


def relief(
    z: NDArray[Any], valid: NDArray[np.bool_] | None, steps: Floats, light: ArrayLike
) -> Singles:
    """Return the cosines between Horn's normals and a light: cos z cos s + sin z sin s cos(a − b).

    Parameters
    ----------
    z, valid, steps
        As for `horn_slopes`.
    light : (3,) array_like
        Unit vector (east, north, up) towards the light.

    Returns
    -------
    (rows, cols) array of float32
        In [−1, 1]; 0 where not valid.
    """
    out = np.zeros((1, *z.shape), np.float32)
    _swept(_cosines, z, valid, steps, np.asarray(light, np.float64), out)
    return out[0]


def mark_relief(
    z: NDArray[Any],
    valid: NDArray[np.bool_] | None,
    steps: Floats,
    elevation: float = MARK_ELEVATION,
) -> Singles:
    """Return the shade under four lights after Mark (1992), each where it grazes a slope.

    Σ ½ sin²(aspect − azimuth) max(0, n·l), lights from 225°, 270°, 315° and 360°.

    Parameters
    ----------
    z, valid, steps
        As for `horn_slopes`.
    elevation : float
        Of the lights above the horizon, in degrees.

    Returns
    -------
    (rows, cols) array of float32
        In [0, 1], the sine of the elevation where level; 0 where not valid.
    """
    out = np.zeros((1, *z.shape), np.float32)
    height = math.radians(elevation)
    _swept(_marks, z, valid, steps, np.array([math.cos(height), math.sin(height), 0]), out)
    return out[0]


def mark_shades(normals: NDArray[Any], elevation: float = MARK_ELEVATION) -> Singles:
    """Return the shade of normals (n, 3) in the map's frame under the lights of `mark_relief`."""
    east, north, up = normals.astype(np.float32).T
    squared = np.maximum(east * east + north * north, np.float32(1e-30))
    height = math.radians(elevation)
    shades = np.zeros(len(normals), np.float32)
    for azimuth in MARK_AZIMUTHS:
        turn = math.radians(azimuth)
        along = east * np.float32(math.sin(turn)) + north * np.float32(math.cos(turn))
        cosine = up * np.float32(math.sin(height)) + along * np.float32(math.cos(height))
        shades += np.maximum(cosine, 0) * (1 - along * along / squared) / 2
    level = squared <= np.float32(1e-30)
    return np.where(level, np.maximum(up * np.float32(math.sin(height)), 0), shades)


def _swept(
    shade: Any, z: NDArray[Any], valid: NDArray[np.bool_] | None, steps: Floats,
    light: Floats, out: Singles,
) -> None:  # fmt: skip
    """Run a kernel over all rows."""
    mask = np.empty((0, 0), np.bool_) if valid is None else valid
    inverse = np.linalg.inv(steps).astype(np.float32)  # from slopes a cell to slopes a metre
    light = light.astype(np.float32)

    def work(begin: int, end: int) -> None:
        lines = np.empty((2, z.shape[1]), np.float32)
        shade(z, mask, inverse, light, lines, out, begin, end)

    each(work, spans(len(z), max(thread_count(), len(z) // _ROWS)))


@kernel("contracted", inline=True)
def _side(a, m, b, has_a, has_m, has_b):  # type: ignore[no-untyped-def]
    """Difference a cell from a over m to b, and whether there is one."""
    if has_a and has_b:
        return (b - a) * 0.5, 1
    if has_m and has_b:
        return b - m, 1
    if has_a and has_m:
        return m - a, 1
    return (m - m), 0


@kernel("contracted")
def _one(z, mask, r, c):  # type: ignore[no-untyped-def]
    """Slopes of a cell, per column and per row, where neighbours may be missing."""
    rows, cols = z.shape
    across = along = z[r, c] - z[r, c]
    weights_across = weights_along = 0
    for k in range(-1, 2):
        weight = 2 - abs(k)
        if 0 <= r + k < rows:
            has_a = c > 0 and (mask.size == 0 or mask[r + k, c - 1])
            has_m = mask.size == 0 or mask[r + k, c]
            has_b = c + 1 < cols and (mask.size == 0 or mask[r + k, c + 1])
            low, high = max(c - 1, 0), min(c + 1, cols - 1)
            step, there = _side(z[r + k, low], z[r + k, c], z[r + k, high], has_a, has_m, has_b)
            if there:
                across += weight * step
                weights_across += weight
        if 0 <= c + k < cols:
            has_a = r > 0 and (mask.size == 0 or mask[r - 1, c + k])
            has_m = mask.size == 0 or mask[r, c + k]
            has_b = r + 1 < rows and (mask.size == 0 or mask[r + 1, c + k])
            low, high = max(r - 1, 0), min(r + 1, rows - 1)
            step, there = _side(z[low, c + k], z[r, c + k], z[high, c + k], has_a, has_m, has_b)
            if there:
                along += weight * step
                weights_along += weight
    return (
        np.float32(across / weights_across if weights_across else across),
        np.float32(along / weights_along if weights_along else along),
    )


@kernel("contracted")
def _line(z, mask, inverse, r, lines):  # type: ignore[no-untyped-def]
    """Find the slopes of row r to the east and to the north."""
    rows, cols = z.shape
    line = inverse[min(r, len(inverse) - 1)]
    xc, xr, yc, yr = line[0, 0], line[1, 0], line[0, 1], line[1, 1]
    most = np.float32(_STEEPEST)
    whole = 0 < r < rows - 1
    if whole:
        up, here, down = z[r - 1], z[r], z[r + 1]
        eighth = np.float32(0.125)
        for c in range(1, cols - 1):
            # Differences first: they are exact however high the land is.
            across = np.float32(
                (up[c + 1] - up[c - 1])
                + (here[c + 1] - here[c - 1])
                + (here[c + 1] - here[c - 1])
                + (down[c + 1] - down[c - 1])
            )
            along = np.float32(
                (down[c - 1] - up[c - 1])
                + (down[c] - up[c])
                + (down[c] - up[c])
                + (down[c + 1] - up[c + 1])
            )
            across = min(max(across * eighth, -most), most)
            along = min(max(along * eighth, -most), most)
            lines[0, c] = xc * across + xr * along
            lines[1, c] = yc * across + yr * along
    for c in range(cols):
        if whole and 0 < c < cols - 1:
            if mask.size == 0:
                continue
            every = True
            for k in range(r - 1, r + 2):
                every &= mask[k, c - 1] & mask[k, c] & mask[k, c + 1]
            if every:
                continue
        across, along = _one(z, mask, r, c)
        across, along = min(max(across, -most), most), min(max(along, -most), most)
        lines[0, c] = xc * across + xr * along
        lines[1, c] = yc * across + yr * along


@kernel("contracted")
def _slopes(z, mask, inverse, light, lines, out, begin, end):  # type: ignore[no-untyped-def]
    for r in range(begin, end):
        _line(z, mask, inverse, r, lines)
        for c in range(z.shape[1]):
            if mask.size == 0 or mask[r, c]:
                out[0, r, c], out[1, r, c] = lines[0, c], lines[1, c]


@kernel("contracted")
def _cosines(z, mask, inverse, light, lines, out, begin, end):  # type: ignore[no-untyped-def]
    x, y, up, one = light[0], light[1], light[2], np.float32(1)
    for r in range(begin, end):
        _line(z, mask, inverse, r, lines)
        east, north, shade = lines[0], lines[1], out[0, r]
        for c in range(z.shape[1]):
            p, q = east[c], north[c]
            shade[c] = (up - x * p - y * q) / math.sqrt(one + p * p + q * q)
        if mask.size > 0:
            for c in range(z.shape[1]):
                if not mask[r, c]:
                    shade[c] = 0


@kernel("contracted")
def _marks(z, mask, inverse, light, lines, out, begin, end):  # type: ignore[no-untyped-def]
    level, up = light[0], light[1]
    half, one, zero = np.float32(0.5), np.float32(1), np.float32(0)
    root, least = np.float32(math.sqrt(0.5)), np.float32(1e-15)
    for r in range(begin, end):
        _line(z, mask, inverse, r, lines)
        east, north, shade = lines[0], lines[1], out[0, r]
        for c in range(z.shape[1]):
            p, q = east[c], north[c]
            square = p * p + q * q
            steep = np.float32(math.sqrt(square))
            down = one / np.float32(math.sqrt(one + square))
            # Cosines between what is uphill and 225°, 270°, 315° and 360°; 0 where level.
            p, q = p / max(steep, least), q / max(steep, least)
            a, b, d, e = -(p + q) * root, -p, (q - p) * root, q
            high, rise = up * down, level * steep * down
            shade[c] = (
                half
                * (
                    (one - a * a) * max(zero, high - rise * a)
                    + (one - b * b) * max(zero, high - rise * b)
                    + (one - d * d) * max(zero, high - rise * d)
                    + (one - e * e) * max(zero, high - rise * e)
                )
                if steep > least
                else high
            )
        if mask.size > 0:
            for c in range(z.shape[1]):
                if not mask[r, c]:
                    shade[c] = 0
