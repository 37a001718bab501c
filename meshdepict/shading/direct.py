"""Direct light on a material: the terms of all lights, warped and scaled where asked for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.material import (
    AshikhminShirley,
    CookTorrance,
    HalfLambert,
    Lambert,
    Material,
    Phong,
    SubLambert,
    Toon,
    diffuse_term,
    specular_term,
)
from meshdepict.scene.vectors import cosines
from meshdepict.shading.features import Frames, Scaling
from meshdepict.shading.lobes import needs_samples
from meshdepict.shading.material_kinds import (
    ASHIKHMIN_SHIRLEY,
    COOK_TORRANCE,
    HALF_LAMBERT,
    LAMBERT,
    PHONG,
    SUB_LAMBERT,
)
from meshdepict.shading.tones import soft_tones
from meshdepict.shading.warp_equations import jacobian, unwarp, warp_scale

__all__ = ["direct", "kernel_colors", "kernel_parameters", "quantised", "squeezed", "unwarped"]

_FEW = 2  # lights that plain arrays are as good for


def direct(
    space: ScaleSpace,
    lights: Sequence[Light],
    eyes: NDArray[np.float32],
    material: Material,
    *,
    environments: Sequence[Environment] = (),
    count: int = 54,
    frames: Frames | None = None,
    warping: float = 0.0,
    scaling: Scaling = Scaling(),  # noqa: B008 (immutable)
) -> NDArray[np.float32]:
    """Return diffuse plus specular light, before exposure.

    Parameters
    ----------
    space : ScaleSpace
    lights : sequence of Light
    eyes : (3, n) or (3, 1) array
        Towards the eye.
    material : Material
        One that lights shine on.
    environments : sequence of Environment
        Each is cut into ``count`` lights; highlights that those don't serve have as many samples
        in the lobe of every point (`meshdepict.shading.lobes`).
    count : int
    frames : Frames, optional
        Curvature, needed for the next two.
    warping : float
        Magnitude α of Light Warping.
    scaling : Scaling

    Returns
    -------
    (n,) array, (n, 3) where a light is coloured
    """
    kind, parameters = kernel_parameters(material)
    settings: Any = {"frames": frames, "warping": warping, "scaling": scaling}
    glossy = [e for e in environments if needs_samples(e, kind, parameters)]
    lights = [*lights, *(x for e in environments if e not in glossy for x in e.lights(count))]
    if glossy:
        from meshdepict.shading.lobes import lobes
        from meshdepict.shading.many_lights_kernel import sum_lights

        cut = [light for environment in glossy for light in environment.lights(count)]
        directions = np.array([light.direction for light in cut], np.float32)
        total = sum_lights(
            space.planes_at(0), eyes, directions, kernel_colors([light.color for light in cut]),
            kind, parameters, highlights=False, **settings,
        )  # fmt: skip
        for environment in glossy:
            total = total + lobes(
                space.planes_of((0,)), eyes, environment, kind, parameters, count=count, **settings
            )
        if lights:
            own = direct(space, lights, eyes, material, **settings)
            total = total + (own if own.ndim == 2 else own[:, None])
        return squeezed(total)
    scaled = frames is not None and bool(scaling.diffuse or scaling.specular)
    if len(lights) <= _FEW and not scaled:
        return _few(space, lights, eyes, material, frames if warping else None, warping)

    from meshdepict.shading.many_lights_kernel import sum_lights

    directions = np.array([light.direction for light in lights], np.float32)
    return squeezed(
        sum_lights(
            space.planes_at(0), eyes, directions, kernel_colors([light.color for light in lights]),
            kind, parameters, **settings,
        )
    )  # fmt: skip


def _few(
    space: ScaleSpace,
    lights: Sequence[Light],
    eyes: NDArray[np.float32],
    material: Material,
    frames: Frames | None,
    warping: float,
) -> NDArray[np.float32]:
    """Do the same by arrays: in a fresh process the kernel takes longer to load than this."""
    normals, eye = space.normals_at(0), eyes.T
    colors = kernel_colors([light.color for light in lights])
    total = np.zeros((len(normals), colors.shape[1]), np.float32)
    for light, color in zip(lights, colors, strict=True):
        direction = light.direction.astype(np.float32)
        weight: np.float32 | NDArray[np.float32] = np.float32(1)
        if frames is not None:
            direction, weight = unwarped(normals, direction, frames, warping)
        value = diffuse_term(material, normals, direction, eye)
        value = (value + specular_term(material, normals, direction, eye)) * weight
        total += value[:, None] * color
    return squeezed(total)


def unwarped(
    normals: NDArray[np.float32], light: NDArray[np.float32], frames: Frames, warping: float
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return W⁻¹(l') of a light at every point, and its J (Light Warping, eq. 2).

    Parameters
    ----------
    normals : (n, 3) array
    light : (3,) array of float32
    frames : Frames
    warping : float
        Magnitude α.

    Returns
    -------
    (n, 3) array
    (n,) array
        Zero unless both directions lie in the hemisphere of n.
    """
    axes = np.stack([frames.u, frames.v, frames.z], axis=1)
    local = axes @ light
    stretch = warp_scale(frames.ku, warping), warp_scale(frames.kv, warping)
    back = np.einsum("nij,ni->nj", axes, unwarp(local, *stretch))
    both = np.minimum(cosines(normals, light), np.einsum("ni,ni->n", normals, back)) > 0
    return back, np.where(both, jacobian(local, *stretch), np.float32(0))


def kernel_parameters(material: Material) -> tuple[int, NDArray[np.float32]]:
    """Return a material as the kernel takes it: its kind, and diffuse, specular, exponent.

    Raises
    ------
    MeshdepictError
        For a material that shows an environment or a painting instead of lights.
    """
    match material:
        case Lambert():
            found: tuple[Any, ...] = (LAMBERT, material.diffuse, 0, 0)
        case Toon():
            found = (LAMBERT, 1, 0, 0)
        case HalfLambert():
            found = (HALF_LAMBERT, material.diffuse, 0, 0)
        case SubLambert():
            found = (SUB_LAMBERT, material.diffuse, 0, material.flatness)
        case Phong():
            found = (PHONG, material.diffuse, material.specular, material.shininess)
        case CookTorrance():
            found = (COOK_TORRANCE, material.diffuse, material.reflectance, material.roughness)
        case AshikhminShirley():
            found = (ASHIKHMIN_SHIRLEY, material.diffuse, material.reflectance, material.shininess)
        case _:
            raise MeshdepictError(
                f"lights don't shine on {type(material).__name__}: give an Environment as the light"
            )
    return found[0], np.array(found[1:], np.float32)


def kernel_colors(colors: Sequence[Any]) -> NDArray[np.float32]:
    """Return colours (k, 3), or (k, 1) where all are gray."""
    array = np.array(colors, np.float32)
    gray = (array == array[:, :1]).all()
    return np.ascontiguousarray(array[:, :1]) if gray else array


def squeezed(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return (n,) for a single channel."""
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values


def quantised(values: NDArray[Any], material: Material, exposure: float) -> NDArray[Any]:
    """Return the shading in soft steps where the material is a toon: after exposure, as seen."""
    if not isinstance(material, Toon):
        return values
    shown = np.maximum(values * np.float32(exposure), 0)
    steps = soft_tones(shown, bins=material.bins, sharpness=material.sharpness)
    return steps / np.float32(max(exposure, 1e-30))
