"""View-centred curvature: how the depth seen by the eye bends, per pixel (Light Warping, §4).

In view space (x right, y up, z to the eye) a surface with normal n has the slope
g = (−n_x, −n_y)/n_z^f, and its Hessian H = ∇g tells convex from concave as the eye sees it. On a
mesh neither image nor differences are needed: H follows from the shape operator S by

    H = −n_z^−f [ II + ½ (f − 1)(p pᵀ II + II p pᵀ) ],   II_ab = t_a·S t_b,   p = (n_x, n_y),

with t_x = (1, 0, −n_x/n_z) and t_y = (0, 1, −n_y/n_z), what lies above a step in the picture.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.curvature.frames import halved_angle
from meshdepict.curvature.principal import PrincipalCurvatures
from meshdepict.errors import MeshdepictError
from meshdepict.threads import each, spans

if TYPE_CHECKING:
    from meshdepict.scene.view import View

__all__ = ["ViewCurvature", "conductance", "eye_frames", "view_hessian", "view_tensor"]

Floats = NDArray[np.float64]
Pair = tuple[Floats, Floats]

_STEEPEST = 0.01  # n_z is held at this where the surface turns away from the eye
_BLOCK = 1 << 14  # points at a time: their temporaries stay in the cache


class ViewCurvature(NamedTuple):
    """Curvature of the depth seen by an eye, per pixel, concave positive.

    Attributes
    ----------
    ku, kv : (n,) array of float64
        Eigenvalues of H, ``|ku| ≥ |kv|``, not blended by the weight. A bump towards the eye has
        negative ones.
    u, v : (n, 3) array of float32
        Their directions, unit vectors in world space, perpendicular to the line of sight z:
        (u, v, z) is right-handed.
    weight : (n,) array of float32
        0 on silhouettes and creases, where H means nothing, 1 elsewhere; see `conductance`.
    """

    ku: NDArray[np.float64]
    kv: NDArray[np.float64]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    weight: NDArray[np.float32]

    @property
    def mean(self) -> NDArray[np.float64]:
        """(ku + kv)/2."""
        return (self.ku + self.kv) / 2


def view_tensor(
    points: Floats,
    normals: ArrayLike,
    curvatures: PrincipalCurvatures,
    turns: ArrayLike,
    view: View,
    *,
    foreshortening: float = 1.0,
) -> ViewCurvature:
    """Return the curvature seen by a view at points of a surface.

    Parameters
    ----------
    points : (n, 3) array
        World positions.
    normals : (n, 3) array_like
        Unit normals at the wanted width.
    curvatures : PrincipalCurvatures
        At that width.
    turns : (n,) array_like
        The least cosine between a normal and its neighbours'; see `creases.neighbour_cosines`.
    view : View
    foreshortening : float
        f: 1 in Light Warping, 0.4 in Radiance Scaling's released shader.

    Raises
    ------
    MeshdepictError
        For a foreshortening that is not in 0 … 10.
    """
    if not 0 <= foreshortening <= 10:
        raise MeshdepictError(f"foreshortening={foreshortening!r} is not a number from 0 to 10")
    count = len(points)
    normals, turns = np.asarray(normals), np.asarray(turns)
    k, uv = np.empty((2, count)), np.empty((2, count, 3), np.float32)
    weight = np.empty(count, np.float32)

    def block(begin: int, end: int) -> None:
        part = slice(begin, end)
        k1, k2, d1, d2 = curvatures
        some = PrincipalCurvatures(k1[part], k2[part], d1[part], d2[part])
        frame, pixel = eye_frames(points[part], view)
        n = normals[part].astype(np.float64)
        hessian = view_hessian(n, some, frame, pixel, foreshortening=foreshortening)
        (ku, kv), (cosine, sine) = eigenvalues(*hessian)
        x, y, z = frame
        k[0, part], k[1, part] = ku, kv
        uv[0, part] = cosine[:, None] * x + sine[:, None] * y
        uv[1, part] = cosine[:, None] * y - sine[:, None] * x
        weight[part] = conductance((n * z).sum(axis=1), turns[part])

    each(block, spans(count, -(-count // _BLOCK)))
    return ViewCurvature(k[0], k[1], uv[0], uv[1], weight)


def eye_frames(points: Floats, view: View) -> tuple[tuple[Floats, Floats, Floats], Floats]:
    """Return right, up and the direction to the eye at each point, and the size of a pixel there.

    Parameters
    ----------
    points : (n, 3) array

    Returns
    -------
    x, y, z : three (n, 3) arrays
        In a perspective view z points to the eye, and x and y are the view's own, turned as its
        axis is turned onto z.
    pixel : (n,) array
        In world units; 0 at and behind the eye.
    """
    right, up, axis = view.frame
    if view.parallel_scale is not None:
        x, y, z = (np.broadcast_to(row, points.shape) for row in (right, up, axis))
        return (x, y, z), np.full(len(points), 2 * view.parallel_scale / view.height_px)
    assert view.field_of_view is not None  # every view has the one or the other
    towards = view.position - points
    step = 2 * math.tan(math.radians(view.field_of_view) / 2) / view.height_px
    pixel = step * np.maximum(towards @ axis, 0)
    length = np.linalg.norm(towards, axis=1, keepdims=True)
    # At the eye itself any direction will do; the view's axis stays finite.
    z = np.where(length > 0, towards / np.where(length > 0, length, 1.0), axis)
    cosine = z @ axis
    behind = cosine < -1 + 1e-6  # there the shortest turn is not one: a half turn about x
    share = (z + axis) / np.where(behind, 1.0, 1 + cosine)[:, None]
    x = np.where(behind[:, None], right, right - share * (z @ right)[:, None])
    y = np.where(behind[:, None], -up, up - share * (z @ up)[:, None])
    return (x, y, np.where(behind[:, None], -axis, z)), pixel


def view_hessian(
    normals: Floats,
    curvatures: PrincipalCurvatures,
    frame: tuple[Floats, Floats, Floats],
    pixel: Floats,
    *,
    foreshortening: float = 1.0,
) -> tuple[Floats, Floats, Floats]:
    """Return H_xx, H_xy, H_yy per pixel, each (n,): the equation at the top of this file.

    Parameters
    ----------
    normals : (n, 3) array
    curvatures : PrincipalCurvatures
    frame : three (n, 3) arrays
        Right, up and towards the eye.
    pixel : (n,) array
        Size of a pixel in world units at each point.
    foreshortening : float
    """
    x, y, z = frame
    f = foreshortening
    px, py = _dot(normals, x), _dot(normals, y)
    nz = np.maximum(_dot(normals, z), _STEEPEST)
    xx = xy = yy = np.zeros(len(normals))
    for k, d in ((curvatures.k1, curvatures.d1), (curvatures.k2, curvatures.d2)):
        depth = _dot(d, z) / nz
        tx, ty = _dot(d, x) - px * depth, _dot(d, y) - py * depth  # t_x·d and t_y·d
        bend = k * pixel
        xx, xy, yy = xx + bend * tx * tx, xy + bend * tx * ty, yy + bend * ty * ty
    half = (f - 1) / 2
    extra_xx = 2 * px * (px * xx + py * xy)
    extra_xy = px * (px * xy + py * yy) + py * (px * xx + py * xy)
    extra_yy = 2 * py * (px * xy + py * yy)
    scale = -(nz**-f)
    return (
        scale * (xx + half * extra_xx),
        scale * (xy + half * extra_xy),
        scale * (yy + half * extra_yy),
    )


def conductance(facing: ArrayLike, turns: ArrayLike) -> Floats:
    """Return 1 − max(w_s, w_c): how far a surface is from silhouettes and creases.

    Parameters
    ----------
    facing : array_like
        n·e; silhouettes are where it is below 0.2.
    turns : array_like
        Cosine of the largest angle between a normal and its neighbours'; 30° begins a crease,
        60° is one.
    """
    silhouette = 1 - smoothstep(np.asarray(facing) / 0.2)
    angle = np.degrees(np.arccos(np.clip(turns, -1, 1)))
    return 1 - np.maximum(silhouette, smoothstep((angle - 30) / 30))


def smoothstep(t: Floats) -> Floats:
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)


def _dot(a: NDArray[np.floating], b: Floats) -> Floats:
    return np.einsum("ij,ij->i", a, b, dtype=np.float64)


def eigenvalues(xx: Floats, xy: Floats, yy: Floats) -> tuple[Pair, Pair]:
    """Return the eigenvalues of 2×2 matrices, larger magnitude first, and that one's direction."""
    mean, half = (xx + yy) / 2, (xx - yy) / 2
    radius = np.hypot(half, xy)
    cosine, sine = halved_angle(half, xy)
    negative = mean < 0  # the smaller eigenvalue is larger in magnitude
    radius = np.where(negative, -radius, radius)
    cosine, sine = np.where(negative, -sine, cosine), np.where(negative, cosine, sine)
    return (mean + radius, mean - radius), (cosine, sine)
