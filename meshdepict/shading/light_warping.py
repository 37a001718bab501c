"""Light Warping (Vergne, Pacanowski, Barla, Granier and Schlick, SIGGRAPH 2009)."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Range, Samples
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.equirectangular import bilinear, to_picture
from meshdepict.scene.light import Light
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
from meshdepict.shading.direct import direct, kernel_parameters, quantised, squeezed
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
)
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shading.surroundings import as_environment, seen
from meshdepict.shading.warp_equations import jacobian, unwarp, warp, warp_scale

__all__ = ["jacobian", "light_warping", "unwarp", "warp", "warp_scale"]

Single = NDArray[np.float32]


def _bends(magnitude: float, gain: float | None) -> bool:
    return magnitude != 0 and gain != 0


def _reads(
    last: int,
    *,
    curvature: str,
    scale: int,
    gain: float | None,
    magnitude: float,
    illumination: str,
    rays: int,
    importance: ArrayLike | Samples | str | None,
    **_: Any,
) -> Reads:
    """Return the shape's own normals, with what bends light, and rays if they are wanted."""
    own = Reads(normals=frozenset((0,)), rays=rays if illumination == "occlusion" else 0)
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
    rays: Annotated[int, Range(2, 65536, help="of ambient occlusion", soft=(16, 256))] = 256,
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
        For a scale that is not there, or light that does not go with the material.
    """
    if isinstance(material := as_material(material), (LitSphere, HalfLambert)):
        raise MeshdepictError(
            f"light_warping: {type(material).__name__} has no light that could be warped; "
            "radiance_scaling takes it"
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

        shaded = warped_openness(space, frames, magnitude, rays=rays)
    elif isinstance(chosen, (Mirror, Refractive)):
        shaded = seen(space, light, eye, chosen, frames, magnitude)
    elif quadrature == "directions":
        environment = as_environment(light, "quadrature='directions'")
        shaded = _integral(space, environment, eyes(space, eye), chosen, frames, magnitude, lights)
    else:
        lamps, environments = parted(light, eye)
        shaded = direct(
            space, lamps, eyes(space, eye), chosen, environments=environments, count=lights,
            frames=frames, warping=magnitude,
        )  # fmt: skip
    shaded = shaded + np.float32(ambient_term(chosen))
    if contrast and frames is not None:
        area = warp_scale(frames.ku, magnitude) * warp_scale(frames.kv, magnitude)
        shaded = (shaded.T * area ** np.float32(contrast)).T
    return exposed(quantised(shaded, chosen, exposure), exposure)


def _integral(
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
