"""The window's panel of options: sliders to drag, and lists that digits go round."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from meshdepict.viewer.controls import Control, slid
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.cycle import other
from meshdepict.viewer.windows.labels import INK, label

if TYPE_CHECKING:
    from vtkmodules.vtkInteractionWidgets import vtkSliderRepresentation2D, vtkSliderWidget
    from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindowInteractor, vtkTextActor

__all__ = ["SLIDERS", "OptionPanel", "readable"]

SLIDERS = 6
"""Sliders on a page."""

_TOP, _STEP = 0.855, 0.068  # of the first slider's words, and from one to the next
_LINE = 0.032  # from one list to the next
_LEFT, _RIGHT = 0.08, 0.92
_FAINT = (0.45, 0.45, 0.45)
_BLUE = (0.16, 0.36, 0.6)


def readable(control: Control, value: float) -> float:
    """Return a slider's value without digits that no hand can set: whole, or 1/500 of the range."""
    value = min(max(value, control.low), control.high)
    if control.step:
        return round(value)
    digits = max(0, -math.floor(math.log10((control.high - control.low) / 500)))
    return min(max(round(value, digits), control.low), control.high)


class Slider(NamedTuple):
    """A control on the screen: VTK's slider, how it looks, and the number beside it."""

    control: Control
    widget: vtkSliderWidget
    shape: vtkSliderRepresentation2D
    number: vtkTextActor


class OptionPanel:
    """Controls of the session's method.

    Parameters
    ----------
    renderer : vtkRenderer
        At the side of the window, for words.
    sheet : vtkRenderer
        Over the whole window, for sliders.
    interactor : vtkRenderWindowInteractor
    session : Session
    changed : callable (name, value)
        Told what the person chose.
    """

    def __init__(
        self,
        renderer: vtkRenderer,
        sheet: vtkRenderer,
        interactor: vtkRenderWindowInteractor,
        session: Session,
        changed: Callable[[str, Any], None],
    ) -> None:
        self._renderer, self._sheet, self._interactor = renderer, sheet, interactor
        self._session, self._changed = session, changed
        self._page = 0
        self._method = ""
        self._sliders: list[Slider] = []
        self._lists: list[tuple[Control, vtkTextActor]] = []
        self._words: list[vtkTextActor] = []

    @property
    def names(self) -> list[str]:
        """Of the options on this page: sliders, then lists."""
        sliders = [slider.control.name for slider in self._sliders]
        return [*sliders, *(control.name for control, _ in self._lists)]

    def turn_page(self) -> None:
        """Show the next sliders."""
        self._page += 1
        self._build()

    def choose(self, number: int) -> str | None:
        """Go on to the next choice of list 1, 2, …; return its name, None without such a list."""
        if not 1 <= number <= len(self._lists):
            return None
        control = self._lists[number - 1][0]
        self._changed(control.name, other(control.choices, self._value(control), 1))
        return control.name

    def slide(self, name: str, value: float) -> None:
        """Take a value from a slider, as when it is dragged.

        Raises
        ------
        KeyError
            For an option that has no slider on this page.
        """
        control = {control.name: control for control, *_ in self._sliders}[name]
        self._changed(name, readable(control, value))

    def update(self) -> None:
        """Show what the session has."""
        if self._session.method != self._method:
            self._method, self._page = self._session.method, 0
            self._build()
        for control, _, shape, number in self._sliders:
            value = self._value(control)
            number.SetInput(_said(control, value))
            shape.SetValue(min(max(slid(control, value), control.low), control.high))
        for i, (control, line) in enumerate(self._lists):
            line.SetInput(f"{i + 1}   {control.label}: {self._value(control)}")

    def show(self, *, shown: bool) -> None:
        """Show or hide all sliders."""
        for _, widget, *_ in self._sliders:
            widget.SetEnabled(shown)

    def close(self) -> None:
        """Let go of the sliders."""
        for slider in self._sliders:
            slider.widget.Off()
            slider.widget.SetInteractor(None)  # type: ignore[arg-type] # VTK takes it
        for actor in (*self._words, *(line for _, line in self._lists)):
            self._renderer.RemoveViewProp(actor)
        self._sliders, self._lists, self._words = [], [], []

    def _value(self, control: Control) -> Any:
        return self._session.value(control)

    def _build(self) -> None:
        self.close()
        known = self._session.controls
        sliders = [control for control in known if control.kind == "slider"]
        pages = max(1, math.ceil(len(sliders) / SLIDERS))
        self._page %= pages
        height = _TOP
        for control in sliders[self._page * SLIDERS :][:SLIDERS]:
            self._words.append(label(self._renderer, control.label, (_LEFT, height)))
            number = label(self._renderer, "", (_RIGHT, height), align="right", color=_BLUE)
            self._words.append(number)
            self._sliders.append(self._slider(control, height - 0.019, number))
            height -= _STEP
        if pages > 1:
            more = f"Tab: more options ({self._page + 1} of {pages})"
            self._words.append(label(self._renderer, more, (_LEFT, height), size=11, color=_FAINT))
            height -= _LINE
        for control in (control for control in known if control.kind == "list"):
            self._lists.append((control, label(self._renderer, "", (_LEFT, height))))
            height -= _LINE
        others = [control.label for control in known if control.kind == "text"]
        if others:
            words = "by --set: " + ", ".join(others)
            self._words.append(label(self._renderer, words, (_LEFT, height), size=11, color=_FAINT))

    def _slider(self, control: Control, height: float, number: vtkTextActor) -> Slider:
        from vtkmodules.vtkCommonCore import vtkCommand
        from vtkmodules.vtkInteractionWidgets import vtkSliderRepresentation2D, vtkSliderWidget

        shape = vtkSliderRepresentation2D()
        shape.SetMinimumValue(control.low)
        shape.SetMaximumValue(control.high)
        left, bottom, right, top = self._renderer.GetViewport()
        for point, share in (
            (shape.GetPoint1Coordinate(), _LEFT),
            (shape.GetPoint2Coordinate(), _RIGHT),
        ):
            point.SetCoordinateSystemToNormalizedDisplay()
            point.SetValue(left + share * (right - left), bottom + height * (top - bottom))
        shape.ShowSliderLabelOff()
        shape.SetTitleText("")
        shape.SetTubeWidth(0.004)
        shape.SetSliderLength(0.009)
        shape.SetSliderWidth(0.022)
        shape.SetEndCapLength(0.0)
        shape.GetTubeProperty().SetColor(0.72, 0.72, 0.72)
        shape.GetSliderProperty().SetColor(*_BLUE)
        shape.GetSelectedProperty().SetColor(*INK)
        widget = vtkSliderWidget()
        widget.SetInteractor(self._interactor)
        widget.SetCurrentRenderer(self._sheet)
        widget.SetRepresentation(shape)
        widget.SetAnimationModeToJump()
        widget.KeyPressActivationOff()  # else the key i would hide it
        widget.AddObserver(
            vtkCommand.InteractionEvent, lambda *_: self.slide(control.name, shape.GetValue())
        )
        widget.On()
        return Slider(control, widget, shape, number)


def _said(control: Control, value: Any) -> str:
    """Return what stands beside a slider."""
    if value is None or isinstance(value, str):
        return value or "auto"
    return "several" if isinstance(value, tuple) else f"{value:.5g}{control.unit}"
