"""What Radiance Scaling reads of a scale space, and whether curvature has any weight there."""

from __future__ import annotations

from typing import Any

from meshdepict.scales.reads import Reads
from meshdepict.scene.material import LitSphere, Material, Mirror, Refractive, as_material
from meshdepict.shading.features import bends
from meshdepict.shading.reached import USUAL_RAYS, ray_count

__all__ = ["scaling_bends", "scaling_reads"]


def scaling_reads(
    last: int,
    *,
    material: str | Material,
    curvature: str,
    scale: int,
    gain: float | None,
    illumination: str,
    shadows: bool,
    bounces: int,
    rays: int | str,
    roughness: float | None,
    **options: Any,
) -> Reads:
    """Return the shape's own normals, with what scales light, and rays if they are wanted."""
    shown = as_material(material)
    lit = not isinstance(shown, (LitSphere, Mirror, Refractive))
    hidden = ray_count(shadows=shadows, bounces=bounces, rays=rays or USUAL_RAYS)
    rays = 0 if isinstance(rays, str) else rays  # which precomputed light refuses
    gathered = {"occlusion": rays or 256, "irradiance": rays}.get(illumination, hidden)
    if not lit:  # a smooth mirror has one ray, a painting none
        rough = isinstance(shown, (Mirror, Refractive)) and (roughness or shown.roughness)
        gathered = 0 if isinstance(shown, LitSphere) else int(shadows or bounces > 0)
        gathered *= (rays or USUAL_RAYS) if rough else 1
    own = Reads(normals=frozenset((0,)), rays=gathered)
    return own | bends(scale, curvature) if scaling_bends(shown, gain, **options) else own


def scaling_bends(
    material: Material,
    gain: float | None,
    *,
    magnitude: float,
    ambient_magnitude: float | None,
    diffuse_magnitude: float | None,
    specular_magnitude: float | None,
    warping: float,
    **_: Any,
) -> bool:
    """Whether curvature has any weight."""
    own = (ambient_magnitude, diffuse_magnitude, specular_magnitude)
    scaled = any(magnitude if each is None else each for each in own)
    mixed = isinstance(material, LitSphere) and material.concave is not None
    return gain != 0 and bool(scaled or warping or mixed)
