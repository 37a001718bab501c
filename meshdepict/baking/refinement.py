"""How far colours between vertices are from shading there, and triangles split where it shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.space import ScaleSpace
from meshdepict.shapes.mesh import Mesh

__all__ = ["EdgeError", "edge_error", "midpoint_differences", "refine", "split_faces"]

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Shade = Callable[[Any], NDArray[Any]]

_SAMPLE = 5_000  # edges: the mean square of their errors is known to 3 %
_ROUNDS = 5  # an edge becomes 32 at most
_GROWTH = 16  # times as many triangles as before, at most


class EdgeError(NamedTuple):
    """How far interpolated colours are from shading at the middle of edges, in grey levels.

    Attributes
    ----------
    rms : float
        Root mean square over the edges.
    share : float
        Of the edges, those beyond two levels.
    """

    rms: float
    share: float


def edge_error(space: ScaleSpace, shade: Shade, *, linear: bool) -> EdgeError:
    """Estimate the error of interpolated colours from an even choice of edges.

    Parameters
    ----------
    space : ScaleSpace
        Of a mesh.
    shade : callable
        A scale space to values (n,) or (n, 3) in [0, 1], each sample on its own.
    linear : bool
        Whether the values are linear light.
    """
    faces = space.shape.faces
    edges = faces[:: max(1, len(faces) // _SAMPLE), :2]  # of each the first side: any will do
    ends = np.unique(edges)
    rows = np.searchsorted(ends, edges)
    corners = np.concatenate([np.repeat(ends[:, None], 3, axis=1), edges[:, [0, 1, 1]]])
    weights = np.concatenate(
        [np.tile((1.0, 0, 0), (len(ends), 1)), np.tile((0.5, 0.5, 0), (len(edges), 1))]
    )
    values = _levels(shade(InterpolatedSpace(space, corners, weights)), linear=linear)
    error = midpoint_differences(values[: len(ends)], rows, values[len(ends) :])
    return EdgeError(float(np.sqrt(np.mean(error**2))), float(np.mean(error > 2)))


def refine(
    space: ScaleSpace, shade: Shade, *, linear: bool, levels: float = 2.0
) -> tuple[Mesh, NDArray[Any]]:
    """Split edges until colours between vertices are within so many grey levels of shading there.

    Only triangles at such edges are split, five times at most; the surface stays what it is. New
    vertices come after the old ones.

    Parameters
    ----------
    space : ScaleSpace
        Of a mesh.
    shade, linear
        As for `edge_error`.
    levels : float
        Of 255.

    Returns
    -------
    mesh : Mesh
        The finer one.
    values : (n,) or (n, 3) array
        The shading of it.

    Raises
    ------
    MeshdepictError
        For a number of levels that is none.
    """
    if not 0 < (real(levels) or 0) <= 255:
        raise MeshdepictError(
            f"refine={levels!r} is not a number of grey levels above 0 and up to 255"
        )
    mesh = space.shape
    faces, owner = mesh.faces, np.arange(len(mesh.faces))
    count = len(mesh.vertices)
    corners = np.repeat(np.arange(count)[:, None], 3, axis=1)
    weights = np.tile((1.0, 0.0, 0.0), (count, 1))
    values = shade(InterpolatedSpace(space, corners, weights))
    active = np.ones(len(faces), bool)
    for _ in range(_ROUNDS):
        edges = _edges(faces[active])
        middle = _midpoints(corners, weights, edges)
        shaded = shade(InterpolatedSpace(space, *middle))
        error = midpoint_differences(
            _levels(values, linear=linear), edges, _levels(shaded, linear=linear)
        )
        split = error > levels
        if not split.any() or len(faces) > _GROWTH * len(mesh.faces):
            break
        number = len(corners) + np.arange(np.count_nonzero(split))
        corners = np.concatenate([corners, middle[0][split]])
        weights = np.concatenate([weights, middle[1][split]])
        values = np.concatenate([values, shaded[split]])
        faces, parent = split_faces(faces, edges[split], number)
        owner = owner[parent]
        active = np.bincount(parent)[parent] > 1
    return _mesh(mesh, faces, owner, corners, weights), values


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


def midpoint_differences(ends: Floats, edges: Ints, middles: Floats) -> Floats:
    """Return |middle − mean of the ends| of each edge, the largest of the channels."""
    difference = np.abs(middles - (ends[edges[:, 0]] + ends[edges[:, 1]]) / 2)
    return difference.reshape(len(edges), -1).max(axis=1, initial=0)


def _edges(faces: Ints) -> Ints:
    """Return the edges of triangles as sorted pairs, each once, in lexical order."""
    size = int(faces.max()) + 1
    pairs = np.sort(np.concatenate([faces[:, :2], faces[:, 1:], faces[:, ::2]]), axis=1)
    keys = np.unique(pairs[:, 0] * size + pairs[:, 1])
    edges = np.stack(np.divmod(keys, size), axis=1)
    return edges[edges[:, 0] != edges[:, 1]]


def _midpoints(corners: Ints, weights: Floats, edges: Ints) -> tuple[Ints, Floats]:
    """Return corners and weights of the middles of edges, whose ends share a triangle."""
    both = corners[edges].reshape(len(edges), 6)
    shares = weights[edges].reshape(len(edges), 6) / 2
    # The same vertex's shares are added; corners with none stand for anything.
    order = np.argsort(np.where(shares > 0, both, np.iinfo(np.int64).max), axis=1, kind="stable")
    both = np.take_along_axis(both, order, axis=1)
    shares = np.take_along_axis(shares, order, axis=1)
    used = shares > 0
    new = np.ones_like(used)
    new[:, 1:] = (both[:, 1:] != both[:, :-1]) & used[:, 1:]
    slot = np.minimum(np.cumsum(new, axis=1) - 1, 2)
    row = np.arange(len(edges))[:, None]
    found = np.repeat(both[:, :1], 3, axis=1)
    merged = np.zeros((len(edges), 3))
    np.add.at(merged, (row, slot), shares)
    rows, columns = np.nonzero(used)
    found[rows, slot[rows, columns]] = both[rows, columns]
    return found, merged


def _levels(values: NDArray[Any], *, linear: bool) -> Floats:
    """Return display values in grey levels, 0 … 255, not rounded."""
    return 255 * np.asarray(linear_to_srgb(values) if linear else values, np.float64)


def _mesh(mesh: Mesh, faces: Ints, owner: Ints, corners: Ints, weights: Floats) -> Mesh:
    """Return the finer mesh: attributes of vertices interpolated, those of faces handed down."""
    new = slice(len(mesh.vertices), None)
    where, share = corners[new], weights[new]

    def spread(values: NDArray[Any]) -> NDArray[Any]:
        mean = np.einsum("nc,nc...->n...", share, values[where].astype(np.float64))
        if values.dtype.kind in "iub":
            mean = np.rint(mean)
        return np.concatenate([values, mean.astype(values.dtype)])

    vertices = np.concatenate([mesh.vertices, np.einsum("nc,nci->ni", share, mesh.vertices[where])])
    numeric = {k: v for k, v in mesh.attributes["vertex"].items() if v.dtype.kind in "iubf"}
    return Mesh(
        vertices,
        faces,
        attributes={
            "vertex": {name: spread(values) for name, values in numeric.items()},
            "face": {n: v[mesh._owner[owner]] for n, v in mesh.attributes["face"].items()},
        },
        winding="keep",
        length_unit=mesh.length_unit,
    )
