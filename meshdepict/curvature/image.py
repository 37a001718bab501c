"""Curvature at the pixels of a picture, from its normals (Light Warping, alg. 1).

Derivatives are Sobel's divided by 8, over the pixels of a 3×3 window that show the same surface:
where all do, the filter itself; at a mask's border and at steps of depth what is left of it,
one-sided. Normals that a pixel's neighbours have are looked at in the pixel's own frame (in a
perspective view each has another, and a flat wall is flat).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.curvature.tensor import _principal, tangent
from meshdepict.curvature.view import _STEEPEST
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["largest_steps", "least_cosines", "sobel_hessian", "sobel_principal"]

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Index = NDArray[np.int32]


def largest_steps(index: Index, depth: Floats) -> Floats:
    """Return for each sample how far the depth jumps to a neighbour, of eight: (n,).

    Parameters
    ----------
    index : (h + 2, w + 2) array of int32
        The sample at each pixel, −1 where there is none, −2 in a frame round the picture.
    depth : (n,) array

    Returns
    -------
    (n,) array
        Infinite where a neighbour within the picture shows no surface.
    """
    found = np.empty(len(depth))
    _by_rows(index, _steps, depth, found)
    return found


def least_cosines(index: Index, normals: Singles) -> Singles:
    """Return for each sample the least cosine between its normal and a neighbour's, of eight.

    Parameters
    ----------
    index : as for `largest_steps`
    normals : (3, n) array of float32
    """
    found = np.empty(normals.shape[1], np.float32)
    _by_rows(index, _cosines, normals, found)
    return found


def sobel_hessian(
    index: Index,
    normals: Singles,
    depth: Floats,
    frames: Floats,
    *,
    steepest: float,
    foreshortening: float = 1.0,
) -> Floats:
    """Return H_xx, H_xy, H_yy per pixel, (3, n): the gradient of the slope, symmetrised.

    Parameters
    ----------
    index : as for `largest_steps`
    normals : (3, n) array of float32
        In world space.
    depth : (n,) array
        In pixels.
    frames : (n, 3, 3) array
        Rows right, up and to the eye at each sample.
    steepest : float
        Neighbours that are further away than this, in pixels of depth, are of another surface.
    foreshortening : float
        f of the slope (−n_x, −n_y)/n_z^f.
    """
    found = np.empty((3, len(depth)))
    _by_rows(
        index, _hessians, normals, depth, frames, float(steepest), float(foreshortening), found
    )
    return found


def sobel_principal(
    index: Index,
    normals: Singles,
    depth: Floats,
    towards: Floats,
    right: Floats,
    up: Floats,
    *,
    steepest: float,
) -> tuple[Floats, Singles]:
    """Return principal curvatures (2, n), per pixel, and directions (2, n, 3).

    What lies above a step to the next pixel is a step along the surface, and how the normal turns
    over it is the shape operator's.

    Parameters
    ----------
    index, normals, depth, steepest
        As for `sobel_hessian`.
    towards : (n, 3) array
        Unit vectors to the eye.
    right, up : (3,) array
        Of the picture.
    """
    count = len(depth)
    k, d = np.empty((2, count)), np.empty((2, count, 3), np.float32)
    _by_rows(index, _operators, normals, depth, towards, right, up, float(steepest), k, d)
    return k, d


def _by_rows(index: Index, kernel: Callable[..., None], *arguments: float | NDArray[Any]) -> None:
    rows = len(index) - 2
    pieces = thread_count() if index.size > 10_000 else 1
    each(lambda a, b: kernel(index, a + 1, b + 1, *arguments), spans(rows, pieces))


@kernel()
def _steps(index, first, last, depth, found):  # type: ignore[no-untyped-def]
    for row in range(first, last):
        for column in range(1, index.shape[1] - 1):
            p = index[row, column]
            if p < 0:
                continue
            largest = 0.0
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    q = index[row + dy, column + dx]
                    if q >= 0:
                        largest = max(largest, abs(depth[q] - depth[p]))
                    elif q == -1:
                        largest = np.inf
            found[p] = largest


@kernel()
def _cosines(index, first, last, normals, found):  # type: ignore[no-untyped-def]
    for row in range(first, last):
        for column in range(1, index.shape[1] - 1):
            p = index[row, column]
            if p < 0:
                continue
            least = np.float32(1)
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    q = index[row + dy, column + dx]
                    if q >= 0:
                        least = min(
                            least,
                            normals[0, p] * normals[0, q]
                            + normals[1, p] * normals[1, q]
                            + normals[2, p] * normals[2, q],
                        )
            found[p] = least


@kernel()
def _in_frame(normals, q, frame):  # type: ignore[no-untyped-def]
    x, y, z = normals[0, q], normals[1, q], normals[2, q]
    return (
        x * frame[0, 0] + y * frame[0, 1] + z * frame[0, 2],
        x * frame[1, 0] + y * frame[1, 1] + z * frame[1, 2],
        x * frame[2, 0] + y * frame[2, 1] + z * frame[2, 2],
    )


@kernel()
def _hessians(index, first, last, normals, depth, frames, steepest, f, found):  # type: ignore[no-untyped-def]
    for row in range(first, last):
        for column in range(1, index.shape[1] - 1):
            p = index[row, column]
            if p < 0:
                continue
            frame = frames[p]
            nx, ny, nz = _in_frame(normals, p, frame)
            fall = max(nz, _STEEPEST) ** -f
            own_x, own_y = -nx * fall, -ny * fall
            # Least squares for each of the two directions: Σ w d Δg / Σ w d², w = 1, 2, 1.
            xx = xy = yx = yy = 0.0
            sum_x = sum_y = 0
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    q = index[row - dy, column + dx]  # rows run downwards
                    if q < 0 or q == p or abs(depth[q] - depth[p]) > steepest:
                        continue
                    nx, ny, nz = _in_frame(normals, q, frame)
                    fall = max(nz, _STEEPEST) ** -f
                    gx, gy = -nx * fall - own_x, -ny * fall - own_y
                    wx, wy = dx * (2 - abs(dy)), dy * (2 - abs(dx))
                    xx, xy = xx + wx * gx, xy + wx * gy
                    yx, yy = yx + wy * gx, yy + wy * gy
                    sum_x, sum_y = sum_x + abs(wx), sum_y + abs(wy)
            across, along = 1.0 / max(sum_x, 1), 1.0 / max(sum_y, 1)
            found[0, p], found[2, p] = xx * across, yy * along
            found[1, p] = (xy * across + yx * along) / 2


@kernel()
def _operators(index, first, last, normals, depth, towards, right, up, steepest, k, d):  # type: ignore[no-untyped-def]
    sums = np.empty(4)
    for row in range(first, last):
        for column in range(1, index.shape[1] - 1):
            p = index[row, column]
            if p < 0:
                continue
            nx, ny, nz = float(normals[0, p]), float(normals[1, p]), float(normals[2, p])
            ux, uy, uz = tangent(nx, ny, nz)
            vx, vy, vz = ny * uz - nz * uy, nz * ux - nx * uz, nx * uy - ny * ux
            # How the normal changes over a pixel, in the tangent frame (u, v).
            xu = xv = yu = yv = 0.0
            sum_x = sum_y = 0
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    q = index[row - dy, column + dx]  # rows run downwards
                    if q < 0 or q == p or abs(depth[q] - depth[p]) > steepest:
                        continue
                    mx, my, mz = normals[0, q] - nx, normals[1, q] - ny, normals[2, q] - nz
                    mu, mv = mx * ux + my * uy + mz * uz, mx * vx + my * vy + mz * vz
                    wx, wy = dx * (2 - abs(dy)), dy * (2 - abs(dx))
                    xu, xv, yu, yv = xu + wx * mu, xv + wx * mv, yu + wy * mu, yv + wy * mv
                    sum_x, sum_y = sum_x + abs(wx), sum_y + abs(wy)
            across, along = 1.0 / max(sum_x, 1), 1.0 / max(sum_y, 1)
            xu, xv, yu, yv = xu * across, xv * across, yu * along, yv * along
            # The steps along the surface above those pixels: e − z (e·n)/(z·n), in (u, v).
            zx, zy, zz = towards[p, 0], towards[p, 1], towards[p, 2]
            facing = zx * nx + zy * ny + zz * nz
            facing = math.copysign(max(abs(facing), _STEEPEST), facing)
            zu, zv = (zx * ux + zy * uy + zz * uz) / facing, (zx * vx + zy * vy + zz * vz) / facing
            fall = right[0] * nx + right[1] * ny + right[2] * nz
            au = right[0] * ux + right[1] * uy + right[2] * uz - fall * zu
            av = right[0] * vx + right[1] * vy + right[2] * vz - fall * zv
            fall = up[0] * nx + up[1] * ny + up[2] * nz
            bu = up[0] * ux + up[1] * uy + up[2] * uz - fall * zu
            bv = up[0] * vx + up[1] * vy + up[2] * vz - fall * zv
            # (a, b)ᵀ S = (Δx, Δy)ᵀ; a pixel's shadow on the surface is never smaller than it.
            area = au * bv - av * bu
            area = math.copysign(max(abs(area), 1.0), area)
            sums[0] = (bv * xu - av * yu) / area
            sums[1] = (bv * xv - av * yv - bu * xu + au * yu) / (2 * area)
            sums[2] = (au * yv - bu * xv) / area
            sums[3] = 1.0
            _principal(nx, ny, nz, sums, p, k, d)
