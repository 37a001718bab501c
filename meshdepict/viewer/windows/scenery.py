"""What stands round the object in the window: panel, light, axes, scale bar, line, help, words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from meshdepict.drawing.display import check_opengl, has_graphics_card
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.keys import WELCOME, Key, help_text
from meshdepict.viewer.windows.labels import label
from meshdepict.viewer.windows.light_gizmo import LightGizmo
from meshdepict.viewer.windows.lit_shape import NO_CARD
from meshdepict.viewer.windows.option_panel import OptionPanel
from meshdepict.viewer.windows.ruler import Ruler
from meshdepict.viewer.windows.status import color_line, light_line, view_line
from meshdepict.viewer.windows.wipe import Wipe

if TYPE_CHECKING:
    from meshdepict.drawing.plotter import Plotter

__all__ = ["Scenery"]

_PANEL = 0.22  # share of the window's width

_GROUND = (0.955, 0.955, 0.945)
_FAINT = (0.45, 0.45, 0.45)
_SAMPLES = 4  # of a pixel


class Scenery:
    """A plotter with everything but the object.

    Parameters
    ----------
    session : Session
    changed : callable (name, value)
        Told what options the person chose.
    name : str
        Of what is shown, for the title.
    keys : sequence of Key
        What the help says.
    size : (int, int)
        In pixels.
    off_screen : bool

    Attributes
    ----------
    plotter : pyvista.Plotter
    panel : OptionPanel
    wipe : Wipe
    helping, bare : bool
        Whether help is shown, and whether the object stands alone.
    """

    def __init__(
        self,
        session: Session,
        changed: Callable[[str, Any], None],
        *,
        name: str,
        keys: Sequence[Key],
        size: tuple[int, int],
        off_screen: bool,
    ) -> None:
        import pyvista as pv
        from vtkmodules.vtkRenderingCore import vtkRenderer

        self._session = session
        self.helping = self.bare = False
        title = f"{name} - meshdepict"
        self.plotter: Plotter = pv.Plotter(
            window_size=list(size), off_screen=off_screen, notebook=False, title=title
        )
        check_opengl(self.plotter)
        self.plotter.render_window.SetWindowName(title)
        self.plotter.set_background("white")
        self.plotter.iren.initialize()  # sliders need it
        main = self.plotter.renderer
        main.SetViewport(0, 0, 1 - _PANEL, 1)
        window = self.plotter.render_window
        self._side = vtkRenderer()
        self._side.SetViewport(1 - _PANEL, 0, 1, 1)
        self._side.SetBackground(*_GROUND)
        self._side.SetLayer(0)
        self._side.InteractiveOff()
        window.AddRenderer(self._side)
        self.gizmo = LightGizmo((1 - _PANEL + 0.02, 0.015, 1 - 0.02, 0.2))
        window.SetNumberOfLayers(max(2, window.GetNumberOfLayers()))
        self.gizmo.renderer.SetLayer(window.GetNumberOfLayers() - 1)
        window.AddRenderer(self.gizmo.renderer)
        # VTK places sliders rightly only in a renderer that has the whole window.
        self._sheet = vtkRenderer()
        self._sheet.SetLayer(self.gizmo.renderer.GetLayer())
        self._sheet.InteractiveOff()
        window.AddRenderer(self._sheet)
        self.panel = OptionPanel(
            self._side, self._sheet, self.plotter.iren.interactor, session, changed
        )
        self.wipe = Wipe()
        main.AddViewProp(self.wipe.line)
        self._ruler = Ruler(main, getattr(session.shape, "length_unit", ""))
        self.plotter.add_axes(
            viewport=(0, 0, 0.13, 0.17), line_width=2, color="black", interactive=False
        )
        self._title = label(self._side, "", (0.08, 0.945), size=18, bold=True)
        self._source = label(self._side, "", (0.08, 0.915), size=10, color=_FAINT)
        self._lines = label(self._side, "", (0.08, 0.205), size=11, color=_FAINT)
        self._message = label(main, "", (0.015, 0.965), size=14)
        self._welcome = label(main, WELCOME, (0.985, 0.02), size=12, color=_FAINT, align="right")
        columns = (text.splitlines() for text in help_text(keys))
        rows = [f" {keys:<26}{words:<44}" for keys, words in zip(*columns, strict=True)]
        self._help = label(main, "\n".join(rows), (0.5, 0.5), size=13, align="center")
        letters = self._help.GetTextProperty()
        letters.SetFontFamilyToCourier()
        letters.SetVerticalJustificationToCentered()
        letters.SetLineSpacing(1.15)
        letters.SetBackgroundColor(1, 1, 1)
        letters.SetBackgroundOpacity(0.92)
        main.AddObserver("StartEvent", lambda *_: self._follow_camera())

    @property
    def picture_size(self) -> tuple[int, int]:
        """Width and height in pixels of the part that shows the object."""
        width, height = self.plotter.render_window.GetSize()
        return (width if self.bare else round(width * (1 - _PANEL))), height

    @cached_property
    def has_graphics_card(self) -> bool:
        """Whether OpenGL is more than software."""
        return has_graphics_card(self.plotter.render_window)

    def smooth_edges(self, *, on: bool) -> None:
        """Smooth the edges of triangles; in software only at rest, as it takes most of the time."""
        samples = _SAMPLES if on or self.has_graphics_card else 0
        if self.plotter.render_window.GetMultiSamples() != samples:
            self.plotter.render_window.SetMultiSamples(samples)

    def update(self, message: str, why_baked: str) -> None:
        """Show what the session has now, and a message."""
        session = self._session
        self._title.SetInput(session.method.replace("_", " "))
        self._source.SetInput(_wrapped(session.declared.source))
        where = "processor" if why_baked else "graphics card"
        reason = f": {why_baked}" if why_baked not in ("", NO_CARD) else ""
        shading = f"shaded by the {where}{reason}"
        lines = [
            color_line(session),
            view_line(session),
            light_line(session),
            shading,
        ]
        self._lines.SetInput("\n".join(map(_wrapped, lines)))
        self._message.SetInput(message)
        self.panel.update()
        self.plotter.renderer.SetViewport(0, 0, 1 if self.bare else 1 - _PANEL, 1)
        for renderer in (self._side, self.gizmo.renderer):
            renderer.SetDraw(not self.bare)
        self.panel.show(shown=not self.bare)
        for words in (self._message, self._welcome):
            words.SetVisibility(not self.bare)
        self._help.SetVisibility(self.helping)

    def _follow_camera(self) -> None:
        """Bring what depends on the camera up to date; VTK calls it at the start of a frame."""
        from meshdepict.viewer.windows.camera import camera_view

        camera, (width, height) = self.plotter.camera, self.picture_size
        shape = self._session.shape
        view = camera_view(camera, shape)
        self.gizmo.update(self._session.light, view)
        scale = view.parallel_scale
        self._ruler.update(None if scale is None else 2 * scale / height, width, hidden=self.bare)
        self.wipe.update(camera, width / height)


def _wrapped(text: str, width: int = 42) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(text, width)[:3])
