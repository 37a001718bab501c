"""Seams closed: faces between distinct points of the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.mesh import Mesh


def welded(mesh: Mesh):
    group = mesh._groups
    if group is None:
        return mesh._outward_faces, slice(None), None
    first = np.empty(int(group.max()) + 1, np.int64)
    first[group[::-1]] = np.arange(len(group) - 1, -1, -1)
    return group[mesh._outward_faces], first, group
