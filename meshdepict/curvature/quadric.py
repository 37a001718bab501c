"""Curvature of a quadric fitted to the vertices within a radius of each vertex.

D. Panozzo, E. Puppo, L. Rocca, *Efficient Multi-scale Curvature and Crease Estimation*, 2010, the
method of libigl's ``principal_curvature``: gather what is connected within the radius, take the
mean of the normals there as the height axis, fit z = a u² + b uv + c v² + d u + e v by least
squares and read its curvature at the vertex.

libigl itself is the peer in the tests and not used here: it kills the process where normals cancel
(fins on an edge), needs vertices without faces taken out, counts its radius in whole mean edges,
and takes the fitted quadric's shape operator for symmetric, which it is not where (d, e) ≠ 0.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.frames import tangents
from meshdepict.curvature.tensor import tangent, tensor_curvatures
from meshdepict.curvature.welded import Welded
from meshdepict.errors import MeshdepictError
from meshdepict.threads import each, kernel, spans, thread_count

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["quadric_curvatures"]

Floats = NDArray[np.float64]


_DEFAULT_EDGES = 5.0  # libigl's default radius, in median edges here
_UNKNOWNS = 5
_ALL = 2.0  # a radius beyond the whole mesh, whose diagonal is one
_PROBED = 64  # vertices that tell how many lie within the radius of all
_MOST = 5e9  # vertices looked at in all: about a minute's work
_SINGULAR = 1e-12  # a pivot below this share of what it was: the points don't tell five unknowns


def quadric_curvatures(
    mesh: Mesh, radius: float | str | None
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return k1, k2, d1, d2 of the quadrics fitted within a radius along the surface.

    Where fewer than six vertices lie within it the radius is doubled until there are enough.
    Where there is no quadric (a part of fewer vertices, all on a line) the "tensor" estimate
    stands in.

    Parameters
    ----------
    mesh : Mesh
    radius : float or str, optional
        In world units, or "0.2%" of the diagonal; five median edges unless given.

    Raises
    ------
    MeshdepictError
        For a radius that is no length, and one within which too many vertices lie.
    """
    from meshdepict.shapes.lengths import resolve_width

    surface = Welded(mesh)
    unit = mesh.diagonal or 1.0
    wanted = (
        _DEFAULT_EDGES * mesh.edge_length
        if radius is None
        else resolve_width(radius, mesh, averages=False)
    )
    normals = surface.gathered(mesh.normals)
    normals.setflags(write=False)
    k, directions = _fitted(surface, normals, min(wanted / unit, _ALL / 2))
    failed = ~np.isfinite(k).all(axis=0)
    if failed.any():
        spare, (spare_directions, _) = tensor_curvatures(surface.points, surface.faces, normals)
        k[:, failed], directions[failed] = spare[:, failed], spare_directions[failed]
    d1 = _into_plane(directions, normals)
    k1, k2, d1, d2 = (surface.spread(part) for part in (*k / unit, d1, np.cross(normals, d1)))
    return k1, k2, d1, d2


def _fitted(surface: Welded, normals: Floats, radius: float) -> tuple[Floats, Floats]:
    """Return curvatures (2, w), NaN without fit, and the first one's directions (w, 3)."""
    faces, count = surface.proper_faces, len(surface.points)
    # The faces at vertex v are those of corners[start[v] : start[v + 1]].
    corners = np.argsort(faces.ravel(), kind="stable")
    start = np.concatenate(([0], np.cumsum(np.bincount(faces.ravel(), minlength=count))))
    some = np.arange(0, count, -(-count // _PROBED))
    mean = _mean_count(surface.points, faces, corners, start, radius, some)
    if mean * count > _MOST:
        raise MeshdepictError(
            f"a quadric through {mean:,.0f} vertices, as many as lie within the radius, at each of "
            f"{count:,} would take too long: take a smaller radius, or method='tensor'"
        )
    k, directions = np.full((2, count), np.nan), np.zeros((count, 3))

    def work(begin: int, end: int) -> None:
        _span(surface.points, normals, faces, corners, start, radius, begin, end, k, directions)

    each(work, spans(count, 4 * thread_count() if count > 2_000 else 1))
    return k, directions


@kernel()
def _mean_count(points, faces, corners, start, radius, some):  # type: ignore[no-untyped-def]
    """Return how many vertices lie within the radius of some of them, on the average."""
    seen = np.full(len(points), -1)
    ball = np.empty(len(points), np.int64)
    total = 0.0
    for i in range(len(some)):
        total += _gather(points, faces, corners, start, some[i], radius, i, seen, ball)
    return total / len(some)


@kernel()
def _span(points, normals, faces, corners, start, radius, begin, end, k, directions):  # type: ignore[no-untyped-def]
    """Fit the vertices [begin, end)."""
    seen = np.full(len(points), -1)
    ball = np.empty(len(points), np.int64)
    mark = 0
    for v in range(begin, end):
        if start[v] == start[v + 1]:
            continue
        reach, found = radius, 0
        while found <= _UNKNOWNS and reach < _ALL:
            mark += 1
            found = _gather(points, faces, corners, start, v, reach, mark, seen, ball)
            reach *= 2
        if found > _UNKNOWNS:
            _fit(points, normals, v, ball, found, reach / 2, k, directions)


@kernel()
def _gather(points, faces, corners, start, v, radius, mark, seen, ball):  # type: ignore[no-untyped-def]
    """List in ``ball`` what is connected to v through vertices within the radius; v comes first."""
    ball[0], found, at = v, 1, 0
    seen[v] = mark
    while at < found:
        for c in range(start[ball[at]], start[ball[at] + 1]):
            face = corners[c] // 3
            for corner in range(3):
                w = faces[face, corner]
                if seen[w] != mark:
                    seen[w] = mark
                    x = points[w, 0] - points[v, 0]
                    y = points[w, 1] - points[v, 1]
                    z = points[w, 2] - points[v, 2]
                    if x * x + y * y + z * z < radius * radius:
                        ball[found] = w
                        found += 1
        at += 1
    return found


@kernel()
def _fit(points, normals, v, ball, found, radius, k, directions):  # type: ignore[no-untyped-def]
    """Fit a quadric to ball[1 : found] about v; leave k as it is where that fails."""
    nx = ny = nz = 0.0
    for i in range(found):
        nx += normals[ball[i], 0]
        ny += normals[ball[i], 1]
        nz += normals[ball[i], 2]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if length < 1e-6 * found:
        return  # the normals cancel
    nx, ny, nz = nx / length, ny / length, nz / length
    ux, uy, uz = tangent(nx, ny, nz)
    vx, vy, vz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
    # Least squares in units of the radius: upper triangle of AᵀA, and Aᵀb as its last column.
    m = np.zeros((_UNKNOWNS, _UNKNOWNS + 1))
    row = np.empty(_UNKNOWNS + 1)
    for i in range(1, found):
        x = (points[ball[i], 0] - points[v, 0]) / radius
        y = (points[ball[i], 1] - points[v, 1]) / radius
        z = (points[ball[i], 2] - points[v, 2]) / radius
        p, q = x * ux + y * uy + z * uz, x * vx + y * vy + z * vz
        row[0], row[1], row[2], row[3], row[4] = p * p, p * q, q * q, p, q
        row[5] = x * nx + y * ny + z * nz
        for a in range(_UNKNOWNS):
            for b in range(a, _UNKNOWNS + 1):
                m[a, b] += row[a] * row[b]
    if not _solve(m):
        return
    _curvature(m[:, _UNKNOWNS], ux, uy, uz, vx, vy, vz, nx, ny, nz, radius, v, k, directions)


@kernel()
def _solve(m):  # type: ignore[no-untyped-def]
    """Solve a symmetric positive system given by its upper triangle and last column, in place."""
    for i in range(_UNKNOWNS):
        diagonal = m[i, i]
        for h in range(i):  # LDLᵀ: row h holds D_h in place of its unit diagonal
            m[i, i] -= m[h, i] * m[h, i] / m[h, h]
        if not m[i, i] > _SINGULAR * diagonal:
            return False
        for j in range(i + 1, _UNKNOWNS + 1):
            for h in range(i):
                m[i, j] -= m[h, i] * m[h, j] / m[h, h]
    for i in range(_UNKNOWNS - 1, -1, -1):
        for j in range(i + 1, _UNKNOWNS):
            m[i, _UNKNOWNS] -= m[i, j] * m[j, _UNKNOWNS]
        m[i, _UNKNOWNS] /= m[i, i]
    return True


@kernel()
def _curvature(quadric, ux, uy, uz, vx, vy, vz, nx, ny, nz, radius, i, k, directions):  # type: ignore[no-untyped-def]
    """Read the curvature, at the vertex, of a quadric over (u, v) with heights along n."""
    a, b, c, d, e = quadric
    # A tangent frame of the quadric: p along u, q across it, each as (step in u, step in v).
    p1 = 1.0 / math.sqrt(1.0 + d * d)
    root = math.sqrt(1.0 + d * d + e * e)
    q1, q2 = -d * e * p1 / root, (1.0 + d * d) * p1 / root
    # Its second fundamental form there, positive where it falls away from the normal.
    pp = -2 * a * p1 * p1 / root
    pq = -(2 * a * p1 * q1 + b * p1 * q2) / root
    qq = -(2 * a * q1 * q1 + 2 * b * q1 * q2 + 2 * c * q2 * q2) / root
    mean, half = (pp + qq) / 2, (pp - qq) / 2
    spread = math.sqrt(half * half + pq * pq)
    angle = math.atan2(pq, half) / 2
    if mean < 0:
        spread, angle = -spread, angle + math.pi / 2
    k[0, i], k[1, i] = (mean + spread) / radius, (mean - spread) / radius
    co, si = math.cos(angle), math.sin(angle)
    s, t = co * p1 + si * q1, si * q2
    h = d * s + e * t
    directions[i, 0] = s * ux + t * vx + h * nx
    directions[i, 1] = s * uy + t * vy + h * ny
    directions[i, 2] = s * uz + t * vz + h * nz


def _into_plane(directions: Floats, normals: Floats) -> Floats:
    """Return unit tangents: directions projected on the planes, any where nothing is left."""
    d = directions - normals * np.einsum("ij,ij->i", directions, normals)[:, None]
    length = np.linalg.norm(d, axis=1, keepdims=True)
    firm = length > 1e-6
    return np.where(firm, d / np.where(firm, length, 1.0), tangents(normals))
