"""How sure light is that was sampled by rays, and how many of them there had to be."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["FoundRays", "LightErrors"]


class FoundRays(NamedTuple):
    """How many rays were enough.

    Attributes
    ----------
    rays : int
        Of each sample.
    error : float
        Root mean square, in grey levels.
    ended : str
        Why there are no more, where the error is not yet small: "time", "memory" or "most"; else
        empty.
    """

    rays: int
    error: float
    ended: str = ""

    def __str__(self) -> str:
        """Return them in a few words."""
        said = {"time": " when time was up", "memory": " when memory was full"}
        return f"{self.rays}, {self.error:.2g} grey levels{said.get(self.ended, '')}"


class LightErrors(dict[int, float]):
    """By the number of rays, the rms error in grey levels of the last light that was sampled.

    Attributes
    ----------
    found : FoundRays or None
        What the last light took for which rays were to be as many as it takes.
    """

    found: FoundRays | None = None
