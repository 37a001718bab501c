"""Before and after: a line parts the picture, the object before to its left, after to its right."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdepict.drawing.plotter import Camera

__all__ = ["Wipe", "wipe_normal"]

Vector = NDArray[np.float64]


def wipe_normal(camera: Camera, place: float, aspect: float) -> tuple[Vector, Vector]:
    """Return a point of the plane that a vertical line on the picture is, and its normal.

    Parameters
    ----------
    camera : pyvista.Camera
    place : float
        Of the line: 0 at the left edge, 1 at the right.
    aspect : float
        Width over height of the picture.

    Returns
    -------
    origin, normal : (3,) array
        The normal goes to the right. In perspective the plane goes through the eye.
    """
    position, focus = np.array(camera.position), np.array(camera.focal_point)
    forward = (focus - position) / np.linalg.norm(focus - position)
    right = np.cross(forward, np.array(camera.up))
    right /= np.linalg.norm(right)
    across = (2 * place - 1) * aspect
    if camera.parallel_projection:
        return focus + across * camera.parallel_scale * right, right
    slant = across * np.tan(np.radians(camera.view_angle / 2))
    normal = right - slant * forward
    return position, normal / np.linalg.norm(normal)


class Wipe:
    """The line and its two planes.

    Attributes
    ----------
    on : bool
    place : float
        0 at the left edge, 1 at the right.
    now, before : vtkPlane
        The object now lies on the positive side of the one, as it was on that of the other.
    line : vtkActor2D
    """

    def __init__(self) -> None:
        import pyvista as pv
        from vtkmodules.vtkCommonDataModel import vtkPlane
        from vtkmodules.vtkRenderingCore import vtkActor2D, vtkCoordinate, vtkPolyDataMapper2D

        self.on = False
        self.place = 0.5
        self.now, self.before = vtkPlane(), vtkPlane()
        mapper = vtkPolyDataMapper2D()
        mapper.SetInputData(pv.Line((0, 0, 0), (0, 1, 0)))
        mapper.ScalarVisibilityOff()
        coordinate = vtkCoordinate()
        coordinate.SetCoordinateSystemToNormalizedViewport()
        mapper.SetTransformCoordinate(coordinate)
        self.line = vtkActor2D()
        self.line.SetMapper(mapper)
        self.line.GetProperty().SetColor(0.85, 0.33, 0.1)
        self.line.GetProperty().SetLineWidth(2)
        self.line.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
        self.line.VisibilityOff()

    def move(self, place: float) -> None:
        """Move the line; it stays within the picture."""
        self.place = min(max(place, 0.0), 1.0)

    def update(self, camera: Camera, aspect: float) -> None:
        """Follow the camera."""
        self.line.SetVisibility(self.on)
        self.line.SetPosition(self.place, 0)
        origin, normal = wipe_normal(camera, self.place, aspect)
        for plane, side in ((self.now, 1), (self.before, -1)):
            plane.SetOrigin(*origin)
            plane.SetNormal(*(side * normal))
