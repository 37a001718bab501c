"""Where fine detail matters: Light Warping's importance function I(p), §4.3, and what it mixes.

The paper diffuses slopes less where a place is important. On a mesh the steps of diffusion are the
scales of a scale space: 1 takes the finest that curvature is of, 0 the coarsest, and between two of
them their curvature tensors are mixed, so that no border runs along the levels of I.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.curvature.view import eigenvalues
from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import any_numbers
from meshdepict.files.pictures import is_picture
from meshdepict.options import Samples, nearest
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import LUMINANCE
from meshdepict.scene.upright import UPS
from meshdepict.scene.view import VIEWS, View
from meshdepict.shading.attention import remoteness

__all__ = ["between_scales", "importance_at", "mean_between_scales", "wanted_scales"]

Floats = NDArray[np.float64]


def importance_at(space: ScaleSpace, view: View, importance: ArrayLike | Samples | str) -> Floats:
    """Return I of every sample, (n,) in [0, 1].

    Parameters
    ----------
    space : ScaleSpace
    view : View
        Which an image was seen from.
    importance : array_like or str
        One number for each sample, each vertex, or each pixel of an image's picture; or a text:

        * the name of a vertex attribute, 0 … 1, or 0 … 255 where it has bytes;
        * an image file, as bright as places are important, laid over the picture that the view
          shows: of a named view the one of the image's proportions. It falls on what is behind,
          too; what lies outside is unimportant;
        * ``x,y,z`` or ``x,y,z,radius``, a point and how far around it: exp(−½ (d/radius)²); a
          tenth of the diagonal unless given.

    Raises
    ------
    MeshdepictError
        For anything else, and numbers beyond 0 … 1.
    """
    count = space.count
    if isinstance(importance, str):
        share = _named(space, view, importance)
    else:
        share = np.asarray(importance, np.float64)
        mask = getattr(space.shape, "mask", None)
        if mask is not None and share.shape == mask.shape:
            share = share[mask]
        mesh = _mesh(space)
        if mesh is not None and share.shape == (len(mesh.vertices),):
            share = space.of_vertices(share)
    if share.shape != (count,) or not ((share >= 0) & (share <= 1)).all():
        raise MeshdepictError(f"importance must be {count:,} numbers from 0 to 1, one per point")
    return share


def wanted_scales(
    space: ScaleSpace, view: View, importance: ArrayLike | Samples | str, *, scale: int
) -> Floats:
    """Return which scale every sample takes, (n,): `scale` where I = 1, the coarsest where I = 0.

    Raises
    ------
    MeshdepictError
        Where there are no coarser scales, and as `importance_at`.
    """
    last = len(space.widths) - 1
    if scale >= last:
        raise MeshdepictError(
            f"importance chooses between scale {scale} and coarser ones, and there are none: make "
            "more with scales=5 (--scales 5)"
        )
    return last - importance_at(space, view, importance) * (last - scale)


def mean_between_scales(at: Callable[[int], NDArray[Any]], wanted: Floats) -> NDArray[Any]:
    """Return numbers (k, n) of every sample at a scale of its own, between two linearly.

    Parameters
    ----------
    at : callable
        ``at(scale)`` returns the (k, n) numbers of all samples at a scale.
    wanted : (n,) array
    """
    found: Any = 0
    for scale in np.unique(np.concatenate([np.floor(wanted), np.ceil(wanted)])):
        found = found + np.maximum(1 - np.abs(wanted - scale), 0) * at(int(scale))
    return np.asarray(found)


def between_scales(at: Callable[[int], Any], wanted: Floats) -> Any:
    """Return the frames of every sample at a scale of its own, which may lie between two.

    Parameters
    ----------
    at : callable
        ``at(scale)`` returns the `features.Frames` of all samples at a scale, to be kept.
    wanted : (n,) array
        Scales; whole numbers take theirs as it is.
    """
    lower = np.floor(wanted).astype(np.intp)
    scales = np.unique(np.concatenate([lower, np.ceil(wanted).astype(np.intp)]))
    frames = {int(scale): at(int(scale)) for scale in scales}
    found = type(frames[int(lower[0])])(*map(np.copy, frames[int(lower[0])]))
    for scale in np.unique(lower):
        whole, between = (lower == scale) & (wanted == scale), (lower == scale) & (wanted > scale)
        _put(found, whole, (part[whole] for part in frames[int(scale)]))
        if between.any():
            fine, coarse = (
                type(found)(*(part[between] for part in frames[int(scale) + step]))
                for step in (0, 1)
            )
            _put(found, between, mixed_tensors(fine, coarse, (wanted - lower)[between]))
    return found


def _put(found: Any, here: NDArray[np.bool_], parts: Iterable[NDArray[Any]]) -> None:
    for mine, other in zip(found, parts, strict=True):
        mine[here] = other


def mixed_tensors(fine: Any, coarse: Any, share: Floats) -> Any:
    """Return frames of curvature between two of them, (1 − share)·fine + share·coarse.

    Tensors are added in world space, and what of them lies in the plane of the mixed z counts.

    Parameters
    ----------
    fine, coarse : features.Frames
        Of the same samples.
    share : (n,) array
        Strictly between 0 and 1.
    """
    weights = (1 - share, share)
    z = sum(w[:, None] * frames.z for w, frames in zip(weights, (fine, coarse), strict=True))
    z = z / np.maximum(np.linalg.norm(z, axis=1, keepdims=True), 1e-12)
    x = fine.u - np.einsum("na,na->n", fine.u, z)[:, None] * z
    other = fine.v - np.einsum("na,na->n", fine.v, z)[:, None] * z
    lengths = [np.linalg.norm(a, axis=1, keepdims=True) for a in (x, other)]
    x = np.where(lengths[0] >= lengths[1], x, other) / np.maximum(*lengths)
    y = np.cross(z, x)
    xx = xy = yy = np.zeros(len(z))
    for w, frames in zip(weights, (fine, coarse), strict=True):
        for k, d in ((frames.ku, frames.u), (frames.kv, frames.v)):
            along, across = (np.einsum("na,na->n", d, axis) for axis in (x, y))
            bend = w * k
            xx, xy, yy = xx + bend * along**2, xy + bend * along * across, yy + bend * across**2
    (ku, kv), (cosine, sine) = eigenvalues(xx, xy, yy)
    u = cosine[:, None] * x + sine[:, None] * y
    v = cosine[:, None] * y - sine[:, None] * x
    return type(fine)(*(np.asarray(part, np.float32) for part in (ku, kv, u, v, z)))


def _named(space: ScaleSpace, view: View, text: str) -> Floats:
    """Return what a text stands for, at the samples."""
    mesh = _mesh(space)
    attributes: dict[str, Any] = {} if mesh is None else dict(mesh.attributes["vertex"])
    if text in attributes:
        return space.of_vertices(_in_range(attributes[text], text))
    if is_picture(text):
        return _laid_over(space, view, text)
    numbers = _numbers(text)
    if numbers is not None:
        far = remoteness(space, numbers[:3], numbers[3] if len(numbers) == 4 else None)
        return np.exp(-far.astype(np.float64))
    usable = [name for name, values in attributes.items() if _is_plain(values)]
    there = f"the vertices have {', '.join(usable)}" if usable else "the vertices have none"
    raise MeshdepictError(
        f"importance={text!r} is no vertex attribute ({there}){nearest(text, usable)}, no image "
        "file and no point x,y,z or x,y,z,radius"
    )


def _mesh(space: ScaleSpace) -> Any:
    shape: Any = space.shape
    return shape if shape.kind == "mesh" else getattr(shape, "mesh", None)


def _is_plain(values: NDArray[Any]) -> bool:
    """Whether these are real numbers, one for each vertex."""
    return values.ndim == 1 and values.dtype.kind in "iufb"


def _in_range(values: NDArray[Any], name: str) -> Floats:
    if not _is_plain(values):
        raise MeshdepictError(f"importance: the attribute {name!r} is not one number a vertex")
    with any_numbers():
        share = values / 255 if values.dtype == np.uint8 else values.astype(np.float64)
    if not np.isfinite(share).all():
        raise MeshdepictError(f"importance: the attribute {name!r} holds NaN or infinite numbers")
    if not ((share >= 0) & (share <= 1)).all():
        raise MeshdepictError(
            f"importance: the attribute {name!r} goes from {share.min():.4g} to "
            f"{share.max():.4g}: scale it to 0 … 1"
        )
    return share


def _numbers(text: str) -> list[float] | None:
    """Return three or four numbers from a text, None where it is anything else."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        return None
    right = len(numbers) in (3, 4) and all(map(math.isfinite, numbers))
    return numbers if right and (len(numbers) == 3 or numbers[3] > 0) else None


def _laid_over(space: ScaleSpace, view: View, path: str) -> Floats:
    """Return an image's brightness where it shows the samples, 0 outside of it."""
    from scipy.ndimage import map_coordinates

    picture = _brightness(path)
    height, width = picture.shape
    mask = getattr(space.shape, "mask", None)
    if mask is not None:
        if mask.shape != picture.shape:
            raise MeshdepictError(
                f"{path} has {width} x {height} pixels, and the picture whose importance it says "
                f"{mask.shape[1]} x {mask.shape[0]}: make them alike"
            )
        return picture[mask]
    eye = _proportioned(view, space, width / height)
    away = space.points - eye.focus
    x, y, z = (away @ axis for axis in eye.frame)
    if eye.parallel_scale is not None:
        half: Any = eye.parallel_scale
    else:
        assert eye.field_of_view is not None  # every view has the one or the other
        depth = float(np.linalg.norm(eye.position - eye.focus)) - z
        half = np.where(depth > 0, depth, np.inf) * math.tan(math.radians(eye.field_of_view) / 2)
    rows = (1 - y / half) * height / 2 - 0.5
    columns = (width + x / half * height) / 2 - 0.5
    if eye.parallel_scale is None:
        rows = np.where(depth > 0, rows, -height)  # behind the eye nothing is seen
    inside = (np.abs(rows + 0.5 - height / 2) <= height / 2) & (
        np.abs(columns + 0.5 - width / 2) <= width / 2
    )
    found = map_coordinates(picture, [rows, columns], order=1, mode="nearest")
    return np.where(inside, np.clip(found, 0, 1), 0.0)


def _brightness(path: str) -> Floats:
    """Return an image (h, w) in [0, 1]: its display values, transparent parts black."""
    from meshdepict.images.image_files import read_image

    values = read_image(path)
    whole = values.dtype.kind in "iub"
    most = float(np.iinfo(values.dtype).max) if whole and values.dtype != bool else 1.0
    share = values.astype(np.float64) / most
    if share.ndim == 3 and share.shape[2] in (1, 2, 3, 4) and share.size:
        alpha = share[..., -1] if share.shape[2] in (2, 4) else 1.0
        colors = share[..., :3] @ LUMINANCE if share.shape[2] >= 3 else share[..., 0]
        share = colors * alpha
    if share.ndim != 2 or not share.size or not ((share >= 0) & (share <= 1)).all():
        raise MeshdepictError(f"{path}: an image of importance is grey or coloured, from 0 to 1")
    return share


def _proportioned(view: View, space: ScaleSpace, aspect: float) -> View:
    """Return a named view as a picture of these proportions shows it; others as they are."""
    for up in UPS if view.name in VIEWS else ():
        square = View.fitted(view.name, space.shape, up=up)
        if np.allclose(square.position, view.position) and np.allclose(square.up, view.up):
            return View.fitted(view.name, space.shape, up=up, aspect=aspect)
    return view
