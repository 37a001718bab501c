"""Words in a window."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkRenderer, vtkTextActor

__all__ = ["INK", "label"]

INK = (0.13, 0.13, 0.13)


def label(
    renderer: vtkRenderer,
    text: str,
    at: tuple[float, float],
    *,
    size: int = 13,
    bold: bool = False,
    color: tuple[float, float, float] = INK,
    align: str = "left",
) -> vtkTextActor:
    """Add a ``vtkTextActor`` to a renderer.

    Parameters
    ----------
    renderer : vtkRenderer
    text : str
    at : (float, float)
        In parts of the renderer's width and height.
    size : int
        Of the letters, in points.
    bold : bool
    color : (float, float, float)
    align : {"left", "center", "right"}
    """
    from vtkmodules.vtkRenderingCore import vtkTextActor

    actor = vtkTextActor()
    actor.SetInput(text)
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(*at)
    letters = actor.GetTextProperty()
    letters.SetFontSize(size)
    letters.SetBold(bold)
    letters.SetColor(*color)
    {
        "left": letters.SetJustificationToLeft,
        "center": letters.SetJustificationToCentered,
        "right": letters.SetJustificationToRight,
    }[align]()
    renderer.AddViewProp(actor)
    return actor
