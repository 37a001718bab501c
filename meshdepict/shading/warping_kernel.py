"""Light Warping at one point, compiled: lights in its frame, unwarped or looked up.

`meshdepict.shading.warp_equations` are the same formulas for arrays.
"""

from __future__ import annotations

import math

import numpy as np

from meshdepict.threads import kernel

__all__ = ["lights_at", "look_up", "stretch", "turned", "unwarp", "warp_rays"]

_ZERO, _HALF, _ONE, _TWO = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2)
_TINY = np.float32(1e-30)
_SIXTH = np.float32(1 / 6)


@kernel("contracted", inline=True)
def turned(turn, x, y, z):  # type: ignore[no-untyped-def]
    """Return a vector in the frame whose axes are the rows of `turn`."""
    return (
        turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z,
        turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z,
        turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z,
    )


@kernel("contracted")
def lights_at(world, turn, local):  # type: ignore[no-untyped-def]
    """Write all lights (3, k) in the frame, not warped."""
    for a in range(3):
        x, y, z = turn[a, 0], turn[a, 1], turn[a, 2]
        for k in range(world.shape[1]):
            local[a, k] = x * world[0, k] + y * world[1, k] + z * world[2, k]


@kernel("contracted")
def stretch(product):  # type: ignore[no-untyped-def]
    """Return `warp_equations.warp_scale`."""
    tangent = np.float32(math.tan(math.atan(product) * _SIXTH))
    return (_ONE + tangent) / (_ONE - tangent)


@kernel("contracted")
def unwarp(world, turn, scale_u, scale_v, nx, ny, nz, local, weight):  # type: ignore[no-untyped-def]
    """Write W⁻¹(l') and J, zero unless both directions lie in the hemisphere of n (eq. 2)."""
    a, b = _ONE / scale_u, _ONE / scale_v
    pole = (scale_u * scale_u + scale_v * scale_v) * _HALF
    ux, uy, uz = turn[0, 0], turn[0, 1], turn[0, 2]
    vx, vy, vz = turn[1, 0], turn[1, 1], turn[1, 2]
    wx, wy, wz = turn[2, 0], turn[2, 1], turn[2, 2]
    for k in range(world.shape[1]):
        x, y, z = world[0, k], world[1, k], world[2, k]
        lu = ux * x + uy * y + uz * z
        lv = vx * x + vy * y + vz * z
        lz = wx * x + wy * y + wz * z
        far = (lu * lu + lv * lv) / (_ONE - min(lz, _ZERO))
        q = far if lz < _ZERO else _ONE + lz
        p, r = a * lu, b * lv
        t = _TWO * q / max(q * q + p * p + r * r, _TINY)
        back_u, back_v, back_z = t * p, t * r, t * q - _ONE
        jacobian = t * t * a * b if t > _ZERO else pole
        before = nx * lu + ny * lv + nz * lz
        after = nx * back_u + ny * back_v + nz * back_z
        local[0, k], local[1, k], local[2, k] = back_u, back_v, back_z
        weight[k] = jacobian if min(before, after) > _ZERO else _ZERO


@kernel("contracted")
def look_up(environment, local, turn, scale_u, scale_v, nx, ny, nz, weight, colors, radiance):  # type: ignore[no-untyped-def]
    """Write L(W(l)), zero unless both directions lie in the hemisphere of n (eq. 1)."""
    height, width, channels = environment.shape
    for k in range(local.shape[1]):
        lu, lv, lz = local[0, k], local[1, k], local[2, k]
        q = _ONE + lz if lz >= _ZERO else (lu * lu + lv * lv) / (_ONE - lz)
        p, r = scale_u * lu, scale_v * lv
        t = _TWO * q / max(q * q + p * p + r * r, _TINY)
        x, y, z = t * p, t * r, t * q - _ONE
        both = min(nx * lu + ny * lv + nz * lz, nx * x + ny * y + nz * z) > _ZERO
        weight[k] = _ONE if both else _ZERO
        if not both:
            continue
        gx = turn[0, 0] * x + turn[1, 0] * y + turn[2, 0] * z
        gy = turn[0, 1] * x + turn[1, 1] * y + turn[2, 1] * z
        gz = turn[0, 2] * x + turn[1, 2] * y + turn[2, 2] * z
        column = (math.atan2(gx, -gz) / (2 * math.pi) + 0.5) * width - 0.5
        row = math.acos(max(-1.0, min(1.0, gy))) / math.pi * height - 0.5
        c0, r0 = math.floor(column), math.floor(row)
        fc, fr = np.float32(column - c0), np.float32(row - r0)
        left, right = int(c0) % width, (int(c0) + 1) % width
        upper, lower = max(int(r0), 0), min(int(r0) + 1, height - 1)
        for c in range(channels):
            top = (_ONE - fc) * environment[upper, left, c] + fc * environment[upper, right, c]
            base = (_ONE - fc) * environment[lower, left, c] + fc * environment[lower, right, c]
            radiance[k, c] = colors[k, c] * ((_ONE - fr) * top + fr * base)


@kernel("contracted")
def warp_rays(directions, which, u, v, z, scale_u, scale_v):  # type: ignore[no-untyped-def]
    """Turn the directions d (k, rays, 3) in the world of the points `which` (k,) to W(d)."""
    for i in range(len(which)):
        at = which[i]
        a, b = scale_u[at], scale_v[at]
        ux, uy, uz = u[at, 0], u[at, 1], u[at, 2]
        vx, vy, vz = v[at, 0], v[at, 1], v[at, 2]
        wx, wy, wz = z[at, 0], z[at, 1], z[at, 2]
        for k in range(directions.shape[1]):
            x, y, d = directions[i, k, 0], directions[i, k, 1], directions[i, k, 2]
            lu = ux * x + uy * y + uz * d
            lv = vx * x + vy * y + vz * d
            lz = wx * x + wy * y + wz * d
            far = (lu * lu + lv * lv) / (_ONE - min(lz, _ZERO))
            q = far if lz < _ZERO else _ONE + lz
            p, r = a * lu, b * lv
            t = _TWO * q / max(q * q + p * p + r * r, _TINY)
            p, r, q = t * p, t * r, t * q - _ONE
            directions[i, k, 0] = ux * p + vx * r + wx * q
            directions[i, k, 1] = uy * p + vy * r + wy * q
            directions[i, k, 2] = uz * p + vz * r + wz * q
