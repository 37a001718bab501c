"""Which blocks of a sparse grid points touch, and which ones a blur needs.

A block is known by a key: one number of its three places. All arrays of keys are sorted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Cells", "blurs", "cells", "morton_order"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_BITS = 21  # of a place along an axis: three of them fill a key


def morton_order(places: Floats) -> Ints:
    """Return the order of points (3, n) in [0, 1) along Morton's curve.

    In it neighbours are near each other, and so is what they read and write.
    """
    code = np.zeros(places.shape[1], np.int64)
    for axis, along in enumerate(places):
        bits = (along * (1 << _BITS)).astype(np.int64)
        for shift, mask in (
            (32, 0x1F00000000FFFF), (16, 0x1F0000FF0000FF), (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3), (2, 0x1249249249249249),
        ):  # fmt: skip
            bits = (bits | (bits << shift)) & mask
        code |= bits << axis
    return np.argsort(code, kind="stable")


class Cells(NamedTuple):
    """Points by the block that their first nodes lie in.

    Attributes
    ----------
    order : (n,) array
        That sorts points by their blocks; those of a block stay in the order that they had.
    starts : (k + 1,) array
        Where the sorted points of each begin.
    keys : (k,) array
        Of their blocks, sorted.
    step : (3,) array
        From a block's key to that of the next one along each axis.
    """

    order: Ints
    starts: Ints
    keys: Ints
    step: Ints


def cells(block: NDArray[np.int32], room: int) -> Cells:
    """Return the cells of points.

    Parameters
    ----------
    block : (n, 3) array
        The place of the block with each point's first node.
    room : int
        Blocks round all of them that keys leave room for.
    """
    low, high = block.min(axis=0) - room, block.max(axis=0) + room + 2
    shape = (high - low).astype(np.int64)
    step = np.array([1, shape[0], shape[0] * shape[1]])
    key = (block[:, 2] - low[2]) * step[2] + (block[:, 1] - low[1]) * step[1] + block[:, 0] - low[0]
    order = np.argsort(key, kind="stable")  # quick: they nearly are
    key = key[order]
    starts = np.flatnonzero(np.concatenate(([True], key[1:] != key[:-1], [True])))
    return Cells(order, starts, key[starts[:-1]], step)


Near = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]


def blurs(given: Ints, wanted: Ints, far: int, step: Ints) -> Near:
    """Return the way of a blur along z, y and x, which reaches so many blocks far along each.

    Parameters
    ----------
    given, wanted : arrays
        Keys of the blocks that are blurred, and of those that are to come out.
    far : int
    step : (3,) array

    Returns
    -------
    three (·, 2 far + 1) arrays of int32
        For the blocks after each blur, where those that it needs are among the ones before; −1
        where there are none. After the last, blocks are those that are wanted.
    """
    around = np.arange(-far, far + 1)

    def dilated(keys: Ints, axis: int) -> Ints:
        return np.unique(keys[:, None] + around * step[axis])

    def places(keys: Ints, among: Ints, axis: int) -> NDArray[np.int32]:
        neighbours = keys[:, None] + around * step[axis]
        at = np.minimum(np.searchsorted(among, neighbours), len(among) - 1)
        return np.where(among[at] == neighbours, at, -1).astype(np.int32)

    for_x = dilated(wanted, 0)
    for_y = dilated(for_x, 1)
    after_z = np.intersect1d(dilated(given, 2), for_y, assume_unique=True)
    after_y = np.intersect1d(dilated(after_z, 1), for_x, assume_unique=True)
    return places(after_z, given, 2), places(after_y, after_z, 1), places(wanted, after_y, 0)
