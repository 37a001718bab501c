"""Local Light Alignment's chain of rotations, compiled: S − 1 of them per sample and light.

Angles are computed by polynomials: the arc tangent's error is below 3e-7 rad, sine and cosine are
within 1e-7, float32 rounding not counted. A light that is turned wrongly by that much is wrong by
a ten-thousandth of a grey level.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.shading.sharpness import SINGLE
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["align_chain", "arc_tangent", "cosine", "exactly_rotated", "rotated", "sine"]

_BLOCK = 256  # samples whose lights stay in the fastest cache
_ONE, _ZERO = np.float32(1), np.float32(0)
_TINY = np.float32(1e-30)  # keeps quotients finite; its square root is still a normal number
_SINGULAR = np.float32(1e-6)  # METHODS: ‖l̄‖/√(‖l̄‖² + 10⁻⁶)
_HALF_PI = np.float32(math.pi / 2)

# Minimax fits: atan x / x on [0, 1] and sin x / x, cos x on [0, π/2], in powers of x².
_ATAN = tuple(
    np.float32(c)
    for c in (0.999996112, -0.33317368, 0.198078153, -0.132333412, 0.0796236577, -0.0336042086,
              0.00681178956)
)  # fmt: skip
_SIN = tuple(
    np.float32(c)
    for c in (0.999999977, -0.166666476, 0.00833289982, -0.000198008978, 2.5904885e-06)
)
_COS = tuple(
    np.float32(c) for c in (0.999999953, -0.499999053, 0.0416635847, -0.00138537043, 2.31539316e-05)
)


@kernel("contracted", inline=True)
def arc_tangent(y, x):  # type: ignore[no-untyped-def]
    """Return atan2(y, x) for y, x ≥ 0 in float32, in [0, π/2]; 0 for (0, 0)."""
    t = min(y, x) / max(max(y, x), _TINY)
    s = t * t
    p = _ATAN[5] + s * _ATAN[6]
    p = _ATAN[3] + s * (_ATAN[4] + s * p)
    p = t * (_ATAN[0] + s * (_ATAN[1] + s * (_ATAN[2] + s * p)))
    return _HALF_PI - p if y > x else p


@kernel("contracted", inline=True)
def sine(x):  # type: ignore[no-untyped-def]
    """Return sin x in float32 for |x| ≤ π/2."""
    s = x * x
    return x * (_SIN[0] + s * (_SIN[1] + s * (_SIN[2] + s * (_SIN[3] + s * _SIN[4]))))


@kernel("contracted", inline=True)
def cosine(x):  # type: ignore[no-untyped-def]
    """Return cos x in float32 for |x| ≤ π/2."""
    s = x * x
    return _COS[0] + s * (_COS[1] + s * (_COS[2] + s * (_COS[3] + s * _COS[4])))


def align_chain(
    planes: NDArray[np.float32],
    light: NDArray[np.float64],
    strengths: NDArray[np.float64],
    sharpness: float,
) -> NDArray[np.float32]:
    """Turn a light at every sample, from the coarsest pair of scales to the finest.

    Parameters
    ----------
    planes : (S, 3, n) array of float32
        What the light is aligned with at every scale, fine to coarse: normals, or reflected or
        transmitted view vectors. Zero vectors where there is none: those scales are skipped.
    light : (3,) array
        Unit vector.
    strengths : (S − 1,) array
        Finest first.
    sharpness : float
        γ.

    Returns
    -------
    (3, n) array of float32
    """
    count = planes.shape[2]
    exact = sharpness > SINGLE
    lights = np.empty((3, count), np.float64 if exact else np.float32)
    lights[:] = light.astype(np.float32)[:, None]
    strengths = strengths.astype(lights.dtype)
    fade = lights.dtype.type(math.exp(-sharpness))
    work = _exact_chain if exact else _chain
    pieces = thread_count() if count > 5_000 else 1
    each(lambda a, b: work(planes, strengths, fade, lights, a, b), spans(count, pieces))
    return lights.astype(np.float32, copy=False)


@kernel("contracted")
def _chain(planes, strengths, fade, lights, begin, end):  # type: ignore[no-untyped-def]
    for start in range(begin, end, _BLOCK):
        stop = min(_BLOCK, end - start) + start
        for scale in range(len(strengths) - 1, -1, -1):
            if strengths[scale] > _ZERO:
                _rotate(
                    planes[scale, 0, start:stop], planes[scale, 1, start:stop],
                    planes[scale, 2, start:stop], planes[scale + 1, 0, start:stop],
                    planes[scale + 1, 1, start:stop], planes[scale + 1, 2, start:stop],
                    strengths[scale], fade,
                    lights[0, start:stop], lights[1, start:stop], lights[2, start:stop],
                )  # fmt: skip


@kernel("contracted")
def _rotate(nx, ny, nz, zx, zy, zz, strength, fade, lx, ly, lz):  # type: ignore[no-untyped-def]
    """Do `light_alignment.align` in place; without branches the loop runs in vector registers."""
    for i in range(len(lx)):
        lx[i], ly[i], lz[i] = rotated(
            nx[i], ny[i], nz[i], zx[i], zy[i], zz[i], strength, fade, lx[i], ly[i], lz[i]
        )


@kernel("contracted", inline=True)
def guided(n0, n1, n2, z0, z1, z2, l0, l1, l2):  # type: ignore[no-untyped-def]
    """Return the guide of a light, and what its confidence is made of.

    That is n_x |l·x|, n_x |l·y|, ‖l̄‖/√(‖l̄‖² + 10⁻⁶), n_x, and whether the side has a guide.
    """
    c = n0 * z0 + n1 * z1 + n2 * z2  # n_z in the local frame
    # z × n: its length is n_x, and with l it gives n_x l·y.
    w0, w1, w2 = z1 * n2 - z2 * n1, z2 * n0 - z0 * n2, z0 * n1 - z1 * n0
    length = math.sqrt(w0 * w0 + w1 * w1 + w2 * w2)
    along_z = l0 * z0 + l1 * z1 + l2 * z2
    along_x = (l0 * n0 + l1 * n1 + l2 * n2) - along_z * c  # n_x l·x
    along_y = l0 * w0 + l1 * w1 + l2 * w2
    bright = along_x >= _ZERO
    # Guide: n, or (z − n_z n) / n_x, which is −n_z x + n_x z.
    g0 = n0 if bright else z0 - c * n0
    g1 = n1 if bright else z1 - c * n1
    g2 = n2 if bright else z2 - c * n2
    scaled = _ONE / math.sqrt(max(g0 * g0 + g1 * g1 + g2 * g2, _TINY))
    # Confidence: 0 too where guide or base is missing, because then w and length are.
    q0, q1, q2 = l1 * z2 - l2 * z1, l2 * z0 - l0 * z2, l0 * z1 - l1 * z0
    level = q0 * q0 + q1 * q1 + q2 * q2
    level = math.sqrt(level / (level + _SINGULAR))
    sided = bright or c > _ZERO
    return g0 * scaled, g1 * scaled, g2 * scaled, abs(along_x), abs(along_y), level, length, sided


@kernel("contracted", inline=True)
def rotated(n0, n1, n2, z0, z1, z2, strength, fade, l0, l1, l2):  # type: ignore[no-untyped-def]
    """Return what `light_alignment.align` does, in single precision."""
    g0, g1, g2, x, y, level, length, sided = guided(n0, n1, n2, z0, z1, z2, l0, l1, l2)
    first = arc_tangent(x, y) / _HALF_PI
    first = first * level if sided else _ZERO
    confidence = min(_ONE, max(_ZERO, first * length))
    weight = confidence / max(fade * (_ONE - confidence) + confidence, _TINY)
    cos = g0 * l0 + g1 * l1 + g2 * l2
    t0, t1, t2 = g0 - cos * l0, g1 - cos * l1, g2 - cos * l2
    sin = math.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
    acute = arc_tangent(sin, abs(cos))
    angle = acute if cos >= _ZERO else _HALF_PI + _HALF_PI - acute
    turn = strength * weight * angle - _HALF_PI
    a, b = -sine(turn), cosine(turn) / max(sin, _TINY)  # cos θ, sin θ / ‖t‖
    return a * l0 + b * t0, a * l1 + b * t1, a * l2 + b * t2


@kernel("contracted", inline=True)
def exactly_rotated(n0, n1, n2, z0, z1, z2, strength, fade, l0, l1, l2):  # type: ignore[no-untyped-def]
    """Return the same in double precision, without polynomials, of any guide and base."""
    n0, n1, n2 = np.float64(n0), np.float64(n1), np.float64(n2)
    z0, z1, z2 = np.float64(z0), np.float64(z1), np.float64(z2)
    g0, g1, g2, x, y, level, length, sided = guided(n0, n1, n2, z0, z1, z2, l0, l1, l2)
    confidence = min(1.0, math.atan2(x, y) * (2 / math.pi) * level * length) if sided else 0.0
    weight = confidence / max(fade * (1 - confidence) + confidence, 1e-300)
    cos = g0 * l0 + g1 * l1 + g2 * l2
    t0, t1, t2 = g0 - cos * l0, g1 - cos * l1, g2 - cos * l2
    sin = math.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
    turn = strength * weight * math.atan2(sin, cos)
    a, b = math.cos(turn), math.sin(turn) / max(sin, 1e-300)
    return a * l0 + b * t0, a * l1 + b * t1, a * l2 + b * t2


@kernel("contracted")
def _exact_chain(planes, strengths, fade, lights, begin, end):  # type: ignore[no-untyped-def]
    for i in range(begin, end):
        l0, l1, l2 = lights[0, i], lights[1, i], lights[2, i]
        for scale in range(len(strengths) - 1, -1, -1):
            if strengths[scale] > 0:
                l0, l1, l2 = exactly_rotated(
                    planes[scale, 0, i], planes[scale, 1, i], planes[scale, 2, i],
                    planes[scale + 1, 0, i], planes[scale + 1, 1, i], planes[scale + 1, 2, i],
                    strengths[scale], fade, l0, l1, l2,
                )  # fmt: skip
        lights[0, i], lights[1, i], lights[2, i] = l0, l1, l2
