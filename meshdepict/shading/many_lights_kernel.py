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
from meshdepict.shading.material_kernel import FAINT, diffuse, specular
from meshdepict.shading.material_kinds import PHONG
from meshdepict.shading.scaling_kernel import MOST_EXPONENT, factors
from meshdepict.shading.warping_kernel import lights_at, look_up, stretch, turned, unwarp
from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["sum_lights"]

Single = NDArray[np.float32]

_ZERO, _ONE, _TWO = np.float32(0), np.float32(1), np.float32(2)


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
    highlights: bool = True,
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
        One of `material_kinds`.
    parameters : (3,) array
        Diffuse, specular or reflectance, and the exponent or roughness.
    frames : Frames, optional
        Needed for warping and scaling.
    warping : float
        Magnitude α of Light Warping; exactly 0 leaves the lights alone.
    scaling : Scaling
    environment : (h, w, c) array, optional
        Radiance by latitude (first row +y) and longitude, looked up at W(l) for eq. 1.
    highlights : bool
        Whether the material's specular term counts, too.

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
    shiny = highlights and kind >= PHONG and bool(parameters[1] > 0)
    arguments = (
        normals, eyes, lights, colors, kind, parameters, shiny, *frames, numbers, environment,
    )  # fmt: skip
    # Several pieces per thread: points in the dark take less time.
    pieces = 4 * thread_count() if count * len(lights) > 20_000 else 1
    each(lambda a, b: _sum(*arguments, out, a, b), spans(count, pieces))
    return out


@kernel("contracted")
def _sum(  # type: ignore[no-untyped-def]
    normals, eyes, lights, colors, kind, parameters, shiny, ku, kv, u, v, z, numbers, environment,
    out, begin, end,
):  # fmt: skip
    count, channels = colors.shape
    warping, anisotropy = numbers[0], numbers[4]
    curved = len(ku) > 0
    framed = curved and (warping != _ZERO or anisotropy != _ZERO)
    scaled = curved and (numbers[1] != _ZERO or numbers[2] != _ZERO)
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
            nx, ny, nz = turned(turn, nx, ny, nz)
            ex, ey, ez = turned(turn, ex, ey, ez)
            if environment.size:
                lights_at(world, turn, local)
                look_up(
                    environment, local, turn, stretch(warping * ku[i]), stretch(warping * kv[i]),
                    nx, ny, nz, weight, colors, radiance,
                )  # fmt: skip
            elif warping != _ZERO:
                unwarp(
                    world, turn, stretch(warping * ku[i]), stretch(warping * kv[i]), nx, ny, nz,
                    local, weight,
                )  # fmt: skip
            else:
                lights_at(world, turn, local)
        # The eye, mirrored where the point faces away from it.
        away = min(nx * ex + ny * ey + nz * ez, _ZERO) * _TWO
        ex, ey, ez = ex - away * nx, ey - away * ny, ez - away * nz
        ne = nx * ex + ny * ey + nz * ez
        for k in range(count):
            cosine[k] = nx * local[0, k] + ny * local[1, k] + nz * local[2, k]
        diffuse(kind, parameters, cosine, ne, term, delta)
        faint = FAINT
        if scaled:
            faint += min(MOST_EXPONENT, numbers[2])  # what scaling may multiply it by
            mean = ku[i] + kv[i]
            slant = anisotropy * (ku[i] - kv[i])
            convexity = -math.tanh(mean)  # where isotropic, else one for each light
            factors(numbers[1], numbers[3], convexity, mean, slant, local, term, delta, factor)
            for k in range(count):
                value[k] = term[k] * factor[k]
        else:
            for k in range(count):
                value[k] = term[k]
        if shiny:
            specular(
                kind, parameters, faint, local, cosine, nx, ny, nz, ex, ey, ez, ne, term, delta
            )
            if scaled:
                factors(numbers[2], numbers[3], convexity, mean, slant, local, term, delta, factor)
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
