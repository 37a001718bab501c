"""What a person reads on stderr beside the results: errors, notes and a progress bar."""

from __future__ import annotations

import re
import sys
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from meshdepict.errors import MeshdepictWarning, printable

__all__ = ["FAULT", "Heard", "about", "complain", "notes", "progress_bar", "say"]

FAULT = 2  # exit status of wrong input
_FIGURES = re.compile(r"\d[\d.,]*(?:e[+-]?\d+)?%?")
_PATIENCE = 0.5  # seconds without a sign of life


def say(text: str) -> None:
    """Print lines on stdout; names in them, which are other people's, steer no terminal."""
    print(printable(text, keep="\n"), flush=True)  # noqa: T201


def complain(message: object) -> None:
    """Print one line on stderr; where nobody is left to read it, nothing."""
    line = printable(" ".join(str(message).split()))
    if sys.stderr is not None:
        with suppress(OSError):  # a closed pipe
            print(f"meshdepict: {line}", file=sys.stderr, flush=True)  # noqa: T201


def about(path: Path | None, message: object) -> str:
    """Return a message that begins with the file that it is about."""
    text = str(message)
    named = path is None or text.startswith((f"{path} ", f"{path}:"))
    return text if named else f"{path}: {text}"


class Heard:
    """Notes of a batch: what one file's note said is only counted for the others.

    Figures may differ: "12 vertices" and "7 vertices" are one note.
    """

    def __init__(self) -> None:
        self._first: dict[str, str] = {}  # by what is said, figures left out
        self._files: dict[str, set[object]] = {}

    def fresh(self, path: Path | None, messages: Iterable[str]) -> list[str]:
        """Return the messages that no earlier file had."""
        new = []
        for message in messages:
            text = _after(path, message)
            said = _FIGURES.sub("#", text)
            self._files.setdefault(said, set()).add(path)
            if said not in self._first:
                self._first[said] = text
                new.append(message)
        return new

    def tell(self) -> None:
        """Say of how many files more each note was true."""
        for said, first in self._first.items():
            others = len(self._files[said]) - 1
            if others:
                many = "1 more file" if others == 1 else f"{others:,} more files"
                complain(f"note: of {many}, too: {first}")


@contextmanager
def notes(path: Path | None = None, *, quiet: bool, heard: Heard | None = None) -> Iterator[None]:
    """Print this package's warnings, those about one file as one line, and none of other packages.

    What is about a file waits for the end of the work on it; without a path each is shown at once.
    What was `heard` about another file of a batch is left to its end.
    """
    waiting: dict[str, None] = {}  # in order, each once

    def show(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
        if not issubclass(category, MeshdepictWarning) or quiet:
            return
        if path is None:
            complain(f"note: {message}")
        else:
            waiting[str(message)] = None

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.showwarning = show
            yield
    finally:
        said = list(waiting) if heard is None else heard.fresh(path, waiting)
        if said:
            first, *others = said
            complain("; ".join([f"note: {about(path, first)}", *(_after(path, o) for o in others)]))


def _after(path: Path | None, message: str) -> str:
    """Return a message without the file's name in front, where that has been said."""
    return message.removeprefix(f"{path}: ").removeprefix(f"{path} ")


@contextmanager
def progress_bar(label: str, *, quiet: bool) -> Iterator[Callable[[float, float], None] | None]:
    """Give a callable ``(done, total)`` that moves a bar, None where there is no terminal.

    The bar appears when the work has lasted for half a second, and is gone at its end.
    """
    if quiet or sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=Console(stderr=True), transient=True)
    task = bar.add_task(printable(label), total=None)
    timer = threading.Timer(_PATIENCE, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield lambda done, total: bar.update(task, completed=done, total=total)
    finally:
        timer.cancel()
        timer.join()
        if bar.live.is_started:
            bar.stop()
