"""The window's scale bar: as `scale_bar` chooses it, following the zoom."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from meshdepict.drawing.scale_bar import scale_bar
from meshdepict.viewer.windows.labels import label

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from vtkmodules.vtkRenderingCore import vtkRenderer

__all__ = ["Ruler"]

_THICK = 6  # pixels
_SHARE = 0.25  # of the picture's width, at most


class Ruler:
    """A bar of a round length at the bottom of a renderer, and its label.

    Parameters
    ----------
    renderer : vtkRenderer
    unit : str
        Of the coordinates, empty where unknown.
    """

    def __init__(self, renderer: vtkRenderer, unit: str = "") -> None:
        import pyvista as pv
        from vtkmodules.vtkRenderingCore import vtkActor2D, vtkPolyDataMapper2D

        self._unit = unit
        self._bar = pv.PolyData()
        mapper = vtkPolyDataMapper2D()
        mapper.SetInputData(self._bar)
        self._actor = vtkActor2D()
        self._actor.SetMapper(mapper)
        self._actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
        self._actor.SetPosition(0.5, 0.03)
        renderer.AddViewProp(self._actor)
        self._label = label(renderer, "", (0.5, 0.045), size=14, align="center")
        self._label.GetTextProperty().SetBackgroundColor(1, 1, 1)
        self._label.GetTextProperty().SetBackgroundOpacity(0.7)
        self._drawn: tuple[float, int] | None = None

    def update(self, units_per_pixel: float | None, width: int, *, hidden: bool = False) -> None:
        """Show the scale of a picture so many pixels wide; None is perspective, without one."""
        import numpy as np
        import pyvista as pv

        shown = units_per_pixel is not None and not hidden
        self._actor.SetVisibility(shown)
        self._label.SetVisibility(shown)
        if units_per_pixel is None or (units_per_pixel, width) == self._drawn:
            return
        self._drawn = units_per_pixel, width
        bar = scale_bar(width * units_per_pixel, self._unit, share=_SHARE)
        long = bar.length / units_per_pixel
        ends = np.round(np.linspace(-long / 2, long / 2, bar.parts + 1))
        points: list[tuple[float, float, float]] = []
        quads: list[list[int]] = []
        colors: list[tuple[int, int, int]] = []
        for i, (left, right) in enumerate(pairwise(ends)):
            for rim, color in ((0, (25, 25, 25)), (1, (250, 250, 250))):
                if rim and i % 2 == 0:
                    continue  # every other part is filled
                low, high = rim, _THICK - rim
                quads.append([len(points) + k for k in range(4)])
                points += [(left, low, 0), (right, low, 0), (right, high, 0), (left, high, 0)]
                colors.append(color)
        corners: NDArray[Any] = np.array(points, np.float32)
        fresh = pv.PolyData.from_regular_faces(corners, np.array(quads))
        fresh.cell_data.set_array(np.array(colors, np.uint8), "RGB")
        fresh.cell_data.active_scalars_name = "RGB"
        self._bar.copy_from(fresh)
        self._label.SetInput(bar.label)
