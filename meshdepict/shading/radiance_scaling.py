"""Radiance Scaling (Vergne, Pacanowski, Barla, Granier and Schlick, TVCG 2011)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import (
    LitSphere,
    Mirror,
    Refractive,
    ambient_term,
    as_material,
)
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.direct import quantised
from meshdepict.shading.enhancement import Enhancement
from meshdepict.shading.features import (
    Bins,
    CurvatureKind,
    Foreshortening,
    Gain,
    LightCount,
    Magnitude,
    MaterialName,
    Parameter,
    Scale,
    Scaling,
    convexity,
    curved,
    eyes,
)
from meshdepict.shading.gathering import PLAIN, Gathering
from meshdepict.shading.hidden_light import albedo, hidden_direct, refuse_unhidden
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shading.reached import (
    USUAL_RAYS,
    Bounces,
    Denoise,
    RaysOfAll,
    Reached,
    Shadows,
    reached,
)
from meshdepict.shading.sampled import used_rays
from meshdepict.shading.scaling_equation import LEAST_INVARIANT, scaling
from meshdepict.shading.scaling_reads import scaling_bends, scaling_reads
from meshdepict.shading.surroundings import (
    as_environment,
    gathered,
    luminance,
    seen,
    sphere_colors,
)

__all__ = ["LEAST_INVARIANT", "radiance_scaling", "scaling"]

Floats = NDArray[Any]
Single = NDArray[np.float32]

_BRIGHTEST = np.float32(1e10)  # that is scaled again, by e^60 at most, where light is mirrored


@method(
    scales=1,
    reads=scaling_reads,
    linear=True,
    lights="several",
    needs=("curvature",),
    compared={"material": "lambert", "magnitude": 4.0},  # as Local Light Alignment, figs. 13 and 14
    source="Radiance Scaling (Vergne et al. 2011)",
)
def radiance_scaling(
    space: ScaleSpace,
    light: LightsLike,
    *,
    view: View | str = "front",
    material: MaterialName = "phong",
    curvature: CurvatureKind = "object",
    scale: Scale = 1,
    gain: Gain = None,
    foreshortening: Foreshortening = 1.0,
    magnitude: Annotated[float, Range(0, 1e30, help="γ of every term", soft=(0, 20))] = 4.0,
    ambient_magnitude: Magnitude = None,
    diffuse_magnitude: Magnitude = None,
    specular_magnitude: Magnitude = None,
    invariant: Annotated[
        float, Range(0, 1, help="α: the reflectance that curvature leaves alone")
    ] = 0.5,
    anisotropy: Annotated[
        float, Range(-1, 1, help="1: curvature along the light counts, −1: across it")
    ] = 0.0,
    warping: Annotated[
        float, Range(-1e30, 1e30, help="magnitude of Light Warping before it", soft=(-4, 4))
    ] = 0.0,
    illumination: Annotated[
        str,
        Choice(
            ("lights", "irradiance", "occlusion"),
            help="light by light, or what is precomputed: irradiance, ambient occlusion",
        ),
    ] = "lights",
    lights: LightCount = 54,
    shadows: Shadows = False,
    bounces: Bounces = 0,
    enhance: Annotated[
        str,
        Choice(
            ("first", "all"),
            help="light that bounced: scaled where the eye sees it, or at every bounce",
        ),
    ] = "first",
    rays: RaysOfAll = 0,
    denoise: Denoise = 0.0,
    shininess: Parameter = None,
    roughness: Parameter = None,
    bins: Bins = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Brighten light on convexities and darken it in concavities, each term of a material alone.

    ``L' = Σ_j ρ_j · scaling(κ, δ_j) · L_j``: reflected light above the invariant point is scaled up
    where the surface is convex and down where it is concave, light below it the other way.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale, unless ``scale=0``.
    light : light, several, or an Environment
        As in `meshdepict.scene.names.as_lights`. Mirrors, refraction and irradiance need an
        Environment; lit spheres and occlusion have no use for light.
    material : str or Material
        As in `meshdepict.scene.material`: each has its own reflectance mapping δ (METHODS §5).
    curvature : {"object", "view"}
        See `meshdepict.shading.features.features`.
    gain : float, optional
        Factor on curvature before κ = tanh(…). The defaults, 0.7 (object) and 2.5 (view), were
        chosen by eye on the bunny, the armadillo and Lucy: at twice that, legs and folds are burnt
        out, at a quarter fur and plates hardly differ from plain Phong.
    foreshortening : float
        Of curvature="view": f in the slope (−n_x, −n_y)/n_z^f. 1 is Light Warping's, 0.4 is in the
        authors' released shader: slants and silhouettes bend less.
    magnitude : float
        γ. The paper shows 10 and 20 on smooth models; 4 is the setting of LLA fig. 14.
    ambient_magnitude, diffuse_magnitude, specular_magnitude : float, optional
        γ of one term, in place of `magnitude`.
    invariant : float
        α.
    anisotropy : float
        λ of the anisotropic curvature mapping; the paper uses small ones with a single light.
    warping : float
        α of Light Warping, whose directions are then scaled (fig. 14); 0: none.
    illumination : {"lights", "irradiance", "occlusion"}
        "irradiance": albedo/π · A · irradiance of an Environment with δ its share of the largest
        (fig. 8a). "occlusion": A alone, which is δ too (fig. 8b).
    shadows, bounces : bool, int
        With light by light alone. Light that comes by rays, from the sky and by bounces, is scaled
        ray by ray, δ = n·d, by κ without its anisotropy; the ambient term neither is hidden nor
        bounces. Highlights, too, are of what rays meet: the sky or the surface. A mirror shows the
        surface: mirrored as often as bounces says, then the environment, or nothing where shadows
        hide that. A refractive body lets light out by up to so many walls within.
    enhance : {"first", "all"}
        "all" is the paper's fig. 11, of the surface's own curvature. Where albedo times scaling is
        above 1 light grows from bounce to bounce: the sum of so many bounces is finite still, and
        what is beyond 1 is cut.
    rays : int
        For A; 0: A = 1, but for illumination="occlusion" 256, and 64 with shadows and bounces.

    Returns
    -------
    (n,) array, (n, 3) in colour
        Linear values in [0, 1].

    Raises
    ------
    MeshdepictError
        For a scale that is not there, light that does not go with the material, and shadows or
        bounces of what has none.
    """
    if shadows or bounces:
        refuse_unhidden(as_material(material), illumination, shadows=shadows)
        if enhance == "all" and curvature != "object":
            raise MeshdepictError(
                f"enhance='all' is of the surface's own curvature: leave curvature={curvature!r} "
                "out, or take enhance='first'"
            )
    chosen, eye, frames = curved(
        space, view, material, curvature=curvature, scale=scale, gain=gain,
        foreshortening=foreshortening,
        needed=scaling_bends(
            as_material(material), gain, magnitude=magnitude, ambient_magnitude=ambient_magnitude,
            diffuse_magnitude=diffuse_magnitude, specular_magnitude=specular_magnitude,
            warping=warping,
        ),
        shininess=shininess, roughness=roughness, bins=bins,
    )  # fmt: skip
    gamma_a, gamma_d, gamma_s = (
        magnitude if own is None else own
        for own in (ambient_magnitude, diffuse_magnitude, specular_magnitude)
    )
    kappa = np.zeros(space.count, np.float32)
    if frames is not None:
        kappa = np.tanh(-(frames.ku + frames.kv))

    def scaled(value: Floats, delta: ArrayLike, gamma: float) -> Floats:
        return (value.T * scaling(kappa, delta, invariant=invariant, magnitude=gamma)).T

    def bend_of_vertices() -> Single:
        vertices = space.vertex_space
        if vertices is space:
            return kappa
        return convexity(
            vertices, eye, curvature=curvature, scale=scale, gain=gain,
            foreshortening=foreshortening,
        )  # fmt: skip

    if isinstance(chosen, LitSphere):
        colors = sphere_colors(space, eye, chosen, kappa)
        shaded = scaled(colors, luminance(colors), gamma_d)
    elif isinstance(chosen, (Mirror, Refractive)):
        brightest = np.float32(max(as_environment(light, type(chosen).__name__).brightest, 1e-30))

        def mirrored(shown: Floats, bend: Floats) -> Floats:
            delta = luminance(shown) / brightest
            factor = scaling(bend, delta, invariant=invariant, magnitude=gamma_s)
            return np.minimum(shown.T * factor, _BRIGHTEST).T

        on_the_way = None
        if enhance == "all" and bounces and frames is not None and gamma_s:
            on_the_way = mirrored, space.on_surface(bend_of_vertices())
        shown = seen(
            space, light, eye, chosen, frames, warping, shadows=shadows, bounces=bounces,
            rays=used_rays(space, rays or USUAL_RAYS), scaled=on_the_way,
        )  # fmt: skip
        shaded = scaled(shown, luminance(shown) / brightest, gamma_s)
    elif illumination != "lights":
        if isinstance(rays, str):
            raise MeshdepictError(
                f"illumination={illumination!r} takes a number of rays, 256 for instance: "
                f"rays={rays!r} is for shadows and bounces"
            )
        value, delta = gathered(space, light, chosen, illumination=illumination, rays=rays)
        shaded = scaled(value, delta, gamma_d)
    else:
        alpha = float(np.clip(invariant, LEAST_INVARIANT, 1 - LEAST_INVARIANT))
        lamps, environments = parted(light, eye)
        ambient = ambient_term(chosen)
        reach = Reached((None,) * len(lamps))
        if shadows or bounces:
            gathering: Gathering = PLAIN
            if frames is not None and gamma_d and (bounces or environments):
                gathering = Enhancement(bend_of_vertices(), gamma_d, alpha, enhance == "all")

            def displayed(light: Floats) -> Floats:
                return linear_to_srgb(exposed(ambient + albedo(chosen) * light, exposure))

            reach = reached(
                space, lamps, environments, shadows=shadows, bounces=bounces,
                rays=rays or USUAL_RAYS, denoise=denoise, albedo=albedo(chosen),
                shown=displayed, gathering=gathering,
            )  # fmt: skip
        shaded = hidden_direct(
            space, lamps, eyes(space, eye), chosen, reach, environments=environments, count=lights,
            rays=used_rays(space, rays or USUAL_RAYS), frames=frames, warping=warping,
            scaling=Scaling(gamma_d, gamma_s, alpha, anisotropy),
        )  # fmt: skip
        if ambient:
            everywhere = np.full(len(kappa), ambient, np.float32)
            shaded = (shaded.T + scaled(everywhere, np.float32(1), gamma_a)).T
    return exposed(quantised(shaded, chosen, exposure), exposure)
