"""Equirectangular pictures: reading, directions, values between pixels.

Directions here are in the picture's own frame: y is up, the first row is at +y, the middle column
at −z, the right quarter at +x.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.reach import regular
from meshdepict.scene.upright import upright

__all__ = ["bilinear", "grid", "read_radiance", "to_picture", "to_world"]

Floats = NDArray[Any]

_HEADER = 1 << 16  # bytes in which a picture says its size
_PACKED = 64  # pixels that a byte may stand for


def grid(height: int, width: int) -> NDArray[np.float64]:
    """Return the directions (h, w, 3) to the middles of a picture's pixels, y up."""
    polar = (np.arange(height) + 0.5) * (math.pi / height)
    azimuth = ((np.arange(width) + 0.5) / width - 0.5) * (2 * math.pi)
    out = np.empty((height, width, 3))
    out[..., 0] = np.sin(polar)[:, None] * np.sin(azimuth)
    out[..., 1] = np.cos(polar)[:, None]
    out[..., 2] = -np.sin(polar)[:, None] * np.cos(azimuth)
    return out


def to_picture(directions: Floats, up: str) -> Floats:
    """Turn world directions into the picture's frame, whose y is up."""
    return directions if up == "y" else directions @ upright(up)


def to_world(directions: Floats, up: str) -> Floats:
    """Turn directions of the picture into a world where another axis may be up."""
    return directions if up == "y" else directions @ upright(up).T


def bilinear(pixels: NDArray[np.float32], directions: Floats) -> NDArray[np.float32]:
    """Return radiance between pixels: columns go round, rows end at the poles."""
    height, width = pixels.shape[:2]
    x, y, z = np.moveaxis(directions, -1, 0)
    column = (np.arctan2(x, -z) / (2 * math.pi) + 0.5) * width - 0.5
    row = np.arctan2(np.hypot(x, z), y) / math.pi * height - 0.5
    left, upper = np.floor(column).astype(np.intp), np.floor(row).astype(np.intp)
    right_share = (column - left).astype(np.float32)[..., None]
    lower_share = (row - upper).astype(np.float32)[..., None]
    rows = np.clip(upper, 0, None), np.clip(upper + 1, None, height - 1)
    columns = left % width, (left + 1) % width
    top = (1 - right_share) * pixels[rows[0], columns[0]] + right_share * pixels[
        rows[0], columns[1]
    ]
    base = (1 - right_share) * pixels[rows[1], columns[0]] + right_share * pixels[
        rows[1], columns[1]
    ]
    return (1 - lower_share) * top + lower_share * base


def read_radiance(path: Path) -> NDArray[np.float32]:
    """Return the pixels (h, w, 3) of a Radiance picture, first row up.

    Raises
    ------
    MeshdepictError
        Where there is no such file, or it is something else or damaged.
    """
    regular(path)
    try:
        with path.open("rb") as file:
            begin, size = file.read(_HEADER), path.stat().st_size
    except OSError as error:
        raise MeshdepictError(f"{path}: cannot be read ({error.strerror})") from None
    if not begin.startswith((b"#?RADIANCE", b"#?RGBE")):
        raise MeshdepictError(f"{path}: not a Radiance picture (.hdr)")
    found = re.search(rb"\n\n[-+][XY] +(\d{1,9}) +[-+][XY] +(\d{1,9}) *\n", begin)
    if found is None:
        raise MeshdepictError(f"{path}: a Radiance picture that doesn't say its size")
    # A packed row has two bytes for up to 127 equal ones: VTK believes any claim, and dies of it.
    rows, columns = (int(number) for number in found.groups())
    if not 0 < rows * columns <= _PACKED * size:
        raise MeshdepictError(
            f"{path}: says that it has {columns:.6g} x {rows:.6g} pixels, which a file of {size:,} "
            "bytes can't hold"
        )

    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkHDRReader

    from meshdepict.files.vtk_errors import vtk_errors

    reader: Any = vtkHDRReader()
    with vtk_errors() as errors:
        reader.SetFileName(str(path))
        reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    values = image.GetPointData().GetScalars()
    if errors or values is None or values.GetNumberOfComponents() != 3:
        raise MeshdepictError(f"{path}: a damaged Radiance picture, or of a kind not supported")
    # VTK's first row is the lowest.
    return np.asarray(vtk_to_numpy(values).reshape(height, width, 3)[::-1], np.float32)
