"""Pictures as they come in: every check of a mask, a depth image or a rendering, once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError

__all__ = ["checked_mask", "checked_normals", "checked_picture"]

_LUMINANCE = np.array((0.2126, 0.7152, 0.0722))  # of linear RGB (IEC 61966-2-1)
_NUMBERS = "buif"  # kinds of NumPy's types


def checked_mask(mask: ArrayLike, *, smallest: int = 1) -> NDArray[np.bool_]:
    """Return where a picture shows the object, (h, w).

    Raises
    ------
    MeshdepictError
        For another shape, an empty mask, or a side of fewer than `smallest` pixels.
    """
    known = np.asarray(mask)
    if known.ndim != 2 or known.dtype.kind not in _NUMBERS:
        raise MeshdepictError(
            f"the mask must be a picture of shape (h, w), not {known.dtype} of shape {known.shape}"
        )
    known = known != 0
    if not known.any():
        raise MeshdepictError("the mask is empty: no pixel shows the object; check the view")
    if min(known.shape) < smallest:
        raise MeshdepictError(
            f"a picture of {_size(known)} pixels is too small, at least {smallest}x{smallest} are "
            "needed; render it larger"
        )
    return known


def checked_picture(
    values: ArrayLike, what: str, mask: NDArray[np.bool_], *, color: bool = True
) -> NDArray[np.float64]:
    """Return a picture as finite numbers (h, w), zero beyond the mask.

    Parameters
    ----------
    values : (h, w) or (h, w, 3) array_like of float
        Linear; of RGB the luminance is returned.
    what : str
        What to call it in a sentence.
    mask : (h, w) array of bool
    color : bool
        Whether it may be RGB.

    Raises
    ------
    MeshdepictError
        For another shape than the mask's, 8-bit values, NaN or infinity inside the mask.
    """
    image = np.asarray(values)
    rgb = color and image.ndim == 3 and image.shape[2] == 3
    if image.dtype.kind not in _NUMBERS or not (rgb or image.ndim == 2):
        raise MeshdepictError(
            f"the {what} must be a picture of numbers of shape (h, w){' or (h, w, 3)' * color}, "
            f"not {image.dtype} of shape {image.shape}"
        )
    if image.dtype == np.uint8:
        raise MeshdepictError(
            f"the {what} is 8-bit; give linear values as floats (for a picture in sRGB: "
            "color.srgb_to_linear(picture / 255))"
        )
    if image.shape[:2] != mask.shape:
        raise MeshdepictError(
            f"the {what} has {_size(image)} pixels, the mask {_size(mask)}: give pictures of one "
            "view in one size"
        )
    with np.errstate(invalid="ignore"):  # what lies beyond the mask may be anything
        numbers = image @ _LUMINANCE if rgb else image.astype(np.float64, copy=False)
    broken = mask & ~np.isfinite(numbers)
    if broken.any():
        row, column = np.argwhere(broken)[0]
        raise MeshdepictError(
            f"the {what} is NaN or infinite inside the mask, first at row {row}, column {column}; "
            "take such pixels out of the mask"
        )
    return np.where(mask, numbers, 0.0)


def checked_normals(values: ArrayLike, mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return unit normals (h, w, 3), zero beyond the mask.

    Raises
    ------
    MeshdepictError
        For another shape than the mask's, NaN, infinity and normals of no length inside the mask.
    """
    image = np.asarray(values)
    if image.dtype.kind not in _NUMBERS or image.shape != (*mask.shape, 3):
        raise MeshdepictError(
            f"the normals must be a picture of {_size(mask)} pixels with three numbers each, as "
            f"the mask is, not {image.dtype} of shape {image.shape}"
        )
    normals = np.where(mask[..., None], image, 0).astype(np.float64, copy=False)
    with np.errstate(over="ignore"):
        length = np.linalg.norm(normals, axis=2, keepdims=True)
    broken = mask & ~(np.isfinite(length[..., 0]) & (length[..., 0] > 0))
    if broken.any():
        row, column = np.argwhere(broken)[0]
        raise MeshdepictError(
            f"the normals have no direction inside the mask, first at row {row}, column {column}; "
            "take such pixels out of the mask"
        )
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)


def _size(image: NDArray[Any]) -> str:
    return f"{image.shape[1]}x{image.shape[0]}"
