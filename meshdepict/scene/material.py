"""Materials: what light does at a surface, each term a function of its own.

A term is ``π ρ(e, l) ⟨n·l⟩``: what a light of colour 1 adds, so that a white Lambertian surface
shows the cosine. Vectors are unit arrays (…, 3), broadcast against each other: ``normal``,
``light`` towards the light, ``eye`` towards the eye. Terms stay apart, because methods treat each
in its own way.

A point that faces away from the eye is shaded for the eye mirrored in its tangent plane, so that a
bake may be turned round: formulas of the visible side alone would leave it black.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range, check, nearest

__all__ = [
    "MATERIALS",
    "AshikhminShirley",
    "CookTorrance",
    "HalfLambert",
    "Lambert",
    "LitSphere",
    "Material",
    "Mirror",
    "Phong",
    "Refractive",
    "SubLambert",
    "Toon",
    "adjusted",
    "ambient_term",
    "as_material",
    "diffuse_term",
    "reflected",
    "refracted",
    "soft_steps",
    "specular_term",
    "towards_visible",
]

Floats = NDArray[Any]
Share = Annotated[float, Range(0, 1)]
GRAZING = 1e-4  # least cosine that is divided by


class _Checked:
    """Checks every field against its range when made."""

    def __post_init__(self) -> None:
        for name, value in check(type(self), vars(self), type(self).__name__).items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class Lambert(_Checked):
    """Diffuse: n·l."""

    diffuse: Share = 1.0


@dataclass(frozen=True)
class HalfLambert(_Checked):
    """The unclamped cosine ½ + ½ n·l."""

    diffuse: Share = 1.0


@dataclass(frozen=True)
class SubLambert(_Checked):
    """Flatter than Lambert, as the moon: (n·l)^flatness."""

    flatness: Annotated[float, Range(0, 1, help="ζ")] = 0.5
    diffuse: Share = 1.0


@dataclass(frozen=True)
class Phong(_Checked):
    """Ambient, n·l and (r·l)^shininess, weighted; r is the reflected line of sight."""

    ambient: Share = 0.1
    diffuse: Share = 0.7
    specular: Share = 0.3
    shininess: Annotated[float, Range(0, 1e6)] = 20.0


@dataclass(frozen=True)
class CookTorrance(_Checked):
    """Beckmann microfacets in V-shaped grooves (Cook and Torrance 1982) over a diffuse base.

    The base gets what Schlick's Fresnel term lets in and out, so that no light is made.
    """

    diffuse: Share = 0.6
    reflectance: Annotated[float, Range(0, 1, help="of the facets, seen head-on")] = 0.2
    roughness: Annotated[float, Range(0.02, 1, help="slope m of the facets")] = 0.3


@dataclass(frozen=True)
class AshikhminShirley(_Checked):
    """A glossy coat over a diffuse base (Ashikhmin and Shirley 2000), isotropic: n_u = n_v."""

    diffuse: Share = 0.6
    reflectance: Annotated[float, Range(0, 1, help="R_s, seen head-on")] = 0.2
    shininess: Annotated[float, Range(0, 1e5)] = 50.0


@dataclass(frozen=True)
class Toon(_Checked):
    """Lambert, quantised by soft steps."""

    bins: Annotated[int, Range(1, 256)] = 8
    sharpness: Annotated[float, Range(1e-3, 1e3, help="φ of the steps", soft=(3, 14))] = 6.0


@dataclass(frozen=True)
class Mirror(_Checked):
    """Reflects an environment, blurred where rough; with bounces also what stands before it."""

    roughness: Annotated[float, Range(0, 1.5, unit="rad", help="width of the lobe")] = 0.0


@dataclass(frozen=True)
class Refractive(_Checked):
    """Shows an environment through one refraction, or with bounces through a body and its walls."""

    refraction: Annotated[float, Range(1, 10, help="index behind over before the surface")] = 1.5
    roughness: Annotated[float, Range(0, 1.5, unit="rad", help="width of the lobe")] = 0.0


@dataclass(frozen=True)
class LitSphere:
    """Light, material and style painted on a sphere: colour by view-space normal.

    Parameters
    ----------
    convex : str or path
        "clay", "metal", or a picture of a sphere that fills it.
    concave : str or path, optional
        A second one for concavities.
    """

    convex: Any = "clay"
    concave: Any = None


Material = (
    Lambert | HalfLambert | SubLambert | Phong | CookTorrance | AshikhminShirley | Toon | Mirror
    | Refractive | LitSphere
)  # fmt: skip

MATERIALS: dict[str, type[Any]] = {
    "lambert": Lambert, "half_lambert": HalfLambert, "sub_lambert": SubLambert, "phong": Phong,
    "cook_torrance": CookTorrance, "ashikhmin_shirley": AshikhminShirley, "toon": Toon,
    "lit_sphere": LitSphere, "mirror": Mirror, "refractive": Refractive,
}  # fmt: skip


def as_material(material: str | Material) -> Any:
    """Return a material: as given, or by name with its defaults.

    Raises
    ------
    MeshdepictError
        For an unknown name.
    """
    if isinstance(material, tuple(MATERIALS.values())):
        return material
    if not isinstance(material, str) or material not in MATERIALS:
        raise MeshdepictError(
            f"no material is called {material!r}{nearest(str(material), MATERIALS)} (there are "
            f"{', '.join(MATERIALS)})"
        )
    return MATERIALS[material]()


def adjusted(material: Any, **parameters: float | None) -> Any:
    """Return the material with those of its parameters replaced that are not None.

    Raises
    ------
    MeshdepictError
        For a parameter that the material does not have.
    """
    given = {name: value for name, value in parameters.items() if value is not None}
    for name in given:
        if not hasattr(material, name):
            raise MeshdepictError(f"{type(material).__name__} has no {name}")
    return replace(material, **given) if given else material


def ambient_term(material: Material) -> float:
    """Return the share of constant ambient light that the material shows."""
    return material.ambient if isinstance(material, Phong) else 0.0


def diffuse_term(material: Material, normal: ArrayLike, light: ArrayLike, eye: ArrayLike) -> Floats:
    """Return the diffuse term, (…) ≥ 0; 0 for materials that have none."""
    normal, light, eye = _visible(normal, light, eye)
    nl = _dot(normal, light)
    cosine = np.clip(nl, 0, 1)
    if isinstance(material, HalfLambert):
        return material.diffuse * (1 + np.clip(nl, -1, 1)) / 2
    if isinstance(material, SubLambert):
        return material.diffuse * np.where(cosine > 0, cosine**material.flatness, 0)
    if isinstance(material, CookTorrance):
        let_in = 1 - schlick(material.reflectance, cosine)
        let_out = 1 - schlick(material.reflectance, np.clip(_dot(normal, eye), 0, 1))
        return material.diffuse * let_in * let_out * cosine
    if isinstance(material, AshikhminShirley):
        base = 28 / 23 * material.diffuse * (1 - material.reflectance)
        return base * _coupled(cosine) * _coupled(np.clip(_dot(normal, eye), 0, 1)) * cosine
    if isinstance(material, (Lambert, Phong)):
        return material.diffuse * cosine
    if isinstance(material, Toon):
        return cosine
    return np.zeros_like(cosine)


def specular_term(
    material: Material, normal: ArrayLike, light: ArrayLike, eye: ArrayLike
) -> Floats:
    """Return the specular term, (…) ≥ 0; 0 for materials that have none."""
    normal, light, eye = _visible(normal, light, eye)
    cosine = np.clip(_dot(normal, light), 0, 1)
    if isinstance(material, Phong):
        along = np.clip(_dot(reflected(normal, eye), light), 0, 1)
        return material.specular * np.where(along > 0, along**material.shininess, 0)
    if not isinstance(material, (CookTorrance, AshikhminShirley)):
        return np.zeros_like(cosine)
    half = light + eye
    half = half / np.maximum(np.linalg.norm(half, axis=-1, keepdims=True), 1e-12)
    nh, eh = np.clip(_dot(normal, half), 0, 1), np.maximum(_dot(eye, half), GRAZING)
    ne = np.maximum(_dot(normal, eye), GRAZING)
    mirror = schlick(material.reflectance, np.minimum(eh, 1))
    if isinstance(material, CookTorrance):
        # π F D G ⟨n·l⟩ / (4 n·l n·e), with G = min(1, 2 n·h n·e / e·h, 2 n·h n·l / e·h).
        slope = material.roughness**2
        c2 = np.maximum(nh * nh, GRAZING)
        facets = np.exp((c2 - 1) / (c2 * slope)) / (slope * c2 * c2)
        lit = np.minimum(np.minimum(1 / ne, 2 * nh / eh), 2 * nh * cosine / (eh * ne))
        return np.where(cosine > 0, mirror * facets * lit / 4, 0)
    # π ρ_s ⟨n·l⟩ = (n+1)/8 (n·h)^n F / (e·h max(n·l, n·e)) ⟨n·l⟩
    power = np.where(nh > 0, nh**material.shininess, 0)
    value = (material.shininess + 1) / 8 * power * mirror * cosine / (eh * np.maximum(cosine, ne))
    return np.where(cosine > 0, value, 0)


def soft_steps(intensity: ArrayLike, *, bins: int, sharpness: float) -> Floats:
    """Quantise to ``bins`` steps with soft transitions (Winnemöller et al. 2006, METHODS §7).

    Q = q + (Δ/2) tanh(φ(I − q)/Δ) / tanh(φ/2), q the nearest multiple of Δ = 1/bins. Continuous
    and monotonic: it jumps nowhere, and 0 and 1 stay.
    """
    value: Floats = np.clip(np.asarray(intensity), 0, 1)
    edge = np.round(value * bins)
    within = np.tanh(sharpness * (value * bins - edge)) / (2 * np.tanh(sharpness / 2))
    return np.clip((edge + within) / bins, 0, 1).astype(value.dtype)


def schlick(reflectance: float, cosine: Floats) -> Floats:
    """Return Schlick's Fresnel term F = R + (1 − R)(1 − cos)^5."""
    return reflectance + (1 - reflectance) * (1 - cosine) ** 5


def towards_visible(normal: ArrayLike, eye: ArrayLike) -> Floats:
    """Return the eye, mirrored in the tangent plane of points that face away from it."""
    normal, eye = np.asarray(normal), np.asarray(eye)
    return eye - 2 * np.minimum(_dot(normal, eye), 0)[..., None] * normal


def reflected(normal: ArrayLike, eye: ArrayLike) -> Floats:
    """Return r = 2(n·e)n − e, where a mirror looks."""
    normal, eye = np.asarray(normal), np.asarray(eye)
    return 2 * _dot(normal, eye)[..., None] * normal - eye


def refracted(normal: ArrayLike, eye: ArrayLike, *, refraction: float) -> Floats:
    """Return where the line of sight goes on behind the surface (Snell).

    Parameters
    ----------
    refraction : float
        Index behind the surface over that before it, ≥ 1: there is no total reflection.
    """
    normal, eye = np.asarray(normal), np.asarray(eye)
    c, ratio = np.clip(_dot(normal, eye), 0, 1)[..., None], 1 / refraction
    return (ratio * c - np.sqrt(1 + ratio**2 * (c * c - 1))) * normal - ratio * eye


def _coupled(cosine: Floats) -> Floats:
    """Return Ashikhmin and Shirley's 1 − (1 − cos/2)^5."""
    return 1 - (1 - cosine / 2) ** 5


def _visible(normal: ArrayLike, light: ArrayLike, eye: ArrayLike) -> tuple[Floats, Floats, Floats]:
    return np.asarray(normal), np.asarray(light), towards_visible(normal, eye)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.einsum("...i,...i->...", a, b)
