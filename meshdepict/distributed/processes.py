"""Processes of this machine, each with its share of the cores; one that ends is replaced."""

from __future__ import annotations

import signal
import sys
from contextlib import suppress
from multiprocessing import connection, get_context
from types import TracebackType
from typing import Any

from meshdepict.distributed.attempts import Outcome, Share, Work, attempt, gone

__all__ = ["Processes"]

_PATIENCE = 10  # seconds that a process has to put its files away


class Processes:
    """Processes that do the same work, used in a ``with`` statement.

    Parameters
    ----------
    work : callable
        Known by its name to a process that imports its module.
    count : int
    share : Share
        Of each of them.
    """

    def __init__(self, work: Work, count: int, share: Share) -> None:
        self.ahead = count
        self._work, self._share = work, share
        self._idle: list[_Process] = []
        self._busy: dict[Any, tuple[_Process, int]] = {}

    def __enter__(self) -> Processes:
        """Return itself; processes begin when there is something to do."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End all of them; what they were writing is put away."""
        running = [*self._idle, *(process for process, _ in self._busy.values())]
        for process in running:
            process.end()
        for process in running:
            process.wait()

    def give(self, number: int, item: Any) -> None:
        """Have a part done by an idle process, or a new one."""
        process = self._idle.pop() if self._idle else _Process(self._work, self._share)
        self._busy[process.pipe] = process, number
        with suppress(OSError):  # it has ended: `take` sees that
            process.pipe.send((number, item))

    def take(self) -> Outcome:
        """Wait for what becomes of any part."""
        pipe = connection.wait(list(self._busy))[0]
        process, number = self._busy.pop(pipe)
        try:
            found: Outcome = process.pipe.recv()
        except (EOFError, OSError):
            process.wait()
            return gone(number)
        self._idle.append(process)
        return found


class _Process:
    def __init__(self, work: Work, share: Share) -> None:
        # Not a fork: threads of this process would be missing in it, and their locks taken.
        context = get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, work, share), daemon=True)
        self._process.start()
        theirs.close()  # so that its end is the pipe's

    def end(self) -> None:
        self._process.terminate()

    def wait(self) -> None:
        self._process.join(_PATIENCE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._process.close()
        self.pipe.close()


def _serve(pipe: Any, work: Work, share: Share) -> None:
    """Do what comes by the pipe, until it closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is this process's parent's
    signal.signal(signal.SIGTERM, _leave)
    share.obey()
    with suppress(EOFError, OSError):  # the parent has gone
        while True:
            number, item = pipe.recv()
            pipe.send(attempt(work, number, item))


def _leave(*_: object) -> None:
    """Leave by an exception, so that a file that is being written is put away."""
    sys.exit(1)
