"""What a DICOM file's header says of its slices: where they are, and what their numbers mean."""

from __future__ import annotations

import math
import mmap
import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.dicom_elements import DicomFile, Texts, looks_like_dicom, parse
from meshdepict.io.volume_contents import printable

__all__ = ["Slice", "headers", "is_dicom", "opened"]

_SUFFIXES = (".dcm", ".dicom", ".ima")
_DIRECTORY = "1.2.840.10008.1.3.10"
_SCREENSHOT = "1.2.840.10008.5.1.4.1.1.7"  # secondary capture
_MOST_BITS = 32


@dataclass(frozen=True, eq=False)
class Slice:
    """One DICOM file's header; of a file of many frames also that of a single frame."""

    path: Path
    size: tuple[int, ...]
    spacing: NDArray[np.float64]
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    tags: Texts
    file: DicomFile = field(default_factory=DicomFile, repr=False)
    frame: int | None = None
    among: bool = False  # whether its series has several files of many frames

    def tag(self, name: str, default: str = "") -> str:
        """Return a tag such as "0020|000e" without padding, fit to be printed."""
        text = self.tags.get(name, default).strip(" \0")
        # In other character sets than UTF-8 bytes come as lone surrogates, which nothing prints.
        return printable(text.encode(errors="surrogateescape").decode(errors="replace"))

    def number(self, name: str, default: float) -> float:
        """Return the number that a tag says."""
        return _numbers(self.tags, name, self.path.name, (default,))[0]

    @property
    def name(self) -> str:
        """What messages call it."""
        if self.frame is None:
            return self.path.name
        number = f"frame {self.frame + 1}"
        return f"{self.path.name}, {number}" if self.among else number

    @property
    def series(self) -> str:
        """The series' id (SeriesInstanceUID)."""
        return self.tag("0020|000e")

    @property
    def concatenation(self) -> str:
        """The id that files share over which the frames of one image are spread; "" for none."""
        return self.tag("0020|9161")

    @property
    def frames(self) -> int:
        """How many slices the file holds."""
        return self.size[2] if len(self.size) > 2 else 1

    @property
    def has_position(self) -> bool:
        """Whether the header says where the slice is."""
        return "0020|0032" in self.tags and "0020|0037" in self.tags

    @property
    def has_spacing(self) -> bool:
        """Whether the header says how far pixels are apart."""
        return "0028|0030" in self.tags

    @property
    def has_commas(self) -> bool:
        """Whether numbers that matter are written with decimal commas."""
        return any("," in self.tags.get(name, "") for name in _DECIMALS)

    @cached_property
    def slope(self) -> float:
        """Rescale slope, 1 where there is none."""
        slope = self.number("0028|1053", 1.0)
        if slope == 0:
            raise MeshdepictError(f"says a rescale slope of 0 in {self.name}: correct the header")
        return slope

    @cached_property
    def intercept(self) -> float:
        """Rescale intercept, 0 where there is none."""
        return self.number("0028|1052", 0.0)

    @property
    def hounsfield(self) -> bool:
        """Whether the rescaled numbers are Hounsfield units."""
        kind = self.tag("0028|1054")
        rescaled = "0028|1052" in self.tags and "0028|1053" in self.tags
        return self.tag("0008|0060") == "CT" and rescaled and kind in ("", "HU", "US")

    @property
    def stored_padding(self) -> tuple[float, float] | None:
        """Ends of the stored numbers that stand for "nothing measured here"."""
        if not self.tag("0028|0120"):
            return None
        first = self.number("0028|0120", 0.0)
        last = self.number("0028|0121", first)
        # The tag may be written unsigned where the pixels are signed, and the other way round.
        signed, size = self.tag("0028|0103") == "1", 2.0 ** self.number("0028|0100", 16)
        ends = sorted(
            end - size
            if signed and end >= size / 2
            else end + size
            if not signed and end < 0
            else end
            for end in (first, last)
        )
        return ends[0], ends[1]

    @property
    def padding(self) -> tuple[float, float] | None:
        """Ends of the rescaled numbers that stand for "nothing measured here"."""
        if self.stored_padding is None:
            return None
        low, high = sorted(self.slope * end + self.intercept for end in self.stored_padding)
        return low, high

    @property
    def is_localiser(self) -> bool:
        """Whether it is an overview that the slices were planned on, or a picture of a screen."""
        words = self.tag("0008|0008").upper().split("\\")
        return (
            not {"LOCALIZER", "LOCALISER", "SCOUT", "TOPOGRAM"}.isdisjoint(words)
            or (self.tag("0008|0016") == _SCREENSHOT and not self.has_position)
        )  # fmt: skip

    def planes(self, *, among: bool = False) -> list[Slice]:
        """Return a slice for every frame, each with what is said of it alone.

        Parameters
        ----------
        among : bool
            Whether there are frames of other files.

        Raises
        ------
        MeshdepictError
            Where the places of some frames only are told.
        """
        if self.frames == 1 and not self.file.frames:
            return [self]
        said = self.file.frames
        if said and len(said) != self.frames:
            raise MeshdepictError(
                f"says where {len(said):,} frames are, but holds {self.frames:,}: {self.path.name} "
                "is damaged"
            )
        if said:
            shared = self.tags | self.file.shared
            return [
                _placed(replace(self, tags=shared | one, frame=at, among=among))
                for at, one in enumerate(said)
            ]
        offsets = self.offsets
        normal = self.direction[:, 2]
        return [
            replace(self, frame=at, origin=self.origin + normal * offset)
            for at, offset in enumerate(offsets or range(self.frames))
        ]

    @property
    def offsets(self) -> list[float] | None:
        """Heights of the frames over the first, in files that don't place each; None: not said."""
        if self.tag("3004|000c"):
            found = _numbers(self.tags, "3004|000c", self.path.name, ())
            if len(found) == self.frames:
                return list(found)
        step = self.number("0018|0088", 0.0) or self.number("0018|0050", 0.0)
        return [at * step for at in range(self.frames)] if step else None


_DECIMALS = ("0018|0050", "0018|0088", "0020|0032", "0020|0037", "0028|0030", "0028|1052",
             "0028|1053")  # fmt: skip
_COUNTS = {"0020|0032": 3, "0020|0037": 6, "0028|0030": 2}
_NAMES = {
    "0020|0032": "position", "0020|0037": "orientation", "0028|0030": "pixel spacing",
    "0028|1052": "rescale intercept", "0028|1053": "rescale slope", "0018|0088": "spacing",
    "0018|0050": "thickness", "0028|0010": "number of rows", "0028|0011": "number of columns",
    "0028|0008": "number of frames", "0028|0100": "number of bits",
}  # fmt: skip


def _numbers(tags: Texts, name: str, where: str, default: Iterable[float]) -> tuple[float, ...]:
    """Return a tag's finite numbers, also those with decimal commas."""
    text = tags.get(name, "").strip(" \0")
    if not text:
        return tuple(default)
    parts = [part.strip() for part in text.split("\\")]
    try:
        found = tuple(
            float(re.sub(r"^([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)$", r"\1.\2", part)) for part in parts
        )
    except ValueError:
        found = ()
    wanted = _COUNTS.get(name, 0)
    if not found or not all(map(math.isfinite, found)) or (wanted and len(found) != wanted):
        raise MeshdepictError(
            f"says the {_NAMES.get(name, name)} '{printable(text)[:60]}' in {where}, which is no "
            f"{'list of numbers' if wanted else 'number'}: correct the header"
        )
    return found


def is_dicom(path: Path) -> bool:
    """Whether a file looks like DICOM: by its beginning, else by its suffix."""
    with path.open("rb") as file:
        start = file.read(132)
    return path.suffix.lower() in _SUFFIXES or looks_like_dicom(start, path.stat().st_size)


def opened(path: Path) -> DicomFile:
    """Return what a file's elements say.

    Raises
    ------
    MeshdepictError
        For a file that is cut off, damaged or no DICOM: one clause whose subject is the file.
    """
    with path.open("rb") as file:
        if path.stat().st_size == 0:
            raise MeshdepictError("is empty")
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            found = parse(data)
            if found.data is data:
                found.data = b""  # a series has more files than a process may hold open
    return found


def headers(paths: Iterable[Path]) -> tuple[list[Slice], list[Path]]:
    """Return the headers of those files that are DICOM images, and DICOM files that are none.

    Raises
    ------
    MeshdepictError
        For places and counts that are no numbers.
    """
    found, left_out = [], []
    for path in paths:
        if not path.is_file() or not is_dicom(path):
            continue
        try:
            file = opened(path)
        except MeshdepictError:
            left_out.append(path)
            continue
        if file.records or file.texts.get("0008|0016", "").strip(" \0") == _DIRECTORY:
            continue  # a DICOMDIR: the files that it lists are here themselves
        if path.name.upper() == "DICOMDIR":
            continue
        if file.pixels is None:
            left_out.append(path)
        else:
            found.append(_slice(path, file))
    return found, left_out


def _slice(path: Path, file: DicomFile) -> Slice:
    """Return the header of an image."""
    counts = [
        _numbers(file.texts, name, path.name, (1,))[0]
        for name in ("0028|0011", "0028|0010", "0028|0008")
    ]
    bits = _numbers(file.texts, "0028|0100", path.name, (16,))[0]
    if not all(1 <= n < 1 << 31 and n == int(n) for n in counts) or not 0 < bits <= 64:
        raise MeshdepictError(f"is damaged: {path.name} says an impossible size of its image")
    zeros = np.zeros(3)
    size = tuple(int(n) for n in counts)
    return _placed(Slice(path, size, zeros, zeros, np.eye(3), file.texts, file))


def _placed(one: Slice) -> Slice:
    """Return a slice where its tags say that it is."""
    where, tags = replace(one, among=True).name, one.tags
    rows, columns = _numbers(tags, "0028|0030", where, (1, 1))
    step = one.number("0018|0088", 0.0) or one.number("0018|0050", 0.0) or 1.0
    ways = np.reshape(_numbers(tags, "0020|0037", where, (1, 0, 0, 0, 1, 0)), (2, 3))
    lengths = np.linalg.norm(ways, axis=1)
    if np.abs(lengths - 1).max() > 0.01 or abs(ways[0] @ ways[1]) > 0.01:
        raise MeshdepictError(
            f"says an orientation in {where} whose axes are not orthonormal: correct the header"
        )
    x, y = ways / lengths[:, None]
    z = np.cross(x, y)
    return replace(
        one,
        spacing=np.array((columns, rows, step)),
        origin=np.array(_numbers(tags, "0020|0032", where, (0, 0, 0))),
        direction=np.stack((x, y, z / np.linalg.norm(z)), axis=1),
    )
