"""NIfTI, NRRD and MetaImage through SimpleITK, which knows their directions and rescaling.

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
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.atomic import atomic_write

if TYPE_CHECKING:
    from meshdepict.shapes.volume import Volume

__all__ = ["array_of", "place_of", "read_itk", "reason", "simpleitk", "write_itk"]

_UNIT = "meshdepict_unit"  # our keys in files that take any (NRRD, MetaImage)
PROVENANCE = "meshdepict_provenance"
_NIFTI = (".nii", ".nii.gz")
_one_at_a_time = threading.RLock()  # ITK has one logger for all threads


@contextmanager
def simpleitk() -> Iterator[Any]:
    """Give the module SimpleITK; what ITK warns of becomes this package's warnings.

    Raises
    ------
    MeshdepictError
        Where SimpleITK is not installed.
    """
    try:
        sitk: Any = _module()
    except ImportError as error:
        raise MeshdepictError(
            "DICOM, NIfTI, NRRD, MetaImage and TIFF volumes need SimpleITK, which is not "
            "installed: pip install 'meshdepict[ct]'"
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
    for text in told:
        warnings.warn(reason(text), MeshdepictWarning, stacklevel=4)


def _module() -> Any:
    with warnings.catch_warnings():  # its wrapper's types do, in Python 3.12 and later
        warnings.simplefilter("ignore", DeprecationWarning)
        return importlib.import_module("SimpleITK")


def reason(text: object) -> str:
    """Return the telling last line of a message of ITK's, without addresses."""
    lines = [line.strip() for line in str(text).splitlines() if line.strip()]
    line = lines[-1] if lines else "no reason given"
    return re.sub(r"^(?:\w+::)?(?:ITK )?(?:ERROR|WARNING): |\w+ ?\(0x\w+\): ", "", line)


def read_itk(path: Path) -> tuple[NDArray[Any], dict[str, Any], bool]:
    """Return values, place (the keywords of `Volume`), and whether these are Hounsfield units.

    The values share ITK's memory.

    Raises
    ------
    MeshdepictError
        For a damaged file, another number of dimensions than three, several values in a voxel:
        without the file's name.
    """
    with simpleitk() as sitk:
        try:
            image = sitk.ReadImage(str(path))
        except RuntimeError as error:
            raise MeshdepictError(
                f"is cut off, damaged or not what its suffix says: {reason(error)}"
            ) from error
    if path.name.lower().endswith(_NIFTI):
        _check_length(path, image)
    unit = image.GetMetaData(_UNIT) if image.HasMetaDataKey(_UNIT) else "raw"
    return array_of(image), place_of(image), unit == "HU"


def write_itk(
    path: Path, values: NDArray[Any], volume: Volume, comments: Sequence[str] = ()
) -> None:
    """Write scalar or RGBA values on a volume's grid, wholly or not at all."""
    suffix = "".join(path.suffixes[-2:]) if path.suffix == ".gz" else path.suffix
    with simpleitk() as sitk, atomic_write(path) as file:
        image = sitk.GetImageFromArray(values, isVector=values.ndim == 4)
        image.SetSpacing(volume.spacing.tolist())
        image.SetOrigin(volume.origin.tolist())
        image.SetDirection(volume.direction.ravel().tolist())
        if values.ndim == 3:
            image.SetMetaData(_UNIT, volume.unit)
        if comments and suffix.lower() not in _NIFTI:
            image.SetMetaData(PROVENANCE, "; ".join(comments))
        # ITK chooses the format by the suffix, which the file to be renamed doesn't have.
        with tempfile.TemporaryDirectory(prefix=".", dir=Path(file.name).parent) as folder:
            whole = Path(folder) / f"volume{suffix.lower()}"
            try:
                sitk.WriteImage(image, str(whole), useCompression=suffix == ".nrrd")
            except RuntimeError as error:
                raise OSError(reason(error)) from error
            with whole.open("rb") as stream:
                shutil.copyfileobj(stream, file, 1 << 20)


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
        raise MeshdepictError(f"has {count} values in a voxel, not one")
    return np.asarray(_Held(image))


class _Held:
    """An image and the array on its memory, which lives as long as any view of it."""

    def __init__(self, image: Any) -> None:
        self.image = image
        self.__array_interface__ = _module().GetArrayViewFromImage(image).__array_interface__


def place_of(image: Any) -> dict[str, Any]:
    """Return where an image of three dimensions is, as keywords of `Volume`."""
    return {
        "spacing": np.array(image.GetSpacing()),
        "origin": np.array(image.GetOrigin()),
        "direction": np.array(image.GetDirection()).reshape(3, 3),
    }


def _check_length(path: Path, image: Any) -> None:
    """Refuse a NIfTI file that is cut off: ITK fills what is missing without a word."""
    key = image.GetMetaData
    voxels = image.GetNumberOfPixels() * image.GetNumberOfComponentsPerPixel()
    needed = int(float(key("vox_offset"))) + voxels * int(key("bitpix")) // 8
    found = path.stat().st_size
    with path.open("rb") as file:
        if file.read(2) == b"\x1f\x8b":
            found = 0
            file.seek(0)
            try:
                with gzip.open(file) as unpacked:
                    while part := unpacked.read(1 << 20):
                        found += len(part)
            except (EOFError, OSError, zlib.error) as error:
                raise MeshdepictError(f"is cut off or damaged: {error}") from error
    if found < needed:
        raise MeshdepictError(f"is cut off: it holds {found:,} of {needed:,} bytes")
