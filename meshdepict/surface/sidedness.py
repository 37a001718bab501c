"""Which side of an open surface is outside, asked with rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["looks_inward"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_AGREEMENT = 0.9  # of the telling pairs of rays
_TELLING = 8  # pairs that a verdict needs
_PAIRS = 2048  # of rays, shared by all patches …
_FEWEST = 64  # … that get at least these
_PATCHES = 1024  # the largest ones; the rest of a mesh in so many pieces is not asked about
_OFFSET = 1e-5  # of a ray's start from its face, in sizes of the mesh: 100 roundings in float32


def looks_inward(points: Floats, faces: Ints, patch: Ints, areas: Floats) -> Ints:
    """Find the patches whose faces look inwards.

    A pair of rays leaves the two sides of a face in opposite directions. Where one gets away and
    the other hits something, the first side is outside; where both get away, the patch is a sheet
    there, and where neither does the pair tells nothing. A patch looks inwards if 90 % of its
    telling pairs say so. By reciprocity, the share of the pairs that see a sheet in a vessel is
    the area of its opening over that of its wall.

    Parameters
    ----------
    points : (n, 3) array
        In a box of size one about the origin: Embree computes in float32.
    faces : (m, 3) array
        All of them stop rays.
    patch : (m,) array of int
        Number of the patch of each face to be asked about, −1 for the others.
    areas : (m,) array
        Areas of the faces.

    Returns
    -------
    (patches,) array of int
        The numbers of the patches that look inwards.
    """
    asked = np.flatnonzero((patch >= 0) & (areas > 0))
    area = np.bincount(patch[asked], areas[asked])
    largest = np.argsort(-area, kind="stable")[:_PATCHES]
    largest = largest[area[largest] > 0]
    if len(largest) == 0:
        return largest
    number = np.full(len(area), -1)
    number[largest] = np.arange(len(largest))
    asked = asked[number[patch[asked]] >= 0]
    pairs = max(_FEWEST, _PAIRS // len(largest))
    generator = np.random.default_rng(0)
    step, u, v, radius, angle = generator.random((5, len(largest), pairs))
    chosen = _spread(asked, number[patch[asked]], areas[asked], (np.arange(pairs) + step) / pairs)

    a, b, c = points[faces[chosen]].transpose(2, 0, 1, 3)
    fold = u + v > 1
    u, v = np.where(fold, 1 - u, u)[..., None], np.where(fold, 1 - v, v)[..., None]
    foot = a + u * (b - a) + v * (c - a)
    # Directions weighted by their cosine, in a frame of the face: turning the mesh turns the rays.
    x, z = _unit(b - a), _unit(np.cross(b - a, c - a))
    radius, angle = np.sqrt(radius)[..., None], 2 * np.pi * angle[..., None]
    direction = radius * (np.cos(angle) * x + np.sin(angle) * np.cross(z, x))
    direction += np.sqrt(1 - radius * radius) * z

    origins = np.stack((foot + _OFFSET * z, foot - _OFFSET * z))
    front, back = _gets_away(points, faces, origins, np.stack((direction, -direction)))
    telling = (front | back).sum(axis=1)
    inward = (back & ~front).sum(axis=1)
    return largest[(telling >= _TELLING) & (inward >= _AGREEMENT * telling)]


def _spread(asked: Ints, number: Ints, areas: Floats, shares: Floats) -> Ints:
    """Choose the face at each share (patches, pairs) of the way through its patch's area."""
    order = np.argsort(number, kind="stable")
    end = np.cumsum(areas[order])
    last = np.searchsorted(number[order], np.arange(len(shares)), side="right") - 1
    below = np.append(0.0, end[last[:-1]])[:, None]
    wanted = below + shares * (end[last][:, None] - below)
    chosen = np.minimum(np.searchsorted(end, wanted, side="right"), last[:, None])
    return asked[order[chosen]]


def _gets_away(
    points: Floats, faces: Ints, origins: Floats, directions: Floats
) -> NDArray[np.bool_]:
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    TriangleMesh(scene, points.astype(np.float32), faces.astype(np.int32))
    rays = (array.reshape(-1, 3).astype(np.float32) for array in (origins, directions))
    return np.asarray(scene.run(*rays, query="OCCLUDED") < 0).reshape(origins.shape[:-1])


def _unit(vectors: Floats) -> Floats:
    """Return unit vectors; what is too short for a square of its length stays near zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)
