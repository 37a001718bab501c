"""What VTK's readers and writers would print on stderr, as words to be raised."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["vtk_errors"]


@contextmanager
def vtk_errors() -> Iterator[list[str]]:
    """Collect what VTK would print on stderr."""
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    found: list[str] = []
    window, before = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkOutputWindow.SetInstance(window)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield found
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        vtkOutputWindow.SetInstance(before)
        for told in window.GetOutput().split("ERROR:")[1:]:
            line = [*told.splitlines(), ""][1]  # the first names VTK's source file
            found.append(re.sub(r"\s*\(0x\w+\)", "", line))
