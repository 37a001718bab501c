"""The point of a volume that is seen through a pixel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane

    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.shapes.volume import Volume

__all__ = ["first_seen"]

_STEP = 0.25  # voxels, as the ray caster's parts of a step
_HALF = 0.5  # of the light of a ray, after which it is seen where it is


def first_seen(
    volume: Volume,
    transfer: TransferFunction,
    near: NDArray[np.float64],
    far: NDArray[np.float64],
    planes: Sequence[vtkPlane] = (),
) -> NDArray[np.float64] | None:
    """Return the point of a ray where opacity has used up half of its light; None if nowhere.

    Parameters
    ----------
    volume : Volume
    transfer : TransferFunction
        In the volume's unit; where it asks for the gradient, that is left out.
    near, far : (3,) array
        The ray's ends, in the volume's diagonals about its centre.
    planes : sequence of vtkPlane
        What is on their negative sides is not there.

    Returns
    -------
    (3,) array or None
        In the volume's diagonals about its centre, too.
    """
    from scipy.ndimage import map_coordinates

    span = _within(volume, near, far)
    if span is None:
        return None
    first, last = span
    voxels = float(np.linalg.norm(_indices(volume, far) - _indices(volume, near))) * (last - first)
    shares = np.linspace(first, last, max(2, int(np.ceil(voxels / _STEP)) + 1))
    points = near + shares[:, None] * (far - near)
    values = map_coordinates(
        volume.values, _indices(volume, points).T[::-1], output=np.float64, order=1, mode="nearest"
    )
    opacity = transfer.opacity(values).astype(np.float64)
    for plane in planes:
        opacity[(points - np.array(plane.GetOrigin())) @ np.array(plane.GetNormal()) < 0] = 0
    # Opacity is that of a voxel's way, by the smallest spacing.
    long = np.linalg.norm(points[1] - points[0]) * volume.diagonal / volume.spacing.min()
    with np.errstate(divide="ignore"):
        used = np.cumsum(np.log1p(-opacity) * long)
    seen = np.flatnonzero(used <= np.log(_HALF))
    return points[seen[0]] if len(seen) else None


def _indices(volume: Volume, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return voxel coordinates (…, 3) along x, y and z of points of the scene."""
    world = points * (volume.diagonal or 1.0) + volume.centre
    found: NDArray[np.float64] = (world - volume.origin) @ volume.direction / volume.spacing
    return found


def _within(
    volume: Volume, near: NDArray[np.float64], far: NDArray[np.float64]
) -> tuple[float, float] | None:
    """Return between which shares of its length a ray is in the box of voxel centres."""
    a, b = _indices(volume, near), _indices(volume, far)
    top = np.array(volume.counts[::-1]) - 1.0
    way = np.where(np.abs(b - a) < 1e-12, 1e-12, b - a)
    sides = np.sort(np.stack([(0 - a) / way, (top - a) / way]), axis=0)
    first, last = max(float(sides[0].max()), 0.0), min(float(sides[1].min()), 1.0)
    return (first, last) if first < last else None
