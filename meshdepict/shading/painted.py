"""Lit spheres: light, material and style painted on a sphere, looked up by view-space normal."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.files.pictures import opened_picture
from meshdepict.options import nearest
from meshdepict.scene.equirectangular import read_radiance

Floats = NDArray[Any]

__all__ = ["SPHERES", "painted", "sphere_picture"]

SPHERES = ("clay", "metal")
_SIZE = 256
_RIM = 0.985  # share of the radius that is looked up: a picture's rim is blended with its ground


def painted(picture: NDArray[np.float32], normals: NDArray[Any]) -> NDArray[np.float32]:
    """Return the picture's colours for view-space normals.

    Parameters
    ----------
    picture : (h, w, 3) array
        A sphere that fills it, first row up.
    normals : (n, 3) array_like
        x right, y up, z to the eye. What faces away looks like its mirror image.

    Returns
    -------
    (n, 3) array
    """
    height, width = picture.shape[:2]
    column = (1 + _RIM * normals[:, 0]) / 2 * width - 0.5
    row = (1 - _RIM * normals[:, 1]) / 2 * height - 0.5
    left = np.clip(np.floor(column).astype(np.intp), 0, width - 2)
    upper = np.clip(np.floor(row).astype(np.intp), 0, height - 2)
    x = np.clip(column - left, 0, 1).astype(np.float32)[:, None]
    y = np.clip(row - upper, 0, 1).astype(np.float32)[:, None]
    top = (1 - x) * picture[upper, left] + x * picture[upper, left + 1]
    base = (1 - x) * picture[upper + 1, left] + x * picture[upper + 1, left + 1]
    return (1 - y) * top + y * base


@lru_cache(maxsize=8)
def sphere_picture(sphere: str | Path) -> NDArray[np.float32]:
    """Return a lit sphere's display colours: a built-in one, or a picture file's.

    Radiance (.hdr) is linear: it is clipped to 1 and encoded.

    Raises
    ------
    MeshdepictError
        For an unknown name, and a file that is no picture.
    """
    if sphere in SPHERES:
        return _procedural(str(sphere))
    if isinstance(sphere, str) and "." not in sphere and not Path(sphere).exists():
        raise MeshdepictError(
            f"no lit sphere is called {sphere!r}{nearest(sphere, SPHERES)} (there are "
            f"{', '.join(SPHERES)}, or give a picture file)"
        )
    if Path(sphere).suffix.lower() == ".hdr":
        picture: Floats = linear_to_srgb(read_radiance(Path(sphere)))
    else:
        picture = _filled(_read(sphere))
    if min(picture.shape[:2]) < 2:
        raise MeshdepictError(f"{sphere}: too small for a lit sphere")
    return np.ascontiguousarray(picture, np.float32)


def _read(sphere: str | Path) -> Floats:
    try:
        with opened_picture(sphere) as image:
            rgba: Floats = np.asarray(image.convert("RGBA"), np.float32) / 255
    except (OSError, ValueError) as error:
        raise MeshdepictError(f"{sphere}: cannot be read as a picture ({error})") from None
    return rgba


def _filled(rgba: Floats) -> Floats:
    """Give pixels that are not opaque the colour of the nearest one that is."""
    opaque = rgba[..., 3] >= 1
    if opaque.all() or not opaque.any():
        return np.ascontiguousarray(rgba[..., :3])
    from scipy.ndimage import distance_transform_edt

    rows, columns = distance_transform_edt(~opaque, return_distances=False, return_indices=True)
    return np.ascontiguousarray(rgba[rows, columns, :3])


def _procedural(name: str) -> NDArray[np.float32]:
    """Paint warm clay under a soft light, or dark metal between a bright sky and a floor."""
    x, y = np.meshgrid(_ticks(), -_ticks())
    length = np.maximum(np.hypot(x, y), 1)
    x, y = x / length, y / length
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    key = (-x + y + z) / np.sqrt(3)
    rim = (1 - z) ** 3
    if name == "clay":
        lit = (0.5 + 0.5 * key)[..., None]
        color = (1 - lit) * [0.16, 0.10, 0.12] + lit * [0.98, 0.86, 0.74]
        color = color + 0.12 * rim[..., None] * [0.6, 0.8, 1.0]
    else:
        up = 2 * y * z  # where a mirror would look
        sky = 1 / (1 + np.exp(-12 * (up - 0.05)))[..., None]
        color = (1 - sky) * [0.10, 0.09, 0.09] + sky * [0.55, 0.60, 0.66]
        color = color + (np.maximum(2 * z * key - 1 / np.sqrt(3), 0) ** 24)[..., None]
        color = color + 0.25 * rim[..., None]
    return np.clip(color, 0, 1).astype(np.float32)


def _ticks() -> Floats:
    return (np.arange(_SIZE) + 0.5) * (2 / _SIZE) - 1
