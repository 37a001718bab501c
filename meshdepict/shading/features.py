"""What Light Warping and Radiance Scaling respond to: curvature at every point, in a frame."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.options import Choice, Range, Samples, Values
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.material import MATERIALS, Material, adjusted, as_material
from meshdepict.scene.names import as_view
from meshdepict.scene.view import View, named_directions
from meshdepict.shading.importance import between_scales, wanted_scales

__all__ = [
    "Bins",
    "CurvatureKind",
    "Foreshortening",
    "Frames",
    "Gain",
    "Importance",
    "LightCount",
    "Magnitude",
    "MaterialName",
    "Parameter",
    "Scale",
    "Scaling",
    "bends",
    "convexity",
    "curved",
    "eyes",
    "features",
    "frames_key",
    "sight",
    "width_at",
]

Single = NDArray[np.float32]

CurvatureKind = Annotated[
    str, Choice(("object", "view"), help="of the surface itself, or of the depth seen by the view")
]
Scale = Annotated[int, Range(0, 64, help="which set of normals curvature is of", soft=(0, 8))]
Gain = Annotated[
    float | None,
    Range(0, 1e30, help="factor on curvature; object 0.7, view 2.5 if none", soft=(0, 10)),
]
Foreshortening = Annotated[
    float,
    Range(0, 10, help="power of n·z in the view's curvature; the object's has none", soft=(0, 1)),
]

Importance = Annotated[
    ArrayLike | Samples | str | None, Values(help="where fine detail matters, 1, and where not, 0")
]
LightCount = Annotated[
    int, Range(1, 65536, help="lights that an environment is sampled into", soft=(16, 256))
]
MaterialName = Annotated[
    str | Material, Choice(tuple(MATERIALS), help="what light does", also=tuple(MATERIALS.values()))
]
Magnitude = Annotated[float | None, Range(0, 1e30, help="γ of this term", soft=(0, 20))]
Parameter = Annotated[float | None, Range(0, 1e6, help="of the material, in place of its own")]
Bins = Annotated[int | None, Range(1, 256, help="tones of the toon material", soft=(2, 16))]

# Curvature is counted per width (object) or per pixel (view). The defaults were chosen by looking
# at the bunny, the armadillo and Lucy (36,000 to 50,000 vertices): see radiance_scaling.
DEFAULT_GAIN = {"object": 0.7, "view": 2.5}


def bends(
    scale: int,
    curvature: str,
    importance: ArrayLike | Samples | str | None = None,
    last: int = 0,
) -> Reads:
    """Return what `features` reads of a scale space with so many smoothed sets."""
    scales = {scale}
    if importance is not None and scale <= last:
        scales |= _scales_of(importance, scale, last)
    # Where a sample faces away from the eye, a view's curvature is the surface's own.
    seen = scales if curvature == "view" else ()
    return Reads(frozenset(scales), frozenset(scales), frozenset(seen))


class Frames(NamedTuple):
    """Curvature at every point, concave positive, and the frame it refers to.

    Attributes
    ----------
    ku, kv : (n,) array
    u, v, z : (n, 3) array
        Orthonormal, in world space.
    """

    ku: Single
    kv: Single
    u: Single
    v: Single
    z: Single


class Scaling(NamedTuple):
    """Radiance Scaling's parameters; magnitudes of 0 scale nothing."""

    diffuse: float = 0.0
    specular: float = 0.0
    invariant: float = 0.5
    anisotropy: float = 0.0


def features(
    space: ScaleSpace,
    view: View,
    *,
    curvature: str,
    scale: int,
    gain: float | None,
    foreshortening: float = 1.0,
    importance: ArrayLike | Samples | str | None = None,
) -> Frames:
    """Return curvature times gain, concave positive, with its directions.

    Parameters
    ----------
    space : ScaleSpace
    view : View
        Asked for view curvature, and for nothing else.
    curvature : {"object", "view"}
        "object": κ_{u|v} = −gain·width·κ_{1|2} in the frame (d_1, d_2, n), whatever the view.
        "view": per pixel, faded out at silhouettes and creases, in the frame (u, v, towards the
        eye). Points that face away from the eye, which it cannot say anything about, get the first.
    scale : int
        Whose normals' curvature.
    gain : float, optional
    foreshortening : float
        f of METHODS §3, the power of n·z in the slope that the view's curvature is the gradient of:
        1 in Light Warping, 0.4 in Radiance Scaling's released shader, 0 none.
    importance : str or array_like in [0, 1], optional
        Where fine detail matters (Light Warping's I(p)): `scale` at 1, the coarsest one at 0; see
        `importance.importance_at`.

    Returns
    -------
    Frames

    Raises
    ------
    MeshdepictError
        For a scale that the space does not have, an importance that can't be had, and where there
        are no scales to choose from.
    """
    if importance is None:
        return _at_scale(space, view, curvature, scale, gain, foreshortening)
    return between_scales(
        lambda each: _at_scale(space, view, curvature, each, gain, foreshortening),
        wanted_scales(space, view, importance, scale=scale),
    )


def frames_key(
    view: View,
    *,
    curvature: str,
    scale: int,
    gain: float | None,
    foreshortening: float,
    importance: ArrayLike | Samples | str | None = None,
) -> tuple[Any, ...]:
    """Return all that `features` depends on beside the samples, to be compared."""
    sight: tuple[Any, ...] = ()
    if curvature == "view" or importance is not None:
        sight = (
            *view.position, *view.focus, *view.up, view.height_px, view.field_of_view,
            view.parallel_scale, foreshortening,
        )  # fmt: skip
    if importance is not None and not isinstance(importance, str):
        importance = np.asarray(importance, np.float64).tobytes()
    return curvature, scale, gain, importance, sight


def curved(
    space: ScaleSpace,
    view: View | str,
    material: str | Material,
    *,
    curvature: str,
    scale: int,
    gain: float | None,
    foreshortening: float,
    importance: ArrayLike | Samples | str | None = None,
    needed: bool = True,
    **own: float | None,
) -> tuple[Any, View, Frames | None]:
    """Return what Light Warping and Radiance Scaling begin with: material, eye and curvature.

    Parameters
    ----------
    space, view, curvature, scale, gain, foreshortening, importance
        As for `features`; the view also by its name.
    material : str or Material
    needed : bool
        Whether curvature has any weight; without it there are no frames.
    **own
        Parameters in place of the material's own; None leaves it alone.
    """
    chosen = adjusted(as_material(material), **own)
    eye = sight(view, space, fitted=curvature == "view" or importance is not None)
    if not needed:
        return chosen, eye, None
    frames = features(
        space, eye, curvature=curvature, scale=scale, gain=gain, foreshortening=foreshortening,
        importance=importance,
    )  # fmt: skip
    return chosen, eye, frames


def convexity(
    space: ScaleSpace,
    view: View,
    *,
    curvature: str,
    scale: int,
    gain: float | None,
    foreshortening: float,
) -> NDArray[np.float32]:
    """Return κ = tanh(−(κ_u + κ_v)) of `features`: −1 in hollows, 0 where flat, 1 on bumps."""
    frames = features(
        space, view, curvature=curvature, scale=scale, gain=gain, foreshortening=foreshortening
    )
    return np.tanh(-(frames.ku + frames.kv))


def sight(view: View | str, space: ScaleSpace, *, fitted: bool) -> View:
    """Return the view; a named one is fitted to the shape only where pixels count."""
    if fitted or isinstance(view, View) or space.shape.kind == "image":
        return as_view(view, space.shape)
    towards, up = named_directions(view)
    return View(towards, (0, 0, 0), up, parallel_scale=1.0, name=view)


def eyes(space: ScaleSpace, view: View) -> NDArray[np.float32]:
    """Return unit vectors to the eye, (3, 1) of a parallel view, else (3, n)."""
    if view.parallel_scale is not None:
        return view.towards_eye.astype(np.float32)[:, None]
    away = view.position - space.points
    length = np.linalg.norm(away, axis=1, keepdims=True)
    away = np.where(length > 0, away / np.where(length > 0, length, 1), view.towards_eye)
    return np.ascontiguousarray(away.T, np.float32)


def width_at(space: ScaleSpace, scale: int) -> float:
    """Return a scale's width; for the unsmoothed one σ_0, or without any scale the median edge."""
    return float(space.widths[scale]) or space.finest_width or float(space.shape.edge_length)


def _at_scale(
    space: ScaleSpace,
    view: View,
    curvature: str,
    scale: int,
    gain: float | None,
    foreshortening: float,
) -> Frames:
    """Return the features of one scale in arrays of their own."""
    share = 1.0 if gain is None else gain / DEFAULT_GAIN[curvature]
    if curvature == "view":
        facing = np.einsum("an,an->n", space.planes_at(scale), eyes(space, view)) >= 0
        if facing.all():
            return _seen(space, view, scale, share, foreshortening)
    own = space.curvature(scale)
    factor = -share * DEFAULT_GAIN["object"] * width_at(space, scale)
    frames = Frames(
        _single(factor * own.k1), _single(factor * own.k2), np.array(own.d1), np.array(own.d2),
        np.array(space.normals_at(scale), order="C"),
    )  # fmt: skip
    if curvature == "object":
        return frames
    found = _seen(space, view, scale, share, foreshortening)
    for mine, other in zip(frames, found, strict=True):
        mine[facing] = other[facing]
    return frames


def _seen(space: ScaleSpace, view: View, scale: int, share: float, foreshortening: float) -> Frames:
    """Return the features as the eye sees them, in arrays of their own."""
    seen = space.view_curvature(view, scale, foreshortening=foreshortening)
    weight = (share * DEFAULT_GAIN["view"]) * seen.weight.astype(np.float64)
    return Frames(
        _single(seen.ku * weight), _single(seen.kv * weight), np.array(seen.u), np.array(seen.v),
        np.cross(seen.u, seen.v),
    )  # fmt: skip


def _single(values: NDArray[Any]) -> NDArray[np.float32]:
    """Return float32, kept from overflowing: products with any magnitude must not be NaN."""
    return np.clip(values, -1e30, 1e30).astype(np.float32)


def _scales_of(importance: ArrayLike | Samples | str, scale: int, last: int) -> set[int]:
    """Return the scales that an importance may choose; of a text any of them."""
    if isinstance(importance, str):
        return set(range(scale, last + 1))
    share = np.asarray(importance, np.float64)
    if not np.isfinite(share).all():
        return set()  # which is refused as soon as it is looked at
    share = np.clip(share, 0, 1)
    wanted = last - share * (last - scale)
    return {int(each) for each in np.unique([np.floor(wanted), np.ceil(wanted)])}
