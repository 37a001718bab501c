"""`LiveShading`: a method on a mesh, on the graphics card, following its light and options."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from meshdepict.color.encoding import encode
from meshdepict.drawing.shader import SURROUNDINGS, assemble, set_uniforms
from meshdepict.errors import MeshdepictError
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh
from meshdepict.viewer.live import encoding, octahedral
from meshdepict.viewer.live.locality import along_curve
from meshdepict.viewer.live.look import (
    LiveLook,
    changed_options,
    live_lights,
    live_methods,
    look_uniforms,
    switches,
)

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    from meshdepict.drawing.plotter import Plotter
    from meshdepict.scene.shape import Shape
    from meshdepict.shapes.data_set import PolyData

__all__ = ["LiveShading", "live_methods"]


class LiveShading(LiveLook):
    """A mesh whose shading the graphics card computes anew in every frame.

    It shows what ``bake(space, method, light=light, view=view, colormap=colormap, **options)``
    would: lights by name or angle refer to the view, and move with it. A new light or option sets
    uniforms. The vertices are passed over once, and again for another `curvature` or `scale`, and
    for another view where curvature is the view's. Some options, such as a first highlight or
    colour map, have the shader compiled again.

    Not live, and refused: methods that `live_methods` doesn't name, more than 64 lights
    (environments that are sampled into more), materials other than Lambert's and Phong's,
    principal_strength, transmitted light, illumination other than "lights", quadrature by
    directions, and more than 44 scales (29 of Light Alignment). Two-dimensional colour maps and the
    object's own colours are not part of it.

    It agrees with a bake to two grey levels where options are in the ranges that sliders offer.
    Where a method has an edge, such as lights that set under Light Warping, rounding may take a
    vertex to its other side: at most one pixel in a thousand. More are off far beyond those ranges:
    an exaggeration of 1000 shows how normals are rounded.

    Parameters
    ----------
    space : ScaleSpace
        Of a mesh.
    method : str or function
    options : mapping, optional
        The method's own.
    light : light, or several
        As in `bake`.
    view : View or str
    colormap : str, optional
        Name of a 1D colour map; grey unless given.

    Attributes
    ----------
    actor : vtkActor
        For ``plotter.add_actor``. Positions are recentred, (points − centre) / diagonal, as those
        of `drawing.picture.plot`. Its vertices are in the mesh's order, its triangles in another.

    Raises
    ------
    MeshdepictError
        For what can't be live, and wrong options; nothing changes then.
    """

    actor: vtkActor

    def _made(self, space: ScaleSpace) -> vtkActor:
        shape = space.shape if isinstance(space, ScaleSpace) else None
        known = isinstance(shape, (Mesh, HeightField))
        if not known or len(space.points) != len(space.own_surface.vertices):
            raise MeshdepictError(
                "live shading needs the scale space of a mesh's vertices; bake other shapes instead"
            )
        actor, self._mapper, self._poly = _actor(shape, space.own_surface)
        return actor

    def set_colormap(self, colormap: str | None) -> None:
        """Colour by another 1D map; None is grey."""
        self._show(colormap=colormap)

    def _enter(self, window: Plotter) -> None:
        window.add_actor(self.actor)

    def _show(self, **changes: Any) -> None:
        """Check changes to light, options, view and colour map together, then make them."""
        method, space = self._method, self._space
        view: View = changes.get("view", self._view)
        light = changes.get("light", self._light)
        colormap = changes.get("colormap", self._colormap)
        options = changed_options(method, self._options, changes.get("options", {}))
        lights = live_lights(method, light, view, options)
        if colormap is not None:  # which refuses unknown ones, and coloured light
            colored = any(np.ptp(lamp.color) > 0 for lamp in lights)
            encode(np.zeros((1, 3) if colored else 1), linear=False, colormap=colormap)
        uniforms = {
            **look_uniforms(method, space, lights, view, options),
            **encoding.table_uniforms(colormap),
        }
        key = *method.key(view, options), method.reads(space, options)
        if key != self._key:
            self._sets = self._upload(*method.attributes(space, view, options))
        defines = switches(method, self._sets, options)
        defines |= {} if colormap is None else {"MAPPED": 1}
        set_uniforms(self.actor.GetShaderProperty().GetVertexCustomUniforms(), uniforms)
        if defines != self._defines:
            assemble(self.actor, self._parts(), defines)
        self._view, self._light, self._colormap = view, light, colormap
        self._options, self._key, self._defines = options, key, defines

    def _parts(self) -> dict[str, str]:
        scalars = "in vec2 curvature;\n" if "curvature" in self._poly.point_data else ""
        return {
            "attributes": scalars + octahedral.unpacking(self._sets, bits=self._method.bits),
            "surroundings": SURROUNDINGS,
            "method": self._method.glsl,
            "encoding": encoding.GLSL,
        }

    def _upload(self, sets: int, attributes: Mapping[str, Any]) -> int:
        """Hand arrays over the vertices to the card; return the number of sets of normals."""
        if sets > (most := octahedral.most_sets(self._method.bits)):
            raise MeshdepictError(
                f"{self.method} can be live with at most {most - 1} scales, not {sets - 1}; bake "
                "it instead"
            )
        for name, values in attributes.items():
            self._poly.point_data[name] = values
            self._mapper.MapDataArrayToVertexAttribute(name, name, 0, -1)
        self._poly.point_data.active_scalars_name = None
        self._poly.Modified()
        return sets


def _actor(shape: Shape, mesh: Mesh) -> tuple[vtkActor, vtkPolyDataMapper, PolyData]:
    """Return an actor of the recentred mesh, without lighting, and its data."""
    import pyvista as pv
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (what draws)
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    poly = pv.PolyData()
    poly.points = shape.recentred(mesh.vertices).astype(np.float32)
    if mesh.polygons is None:
        faces = along_curve(poly.points, mesh.faces)
        poly.SetPolys(pv.CellArray.from_regular_cells(faces, deep=True))
    else:  # which VTK divides as it does those of a bake
        connectivity, offsets = mesh.polygons
        poly.SetPolys(pv.CellArray.from_arrays(offsets, connectivity, deep=True))
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(poly)
    mapper.ScalarVisibilityOff()
    mapper.SetVBOShiftScaleMethod(0)  # recentred already: attributes and uniforms rely on it
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    return actor, mapper, poly
