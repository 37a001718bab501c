"""Welding: which vertices are one point of the surface, stored several times along a seam."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["normal_groups", "same_position"]


def same_position(vertices: NDArray[np.float64]) -> NDArray[np.int64] | None:
    """Return an (n,) label per distinct position, or None where all positions differ.

    Positions are compared bit for bit, −0 and 0 being equal.
    """
    keys = np.ascontiguousarray(vertices + 0.0)  # −0 becomes 0
    order = np.lexsort(keys.T)
    ranked = keys[order]
    new = np.concatenate(([True], (ranked[1:] != ranked[:-1]).any(axis=1)))
    if new.all():
        return None
    label = np.empty(len(vertices), np.int64)
    label[order] = np.cumsum(new) - 1
    return label


def normal_groups(
    vertices: NDArray[np.float64], normals: NDArray[np.float64]
) -> NDArray[np.int64] | None:
    """Group vertices at one position whose own normals lie within 90° of the group's largest.

    Parameters
    ----------
    vertices : (n, 3) array
    normals : (n, 3) array
        Their own normals, unnormalised; the longest at a position gathers the others within 90°
        round it, then the longest of the rest, and so on. Zero normals join the first.

    Returns
    -------
    (n,) array of int or None
        A group number per vertex, None where every vertex is alone.
    """
    position = same_position(vertices)
    if position is None:
        return None
    group = position.copy()
    crowded = np.bincount(position)[position] > 1
    rest = np.flatnonzero(crowded)
    length = np.linalg.norm(normals, axis=1)
    group_count = int(position.max()) + 1
    seeded_once = np.zeros(group_count, bool)
    while len(rest):
        # The longest normal at each position that is still unassigned leads.
        order = rest[np.lexsort((length[rest], position[rest]))]
        last = np.concatenate((position[order][1:] != position[order][:-1], [True]))
        leader = np.full(len(seeded_once), -1, np.int64)
        leader[position[order][last]] = order[last]
        lead = leader[position[rest]]
        joins = np.einsum("ij,ij->i", normals[rest], normals[lead]) >= 0
        joins |= rest == lead
        again = joins & seeded_once[position[rest]]
        if again.any():  # a further group at this position needs a number of its own
            places, number = np.unique(position[rest[again]], return_inverse=True)
            group[rest[again]] = group_count + number
            group_count += len(places)
        seeded_once[position[rest[joins]]] = True
        rest = rest[~joins]
    return group
