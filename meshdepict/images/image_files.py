"""Normals, depth, mask and occlusion as images: read from files, decoded, made to fit together."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.any_numbers import any_numbers, quiet, real_array
from meshdepict.files.pictures import mapped_array, opened_picture
from meshdepict.files.reach import regular

if TYPE_CHECKING:
    from meshdepict.scene.view import View

__all__ = [
    "SurfaceImages",
    "depth_unit",
    "fitted_depth_scale",
    "image_colors",
    "read_image",
    "surface_images",
]

Floats = NDArray[np.float64]
Picture = ArrayLike | str | Path

_UNIT = 0.01  # how far a normal's length may be off; eight bits are off by 0.007
_NONE = 0.5  # a decoded vector shorter than this is no normal


class SurfaceImages(NamedTuple):
    """Images of one size.

    Attributes
    ----------
    normals : (h, w, 3) array
        Unit vectors in view space, zero outside the mask.
    mask : (h, w) array of bool
    depth, occlusion : (h, w) array or None
        Depth in the image's own unit; occlusion in [0, 1], 1 where open.
    """

    normals: Floats
    mask: NDArray[np.bool_]
    depth: Floats | None
    occlusion: Floats | None


def read_image(path: str | Path) -> NDArray[Any]:
    """Return the values of an image file as they are, (h, w) or (h, w, channels).

    PNG of 1, 8 and 16 bits, TIFF of 8 bits, of 16 bits and floats in one channel, NumPy's .npy,
    and what else Pillow reads with 8 bits.

    Raises
    ------
    MeshdepictError
        For a file that is missing, damaged or of another kind.
    """
    path = Path(path)
    regular(path)
    if not path.is_file():
        raise MeshdepictError(f"{path}: no such file")
    try:
        if path.suffix.lower() == ".npy":
            return np.array(quiet(mapped_array(path)))
        return quiet(_pixels(path))
    except (OSError, ValueError) as error:
        raise MeshdepictError(
            f"{path}: not an image that can be read ({error}); PNG, TIFF in one channel or 8 bits, "
            "or an array saved as .npy can"
        ) from None


def _pixels(path: Path) -> NDArray[Any]:
    with path.open("rb") as stream:
        head = stream.read(26)
    # Pillow cuts 16-bit colours to 8 bits without a word.
    if head.startswith(b"\x89PNG") and len(head) == 26 and head[24] == 16 and head[25] in (2, 6):
        return _deep_png(path)
    with opened_picture(path) as image:
        mode = image.mode
        if mode == "1":
            return np.asarray(image.convert("L"))
        if mode not in ("L", "LA", "RGB", "RGBA", "I", "F") and not mode.startswith("I;16"):
            return np.asarray(image.convert("RGBA"))
        values = np.asarray(image)
    if mode == "I" and 0 <= values.min() <= values.max() < 65536:
        return values.astype(np.uint16)  # 32 bits in Pillow's hands, 16 in a PNG's
    return values


def _deep_png(path: Path) -> NDArray[Any]:
    """Return the 16-bit colours of a PNG, (h, w, 3 or 4), whose beginning has been looked at."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader

    with opened_picture(path) as image:
        image.load()  # complains where VTK would only print
        width, height = image.size
    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    scalars = reader.GetOutput().GetPointData().GetScalars()
    return vtk_to_numpy(scalars).reshape(height, width, -1)[::-1].copy()


def surface_images(
    normals: Picture,
    depth: Picture | None,
    mask: Picture | None,
    occlusion: Picture | None,
    *,
    green: str = "up",
) -> SurfaceImages:
    """Return arrays or files decoded; see `GBuffer.from_images`, also for what is raised."""
    if not isinstance(green, str) or green not in ("up", "down"):
        raise MeshdepictError(f"green={green!r} is neither 'up' nor 'down'")
    array = _array(normals, "normals")
    if array.ndim != 3 or array.shape[2] not in (3, 4) or array.size == 0:
        raise MeshdepictError(
            f"a normal map has three channels and perhaps alpha, not the shape {array.shape}"
        )
    size = array.shape[:2]
    vectors = _signed(array[..., :3])
    if green == "down":
        vectors[..., 1] *= -1
    with any_numbers():  # what is too long to have a length says nothing
        length = np.linalg.norm(vectors, axis=2)
        there = np.isfinite(length) & (length >= _NONE)
    if array.dtype.kind == "u":
        there &= array[..., :3].any(axis=2)
    if array.shape[2] == 4:
        there &= array[..., 3] > 0
    if mask is not None:
        wanted = _plane(mask, "mask", size) != 0
        lost = int(np.count_nonzero(wanted & ~there))
        if lost and lost < np.count_nonzero(wanted):
            warnings.warn(
                f"{lost:,} pixels of the mask have no normal and were left out",
                MeshdepictWarning,
                stacklevel=3,
            )
        there &= wanted
    if not there.any():
        raise MeshdepictError("the mask is empty: no pixel shows a surface with a normal")
    off = int(np.count_nonzero(np.abs(length[there] - 1) > _UNIT))
    if off:
        warnings.warn(
            f"{off:,} of {int(there.sum()):,} normals were not of unit length and were normalised",
            MeshdepictWarning,
            stacklevel=3,
        )
    vectors = np.where(there[..., None], vectors, 0) / np.where(there, length, 1)[..., None]
    away = None if depth is None else _plane(depth, "depth", size).astype(np.float64)
    if away is not None:
        bad = int(np.count_nonzero(~np.isfinite(away[there])))
        if bad:
            raise MeshdepictError(
                f"depth is not finite at {bad:,} pixels of the mask: leave them out of the mask"
            )
        away = np.where(there, away, 0)
    shade = None if occlusion is None else _plane(occlusion, "occlusion", size)
    if shade is not None:
        shade = shade / _largest(shade)
    return SurfaceImages(vectors, there, away, shade)


def image_colors(given: Picture, size: tuple[int, ...]) -> NDArray[np.uint8]:
    """Return the display colours (h, w, 3) of an array or a file; see `GBuffer.from_images`.

    Raises
    ------
    MeshdepictError
        For a file that can't be read, another size, and numbers that are no colours.
    """
    array = _array(given, "colors")
    if array.ndim != 3 or array.shape[2] not in (3, 4):
        raise MeshdepictError(
            f"colors have three channels and perhaps alpha, not the shape {array.shape}"
        )
    if array.shape[:2] != size:
        raise MeshdepictError(
            f"images of different sizes: colors have the shape {array.shape[:2]}, the normal map "
            f"{size} (rows, columns)"
        )
    fractions = array[..., :3].astype(np.float64) / _largest(array)
    if not ((fractions >= 0) & (fractions <= 1)).all():
        raise MeshdepictError("colors must be unsigned integers, or numbers from 0 to 1")
    return np.rint(255 * fractions).astype(np.uint8)


def depth_unit(scale: float | str, images: SurfaceImages, view: View) -> float:
    """Return world units per unit of the depth image: a number, or what "fit" finds.

    Raises
    ------
    MeshdepictError
        For anything else, "fit" in a perspective view, and as `fitted_depth_scale`.
    """
    if scale == "fit":
        if view.parallel_scale is None:
            raise MeshdepictError("depth_scale='fit' needs a parallel view: give a number")
        return fitted_depth_scale(images) * 2 * view.parallel_scale / len(images.mask)
    try:
        number = 0.0 if isinstance(scale, (str, bool)) else float(scale)
    except (TypeError, ValueError):
        number = 0.0
    if number == 0 or not math.isfinite(number):
        raise MeshdepictError(f"depth_scale={scale!r} is neither 'fit' nor a number other than 0")
    return number


def fitted_depth_scale(images: SurfaceImages) -> float:
    """Return by what to multiply a depth image to have pixels as its unit.

    The factor that makes its differences the normals' slopes: their least squares' fit over
    neighbours on surfaces that face the eye (n_z ≥ ½). Depth may be coarse, normals are believed.

    Raises
    ------
    MeshdepictError
        Where the depth doesn't vary with the normals.
    """
    normals, depth = images.normals, images.depth
    assert depth is not None
    nz = np.maximum(normals[..., 2], 0.5)
    facing = images.mask & (normals[..., 2] >= 0.5)
    rises, slopes = [], []
    # Away from the eye is positive: depth rises by n_x/n_z to the right and by −n_y/n_z downwards.
    for axis, slope in ((1, normals[..., 0] / nz), (0, -normals[..., 1] / nz)):
        here, there = _neighbours(axis)
        both = facing[here] & facing[there]
        rises.append((depth[there] - depth[here])[both])
        slopes.append(((slope[there] + slope[here]) / 2)[both])
    rise, slope = np.concatenate(rises), np.concatenate(slopes)
    unit, usual = 0.0, np.ones(len(rise), bool)
    for _ in range(5):  # a pixel in the image's unit, without the steps, which fit far worse
        squared = float(slope[usual] @ slope[usual])
        unit = float(rise[usual] @ slope[usual]) / squared if squared > 0 else 0.0
        misfit = np.abs(rise - unit * slope)
        usual = misfit <= 4 * (np.median(misfit) if len(misfit) else 0)
    if unit == 0:
        raise MeshdepictError(
            "the depth image doesn't vary as its normals do: give depth_scale as a number"
        )
    return 1 / unit


def _neighbours(axis: int) -> tuple[Any, Any]:
    """Return what cuts an image to all pixels but the last, and but the first, along an axis."""
    fore, rest = [slice(None)] * 2, [slice(None)] * 2
    fore[axis], rest[axis] = slice(None, -1), slice(1, None)
    return tuple(fore), tuple(rest)


def _array(given: Picture, what: str) -> NDArray[Any]:
    try:
        array = read_image(given) if isinstance(given, (str, Path)) else np.asarray(given)
    except MeshdepictError:
        raise
    except (TypeError, ValueError, OverflowError):
        raise MeshdepictError(f"{what}: rows of different lengths make no image") from None
    if array.dtype.kind not in "buif":
        raise MeshdepictError(f"{what}: real numbers are needed, not {array.dtype}")
    # No further than in double precision, and without what a mask hides.
    whole = array.dtype.itemsize <= 8 and not np.ma.is_masked(given)
    found = None if whole else real_array(given)  # type: ignore[arg-type]
    return array if found is None else found


def _plane(given: Picture, what: str, size: tuple[int, ...]) -> NDArray[Any]:
    """Return one channel of the size of the normal map: a grey image's, or a colour one's first."""
    array = _array(given, what)
    if array.ndim == 3 and array.shape[2] in (1, 2, 3, 4):
        array = array[..., 0]
    if array.shape != size:
        raise MeshdepictError(
            f"images of different sizes: {what} has the shape {array.shape}, the normal map {size} "
            "(rows, columns)"
        )
    return array


def _largest(array: NDArray[Any]) -> float:
    """Return what stands for 1: an unsigned type's largest number."""
    return float(np.iinfo(array.dtype).max) if array.dtype.kind == "u" else 1.0


def _signed(channels: NDArray[Any]) -> Floats:
    """Return −1 … 1 from unsigned numbers; others are as they are."""
    if channels.dtype.kind != "u":
        return channels.astype(np.float64)
    return channels.astype(np.float64) * (2 / _largest(channels)) - 1
