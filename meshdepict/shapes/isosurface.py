"""Surfaces of equal CT number, as meshes: the other way to see a volume."""

from __future__ import annotations

import numpy as np

from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.volume import Volume

__all__ = ["isosurface"]


def isosurface(volume: Volume, value: float) -> Mesh:
    """Return the surface where a volume has a value, in world coordinates (marching cubes).

    Faces look towards lower values, out of dense things and into the voids in them: the gradient
    says so everywhere, and nothing is turned afterwards.

    Parameters
    ----------
    volume : Volume
    value : float
        In the volume's unit: about 200 HU for bone, −300 HU for skin.

    Raises
    ------
    MeshdepictError
        For a value that is no number, or outside of those that the volume has.
    """
    if not isinstance(volume, Volume):
        raise MeshdepictError(f"a {type(volume).__name__} has no isosurface: give a Volume")
    low, high = volume.range
    number = real(value)
    if number is None or not low < number < high:
        raise MeshdepictError(
            f"a surface at {value!r} can't be found: the volume's values are {low:g} … {high:g} "
            f"({volume.unit})"
        )
    if not np.isfinite(high - low):
        raise MeshdepictError(
            f"a surface between values from {low:g} to {high:g}, whose difference is no number, "
            "can't be found: give the volume's values in another unit"
        )
    # Found on the grid itself, of spacing 1, and then taken to the world: neither large offsets
    # nor tiny voxels cost digits, and any direction will do.
    grid = volume.to_pyvista()
    grid.origin, grid.spacing, grid.direction_matrix = (0, 0, 0), (1, 1, 1), np.eye(3)
    found = grid.contour([value], scalars="values", method="flying_edges", compute_normals=False)
    faces = np.asarray(found.regular_faces, np.int64)
    vertices = volume.to_world(np.asarray(found.points, np.float64))
    if np.linalg.det(volume.direction) < 0:
        faces = faces[:, ::-1]
    return Mesh(vertices, faces, winding="keep", length_unit=volume.length_unit)
