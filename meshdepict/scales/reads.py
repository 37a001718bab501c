"""What is read of a scale space: which sets of normals, whose curvature, how many rays."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Reads"]

Scales = frozenset[int]
_NONE: Scales = frozenset()


@dataclass(frozen=True)
class Reads:
    """What a method with its options reads of a scale space.

    Attributes
    ----------
    normals : frozenset of int
        The scales whose normals it reads itself; 0 are the shape's own.
    curvature : frozenset of int
        The scales whose principal curvature it reads.
    seen : frozenset of int
        The scales whose curvature it reads as the eye sees it.
    means : frozenset of int
        The scales over whose width it averages values.
    rays : int
        How many rays go from each sample.
    around : float, optional
        How far round a sample it looks beside, in steps of the shape: cells, edge lengths. None:
        nobody said, so at all of the shape where rays go or samples don't stand for themselves.
    """

    normals: Scales = _NONE
    curvature: Scales = _NONE
    seen: Scales = _NONE
    means: Scales = _NONE
    rays: int = 0
    around: float | None = None

    @property
    def sets(self) -> Scales:
        """The scales whose normals have to be there: those read, and those that bend."""
        return self.normals | self.curvature | self.seen

    def __or__(self, other: Reads) -> Reads:
        """Return what two methods read together."""
        return Reads(
            self.normals | other.normals,
            self.curvature | other.curvature,
            self.seen | other.seen,
            self.means | other.means,
            max(self.rays, other.rays),
            _farther(self, other),
        )


def _farther(one: Reads, other: Reads) -> float | None:
    """Return how far both look together: at all where either has rays and nobody said how far."""
    known = [each.around for each in (one, other) if each.around is not None]
    silent = any(each.around is None and each.rays for each in (one, other))
    return None if silent or not known else max(known)
