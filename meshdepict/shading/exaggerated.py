"""Exaggerated Shading (Rusinkiewicz, Burns and DeCarlo, SIGGRAPH 2006)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.options import Range
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.shading.attention import remoteness
from meshdepict.shading.method import Exposure, exposed, method, require_smoothing

__all__ = ["band_weights", "exaggerated", "local_light", "soft_toon"]

# Where the light stands along the smoothed normal it has no direction in the tangent plane: there
# the projected light is l / √(‖l‖² + ε²) instead of l / ‖l‖, which fades to zero continuously.
SINGULAR_LIGHT = 1e-3


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


def band_weights(
    widths: NDArray[np.float64], ratio: float, *, emphasis: float, contrast: float
) -> NDArray[np.float64]:
    """Return k_i ∝ σ_i^emphasis for i = 0 … b, their sum the contrast (§3).

    Parameters
    ----------
    widths : (b + 1,) array
        σ_0 … σ_b; σ_0 is taken as σ_1 / ratio.
    """
    if len(widths) == 1:
        return np.array([contrast])
    # Relative to the finest, so that neither tiny nor huge units overflow a power.
    relative = np.concatenate(([1 / ratio], widths[1:] / widths[1]))
    weights = relative**emphasis
    return contrast * weights / weights.sum()


@method(
    scales=9,
    compared={"exaggeration": 40.0},  # within the 25 … 50 of the paper
    source="Exaggerated Shading (Rusinkiewicz et al. 2006), eqs. 3–5",
)
def exaggerated(
    space: ScaleSpace,
    light: LightLike,
    *,
    exaggeration: Annotated[
        float, Range(0, 1e30, help="steepness of the soft toon at every scale", soft=(1, 60))
    ] = 15.0,
    emphasis: Annotated[
        float,
        Range(-4, 4, help="power of the width: −1 fine detail, 0 all scales alike", soft=(-1, 0)),
    ] = -0.5,
    contrast: Annotated[float, Range(0, 1e6, help="sum of the scales' weights", soft=(0, 2))] = 1.0,
    principal_strength: Annotated[
        float,
        Range(0, 1e6, help="how far light turns to the direction that bends most", soft=(0, 20)),
    ] = 0.0,
    focus: Annotated[
        tuple[float, float, float] | None,
        Range(help="x,y,z in world units: detail fades away from this point"),
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
    exaggeration : float
        a of eq. 3. The paper's figures use 25 to 50. The default, 15, was chosen on scans (bunny,
        armadillo, Lucy, a stone flake) by eye: at 40 fur, skin and scanner noise turn black and
        white and break up the large forms, at 5 the ripples of the flake are lost; between 10,
        where the armadillo and Lucy look best, and 20, which the flake wants, lies 15.
    emphasis : float
        p in k_i ∝ σ_i^p.
    contrast : float
        Σ k_i.
    principal_strength : float
        Of eq. 9, s = principal_strength·σ_i²: sharpens the light's turn at ridges and valleys. 0
        computes no curvature.
    focus : (float, float, float), optional
        Where attention is drawn to (fig. 9): at the distance d from it the weight k_i is
        multiplied by exp(−½ (d/ρ_i)²), ρ_i = radius·2^{i/2}. The base coat stays.
    radius : float, optional
        In world units; a tenth of the shape's diagonal unless given.

    Raises
    ------
    MeshdepictError
        If the scale space has no smoothed scale.
    """
    from meshdepict.shading.exaggerated_kernel import combine_bands

    require_smoothing(space, "exaggerated shading", scales=9)
    direction = as_light(light).direction
    weights = band_weights(space.widths, space.ratio, emphasis=emphasis, contrast=contrast)
    far = None if focus is None else remoteness(space, focus, radius)
    if principal_strength:
        from meshdepict.shading.principal_light import combine_bent_bands

        sums = combine_bent_bands(
            space, direction, weights, exaggeration, SINGULAR_LIGHT, principal_strength, far
        )
    else:
        sums = combine_bands(space, direction, weights, exaggeration, SINGULAR_LIGHT, far)
    return exposed((1 + sums) / 2, exposure)
