"""Connected components of a graph, in the time that it takes to read its links."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import kernel

__all__ = ["connected"]

Ints = NDArray[np.int64]


def connected(count: int, i: Ints, j: Ints) -> Ints:
    """Label the connected components of `count` nodes with links i – j.

    Components are numbered by their first nodes, in the order of the nodes.
    """
    root = np.arange(count)
    _join(root, np.ascontiguousarray(i, np.int64), np.ascontiguousarray(j, np.int64))
    return root


@kernel()
def _join(root, i, j):  # type: ignore[no-untyped-def]
    """Make of ``root``, which is each node itself, the number of its component.

    A root has the smallest number of its tree (Tarjan 1975, with halved paths).
    """
    for link in range(len(i)):
        a, b = i[link], j[link]
        while root[a] != a:
            root[a] = root[root[a]]
            a = root[a]
        while root[b] != b:
            root[b] = root[root[b]]
            b = root[b]
        if a < b:
            root[b] = a
        else:
            root[a] = b
    parts = 0
    for node in range(len(root)):
        if root[node] == node:
            root[node] = parts
            parts += 1
        else:  # its root, and so all between, came before
            root[node] = root[root[node]]
