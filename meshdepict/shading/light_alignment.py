"""Local Light Alignment (Mestres, Vergne, Noûs and Thollot, Eurographics 2021)."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import (
    AshikhminShirley,
    CookTorrance,
    Lambert,
    Material,
    Phong,
    adjusted,
    ambient_term,
    as_material,
    diffuse_term,
    specular_term,
)
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.direct import kernel_parameters
from meshdepict.shading.features import LightCount, Parameter, eyes, sight
from meshdepict.shading.lobes import aligned_lobes, needs_samples
from meshdepict.shading.method import Exposure, exposed, method, require_smoothing
from meshdepict.shading.reached import USUAL_RAYS
from meshdepict.shading.seen_through import background_light, transmitted_guides
from meshdepict.shading.transmission import rough_transmission

__all__ = ["align", "confidence", "light_alignment", "transition"]

# The light has no direction in the base plane where it stands along the base's normal: there the
# confidence fades to zero continuously, as ‖l̄‖/√(‖l̄‖² + ε²).
_SINGULAR = 1e-3
_NO_TURN = 1e-12  # ‖t‖ below which light and guide are one

Term = Callable[[NDArray[np.float64]], NDArray[np.float32]]
AlignedMaterial = Annotated[
    str | Lambert | Phong | CookTorrance | AshikhminShirley,
    Choice(
        ("lambert", "phong", "cook_torrance", "ashikhmin_shirley"),
        help="what light does",
        also=(Lambert, Phong, CookTorrance, AshikhminShirley),
    ),
]
Strength = Annotated[
    float | tuple[float, ...],
    Range(0, 1, help="share of the way to the guide, one for all scales or finest,…,coarsest"),
]


def transition(confidence: ArrayLike, sharpness: float) -> NDArray[np.float64]:
    """Return W_γ(λ) = λ / (e^−γ (1 − λ) + λ): 0 at 0, 1 at 1, λ itself for γ = 0."""
    share = np.asarray(confidence, float)
    return share / np.maximum(np.exp(-sharpness) * (1 - share) + share, np.finfo(float).tiny)


def confidence(light: ArrayLike, normal: ArrayLike, base: ArrayLike) -> NDArray[np.float64]:
    """Return λ = λ1 λ2 in [0, 1]: how far the light is from where its guide switches (§4).

    λ1 is 0 where the light changes sides and on a dark side that turns away from the base; λ2,
    the sine between normal and base, is 0 where there is no feature.
    """
    l, n, z = (np.asarray(v, float) for v in (light, normal, base))  # noqa: E741
    c, along_x, along_y, length = _frame(l, n, z)
    level = np.linalg.norm(np.cross(l, z), axis=-1)
    first = 2 / np.pi * np.arctan2(np.abs(along_x), np.abs(along_y))
    first = first * level / np.sqrt(level**2 + _SINGULAR**2)
    first = np.where((along_x >= 0) | (c > 0), first, 0.0)
    return np.clip(first * length, 0, 1)


def align(
    light: ArrayLike,
    normal: ArrayLike,
    base: ArrayLike,
    *,
    strength: float,
    sharpness: float = 3.0,
) -> NDArray[np.float64]:
    """Turn a light towards the normal on a feature's bright side, off it on the dark one (eq. 1).

    Parameters
    ----------
    light, normal, base : (…, 3) array_like
        Unit vectors, broadcast against each other: the light of the next coarser scale, the
        normal at this scale and at the next coarser one. In place of normals, reflected or
        transmitted view vectors align highlights or refractions (§6).
    strength : float
        σ in [0, 1]: 0 leaves the light as it is, 1 turns it all the way where the confidence is 1.
    sharpness : float
        γ ≥ 0: larger values narrow the transition from bright to dark.

    Returns
    -------
    (…, 3) array of float64
        Unit vectors.
    """
    l, n, z = np.broadcast_arrays(*(np.asarray(v, float) for v in (light, normal, base)))  # noqa: E741
    c, along_x, _, length = _frame(l, n, z)
    # In the frame x = (n − c z)/n_x the paper's R(y, −π/2) n = −n_z x + n_x z is (z − n_z n)/n_x.
    dark = (z - c[..., None] * n) / np.where(length > 0, length, 1.0)[..., None]
    guide = np.where((along_x >= 0)[..., None], n, dark)
    cosine = np.einsum("...i,...i->...", guide, l)
    sine = np.linalg.norm(np.cross(l, guide), axis=-1)
    angle = strength * transition(confidence(l, n, z), sharpness) * np.arctan2(sine, cosine)
    towards = guide - cosine[..., None] * l
    size = np.linalg.norm(towards, axis=-1)
    towards = towards / np.where(size < _NO_TURN, 1.0, size)[..., None]
    turned = np.cos(angle)[..., None] * l + np.sin(angle)[..., None] * towards
    return np.where((size < _NO_TURN)[..., None], l, turned)


def _frame(
    light: NDArray[Any], normal: NDArray[Any], base: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Return n_z, n_x l·x, n_x l·y and n_x in the local frame of §4."""
    across = np.cross(base, normal)
    c = np.einsum("...i,...i->...", normal, base)
    along_z = np.einsum("...i,...i->...", light, base)
    along_x = np.einsum("...i,...i->...", light, normal) - along_z * c
    along_y = np.einsum("...i,...i->...", light, across)
    return c, along_x, along_y, np.linalg.norm(across, axis=-1)


def _reads(
    last: int,
    *,
    material: str | Material,
    strength: float | Sequence[float],
    specular_strength: float | Sequence[float],
    transmitted: float,
    transmitted_strength: float | Sequence[float],
    background: float,
    interfaces: int,
    **_: Any,
) -> Reads:
    """Return the shape's own normals, and both of every pair of scales that turns light."""
    strengths = [per_scale(last, strength, "strength")] if last else []
    if last and not isinstance(as_material(material), Lambert):
        strengths.append(per_scale(last, specular_strength, "specular_strength"))
    if last and transmitted > 0:
        strengths.append(per_scale(last, transmitted_strength, "transmitted_strength"))
    within = interfaces == 2 and bool(transmitted or background)
    return Reads(normals=frozenset(aligned_scales(*strengths)), rays=USUAL_RAYS if within else 0)


def aligned_scales(*strengths: NDArray[Any]) -> list[int]:
    """Return the scales that are read for strengths (S − 1,), finest first: 0 always."""
    turning = {int(i) for each in strengths for i in np.flatnonzero(each > 0)}
    return sorted({0} | turning | {i + 1 for i in turning})


def strengths_between(scales: Sequence[int], strengths: NDArray[Any]) -> NDArray[Any]:
    """Return the strengths of the pairs of some scales: 0 of those that don't follow each other."""
    pairs = itertools.pairwise(scales)
    return np.array([strengths[i] if j == i + 1 else 0.0 for i, j in pairs], float)


@method(
    scales=5,
    ratio=1.7,
    reads=_reads,
    linear=True,
    lights="several",
    light="key-and-fill",
    compared={},
    source="Local Light Alignment (Mestres et al. 2021)",
)
def light_alignment(
    space: ScaleSpace,
    light: LightsLike,
    *,
    view: View | str = "front",
    material: AlignedMaterial = "lambert",
    strength: Strength = 0.3,
    specular_strength: Strength = 0.3,
    sharpness: Annotated[
        float, Range(0, 20, help="γ: how narrow transitions from bright to dark are", soft=(0, 8))
    ] = 3.0,
    diffuse: Parameter = None,
    specular: Parameter = None,
    shininess: Parameter = None,
    roughness: Parameter = None,
    transmitted: Annotated[
        float, Range(0, 1e6, help="weight of light seen through the surface", soft=(0, 1))
    ] = 0.0,
    transmitted_strength: Strength = 0.4,
    refraction: Annotated[float, Range(1, 10, help="index of refraction", soft=(1, 2.5))] = 1.5,
    frosting: Annotated[
        float, Range(0.01, 1, help="roughness of the surface that light comes through")
    ] = 0.3,
    background: Annotated[
        float,
        Range(0, 1e6, help="weight of what shows through: the environment, or white", soft=(0, 1)),
    ] = 0.0,
    interfaces: Annotated[
        int,
        Range(1, 2, help="light comes through the surface alone, or through the body, by two"),
    ] = 1,
    lights: LightCount = 54,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Turn the light at every point and scale so that each feature has a bright and a dark side.

    From coarse to fine, the light is turned towards the normal on the side of a feature that
    faces it and perpendicular to it on the other; then the material is shaded as ever. Each of the
    material's terms has a light of its own: highlights follow the reflected, transmission the
    refracted view.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale.
    light : light, several, or an Environment
        As in `meshdepict.scene.names.as_lights`.
    view : View or str
        Where the eye is; it matters to highlights and transmitted light. Points that face away
        from it are shaded for the eye mirrored in their tangent plane.
    material : str or Material
        "lambert", "phong", "cook_torrance" or "ashikhmin_shirley".
    strength, specular_strength, transmitted_strength : float or sequence of float
        σ_i of eq. 1, one for all scales or one each, finest first. The paper's figures use
        .5,.3,.1,.2,.2 (fig. 7), .9,.6,.4,.2,.3,.2 (fig. 9), for highlights .4,.2,0,.3 and for
        transmission .7,.3,.25,.6 (fig. 8). The default, 0.3 for all, was chosen on scans by eye:
        the dark side of the bunny shows its fur and flat lit parts are not yet mottled.
    diffuse, specular, shininess, roughness : float, optional
        In place of the material's own, for materials that have them.
    transmitted, refraction, frosting : float
        Weight, index and roughness of rough transmission (Walter et al. 2007), which shows light
        from behind.
    background : float
        Weight of the background seen through the surface by the same index and roughness (fig. 8):
        an Environment's radiance, or white behind lights of other kinds. It has no light to align.
    interfaces : {1, 2}
        1: what is seen through the surface is lit as if glass went on for ever. 2: rays go through
        the body, are refracted or mirrored at up to four walls within, and see lights and the
        background outside; light is aligned with the guides of 1, turned to where rays leave.
        Where the mesh is open and a ray finds no wall it leaves as it goes, and meets no light.

    Raises
    ------
    MeshdepictError
        If the scale space has no smoothed scale, for another number of strengths, and for a
        parameter that the material does not have.
    """
    require_smoothing(space, "Local Light Alignment", scales=5)
    given = {
        "diffuse": diffuse, "specular": specular, "shininess": shininess, "roughness": roughness,
    }  # fmt: skip
    surface = adjusted(as_material(material), **given)
    eye = sight(view, space, fitted=False)
    diffuse_strength = per_scale(space.last, strength, "strength")
    glossy_strength = per_scale(space.last, specular_strength, "specular_strength")
    clear_strength = per_scale(space.last, transmitted_strength, "transmitted_strength")
    used = [diffuse_strength]
    used += [] if isinstance(surface, Lambert) else [glossy_strength]
    used += [clear_strength] if transmitted > 0 else []
    scales = aligned_scales(*used)
    normals = space.planes_of(scales)
    diffuse_strength, glossy_strength, clear_strength = (
        strengths_between(scales, each)
        for each in (diffuse_strength, glossy_strength, clear_strength)
    )
    terms = _terms(
        normals, eyes(space, eye), surface, transmitted=transmitted if interfaces == 1 else 0.0,
        refraction=refraction, frosting=frosting, sharpness=sharpness,
        diffuse_strength=diffuse_strength,
        specular_strength=glossy_strength, transmitted_strength=clear_strength,
    )  # fmt: skip
    total = np.full((space.count, 1), ambient_term(surface), np.float32)
    lamps, environments = parted(light, eye)
    kind, parameters = kernel_parameters(surface)
    sampled = [e for e in environments if needs_samples(e, kind, parameters)]
    matt = {name: term for name, term in terms.items() if name != "glossy"}
    for group, shown in (
        (lamps, terms),
        *((e.lights(lights), matt if e in sampled else terms) for e in environments),
    ):
        for lamp in group:
            color = lamp.color.astype(np.float32)
            shaded = np.sum([term(lamp.direction) for term in shown.values()], axis=0)
            total = total + shaded[:, None] * (color[:1] if np.ptp(color) == 0 else color)
    for environment in sampled:
        total = total + aligned_lobes(
            normals, eyes(space, eye), environment, kind, parameters,
            count=lights, sharpness=sharpness, strengths=glossy_strength,
        )  # fmt: skip
    if interfaces == 2 and (transmitted or background):
        from meshdepict.shading.aligned_glass import aligned_glass

        lamps = [*lamps, *(lamp for sky in environments for lamp in sky.lights(lights))]
        towards = visible_eye(normals[0], eyes(space, eye))
        total = total + aligned_glass(
            space, normals, towards, lamps, environments, transmitted=transmitted,
            background=background, refraction=refraction, frosting=frosting, sharpness=sharpness,
            strengths=clear_strength,
        )  # fmt: skip
    elif background:
        own = normals[0]
        for sky in environments or (None,):
            total = total + np.float32(background) * background_light(
                own, visible_eye(own, eyes(space, eye)), sky,
                refraction=refraction, frosting=frosting,
            )  # fmt: skip
    return exposed(total[:, 0] if total.shape[1] == 1 else total, exposure)


def _terms(
    normals: NDArray[np.float32],
    eye: NDArray[np.float32],
    surface: Material,
    *,
    transmitted: float,
    refraction: float,
    frosting: float,
    sharpness: float,
    diffuse_strength: NDArray[Any],
    specular_strength: NDArray[Any],
    transmitted_strength: NDArray[Any],
) -> dict[str, Term]:
    """Return the terms that there are, each from a light to (n,), with guides of its own."""
    from meshdepict.shading.alignment_kernel import align_chain

    finest = normals[0]

    def matt(light: NDArray[Any]) -> NDArray[np.float32]:
        turned = align_chain(normals, light, diffuse_strength, sharpness)
        if isinstance(surface, (Lambert, Phong)):  # in a tenth of the time
            return np.float32(surface.diffuse) * np.maximum(_dot(finest, turned), 0)
        return diffuse_term(surface, finest.T, turned.T, eye.T)

    found: dict[str, Term] = {"matt": matt}
    if transmitted == 0 and isinstance(surface, Lambert):
        return found
    eye = visible_eye(finest, eye)
    if not isinstance(surface, Lambert):
        reflected = np.stack([2 * _dot(n, eye) * n - eye for n in normals])

        def glossy(light: NDArray[Any]) -> NDArray[np.float32]:
            turned = align_chain(reflected, light, specular_strength, sharpness)
            return specular_term(surface, finest.T, turned.T, eye.T) * (_dot(finest, turned) > 0)

        found["glossy"] = glossy
    if transmitted > 0:
        through = transmitted_guides(normals, eye, refraction)

        def clear(light: NDArray[Any]) -> NDArray[np.float32]:
            turned = align_chain(through, light, transmitted_strength, sharpness)
            shown = rough_transmission(
                finest, eye, turned, refraction=refraction, roughness=frosting
            )
            return np.float32(transmitted) * shown

        found["clear"] = clear
    return found


def visible_eye(normals: NDArray[np.float32], eye: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the eye (3, n), mirrored in the tangent plane of points that face away from it."""
    return eye - np.float32(2) * np.minimum(_dot(normals, eye), np.float32(0)) * normals


def per_scale(steps: int, strength: float | Sequence[float], name: str) -> NDArray[Any]:
    """Return one strength per pair of scales, of which there are so many, finest first."""
    values = np.asarray(strength, float)
    if values.ndim == 0:
        return np.full(steps, float(values))
    if values.shape != (steps,):
        raise MeshdepictError(
            f"light_alignment: {name} has {values.size} values for {steps} scales; give one for "
            "all, or one for each, finest first"
        )
    return values


def _dot(a: NDArray[np.float32], b: NDArray[np.float32]) -> NDArray[np.float32]:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
