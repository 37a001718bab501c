"""``meshdepict methods``: what methods there are, and their options."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from meshdepict.commands.parameters import Everywhere, takes_words
from meshdepict.console import say

__all__ = ["methods"]


@takes_words()
def methods(
    *names: Annotated[str, Parameter(name="NAME")],
    everywhere: Everywhere,
) -> None:
    """List the shading methods, or the options of some.

    Parameters
    ----------
    names
        Methods to describe.
    """
    from meshdepict.baking import method_list

    everywhere.obey()
    described = [repr(method_list.methods(name)) for name in names]
    say("\n\n".join(described) if described else repr(method_list.methods()))
