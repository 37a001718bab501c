"""Lobes sampled at every point, each sample looking up an environment that is blurred to fit it."""

from __future__ import annotations

import math

import numpy as np

from meshdepict.shading.alignment_kernel import arc_tangent
from meshdepict.shading.lobe_alignment_kernel import align_samples, guides, undo
from meshdepict.shading.lobe_tables import MOST_PARTS, WIDE
from meshdepict.shading.material_kernel import FAINT, specular, specular_of_halves
from meshdepict.shading.scaling_kernel import MOST_EXPONENT, factors
from meshdepict.shading.warping_kernel import stretch, turned
from meshdepict.threads import kernel

__all__ = ["sum_lobes"]

_ZERO, _HALF, _ONE, _TWO = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2)
_TINY = np.float32(1e-30)
_PI = np.float32(math.pi)


@kernel("contracted", inline=True)
def _padded(count):  # type: ignore[no-untyped-def]
    return (count + WIDE - 1) // WIDE * WIDE


@kernel("contracted")
def _about(cosines, solids, turns, a, b, c, x, y, z, weight):  # type: ignore[no-untyped-def]
    """Write samples about an axis a, and the solid angles they stand for."""
    for k in range(len(cosines)):
        up = cosines[k]
        level = math.sqrt(max(_ONE - up * up, _ZERO))
        p, q = level * turns[0, k], level * turns[1, k]
        x[k] = p * b[0] + q * c[0] + up * a[0]
        y[k] = p * b[1] + q * c[1] + up * a[1]
        z[k] = p * b[2] + q * c[2] + up * a[2]
        weight[k] = solids[k]


@kernel("contracted")
def _mirrored(ex, ey, ez, ne, nh, x, y, z, weight, seen, cosine):  # type: ignore[no-untyped-def]
    """Turn half vectors into directions, and their solid angles with them; write e·h and n·l."""
    for k in range(len(x)):
        under = max(ex * x[k] + ey * y[k] + ez * z[k], _ZERO)
        twice = _TWO * under
        x[k], y[k], z[k] = twice * x[k] - ex, twice * y[k] - ey, twice * z[k] - ez
        weight[k] *= np.float32(4) * under
        seen[k] = under
        cosine[k] = twice * nh[k] - ne


@kernel("contracted")
def _parted(ex, ey, ez, nx, ny, nz, count, seen, x, y, z, solid, value):  # type: ignore[no-untyped-def]
    """Part what is seen at grazing angles; return how many there are then.

    There a round cell of half vectors is a long one of directions, 1 by e·h: as many places along
    it are looked up as make each of them round.
    """
    more = count
    for k in range(count):
        if seen[k] > _HALF:
            continue
        parts = min(int(_ONE / max(seen[k], _TINY)), MOST_PARTS)
        lx, ly, lz = x[k], y[k], z[k]
        back = ex * lx + ey * ly + ez * lz
        dx, dy, dz = ex - back * lx, ey - back * ly, ez - back * lz
        reach = math.sqrt(solid[k] / max(seen[k] * (_ONE - back * back), _TINY)) / parts
        dx, dy, dz = dx * reach, dy * reach, dz * reach
        share, own = value[k] / parts, solid[k] / parts
        for part in range(parts):
            shift = np.float32(part) - _HALF * np.float32(parts - 1)
            px, py, pz = lx + shift * dx, ly + shift * dy, lz + shift * dz
            size = _ONE / math.sqrt(px * px + py * py + pz * pz)
            px, py, pz = px * size, py * size, pz * size
            to = k if part == 0 else more
            more += part > 0
            x[to], y[to], z[to], solid[to] = px, py, pz, own
            value[to] = share if nx * px + ny * py + nz * pz > _ZERO else _ZERO
    return more


@kernel("contracted")
def _warped(scale_u, scale_v, nx, ny, nz, x, y, z, solid, value):  # type: ignore[no-untyped-def]
    """Warp directions; nothing counts unless both lie in the hemisphere of n (eq. 1)."""
    for k in range(len(x)):
        before = nx * x[k] + ny * y[k] + nz * z[k]
        far = (x[k] * x[k] + y[k] * y[k]) / (_ONE - min(z[k], _ZERO))
        q = far if z[k] < _ZERO else _ONE + z[k]
        p, r = scale_u * x[k], scale_v * y[k]
        t = _TWO * q / max(q * q + p * p + r * r, _TINY)
        x[k], y[k], z[k] = t * p, t * r, t * q - _ONE
        both = min(before, nx * x[k] + ny * y[k] + nz * z[k]) > _ZERO
        value[k] = value[k] if both else _ZERO
        solid[k] *= t * t * scale_u * scale_v


@kernel("contracted")
def _places(to_picture, x, y, z, solid, widest, starts, rows, columns, ratio, bits, place):  # type: ignore[no-untyped-def]
    """Write which texel of which copy each direction is to be looked up at."""
    _on_picture(to_picture, x, y, z)
    for k in range(len(x)):
        ratio[k] = widest / max(solid[k], _TINY)
    finest = np.int32(len(starts) - 1)
    for k in range(len(x)):
        # A float's exponent is the logarithm of its square: a level for every factor of 2.
        level = min(max((bits[k] >> np.int32(23)) - np.int32(127), np.int32(0)), finest)
        wide, high = columns[level], rows[level]
        column, row = np.int32(x[k] * np.float32(wide)), np.int32(y[k] * np.float32(high))
        column, row = min(column, wide - np.int32(1)), min(row, high - np.int32(1))
        place[k] = starts[level] + row * wide + column


@kernel("contracted")
def _on_picture(to_picture, x, y, z):  # type: ignore[no-untyped-def]
    """Turn x and y of directions into shares of a picture's width and height."""
    t00, t01, t02 = to_picture[0, 0], to_picture[0, 1], to_picture[0, 2]
    t10, t11, t12 = to_picture[1, 0], to_picture[1, 1], to_picture[1, 2]
    t20, t21, t22 = to_picture[2, 0], to_picture[2, 1], to_picture[2, 2]
    for k in range(len(x)):
        px = t00 * x[k] + t01 * y[k] + t02 * z[k]
        py = t10 * x[k] + t11 * y[k] + t12 * z[k]
        pz = t20 * x[k] + t21 * y[k] + t22 * z[k]
        azimuth = arc_tangent(abs(px), abs(pz))  # from −z or z, whichever is nearer
        azimuth = azimuth if pz <= _ZERO else _PI - azimuth
        azimuth = azimuth if px >= _ZERO else -azimuth
        polar = arc_tangent(math.sqrt(px * px + pz * pz), abs(py))
        polar = polar if py >= _ZERO else _PI - polar
        x[k], y[k] = azimuth / _PI * _HALF + _HALF, polar / _PI


@kernel("contracted")
def sum_lobes(  # type: ignore[no-untyped-def]
    planes, eyes, kind, parameters, halves, ku, kv, u, v, z, numbers, strengths, fade, exact,
    undone, cosines, solids, turns, lobe, texels, starts, rows, columns, upright, widest, between,
    out, towards, values, places, begin, end,
):  # fmt: skip
    """Write Σ_k ρ_s scaling L dl_k / π into `out` (n, 3), k running over the samples.

    Parameters
    ----------
    planes : (S, 3, n) array
        Normals; with strengths (S − 1,) those of every scale, for Local Light Alignment.
    halves : bool
        Whether samples are half vectors.
    undone : bool
        Whether samples lie in the lobe and the chain is undone to find where their light comes
        from; else they are lights that go through it.
    numbers : (5,) array
        Warping and scaling, as `many_lights_kernel.sum_lights` has them.
    upright : (3, 3) array
        From the world to the picture.
    widest : float
        Variance of the widest blur over a sample's solid angle times what the blur is to be of it.
    between : (2,) array
        Only points whose cosine to the eye lies here are dealt with.
    towards, values, places : (k, samples, 3), (k, samples) and (k, samples) arrays
        If k is not 0 nothing is summed, but told of each of the points: where in the world the
        light of its samples comes from, what it counts, and the texel that it is looked up at.
    """
    bins, count = cosines.shape
    warping, anisotropy = numbers[0], numbers[4]
    curved = len(ku) > 0
    framed = curved and (warping != _ZERO or anisotropy != _ZERO)
    scaled = curved and numbers[2] != _ZERO
    aligned = len(strengths) > 0
    forward = aligned and not undone
    local = np.empty((3, count), np.float32)
    most = _padded(count * (MOST_PARTS if halves else 1))
    arriving, solid = np.empty((3, most), np.float32), np.empty(most, np.float32)
    value, ratio = np.empty(most, np.float32), np.empty(most, np.float32)
    bits, place = ratio.view(np.int32), np.empty(most, np.int32)
    axis, side, other = np.empty(3, np.float32), np.empty(3, np.float32), np.empty(3, np.float32)
    cosine, weight = np.empty(count, np.float32), np.empty(count, np.float32)
    seen = np.ones(count, np.float32)
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
        if ne < between[0] or ne >= between[1]:
            if len(values):
                values[i - begin] = _ZERO
            continue
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
        size = np.float32(_ONE / math.sqrt(max(bx * bx + by * by + bz * bz, _TINY)))
        bx, by, bz = bx * size, by * size, bz * size
        axis[0], axis[1], axis[2] = ax, ay, az
        side[0], side[1], side[2] = bx, by, bz
        other[0], other[1], other[2] = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        _about(
            cosines[row], solids[row], turns, axis, side, other, local[0], local[1], local[2],
            weight,
        )  # fmt: skip
        if halves:
            _mirrored(
                ex, ey, ez, ne, cosines[row], local[0], local[1], local[2], weight, seen, cosine
            )
        if forward:
            arriving[:, :count] = local
            for scale in range(len(strengths) - 1, -1, -1):
                if strengths[scale] > 0:
                    guides(planes, scale, i, ex, ey, ez, axis, side)
                    align_samples(
                        axis, side, strengths[scale], fade, exact, local[0], local[1], local[2]
                    )
        if halves:
            specular_of_halves(kind, parameters, lobe[row], cosines[row], seen, cosine, ne, term)
            delta[:] = cosines[row]
        else:
            for k in range(count):
                cosine[k] = nx * local[0, k] + ny * local[1, k] + nz * local[2, k]
            specular(
                kind, parameters, faint, local, cosine, nx, ny, nz, ex, ey, ez, ne, term, delta
            )
        if scaled:
            factors(numbers[2], numbers[3], convexity, mean, slant, local, term, delta, factor)
        # What counts moves to the front.
        met = 0
        for k in range(count):
            shown = term[k] * factor[k] * weight[k]
            if shown > _ZERO and not (aligned and cosine[k] <= _ZERO):
                of = arriving if forward else local
                x, y, w = of[0, k], of[1, k], of[2, k]
                arriving[0, met], arriving[1, met], arriving[2, met] = x, y, w
                solid[met], value[met] = weight[k], shown
                seen[met] = seen[k]
                met += 1
        if halves:
            met = _parted(
                ex, ey, ez, nx, ny, nz, met, seen, arriving[0], arriving[1], arriving[2], solid,
                value,
            )  # fmt: skip
        filled = _padded(met)
        for k in range(met, filled):
            arriving[0, k], arriving[1, k], arriving[2, k] = ex, ey, ez
            solid[k], value[k] = _ONE, _ZERO
        met = filled
        lx, ly, lz = arriving[0, :met], arriving[1, :met], arriving[2, :met]
        if warping != _ZERO:
            _warped(scale_u, scale_v, nx, ny, nz, lx, ly, lz, solid, value)
        for scale in range(len(strengths) if undone else 0):
            if strengths[scale] > 0:
                guides(planes, scale, i, ex, ey, ez, axis, side)
                undo(axis, side, strengths[scale], fade, lx, ly, lz, solid[:met], value[:met])
        told = i - begin
        if len(values):
            values[told] = _ZERO
            for k in range(met):
                values[told, k] = value[k]
                for a in range(3):
                    towards[told, k, a] = (lx if a == 0 else (ly if a == 1 else lz))[k]
                    if framed:
                        towards[told, k, a] = (
                            turn[0, a] * lx[k] + turn[1, a] * ly[k] + turn[2, a] * lz[k]
                        )
        _places(to_picture, lx, ly, lz, solid, widest, starts, rows, columns, ratio, bits, place)
        if len(values):
            places[told, :met] = place[:met]
            continue
        red, green, blue = _ZERO, _ZERO, _ZERO
        for k in range(met):
            at = place[k]
            red += value[k] * texels[at, 0]
            green += value[k] * texels[at, 1]
            blue += value[k] * texels[at, 2]
        out[i, 0], out[i, 1], out[i, 2] = red / _PI, green / _PI, blue / _PI
