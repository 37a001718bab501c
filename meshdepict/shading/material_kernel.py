"""Materials' terms for many lights at one point, compiled.

`meshdepict.scene.material` are the same formulas for arrays.
"""

from __future__ import annotations

import math

import numpy as np

from meshdepict.shading.material_kinds import (
    ASHIKHMIN_SHIRLEY,
    COOK_TORRANCE,
    HALF_LAMBERT,
    PHONG,
    SUB_LAMBERT,
)
from meshdepict.threads import kernel

__all__ = ["FAINT", "diffuse", "specular", "specular_of_halves"]

FAINT = np.float32(20)  # e^−20 is a millionth of a grey level

_ZERO, _HALF, _ONE, _TWO = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2)
_TINY = np.float32(1e-30)
_GRAZING = np.float32(1e-4)  # material.GRAZING


@kernel("contracted")
def _fifth(x):  # type: ignore[no-untyped-def]
    return x * x * (x * x) * x


@kernel("contracted")
def diffuse(kind, parameters, cosine, ne, term, delta):  # type: ignore[no-untyped-def]
    """Write `material.diffuse_term` and its reflectance mapping δ."""
    share, reflectance, power = parameters[0], parameters[1], parameters[2]
    count = len(cosine)
    if kind == HALF_LAMBERT:
        for k in range(count):
            delta[k] = max(_ZERO, min(_ONE, _HALF + _HALF * cosine[k]))
    elif kind == SUB_LAMBERT:
        for k in range(count):
            delta[k] = min(_ONE, cosine[k]) ** power if cosine[k] > _ZERO else _ZERO
    else:
        for k in range(count):
            delta[k] = max(_ZERO, min(_ONE, cosine[k]))
    if kind == COOK_TORRANCE:
        rest = _ONE - reflectance
        share *= rest * rest * (_ONE - _fifth(_ONE - max(_ZERO, min(_ONE, ne))))
        for k in range(count):
            term[k] = share * (_ONE - _fifth(_ONE - delta[k])) * delta[k]
    elif kind == ASHIKHMIN_SHIRLEY:
        share *= np.float32(28 / 23) * (_ONE - reflectance)
        share *= _ONE - _fifth(_ONE - max(_ZERO, min(_ONE, ne)) * _HALF)
        for k in range(count):
            term[k] = share * (_ONE - _fifth(_ONE - delta[k] * _HALF)) * delta[k]
    else:
        for k in range(count):
            term[k] = share * delta[k]


@kernel("contracted")
def specular(kind, parameters, faint, local, cosine, nx, ny, nz, ex, ey, ez, ne, term, delta):  # type: ignore[no-untyped-def]
    """Write `material.specular_term` and its reflectance mapping δ.

    Powers below e^−faint are left out: `FAINT`, and the logarithm of what the term is multiplied
    by afterwards at most.
    """
    reflectance, power = parameters[1], parameters[2]
    least = np.float32(math.exp(-faint / max(power, _TINY)))
    count = len(cosine)
    if kind == PHONG:
        rx, ry, rz = _TWO * ne * nx - ex, _TWO * ne * ny - ey, _TWO * ne * nz - ez
        for k in range(count):
            delta[k] = min(_ONE, rx * local[0, k] + ry * local[1, k] + rz * local[2, k])
        for k in range(count):
            delta[k] = delta[k] ** power if delta[k] > least else _ZERO
            term[k] = reflectance * delta[k]
        return
    seen = max(ne, _GRAZING)
    for k in range(count):
        hx, hy, hz = local[0, k] + ex, local[1, k] + ey, local[2, k] + ez
        scaled = _ONE / math.sqrt(max(hx * hx + hy * hy + hz * hz, np.float32(1e-24)))
        nh = (nx * hx + ny * hy + nz * hz) * scaled
        delta[k] = max(_ZERO, min(_ONE, nh))
        term[k] = max((ex * hx + ey * hy + ez * hz) * scaled, _GRAZING)
    for k in range(count):
        nh, eh, nl = delta[k], term[k], min(_ONE, cosine[k])
        if nl <= _ZERO:
            term[k] = _ZERO
            continue
        mirror = reflectance + (_ONE - reflectance) * _fifth(_ONE - min(_ONE, eh))
        if kind == COOK_TORRANCE:
            slope, c2 = power * power, max(nh * nh, _GRAZING)
            facets = np.float32(math.exp((c2 - _ONE) / (c2 * slope))) / (slope * c2 * c2)
            lit = min(_ONE / seen, _TWO * nh / eh, _TWO * nh * nl / (eh * seen))
            term[k] = mirror * facets * lit * np.float32(0.25)
        else:
            lobe = (power + _ONE) * np.float32(0.125) * nh**power if nh > least else _ZERO
            term[k] = lobe * mirror * nl / (eh * max(nl, seen))


@kernel("contracted")
def specular_of_halves(kind, parameters, lobe, nh, seen_under, cosine, ne, term):  # type: ignore[no-untyped-def]
    """Write the same for half vectors whose n·h and e·h are known, and the lobe with them.

    The lobe is Beckmann's distribution, or Ashikhmin and Shirley's power with its factor.
    """
    reflectance = parameters[1]
    seen = max(ne, _GRAZING)
    for k in range(len(nh)):
        eh, nl = max(seen_under[k], _GRAZING), min(_ONE, cosine[k])
        mirror = reflectance + (_ONE - reflectance) * _fifth(_ONE - min(_ONE, eh))
        if kind == COOK_TORRANCE:
            lit = min(_ONE / seen, _TWO * nh[k] / eh, _TWO * nh[k] * nl / (eh * seen))
            lit *= np.float32(0.25)
        else:
            lit = nl / (eh * max(nl, seen))
        term[k] = mirror * lobe[k] * lit if nl > _ZERO else _ZERO
