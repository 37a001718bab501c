"""Kernels of sums on a grid of blocks: spreading points, blurring, gathering.

A block is a cube of nodes, its channels beside each other: (BLOCK, BLOCK, BLOCK · c). A point whose
first node lies in a block reaches into the next ones, so points of a block are spread on, and
gathered from, a copy of it and of its seven neighbours' edges.
"""

from __future__ import annotations

import numpy as np

from meshdepict.threads import kernel

__all__ = ["BLOCK", "LINES", "blur", "gather", "merge", "spread"]

BLOCK = 8
"""Nodes along the edge of a block."""

LINES = 6
"""Rows of nodes that are taken at once: more than that no bell has."""

_TOGETHER = 256  # points, at most, that are added up before their sum is: for the sake of rounding
_PAD = 16  # numbers beyond a row that may be read


@kernel("free", inline=True)
def _weights(share, table, weights):  # type: ignore[no-untyped-def]
    """Fill weights (3, LINES) of a point's nodes."""
    steps = table.shape[0] - 1
    for axis in range(3):
        at = share[axis] * np.float32(steps)
        j = min(int(at), steps - 1)
        part = at - np.float32(j)
        for k in range(table.shape[1]):
            weights[axis, k] = table[j, k] + part * (table[j + 1, k] - table[j, k])


@kernel("free", inline=True)
def _factors(weight, weights):  # type: ignore[no-untyped-def]
    """Return six weights, times one."""
    return (
        weight * weights[0], weight * weights[1], weight * weights[2], weight * weights[3],
        weight * weights[4], weight * weights[5],
    )  # fmt: skip


@kernel("free", inline=True)
def _rows(numbers, at, apart, run):  # type: ignore[no-untyped-def]
    """Return six rows of so many numbers, the first at a place, each so far after the last."""
    return (
        numbers[at : at + run],
        numbers[at + apart : at + apart + run],
        numbers[at + 2 * apart : at + 2 * apart + run],
        numbers[at + 3 * apart : at + 3 * apart + run],
        numbers[at + 4 * apart : at + 4 * apart + run],
        numbers[at + 5 * apart : at + 5 * apart + run],
    )


@kernel("free")
def spread(starts, slots, shares, local, values, table, first, last, grid):  # type: ignore[no-untyped-def]
    """Spread the points of cells [first, last) on their blocks.

    Parameters
    ----------
    starts : (cells + 1,) array
        Where each cell's points begin.
    slots : (cells, 8) array
        Blocks that a cell's points reach, x before y before z.
    shares, local : (n, 3) arrays
        Of points: how far they are beyond a node, and the first node's place in its block.
    values : (n, c) array
    table : (steps + 1, nodes) array
    grid : (blocks, BLOCK, BLOCK, BLOCK · c) array
        What is added to.
    """
    c, nodes = values.shape[1], table.shape[1]
    side = BLOCK + LINES - 1
    line, run = side * c, nodes * c
    flat = np.zeros(side * side * line + _PAD, np.float32)
    row = np.zeros(run, np.float32)
    w = np.zeros((3, LINES), np.float32)
    for cell in range(first, last):
        begin, end = starts[cell], starts[cell + 1]
        while begin < end:
            stop = min(begin + _TOGETHER, end)
            flat[:] = np.float32(0)
            for i in range(begin, stop):
                _weights(shares[i], table, w)
                for k in range(nodes):
                    for m in range(c):
                        row[k * c + m] = w[0, k] * values[i, m]
                for z in range(nodes):
                    a0, a1, a2, a3, a4, a5 = _factors(w[2, z], w[1])
                    at = ((local[i, 2] + z) * side + local[i, 1]) * line + local[i, 0] * c
                    r0, r1, r2, r3, r4, r5 = _rows(flat, at, line, run)
                    for k in range(run):
                        v = row[k]
                        r0[k] += a0 * v
                        r1[k] += a1 * v
                        r2[k] += a2 * v
                        r3[k] += a3 * v
                        r4[k] += a4 * v
                        r5[k] += a5 * v
            begin = stop
            for part in range(8):
                ox, oy, oz = (part & 1) * BLOCK, (part >> 1 & 1) * BLOCK, (part >> 2) * BLOCK
                block = grid[slots[cell, part]]
                length = min(BLOCK, side - ox) * c
                for z in range(min(BLOCK, side - oz)):
                    for y in range(min(BLOCK, side - oy)):
                        at = ((oz + z) * side + oy + y) * line + ox * c
                        to, given = block[z, y], flat[at : at + length]
                        for k in range(length):
                            to[k] += given[k]


@kernel("free")
def gather(starts, slots, shares, local, table, grid, order, wanted, first, last, sums):  # type: ignore[no-untyped-def]
    """Gather the sums (c, n) at the points of cells [first, last), in the order that they had.

    Parameters
    ----------
    order : (n,) array
        Where each point belongs among the sums.
    wanted : (n,) array of bool
        Whether it is gathered at all.
    starts, slots, shares, local, table, grid
        As for `spread`.
    """
    c, nodes = sums.shape[0], table.shape[1]
    side = BLOCK + LINES - 1
    line, run = side * c, nodes * c
    flat = np.zeros(side * side * line + _PAD, np.float32)
    row = np.zeros(run, np.float32)
    w = np.zeros((3, LINES), np.float32)
    for cell in range(first, last):
        for part in range(8):
            ox, oy, oz = (part & 1) * BLOCK, (part >> 1 & 1) * BLOCK, (part >> 2) * BLOCK
            block = grid[slots[cell, part]]
            length = min(BLOCK, side - ox) * c
            for z in range(min(BLOCK, side - oz)):
                for y in range(min(BLOCK, side - oy)):
                    at = ((oz + z) * side + oy + y) * line + ox * c
                    to, given = flat[at : at + length], block[z, y]
                    for k in range(length):
                        to[k] = given[k]
        for i in range(starts[cell], starts[cell + 1]):
            if not wanted[i]:
                continue
            _weights(shares[i], table, w)
            row[:] = np.float32(0)
            for z in range(nodes):
                a0, a1, a2, a3, a4, a5 = _factors(w[2, z], w[1])
                at = ((local[i, 2] + z) * side + local[i, 1]) * line + local[i, 0] * c
                r0, r1, r2, r3, r4, r5 = _rows(flat, at, line, run)
                for k in range(run):
                    row[k] += (
                        a0 * r0[k] + a1 * r1[k] + a2 * r2[k] + a3 * r3[k] + a4 * r4[k] + a5 * r5[k]
                    )
            o = order[i]
            for m in range(c):
                total = np.float32(0)
                for k in range(nodes):
                    total += w[0, k] * row[k * c + m]
                sums[m, o] = total


@kernel("free")
def blur(near, grid, taps, before, stride, first, last, out):  # type: ignore[no-untyped-def]
    """Blur along one axis: blocks [first, last) of ``out``.

    Parameters
    ----------
    near : (blocks, 2 far + 1) array
        Of each block of ``out`` those of the grid along the axis, −1 where there is none.
    grid, out : (blocks, numbers) arrays
    taps : (k · LINES,) array
        The last ones zeros, if need be.
    before : int
        How many nodes before a node the first tap is, ≤ BLOCK · far.
    stride : int
        Numbers from a node of a block to the next one along the axis.
    """
    many, size = near.shape[1], grid.shape[1]
    run = stride * BLOCK  # numbers of all nodes along the axis, one after the other
    whole = (many * BLOCK + LINES) * stride
    reach = many // 2 * BLOCK
    lines = np.zeros(whole, np.float32)
    for i in range(first, last):
        for begin in range(0, size, run):
            for number in range(many):
                to = lines[number * run : (number + 1) * run]
                if near[i, number] < 0:
                    to[:] = np.float32(0)
                else:
                    given = grid[near[i, number], begin : begin + run]
                    for k in range(run):
                        to[k] = given[k]
            sums = out[i, begin : begin + run]
            sums[:] = np.float32(0)
            for tap in range(0, taps.shape[0], LINES):
                a0, a1, a2, a3, a4, a5 = _factors(np.float32(1), taps[tap : tap + LINES])
                at = (reach - before + tap) * stride
                r0, r1, r2, r3, r4, r5 = _rows(lines, at, stride, run)
                for k in range(run):
                    sums[k] += (
                        a0 * r0[k] + a1 * r1[k] + a2 * r2[k] + a3 * r3[k] + a4 * r4[k] + a5 * r5[k]
                    )


@kernel()
def merge(extra, owner, grid):  # type: ignore[no-untyped-def]
    """Add blocks of the grid to their owners, in this order."""
    for i in range(len(extra)):
        to, given = grid[owner[i]], grid[extra[i]]
        for k in range(grid.shape[1]):
            to[k] += given[k]
