"""Wires from the window system to the window's handlers, and the loop that keeps it open."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from meshdepict.drawing.canvas import only_errors
from meshdepict.drawing.display import check_display
from meshdepict.errors import MeshdepictError

__all__ = ["bind", "only_errors", "run_loop"]

_FIRST = 10.0  # before sliders (0.5) and the camera's style (0)
_TIMER = 50  # milliseconds


def bind(window: Any) -> None:
    """Lead the events of a `Window`'s interactor to its handlers, before anybody else's."""
    interactor = window.plotter.iren.interactor
    # Else the camera's style draws a frame for every event, beside the window's.
    interactor.EnableRenderOff()

    def on(event: str, handler: Callable[[Any], bool]) -> None:
        def handle(caller: Any, _: str) -> None:
            if _guarded(window, lambda: handler(caller)):
                interactor.GetCommand(tag).SetAbortFlag(1)

        tag = interactor.AddObserver(event, handle, _FIRST)

    def key(caller: Any) -> bool:
        window.actions.press(caller.GetKeySym() or "")
        return True  # no keys of VTK's or PyVista's

    def left(caller: Any) -> bool:
        at = caller.GetEventPosition()
        what = "light" if caller.GetControlKey() else window.grip(at)
        if what is not None:
            window.take(what, at)
        return what is not None

    def right(caller: Any) -> bool:
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
    # While the camera moves its style gets all events, and nobody else any: at every tick it would
    # repeat the last move, and a key would do what VTK means by it.
    style.AddObserver("TimerEvent", lambda *_: None)
    style.AddObserver("CharEvent", lambda *_: None)
    style.AddObserver("InteractionEvent", lambda *_: _guarded(window, window.camera_moved))
    style.AddObserver("EndInteractionEvent", lambda *_: _guarded(window, window.soon))


def _guarded(window: Any, handler: Callable[[], Any]) -> Any:
    """Call a handler; VTK would print what it raises and go on."""
    try:
        return handler()
    except MeshdepictError as error:
        window.say(str(error))
    except BaseException as error:  # Ctrl-C, too: kept until the loop has ended
        window.fault = error
        window.close()
    return True


def run_loop(window: Any, frames: int | None) -> None:
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
def _interruptible(window: Any) -> Iterator[None]:
    """Let Ctrl-C end the loop; in a handler of VTK's it would end the program there and then."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    usual = signal.getsignal(signal.SIGINT)

    def interrupt(*_: Any) -> None:
        signal.signal(signal.SIGINT, usual)  # a second one doesn't wait
        window.fault = KeyboardInterrupt()
        window.close()

    signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
