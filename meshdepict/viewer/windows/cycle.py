"""Going round: the next method, colour map, view or choice of a list, and the ones before."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from meshdepict.color.colormaps import BUILT_IN
from meshdepict.errors import MeshdepictError
from meshdepict.viewer.session import Session

__all__ = ["colormaps", "next_method", "other"]

Item = TypeVar("Item")


def other(items: Sequence[Item], current: Item, step: int) -> Item:
    """Return the item some steps from the current one, round and round; the first if it is none."""
    if current not in items:
        return items[0]
    return items[(items.index(current) + step) % len(items)]


def colormaps(session: Session) -> list[str | None]:
    """Return the colour maps to go round: grey, this package's own, and the one in use."""
    maps = [None, *(name for name in BUILT_IN if name != "gray")]
    return maps if session.colormap in maps else [*maps, session.colormap]


def next_method(session: Session, step: int) -> list[str]:
    """Shade by the next method that can shade this; return why others were passed over."""
    from meshdepict.shading.registry import METHODS

    names, former = list(METHODS), session.method
    refusals = []
    for k in range(1, len(names) + 1):
        session.use(other(names, former, k * step))
        try:
            session.baked()
        except MeshdepictError as error:
            refusals.append(f"{session.method}: {error}")
        else:
            break
    return refusals
