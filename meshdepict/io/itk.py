"""SimpleITK: what it unpacks and resamples, and writing NIfTI, NRRD and MetaImage.

SimpleITK is the extra ``[ct]`` and is imported where it is used.
"""

from __future__ import annotations

import gzip
import importlib
import re
import shutil
import tempfile
import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.atomic import atomic_write
from meshdepict.io.volume_contents import several_values
from meshdepict.voxels.length_unit import MILLIMETRES

if TYPE_CHECKING:
    from meshdepict.voxels.grid import Grid

__all__ = ["array_of", "reason", "simpleitk", "write_itk"]

_LENGTH_UNIT = "meshdepict_length_unit"
_UNIT = "meshdepict_unit"  # our keys in files that take any (NRRD, MetaImage)
PROVENANCE = "meshdepict_provenance"
_NIFTI = (".nii", ".nii.gz")
_UNIT_CODES = {"m": 1, "mm": 2, "µm": 3}  # NIfTI's, at byte 123 of its header
_one_at_a_time = threading.RLock()  # ITK has one logger for all threads


@contextmanager
def simpleitk(noise: list[str] | None = None) -> Iterator[Any]:
    """Give the module SimpleITK; what ITK warns of becomes this package's warnings.

    Parameters
    ----------
    noise : list of str, optional
        Gets the warnings instead, for what says more than they do.

    Raises
    ------
    MeshdepictError
        Where SimpleITK is not installed.
    """
    try:
        sitk: Any = _module()
    except ImportError as error:
        raise MeshdepictError(
            "compressed DICOM and TIFF, tilted grids, and writing NIfTI, NRRD and MetaImage need "
            "SimpleITK, which is not installed: pip install 'meshdepict[ct]'"
        ) from error

    class Collector(sitk.LoggerBase):
        def _take(self, text: str) -> None:
            told.append(text)

        # SimpleITK prescribes the names.
        DisplayText = DisplayErrorText = DisplayWarningText = _take
        DisplayGenericOutputText = DisplayDebugText = _take

    told: list[str] = []
    with _one_at_a_time:
        collector: Any = Collector()
        before = collector.SetAsGlobalITKLogger()
        try:
            yield sitk
        finally:
            before.SetAsGlobalITKLogger()
    told = list(dict.fromkeys(map(reason, told)))
    if noise is not None:
        noise += told
    elif told:
        warnings.warn("; ".join(told), MeshdepictWarning, stacklevel=4)


def _module() -> Any:
    with warnings.catch_warnings():  # its wrapper's types do, in Python 3.12 and later
        warnings.simplefilter("ignore", DeprecationWarning)
        return importlib.import_module("SimpleITK")


def reason(text: object) -> str:
    """Return the telling last line of a message of ITK's, without addresses."""
    lines = [line.strip() for line in str(text).splitlines() if line.strip()]
    line = lines[-1] if lines else "no reason given"
    return re.sub(r"^(?:\w+::)?(?:ITK )?(?:ERROR|WARNING): |\w+ ?\(0x\w+\): ", "", line)


def write_itk(path: Path, values: NDArray[Any], grid: Grid, comments: Sequence[str] = ()) -> None:
    """Write scalar or RGBA values on a volume's grid, wholly or not at all."""
    suffix = ("".join(path.suffixes[-2:]) if path.suffix == ".gz" else path.suffix).lower()
    nifti = suffix in _NIFTI
    # NIfTI knows three units; lengths in others are written in mm.
    told = grid.length_unit in ("", *_UNIT_CODES) or not nifti
    scale = 1.0 if told else MILLIMETRES.get(grid.length_unit, 1.0)
    with simpleitk() as sitk, atomic_write(path) as file:
        image = sitk.GetImageFromArray(values, isVector=values.ndim == 4)
        image.SetSpacing((grid.spacing * scale).tolist())
        image.SetOrigin((grid.origin * scale).tolist())
        image.SetDirection(grid.direction.ravel().tolist())
        if values.ndim == 3:
            image.SetMetaData(_UNIT, grid.unit)
        if grid.length_unit and not nifti:
            image.SetMetaData(_LENGTH_UNIT, grid.length_unit.replace("µ", "u"))
        if comments and not nifti:
            image.SetMetaData(PROVENANCE, "; ".join(comments))
        # ITK chooses the format by the suffix, which the file to be renamed doesn't have.
        with tempfile.TemporaryDirectory(prefix=".", dir=Path(file.name).parent) as folder:
            whole = Path(folder) / ("volume.nii" if nifti else f"volume{suffix}")
            try:
                sitk.WriteImage(image, str(whole), useCompression=suffix == ".nrrd")
            except RuntimeError as error:
                raise OSError(reason(error)) from error
            if nifti:  # ITK claims mm whatever it is given
                code = _UNIT_CODES.get(grid.length_unit, 0 if told else 2)
                with whole.open("r+b") as header:
                    header.seek(123)
                    header.write(bytes([code]))
            with whole.open("rb") as stream:
                _copy(stream, file, pack=suffix == ".nii.gz")


def _copy(source: BinaryIO, target: BinaryIO, *, pack: bool) -> None:
    """Copy a file, packed where that is wanted, the same way at any time."""
    if pack:
        with gzip.GzipFile("", "wb", 6, target, mtime=0) as packed:
            shutil.copyfileobj(source, packed, 1 << 20)
    else:
        shutil.copyfileobj(source, target, 1 << 20)


def array_of(image: Any) -> NDArray[Any]:
    """Return an image's values, (nz, ny, nx) and read-only, in ITK's own memory.

    Raises
    ------
    MeshdepictError
        For other dimensions than three and several values in a voxel: without the file's name.
    """
    if image.GetDimension() != 3:
        size = " x ".join(map(str, image.GetSize()))
        raise MeshdepictError(
            f"has {image.GetDimension()} dimensions ({size}), not three: extract one volume first"
        )
    if image.GetNumberOfComponentsPerPixel() != 1:
        count = image.GetNumberOfComponentsPerPixel()
        raise several_values(count)
    return np.asarray(_Held(image))


class _Held:
    """An image and the array on its memory, which lives as long as any view of it."""

    def __init__(self, image: Any) -> None:
        self.image = image
        self.__array_interface__ = _module().GetArrayViewFromImage(image).__array_interface__
