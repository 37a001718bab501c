"""Samples of lobes aligned, and alignment undone: where light that stands in a lobe came from.

A step turns a light along the arc towards its guide, never past it or out of its side, and less the
nearer it is to the other side. So every step can be undone, and a lobe can be sampled where it is
after alignment: half vectors as ever, and the light of each looked up where it comes from.
"""

from __future__ import annotations

import math

import numpy as np

from meshdepict.shading.alignment_kernel import (
    arc_tangent,
    cosine,
    exactly_rotated,
    rotated,
    sine,
)
from meshdepict.threads import kernel

__all__ = ["align_samples", "guides", "undo"]

_ZERO, _ONE, _TWO = np.float32(0), np.float32(1), np.float32(2)
_HALF_PI = np.float32(math.pi / 2)
_TINY = np.float32(1e-30)
_LEAST = np.float32(1e-4)  # of angles and what is left of them: quotients stay finite


@kernel("contracted")
def guides(planes, scale, i, ex, ey, ez, guide, base):  # type: ignore[no-untyped-def]
    """Write the mirrored lines of sight of a scale and the next coarser one."""
    for to, at in ((guide, scale), (base, scale + 1)):
        n0, n1, n2 = planes[at, 0, i], planes[at, 1, i], planes[at, 2, i]
        d = _TWO * (n0 * ex + n1 * ey + n2 * ez)
        to[0], to[1], to[2] = d * n0 - ex, d * n1 - ey, d * n2 - ez


@kernel("contracted")
def align_samples(g, m, strength, fade, exact, x, y, z):  # type: ignore[no-untyped-def]
    """Align samples with a guide g over a base m."""
    if exact:
        for k in range(len(x)):
            x[k], y[k], z[k] = exactly_rotated(
                g[0], g[1], g[2], m[0], m[1], m[2], strength, fade,
                np.float64(x[k]), np.float64(y[k]), np.float64(z[k]),
            )  # fmt: skip
        return
    g0, g1, g2, m0, m1, m2 = g[0], g[1], g[2], m[0], m[1], m[2]
    for k in range(len(x)):
        x[k], y[k], z[k] = rotated(g0, g1, g2, m0, m1, m2, strength, fade, x[k], y[k], z[k])


@kernel("contracted", inline=True)
def _kept(gx, tx, ty, confident, strength, fade, angle, s, co):  # type: ignore[no-untyped-def]
    """Return what a step leaves of an angle φ to the guide, 1 − σW, and the derivative of both."""
    across, aside = max(gx * co + tx * s, _ZERO), ty * s
    confidence = min(_ONE, confident * arc_tangent(across, aside))
    below = _ONE / max(fade * (_ONE - confidence) + confidence, _TINY)
    left = max(_ONE - strength * confidence * below, _LEAST)
    change = confident * ty * gx / max(across * across + aside * aside, _TINY)
    return left, left + angle * strength * fade * below * below * change


@kernel("contracted", inline=True)
def _nearer(gx, tx, ty, confident, strength, fade, angle, now, most):  # type: ignore[no-untyped-def]
    """Return a better angle (Newton) of which the step leaves what there is now."""
    quarter = angle - _HALF_PI
    s, co = cosine(quarter), -sine(quarter)
    left, slope = _kept(gx, tx, ty, confident, strength, fade, angle, s, co)
    return min(max(angle - (angle * left - now) / slope, now), most)


@kernel("contracted", inline=True)
def _angle(sin, cos):  # type: ignore[no-untyped-def]
    """Return an angle of [0, π] by its sine and cosine, or multiples of both."""
    acute = arc_tangent(sin, abs(cos))
    return acute if cos >= _ZERO else _HALF_PI + _HALF_PI - acute


@kernel("contracted", inline=True)
def _begun(confidence, strength, fade, now, most):  # type: ignore[no-untyped-def]
    """Return what the angle was if the confidence falls evenly on the way to the other side."""
    falls = confidence / max(most - now, _LEAST)
    keen = (_ONE - fade) * falls
    p, q = keen - strength * falls, fade + keen * most
    half = (fade + p * most + now * keen) * np.float32(0.5)
    root = math.sqrt(max(half * half - p * now * q, _ZERO))
    return min(max(now * q / max(half + root, _TINY), now), most)


@kernel("contracted")
def undo(n, z, strength, fade, x, y, w, solid, value):  # type: ignore[no-untyped-def]
    """Turn lights back to where they were before a step; solid angles and values with them.

    Parameters
    ----------
    n, z : (3,) arrays
        The guides of the step's finer and coarser scale.
    strength, fade : float
        σ and e^−γ.
    x, y, w : (k,) arrays
        Lights.
    solid, value : (k,) arrays
        Both are multiplied by how much larger a solid angle was before.
    """
    n0, n1, n2, z0, z1, z2 = n[0], n[1], n[2], z[0], z[1], z[2]
    c = n0 * z0 + n1 * z1 + n2 * z2
    w0, w1, w2 = z1 * n2 - z2 * n1, z2 * n0 - z0 * n2, z0 * n1 - z1 * n0
    x0, x1, x2 = n0 - c * z0, n1 - c * z1, n2 - c * z2
    length = math.sqrt(w0 * w0 + w1 * w1 + w2 * w2)
    if not length > np.float32(1e-6):
        return
    dark, confident = _ONE / length, length / _HALF_PI
    for k in range(len(x)):
        m0, m1, m2 = x[k], y[k], w[k]
        bright = m0 * x0 + m1 * x1 + m2 * x2 >= _ZERO
        side = _ONE if bright else -_ONE
        g0 = n0 if bright else (z0 - c * n0) * dark
        g1 = n1 if bright else (z1 - c * n1) * dark
        g2 = n2 if bright else (z2 - c * n2) * dark
        cos = g0 * m0 + g1 * m1 + g2 * m2
        t0, t1, t2 = m0 - cos * g0, m1 - cos * g1, m2 - cos * g2
        sin = math.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
        scaled = _ONE / np.float32(sin if sin > _TINY else _TINY)
        t0, t1, t2 = t0 * scaled, t1 * scaled, t2 * scaled
        # On the arc from the guide, n_x l·x = gx cos φ + tx sin φ, n_x l·y = ty sin φ.
        gx = side * (g0 * x0 + g1 * x1 + g2 * x2)
        tx = side * (t0 * x0 + t1 * x1 + t2 * x2)
        ty = abs(t0 * w0 + t1 * w1 + t2 * w2)
        now, most = _angle(sin, cos), _angle(max(gx, _ZERO), -tx)
        sided = bright or c > _ZERO
        confidence = min(_ONE, confident * arc_tangent(max(gx * cos + tx * sin, _ZERO), ty * sin))
        angle = _begun(confidence, strength, fade, now, most)
        angle = _nearer(gx, tx, ty, confident, strength, fade, angle, now, most)
        angle = _nearer(gx, tx, ty, confident, strength, fade, angle, now, most)
        quarter = angle - _HALF_PI
        s, co = cosine(quarter), -sine(quarter)
        left, slope = _kept(gx, tx, ty, confident, strength, fade, angle, s, co)
        larger = (s * scaled if sin > _LEAST else _ONE / left) / slope
        turns = sided and sin > _TINY
        x[k] = co * g0 + s * t0 if turns else m0
        y[k] = co * g1 + s * t1 if turns else m1
        w[k] = co * g2 + s * t2 if turns else m2
        larger = larger if sided else _ONE
        solid[k] *= larger
        value[k] *= larger
