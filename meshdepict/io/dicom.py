"""DICOM series: which slices belong together, and their numbers stacked in Hounsfield units."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.dicom_geometry import stacked_place
from meshdepict.io.itk import array_of, place_of, reason, simpleitk
from meshdepict.voxels.volume_input import fitting_integer

__all__ = ["Slice", "headers", "is_dicom", "read_dicom"]

_SUFFIXES = (".dcm", ".dicom", ".ima")
_AIR = -1000.0  # HU, for voxels outside of the scanner's field of view


@dataclass(frozen=True)
class Slice:
    """One DICOM file's header."""

    path: Path
    size: tuple[int, ...]
    spacing: NDArray[np.float64]
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    tags: dict[str, str]

    def tag(self, name: str, default: str = "") -> str:
        """Return a tag such as "0020|000e" without padding."""
        text = self.tags.get(name, default).strip(" \0")
        # In other character sets than UTF-8 bytes come as lone surrogates, which nothing prints.
        return text.encode(errors="surrogateescape").decode(errors="replace")

    @property
    def series(self) -> str:
        """The series' id (SeriesInstanceUID)."""
        return self.tag("0020|000e")

    @property
    def frames(self) -> int:
        """How many slices the file holds."""
        return self.size[2] if len(self.size) > 2 else 1

    @property
    def has_position(self) -> bool:
        """Whether the header says where the slice is."""
        return "0020|0032" in self.tags and "0020|0037" in self.tags

    @cached_property
    def slope(self) -> float:
        """Rescale slope, 1 where there is none."""
        return float(self.tag("0028|1053") or 1)

    @property
    def hounsfield(self) -> bool:
        """Whether the rescaled numbers are Hounsfield units."""
        kind = self.tag("0028|1054")
        rescaled = "0028|1052" in self.tags and "0028|1053" in self.tags
        return self.tag("0008|0060") == "CT" and rescaled and kind in ("", "HU", "US")

    @property
    def padding(self) -> tuple[float, float] | None:
        """Ends of the rescaled numbers that stand for "nothing measured here"."""
        if not self.tag("0028|0120"):
            return None
        first = float(self.tag("0028|0120"))
        last = float(self.tag("0028|0121") or first)
        # The tag may be written unsigned where the pixels are signed, and the other way round.
        signed, size = self.tag("0028|0103") == "1", 2.0 ** int(self.tag("0028|0100", "16"))
        stored = [
            end - size
            if signed and end >= size / 2
            else end + size
            if not signed and end < 0
            else end
            for end in (first, last)
        ]
        intercept = float(self.tag("0028|1052") or 0)
        low, high = sorted(self.slope * end + intercept for end in stored)
        return low, high


def is_dicom(path: Path) -> bool:
    """Whether a file looks like DICOM: by its preamble, else by its suffix."""
    with path.open("rb") as file:
        return file.read(132)[128:] == b"DICM" or path.suffix.lower() in _SUFFIXES


def read_dicom(
    path: Path, series: str | int | None
) -> tuple[NDArray[Any], dict[str, Any], bool, dict[str, str]]:
    """Return values, place, whether these are Hounsfield units, and attributes.

    Parameters
    ----------
    path : Path
        A folder, or one file of a series, which stands for all of its series beside it.
    series : str, int or None
        The series' id or its number in the list that the error shows.

    Raises
    ------
    MeshdepictError
        For no DICOM at all, several series and no choice, slices that make no grid, damaged files:
        without the path.
    """
    if path.is_dir():
        found, left_out = headers(sorted(path.rglob("*")))
        found = _chosen(found, series)
    else:
        found, left_out = headers([path])
        if not found:
            raise MeshdepictError("is cut off, damaged or no DICOM")
        if found[0].frames == 1 and found[0].series:
            beside, left_out = headers(sorted(path.parent.iterdir()))
            found = [slice_ for slice_ in beside if slice_.series == found[0].series]
    if left_out:
        warnings.warn(
            f"{path}: DICOM files that hold no image, or are damaged, are left out: "
            f"{len(left_out)}, the first {left_out[0].name}",
            MeshdepictWarning,
            stacklevel=4,
        )
    if len(found) == 1 and found[0].frames > 1:
        values, place = _read(found[0])
    else:
        found, place = stacked_place(found)
        values = _stacked(found)
    first = found[0]
    attributes = {
        name: text
        for name, tag in (
            ("series", "0020|000e"),
            ("description", "0008|103e"),
            ("modality", "0008|0060"),
        )
        if (text := first.tag(tag))
    }
    return values, place, all(slice_.hounsfield for slice_ in found), attributes


def headers(paths: Sequence[Path]) -> tuple[list[Slice], list[Path]]:
    """Return the headers of those files that are DICOM images, and DICOM files that are none."""
    found, left_out = [], []
    with simpleitk() as sitk:
        reader = sitk.ImageFileReader()
        reader.SetImageIO("GDCMImageIO")
        for path in paths:
            if path.name == "DICOMDIR" or not path.is_file() or not is_dicom(path):
                continue
            reader.SetFileName(os.fspath(path))
            try:
                reader.ReadImageInformation()
            except RuntimeError:
                left_out.append(path)
                continue
            direction = np.array(reader.GetDirection())
            tags = {key: reader.GetMetaData(key) for key in reader.GetMetaDataKeys()}
            found.append(
                Slice(
                    path,
                    reader.GetSize(),
                    np.array(reader.GetSpacing()),
                    np.array(reader.GetOrigin()),
                    direction.reshape(reader.GetDimension(), -1),
                    {key: text for key, text in tags.items() if "|" in key},
                )
            )
    return found, left_out


def _chosen(found: list[Slice], series: str | int | None) -> list[Slice]:
    groups: dict[str, list[Slice]] = {}
    for slice_ in sorted(found, key=lambda one: (int(one.tag("0020|0011") or 0), one.series)):
        groups.setdefault(slice_.series, []).append(slice_)
    if not groups:
        raise MeshdepictError("holds no DICOM images")
    ids = list(groups)
    if series is None and len(ids) == 1:
        return found
    if str(series) in groups:
        return groups[str(series)]
    if str(series).isdecimal() and 1 <= int(str(series)) <= len(ids):
        return groups[ids[int(str(series)) - 1]]
    listed = "; ".join(
        f"{number}: {group[0].tag('0008|103e') or 'no description'}, {group[0].tag('0008|0060')}, "
        f"{sum(one.frames for one in group)} slices, {uid or 'no id'}"
        for number, (uid, group) in enumerate(groups.items(), 1)
    )
    missing = "" if series is None else f", none of them {series!r}"
    raise MeshdepictError(
        f"holds {len(ids)} series{missing}; choose one by its number or id (series=1): {listed}"
    )


def _read(slice_: Slice) -> tuple[NDArray[Any], dict[str, Any]]:
    """Return the rescaled numbers of one file, in the narrowest type, and its place."""
    with simpleitk() as sitk:
        try:
            image = sitk.ReadImage(str(slice_.path), imageIO="GDCMImageIO")
        except RuntimeError as error:
            raise MeshdepictError(
                f"holds a damaged file, {slice_.path.name}: {reason(error)}"
            ) from error
    values = _without_padding(array_of(image), slice_)
    if values.dtype.kind in "iu":
        if values.dtype.itemsize > 2:  # ITK leaves room for all that 16 bits and a rescale can be
            values = values.astype(fitting_integer(values.min(), values.max()))
    else:
        values = values.astype(np.float32)
    return values, place_of(image)


def _without_padding(values: NDArray[Any], slice_: Slice) -> NDArray[Any]:
    """Return numbers whose padding is air: far outside of the scale it would be an edge."""
    if slice_.padding is None:
        return values
    low, high = slice_.padding
    half = abs(slice_.slope) / 2
    padded = (values > low - half) & (values < high + half)
    if not padded.any():
        return values
    if slice_.hounsfield:
        signed = values.astype(np.int32) if values.dtype.kind == "u" else values
        return np.where(padded, np.asarray(_AIR, signed.dtype), signed)
    fill = values.min() if padded.all() else values[~padded].min()
    return np.where(padded, fill, values)


def _stacked(slices: Sequence[Slice]) -> NDArray[Any]:
    """Return all slices' numbers in the type that holds them all.

    Each is rescaled by its own slope (in PET they differ): ITK would cut all to the first's type.
    """
    arrays = [_read(slice_)[0] for slice_ in slices]
    kind = np.result_type(*arrays)
    stack = np.empty((len(arrays), *arrays[0].shape[1:]), kind)
    for at, array in enumerate(arrays):
        stack[at] = array[0]
    return stack
