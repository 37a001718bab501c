"""What libraries written in C print on stderr: caught, so that a sentence can say it instead."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress

__all__ = ["library_noise"]

_LONGEST = 200  # letters of a line
_MOST = 1 << 16  # bytes looked at


@contextmanager
def library_noise(lines: list[str]) -> Iterator[None]:
    """Catch what is printed on the process's stderr, and add its lines, each once.

    Python's own ``sys.stderr`` writes to the same place: print nothing meanwhile.

    Parameters
    ----------
    lines : list of str
        Gets them, without what a terminal would obey.
    """
    with tempfile.TemporaryFile() as caught:
        try:
            usual = os.dup(2)
        except OSError:  # there is no stderr
            yield
            return
        os.dup2(caught.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(usual, 2)
            os.close(usual)
            with suppress(OSError):
                caught.seek(0)
                text = caught.read(_MOST).decode("utf-8", "replace")
                found = ("".join(filter(str.isprintable, line)) for line in text.splitlines())
                lines += dict.fromkeys(line.strip()[:_LONGEST] for line in found if line.strip())
