"""What lies in a folder that was given for a file, and how its files are given instead."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Collection, Mapping
from pathlib import Path

__all__ = ["MAPS", "RASTERS", "SCANS", "held"]

RASTERS = (
    ".adf", ".asc", ".bag", ".bil", ".bt", ".dem", ".dt0", ".dt1", ".dt2", ".flt", ".grd", ".grib",
    ".grb", ".grb2", ".gtx", ".hgt", ".img", ".nc", ".rst", ".sdat", ".ter", ".vrt",
)  # fmt: skip
"""Suffixes that rasters have and neither meshes nor volumes."""

MAPS: dict[str, tuple[str, ...]] = {"elevation models": (".tif", ".tiff", *RASTERS)}
SCANS: dict[str, tuple[str, ...]] = {"volumes": (".nii", ".nrrd", ".nhdr", ".mha", ".mhd", ".vti")}
"""Suffixes by what such files hold, without what may be anything."""

_MOST = 10_000  # names; more say no more about what a folder is for


def held(folder: str | os.PathLike[str], kinds: Mapping[str, Collection[str]]) -> str:
    """Say which of a folder's files can be given instead of it, "" where none can.

    Parameters
    ----------
    folder : path
    kinds : mapping
        Suffixes in lower case, without ``.gz``, by what files with them hold, in the plural.

    Returns
    -------
    str
        Words that follow "is a folder", about the first kind that is there.
    """
    try:
        with os.scandir(folder) as entries:
            names = [entry.name for entry, _ in zip(entries, range(_MOST), strict=False)]
    except OSError:
        return ""
    ends = {name: Path(name.lower().removesuffix(".gz")).suffix for name in names}
    for kind, suffixes in kinds.items():
        found = sorted(name for name, end in ends.items() if end in suffixes)
        if not found:
            continue
        # The suffix that most of them have.
        ((suffix, count),) = Counter(ends[name] for name in found).most_common(1)
        if len(found) == 1 or count == 1:
            return f"; did you mean {Path(folder) / found[0]}?"
        packed = all(name.lower().endswith(".gz") for name in found if ends[name] == suffix)
        every = Path(folder) / f"*{suffix}{'.gz' if packed else ''}"
        of = "" if count == len(found) else " of one kind"
        return f"; for its {count:,} {kind}{of} give {every}"
    return ""
