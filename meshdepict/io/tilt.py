"""Slices that lie obliquely on each other, as under a tilted gantry, made straight."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import as_text, max_memory
from meshdepict.io.itk import array_of, simpleitk

__all__ = ["TILT", "check_tilt", "straightened", "tilt_of"]

TILT = ("resample", "refuse")
"""What `read_volume` may do with a tilted grid."""

Floats = NDArray[np.float64]

_STRAIGHT = 1e-3  # cosines below it are rounding, as for `Volume`


def check_tilt(tilt: str) -> None:
    """Refuse other words than `TILT`.

    Raises
    ------
    MeshdepictError
        Naming them.
    """
    if tilt not in TILT:
        raise MeshdepictError(f"tilt={tilt!r} is neither 'resample' nor 'refuse'")


def tilt_of(steps: ArrayLike) -> float | None:
    """Return by how many degrees the third axis leans where the first two are at right angles.

    Parameters
    ----------
    steps : (3, 3) array_like
        Columns: from voxel to voxel along x, y and z.

    Returns
    -------
    float or None
        0 for a straight grid, None for one that is sheared in its slices too, or flat.
    """
    matrix = np.asarray(steps, np.float64)
    lengths = np.linalg.norm(matrix, axis=0)
    if not np.isfinite(matrix).all() or not (lengths > 0).all():
        return None
    x, y, z = (matrix / lengths).T
    if abs(x @ y) > _STRAIGHT:
        return None
    normal = np.cross(x, y)
    lean = float(np.hypot(x @ z, y @ z))
    if lean <= _STRAIGHT:
        return 0.0
    along = abs(float(normal @ z))
    return math.degrees(math.atan2(lean, along)) if along > _STRAIGHT else None


def straightened(
    values: NDArray[Any], steps: Floats, origin: Floats, fill: float
) -> tuple[NDArray[Any], dict[str, Any]]:
    """Return a tilted grid's values on a straight one, which reaches as far, and its place.

    Every slice keeps its height and is moved in its plane, by parts of a voxel linearly.

    Parameters
    ----------
    values : (nz, ny, nx) array
    steps : (3, 3) array
        As for `tilt_of`.
    origin : (3,) array
        Of the first voxel.
    fill : float
        For what lies outside of the slices.

    Raises
    ------
    MeshdepictError
        Where SimpleITK is not installed, and for more memory than allowed.
    """
    nz, ny, nx = values.shape
    lengths = np.linalg.norm(steps, axis=0)
    x, y = steps[:, 0] / lengths[0], steps[:, 1] / lengths[1]
    normal = np.cross(x, y)
    normal *= math.copysign(1.0, float(normal @ steps[:, 2])) / np.linalg.norm(normal)
    lean = np.array((x @ steps[:, 2] / lengths[0], y @ steps[:, 2] / lengths[1]))  # voxels a slice
    reach = lean * (nz - 1)
    low = np.floor(np.minimum(reach, 0) + 1e-6)
    more = np.ceil(np.maximum(reach, 0) - 1e-6) - low
    size = [nx + int(more[0]), ny + int(more[1]), nz]
    if math.prod(size) * values.dtype.itemsize > max_memory():
        raise MeshdepictError(
            f"is tilted so far that straight it takes more than {as_text(max_memory())} of memory: "
            "allow more with --max-memory"
        )
    with simpleitk([]) as sitk:
        image = sitk.GetImageFromArray(values)
        # From voxels of the straight grid to those of the tilted one: x − lean·z.
        way = sitk.AffineTransform(3)
        way.SetMatrix((1.0, 0.0, -lean[0], 0.0, 1.0, -lean[1], 0.0, 0.0, 1.0))
        found = sitk.Resample(
            image, size, way, sitk.sitkLinear, (*low.tolist(), 0.0), (1.0, 1.0, 1.0),
            np.eye(3).ravel().tolist(), float(fill), image.GetPixelID(),
        )  # fmt: skip
        straight = array_of(found)
    height = float(normal @ steps[:, 2])
    place = {
        "spacing": np.array((lengths[0], lengths[1], height)),
        "origin": origin + x * lengths[0] * low[0] + y * lengths[1] * low[1],
        "direction": np.stack((x, y, normal), axis=1),
    }
    return straight, place
