"""From a camera back to a `View` in world units: the inverse of `canvas.place`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meshdepict.scene.shape import Shape
from meshdepict.scene.vectors import Vector
from meshdepict.scene.view import View

if TYPE_CHECKING:
    from meshdepict.drawing.plotter import Camera

__all__ = ["camera_view", "project_in_parallel", "project_in_perspective", "same_sight"]


def camera_view(camera: Camera, shape: Shape, *, height_px: int = 1000) -> View:
    """Return the view whose eye a ``pyvista.Camera`` is.

    Parameters
    ----------
    camera : pyvista.Camera
        Of a scene that lies about the origin, in diagonals of the shape.
    shape : Mesh
    height_px : int
        What curvature per pixel refers to.
    """
    unit = shape.diagonal or 1.0
    parallel = camera.parallel_projection
    return View(
        np.array(camera.position) * unit + shape.centre,
        np.array(camera.focal_point) * unit + shape.centre,
        camera.up,
        height_px=height_px,
        parallel_scale=camera.parallel_scale * unit if parallel else None,
        field_of_view=None if parallel else camera.view_angle,
    )


def project_in_perspective(camera: Camera, angle: float = 30.0) -> None:
    """Go over to perspective; what lies at the focus keeps its size."""
    away = _away(camera)
    reach = camera.parallel_scale / np.tan(np.radians(angle / 2))
    camera.position = tuple(np.array(camera.focal_point) + away / np.linalg.norm(away) * reach)
    camera.view_angle = angle
    camera.parallel_projection = False


def project_in_parallel(camera: Camera) -> None:
    """Go over to parallel projection; what lies at the focus keeps its size."""
    reach = float(np.linalg.norm(_away(camera)))
    camera.parallel_scale = reach * float(np.tan(np.radians(camera.view_angle / 2)))
    camera.parallel_projection = True


def same_sight(a: View, b: View, shape: Shape) -> bool:
    """Whether two views show a shape alike, up to rounding."""
    near = 1e-9 * (shape.diagonal or 1.0) + 1e-12 * float(np.abs(shape.centre).max())
    return bool(
        np.allclose(a.position, b.position, rtol=0, atol=8 * near)
        and np.allclose(a.focus, b.focus, rtol=0, atol=8 * near)
        and np.allclose(a.frame, b.frame, rtol=0, atol=1e-9)
        and np.isclose(a.parallel_scale or 0, b.parallel_scale or 0, rtol=1e-9, atol=0)
        and np.isclose(a.field_of_view or 0, b.field_of_view or 0, rtol=1e-9, atol=0)
    )


def _away(camera: Camera) -> Vector:
    return np.array(camera.position) - np.array(camera.focal_point)
