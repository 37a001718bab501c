"""Where a volume's voxels are: what its file says of it, made the keywords of `Volume`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from meshdepict.errors import MeshdepictError
from meshdepict.io.tilt import straightened, tilt_of
from meshdepict.io.volume_contents import VolumeContents
from meshdepict.voxels.volume_input import checked_values, three_numbers

__all__ = ["place"]

_UNPLACED = ("tiff", "images", "npy")  # formats without a place, or with one that few write


def place(contents: VolumeContents, spacing: ArrayLike | None, kind: str, tilt: str) -> None:
    """Bring a file's place to the keywords of `Volume`.

    Parameters
    ----------
    contents : VolumeContents
        Is changed.
    spacing : (3,) array_like or None
        As given with files that don't say it.
    kind : str
        Of file.
    tilt : "resample" or "refuse"

    Raises
    ------
    MeshdepictError
        For a spacing that the file says itself, distances that are none, and oblique slices that
        are to be refused: one clause whose subject is the file.
    """
    known = contents.place
    if spacing is not None:
        if kind not in _UNPLACED and not {"spacing", "steps"}.isdisjoint(known):
            raise MeshdepictError("says its spacing itself: leave spacing= out")
        known["spacing"] = spacing
        contents.length_unit = "" if kind in _UNPLACED else contents.length_unit
    elif "steps" in known:
        _straighten(contents, tilt)
    elif "spacing" not in known:
        contents.notes.append("no spacing is given, taken as 1 along every axis (spacing=)")


def _straighten(contents: VolumeContents, tilt: str) -> None:
    """Turn the steps from voxel to voxel into spacing and direction, of a tilted grid resampled."""
    known = contents.place
    steps = np.asarray(known.pop("steps"), np.float64)
    lengths = np.linalg.norm(steps, axis=0)
    if not np.isfinite(lengths).all():
        raise MeshdepictError("says distances of its voxels that are not finite")
    known["spacing"] = lengths
    known["direction"] = steps / np.where(lengths > 0, lengths, 1.0)
    if not (lengths > 0).all():
        known["direction"] = np.eye(3)  # `Volume` refuses the spacing
    angle = tilt_of(steps)
    if not angle:  # straight, or sheared in its slices, which `Volume` refuses
        return
    if tilt == "refuse":
        raise MeshdepictError(
            f"has slices that lie obliquely on each other, by {angle:.3g}°: resample it first, or "
            "leave that to --tilt resample"
        )
    values = checked_values(contents.values)
    origin = three_numbers(known.get("origin", (0, 0, 0)), "origin")
    contents.values, found = straightened(values, steps, origin, float(values.min()))
    known |= found
    contents.notes.append(
        f"its slices lie obliquely on each other, by {angle:.3g}°, and are resampled to a straight "
        "grid (--tilt refuse)"
    )
