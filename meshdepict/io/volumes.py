"""Reading and writing volumes: DICOM, NIfTI, NRRD, MetaImage, VTI, TIFF stacks and NumPy arrays."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning

if TYPE_CHECKING:
    from meshdepict.shapes.volume import Volume

__all__ = ["WRITABLE_VOLUMES", "is_volume_path", "read_volume", "volume_stem", "write_volume"]

_ITK = (".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd")
_TIFF = (".tif", ".tiff")
_DICOM = (".dcm", ".dicom", ".ima")
_READABLE = (*_DICOM, *_ITK, ".vti", *_TIFF, ".npy")
WRITABLE_VOLUMES = (".vti", ".nrrd", ".mha", ".nii", ".nii.gz")
"""Suffixes that `write_volume` takes."""


def is_volume_path(path: str | os.PathLike[str]) -> bool:
    """Whether `read_volume` is to read this: a folder, a volume's suffix, or DICOM without one.

    A ``.tif`` is none here: it may as well be an elevation model.
    """
    path = Path(path)
    if path.is_dir():
        return True
    suffix = _suffix(path)
    if suffix in _READABLE:
        return suffix not in _TIFF
    if path.is_file() and path.suffix.lower() not in (".gz",):
        with path.open("rb") as file:
            return file.read(132)[128:] == b"DICM"
    return False


def volume_stem(path: str | os.PathLike[str]) -> str:
    """Return the name of a volume's file or folder without suffixes."""
    return Path(path).resolve().name.partition(".")[0] or "ct"


def read_volume(
    path: str | os.PathLike[str],
    *,
    series: str | int | None = None,
    slope: float | None = None,
    intercept: float | None = None,
    spacing: ArrayLike | None = None,
) -> Volume:
    """Read a volume with its spacing, origin and direction, in the patient's frame (LPS).

    Rescaling in the file is applied. CT from DICOM is in Hounsfield units; other formats don't say
    so, and their numbers count as raw unless this program wrote the file.

    Parameters
    ----------
    path : str or path-like
        A folder of DICOM files (its subfolders included) or one file of a series; .nii, .nii.gz,
        .nrrd, .nhdr, .mha, .mhd, .vti; a .tif of many pages or a folder of .tif slices; .npy, an
        array (z, y, x), which is mapped into memory.
    series : str or int, optional
        Which of several DICOM series in a folder: its id, or its number in the list that the
        error shows.
    slope, intercept : float, optional
        Turn raw numbers into Hounsfield units; 1 and 0 say that they are already. One alone takes
        1 or 0 for the other.
    spacing : (3,) array_like, optional
        Distances of voxels in x, y and z, in mm, for files without: TIFF and .npy.

    Returns
    -------
    Volume

    Raises
    ------
    MeshdepictError
        For a file that is missing, damaged, of an unknown format or not a grid of three
        dimensions, a folder of several series and none chosen, slices missing, a volume that
        `Volume` refuses, options that don't go with the format, and where SimpleITK is needed but
        not installed: one sentence that begins with the path.
    """
    from meshdepict.shapes.volume import Volume

    path = Path(path)
    try:
        kind = _kind(path)
        if series is not None and kind != "dicom":
            raise MeshdepictError("is no DICOM, so that there is no series to choose")
        if spacing is not None and kind not in ("tiff", "npy"):
            raise MeshdepictError("says its spacing itself: leave spacing= out")
        if spacing is None and kind in ("tiff", "npy"):
            warnings.warn(
                f"{path}: no spacing is given, taken as 1 along every axis (spacing=)",
                MeshdepictWarning,
                stacklevel=2,
            )
            spacing = (1.0, 1.0, 1.0)
        values, place, hounsfield, attributes = _contents(path, kind, series)
        if spacing is not None:
            place["spacing"] = spacing
        volume = Volume(values, **place, hounsfield=hounsfield, attributes=attributes)
        if slope is not None or intercept is not None:
            volume = volume.rescaled(1 if slope is None else slope, intercept or 0)
    except MeshdepictError as error:
        text = str(error)
        joint = " " if text.split(" ", 1)[0] in _VERBS else ": "
        raise MeshdepictError(f"{path}{joint}{text}") from error
    except PermissionError:
        raise MeshdepictError(f"{path} may not be read: permission denied") from None
    except OSError as error:
        raise MeshdepictError(f"{path} could not be read: {error.strerror or error}") from error
    return volume


_VERBS = ("is", "has", "holds", "lacks", "says")  # sentences whose subject is the file


def write_volume(
    path: str | os.PathLike[str],
    values: ArrayLike,
    volume: Volume,
    *,
    comments: Sequence[str] = (),
) -> None:
    """Write values on a volume's grid, wholly or not at all, in the format that the suffix names.

    NIfTI has no place for the unit and for comments, and rounds spacing, origin and direction to
    single precision.

    Parameters
    ----------
    path : str or path-like
        Ends in .vti, .nrrd (compressed), .mha, .nii or .nii.gz.
    values : (nz, ny, nx) or (nz, ny, nx, 4) array_like
        Scalars, ``volume.values`` for instance, or RGBA as uint8.
    volume : Volume
        Where the values are; its unit is written with scalars.
    comments : sequence of str
        Lines of ASCII that say how the values came about.

    Raises
    ------
    MeshdepictError
        For another suffix, values of another shape or type, and every failure to write.
    """
    from meshdepict.io import itk, vti

    path = Path(path)
    suffix = _suffix(path)
    if suffix not in WRITABLE_VOLUMES:
        raise MeshdepictError(
            f"{path}: volumes are not saved as {suffix or 'a file without suffix'}; "
            f"use one of {', '.join(WRITABLE_VOLUMES)}"
        )
    array = np.asarray(values)
    scalar = array.shape == volume.values.shape and array.dtype.kind in "biuf"
    if not scalar and (array.shape != (*volume.values.shape, 4) or array.dtype != np.uint8):
        raise MeshdepictError(
            f"{path}: values must be numbers of shape {volume.values.shape} or uint8 colours of "
            f"shape {(*volume.values.shape, 4)}, not {array.dtype} of shape {array.shape}"
        )
    if array.dtype == bool or array.dtype == np.float16:
        array = array.astype(np.uint8 if array.dtype == bool else np.float32)
    write = vti.write_vti if suffix == ".vti" else itk.write_itk
    write(path, np.ascontiguousarray(array), volume, comments)


def _suffix(path: Path) -> str:
    name = path.name.lower()
    return ".nii.gz" if name.endswith(".nii.gz") else path.suffix.lower()


def _kind(path: Path) -> str:
    """Return which reader a path is for."""
    if not path.exists():
        raise MeshdepictError("there is no such file or folder")
    if path.is_dir():
        from meshdepict.io.tiff_stack import tiff_slices

        return "tiff" if tiff_slices(path) else "dicom"
    if path.stat().st_size == 0:
        raise MeshdepictError("is empty")
    suffix = _suffix(path)
    if suffix in (".vti", ".npy"):
        return suffix[1:]
    if suffix in _ITK:
        return "itk"
    if suffix in _TIFF:
        return "tiff"
    if suffix in _DICOM or is_volume_path(path):
        return "dicom"
    raise MeshdepictError(
        f"its format is unknown; volumes are read from {', '.join(_READABLE)} and folders"
    )


def _contents(
    path: Path, kind: str, series: str | int | None
) -> tuple[NDArray[Any], dict[str, Any], bool, dict[str, str]]:
    """Return values, place (the keywords of `Volume`), whether in HU, and attributes."""
    if kind == "dicom":
        from meshdepict.io.dicom import read_dicom

        return read_dicom(path, series)
    if kind == "tiff":
        from meshdepict.io.tiff_stack import read_tiff_stack

        return read_tiff_stack(path), {}, False, {}
    if kind == "vti":
        from meshdepict.io.vti import read_vti

        values, place, unit = read_vti(path)
        return values, place, unit == "HU", {}
    if kind == "itk":
        from meshdepict.io.itk import read_itk

        values, place, hounsfield = read_itk(path)
        return values, place, hounsfield, {}
    try:
        return np.load(path, mmap_mode="r", allow_pickle=False), {}, False, {}
    except (ValueError, EOFError) as error:
        raise MeshdepictError(f"is cut off, damaged or no array: {error}") from error
