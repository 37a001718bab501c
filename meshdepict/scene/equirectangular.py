"""Equirectangular pictures: reading, directions, values between pixels, cuts of equal light.

Directions here are in the picture's own frame: y is up, the first row is at +y, the middle column
at −z, the right quarter at +x.
"""

from __future__ import annotations

import heapq
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.reach import regular
from meshdepict.scene.upright import upright

__all__ = ["bilinear", "grid", "median_cut", "read_radiance", "to_picture", "to_world"]

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


def median_cut(
    power: NDArray[np.float64], solid_angles: NDArray[np.float64], count: int
) -> list[tuple[slice, slice]]:
    """Cut a picture into parts of about equal power."""
    height, width = power.shape
    # What has no light at all is cut too, if it comes to that: by solid angle.
    least = 1e-12 * max(float(power.sum()), 1e-300) / (4 * math.pi)
    mass = np.zeros((height + 1, width + 1))
    mass[1:, 1:] = (power + least * solid_angles).cumsum(axis=0).cumsum(axis=1)

    def total(r0: int, r1: int, c0: int, c1: int) -> float:
        return float(mass[r1, c1] - mass[r0, c1] - mass[r1, c0] + mass[r0, c0])

    def entry(*part: int) -> tuple[bool, float, tuple[int, ...]]:
        single = part[1] - part[0] == 1 and part[3] - part[2] == 1
        return (single, -total(*part), part)  # single pixels go last: they can't be cut

    heap = [entry(0, height, 0, width)]
    while len(heap) < count and not heap[0][0]:
        r0, r1, c0, c1 = heapq.heappop(heap)[2]
        middle = math.sin(math.pi * (r0 + r1) / 2 / height)
        tall = (r1 - r0) / height * math.pi, (c1 - c0) / width * 2 * math.pi * middle
        by_rows = c1 - c0 == 1 or (r1 - r0 > 1 and tall[0] >= tall[1])
        if by_rows:
            before = mass[r0 : r1 + 1, c1] - mass[r0 : r1 + 1, c0]
        else:
            before = mass[r1, c0 : c1 + 1] - mass[r0, c0 : c1 + 1]
        half = (before[0] + before[-1]) / 2
        cut = 1 + int(np.argmin(np.abs(before[1:-1] - half)))
        if by_rows:
            parts = (r0, r0 + cut, c0, c1), (r0 + cut, r1, c0, c1)
        else:
            parts = (r0, r1, c0, c0 + cut), (r0, r1, c0 + cut, c1)
        for part in parts:
            heapq.heappush(heap, entry(*part))
    return [(slice(r0, r1), slice(c0, c1)) for _, _, (r0, r1, c0, c1) in sorted(heap)]


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
