"""Kernels of sums on a grid of blocks: spreading points, blurring, gathering.

A block is a cube of nodes, its channels beside each other: (BLOCK, BLOCK, BLOCK · c). A point whose
first node lies in a block reaches into the next ones, so points of a block are spread on, and
gathered from, a copy of it and of its seven neighbours' edges. In that copy a point's nodes along x
are one run of numbers, whatever its channels: as many vectors as hold it are the tuple ``like``.
"""

from __future__ import annotations

import math

import numpy as np

from meshdepict.sums.lanes import (
    WIDE,
    add,
    add_each,
    add_to,
    load,
    many,
    nothing,
    plus,
    store,
    store_each,
)  # fmt: skip
from meshdepict.threads import kernel

__all__ = [
    "BLOCK", "MOST_CHANNELS", "MOST_NODES", "block_keys", "blur", "gather", "merge", "spread",
]  # fmt: skip

BLOCK = 8
"""Nodes along the edge of a block."""

_SHIFT = 3  # bits of a place within it

MOST_NODES = 8
"""Along an axis, of a bell: a row of a table has so many weights, and what to add on the way to the
next row's after them."""

MOST_CHANNELS = WIDE
"""As many as are spread in one go."""

_TOGETHER = 256  # points, at most, that are added up before their sum is: for the sake of rounding
_ONE, _EVERY = many(WIDE), many(WIDE * BLOCK)


@kernel()
def block_keys(points, nodes, density, low, step, first, last, keys):  # type: ignore[no-untyped-def]
    """Fill the keys of the blocks with the first nodes of points [first, last).

    Parameters
    ----------
    points : (n, 3) array
    nodes : int
    density : float
        Nodes of the grid in a unit of the points.
    low, step : (3,) arrays
        The lowest place of a block along each axis, and what a step from there adds to the key.
    """
    for i in range(first, last):
        key = 0
        for axis in range(3):
            node = math.floor(points[i, axis] * density - (nodes / 2 - 1))
            key += ((int(node) >> _SHIFT) - low[axis]) * step[axis]
        keys[i] = key


@kernel("free", inline=True)
def _along(place, corner, nodes, density):  # type: ignore[no-untyped-def]
    """Return a point's first node in its block, along an axis, and how far it is beyond that.

    Rounded another way than for its key, it may be in the next block by a hair.
    """
    x = place * density - (nodes / 2 - 1) - corner
    node = min(max(math.floor(x), 0), BLOCK - 1)
    return int(node), np.float32(min(max(x - node, 0.0), 1.0))


@kernel("free", inline=True)
def _weigh(share, table, weights, at):  # type: ignore[no-untyped-def]
    """Fill weights[at:] of a point's nodes along an axis."""
    steps = len(table) // (2 * MOST_NODES) - 1
    place = share * np.float32(steps)
    j = min(int(place), steps - 1)
    row = j * 2 * MOST_NODES
    found = add(load(table, row, _ONE), place - np.float32(j), table, row + MOST_NODES)
    store(found, weights, at)


@kernel("free", inline=True)
def _bells(point, corner, nodes, density, table, weights):  # type: ignore[no-untyped-def]
    """Fill weights (3 · WIDE,) of a point's nodes, axis by axis; return the first node."""
    x, beyond_x = _along(point[0], corner[0], nodes, density)
    y, beyond_y = _along(point[1], corner[1], nodes, density)
    z, beyond_z = _along(point[2], corner[2], nodes, density)
    _weigh(beyond_x, table, weights, 0)
    _weigh(beyond_y, table, weights, WIDE)
    _weigh(beyond_z, table, weights, 2 * WIDE)
    return x, y, z


@kernel("free", inline=True)
def _reach(part, side):  # type: ignore[no-untyped-def]
    """Return where one of eight blocks begins in a copy of their edges, and how far it goes."""
    ox, oy, oz = (part & 1) * BLOCK, (part >> 1 & 1) * BLOCK, (part >> 2) * BLOCK
    return ox, oy, oz, min(BLOCK, side - ox), min(BLOCK, side - oy), min(BLOCK, side - oz)


@kernel("free")
def spread(  # type: ignore[no-untyped-def]
    starts, slots, corners, order, points, values, nodes, density, table, like, first, last, grid
):
    """Spread the points of cells [first, last) on their blocks.

    Parameters
    ----------
    starts : (cells + 1,) array
        Where each cell's points begin.
    slots : (cells, 8) array
        Blocks that a cell's points reach, x before y before z.
    corners : (cells, 3) array
        The first nodes of their blocks.
    order : (n,) array
        The points of the cells.
    points : (n, 3) array
    values : (n · c + WIDE,) array
        A point's channels after another's.
    nodes, density
        As for `block_keys`.
    table : (rows · 2 · MOST_NODES,) array
    like : tuple
        ``many(nodes * c)``.
    grid : (blocks, BLOCK, BLOCK, BLOCK · c) array
        What is added to.
    """
    c = grid.shape[3] // BLOCK
    side = BLOCK + nodes - 1
    line, run = side * c, nodes * c
    flat = np.zeros(side * side * line + 2 * WIDE, np.float32)
    row = np.zeros(run + 2 * WIDE, np.float32)
    w = np.zeros(3 * WIDE, np.float32)
    zero = nothing(row, _ONE)
    for cell in range(first, last):
        begin, end = starts[cell], starts[cell + 1]
        while begin < end:
            stop = min(begin + _TOGETHER, end)
            flat[:] = np.float32(0)
            for i in range(begin, stop):
                p = order[i]
                x, y, z = _bells(points[p], corners[cell], nodes, density, table, w)
                for k in range(nodes):  # each writes over what is no channel of the one before
                    store(add(zero, w[k], values, p * c), row, k * c)
                store(zero, row, run)
                whole = load(row, 0, like)
                corner = (z * side + y) * line + x * c
                for k in range(nodes):
                    at = corner + k * side * line
                    for j in range(nodes):
                        add_to(whole, w[2 * WIDE + k] * w[WIDE + j], flat, at)
                        at += line
            begin = stop
            for part in range(8):
                ox, oy, oz, nx, ny, nz = _reach(part, side)
                block, length = grid[slots[cell, part]], nx * c
                for z in range(nz):
                    for y in range(ny):
                        at = ((oz + z) * side + oy + y) * line + ox * c
                        to, given = block[z, y], flat[at : at + length]
                        for k in range(length):
                            to[k] += given[k]


@kernel("free")
def gather(  # type: ignore[no-untyped-def]
    starts, slots, corners, order, points, nodes, density, table, like, grid, targets, wanted,
    first, last, sums,
):  # fmt: skip
    """Gather the sums (n, c) at the points of cells [first, last), in the order that they had.

    Parameters
    ----------
    targets : (n,) array
        Where each point belongs among the sums.
    wanted : (n,) array of bool
        Whether those are asked for.
    starts, slots, corners, order, points, nodes, density, table, like, grid
        As for `spread`.
    """
    c = sums.shape[1]
    side = BLOCK + nodes - 1
    line, run = side * c, nodes * c
    flat = np.zeros((side + 1) * side * line + 2 * WIDE, np.float32)  # of a sixth node, say, too
    row = np.zeros(run + 2 * WIDE, np.float32)
    w = np.zeros(3 * WIDE, np.float32)
    found = np.zeros(WIDE, np.float32)
    zero, zeros = nothing(row, _ONE), nothing(row, like)
    for cell in range(first, last):
        any_wanted = False
        for i in range(starts[cell], starts[cell + 1]):
            any_wanted |= wanted[targets[order[i]]]
        if not any_wanted:
            continue
        for part in range(8):
            ox, oy, oz, nx, ny, nz = _reach(part, side)
            block, length = grid[slots[cell, part]], nx * c
            for z in range(nz):
                for y in range(ny):
                    at = ((oz + z) * side + oy + y) * line + ox * c
                    to, given = flat[at : at + length], block[z, y]
                    for k in range(length):
                        to[k] = given[k]
        for i in range(starts[cell], starts[cell + 1]):
            target = targets[order[i]]
            if not wanted[target]:
                continue
            x, y, z = _bells(points[order[i]], corners[cell], nodes, density, table, w)
            even, odd = zeros, zeros  # two sums, neither of which waits for the other
            corner = (z * side + y) * line + x * c
            for k in range(0, nodes, 2):
                at = corner + k * side * line
                for j in range(nodes):
                    even = add(even, w[2 * WIDE + k] * w[WIDE + j], flat, at)
                    odd = add(odd, w[2 * WIDE + k + 1] * w[WIDE + j], flat, at + side * line)
                    at += line
            store(plus(even, odd), row, 0)
            total = zero
            for k in range(nodes):
                total = add(total, w[k], row, k * c)
            store(total, found, 0)
            to = sums[target]
            for m in range(c):
                to[m] = found[m]


@kernel("free")
def blur(near, grid, first, taps, stride, size, out):  # type: ignore[no-untyped-def]
    """Blur blocks along one axis.

    Parameters
    ----------
    near : (blocks, 2 far + 1) array
        Of each block of ``out`` those along the axis that it is blurred from, −1 where there is
        none.
    grid, out : arrays
        Blocks in one row. Of the grid some more numbers behind them are read.
    first : int
        Which block is the first one of the grid.
    taps : (2 reach + 1 + 2 BLOCK,) array
        Of the nodes from ``reach`` before a node to as many after it, at most BLOCK · far, between
        zeros; the same forwards and backwards.
    stride : int
        Numbers from a node of a block to the next one along the axis.
    size : int
        Numbers of a block.
    """
    half, run = near.shape[1] // 2, stride * BLOCK
    reach = (len(taps) - 1) // 2 - BLOCK
    sums = np.zeros(size + WIDE, np.float32)
    zeros = nothing(sums, _EVERY)
    top = (stride - 1) // WIDE * WIDE
    places, numbers = np.empty(BLOCK + 2 * reach, np.int64), np.empty(BLOCK + 2 * reach, np.int64)
    for i in range(len(near)):
        count = 0  # nodes within reach, where they are, and the tap from each to the block's first
        for node in range(-reach, BLOCK + reach):
            block = near[i, (node >> _SHIFT) + half]
            if block >= 0:
                places[count] = (block - first) * size + (node & (BLOCK - 1)) * stride
                numbers[count] = BLOCK + reach - node
                count += 1
        for begin in range(0, size, run):
            # All nodes along the axis at once. What goes beyond a node's numbers is written over:
            # of the next nodes those that come later in the memory are there first.
            for k in range(begin + top, begin - 1, -WIDE):
                every = zeros
                for node in range(count):
                    every = add_each(every, taps, numbers[node], grid, places[node] + k)
                store_each(every, sums, k, stride)
        to = out[i * size : (i + 1) * size]
        for k in range(size):
            to[k] = sums[k]


@kernel()
def merge(extra, owner, grid):  # type: ignore[no-untyped-def]
    """Add blocks of the grid to their owners, in this order."""
    for i in range(len(extra)):
        to, given = grid[owner[i]], grid[extra[i]]
        for k in range(grid.shape[1]):
            to[k] += given[k]
