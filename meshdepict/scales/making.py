"""Making scale spaces: the one place that knows which kind of shape needs which."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.ladder import FACING, TOLERANCE, Progress, check_ladder, ladder
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import as_view
from meshdepict.scene.view import View
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.lengths import resolve_width
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.volume import Volume

__all__ = ["scale_space", "smooth_normals"]


def scale_space(
    shape: object,
    *,
    scales: int = 9,
    width: float | str | None = None,
    ratio: float = math.sqrt(2),
    facing: int = FACING,
    tolerance: float = TOLERANCE,
    view: View | str | None = None,
    at_once: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> ScaleSpace:
    """Smooth the normals of a shape at a geometric series of widths (Exaggerated Shading, §3).

    For vertex i with mixed Voronoi areas A and normals n the smoothed normal is the direction of
    ``Σ_j A_j F(r_i·n_j) exp(−‖x_i − x_j‖² / 2σ²) n_j``, r_i being the next finer scale's normal.

    Parameters
    ----------
    shape : Mesh, HeightField, Volume or GBuffer
        Of a volume see `grid_space`, of an image `image_space`, which have more to choose.
    scales : int
        Number of smoothed sets, ≥ 0; the original normals come before them.
    width : float or str, optional
        First width σ_1 in world units, in a unit of length where the shape knows its own ("5mm"),
        "0.2%" of the bounding box's diagonal, "3px" of a view, "3cells" of terrain, or the larger
        of two: "0.2%,3px". Default: the median edge length, terrain's distance of cells.
    ratio : float
        From one width to the next, > 1; √2 in Exaggerated Shading, 1.7 in Local Light Alignment.
    facing : {0, 1}
        Of meshes. 1: F(u) = (1 + u)/2, which keeps the two sides of a thin sheet apart.
        0: F = 1, the paper's formula to the letter.
    tolerance : float
        Largest angular error of a normal in radians, 1e-7 … 0.1. Images have their own; see
        `bilateral`.
    view : View or str, optional
        Whose pixels a width counts, at the middle of the shape; images have their own.
    at_once : iterable of int, optional
        The scales that are smoothed now, all unless given. Others are as soon as they are read.
    progress : callable, optional
        ``progress(done, total)``, called as the work goes on.

    Returns
    -------
    ScaleSpace

    Raises
    ------
    MeshdepictError
        For a parameter out of its range.
    """
    check_ladder(scales, ratio, facing, tolerance)
    if isinstance(shape, GBuffer):
        from meshdepict.scales.image_scales import image_space

        return image_space(
            shape, scales=scales, width=width, ratio=ratio, at_once=at_once, progress=progress
        )
    if not isinstance(shape, (Mesh, Volume, HeightField)):
        raise MeshdepictError(
            f"a {type(shape).__name__} has no scale space: give a Mesh, a HeightField, a Volume or "
            "a GBuffer"
        )
    eye = None if view is None else as_view(view, shape)
    widths = ladder(scales, ratio, resolve_width(width, shape, eye))
    if isinstance(shape, Volume):
        from meshdepict.scales.grid_making import grid_space

        return grid_space(
            shape, widths, ratio, tolerance=tolerance, at_once=at_once, progress=progress
        )
    if isinstance(shape, HeightField):
        from meshdepict.scales.height_scales import height_space

        return height_space(
            shape, widths, ratio, tolerance=tolerance, at_once=at_once, progress=progress
        )
    from meshdepict.scales.mesh_scales import mesh_space

    return mesh_space(
        shape, widths, ratio, facing=facing, tolerance=tolerance, at_once=at_once, progress=progress
    )


def smooth_normals(
    mesh: Mesh, width: float | str, *, facing: int = FACING, tolerance: float = TOLERANCE
) -> NDArray[np.float32]:
    """Smooth the normals at one width, climbing to it by a ladder of ratio √2.

    The last rung of a `scale_space` whose widths are width·√2^−j, as long as they are no smaller
    than the median edge.

    Returns
    -------
    (n, 3) array of float32
        Unit normals.
    """
    if not isinstance(mesh, Mesh):
        raise MeshdepictError(f"a {type(mesh).__name__} has no normals to smooth: give a Mesh")
    last = resolve_width(width, mesh)
    rungs = 1 + max(0, math.floor(2 * math.log2(last / mesh.edge_length) + 1e-9))
    first = last * math.sqrt(2) ** (1 - rungs)
    space = scale_space(
        mesh, scales=rungs, width=first, facing=facing, tolerance=tolerance, at_once=(rungs,)
    )
    return space.normals_at(space.last)
