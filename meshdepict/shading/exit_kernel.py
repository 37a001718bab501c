"""Light that comes into glass by a rough wall, as a ray within meets it (Walter et al. 2007).

The facets are those of `transmission`; radiance within is counted as outside: what it gains on the
way in, refraction², it loses on the way out.
"""

from __future__ import annotations

import math

import numpy as np

from meshdepict.threads import kernel

__all__ = ["exit_lobe", "sum_exits"]

_ZERO, _ONE, _TWO = np.float32(0), np.float32(1), np.float32(2)


@kernel("contracted", inline=True)
def _unhidden(cosine, a2):  # type: ignore[no-untyped-def]
    """Return the share of facets not hidden in one direction (eq. 34)."""
    squared = min(max(cosine * cosine, np.float32(1e-12)), _ONE)
    return _TWO / (_ONE + math.sqrt(_ONE + a2 * (_ONE - squared) / squared))


@kernel("contracted")
def exit_lobe(dx, dy, dz, nx, ny, nz, lx, ly, lz, refraction, a2):  # type: ignore[no-untyped-def]
    """Return f_t(l, −d) |n·l| / η² (eq. 21): d within and l outside, n between them outward."""
    nd, nl = nx * dx + ny * dy + nz * dz, nx * lx + ny * ly + nz * lz
    if nd <= _ZERO or nl <= _ZERO:
        return _ZERO
    hx, hy, hz = refraction * dx - lx, refraction * dy - ly, refraction * dz - lz
    squared = hx * hx + hy * hy + hz * hz
    if squared < np.float32(1e-12):  # no refraction, and straight through: no facet turns it
        return _ZERO
    size = _ONE / math.sqrt(squared)
    nh = (nx * hx + ny * hy + nz * hz) * size
    dh = (dx * hx + dy * hy + dz * hz) * size
    lh = (lx * hx + ly * hy + lz * hz) * size
    if nh <= _ZERO or dh <= _ZERO or lh <= _ZERO:
        return _ZERO
    c2 = min(nh * nh, _ONE)
    steep = c2 * (_ONE - a2)
    facets = a2 / np.float32(math.pi) * c2 * (_TWO - steep) / ((_ONE - steep) * (_ONE - steep))
    lh = min(lh, _ONE)
    g = math.sqrt(refraction * refraction - _ONE + lh * lh)
    less = (g - lh) / (g + lh)
    more = (lh * (g + lh) - _ONE) / (lh * (g - lh) + _ONE)
    let_in = _ONE - less * less * (_ONE + more * more) / _TWO
    seen = _unhidden(nd, a2) * _unhidden(nl, a2)
    return lh * dh / max(nd, np.float32(1e-6)) * let_in * seen * facets / squared


@kernel("contracted")
def sum_exits(ray, arriving, normal, weight, lights, refraction, a2, rays, out):  # type: ignore[no-untyped-def]
    """Add up the lobes of walls, each times its weight, for the light of the ray's sample."""
    for j in range(len(ray)):
        if weight[j] > np.float32(1e-5):
            i = ray[j] // rays
            out[i] += weight[j] * exit_lobe(
                arriving[j, 0], arriving[j, 1], arriving[j, 2], normal[j, 0], normal[j, 1],
                normal[j, 2], lights[0, i], lights[1, i], lights[2, i], refraction, a2[j],
            )  # fmt: skip
