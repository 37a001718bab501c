"""Which faces to turn so that neighbours agree and normals point outwards.

Faces that share an edge with just one other face are made to agree with it; those that hang
together in this way are a *patch*. A patch keeps the winding that most of its area had. Then the
closed patches are turned all together if they enclose a negative volume in sum, so that a cavity
stays a cavity, and each open patch is turned if rays show that it looks inwards; a sheet, which is
seen from both sides, stays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdepict.surface.components import connected
from meshdepict.surface.edges import Edges, cleaned, is_balanced
from meshdepict.surface.sidedness import looks_inward

__all__ = ["Orientation", "orient"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_BLOCK = 1 << 18  # faces at a time, to keep temporaries small
_ROUNDING = 1e-12  # sums of areas or volumes below this share of their terms are zero
_SHEET = 0.2  # share of the area; see _foretold
_AS_GOOD_AS_CLOSED = 0.01


@dataclass(frozen=True)
class Orientation:
    """Which faces are wound the wrong way round.

    Attributes
    ----------
    flipped : (m,) array of bool
        True where a face has to be turned.
    message : str or None
        One sentence about what has to be turned and why, None if nothing.
    """

    flipped: Bools
    message: str | None


def orient(points: Floats, faces: Ints, *, balanced: bool | None = None) -> Orientation:
    """Find the faces to turn so that neighbours agree and normals point outwards.

    Parameters
    ----------
    points : (n, 3) array of float
        Finite. Points at bit-identical positions count as one.
    faces : (m, 3) array of int
        Copies of a face turn with it; one with two corners at one position has no side, and what
        is said of it means nothing.
    balanced : bool, optional
        What `is_balanced` says of the faces, where that is known.

    Returns
    -------
    Orientation
        The same wherever the mesh lies, however large it is and whichever way it is turned; and,
        unless a patch is on the verge of looking inwards, however points and faces are numbered.
    """
    if len(faces) == 0:
        return Orientation(np.zeros(0, bool), None)
    if is_balanced(faces, len(points)) if balanced is None else balanced:
        inside_out = _is_negative(_measured(_boxed(points, faces), faces)[1])
        flipped = np.full(len(faces), inside_out)
        return Orientation(flipped, _message(flipped, 0, inside_out=inside_out, open_patches=0))

    mesh = cleaned(points, faces)
    faces = mesh.faces
    if len(faces) == 0:
        return Orientation(np.zeros(len(mesh.place), bool), None)
    points = _boxed(points, faces)
    areas, volumes = _measured(points, faces)
    turn, patch = _agreeing(mesh.edges, len(faces))
    turn = _majority(turn, patch, areas, volumes)
    disagreed = int(turn.sum())

    closed = _closed(mesh.edges, turn, patch)
    if mesh.edges_with_copies is not None:
        closed |= _closed(mesh.edges_with_copies, turn, patch)
    closed = closed[patch]
    inside_out = _is_negative(np.where(turn, -volumes, volumes)[closed])
    turn[closed] ^= inside_out
    inward = np.zeros(0, np.int64)
    if not closed.all():
        outcome = None
        if not patch.any():
            volume = float(np.where(turn, -volumes, volumes).sum())
            outcome = _foretold(points, mesh.edges, turn, float(areas.sum()), volume)
        if outcome is None:
            faces = np.where(turn[:, None], faces[:, ::-1], faces)
            outcome = looks_inward(points, faces, np.where(closed, -1, patch), areas)
        inward = outcome
        turn ^= np.isin(patch, inward)
    flipped = turn[mesh.place] & (mesh.place >= 0)
    return Orientation(
        flipped, _message(flipped, disagreed, inside_out=inside_out, open_patches=len(inward))
    )


def _message(flipped: Bools, disagreed: int, *, inside_out: bool, open_patches: int) -> str | None:
    if not flipped.any():
        return None
    reasons = []
    if disagreed:
        their = "its" if disagreed == 1 else "their"
        reasons.append(f"{disagreed:,} disagreed with {their} neighbours")
    if inside_out:
        reasons.append(
            "the mesh was inside out" if flipped.all() else "closed parts were inside out"
        )
    if open_patches:
        parts = "1 open part" if open_patches == 1 else f"{open_patches:,} open parts"
        reasons.append(f"{parts} faced inwards")
    return f"winding of {int(flipped.sum()):,} faces was turned: {', '.join(reasons)}"


# --- agreement ------------------------------------------------------------------------------


def _agreeing(edges: Edges, m: int) -> tuple[Bools, Ints]:
    """Which faces to turn so that all neighbours agree, and the patch of each face.

    Where that can't be (a Möbius strip), what agreed before still does, and the disagreement
    stays on short seams.
    """
    first = edges.start[edges.count == 2]
    f, g = edges.face[first], edges.face[first + 1]
    agree = edges.forward[first] != edges.forward[first + 1]
    if agree.all():
        return np.zeros(m, bool), connected(m, f, g)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import minimum_spanning_tree

    part = connected(m, f[agree], g[agree])
    parts = int(part.max()) + 1
    contacts = np.sort(np.stack((part[f[~agree]], part[g[~agree]])), axis=0)
    i, j = contacts[:, contacts[0] != contacts[1]]
    # A spanning tree of the parts, by the longest contacts (in edges): along it all are opposed.
    weights = coo_array((np.full(len(i), -1.0), (i, j)), shape=(parts, parts)).tocsr()
    i, j = np.asarray(minimum_spanning_tree(weights).nonzero(), np.int64)
    # Each part is two nodes, as wound and turned; opposed parts link one's first to other's second.
    state = connected(2 * parts, np.append(i, i + parts), np.append(j + parts, j))
    return (state[:parts] > state[parts:])[part], connected(parts, i, j)[part]


def _majority(turn: Bools, patch: Ints, areas: Floats, volumes: Floats) -> Bools:
    """Of a patch's two windings take the one that most of its area has, or else the outward one."""
    area = np.bincount(patch, areas)
    excess = 2 * np.bincount(patch, areas * turn) - area
    volume = np.bincount(patch, np.where(turn, -volumes, volumes))
    undecided = np.abs(excess) <= _ROUNDING * area
    negative = volume < -_ROUNDING * np.bincount(patch, np.abs(volumes))
    return turn ^ np.where(undecided, negative, excess > 0)[patch]


def _direction(edges: Edges, turn: Bools) -> Ints:
    """Of every side after turning: 1 from the smaller to the larger vertex number, or −1."""
    return np.where(edges.forward ^ turn[edges.face], 1, -1)


def _closed(edges: Edges, turn: Bools, patch: Ints) -> Bools:
    """Whether each patch is closed: on every edge as many sides one way as the other.

    It may be so alone, or together with the patches that it meets at edges of three faces or more.
    """
    patches = int(patch.max()) + 1
    side_patch = patch[edges.face]
    direction = _direction(edges, turn)
    balance = np.add.reduceat(direction, edges.start)
    open_alone = np.zeros(patches, bool)
    open_alone[side_patch[edges.start[(edges.count <= 2) & (balance != 0)]]] = True
    open_together = open_alone.copy()

    busy = np.repeat(edges.count > 2, edges.count)
    edge = np.repeat(np.arange(len(edges.start)), edges.count)[busy]
    side_patch = side_patch[busy]
    open_together[side_patch[balance[edge] != 0]] = True
    own, inverse = np.unique(edge * patches + side_patch, return_inverse=True)
    unmatched = np.bincount(inverse, direction[busy]) != 0
    open_alone[own[unmatched] % patches] = True
    same = edge[1:] == edge[:-1]
    cluster = connected(patches, side_patch[1:][same], side_patch[:-1][same])
    return ~open_alone | (np.bincount(cluster, open_together) == 0)[cluster]


# --- measures -------------------------------------------------------------------------------


def _boxed(points: Floats, faces: Ints) -> Floats:
    """Move and scale the points so that the faces fill a box of size one about the origin."""
    used = np.zeros(len(points), bool)
    used[faces] = True
    low, high = points[used].min(axis=0), points[used].max(axis=0)
    return (points - (low / 2 + high / 2)) / (float((high - low).max()) or 1.0)


def _measured(points: Floats, faces: Ints) -> tuple[Floats, Floats]:
    """Area of each face, and the signed volume between it and the origin."""
    areas, volumes = np.empty(len(faces)), np.empty(len(faces))
    for block in _blocks(faces):
        a, cross = _cross(points, faces[block])
        areas[block] = np.linalg.norm(cross, axis=1) / 2
        volumes[block] = np.einsum("ij,ij->i", a, cross) / 6
    return areas, volumes


def _is_negative(volumes: Floats) -> bool:
    return bool(volumes.sum() < -_ROUNDING * np.abs(volumes).sum())


def _foretold(points: Floats, edges: Edges, turn: Bools, area: float, volume: float) -> Ints | None:
    """Foretell the verdict of `looks_inward` on a mesh of one patch, where that is easy.

    Building the tree for the rays takes seconds with millions of faces. Of the pairs of rays, the
    share that sees a sheet is that of the openings in the area. They are no smaller than their
    vector area, which the rims tell: from 20 % of the area on, 90 % of the pairs can't agree.
    They are no larger than circles as long as their rims: below 1 % the patch is as good as
    closed, and the sign of its volume tells. Else None.
    """
    balance = np.add.reduceat(_direction(edges, turn), edges.start)
    rim = np.flatnonzero(balance)
    a, b = np.divmod(edges.key[rim], len(points))
    vector = balance[rim] @ np.cross(points[a], points[b]) / 2
    if np.linalg.norm(vector) > _SHEET * area:
        return np.zeros(0, np.int64)
    corners, (i, j) = np.unique(np.stack((a, b)), return_inverse=True)
    rims = np.bincount(
        connected(len(corners), i, j)[i], np.linalg.norm(points[a] - points[b], axis=1)
    )
    openings = float((rims**2).sum()) / (4 * np.pi)
    if openings < _AS_GOOD_AS_CLOSED * area and openings < abs(volume):  # caps add less than that
        return np.flatnonzero([volume < 0])
    return None


def _blocks(faces: Ints) -> list[slice]:
    return [slice(start, start + _BLOCK) for start in range(0, len(faces), _BLOCK)]


def _cross(points: Floats, faces: Ints) -> tuple[Floats, Floats]:
    """First corner of each face, and the cross product of its sides."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    return a, np.cross(b - a, c - a)
