"""What a window shows, whatever its kind: shaded by the card or baked, beside how it was before."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import options_of
from meshdepict.shading.registry import find_method

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane

    from meshdepict.drawing.plotter import Plotter
    from meshdepict.viewer.session import Session

__all__ = ["BEFORE", "NO_CARD", "LitShape"]

NO_CARD = "no graphics card"
BEFORE = "before"


class LitShape:
    """What a session shows, in a plotter; kinds of shapes have their own, which `show`.

    Parameters
    ----------
    plotter : pyvista.Plotter
    session : Session
    live : bool
        Whether the card may shade.
    planes : {"now": vtkPlane, "before": vtkPlane}
        What cuts the two while they are compared.

    Attributes
    ----------
    why_baked : str
        Why the card does not shade; empty where it does.
    comparing : bool
        Whether the shape before is shown, too, each on the positive side of its plane.
    compared : str
        What that is then: one of `comparisons`.
    """

    def __init__(
        self, plotter: Plotter, session: Session, *, live: bool, planes: dict[str, vtkPlane]
    ) -> None:
        self._plotter, self._session, self._may_live = plotter, session, live
        self._planes = planes
        self.why_baked = "" if live else NO_CARD
        self.comparing = False
        self.compared = BEFORE

    @property
    def comparisons(self) -> tuple[str, ...]:
        """What can lie to the left of the line, by name."""
        return (BEFORE,)

    @property
    def has_stand_in(self) -> bool:
        """Whether there is a coarse one to show."""
        return False

    def prepare(self) -> None:
        """Make the coarse stand-in before it is needed."""

    def remake(self) -> None:
        """Draw the session's shape anew: it is another one."""

    def touch(self) -> None:
        """Say that what the session shows is no longer what is drawn."""

    def show(self, *, coarse: bool = False, fresh: bool = True) -> float:
        """Bring what is shown up to date, but don't draw it; return the seconds of shading.

        Parameters
        ----------
        coarse : bool
            Whether to show a stand-in, where there is one.
        fresh : bool
            Whether colours have to be today's; else those of before will do.

        Raises
        ------
        MeshdepictError
            Where the method can't shade this.
        """
        raise NotImplementedError

    def point_at(self, place: tuple[int, int]) -> NDArray[np.float64] | None:
        """Return the point (3,) of the scene that is seen at a place in pixels, if any."""
        raise NotImplementedError

    def compare(self, *, on: bool, what: str = BEFORE) -> None:
        """Show the shape before, or another of `comparisons`, too, or no longer."""
        self.comparing, self.compared = on, what

    def _options(self) -> dict[str, Any]:
        """Return all options of the method as they are now."""
        known = options_of(find_method(self._session.method))
        settled = self._session.settled().options
        return {name: option.default for name, option in known.items()} | dict(settled)
