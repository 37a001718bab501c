"""What a point shows of its surroundings: mirrored, refracted, painted, or gathered beforehand."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import LUMINANCE, Environment
from meshdepict.scene.material import (
    LitSphere,
    Material,
    Mirror,
    Refractive,
    reflected,
    refracted,
    towards_visible,
)
from meshdepict.scene.names import LightsLike
from meshdepict.scene.vectors import in_frame
from meshdepict.scene.view import View
from meshdepict.shading.features import Frames, eyes
from meshdepict.shading.mirrored_light import mirrored_light
from meshdepict.shading.painted import painted, sphere_picture
from meshdepict.shading.refracted_light import refracted_light
from meshdepict.shading.warp_equations import warp, warp_scale

__all__ = ["as_environment", "gathered", "luminance", "seen", "sphere_colors"]

Single = NDArray[np.float32]


def as_environment(light: LightsLike, what: str) -> Environment:
    """Return the light if it is an environment.

    Raises
    ------
    MeshdepictError
        For any other light, saying what wants an environment.
    """
    if not isinstance(light, Environment):
        raise MeshdepictError(
            f"{what} shows an environment: give an Environment or a panorama (.hdr) as the light, "
            f"not {light!s:.60}"
        )
    return light


def luminance(colors: NDArray[Any]) -> Single:
    """Return the luminance (n,) of linear colours (n, 3); gray values are their own."""
    return colors if colors.ndim == 1 else colors @ LUMINANCE.astype(np.float32)


def seen(
    space: ScaleSpace, light: LightsLike, view: View, material: Mirror | Refractive,
    frames: Frames | None = None, warping: float = 0.0, *,
    shadows: bool = False, bounces: int = 0, rays: int = 64,
    scaled: tuple[Callable[[Single, Single], Single], Single] | None = None,
) -> Single:  # fmt: skip
    """Return the radiance (n, 3) in the direction where a mirror or a refraction looks.

    Light Warping turns that direction; it is kept even where it leaves the hemisphere of the
    normal, where a black hole would be the alternative. With shadows or bounces rays go there; see
    `mirrored_light` and `refracted_light` for the rest.
    """
    environment = as_environment(light, type(material).__name__)
    normals = space.normals_at(0)
    eye = towards_visible(normals, eyes(space, view).T)
    if isinstance(material, Mirror):
        directions = reflected(normals, eye)
    else:
        directions = refracted(normals, eye, refraction=material.refraction)
    if frames is not None and warping:
        axes = np.stack([frames.u, frames.v, frames.z], axis=1)
        local = np.einsum("nij,nj->ni", axes, directions)
        turned = warp(local, warp_scale(frames.ku, warping), warp_scale(frames.kv, warping))
        directions = np.einsum("nij,ni->nj", axes, turned)
    if isinstance(material, Refractive) and bounces:
        return refracted_light(space, environment, directions, material, bounces=bounces, rays=rays)
    if isinstance(material, Mirror) and (shadows or bounces):
        return mirrored_light(
            space, environment, directions, roughness=material.roughness, shadows=shadows,
            bounces=bounces, rays=rays, scaled=scaled,
        )  # fmt: skip
    return environment.lookup(directions, blur=material.roughness)


def sphere_colors(space: ScaleSpace, view: View, material: LitSphere, convexity: Single) -> Single:
    """Return linear colours (n, 3) of one lit sphere, or of two mixed by convexity."""
    from meshdepict.color.srgb import srgb_to_linear

    normals = in_frame(space.normals_at(0), view.frame)
    colors = painted(sphere_picture(material.convex), normals)
    if material.concave is not None:
        within: NDArray[Any] = np.clip((0.2 + convexity / 2) / 0.4, 0, 1)[:, None]
        share = within * within * (3 - 2 * within)  # from ½ + κ/2 = 0.3 to 0.7
        hollow = painted(sphere_picture(material.concave), normals)
        colors = share * colors + (1 - share) * hollow
    return np.asarray(srgb_to_linear(colors), np.float32)


def gathered(
    space: ScaleSpace, light: LightsLike, material: Material, *, illumination: str, rays: int
) -> tuple[Single, Single]:
    """Return precomputed diffuse light and its reflectance mapping δ (Radiance Scaling, §5.3).

    Parameters
    ----------
    illumination : {"irradiance", "occlusion"}
        Albedo/π · A · L̄(n), δ = L̄(n)/max L̄; or A alone, δ = A.
    rays : int
        For A. 0: none, but 256 for occlusion alone.
    """
    if illumination == "occlusion":
        openness = space.occlusion(rays or 256)
        return openness, openness
    environment = as_environment(light, "irradiance")
    irradiance = environment.irradiance(space.normals_at(0)).astype(np.float32)
    delta = luminance(irradiance) / np.float32(max(environment.largest_irradiance, 1e-30))
    value = irradiance * np.float32(getattr(material, "diffuse", 1.0) / np.pi)
    return value * space.occlusion(rays)[:, None] if rays else value, delta
