"""DICOM series: which slices belong together, and their numbers stacked in Hounsfield units."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.reach import inside
from meshdepict.io.dicom_geometry import apart_from_the_plane, stacked
from meshdepict.io.dicom_header import Slice, headers, is_dicom, opened
from meshdepict.io.dicom_pixels import stored_numbers
from meshdepict.io.folders import MAPS, SCANS, held
from meshdepict.io.source import MESHES
from meshdepict.io.tilt import straightened
from meshdepict.io.volume_contents import VolumeContents, printable, rescaled
from meshdepict.voxels.volume_input import fitting_integer

__all__ = ["Slice", "headers", "is_dicom", "read_dicom"]

_MOST_NOTES = 4  # damage may be told of a thousand files
_AIR = -1000.0  # HU, for voxels outside of the scanner's field of view


def read_dicom(path: Path, series: str | int | None, *, tilt: str = "resample") -> VolumeContents:
    """Return a series' values in the order of their places, as the scanner measured them.

    Parameters
    ----------
    path : Path
        A folder, a DICOMDIR, or one file of a series, which stands for all of its series beside
        it.
    series : str, int or None
        The series' id or its number in the list that the error shows.
    tilt : "resample" or "refuse"
        What to do with slices of a tilted gantry.

    Raises
    ------
    MeshdepictError
        For no DICOM at all, several series and no choice, slices that make no grid, damaged files:
        without the path.
    """
    notes: list[str] = []
    found = _found(path, series, notes)
    planes, numbers = _planes(found, notes), _Numbers(notes, found)
    try:
        stack = stacked(planes, numbers.same)
    except MeshdepictError as error:  # what was left out may be why
        raise MeshdepictError("; ".join([str(error), *notes])) from error
    if stack.copies:
        copy, kept = stack.copies[0]
        notes.append(
            f"slices that are there twice are left out: {len(stack.copies)}, the first {copy.name} "
            f"(as {kept.name})"
        )
    slices = stack.slices
    hounsfield = all(one.hounsfield for one in slices)
    first = slices[0]
    _note_header(slices, hounsfield, notes)
    values = _stacked([numbers.of(one) for one in slices])
    place: dict[str, Any] = {
        "spacing": np.linalg.norm(stack.steps, axis=0),
        "origin": first.origin,
        "direction": first.direction,
    }
    if stack.tilt:
        if tilt == "refuse":
            raise MeshdepictError(
                "holds slices that are shifted against each other, as the gantry was tilted by "
                f"{stack.tilt:.3g}°; resample it first, or leave that to --tilt resample"
            )
        fill = _AIR if hounsfield else float(values.min())
        values, place = straightened(values, stack.steps, first.origin, fill)
        notes.append(
            f"the gantry was tilted by {stack.tilt:.3g}°, its slices are resampled to a straight "
            "grid (--tilt refuse)"
        )
    attributes = {
        name: text
        for name, tag in (
            ("series", "0020|000e"),
            ("description", "0008|103e"),
            ("modality", "0008|0060"),
        )
        if (text := first.tag(tag))
    }
    unit = "mm" if first.has_spacing else ""
    notes[:] = [*dict.fromkeys(notes)][:_MOST_NOTES]
    return VolumeContents(values, place, hounsfield, unit, attributes, notes)


def _found(path: Path, series: str | int | None, notes: list[str]) -> list[Slice]:
    """Return the headers of one series, without what is no slice of it."""
    if path.is_dir():
        files = sorted(path.rglob("*"))
        found, left_out = headers(files)
        if not found:
            raise MeshdepictError(f"holds no DICOM images{_instead(path, files, left_out)}")
        found = _chosen(found, series)
    else:
        file = opened(path)
        if file.records:
            found, left_out = headers(_listed(path, file.records))
            found = _chosen(found, series)
        elif file.pixels is None:
            raise MeshdepictError("is DICOM, but holds no image: give the folder of the slices")
        else:
            found, left_out = headers([path])
            if found[0].frames == 1 and found[0].series:
                own = found[0]
                beside, left_out = headers(sorted(path.parent.iterdir()))
                found = [one for one in beside if one.series == own.series]
            elif image := found[0].concatenation:
                beside, left_out = headers(sorted(path.parent.iterdir()))
                found = [one for one in beside if one.concatenation == image]
    _note_parts(found, notes)
    if left_out:
        notes.append(
            "DICOM files that hold no image, or are damaged, are left out: "
            f"{len(left_out)}, the first {left_out[0].name}"
        )
    return _without_localisers(found, notes)


def _planes(found: list[Slice], notes: list[str]) -> list[Slice]:
    """Return all slices: files, or the frames that they hold."""
    if len(found) == 1 and (found[0].frames > 1 or found[0].file.frames):
        planes = found[0].planes()
        if not (planes[0].has_position and found[0].file.frames) and found[0].offsets is None:
            notes.append("it doesn't say how far its frames are apart, taken as 1")
        return planes
    # Files of many frames are one stack where each frame says where it is.
    return [
        plane
        for one in found
        for plane in (one.planes(among=True) if one.file.frames else [one])
    ]  # fmt: skip


def _note_parts(found: list[Slice], notes: list[str]) -> None:
    """Note parts of a concatenation that are not there."""
    due = max((int(one.number("0020|9163", 0)) for one in found if one.concatenation), default=0)
    if due > len(found):
        notes.append(
            f"its image is spread over {due:,} files, of which {len(found):,} are there: the "
            "others are missing"
        )


def _instead(folder: Path, files: list[Path], left_out: list[Path]) -> str:
    """Return what a folder holds instead of DICOM images, in words that follow these."""
    if left_out:
        return f" that can be read: {left_out[0].name} is damaged, or holds none"
    suffixes = Counter(path.suffix.lower() for path in files if path.is_file())
    if not suffixes:
        return ": it has no files"
    common = suffixes.most_common(1)[0][0]
    return (
        f", nor slices as TIFF, BMP, PNG or JPEG: most of its {suffixes.total():,} files are "
        f"{printable(common)[:20] or 'without a suffix'}"
        f"{held(folder, MESHES | MAPS | SCANS)}"
    )


def _listed(path: Path, records: Sequence[dict[str, str]]) -> list[Path]:
    """Return the files that a DICOMDIR lists and that are there."""
    names = [
        [printable(part.strip(" \0")) for part in record["0004|1500"].split("\\")]
        for record in records
        if record.get("0004|1500", "").strip(" \0")
    ]
    if not names:
        raise MeshdepictError("is a DICOMDIR that lists no files: give the folder of the slices")
    found = []
    for parts in names:
        for spelt in (parts, [part.lower() for part in parts]):  # as CDs are copied
            file = inside(path.parent, "/".join(spelt), "file")
            if file.exists():
                found.append(file)
                break
    if not found:
        raise MeshdepictError(
            f"is a DICOMDIR: it lists {len(names):,} files, and none is beside it; give the folder "
            "of the slices"
        )
    return sorted(set(found))


def _chosen(found: list[Slice], series: str | int | None) -> list[Slice]:
    groups: dict[str, list[Slice]] = {}
    for slice_ in sorted(found, key=lambda one: (one.number("0020|0011", 0), one.series)):
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


def _without_localisers(found: list[Slice], notes: list[str]) -> list[Slice]:
    """Leave out overviews and pictures of screens among slices."""
    told = [one for one in found if one.is_localiser]
    if len(told) == len(found):
        told = []
    rest = [one for one in found if one not in told]
    told += apart_from_the_plane(rest)
    if told:
        notes.append(
            f"localisers among the slices are left out: {len(told)}, the first {told[0].name}"
        )
    return [one for one in rest if one not in told]


def _note_header(slices: list[Slice], hounsfield: bool, notes: list[str]) -> None:  # noqa: FBT001
    if any(one.has_commas for one in slices):
        notes.append("its header has decimal commas, read as points")
    if not all(one.has_spacing for one in slices):
        notes.append("it says no pixel spacing, taken as 1")
    if not hounsfield and slices[0].tag("0028|0004") == "MONOCHROME1":
        notes.append(
            "its numbers are meant to be shown inverted (MONOCHROME1), and are taken as they are"
        )


class _Numbers:
    """The rescaled numbers of slices, from files of one slice each or of many frames."""

    def __init__(self, notes: list[str], files: Sequence[Slice]) -> None:
        self._notes = notes
        self._files = {file.path: file for file in files}
        self._frames: dict[Path, tuple[NDArray[Any], NDArray[np.bool_] | None]] = {}

    def _stored(self, one: Slice) -> tuple[NDArray[Any], NDArray[np.bool_] | None]:
        if one.frame is None:
            numbers, padded = stored_numbers(one, self._notes)
        else:
            if one.path not in self._frames:
                self._frames[one.path] = stored_numbers(self._files[one.path], self._notes)
            numbers, padded = self._frames[one.path]
        at = one.frame or 0
        return numbers[at], None if padded is None else padded[at]

    def same(self, one: Slice, other: Slice) -> bool:
        """Whether two slices hold the same numbers."""
        alike = (one.slope, one.intercept) == (other.slope, other.intercept)
        return alike and np.array_equal(self._stored(one)[0], self._stored(other)[0])

    def of(self, one: Slice) -> NDArray[Any]:
        """Return a slice's rescaled numbers in the narrowest type, its padding as air.

        Far outside of the scale padding would be an edge.
        """
        stored, padded = self._stored(one)
        values = rescaled(stored, one.slope, one.intercept)
        if padded is None or not padded.any():
            return values
        if one.hounsfield:
            signed = values.astype(np.int32) if values.dtype.kind == "u" else values
            values = np.where(padded, np.asarray(_AIR, signed.dtype), signed)
            return _narrow(values)
        fill = values.min() if padded.all() else values[~padded].min()
        return np.where(padded, fill, values)


def _narrow(values: NDArray[Any]) -> NDArray[Any]:
    """Return integers in 16 bits where they fit."""
    if values.dtype.kind != "i":
        return values
    return values.astype(fitting_integer(int(values.min()), int(values.max())), copy=False)


def _stacked(planes: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return all slices' numbers in the type that holds them all.

    Each is rescaled by its own slope (in PET they differ): ITK would cut all to the first's type.
    """
    kind = np.result_type(*{plane.dtype for plane in planes})
    stack = np.empty((len(planes), *planes[0].shape), kind)
    for at, plane in enumerate(planes):
        stack[at] = plane
    return stack
