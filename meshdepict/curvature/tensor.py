"""Curvature from normals: how they change over each face, averaged to the vertices.

S. Rusinkiewicz, *Estimating Curvatures and Their Derivatives on Triangle Meshes*, 3DPVT 2004. On a
face the shape operator is the symmetric S that comes closest to S e = Δn over its three edges e,
Δn being the difference of the normals at the ends of e. Each vertex turns the S of its faces into
its own tangent plane and averages them with its Voronoi shares of their areas.

Everything is in double precision: on fine meshes Δn is a small difference of large numbers.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from meshdepict.curvature.welded import welded
from meshdepict.mesh import Mesh
from meshdepict.threads import each, spans, thread_count

__all__ = ["tensor_curvatures"]

_COMPILED = {"nogil": True, "cache": True, "error_model": "numpy", "fastmath": {"contract"}}

# A triangle lower than this share of its longest side lies within the rounding of float32
# coordinates: its plane says nothing.
_FLAT = 1e-7


def tensor_curvatures(mesh: Mesh, normals: NDArray[np.float64]):
    faces, first, group = welded(mesh)
    points = mesh._unit_points[first]
    normals = normals[first]
    count = len(points)
    k = np.empty((2, count))
    d = np.empty((2, count, 3), np.float32)
    pieces = spans(count, thread_count() if count > 10_000 else 1)
    each(lambda a, b: _curvatures(points, normals, faces, 1 / (mesh.diagonal or 1.0), a, b, k, d), pieces)
    if group is not None:
        k, d = k[:, group], d[:, group]
    return k[0], k[1], d[0], d[1]


@njit(**_COMPILED)
def _frame(x, y, z):  # type: ignore[no-untyped-def]
    sign = math.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return 1.0 + sign * x * x * a, sign * b, -sign * x, b, sign + y * y * a, -y


@njit(**_COMPILED)
def _curvatures(points, normals, faces, scale, begin, end, k, d):
    sums = np.zeros((end - begin, 4))
    w = np.empty(3)
    for f in range(len(faces)):
        ia, ib, ic = faces[f, 0], faces[f, 1], faces[f, 2]
        if not (begin <= ia < end or begin <= ib < end or begin <= ic < end):
            continue
        px, py, pz = points[ib, 0] - points[ia, 0], points[ib, 1] - points[ia, 1], points[ib, 2] - points[ia, 2]
        qx, qy, qz = points[ic, 0] - points[ia, 0], points[ic, 1] - points[ia, 1], points[ic, 2] - points[ia, 2]
        mx, my, mz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
        double = math.sqrt(mx * mx + my * my + mz * mz)
        pp = px * px + py * py + pz * pz
        qq = qx * qx + qy * qy + qz * qz
        pq = px * qx + py * qy + pz * qz
        rr = pp + qq - 2 * pq
        if double <= _FLAT * max(pp, qq, rr):
            continue
        i = 1.0 / double
        mx, my, mz = mx * i, my * i, mz * i
        p = math.sqrt(pp)
        i = 1.0 / p
        tx, ty, tz = px * i, py * i, pz * i
        sx, sy, sz = my * tz - mz * ty, mz * tx - mx * tz, mx * ty - my * tx
        q1, q2 = pq * i, double * i
        r1 = q1 - p
        # normal differences along p, q and r = q − p
        dx, dy, dz = normals[ib, 0] - normals[ia, 0], normals[ib, 1] - normals[ia, 1], normals[ib, 2] - normals[ia, 2]
        dp1, dp2 = dx * tx + dy * ty + dz * tz, dx * sx + dy * sy + dz * sz
        dx, dy, dz = normals[ic, 0] - normals[ia, 0], normals[ic, 1] - normals[ia, 1], normals[ic, 2] - normals[ia, 2]
        dq1, dq2 = dx * tx + dy * ty + dz * tz, dx * sx + dy * sy + dz * sz
        dr1, dr2 = dq1 - dp1, dq2 - dp2
        # least squares: S M + M S = R
        a, b, c = 2 * q2 * q2, -q2 * (q1 + r1), pp + q1 * q1 + r1 * r1  # adj M
        r11 = 2 * (p * dp1 + q1 * dq1 + r1 * dr1)
        r12 = p * dp2 + q1 * dq2 + r1 * dr2 + q2 * (dq1 + dr1)
        r22 = 2 * q2 * (dq2 + dr2)
        det = 3 * double * double
        i = 1 / (2 * (a + c) * det)
        s11 = (det * r11 + a * a * r11 + 2 * a * b * r12 + b * b * r22) * i
        s12 = (det * r12 + a * b * r11 + (a * c + b * b) * r12 + b * c * r22) * i
        s22 = (det * r22 + b * b * r11 + 2 * b * c * r12 + c * c * r22) * i
        # Voronoi shares
        qr, pr = qq - pq, pp - pq  # dots at c and b
        if pq < 0 or qr < 0 or pr < 0:
            w[0] = double * (0.25 if pq < 0 else 0.125)
            w[1] = double * (0.25 if pr < 0 else 0.125)
            w[2] = double * (0.25 if qr < 0 else 0.125)
        else:
            i = 0.125 / double
            w[0] = (pp * qr + qq * pr) * i
            w[1] = (pp * qr + rr * pq) * i
            w[2] = (qq * pr + rr * pq) * i
        for corner in range(3):
            v = faces[f, corner]
            if begin <= v < end:
                x, y, z = normals[v, 0], normals[v, 1], normals[v, 2]
                ux, uy, uz, vx, vy, vz = _frame(x, y, z)
                nm = x * mx + y * my + z * mz
                sign = math.copysign(1.0, nm)
                g = sign * (ux * mx + uy * my + uz * mz) / (1.0 + sign * nm)
                co = ux * tx + uy * ty + uz * tz - g * (x * tx + y * ty + z * tz)
                si = ux * sx + uy * sy + uz * sz - g * (x * sx + y * sy + z * sz)
                cc, ss, cs, wi = co * co, si * si, co * si, w[corner]
                row = v - begin
                sums[row, 0] += wi * (cc * s11 + 2 * cs * s12 + ss * s22)
                sums[row, 1] += wi * sign * (cs * (s22 - s11) + (cc - ss) * s12)
                sums[row, 2] += wi * (ss * s11 - 2 * cs * s12 + cc * s22)
                sums[row, 3] += wi
    for v in range(begin, end):
        ux, uy, uz, vx, vy, vz = _frame(normals[v, 0], normals[v, 1], normals[v, 2])
        row = v - begin
        total = sums[row, 3]
        i = 1.0 / total if total > 0 else 0.0
        a, b, c = sums[row, 0] * i, sums[row, 1] * i, sums[row, 2] * i
        h, e = (a + c) / 2, (a - c) / 2
        r = math.sqrt(e * e + b * b)
        co, si = (e + r, b) if e >= 0 else (b, r - e)
        length = math.sqrt(co * co + si * si)
        if length > 0:
            co, si = co / length, si / length
        else:
            co, si = 1.0, 0.0
        if h < 0:
            r = -r
            co, si = -si, co
        k[0, v], k[1, v] = (h + r) * scale, (h - r) * scale
        d[0, v, 0], d[0, v, 1], d[0, v, 2] = co * ux + si * vx, co * uy + si * vy, co * uz + si * vz
        d[1, v, 0], d[1, v, 1], d[1, v, 2] = co * vx - si * ux, co * vy - si * uy, co * vz - si * uz
