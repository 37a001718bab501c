"""Welding: which vertices are one point of the surface, stored several times along a seam."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["mixed_bits", "normal_groups", "same_position"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Two normals at a right angle, as on a cube, share whichever side of it rounding put them: this
# much more cosine is allowed. A single-precision file blurs the directions of small faces so far.
_RIGHT_ANGLE = 1e-4
_STEP = 0x9E3779B97F4A7C15  # of SplitMix64: the golden ratio in 64 bits


def same_position(vertices: Floats) -> Ints | None:
    """Return an (n,) label per distinct position, 0, 1, …, or None where all positions differ.

    Positions are compared bit for bit, −0 and 0 being equal.
    """
    keys = np.ascontiguousarray(vertices + 0.0, np.float64)  # −0 becomes 0
    hashes = _hashes(keys)
    ranked = np.sort(hashes)
    if (ranked[1:] != ranked[:-1]).all():
        return None  # most meshes: one sort of plain numbers settles it
    order = np.argsort(hashes)
    same, ranked = _like_previous(keys[order]), hashes[order]
    if (same[1:] != (ranked[1:] == ranked[:-1])).any():  # two positions of one hash: rank them all
        order = np.lexsort(keys.T)
        same = _like_previous(keys[order])
    if not same.any():
        return None
    label = np.empty(len(keys), np.int64)
    label[order] = np.cumsum(~same) - 1
    return label


def normal_groups(position: Ints, normals: Floats) -> Ints:
    """Part the vertices at one position whose own normals differ by more than 90°.

    The vertex whose normal has most in common with all at its position gathers those within 90°
    of it, then the same goes for the rest. Numbering and order of the vertices don't matter.

    Parameters
    ----------
    position : (n,) array of int
        Label of each vertex's position, 0, 1, ….
    normals : (n, 3) array
        Their own normals, unnormalised; zero ones join the first group.

    Returns
    -------
    (n,) array of int
        A group per vertex; all numbers from 0 to the largest are in use.
    """
    group = position.copy()
    crowd = np.bincount(position)
    count = len(crowd)
    rest = np.flatnonzero(crowd[position] > 1)
    # Sums of normals are rounded alike, and ties decided alike, in whichever order vertices come.
    rest = rest[np.lexsort((*normals[rest].T, position[rest]))]
    while len(rest):
        own, here = normals[rest], position[rest]
        start = np.flatnonzero(np.diff(here, prepend=-1))
        place = np.repeat(np.arange(len(start)), np.diff(start, append=len(rest)))
        score = np.einsum("ij,ij->i", own, np.add.reduceat(own, start)[place])
        best = np.flatnonzero(score == np.maximum.reduceat(score, start)[place])
        leader = best[np.flatnonzero(np.diff(place[best], prepend=-1))][place]
        length = np.linalg.norm(own, axis=1)
        cosine = np.einsum("ij,ij->i", own, own[leader])
        joins = cosine >= -_RIGHT_ANGLE * length * length[leader]
        rest = rest[~joins]
        # What is left at a position moves on to a number of its own.
        left, number = np.unique(place[~joins], return_inverse=True)
        group[rest] = count + number
        count += len(left)
    return group


def _like_previous(keys: Floats) -> NDArray[np.bool_]:
    """Whether each row equals the one before; the first has none."""
    return np.concatenate(([False], (keys[1:] == keys[:-1]).all(axis=1)))


def _hashes(keys: Floats) -> NDArray[np.uint64]:
    """Return a 64-bit number per row that differs between rows but for the odd chance."""
    total = np.zeros(len(keys), np.uint64)
    for axis, bits in enumerate(keys.view(np.uint64).T):
        total = mixed_bits((bits ^ total) + np.uint64(_STEP * axis % 2**64))
    return total


def mixed_bits(numbers: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return other numbers, one for each, of which every bit depends on every bit given.

    A step and the finaliser of SplitMix64.
    """
    mixed = numbers + np.uint64(_STEP)
    mixed ^= mixed >> np.uint64(30)
    mixed *= np.uint64(0xBF58476D1CE4E5B9)
    mixed ^= mixed >> np.uint64(27)
    mixed *= np.uint64(0x94D049BB133111EB)
    mixed ^= mixed >> np.uint64(31)
    return mixed
