"""Reading and writing volumes: DICOM, NIfTI, NRRD, MetaImage, VTI, stacks, OME-Zarr, NumPy."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.any_numbers import any_numbers
from meshdepict.files.reach import regular
from meshdepict.io.about_file import about_file
from meshdepict.io.dicom_elements import looks_like_dicom
from meshdepict.io.ome_zarr import OME_ZARR, is_zarr, read_ome_zarr, write_ome_zarr
from meshdepict.io.volume_contents import VolumeContents
from meshdepict.io.volume_place import place

if TYPE_CHECKING:
    from meshdepict.shapes.volume import Volume

__all__ = ["WRITABLE_VOLUMES", "is_volume_path", "read_volume", "volume_stem", "write_volume"]

_TIFF = (".tif", ".tiff")
_DICOM = (".dcm", ".dicom", ".ima")
_READERS = {
    ".nii": "nifti", ".nii.gz": "nifti", ".nrrd": "nrrd", ".nhdr": "nrrd", ".mha": "metaimage",
    ".mhd": "metaimage", ".vti": "vti", ".npy": "npy",
} | dict.fromkeys(_TIFF, "tiff") | dict.fromkeys(_DICOM, "dicom")  # fmt: skip
_READABLE = (*_DICOM, ".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".vti", *_TIFF, ".npy")
_IMPOSSIBLE = (-2048, 40_000)  # no scanner's numbers in HU are beyond
WRITABLE_VOLUMES = (".vti", ".nrrd", ".mha", ".nii", ".nii.gz", OME_ZARR)
"""Suffixes that `write_volume` takes."""


def is_volume_path(path: str | os.PathLike[str]) -> bool:
    """Whether `read_volume` is to read this: a folder, a volume's suffix, or DICOM without one.

    A ``.tif`` is none here: it may as well be a terrain.
    """
    path = Path(path)
    if path.is_dir():
        return True
    suffix = _suffix(path)
    if suffix in _READABLE:
        return suffix not in _TIFF
    if path.is_file() and path.suffix.lower() not in (".gz",):
        with path.open("rb") as file:
            start = file.read(132)
        if not re.fullmatch(r"(\.\d+)?", path.suffix) and start[128:] != b"DICM":
            return False  # files without the preamble have no suffix either, but an id for a name
        return looks_like_dicom(start, path.stat().st_size)
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
    tilt: str = "resample",
) -> Volume:
    """Read a volume with its spacing, origin and direction, in the patient's frame (LPS).

    Lengths stay in the unit that the file says: `Volume.length_unit`. Rescaling in the file is
    applied. CT from DICOM is in Hounsfield units; other formats don't say so, and their numbers
    count as raw unless this program wrote the file.

    Parameters
    ----------
    path : str or path-like
        A folder of DICOM files (its subfolders included), a DICOMDIR, or one file of a series;
        .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .vti; a .tif of many pages, or a folder of slices
        as TIFF, BMP, PNG or JPEG; .npy, an array (z, y, x), which is mapped into memory; a folder
        of OME-Zarr, .ome.zarr, its finest level.
    series : str or int, optional
        Which of several DICOM series in a folder: its id, or its number in the list that the
        error shows.
    slope, intercept : float, optional
        Turn raw numbers into Hounsfield units; 1 and 0 say that they are already. One alone takes
        1 or 0 for the other.
    spacing : (3,) array_like, optional
        Distances of voxels in x, y and z, for files without: TIFF and other images, .npy.
    tilt : "resample" or "refuse"
        What to do with the slices of a tilted gantry, and other grids whose slices lie obliquely
        on each other.

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
    from meshdepict.io.tilt import check_tilt

    path = Path(path)
    check_tilt(tilt)
    regular(path)
    with about_file(path):
        kind = _kind(path)
        if series is not None and kind != "dicom":
            raise MeshdepictError("is no DICOM, so that there is no series to choose")
        with any_numbers():
            contents = _contents(path, kind, series, tilt)
            place(contents, spacing, kind, tilt)
            volume = _volume(contents, slope, intercept)
    if contents.notes:
        warnings.warn(f"{path}: {'; '.join(contents.notes)}", MeshdepictWarning, stacklevel=2)
    return volume


def _volume(contents: VolumeContents, slope: float | None, intercept: float | None) -> Volume:
    """Return the volume, and note numbers that can't be Hounsfield units."""
    from meshdepict.shapes.volume import Volume

    volume = Volume(
        contents.values,
        **contents.place,
        hounsfield=contents.hounsfield,
        attributes=contents.attributes,
        length_unit=contents.length_unit,
    )
    if slope is not None or intercept is not None:
        volume = volume.rescaled(1 if slope is None else slope, intercept or 0)
    if volume.hounsfield:
        low, high = volume.range
        if low < _IMPOSSIBLE[0] or high > _IMPOSSIBLE[1]:
            contents.notes.append(
                f"its numbers, {low:g} … {high:g}, can't be the Hounsfield units that it says they "
                "are"
            )
    return volume


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
        Ends in .vti, .nrrd (compressed), .mha, .nii, .nii.gz or .ome.zarr, a folder that is not
        written over.
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
    write: Callable[..., None] = vti.write_vti if suffix == ".vti" else itk.write_itk
    if suffix == OME_ZARR:
        write = write_ome_zarr
    write(path, np.ascontiguousarray(array), volume, comments)


def _suffix(path: Path) -> str:
    name = path.name.lower()
    double = next((end for end in (".nii.gz", OME_ZARR) if name.endswith(end)), None)
    return double or path.suffix.lower()


def _kind(path: Path) -> str:
    """Return which reader a path is for."""
    if not path.exists():
        raise MeshdepictError("there is no such file or folder")
    if path.is_dir() and is_zarr(path):
        return "zarr"
    if path.is_dir():
        from meshdepict.io.image_stack import IMAGES, image_slices

        found = image_slices(path)
        if not found:
            return "dicom"
        if found[0].suffix.lower() in IMAGES and _has_dicom(path):  # previews beside the slices
            return "dicom"
        return "images"
    if path.stat().st_size == 0:
        raise MeshdepictError("is empty")
    kind = _READERS.get(_suffix(path))
    if kind:
        return kind
    if is_volume_path(path):
        return "dicom"
    from meshdepict.io.image_stack import IMAGES

    if path.suffix.lower() in IMAGES:
        raise MeshdepictError("is a single image: give the folder of all slices")
    raise MeshdepictError(
        f"its format is unknown; volumes are read from {', '.join(_READABLE)} and folders"
    )


def _has_dicom(folder: Path) -> bool:
    from meshdepict.io.dicom_header import is_dicom

    return any(path.is_file() and is_dicom(path) for path in folder.iterdir())


def _contents(path: Path, kind: str, series: str | int | None, tilt: str) -> VolumeContents:
    """Return what a file or folder holds."""
    from meshdepict.io.height_formats import is_map_tiff

    if kind == "dicom":
        from meshdepict.io.dicom import read_dicom

        return read_dicom(path, series, tilt=tilt)
    if kind == "nifti":
        from meshdepict.io.nifti import read_nifti

        return read_nifti(path)
    if kind == "nrrd":
        from meshdepict.io.nrrd import read_nrrd

        return read_nrrd(path)
    if kind == "metaimage":
        from meshdepict.io.metaimage import read_metaimage

        return read_metaimage(path)
    if kind == "vti":
        from meshdepict.io.vti import read_vti

        return read_vti(path)
    if kind == "zarr":
        return read_ome_zarr(path)
    if kind == "tiff" and is_map_tiff(path):
        raise MeshdepictError(
            "is an elevation model or another map (GeoTIFF), not a volume: read it as a height "
            "field"
        )
    if kind == "tiff":
        from meshdepict.io.tiff_stack import read_tiff

        return read_tiff(path)
    if kind == "images":
        from meshdepict.io.image_stack import read_image_stack

        return read_image_stack(path)
    from meshdepict.io.npy import read_npy

    return read_npy(path)
