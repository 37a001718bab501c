"""Visibility: which triangle each pixel of a view sees, and how far away.

Rays through the pixels' centres, triangle by triangle: for each one, the rays within its bounding
box in the picture. With a triangle's corners written as (P, Q, W), so that a corner shows at pixel
(P/W, Q/W), the ray of pixel (i, j) meets it where the three determinants

    w_a = (b − (i, j) b_W) × (c − (i, j) c_W)   and round

have one sign; they are the barycentric coordinates but for a factor. That holds for parallel views
(W = 1) and perspective ones (W = depth), needs no clipping at the eye, and leaves no gap between
neighbours: swapping b and c only changes the sign. Double precision throughout, no fused
operations: the same pixels on every machine. A tree of boxes, which rays of other kinds need,
takes longer to build than all this.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.images.pixels import step
from meshdepict.threads import each, kernel, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.scene.view import View
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Visible", "projected", "visible_surface"]

Floats = NDArray[np.float64]

_SLACK = 1e-6  # pixels round a bounding box: more than rounding does to a quotient


class Visible(NamedTuple):
    """What the pixels of a view see of a mesh.

    Attributes
    ----------
    mask : (height, width) array of bool
        Which see any of it; the others are of these n, row by row.
    triangle : (n,) array of int32
        The nearest one in front of the eye; of triangles equally near the first.
    barycentric : (n, 3) array
        Where in it.
    depth : (n,) array
        Along the view's axis, in world units.
    """

    mask: NDArray[np.bool_]
    triangle: NDArray[np.int32]
    barycentric: Floats
    depth: Floats


def visible_surface(mesh: Mesh, view: View, width: int) -> Visible:
    """Return what the pixels of a picture, ``width`` wide and ``view.height_px`` high, see."""
    corners, depth = projected(mesh, view, width)
    nearest = np.full((view.height_px, width), math.inf)
    triangle = np.full(nearest.shape, -1, np.int32)
    # Every thread looks at all triangles and owns a band of rows.
    pieces = thread_count() if len(mesh.faces) + nearest.size > 20_000 else 1
    each(
        lambda a, b: _band(corners, depth, mesh.faces, a, b, nearest, triangle),
        spans(view.height_px, pieces),
    )
    mask = triangle >= 0
    seen = triangle[mask]
    rows, columns = np.nonzero(mask)
    # The three determinants once more, for the triangles that are seen.
    a, b, c = (
        (corners[v, 0] - columns * corners[v, 2], corners[v, 1] - rows * corners[v, 2])
        for v in mesh.faces[seen].T
    )
    shares = np.stack([p[0] * q[1] - p[1] * q[0] for p, q in ((b, c), (c, a), (a, b))], axis=1)
    shares /= shares.sum(axis=1, keepdims=True)
    return Visible(mask, seen, shares, nearest[mask] * (mesh.diagonal or 1.0))


@kernel()
def _band(corners, depth, faces, first, last, nearest, triangle):  # type: ignore[no-untyped-def]
    """Fill the rows [first, last)."""
    width = nearest.shape[1]
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        za, zb, zc = depth[a], depth[b], depth[c]
        if za <= 0 and zb <= 0 and zc <= 0:
            continue
        ap, aq, aw = corners[a, 0], corners[a, 1], corners[a, 2]
        bp, bq, bw = corners[b, 0], corners[b, 1], corners[b, 2]
        cp, cq, cw = corners[c, 0], corners[c, 1], corners[c, 2]
        left, right, top, bottom = 0, width - 1, first, last - 1
        if aw > 0 and bw > 0 and cw > 0:
            pa, pb, pc = ap / aw, bp / bw, cp / cw
            qa, qb, qc = aq / aw, bq / bw, cq / cw
            left = _within(math.ceil(min(pa, pb, pc) - _SLACK), 0, width)
            right = _within(math.floor(max(pa, pb, pc) + _SLACK), -1, width - 1)
            top = _within(math.ceil(min(qa, qb, qc) - _SLACK), first, last)
            bottom = _within(math.floor(max(qa, qb, qc) + _SLACK), first - 1, last - 1)
        elif (  # through the plane of the eye: it may show anywhere unless it is all on one side
            max(ap + aw, bp + bw, cp + cw) < 0
            or max(aq + aw, bq + bw, cq + cw) < 0
            or min(ap - width * aw, bp - width * bw, cp - width * cw) > 0
            or min(aq - last * aw, bq - last * bw, cq - last * cw) > 0
        ):
            continue
        for row in range(top, bottom + 1):
            y = float(row)
            ay, by, cy = aq - y * aw, bq - y * bw, cq - y * cw
            for column in range(left, right + 1):
                x = float(column)
                ax, bx, cx = ap - x * aw, bp - x * bw, cp - x * cw
                wa, wb, wc = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
                if (wa >= 0 and wb >= 0 and wc >= 0) or (wa <= 0 and wb <= 0 and wc <= 0):
                    total = wa + wb + wc
                    if total != 0:
                        z = (wa * za + wb * zb + wc * zc) / total
                        if 0 < z < nearest[row, column]:
                            nearest[row, column] = z
                            triangle[row, column] = f


@kernel()
def _within(value, low, high):  # type: ignore[no-untyped-def]
    """Return a whole number held between bounds; any number may come in."""
    return int(low) if not value > low else int(high) if value >= high else int(value)


def projected(mesh: Mesh, view: View, width: int) -> tuple[Floats, Floats]:
    """Return a mesh's vertices in a picture, and their depths in diagonals of the mesh.

    Returns
    -------
    corners : (n, 3) array
        As (P, Q, W), shown at column P/W and row Q/W: W is 1 in a parallel view and the depth in a
        perspective one.
    depth : (n,) array
        Along the view's axis, positive in front of the eye.
    """
    unit = mesh.diagonal or 1.0
    x, y, z = view.frame @ (mesh.unit_points - mesh.recentred(view.position)).T
    depth = -z
    if view.parallel_scale is None:
        weight, pixel = depth, step(view)
    else:
        weight, pixel = np.ones_like(depth), 2 * (view.parallel_scale / unit) / view.height_px
    columns = x / pixel + (width / 2 - 0.5) * weight
    rows = (view.height_px / 2 - 0.5) * weight - y / pixel
    return np.stack([columns, rows, weight], axis=1), depth
