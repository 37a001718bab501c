"""Whether sharp edges smear over planes: normals at vertices are means of what meets there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.scene.names import as_lights
from meshdepict.shapes.parted import PartedMesh, parted_at_creases

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["CREASES", "NOTEWORTHY", "smeared_share"]

CREASES = 40.0
"""Degrees: what is sharp unless somebody says otherwise; facets of something round bend less."""
NOTEWORTHY = 0.1
"""Of the area: from there on it is said."""

_LEVELS = 10  # of 255
_FACES = 100_000  # of more, every second, third, … is looked at first
_LIGHTS = 16  # of a panorama: a few levels' accuracy will do
# Where a crease is smeared, a normal is off its triangle by half of the bend or more, on one side.
_TILTED = np.cos(np.radians(CREASES / 2 - 3))


def smeared_share(mesh: Mesh, light: Any) -> float:
    """Return the share of the area whose tone would be another by 10 levels with sharp edges.

    Estimated from plain Lambertian shading of the corners, whatever the method.

    Parameters
    ----------
    mesh : Mesh
    light : Light, Lights or Environment
    """
    if isinstance(mesh, PartedMesh):
        return 0.0
    some = mesh.outward_faces[:: 1 + len(mesh.faces) // _FACES]
    cross, area = _crosses(mesh, some)
    normals = mesh.normals[some]
    tilted = (np.einsum("mi,mci->mc", cross, normals) < _TILTED * area[:, None]).any(axis=1)
    tilted &= area > 0
    # No plane's corners change more than to the plane's own tone: most scans are done with here.
    plane = _tone(cross[tilted] / area[tilted, None], light)[:, None]
    off = (np.abs(_tone(normals[tilted], light) - plane) > _LEVELS).mean(axis=1)
    if (off * area[tilted]).sum() < NOTEWORTHY * area.sum():
        return 0.0
    parted = parted_at_creases(mesh, CREASES)
    area = _crosses(mesh, mesh.outward_faces)[1]
    tones = [_tone(each.normals, light)[each.faces] for each in (mesh, parted)]
    changed = np.abs(tones[1] - tones[0]) > _LEVELS
    return float((changed.mean(axis=1) * area).sum()) / (float(area.sum()) or 1.0)


def _crosses(mesh: Mesh, faces: NDArray[np.int64]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return vectors along triangles' normals, as long as twice their area, and these lengths."""
    a, b, c = mesh.unit_points[faces].swapaxes(0, 1)
    cross = np.cross(b - a, c - a)
    return cross, np.linalg.norm(cross, axis=1)


def _tone(normals: NDArray[np.float64], light: Any) -> NDArray[np.float64]:
    """Return grey levels of Lambertian shading."""
    lights = as_lights(light, count=_LIGHTS)
    tone = sum(
        float(np.mean(each.color)) * np.maximum(normals @ each.direction, 0) for each in lights
    )
    return 255 * np.asarray(linear_to_srgb(np.clip(tone, 0, 1)), np.float64)
