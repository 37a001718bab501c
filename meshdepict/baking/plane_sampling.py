"""Triangles split for sums of smoothed normals: no further apart than a Gaussian is wide.

Sums go over vertices. Where large triangles meet at sharp edges, Gaussians as wide as a median edge
find few or none, and what they make of corners alone is interpolated over whole planes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.finer_mesh import FinerMesh
from meshdepict.scales.mesh_scales import mesh_space
from meshdepict.scales.space import ScaleSpace

__all__ = ["with_sampled_planes"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_SPACING = 1.0  # longest edge beside a bend, in widths of the narrowest Gaussian …
_SLOPE = 0.5  # … and as a share of the distance to the next bend, where that is more:
_REACH = (
    4.0  # wide Gaussians alone reach so far from it; none beyond so many of the widest's widths
)
_ROUNDS = 14
_SHARE = 0.5  # of the triangles there may be: the rest is for colours
_FEATURES = 300_000  # points that stand for bends


def with_sampled_planes(finer: FinerMesh, space: ScaleSpace) -> tuple[FinerMesh, ScaleSpace]:
    """Split what is large beside the widths of a scale space, and smooth anew.

    Meshes without planes, scale spaces with no width, and those of objects that stand together,
    whose rays leave the vertices that they have, stay as they are.

    Parameters
    ----------
    finer : FinerMesh
        Not split yet.
    space : ScaleSpace
        Of the same mesh.
    """
    if finer.pieces is None or len(space.widths) == 1 or space.company is not None:
        return finer, space
    mesh = space.own_surface
    widths = space.widths[1:] / (mesh.diagonal or 1.0)
    spacing = _SPACING * float(widths[0])
    while True:
        sampled = FinerMesh(mesh, finer.pieces)
        if _split(sampled, spacing, _REACH * float(widths[-1])):
            break
        spacing *= 1.5
    pieces = sampled.pieces
    assert pieces is not None
    again = mesh_space(
        sampled.mesh(), space.widths, space.ratio,
        facing=space.facing, tolerance=space.tolerance, normals=(pieces.vertices, pieces.corners),
        at_once=space.smoothed,
    )  # fmt: skip
    if space.tints is not None:
        corners, weights, _ = sampled.vertices
        again.tints = np.einsum("nc,nci->ni", weights.astype(np.float32), space.tints[corners])
    after = FinerMesh(again.shape, pieces)
    after.most = finer.most
    return after, again


def _split(finer: FinerMesh, spacing: float, reach: float) -> bool:
    """Split edges that are too long for where they are; False where that takes too many."""
    from scipy.spatial import KDTree

    bends = KDTree(_bends(finer, spacing))
    for _ in range(_ROUNDS):
        edges = finer.edges()
        middles = finer.middles(edges)
        length = finer.lengths(edges)
        long = length > spacing
        distance, _ = bends.query(finer.points(middles)[long])
        # Of the whole edge, not of its middle.
        distance -= np.minimum(distance, length[long] / 2)
        long[long] = (length[long] > _SLOPE * distance) & (distance < reach)
        if not long.any():
            return True
        if len(finer.faces) + 2 * np.count_nonzero(long) > _SHARE * finer.most:
            return False
        finer.split(edges, middles, finer.together(edges, long))
    return True


def _bends(finer: FinerMesh, spacing: float) -> Floats:
    """Return points of the unit frame along the creases and bends that planes end at."""
    pieces = finer.pieces
    assert pieces is not None
    face, side = np.nonzero(pieces.ends)
    points = finer.points(finer.vertices)
    a, b = points[finer.faces[face, side]], points[finer.faces[face, (side + 1) % 3]]
    length = np.linalg.norm(b - a, axis=1)
    step = max(spacing, float(length.sum()) / _FEATURES)
    count = np.ceil(length / step).astype(np.int64) + 1
    row = np.repeat(np.arange(len(a)), count)
    along = (np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)) / np.maximum(
        count[row] - 1, 1
    )
    return np.asarray(a[row] + along[:, None] * (b - a)[row])
