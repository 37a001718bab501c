"""Light Warping by eq. 1: over directions into an environment, which eq. 2 converges to."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.equirectangular import bilinear, to_picture
from meshdepict.scene.light import Light
from meshdepict.scene.material import Material
from meshdepict.shading.direct import kernel_parameters, squeezed
from meshdepict.shading.features import Frames

__all__ = ["integral"]

Single = NDArray[np.float32]


def integral(
    space: ScaleSpace,
    environment: Environment,
    towards_eye: Single,
    material: Material,
    frames: Frames | None,
    magnitude: float,
    count: int,
) -> Single:
    """Return eq. 1 over evenly spread directions."""
    from meshdepict.shading.many_lights_kernel import sum_lights

    # Radiance averaged over about as much as one direction stands for.
    spacing = math.sqrt(4 * math.pi / count)
    flux, _ = environment.reduced(max(4, math.ceil(math.pi / spacing)))
    radiance = np.ascontiguousarray(flux[..., :3] / flux[..., 3:])
    directions = [light.direction for light in Light((0, 1, 0), spread=180).disc(count)]
    weights = np.full((count, 3), 4 / count, np.float32)  # 4π/count, and the 1/π of all terms
    kind, parameters = kernel_parameters(material)

    def turned(vectors: Single) -> Single:
        return np.ascontiguousarray(to_picture(vectors, environment.up), np.float32)

    normals = turned(space.normals_at(0)).T.copy()
    normals.setflags(write=False)  # as a scale space's are, or the kernel is compiled once more
    eye = turned(towards_eye.T).T.copy()
    if frames is None:  # W(l) is l, for all points
        weights *= bilinear(radiance, np.array(directions))
        return squeezed(
            sum_lights(
                normals, eye, np.array(directions, np.float32), weights, kind, parameters,
                frames=None,
            )
        )  # fmt: skip
    return sum_lights(
        normals, eye,
        np.array(directions, np.float32), weights, kind, parameters,
        frames=Frames(frames.ku, frames.kv, turned(frames.u), turned(frames.v), turned(frames.z)),
        warping=magnitude, environment=radiance,
    )  # fmt: skip
