"""Wires from the window system to the window's handlers, and the loop that keeps it open."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from meshdepict.drawing.canvas import only_errors
from meshdepict.drawing.display import check_display
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.windows.keys import Pressed

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkRenderWindowInteractor

    from meshdepict.drawing.plotter import Plotter

__all__ = ["bind", "only_errors", "run_loop"]


class Handled(Protocol):
    """A window as its events see it; see `LitWindow`, whose handlers these are."""

    plotter: Plotter
    actions: Pressed
    fault: BaseException | None

    def grip(self, at: tuple[int, int]) -> str | None:
        """Return what a plain drag takes hold of."""

    def take(self, what: str, at: tuple[int, int]) -> None:
        """Begin a drag."""

    def drag(self, at: tuple[int, int]) -> bool:
        """Move what is held."""

    def let_go(self) -> bool:
        """End a drag."""

    def attend(self, at: tuple[int, int]) -> None:
        """Draw attention to a point."""

    def camera_moved(self) -> None:
        """Follow the camera."""

    def tick(self) -> None:
        """Do what is due."""

    def soon(self) -> None:
        """Have the whole picture drawn once the hand rests."""

    def settle(self) -> None:
        """Draw the whole picture."""

    def say(self, words: str) -> None:
        """Show a message."""

    def finish(self) -> None:
        """Clean up."""

    def close(self) -> None:
        """Close the window."""


_FIRST = 10.0  # before sliders (0.5) and the camera's style (0)
_TIMER = 50  # milliseconds


def bind(window: Handled) -> None:
    """Lead the events of a `Window`'s interactor to its handlers, before anybody else's."""
    from vtkmodules.vtkCommonCore import vtkCommand

    interactor = window.plotter.iren.interactor
    # Else the camera's style draws a frame for every event, beside the window's.
    interactor.EnableRenderOff()

    def on(event: str, handler: Callable[[vtkRenderWindowInteractor], object]) -> None:
        def handle(caller: vtkRenderWindowInteractor, _: str) -> None:
            if _guarded(window, lambda: handler(caller)):
                interactor.GetCommand(tag).SetAbortFlag(1)

        tag = interactor.AddObserver(vtkCommand.GetEventIdFromString(event), handle, _FIRST)

    def key(caller: vtkRenderWindowInteractor) -> bool:
        window.actions.press(caller.GetKeySym() or "")
        return True  # no keys of VTK's or PyVista's

    def left(caller: vtkRenderWindowInteractor) -> bool:
        at = caller.GetEventPosition()
        if caller.GetAltKey():
            window.attend(at)
            return True
        what = "light" if caller.GetControlKey() else window.grip(at)
        if what is not None:
            window.take(what, at)
        return what is not None

    def right(caller: vtkRenderWindowInteractor) -> bool:
        window.take("light", caller.GetEventPosition())
        return True

    on("KeyPressEvent", key)
    on("CharEvent", lambda _: True)
    on("LeftButtonPressEvent", left)
    on("RightButtonPressEvent", right)
    on("MouseMoveEvent", lambda caller: window.drag(caller.GetEventPosition()))
    for button in ("Left", "Right"):
        on(f"{button}ButtonReleaseEvent", lambda _: window.let_go())
    on("TimerEvent", lambda _: window.tick())
    on("ConfigureEvent", lambda _: window.soon())
    window.plotter.enable_trackball_style()
    style = window.plotter.iren.style

    def followed(*_: object) -> None:
        _guarded(window, window.camera_moved)

    def rested(*_: object) -> None:
        _guarded(window, window.soon)

    # While the camera moves its style gets all events, and nobody else any: at every tick it would
    # repeat the last move, and a key would do what VTK means by it.
    style.AddObserver(vtkCommand.TimerEvent, lambda *_: None)
    style.AddObserver(vtkCommand.CharEvent, lambda *_: None)
    style.AddObserver(vtkCommand.InteractionEvent, followed)
    style.AddObserver(vtkCommand.EndInteractionEvent, rested)


def _guarded(window: Handled, handler: Callable[[], object]) -> object:
    """Call a handler; VTK would print what it raises and go on."""
    try:
        return handler()
    except MeshdepictError as error:
        window.say(str(error))
    except BaseException as error:  # Ctrl-C, too: kept until the loop has ended
        window.fault = error
        window.close()
    return True


def run_loop(window: Handled, frames: int | None) -> None:
    """Keep a window open until it is closed, or off screen for some frames; then clean up."""
    plotter = window.plotter
    try:
        if frames is None:
            check_display(plotter)
            with _interruptible(window):
                plotter.iren.interactor.CreateRepeatingTimer(_TIMER)
                plotter.iren.start()
        for _ in range(frames or 0):
            window.settle()
    finally:
        window.finish()
        plotter.close()
    if window.fault is not None:
        raise window.fault


@contextmanager
def _interruptible(window: Handled) -> Iterator[None]:
    """Let Ctrl-C end the loop; in a handler of VTK's it would end the program there and then."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    usual = signal.getsignal(signal.SIGINT)

    def interrupt(*_: object) -> None:
        signal.signal(signal.SIGINT, usual)  # a second one doesn't wait
        window.fault = KeyboardInterrupt()
        window.close()

    signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
