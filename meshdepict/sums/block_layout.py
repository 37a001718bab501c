"""Which blocks of a sparse grid points touch, and which ones a blur needs.

A block is known by a key: one number of its three places. All arrays of keys are sorted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Cells", "Way", "blurs", "cells"]

Ints = NDArray[np.int64]


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
    low : (3,) array
        The place of the block with key 0.
    """

    order: Ints
    starts: Ints
    keys: Ints
    step: Ints
    low: Ints

    def places(self, first: int, last: int) -> Ints:
        """Return the places (·, 3) of the blocks of cells [first, last)."""
        z, rest = np.divmod(self.keys[first:last], self.step[2])
        y, x = np.divmod(rest, self.step[1])
        found: Ints = np.column_stack([x, y, z]) + self.low
        return found


def cells(key: Ints, step: Ints, low: Ints) -> Cells:
    """Return the cells of points by the keys of the blocks with their first nodes.

    Quick where neighbours follow each other, most of them with the same key.
    """
    begins = np.flatnonzero(np.diff(key, prepend=-1))
    lengths = np.diff(begins, append=len(key))
    sort = np.argsort(key[begins], kind="stable")
    begins, lengths = begins[sort], lengths[sort]
    before = np.cumsum(lengths) - lengths
    order = np.repeat(begins - before, lengths) + np.arange(len(key))
    own = key[begins]
    first = np.flatnonzero(np.diff(own, prepend=-1))
    return Cells(order, np.append(before[first], len(key)), own[first], step, low)


class Way(NamedTuple):
    """How blocks are blurred along z, y and x.

    Attributes
    ----------
    near : three (·, 2 far + 1) arrays of int32
        For the blocks after each blur, where those that it needs are among the ones before; −1
        where there are none. After the last, blocks are those that are wanted.
    layers : (k + 1, 3) array
        Where the blocks of each layer across z begin after each blur: what is blurred along y and x
        stays in its layer.
    """

    near: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]
    layers: Ints


def blurs(given: Ints, wanted: Ints, far: int, step: Ints) -> Way:
    """Return the way of a blur which reaches so many blocks far along each axis.

    Parameters
    ----------
    given, wanted : arrays
        Keys of the blocks that are blurred, and of those that are to come out.
    far : int
    step : (3,) array
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
    near = places(after_z, given, 2), places(after_y, after_z, 1), places(wanted, after_y, 0)
    layer = np.unique(wanted // step[2]) * step[2]
    begins = [
        np.append(np.searchsorted(keys, layer), len(keys)) for keys in (after_z, after_y, wanted)
    ]
    return Way(near, np.column_stack(begins))
