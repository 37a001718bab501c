"""Light Warping (Vergne, Pacanowski, Barla, Granier and Schlick, SIGGRAPH 2009)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Range, Samples
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import (
    HalfLambert,
    LitSphere,
    Material,
    Mirror,
    Refractive,
    ambient_term,
    as_material,
)
from meshdepict.scene.names import LightsLike, parted
from meshdepict.scene.view import View
from meshdepict.shading.direct import quantised
from meshdepict.shading.features import (
    Bins,
    CurvatureKind,
    Foreshortening,
    Frames,
    Gain,
    Importance,
    LightCount,
    MaterialName,
    Parameter,
    Scale,
    bends,
    curved,
    eyes,
    features,
    frames_key,
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
    ray_count,
    reached,
)
from meshdepict.shading.sampled import used_rays
from meshdepict.shading.surroundings import as_environment, seen
from meshdepict.shading.warp_equations import jacobian, unwarp, warp, warp_scale
from meshdepict.shading.warped_gathering import Warping
from meshdepict.shading.warping_integral import integral
from meshdepict.transport.rays import probed

__all__ = ["jacobian", "light_warping", "unwarp", "warp", "warp_scale"]

Single = NDArray[np.float32]

_OPENNESS_RAYS = 256


def _bends(magnitude: float, gain: float | None) -> bool:
    return magnitude != 0 and gain != 0


def _reads(
    last: int,
    *,
    material: str | Material,
    roughness: float | None,
    curvature: str,
    scale: int,
    gain: float | None,
    magnitude: float,
    illumination: str,
    shadows: bool,
    bounces: int,
    rays: int | str,
    importance: ArrayLike | Samples | str | None,
    **_: Any,
) -> Reads:
    """Return the shape's own normals, with what bends light, and rays if they are wanted."""
    hidden = ray_count(shadows=shadows, bounces=bounces, rays=rays or USUAL_RAYS)
    if isinstance(shown := as_material(material), (Mirror, Refractive)):  # a smooth one has one ray
        rough = roughness or shown.roughness
        count = ray_count(shadows=False, bounces=1, rays=rays or USUAL_RAYS) if rough else 1
        hidden = int(shadows or bounces > 0) * count
    open_rays = 0 if isinstance(rays, str) else rays  # which occlusion refuses
    gathered = (open_rays or _OPENNESS_RAYS) if illumination == "occlusion" else hidden
    own = Reads(normals=frozenset((0,)), rays=gathered)
    return own | bends(scale, curvature, importance, last) if _bends(magnitude, gain) else own


@method(
    scales=1,
    reads=_reads,
    linear=True,
    lights="several",
    needs=("curvature",),
    light="studio",
    compared={"magnitude": 16.62},  # Local Light Alignment, figs. 13 and 14: on a matt material
    source="Light Warping (Vergne et al., SIGGRAPH 2009)",
)
def light_warping(
    space: ScaleSpace,
    light: LightsLike,
    *,
    view: View | str = "front",
    material: MaterialName = "lambert",
    curvature: CurvatureKind = "object",
    scale: Scale = 1,
    gain: Gain = None,
    foreshortening: Foreshortening = 1.0,
    magnitude: Annotated[
        float, Range(-1e30, 1e30, help="α: how far light is warped", soft=(-24, 24))
    ] = 14.0,
    contrast: Annotated[
        float, Range(-1, 1, help="γ of eq. 3: below 0 brightens convexities")
    ] = 0.0,
    quadrature: Annotated[
        str,
        Choice(
            ("lights", "directions"),
            help="eq. 2 over the lights, or eq. 1 over directions into an Environment",
        ),
    ] = "lights",
    lights: LightCount = 54,
    illumination: Annotated[
        str, Choice(("lights", "occlusion"), help="light, or warped ambient occlusion")
    ] = "lights",
    shadows: Shadows = False,
    bounces: Bounces = 0,
    rays: RaysOfAll = 0,
    denoise: Denoise = 0.0,
    importance: Importance = None,
    shininess: Parameter = None,
    roughness: Parameter = None,
    bins: Bins = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Compress the light that a curved place reflects, so that it looks more curved.

    Light directions are scaled on the stereographic plane along the directions of curvature. A
    single light works but is only moved; environments and area lights (`Light.spread`) are what
    the method is meant for. A direction contributes only where both it and its warped partner lie
    in the hemisphere of the normal: where one of them sets, that light's part ends at once, by up
    to 9/8 of its colour with object curvature. Many lights hide it, one alone draws a hard edge.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale, unless ``scale=0``.
    light : light, several, or an Environment
        As in `meshdepict.scene.names.as_lights`.
    material : str or Material
        As in `meshdepict.scene.material`; lit spheres and half-Lambert have no light to be warped.
    gain : float, optional
        As in `radiance_scaling`.
    foreshortening : float
        Of curvature="view": f in the slope (−n_x, −n_y)/n_z^f, 1 in the paper.
    magnitude : float
        α; 0 is plain rendering, below 0 stretches instead. The default, 14, was chosen by eye under
        the studio on nine scans: fur, folds and scales stand out (local contrast 1.1 to 1.4 times
        that of plain rendering), and the light still tells where it comes from. With the default
        gain it is 35 per pixel (LLA compares with 16.62).
    contrast : float
        Exponent of λ_u λ_v, which multiplies the result (eq. 3).
    quadrature : {"lights", "directions"}
        "directions" evaluates eq. 1 over as many directions as `lights` says, looking up W(l) in
        an Environment: slow, and what eq. 2 converges to.
    lights : int
        Into how many an Environment is sampled: on four panoramas 16 are off by 3 to 5 grey levels
        (rms) with a matt material and with highlights, 54 by 1 and 1 to 2.4.
    illumination : {"lights", "occlusion"}
        "occlusion": (1/π) ∫ ⟨n·l⟩ V(W(l)) dl, whatever the light and the material.
    shadows, bounces : bool, int
        With light by light alone (§6.1). A light is hidden by what lies where it is, and falls in
        from where it is warped to (eq. 2). What the sky sends and surfaces send on comes along
        rays W(d) of the method's own (eq. 1); before that light bounces as ever. Highlights, too,
        are of what rays meet: the sky or the surface. A mirror's ray is warped where the eye sees
        it, and mirrored as often as bounces says.
    rays : int
        0: for illumination="occlusion" 256, and 64 with shadows and bounces.
    importance : str or array_like in [0, 1], optional
        Where fine detail matters (I of §4.3, fig. 6): `scale` at 1, the coarsest scale at 0, so
        there have to be several. The name of a vertex attribute, an image file laid over the
        picture of the view, a point as x,y,z or x,y,z,radius, or in Python one number for each
        sample; see `meshdepict.shading.importance.importance_at`.

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
    if isinstance(material := as_material(material), (LitSphere, HalfLambert)):
        raise MeshdepictError(
            f"light_warping: {type(material).__name__} has no light that could be warped; "
            "radiance_scaling takes it"
        )
    if shadows or bounces:
        refuse_unhidden(material, illumination, shadows=shadows)
        if quadrature == "directions":
            raise MeshdepictError(
                "quadrature='directions' looks up an environment that nothing hides: leave it out, "
                "or shadows and bounces"
            )
    chosen, eye, frames = curved(
        space, view, material, curvature=curvature, scale=scale, gain=gain,
        foreshortening=foreshortening, importance=importance, needed=_bends(magnitude, gain),
        shininess=shininess,
        roughness=roughness, bins=bins,
    )  # fmt: skip
    shaded: NDArray[Any]
    if illumination == "occlusion":
        from meshdepict.shading.warped_occlusion import warped_openness

        if isinstance(rays, str):
            raise MeshdepictError(
                f"illumination='occlusion' takes a number of rays, 256 for instance: rays={rays!r} "
                "is for shadows and bounces"
            )
        shaded = warped_openness(space, frames, magnitude, rays=rays or _OPENNESS_RAYS)
    elif isinstance(chosen, (Mirror, Refractive)):
        shaded = seen(
            space, light, eye, chosen, frames, magnitude, shadows=shadows, bounces=bounces,
            rays=used_rays(space, rays or USUAL_RAYS),
        )  # fmt: skip
    elif quadrature == "directions":
        environment = as_environment(light, "quadrature='directions'")
        shaded = integral(space, environment, eyes(space, eye), chosen, frames, magnitude, lights)
    else:
        lamps, environments = parted(light, eye)
        reach = Reached((None,) * len(lamps))
        if shadows or bounces:
            around = bool(bounces or environments)
            lit, bent = space.vertex_space if around and frames is not None else space, frames
            settings: Any = {
                "curvature": curvature, "scale": scale, "gain": gain,
                "foreshortening": foreshortening, "importance": importance,
            }  # fmt: skip
            gathering: Gathering = PLAIN
            if bent is not None:
                bent = bent if lit is space else features(lit, eye, **settings)
                gathering = Warping(bent, magnitude, frames_key(eye, **settings))
            factor: Single | np.float32 = np.float32(1)
            if contrast and bent is not None:
                factor = _contrast(bent, magnitude, contrast)[probed(lit.count)]

            def displayed(light: NDArray[Any]) -> NDArray[Any]:
                value = np.float32(ambient_term(chosen)) + albedo(chosen) * light
                return linear_to_srgb(exposed((value.T * factor).T, exposure))

            reach = reached(
                space, lamps, environments, shadows=shadows, bounces=bounces,
                rays=rays or USUAL_RAYS, denoise=denoise, albedo=albedo(chosen),
                shown=displayed, gathering=gathering,
            )  # fmt: skip
        shaded = hidden_direct(
            space, lamps, eyes(space, eye), chosen, reach, environments=environments, count=lights,
            rays=used_rays(space, rays or USUAL_RAYS), frames=frames,
            warping=0.0 if frames is None else magnitude,
        )  # fmt: skip
    shaded = shaded + np.float32(ambient_term(chosen))
    if contrast and frames is not None:
        shaded = (shaded.T * _contrast(frames, magnitude, contrast)).T
    return exposed(quantised(shaded, chosen, exposure), exposure)


def _contrast(frames: Frames, magnitude: float, contrast: float) -> Single:
    """Return (λ_u λ_v)^contrast, what multiplies the result (eq. 3)."""
    area = warp_scale(frames.ku, magnitude) * warp_scale(frames.kv, magnitude)
    return np.asarray(area ** np.float32(contrast), np.float32)
