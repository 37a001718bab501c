"""``meshdepict methods``: what methods there are, and their options."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from meshdepict.commands import parameters

__all__ = ["methods"]


def methods(
    *names: Annotated[str, Parameter(name="NAME")],
    quiet: parameters.Quiet = False,
    cores: parameters.Cores = None,
) -> None:
    """List the shading methods, or one method's options with their ranges.

    Parameters
    ----------
    names
        Methods to describe.
    """
    from meshdepict.commands import report

    del quiet, cores  # accepted everywhere
    described = [report.method(name) for name in names]
    print("\n\n".join(described) if described else report.methods())  # noqa: T201
