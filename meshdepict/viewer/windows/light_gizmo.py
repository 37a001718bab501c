"""A small ball in a corner with an arrow for each light, seen from where the object is seen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meshdepict.scene.names import Lighting
from meshdepict.scene.vectors import Vector
from meshdepict.scene.view import View
from meshdepict.viewer.light_drag import lights_of

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkRenderingCore import vtkActor

__all__ = ["LightGizmo"]

_MOST = 8  # arrows; more would hide the ball
_SUN = (0.93, 0.6, 0.0)
_REACH = 2.0  # half the height of the corner, in radii of the ball


class LightGizmo:
    """A ball lit as the object is.

    Parameters
    ----------
    viewport : (float, float, float, float)
        Left, bottom, right and top of its corner, in parts of the window.

    Attributes
    ----------
    renderer : vtkRenderer
        For the window; it lies upon the others.
    """

    def __init__(self, viewport: tuple[float, float, float, float]) -> None:
        import pyvista as pv
        from vtkmodules.vtkRenderingCore import vtkRenderer

        self.renderer = vtkRenderer()
        self.renderer.SetViewport(viewport)
        self.renderer.InteractiveOff()
        self.renderer.PreserveColorBufferOn()
        self.renderer.AutomaticLightCreationOff()
        ball = pv.Sphere(radius=1.0, theta_resolution=48, phi_resolution=32)
        self._add(ball, (0.85, 0.85, 0.85))
        # From the sun at 1.9 radii down to the ball; turned with the light.
        arrow = pv.Arrow(
            start=(1.75, 0, 0), direction=(-1, 0, 0), scale=0.7, tip_length=0.5, tip_radius=0.2,
            shaft_radius=0.08,
        )  # fmt: skip
        sun = pv.Sphere(radius=0.24, center=(1.72, 0, 0))
        self._arrow = arrow + sun
        self._arrows: list[vtkActor] = []
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetParallelScale(_REACH)

    def update(self, lighting: Lighting, view: View) -> None:
        """Show these lights as a view sees them."""
        from vtkmodules.vtkRenderingCore import vtkLight

        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(*(10 * view.towards_eye))
        camera.SetFocalPoint(0, 0, 0)
        camera.SetViewUp(*view.frame[1])
        camera.SetClippingRange(5, 15)
        lights = lights_of(lighting)[:_MOST]
        while len(self._arrows) < len(lights):
            self._arrows.append(self._add(self._arrow, _SUN, glowing=True))
        self.renderer.RemoveAllLights()
        for arrow, light in zip(self._arrows, lights, strict=False):
            _point(arrow, light.direction)
            lamp = vtkLight()
            lamp.SetPosition(*light.direction)
            lamp.SetFocalPoint(0, 0, 0)
            lamp.SetColor(*np.clip(0.65 * light.color / max(1, len(lights) / 2), 0, 1))
            self.renderer.AddLight(lamp)
        for i, arrow in enumerate(self._arrows):
            arrow.SetVisibility(i < len(lights))

    def _add(
        self, poly: vtkPolyData, color: tuple[float, float, float], *, glowing: bool = False
    ) -> vtkActor:
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

        mapper = vtkPolyDataMapper()
        mapper.SetInputData(poly)
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*color)
        actor.GetProperty().SetAmbient(0.0 if glowing else 0.3)
        actor.GetProperty().SetLighting(not glowing)
        self.renderer.AddActor(actor)
        return actor


def _point(actor: vtkActor, towards: Vector) -> None:
    """Turn an actor so that its x axis goes towards a direction."""
    from vtkmodules.vtkCommonMath import vtkMatrix4x4

    helper = np.eye(3)[np.argmin(np.abs(towards))]
    y = np.cross(helper, towards)
    y /= np.linalg.norm(y)
    turn = np.eye(4)
    turn[:3, :3] = np.stack([towards, y, np.cross(towards, y)], axis=1)
    matrix = vtkMatrix4x4()
    matrix.DeepCopy(turn.ravel().tolist())
    actor.SetUserMatrix(matrix)
