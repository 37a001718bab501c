"""How far colours between vertices are from shading there, and triangles split where it shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.finer_mesh import FinerMesh
from meshdepict.baking.plane_sampling import with_sampled_planes
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.space import ScaleSpace
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.coarseness import coarse_share

__all__ = ["EdgeError", "edge_error", "midpoint_differences", "refine", "worth_refining"]

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Shade = Callable[[Any], NDArray[Any]]

_COARSE = 0.05  # of the area
_SAMPLE = 5_000  # edges: the mean square of their errors is known to 3 %


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
    faces = space.own_surface.faces
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

    Where the corners of a plane's triangles have the normals of its creases, what is new has the
    plane's, large triangles are split for the sums of smoothed normals, too, and up to creases more
    often than five times.

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
    finer, space = with_sampled_planes(FinerMesh(space.own_surface), space)
    values = shade(finer.samples(space, finer.vertices))
    while finer.rounds and len(finer.faces) <= finer.most:
        edges = finer.edges()
        middles = finer.middles(edges)
        shaded = shade(finer.samples(space, middles))
        shown = _levels(values, linear=linear)
        error = midpoint_differences(shown, edges, _levels(shaded, linear=linear))
        hidden = finer.hiding()
        if len(hidden):
            inside = _levels(shade(finer.samples(space, finer.centres(hidden))), linear=linear)
            off = np.abs(inside - shown[finer.faces[hidden]].mean(axis=1))
            error = finer.with_insides(error, edges, hidden, off.reshape(len(off), -1).max(axis=1))
        split = finer.affordable(edges, error, error > levels, hidden)
        if not split.any():
            break
        values = np.concatenate([values, shaded[split]])
        finer.split(edges, middles, split)
    return finer.mesh(), values


def worth_refining(mesh: Mesh) -> bool:
    """Tell whether more triangles show more of the surface.

    Not so where much of it is large triangles with other normals at their corners, and no planes
    are found: what is between them is nobody's shape, and clearer than before.
    """
    unit = mesh.diagonal or 1.0
    coarse = coarse_share(
        mesh.unit_points, mesh.outward_faces, mesh.normals, edge=mesh.edge_length / unit
    )
    return coarse < _COARSE or FinerMesh(mesh).pieces is not None


def midpoint_differences(ends: Floats, edges: Ints, middles: Floats) -> Floats:
    """Return |middle − mean of the ends| of each edge, the largest of the channels."""
    difference = np.abs(middles - (ends[edges[:, 0]] + ends[edges[:, 1]]) / 2)
    return difference.reshape(len(edges), -1).max(axis=1, initial=0)


def _levels(values: NDArray[Any], *, linear: bool) -> Floats:
    """Return display values in grey levels, 0 … 255, not rounded."""
    return 255 * np.asarray(linear_to_srgb(values) if linear else values, np.float64)
