"""``meshdepict info``: what is in a mesh file, and what a bake of it costs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from meshdepict.baking.choice_list import AUTO, LADDER, choice_fields
from meshdepict.commands.parameters import Everywhere, LookWords, takes_words
from meshdepict.commands.values import method_options
from meshdepict.console import FAULT, about, complain, notes, say
from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from meshdepict.baking.look import Look

__all__ = ["info"]


_ABOUT = {*LADDER, "transfer", "accuracy", "budget"}  # of a look: what decides what is computed


@takes_words(without=[name for name in choice_fields() if name not in _ABOUT])
def info(
    *inputs: Annotated[Path, Parameter(name="INPUT")],
    explain: Annotated[
        str | None,
        Parameter(help="A method: say what baking by it computes, with seconds and memory."),
    ] = None,
    look: LookWords,
    everywhere: Everywhere,
) -> int:
    """Say what is in a file, and what a bake of it costs.

    Parameters
    ----------
    inputs
        Meshes, terrain or CT.
    """
    from meshdepict.commands import report

    everywhere.obey()
    if not inputs:
        raise MeshdepictError("info needs a mesh file: meshdepict info INPUT")
    chosen = None
    if explain is not None:
        chosen = _explained(explain, look)
    elif look.said or look.options:
        word = "set" if look.options else next(iter(look.said))
        raise MeshdepictError(
            f"--{word} is about a bake: say which method to explain, --explain exaggerated"
        )
    failed = 0
    for path in inputs:
        try:
            with notes(path, quiet=everywhere.quiet):
                text = report.info(path) if chosen is None else report.explained(path, chosen)
        except MeshdepictError as error:
            complain(about(path, error))
            failed += 1
        else:
            say(text if path is inputs[-1] else f"{text}\n")
    return FAULT if failed else 0


def _explained(method: str, words: LookWords) -> Look:
    """Return the look whose bake is to be explained; refuse one that `bake` refuses."""
    from meshdepict.baking.batch import check_look
    from meshdepict.baking.look import Look

    options = method_options(method, words.options or [])
    look = Look(**{"view": AUTO, "up": AUTO, **words.said, "method": method, **options})
    if look.transfer is None:
        check_look(look)
    return look
