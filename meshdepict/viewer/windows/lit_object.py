"""The object in the window: whole or coarse, shaded by the card or painted, and how it was before.

Actors over one session: the one that the card shades (`LiveShading`), the whole mesh painted with
baked colours where that can't be, a coarse stand-in while a big mesh moves, the object before, for
comparison, and the mesh in textures: its file's, and one that was baked.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.textured import add_appearance
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.looks_before import colors_before, own_look
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.lit_shape import BEFORE, LitShape
from meshdepict.viewer.windows.preview import Proxy

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane
    from vtkmodules.vtkRenderingCore import vtkActor

    from meshdepict.drawing.plotter import Plotter
    from meshdepict.shapes.appearance import Appearance
    from meshdepict.viewer.live.live_shading import LiveShading

__all__ = ["LitObject", "PaintedMesh"]

AT_VERTICES = "at the vertices"

Chosen = slice | NDArray[np.intp]  # vertices: all, or those of the stand-in


class PaintedMesh:
    """Triangles in vertex colours as they are.

    Parameters
    ----------
    points : (n, 3) array
        About the origin, in diagonals of the shape.
    faces : (m, 3) array of int

    Attributes
    ----------
    actor : vtkActor
    """

    def __init__(self, points: NDArray[Any], faces: NDArray[Any]) -> None:
        import pyvista as pv
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

        small = np.int32 if len(points) < 2**31 else np.int64
        single: NDArray[Any] = points.astype(np.float32)
        corners: NDArray[Any] = faces.astype(small)
        self._poly = pv.PolyData.from_regular_faces(single, corners)
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(self._poly)
        mapper.SetScalarModeToUsePointData()
        mapper.SetColorModeToDirectScalars()
        self.actor = vtkActor()
        self.actor.SetMapper(mapper)
        self.actor.GetProperty().LightingOff()

    def paint(self, colors: NDArray[np.uint8]) -> None:
        """Take other colours (n, 3)."""
        self._poly.point_data.set_array(np.ascontiguousarray(colors), "RGB")
        self._poly.point_data.active_scalars_name = "RGB"
        self._poly.Modified()


class LitObject(LitShape):
    """A mesh that a session shows, in a plotter; parameters as of `LitShape`."""

    def __init__(
        self, plotter: Plotter, session: Session, *, live: bool, planes: dict[str, vtkPlane]
    ) -> None:
        super().__init__(plotter, session, live=live, planes=planes)
        self._renderer = plotter.renderer
        self._live: LiveShading | None = None
        self._tried: Callable[..., Any] | None = None  # what `_live` was made, or refused, for
        self._proxy: Proxy | None = None
        self._meshes: dict[tuple[str, str], PaintedMesh] = {}
        self._stale: set[tuple[str, str]] = set()
        self._laid: dict[str, list[vtkActor]] = {}  # in textures: "now", "before"
        self._own: Appearance | None = None
        self._asked_own = False

    @property
    def comparisons(self) -> tuple[str, ...]:
        """What can lie left of the line: the mesh before, beside a texture the vertices first."""
        return (AT_VERTICES, BEFORE) if self.is_textured else (BEFORE,)

    @property
    def is_textured(self) -> bool:
        """Whether a baked texture is shown."""
        return "now" in self._laid

    def wear(self, texture: Appearance | None) -> None:
        """Show the mesh in a texture from now on, until what is shown changes; None for none."""
        self._take_off("now")
        if texture is not None:
            self._lay("now", texture)

    @property
    def has_stand_in(self) -> bool:
        """Whether the mesh is so big that there is a coarse one to show."""
        return Proxy.worth(self._session.surface)

    def prepare(self) -> None:
        """Make the coarse stand-in before it is needed."""
        if self.has_stand_in and self._proxy is None:
            self._proxy = Proxy(self._session.surface)

    def remake(self) -> None:
        """Draw the session's shape anew: it is another one."""
        self._drop_live()
        for mesh in self._meshes.values():
            self._renderer.RemoveActor(mesh.actor)
        self._take_off("before")
        self._meshes, self._proxy, self._asked_own = {}, None, False
        self.touch()

    def touch(self) -> None:
        """Say that what the session shows is no longer what is drawn."""
        whens = ("now", BEFORE, AT_VERTICES)
        self._stale |= {(size, when) for size in ("whole", "coarse") for when in whens}
        self._take_off("now")

    def show(self, *, coarse: bool = False, fresh: bool = True) -> float:
        """Bring what is shown up to date; see `LitShape.show`."""
        size = "coarse" if coarse and self.has_stand_in else "whole"
        began = time.perf_counter()
        if size == "whole" and self.is_textured:
            shown = [*self._laid["now"]]
        else:
            live = self._shade_live(fresh=fresh) if size == "whole" else None
            shown = [live.actor if live else self._painted(size, "now", fresh=fresh).actor]
        if self.comparing:
            shown += self._compared(size, fresh=fresh)
        took = time.perf_counter() - began
        for actor in self._actors():
            actor.SetVisibility(actor in shown)
        return took

    def point_at(self, place: tuple[int, int]) -> NDArray[np.float64] | None:
        """Return the point (3,) of the scene that is seen at a place in pixels, if any."""
        from vtkmodules.vtkRenderingCore import vtkCellPicker

        picker = vtkCellPicker()
        picker.SetTolerance(0)
        picker.PickFromListOn()
        for actor in self._actors():
            if actor.GetVisibility():
                picker.AddPickList(actor)
        found = picker.Pick(*place, 0, self._renderer)
        return np.array(picker.GetPickPosition()) if found else None

    def compare(self, *, on: bool, what: str = BEFORE) -> None:
        """Show the mesh before, too: in its own texture or colours, or Lambert's."""
        super().compare(on=on, what=what)
        for (_, when), mesh in self._meshes.items():
            self._clip(mesh.actor, when)
        for when, actors in self._laid.items():
            for actor in actors:
                self._clip(actor, when)
        if self._live is not None:
            self._clip(self._live.actor, "now")

    def _clip(self, actor: vtkActor, when: str) -> None:
        mapper = actor.GetMapper()
        mapper.RemoveAllClippingPlanes()
        if self.comparing:
            mapper.AddClippingPlane(self._planes["now" if when == "now" else "before"])

    def _compared(self, size: str, *, fresh: bool) -> list[vtkActor]:
        """Return what lies to the left of the line, up to date."""
        what = self.compared if self.compared in self.comparisons else BEFORE
        if what == BEFORE and size == "whole":
            if not self._asked_own:
                self._own, self._asked_own = own_look(self._session), True
            if self._own is not None and self._own.textures is not None:
                if BEFORE not in self._laid:
                    self._lay(BEFORE, self._own)
                return self._laid[BEFORE]
        return [self._painted(size, what, fresh=fresh).actor]

    def _lay(self, when: str, appearance: Appearance) -> None:
        """Have actors of a mesh in its textures."""
        self._laid[when] = add_appearance(
            self._plotter, appearance, reset_camera=False, render=False
        )
        for actor in self._laid[when]:
            self._clip(actor, when)

    def _take_off(self, when: str) -> None:
        for actor in self._laid.pop(when, []):
            self._renderer.RemoveActor(actor)

    def _actors(self) -> list[vtkActor]:
        actors = [mesh.actor for mesh in self._meshes.values()]
        actors += [actor for laid in self._laid.values() for actor in laid]
        return actors if self._live is None else [*actors, self._live.actor]

    def _painted(self, size: str, when: str, *, fresh: bool) -> PaintedMesh:
        session, key = self._session, (size, when)
        new = key not in self._meshes
        chosen: Chosen = slice(None)
        if size == "coarse":
            self.prepare()
            assert self._proxy is not None
            chosen = self._proxy.chosen
        if new:
            shape = session.surface
            faces = shape.faces if self._proxy is None or size == "whole" else self._proxy.faces
            self._meshes[key] = PaintedMesh(session.shape.recentred(shape.vertices[chosen]), faces)
            self._renderer.AddActor(self._meshes[key].actor)
            self._clip(self._meshes[key].actor, when)
        if new or (fresh and key in self._stale):
            self._meshes[key].paint(self._colors(size, when, chosen))
            self._stale.discard(key)
        return self._meshes[key]

    def _colors(self, size: str, when: str, chosen: Chosen) -> NDArray[np.uint8]:
        session = self._session
        if size == "whole":
            return colors_before(session) if when == BEFORE else session.colors
        assert self._proxy is not None
        thinned = self._proxy.space(session.space)
        if when == BEFORE:
            found = colors_before(session, thinned)
            return found if len(found) == len(thinned.points) else found[chosen]
        try:
            return session.colors_at(thinned)
        except MeshdepictError:  # a method that needs every neighbour
            return session.colors[chosen]

    def _shade_live(self, *, fresh: bool) -> LiveShading | None:
        """Return the `LiveShading` of what the session shows, None where that can't be."""
        if not self._may_live or self._session.two_sided:  # the shader knows one side
            return None
        if self._live is not None and not fresh:
            return self._live
        from meshdepict.viewer.live.live_shading import LiveShading

        session, options = self._session, self._options()
        try:
            space = session.space  # with what is read by now, and its progress
            if self._live is None or self._tried is not session.function:
                self._drop_live()
                self._tried = session.function
                self._live = LiveShading(
                    space, session.function, options=options, light=session.light,
                    view=session.view, colormap=session.colormap,
                )  # fmt: skip
                self._live.check()
                self._renderer.AddActor(self._live.actor)
                self._clip(self._live.actor, "now")
            elif ("whole", "now") in self._stale:
                self._live.set_view(session.view)
                self._live.set_light(session.light)
                self._live.set_options(**options)
                self._live.set_colormap(session.colormap)
        except MeshdepictError as error:
            self._drop_live()
            self.why_baked = str(error)
            return None
        self.why_baked = ""
        self._stale.discard(("whole", "now"))
        return self._live

    def _drop_live(self) -> None:
        if self._live is not None:
            self._renderer.RemoveActor(self._live.actor)
        self._live = None
