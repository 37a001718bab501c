"""What a surface shows along its axes: areas, detail, symmetry, and how it would stand.

Measured on a few thousand points spread over the surface, whatever its size, in pictures of a few
pixels: enough for questions that have one of six answers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["AXES", "Aspect", "Footing", "aspects", "footing", "mirrored", "spread"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AXES = ("x", "y", "z", "-x", "-y", "-z")
"""Directions, numbered: axis number % 3, and its negative from 3 on."""

_POINTS = 20_000
_FACES = 200_000  # of more, every second, third, … is looked at
_CELLS = 32  # on a side of a picture: some ten points each
_SKIN = 2 / _CELLS  # so far below the nearest point a cell's points are still seen
_LOW = 0.06  # of half the largest extent: what stands there bears the object
_FLAT = 0.03  # … and lies in a plane
_DOWN = 0.9  # cosine
_FAR = 0.5  # a difference of depths that is as good as another outline
_DIRECTIONS = 32  # in which a footing's outline is measured
# Shares of a low-discrepancy sequence in two dimensions (the plastic number's).
_STEPS = (0.7548776662466927, 0.5698402909980532)


class Aspect(NamedTuple):
    """What is seen from one end of an axis, in squares of the largest extent.

    Attributes
    ----------
    area : float
        That looks at the eye.
    detail : float
        How much its normals turn from cell to cell: angles times lengths.
    depth : (k, k) array
        Towards the eye, −∞ where nothing is.
    """

    area: float
    detail: float
    depth: Floats


class Footing(NamedTuple):
    """How an object would stand with an axis up.

    Attributes
    ----------
    margin : float
        From the plumb line of its centre to the nearest side of what it stands on, in standard
        deviations of its width; below 0 it falls over.
    flat : float
        Share of its surface that lies in the plane that it stands on.
    height : float
        Of its centre above that, in halves of the largest extent.
    """

    margin: float
    flat: float
    height: float


def spread(points: Floats, faces: Ints) -> tuple[Floats, Floats]:
    """Return points (k, 3) spread evenly over triangles, and their unit normals.

    They are centred on their box, whose largest extent becomes 2.
    """
    some = faces[:: 1 + len(faces) // _FACES]
    a, b, c = points[some].swapaxes(0, 1)
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    reached = np.cumsum(area)
    index = np.arange(_POINTS)
    at = np.searchsorted(reached, (index + 0.5) / _POINTS * reached[-1])
    at = np.minimum(at, len(some) - 1)
    u, v = (index * step % 1 for step in _STEPS)
    beyond = u + v > 1
    u, v = np.where(beyond, 1 - u, u)[:, None], np.where(beyond, 1 - v, v)[:, None]
    found = a[at] + u * (b - a)[at] + v * (c - a)[at]
    low, high = found.min(axis=0), found.max(axis=0)
    half = float((high - low).max()) / 2
    length = np.where(area > 0, area, 1)[at]
    return (found - (low + high) / 2) / (half or 1.0), cross[at] / length[:, None]


def aspects(points: Floats, normals: Floats) -> list[Aspect]:
    """Return what is seen of spread points from the six `AXES`."""
    cell = np.clip(((points + 1) / 2 * _CELLS).astype(np.int64), 0, _CELLS - 1)
    return [_aspect(number, points, normals, cell) for number in range(6)]


def _aspect(number: int, points: Floats, normals: Floats, cell: Ints) -> Aspect:
    axis, sign = number % 3, 1 if number < 3 else -1
    rows, columns = _others(axis)
    place = cell[:, rows] * _CELLS + cell[:, columns]
    height = sign * points[:, axis]
    depth = np.full(_CELLS**2, -np.inf)
    np.maximum.at(depth, place, height)
    seen = height > depth[place] - _SKIN
    facing = np.bincount(place[seen], sign * normals[seen, axis], minlength=_CELLS**2) > 0
    mean = np.stack(
        [np.bincount(place[seen], normals[seen, k], minlength=_CELLS**2) for k in range(3)], axis=1
    )
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    unit = (mean / np.where(length > 0, length, 1)).reshape(_CELLS, _CELLS, 3)
    front = facing.reshape(_CELLS, _CELLS)
    turned = 0.0
    for first, second in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        cosine = (unit[first] * unit[second]).sum(axis=-1)
        both = front[first] & front[second]
        turned += float((np.arccos(np.clip(cosine, -1, 1)) * both).sum())
    cells = _CELLS**2
    return Aspect(float(front.sum()) / cells, turned / cells, depth.reshape(_CELLS, _CELLS))


def mirrored(seen: list[Aspect], axis: int) -> float:
    """Return how much the two halves of an object along an axis are alike: 1 where they are one."""
    unlike = total = 0.0
    for number, aspect in enumerate(seen):
        if number % 3 == axis:
            continue
        depth = aspect.depth
        other = np.flip(depth, _others(number % 3).index(axis))
        here, there = np.isfinite(depth), np.isfinite(other)
        both = here & there
        off = np.abs(np.where(both, depth, 0) - np.where(both, other, 0))
        unlike += float(np.minimum(off / _FAR, 1)[both].sum() + (here ^ there).sum())
        total += float((here | there).sum())
    return 1 - unlike / total


def footing(points: Floats, normals: Floats, number: int) -> Footing:
    """Return how spread points would stand with one of the `AXES` up."""
    axis, sign = number % 3, 1 if number < 3 else -1
    height = sign * points[:, axis]
    height = height - height.min()
    flat = points[:, _others(axis)]
    flat = flat - flat.mean(axis=0)
    width = float(np.sqrt((flat**2).sum(axis=1).mean()))
    angle = np.arange(_DIRECTIONS) * (2 * np.pi / _DIRECTIONS)
    reach = flat[height < _LOW] @ np.stack([np.cos(angle), np.sin(angle)])
    down = sign * normals[:, axis] < -_DOWN
    share = float(np.mean((height < _FLAT) & down))
    margin = float(reach.max(axis=0).min()) / (width or 1.0)
    return Footing(margin, share, float(height.mean()))


def _others(axis: int) -> list[int]:
    return [other for other in range(3) if other != axis]
