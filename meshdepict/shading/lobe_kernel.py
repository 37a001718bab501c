"""Lobes sampled at every point, each sample looking up an environment that is blurred to fit it."""

from __future__ import annotations

import math

import numpy as np

from meshdepict.shading.alignment_kernel import arc_tangent, exactly_rotated, rotated
from meshdepict.shading.material_kernel import FAINT, specular
from meshdepict.shading.scaling_kernel import MOST_EXPONENT, factors
from meshdepict.shading.warping_kernel import stretch, turned
from meshdepict.threads import kernel

__all__ = ["sum_lobes"]

_ZERO, _HALF, _ONE, _TWO = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2)
_TINY = np.float32(1e-30)
_PI = np.float32(math.pi)
_MOST_PARTS = 8


@kernel("reordered", inline=True)
def _pixel(texels, start, rows, columns, x, y, z):  # type: ignore[no-untyped-def]
    """Return the four pixels round a direction of the picture's frame, and the shares between."""
    azimuth = arc_tangent(abs(x), abs(z))  # from −z or z, whichever is nearer
    azimuth = azimuth if z <= _ZERO else _PI - azimuth
    azimuth = azimuth if x >= _ZERO else -azimuth
    polar = arc_tangent(math.sqrt(x * x + z * z), abs(y))
    polar = polar if y >= _ZERO else _PI - polar
    column = (azimuth / _PI * _HALF + _HALF) * columns - _HALF
    row = polar / _PI * rows - _HALF
    c0, r0 = math.floor(column), math.floor(row)
    right, lower = np.float32(column - c0), np.float32(row - r0)
    c1 = c0 + 1
    c0 = c0 if c0 >= 0 else columns - 1
    c1 = c1 if c1 < columns else 0
    upper = start + max(r0, 0) * columns
    under = start + min(r0 + 1, rows - 1) * columns
    return upper + c0, upper + c1, under + c0, under + c1, right, lower


@kernel("reordered")
def sum_lobes(  # type: ignore[no-untyped-def]
    planes, eyes, kind, parameters, halves, ku, kv, u, v, z, numbers, strengths, fade, exact,
    cosines, solids, turns, texels, starts, rows, columns, upright, widest, out, begin, end,
):  # fmt: skip
    """Add Σ_k ρ_s scaling L(A⁻¹(W(l_k))) dl_k / π to `out` (n, 3), k running over the samples.

    Parameters
    ----------
    planes : (S, 3, n) array
        Normals; with strengths (S − 1,) those of every scale, for Local Light Alignment.
    halves : bool
        Whether samples are half vectors.
    numbers : (5,) array
        Warping and scaling, as `many_lights_kernel.sum_lights` has them.
    upright : (3, 3) array
        From the world to the picture.
    widest : float
        Variance of the widest blur over a sample's solid angle times what the blur is to be of it.
    """
    bins, count = cosines.shape
    warping, anisotropy = numbers[0], numbers[4]
    curved = len(ku) > 0
    framed = curved and (warping != _ZERO or anisotropy != _ZERO)
    scaled = curved and numbers[2] != _ZERO
    aligned = len(strengths) > 0
    finest = len(starts) - 1
    local, arriving = np.empty((3, count), np.float32), np.empty((3, count), np.float32)
    cosine, weight = np.empty(count, np.float32), np.empty(count, np.float32)
    term, delta = np.empty(count, np.float32), np.empty(count, np.float32)
    factor = np.ones(count, np.float32)
    turn, to_picture = np.empty((3, 3), np.float32), upright.copy()
    faint = FAINT + min(MOST_EXPONENT, numbers[2]) if scaled else FAINT
    row, mean, slant, convexity = 0, _ZERO, _ZERO, _ZERO
    scale_u, scale_v = _ONE, _ONE
    for i in range(begin, end):
        nx, ny, nz = planes[0, 0, i], planes[0, 1, i], planes[0, 2, i]
        j = i if eyes.shape[1] > 1 else 0
        ex, ey, ez = eyes[0, j], eyes[1, j], eyes[2, j]
        if framed:
            turn[0], turn[1], turn[2] = u[i], v[i], z[i]
            nx, ny, nz = turned(turn, nx, ny, nz)
            ex, ey, ez = turned(turn, ex, ey, ez)
            scale_u, scale_v = stretch(warping * ku[i]), stretch(warping * kv[i])
            for a in range(3):
                for b in range(3):
                    to_picture[a, b] = (
                        upright[a, 0] * turn[b, 0]
                        + upright[a, 1] * turn[b, 1]
                        + upright[a, 2] * turn[b, 2]
                    )
        away = min(nx * ex + ny * ey + nz * ez, _ZERO) * _TWO
        ex, ey, ez = ex - away * nx, ey - away * ny, ez - away * nz
        ne = nx * ex + ny * ey + nz * ez
        if scaled:
            mean = ku[i] + kv[i]
            slant = anisotropy * (ku[i] - kv[i])
            convexity = np.float32(-math.tanh(mean))
            row = int((convexity * _HALF + _HALF) * (bins - 1) + _HALF)
        # The lobe's frame: its axis, and across it the plane of sight.
        if halves:
            ax, ay, az, bx, by, bz = nx, ny, nz, ex, ey, ez
        else:
            ax, ay, az = _TWO * ne * nx - ex, _TWO * ne * ny - ey, _TWO * ne * nz - ez
            bx, by, bz = nx, ny, nz
        along = ax * bx + ay * by + az * bz
        bx, by, bz = bx - along * ax, by - along * ay, bz - along * az
        if bx * bx + by * by + bz * bz < np.float32(1e-10):  # seen head-on: any will do
            bx, by, bz = (_ZERO, -az, ay) if abs(ax) < _HALF else (az, _ZERO, -ax)
        size = _ONE / math.sqrt(max(bx * bx + by * by + bz * bz, _TINY))
        bx, by, bz = bx * size, by * size, bz * size
        cx, cy, cz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for k in range(count):
            c = cosines[row, k]
            s = math.sqrt(max(_ONE - c * c, _ZERO))
            p, q = s * turns[0, k], s * turns[1, k]
            x = p * bx + q * cx + c * ax
            y = p * by + q * cy + c * ay
            w = p * bz + q * cz + c * az
            solid = solids[row, k]
            if halves:
                seen = max(ex * x + ey * y + ez * w, _ZERO)
                x, y, w = _TWO * seen * x - ex, _TWO * seen * y - ey, _TWO * seen * w - ez
                solid *= np.float32(4) * seen  # of the direction over that of the half vector
            local[0, k], local[1, k], local[2, k] = x, y, w
            arriving[0, k], arriving[1, k], arriving[2, k] = x, y, w
            weight[k] = solid
        for scale in range(len(strengths) - 1, -1, -1):
            if strengths[scale] <= 0:
                continue
            # The mirrored lines of sight of two scales: guide and base.
            n0, n1, n2 = planes[scale, 0, i], planes[scale, 1, i], planes[scale, 2, i]
            m0, m1, m2 = planes[scale + 1, 0, i], planes[scale + 1, 1, i], planes[scale + 1, 2, i]
            d = _TWO * (n0 * ex + n1 * ey + n2 * ez)
            g0, g1, g2 = d * n0 - ex, d * n1 - ey, d * n2 - ez
            d = _TWO * (m0 * ex + m1 * ey + m2 * ez)
            m0, m1, m2 = d * m0 - ex, d * m1 - ey, d * m2 - ez
            if exact:
                for k in range(count):
                    local[0, k], local[1, k], local[2, k] = exactly_rotated(
                        g0, g1, g2, m0, m1, m2, strengths[scale], fade,
                        np.float64(local[0, k]), np.float64(local[1, k]), np.float64(local[2, k]),
                    )  # fmt: skip
            else:
                for k in range(count):
                    local[0, k], local[1, k], local[2, k] = rotated(
                        g0, g1, g2, m0, m1, m2, strengths[scale], fade,
                        local[0, k], local[1, k], local[2, k],
                    )  # fmt: skip
        for k in range(count):
            cosine[k] = nx * local[0, k] + ny * local[1, k] + nz * local[2, k]
        specular(kind, parameters, faint, local, cosine, nx, ny, nz, ex, ey, ez, ne, term, delta)
        if scaled:
            factors(numbers[2], numbers[3], convexity, mean, slant, local, term, delta, factor)
        red, green, blue = _ZERO, _ZERO, _ZERO
        for k in range(count):
            value = term[k] * factor[k] * weight[k]
            if value <= _ZERO or (aligned and cosine[k] <= _ZERO):
                continue
            lx, ly, lz = arriving[0, k], arriving[1, k], arriving[2, k]
            solid, parts, step = weight[k], 1, _ZERO
            dx, dy, dz = _ZERO, _ZERO, _ZERO
            if halves:
                # Seen at grazing angles a round cell of half vectors is a long one of directions,
                # 1 by e·h: as many places along it are looked up as make each of them round.
                hx, hy, hz = lx + ex, ly + ey, lz + ez
                seen = _HALF * math.sqrt(hx * hx + hy * hy + hz * hz)
                parts = min(int(_ONE / max(seen, _TINY) + _HALF), _MOST_PARTS)
                if parts > 1:
                    step = np.float32(math.sqrt(solid / max(seen, _TINY)) / parts)
                    back = hx * lx + hy * ly + hz * lz
                    dx, dy, dz = hx - back * lx, hy - back * ly, hz - back * lz
                    size = step / math.sqrt(max(dx * dx + dy * dy + dz * dz, _TINY))
                    dx, dy, dz = dx * size, dy * size, dz * size
                    solid, value = solid / parts, value / parts
            for part in range(parts):
                shift = np.float32(part) - _HALF * np.float32(parts - 1)
                x, y, w = lx + shift * dx, ly + shift * dy, lz + shift * dz
                if parts > 1:
                    size = _ONE / math.sqrt(x * x + y * y + w * w)
                    x, y, w = x * size, y * size, w * size
                    if nx * x + ny * y + nz * w <= _ZERO:
                        continue
                own = solid
                if warping != _ZERO:
                    # W(l); nothing unless both lie in the hemisphere of n, as eq. 1 is settled.
                    far = (x * x + y * y) / (_ONE - min(w, _ZERO))
                    q = far if w < _ZERO else _ONE + w
                    p, r = scale_u * x, scale_v * y
                    t = _TWO * q / max(q * q + p * p + r * r, _TINY)
                    x, y, w = t * p, t * r, t * q - _ONE
                    if min(cosine[k], nx * x + ny * y + nz * w) <= _ZERO:
                        continue
                    own *= t * t * scale_u * scale_v
                level = int(math.log2(max(widest / max(own, _TINY), _ONE)) + _HALF)
                level = min(level, finest)
                x, y, w = turned(to_picture, x, y, w)
                a, b, c, d, right, lower = _pixel(
                    texels, starts[level], rows[level], columns[level], x, y, w
                )
                one, two = (_ONE - lower) * (_ONE - right), (_ONE - lower) * right
                three, four = lower * (_ONE - right), lower * right
                red += value * (
                    one * texels[a, 0] + two * texels[b, 0]
                    + three * texels[c, 0] + four * texels[d, 0]
                )  # fmt: skip
                green += value * (
                    one * texels[a, 1] + two * texels[b, 1]
                    + three * texels[c, 1] + four * texels[d, 1]
                )  # fmt: skip
                blue += value * (
                    one * texels[a, 2] + two * texels[b, 2]
                    + three * texels[c, 2] + four * texels[d, 2]
                )  # fmt: skip
        out[i, 0], out[i, 1], out[i, 2] = red / _PI, green / _PI, blue / _PI
