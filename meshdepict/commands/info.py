"""``meshdepict info``: what is in a mesh file, and what a bake of it costs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from meshdepict.commands.parameters import Everywhere, takes_words
from meshdepict.console import FAULT, about, complain, notes, say
from meshdepict.errors import MeshdepictError

__all__ = ["info"]


@takes_words()
def info(
    *inputs: Annotated[Path, Parameter(name="INPUT")],
    everywhere: Everywhere,
) -> int:
    """Say what is in a file, and what a bake of it costs.

    Parameters
    ----------
    inputs
        Mesh files, or CT.
    """
    from meshdepict.commands import report

    everywhere.obey()
    if not inputs:
        raise MeshdepictError("info needs a mesh file: meshdepict info INPUT")
    failed = 0
    for path in inputs:
        try:
            with notes(path, quiet=everywhere.quiet):
                text = report.info(path)
        except MeshdepictError as error:
            complain(about(path, error))
            failed += 1
        else:
            say(text if path is inputs[-1] else f"{text}\n")
    return FAULT if failed else 0
