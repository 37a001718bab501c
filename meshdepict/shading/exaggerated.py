"""Exaggerated Shading (Rusinkiewicz, Burns and DeCarlo, SIGGRAPH 2006)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Flag, Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.shading.attention import remoteness
from meshdepict.shading.bands import SINGULAR_LIGHT, band_weights
from meshdepict.shading.fitted_tones import fitted_tones, relief_tones
from meshdepict.shading.method import Exposure, exposed, method, require_smoothing

__all__ = ["exaggerated", "horizontal", "local_light", "per_band", "settle", "soft_toon"]

_EMPHASIS = -0.5
_ON_TERRAIN = 4.0  # of terrain that is shaded window by window: nobody sees all of it
_ANYWHERE = 15.0  # an exaggeration that does for scans, chosen by eye, where none can be fitted


def soft_toon(cosine: ArrayLike, exaggeration: float) -> NDArray[Any]:
    """Return clamp[−1, 1](a cos), the soft toon shader of eq. 2."""
    return np.clip(exaggeration * np.asarray(cosine), -1, 1)


def local_light(light: ArrayLike, normals: ArrayLike) -> NDArray[Any]:
    """Return the light turned into the plane of each normal (eq. 4), at most of unit length.

    Parameters
    ----------
    light : (3,) array_like
        Unit vector.
    normals : (…, 3) array_like
        Unit normals of the next coarser scale.
    """
    light, normals = np.asarray(light), np.asarray(normals)
    projected = light - normals * (normals @ light)[..., None]
    squared = (projected**2).sum(axis=-1, keepdims=True)
    return projected / np.sqrt(squared + SINGULAR_LIGHT**2)


def horizontal(light: NDArray[np.float64], vertical: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a light's unit direction on level ground; nothing of one that stands above it."""
    level: NDArray[np.float64] = light - vertical * (light @ vertical)
    length = float(np.linalg.norm(level))
    return level / length if length > SINGULAR_LIGHT**2 else np.zeros(3)


def settle(space: ScaleSpace | None, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return exaggeration, base and contrast: as given, else as fit the shape, or as in the paper.

    Parameters
    ----------
    space : ScaleSpace or None
        None of a shape that is never at hand as a whole: numbers that fit most then.
    options : mapping
        Of `exaggerated`. Without an exaggeration, what is None follows the shape; with one, base
        and contrast are the paper's.
    """
    names = ("exaggeration", "base", "contrast")
    given = {name: options.get(name) for name in names}
    if all(value is not None for value in given.values()):
        return given
    usual: tuple[Any, ...] = (_ANYWHERE, 1.0, 1.0)
    relief = bool(options.get("one_light"))
    fits = given["exaggeration"] is None and given["contrast"] != 0  # with which nothing shows
    if fits and space is not None and len(space.widths) > 1:
        emphasis = options.get("emphasis", _EMPHASIS)
        usual = (relief_tones if relief else fitted_tones)(space, emphasis=emphasis)
    elif relief:
        usual = (_ON_TERRAIN, 1.0, 1.0)
    return {
        name: fit if given[name] is None else given[name]
        for name, fit in zip(names, usual, strict=True)
    }


def per_band(
    space: ScaleSpace, exaggeration: float | Sequence[float], bands: int | None = None
) -> NDArray[np.float64]:
    """Return one exaggeration for each band, finest first; as many as smoothed scales.

    Raises
    ------
    MeshdepictError
        For another number of them.
    """
    bands = len(space.widths) - 1 if bands is None else bands
    values = np.asarray(exaggeration, float)
    if values.ndim and len(values) != bands:
        raise MeshdepictError(
            f"exaggerated: exaggeration has {len(values)} values for {bands} scales; give one for "
            "all, or one for each, finest first"
        )
    return np.broadcast_to(values, bands)


def _reads(last: int, *, contrast: float | None, principal_strength: float, **_: Any) -> Reads:
    """Return all sets, or none where none has a weight; curvature only where it turns light."""
    if contrast == 0:
        return Reads()
    return Reads(
        normals=frozenset(range(last + 1)),
        curvature=frozenset(range(last) if principal_strength else ()),
    )


@method(
    scales=9,
    fits=settle,
    reads=_reads,
    compared={"exaggeration": 40.0},  # within the 25 … 50 of the paper
    source="Exaggerated Shading (Rusinkiewicz et al. 2006), eqs. 3–5",
)
def exaggerated(
    space: ScaleSpace,
    light: LightLike,
    *,
    exaggeration: Annotated[
        float | tuple[float, ...] | None,
        Range(
            0,
            1e30,
            soft=(1, 60),
            help="steepness of the soft toon, one for all scales or finest,…,coarsest",
        ),
    ] = None,
    emphasis: Annotated[
        float,
        Range(-4, 4, help="power of the width: −1 fine detail, 0 all scales alike", soft=(-1, 0)),
    ] = _EMPHASIS,
    base: Annotated[
        float | None,
        Range(0, 1e6, help="times the paper's weight of the broad tone", soft=(0, 40)),
    ] = None,
    contrast: Annotated[
        float | None, Range(0, 1e6, help="sum of the scales' weights", soft=(0, 2))
    ] = None,
    principal_strength: Annotated[
        float,
        Range(0, 1e6, help="how far light turns to the direction that bends most", soft=(0, 20)),
    ] = 0.0,
    one_light: Annotated[
        bool | None,
        Flag(help="shade all scales under the light's horizontal part, as relief; so is terrain"),
    ] = None,
    focus: Annotated[
        tuple[float, float, float] | None,
        Range(help="x,y,z in world units: detail fades away from this point", place=True),
    ] = None,
    radius: Annotated[
        float | None,
        Range(1e-300, help="how far from the focus the finest detail is kept, in world units"),
    ] = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade every scale under a light that grazes the next coarser one, and add them up.

    ``c = ½ + ½ (k_b n_b·l + Σ_i k_i clamp[−1,1](a n_i·l̂_{i+1}))``: detail shows whichever way
    the surface faces, and large forms keep the light's direction.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale.
    light : str, (3,) array_like, (azimuth, elevation) or Light
        The global light, towards it.
    exaggeration : float or sequence of float, optional
        a of eq. 3, one for all scales or one each, finest first. The paper's figures use 25 to 50.
        Unless given, exaggeration, base and contrast follow the shape, whatever the light and the
        view; see `fitted_tones`: each scale saturates 30 % of the samples (40 at most), so that
        smooth finds are not grey and fur and scanner noise not black and white. With one given,
        base and contrast are 1, the paper's.
    emphasis : float
        p in k_i ∝ σ_i^p.
    base : float, optional
        Multiplies k_b before the weights' sum is made the contrast. Unless given, as much as makes
        the result follow half-Lambert: the paper's 1 leaves the lit side of heads dark.
    contrast : float, optional
        Σ k_i. Unless given, what takes a hundredth of the samples to black or white, 1 to 2.
    principal_strength : float
        Of eq. 9, s = principal_strength·σ_i²: sharpens the light's turn at ridges and valleys. 0
        computes no curvature.
    one_light : bool, optional
        The form for terrain (§3): ``c = ½ + ½ Σ_i k_i clamp[−1,1](a_i n_i·l)`` with the light's
        horizontal part l, so that level ground is mid-grey whatever the light. Bakes of a height
        field take it unless told otherwise; of a mesh it needs a sheet, whose axis is vertical.
        Exaggerations are one more then, with the coarsest scale's.
    focus : (float, float, float), optional
        Where attention is drawn to (fig. 9): at the distance d from it the weight k_i is
        multiplied by exp(−½ (d/ρ_i)²), ρ_i = radius·2^{i/2}. The base coat stays.
    radius : float, optional
        In world units; a tenth of the shape's diagonal unless given.

    Raises
    ------
    MeshdepictError
        If the scale space has no smoothed scale, and for another number of exaggerations.
    """
    from meshdepict.shading.exaggerated_kernel import combine_bands, combine_cosines

    require_smoothing(space, "exaggerated shading", scales=9)
    direction = as_light(light).direction
    given = {
        "exaggeration": exaggeration, "base": base, "contrast": contrast, "emphasis": emphasis,
        "one_light": one_light,
    }  # fmt: skip
    tones = settle(space, given)
    weights = band_weights(
        space.widths, space.ratio,
        emphasis=emphasis, contrast=tones["contrast"], base=tones["base"],
    )  # fmt: skip
    steep = per_band(space, tones["exaggeration"], len(weights) if one_light else None)
    if contrast == 0:
        return exposed(np.full(space.count, 0.5, np.float32), exposure)
    if one_light:
        if focus is not None or principal_strength:
            raise MeshdepictError(
                "exaggerated: focus and principal_strength are about each scale's own light, and "
                "one_light has none: leave them out, or set one_light=False"
            )
        sums = combine_cosines(space, horizontal(direction, space.vertical), weights, steep)
        return exposed((1 + sums) / 2, exposure)
    far = None if focus is None else remoteness(space, focus, radius)
    if principal_strength:
        from meshdepict.shading.principal_light import combine_bent_bands

        sums = combine_bent_bands(
            space, direction, weights, steep, SINGULAR_LIGHT, principal_strength, far
        )
    else:
        sums = combine_bands(space, direction, weights, steep, SINGULAR_LIGHT, far)
    return exposed((1 + sums) / 2, exposure)
