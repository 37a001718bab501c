"""Local Light Alignment (Mestres, Vergne, Noûs and Thollot, Eurographics 2021)."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.material import (
    AshikhminShirley,
    CookTorrance,
    Lambert,
    Material,
    Phong,
    adjusted,
    ambient_term,
    as_material,
)
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.aligned_gathering import Alignment
from meshdepict.shading.alignment_equations import align, confidence, transition
from meshdepict.shading.alignment_terms import aligned_terms, lit_by, visible_eye
from meshdepict.shading.direct import kernel_parameters
from meshdepict.shading.features import LightCount, Parameter, eyes, sight
from meshdepict.shading.gathering import PLAIN, Gathering
from meshdepict.shading.hidden_light import albedo, hidden_direct, matt
from meshdepict.shading.lobe_samples import LobeSamples
from meshdepict.shading.lobes import aligned_lobes, aligned_samples, needs_samples
from meshdepict.shading.method import Exposure, exposed, method, require_smoothing
from meshdepict.shading.reached import (
    USUAL_RAYS,
    Bounces,
    Denoise,
    LightRays,
    Reached,
    Shadows,
    ray_count,
    reached,
)
from meshdepict.shading.sampled import used_rays
from meshdepict.shading.seen_through import background_light

__all__ = ["align", "confidence", "light_alignment", "transition"]

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
    shadows: bool,
    bounces: int,
    rays: int | str,
    **_: Any,
) -> Reads:
    """Return the shape's own normals, both of every pair of scales that turns light, and rays."""
    strengths = [per_scale(last, strength, "strength")] if last else []
    if last and not isinstance(as_material(material), Lambert):
        strengths.append(per_scale(last, specular_strength, "specular_strength"))
    if last and transmitted > 0:
        strengths.append(per_scale(last, transmitted_strength, "transmitted_strength"))
    within = interfaces == 2 and bool(transmitted or background)
    count = ray_count(shadows=shadows, bounces=1 if within else bounces, rays=rays)
    return Reads(normals=frozenset(aligned_scales(*strengths)), rays=count)


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
    shadows: Shadows = False,
    bounces: Bounces = 0,
    rays: LightRays = USUAL_RAYS,
    denoise: Denoise = 0.0,
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
    shadows, bounces : bool, int
        A light is hidden by what lies where it is, and shades from where it is turned to; so does
        each ray that brings what the sky sends and surfaces send on, before which light bounces as
        ever. Highlights have rays and guides of their own, and are of the same sky and surface.
        Transmitted light is not hidden.
    rays : int
        Also through a body with two interfaces.

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
    lamps, environments = parted(light, eye)
    reach = Reached((None,) * len(lamps))
    if shadows or bounces:
        gathering: Gathering = PLAIN
        if diffuse_strength.any():
            of = tuple(scales), diffuse_strength, sharpness
            gathering = Alignment(normals, *of)
            if bounces or environments:
                vertices = space.vertex_space
                gathering = Alignment(vertices.planes_of(scales), *of, vertices=vertices)

        def displayed(light: NDArray[Any]) -> NDArray[Any]:
            value = np.float32(ambient_term(surface)) + albedo(surface) * light
            return linear_to_srgb(exposed(value, exposure))

        reach = reached(
            space, lamps, environments, shadows=shadows, bounces=bounces, rays=rays,
            denoise=denoise, albedo=albedo(surface), shown=displayed, gathering=gathering,
        )  # fmt: skip
    clear = transmitted if interfaces == 1 else 0.0
    if (shadows or bounces) and not clear and not any(each.any() for each in used):
        plain = hidden_direct(
            space, lamps, eyes(space, eye), surface, reach, environments=environments,
            count=lights, rays=used_rays(space, rays),
        )  # fmt: skip
        total = np.float32(ambient_term(surface)) + (plain if plain.ndim == 2 else plain[:, None])
    else:
        terms = aligned_terms(
            normals, eyes(space, eye), surface, transmitted=clear, refraction=refraction,
            frosting=frosting, sharpness=sharpness, diffuse_strength=diffuse_strength,
            specular_strength=glossy_strength, transmitted_strength=clear_strength,
        )  # fmt: skip
        total = np.full((space.count, 1), ambient_term(surface), np.float32)
        for lamp, share in zip(lamps, reach.seen, strict=True):
            total = total + lit_by(lamp, terms, share)
        kind, parameters = kernel_parameters(surface)
        if reach.around is not None:
            came = (matt(surface, normals[0].T, eyes(space, eye)) * reach.around.T).T
            total = total + (came if came.ndim == 2 else came[:, None])
        if reach.around is not None and "glossy" in terms and parameters[1] > 0:
            from meshdepict.shading.hidden_lobes import hidden_lobes

            count = max(lights, used_rays(space, rays))

            def samples(environment: Environment) -> list[LobeSamples]:
                return aligned_samples(
                    normals, eyes(space, eye), environment, kind, parameters,
                    count=count, sharpness=sharpness, strengths=glossy_strength,
                )  # fmt: skip

            asked = kind, parameters, count, eyes(space, eye), scales, glossy_strength, sharpness
            gloss = hidden_lobes(space, environments, samples, sent=reach.sent, question=asked)
            total = total + (gloss if gloss.ndim == 2 else gloss[:, None])
        sampled = [e for e in environments if needs_samples(e, kind, parameters)]
        for environment in environments:
            # What comes by rays is no matter of lights, nor are lobes where those won't do.
            elsewhere = {"matt", "glossy"} if reach.around is not None else set()
            elsewhere |= {"glossy"} if environment in sampled else set()
            own = {name: term for name, term in terms.items() if name not in elsewhere}
            for lamp in environment.lights(lights) if own else ():
                total = total + lit_by(lamp, own)
        for environment in sampled if reach.around is None else ():
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
            strengths=clear_strength, rays=used_rays(space, rays),
        )  # fmt: skip
    elif background:
        own = normals[0]
        for sky in environments or (None,):
            total = total + np.float32(background) * background_light(
                own, visible_eye(own, eyes(space, eye)), sky,
                refraction=refraction, frosting=frosting,
            )  # fmt: skip
    return exposed(total[:, 0] if total.shape[1] == 1 else total, exposure)


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
