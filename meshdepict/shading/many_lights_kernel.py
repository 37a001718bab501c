"""Many lights on many points, compiled: warped (Light Warping) and scaled (Radiance Scaling).

Per point the lights are rotated into its frame and unwarped, the material's terms are evaluated,
scaled and summed: a few short loops over the lights, which stay in the fastest cache.
`meshdepict.scene.material` and the equations beside this file are the same formulas for arrays.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.shading.features import Frames, Scaling
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["KINDS", "sum_lights"]

Single = NDArray[np.float32]

KINDS = ("lambert", "half_lambert", "sub_lambert", "phong", "cook_torrance", "ashikhmin_shirley")
_LAMBERT, _HALF, _SUB, _PHONG, _COOK, _ASHIKHMIN = range(len(KINDS))

_ZERO, _HALF_, _ONE, _TWO = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2)
_TINY = np.float32(1e-30)
_GRAZING = np.float32(1e-4)  # material.GRAZING
_MOST = np.float32(60)  # radiance_scaling: e^60 is a float32 that may still be multiplied
_SIXTH = np.float32(1 / 6)
_VANISHED = np.float32(20)  # powers below e^−20 are left out: a millionth of a grey level


def sum_lights(
    normals: Single,
    eyes: Single,
    lights: Single,
    colors: Single,
    kind: int,
    parameters: Single,
    *,
    frames: Frames | None,
    warping: float = 0.0,
    scaling: Scaling = Scaling(),  # noqa: B008 (immutable)
    environment: Single | None = None,
) -> Single:
    """Return Σ_j ρ_j scaling_j L_j over the lights.

    Parameters
    ----------
    normals : (3, n) array
    eyes : (3, n) or (3, 1) array
        Towards the eye.
    lights : (k, 3) array
        Towards the lights; with an environment the directions l of eq. 1's integral.
    colors : (k, c) array
        c = 1 or 3; with an environment the weights of the integral.
    kind : int
        Index into `KINDS`.
    parameters : (3,) array
        Diffuse, specular or reflectance, and the exponent or roughness.
    frames : Frames, optional
        Needed for warping and scaling.
    warping : float
        Magnitude α of Light Warping; exactly 0 leaves the lights alone.
    scaling : Scaling
    environment : (h, w, c) array, optional
        Radiance by latitude (first row +y) and longitude, looked up at W(l) for eq. 1.

    Returns
    -------
    (n, c) array
    """
    count = normals.shape[1]
    out = np.empty((count, colors.shape[1]), np.float32)
    if frames is None:
        none, frame = np.empty(0, np.float32), np.empty((0, 3), np.float32)
        frames = Frames(none, none, frame, frame, frame)
    if environment is None:
        environment = np.empty((0, 0, 1), np.float32)
    numbers = np.array([warping, *scaling], np.float32)
    arguments = (normals, eyes, lights, colors, kind, parameters, *frames, numbers, environment)
    # Several pieces per thread: points in the dark take less time.
    pieces = 4 * thread_count() if count * len(lights) > 20_000 else 1
    each(lambda a, b: _sum(*arguments, out, a, b), spans(count, pieces))
    return out


@kernel("reordered")
def _sum(  # type: ignore[no-untyped-def]
    normals, eyes, lights, colors, kind, parameters, ku, kv, u, v, z, numbers, environment, out,
    begin, end,
):  # fmt: skip
    count, channels = colors.shape
    warping, anisotropy = numbers[0], numbers[4]
    curved = len(ku) > 0
    framed = curved and (warping != _ZERO or anisotropy != _ZERO)
    scaled = curved and (numbers[1] != _ZERO or numbers[2] != _ZERO)
    specular = kind >= _PHONG and parameters[1] > _ZERO
    world = np.ascontiguousarray(lights.T)
    local, weight = world.copy(), np.ones(count, np.float32)
    cosine, factor = np.empty(count, np.float32), np.empty(count, np.float32)
    term, delta = np.empty(count, np.float32), np.empty(count, np.float32)
    value, turn = np.zeros(count, np.float32), np.empty((3, 3), np.float32)
    radiance = colors.copy()
    for i in range(begin, end):
        nx, ny, nz = normals[0, i], normals[1, i], normals[2, i]
        j = i if eyes.shape[1] > 1 else 0
        ex, ey, ez = eyes[0, j], eyes[1, j], eyes[2, j]
        if framed:
            turn[0], turn[1], turn[2] = u[i], v[i], z[i]
            nx, ny, nz = _turned(turn, nx, ny, nz)
            ex, ey, ez = _turned(turn, ex, ey, ez)
            if environment.size:
                _lights_at(world, turn, local)
                _look_up(
                    environment, local, turn, _scale(warping * ku[i]), _scale(warping * kv[i]),
                    nx, ny, nz, weight, colors, radiance,
                )  # fmt: skip
            elif warping != _ZERO:
                _unwarp(
                    world, turn, _scale(warping * ku[i]), _scale(warping * kv[i]), nx, ny, nz,
                    local, weight,
                )  # fmt: skip
            else:
                _lights_at(world, turn, local)
        # The eye, mirrored where the point faces away from it.
        away = min(nx * ex + ny * ey + nz * ez, _ZERO) * _TWO
        ex, ey, ez = ex - away * nx, ey - away * ny, ez - away * nz
        ne = nx * ex + ny * ey + nz * ez
        for k in range(count):
            cosine[k] = nx * local[0, k] + ny * local[1, k] + nz * local[2, k]
        _diffuse(kind, parameters, cosine, ne, term, delta)
        if scaled:
            mean = ku[i] + kv[i]
            slant = anisotropy * (ku[i] - kv[i])
            convexity = -math.tanh(mean)  # where isotropic, else one for each light
            _factors(numbers[1], numbers[3], convexity, mean, slant, local, term, delta, factor)
            for k in range(count):
                value[k] = term[k] * factor[k]
        else:
            for k in range(count):
                value[k] = term[k]
        if specular:
            _specular(kind, parameters, local, cosine, nx, ny, nz, ex, ey, ez, ne, term, delta)
            if scaled:
                _factors(numbers[2], numbers[3], convexity, mean, slant, local, term, delta, factor)
                for k in range(count):
                    value[k] += term[k] * factor[k]
            else:
                for k in range(count):
                    value[k] += term[k]
        for c in range(channels):
            total = _ZERO
            for k in range(count):
                total += value[k] * weight[k] * radiance[k, c]
            out[i, c] = total


@kernel("reordered", inline=True)
def _turned(turn, x, y, z):  # type: ignore[no-untyped-def]
    return (
        turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z,
        turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z,
        turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z,
    )


@kernel("reordered")
def _lights_at(world, turn, local):  # type: ignore[no-untyped-def]
    for a in range(3):
        x, y, z = turn[a, 0], turn[a, 1], turn[a, 2]
        for k in range(world.shape[1]):
            local[a, k] = x * world[0, k] + y * world[1, k] + z * world[2, k]


@kernel("reordered")
def _scale(product):  # type: ignore[no-untyped-def]
    """Return `light_warping.warp_scale`."""
    tangent = np.float32(math.tan(math.atan(product) * _SIXTH))
    return (_ONE + tangent) / (_ONE - tangent)


@kernel("reordered")
def _unwarp(world, turn, scale_u, scale_v, nx, ny, nz, local, weight):  # type: ignore[no-untyped-def]
    """Write W⁻¹(l') and J, zero unless both directions lie in the hemisphere of n (eq. 2)."""
    a, b = _ONE / scale_u, _ONE / scale_v
    pole = (scale_u * scale_u + scale_v * scale_v) * _HALF_
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


@kernel("reordered")
def _look_up(environment, local, turn, scale_u, scale_v, nx, ny, nz, weight, colors, radiance):  # type: ignore[no-untyped-def]
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


@kernel("reordered")
def _fifth(x):  # type: ignore[no-untyped-def]
    return x * x * (x * x) * x


@kernel("reordered")
def _diffuse(kind, parameters, cosine, ne, term, delta):  # type: ignore[no-untyped-def]
    """Write `material.diffuse_term` and its reflectance mapping δ."""
    share, reflectance, power = parameters[0], parameters[1], parameters[2]
    count = len(cosine)
    if kind == _HALF:
        for k in range(count):
            delta[k] = max(_ZERO, min(_ONE, _HALF_ + _HALF_ * cosine[k]))
    elif kind == _SUB:
        for k in range(count):
            delta[k] = min(_ONE, cosine[k]) ** power if cosine[k] > _ZERO else _ZERO
    else:
        for k in range(count):
            delta[k] = max(_ZERO, min(_ONE, cosine[k]))
    if kind == _COOK:
        rest = _ONE - reflectance
        share *= rest * rest * (_ONE - _fifth(_ONE - max(_ZERO, min(_ONE, ne))))
        for k in range(count):
            term[k] = share * (_ONE - _fifth(_ONE - delta[k])) * delta[k]
    elif kind == _ASHIKHMIN:
        share *= np.float32(28 / 23) * (_ONE - reflectance)
        share *= _ONE - _fifth(_ONE - max(_ZERO, min(_ONE, ne)) * _HALF_)
        for k in range(count):
            term[k] = share * (_ONE - _fifth(_ONE - delta[k] * _HALF_)) * delta[k]
    else:
        for k in range(count):
            term[k] = share * delta[k]


@kernel("reordered")
def _specular(kind, parameters, local, cosine, nx, ny, nz, ex, ey, ez, ne, term, delta):  # type: ignore[no-untyped-def]
    """Write `material.specular_term` and its reflectance mapping δ."""
    reflectance, power = parameters[1], parameters[2]
    least = np.float32(math.exp(-_VANISHED / max(power, _TINY)))
    count = len(cosine)
    if kind == _PHONG:
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
        if kind == _COOK:
            slope, c2 = power * power, max(nh * nh, _GRAZING)
            facets = np.float32(math.exp((c2 - _ONE) / (c2 * slope))) / (slope * c2 * c2)
            lit = min(_ONE / seen, _TWO * nh / eh, _TWO * nh * nl / (eh * seen))
            term[k] = mirror * facets * lit * np.float32(0.25)
        else:
            lobe = (power + _ONE) * np.float32(0.125) * nh**power if nh > least else _ZERO
            term[k] = lobe * mirror * nl / (eh * max(nl, seen))


@kernel("reordered")
def _factors(magnitude, alpha, convexity, mean, slant, local, term, delta, factor):  # type: ignore[no-untyped-def]
    """Write `radiance_scaling.scaling` for κ(l), which is one number where isotropic."""
    beta = _ONE - alpha
    if slant == _ZERO:
        e = _faded(magnitude, convexity)
        for k in range(len(delta)):
            low, high = alpha * (_ONE - delta[k]), beta * delta[k]
            factor[k] = (low * e + high) / (low + high * e)
        return
    for k in range(len(delta)):
        factor[k] = _ZERO
        if term[k] > _ZERO:
            across = local[0, k] * local[0, k] - local[1, k] * local[1, k]
            e = _faded(magnitude, -math.tanh(mean + slant * across))
            low, high = alpha * (_ONE - delta[k]), beta * delta[k]
            factor[k] = (low * e + high) / (low + high * e)


@kernel("reordered")
def _faded(magnitude, convexity):  # type: ignore[no-untyped-def]
    """Return E = e^−γκ."""
    return np.float32(math.exp(max(-_MOST, min(_MOST, -magnitude * convexity))))
