"""Triangles split at the middles of their edges, as arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["edge_pairs", "midpoints", "split_faces"]

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


def split_faces(faces: Ints, edges: Ints, middles: Ints) -> tuple[Ints, Ints]:
    """Split triangles at the middles of some edges, leaving no gaps.

    Parameters
    ----------
    faces : (m, 3) array
    edges : (e, 2) array
        Sorted vertex pairs, in lexical order.
    middles : (e,) array
        The vertex in the middle of each.

    Returns
    -------
    faces : (k, 3) array
        Of the same winding.
    parent : (k,) array
        The triangle that each is part of.
    """
    size = int(max(faces.max(), middles.max(initial=0))) + 1
    keys = edges[:, 0] * size + edges[:, 1]
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1), axis=-1)
    wanted = sides[..., 0] * size + sides[..., 1]
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    middle = np.where(keys[place] == wanted, middles[place], -1)
    marked = (middle >= 0).sum(axis=1)
    # Turned so that the first side is split and, of two, the second is, too.
    first = np.where(marked == 2, (np.argmin(middle, axis=1) + 1) % 3, np.argmax(middle, axis=1))
    order = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(faces, order, axis=1).T
    p, q, r = np.take_along_axis(middle, order, axis=1).T  # of ab, bc, ca
    pieces = [
        (marked == 0, (a, b, c)),
        (marked == 1, (a, p, c)), (marked == 1, (p, b, c)),
        (marked == 2, (p, b, q)), (marked == 2, (a, p, q)), (marked == 2, (a, q, c)),
        (marked == 3, (a, p, r)), (marked == 3, (p, b, q)), (marked == 3, (r, q, c)),
        (marked == 3, (p, q, r)),
    ]  # fmt: skip
    parent = np.concatenate([np.flatnonzero(where) for where, _ in pieces])
    parts = np.concatenate([np.stack(corner, axis=1)[where] for where, corner in pieces])
    by_parent = np.argsort(parent, kind="stable")
    return parts[by_parent], parent[by_parent]


def edge_pairs(faces: Ints) -> Ints:
    """Return the edges of triangles as sorted pairs, each once, in lexical order."""
    size = int(faces.max()) + 1
    pairs = np.sort(np.concatenate([faces[:, :2], faces[:, 1:], faces[:, ::2]]), axis=1)
    keys = np.sort(pairs[:, 0] * size + pairs[:, 1])
    keys = keys[np.diff(keys, prepend=-1) > 0]
    edges = np.stack(np.divmod(keys, size), axis=1)
    return edges[edges[:, 0] != edges[:, 1]]


def midpoints(corners: Ints, weights: Floats, ends: Ints) -> tuple[Ints, Floats]:
    """Return corners and weights of the middles of edges (or faces), which lie in one triangle.

    Parameters
    ----------
    corners, weights : (n, 3) array
        The vertices of that triangle and barycentric coordinates there, for each end.
    ends : (e, 2) or (e, 3) array
    """
    count, some = ends.shape
    both = corners[ends].reshape(count, 3 * some)
    shares = weights[ends].reshape(count, 3 * some) / some
    # The same vertex's shares are added; corners with none stand for anything.
    order = np.argsort(np.where(shares > 0, both, np.iinfo(np.int64).max), axis=1, kind="stable")
    both = np.take_along_axis(both, order, axis=1)
    shares = np.take_along_axis(shares, order, axis=1)
    used = shares > 0
    new = np.ones_like(used)
    new[:, 1:] = (both[:, 1:] != both[:, :-1]) & used[:, 1:]
    slot = np.minimum(np.cumsum(new, axis=1) - 1, 2)
    row = np.arange(count)[:, None]
    found = np.repeat(both[:, :1], 3, axis=1)
    merged = np.zeros((count, 3))
    np.add.at(merged, (row, slot), shares)
    rows, columns = np.nonzero(used)
    found[rows, slot[rows, columns]] = both[rows, columns]
    return found, merged
