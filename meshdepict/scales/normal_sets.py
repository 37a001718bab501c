"""Sets of normals, one for each width, that are smoothed when somebody asks for them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.ladder import Progress, checked_scale, checked_scales, reporter

__all__ = ["Fill", "NormalSets"]

Fill = Callable[[int, NDArray[np.float32], Callable[[float], None] | None], None]
"""Fills an array (3, n) with a scale's normals, telling shares of the work that are done."""


class NormalSets:
    """Unit normals of samples at every scale, from fine to coarse.

    A set is there once `smooth` was asked for it, or as soon as it is read: one by `normals_at` or
    `planes_at`, some by `planes_of`, all by `normals` or `planes`. What was read does not change.

    Parameters
    ----------
    widths : (scales + 1,) array
    own : (3, n) array
        Of scale 0.
    planes : (scales + 1, 3, n) array of float32, optional
        Room for all sets, in which the first one stands already.
    """

    # Names of what only smoothing needs, and can't be sent to another process.
    _means_of_smoothing: tuple[str, ...] = ()

    def __init__(
        self,
        widths: NDArray[np.float64],
        own: NDArray[Any],
        planes: NDArray[np.float32] | None = None,
    ) -> None:
        self.widths = widths
        # Stored as (scale, axis, sample), so that kernels read each component in one sweep. Of the
        # room for all sets only that takes memory which somebody has written to.
        if planes is None:
            planes = np.empty((len(widths), *own.shape), np.float32)
            planes[0] = own
        self._room = planes.data
        self._sets: dict[int, NDArray[np.float32]] = {}
        self._all: NDArray[np.float32] | None = None
        self._smoothing = threading.RLock()
        self._take(0)

    @property
    def last(self) -> int:
        """Number of the coarsest scale."""
        return len(self.widths) - 1

    @property
    def smoothed(self) -> frozenset[int]:
        """The scales whose normals are there by now."""
        return frozenset(self._sets)

    @property
    def planes(self) -> NDArray[np.float32]:
        """Unit normals (scales + 1, 3, n), read-only; smooths what is missing."""
        self.smooth()
        assert self._all is not None
        return self._all

    @property
    def normals(self) -> NDArray[np.float32]:
        """Unit normals (scales + 1, n, 3), a read-only view; smooths what is missing."""
        return np.moveaxis(self.planes, 1, 2)

    def planes_at(self, scale: int) -> NDArray[np.float32]:
        """Return the unit normals (3, n) of a scale, read-only; smooths them if they aren't there.

        Raises
        ------
        MeshdepictError
            For a scale that isn't there.
        """
        scale = self._checked_scale(scale)
        self.smooth((scale,))
        return self._sets[scale]

    def normals_at(self, scale: int) -> NDArray[np.float32]:
        """Return the unit normals (n, 3) of a scale; see `planes_at`."""
        return self.planes_at(scale).T

    def planes_of(self, scales: Sequence[int]) -> NDArray[np.float32]:
        """Return the unit normals (k, 3, n) of k scales in this order, read-only.

        A copy, unless they follow each other.
        """
        self.smooth(scales)
        first, planes = scales[0], np.asarray(self._room)
        follow = list(scales) == list(range(first, first + len(scales)))
        found = planes[first : first + len(scales)] if follow else planes[list(scales)]
        found.setflags(write=False)
        return found

    def smooth(
        self, scales: Iterable[int] | None = None, *, progress: Progress | None = None
    ) -> None:
        """Let the normals of some scales be there, with what they are made of.

        Parameters
        ----------
        scales : iterable of int, optional
            All unless given.
        progress : callable, optional
            ``progress(done, total)``, where there is something to be done.

        Raises
        ------
        MeshdepictError
            For a scale that isn't there.
        """
        wanted = checked_scales(scales, self.last)
        if wanted <= self._sets.keys():
            return
        with self._smoothing:
            missing = self._missing(wanted)
            fill = self._smoother() if self._sets[0].size else _nothing
            for number, scale in enumerate(missing, 1):
                done = reporter(progress, number, len(missing))
                fill(scale, np.asarray(self._room)[scale], done)
                self._take(scale)
                if done:
                    done(1.0)

    def _take(self, scale: int) -> None:
        """Let a set be there that has been filled in; nobody may write to it any more."""
        found = np.asarray(self._room)
        found.setflags(write=False)
        if len({*self._sets, scale}) == len(self.widths):
            self._all = found
        self._sets[scale] = found[scale]

    def __getstate__(self) -> dict[str, Any]:
        """Return what is sent to another process: all sets, and not how they are smoothed."""
        self.smooth()
        left_out = ("_room", "_smoothing", "_sets", *self._means_of_smoothing)
        return {name: value for name, value in vars(self).items() if name not in left_out}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take up again what was kept."""
        vars(self).update(state)
        assert self._all is not None
        self._all.setflags(write=False)
        self._sets = dict(enumerate(self._all))
        self._room, self._smoothing = self._all.data, threading.RLock()

    def _missing(self, wanted: set[int]) -> list[int]:
        """Return which scales are to be smoothed for some, fine to coarse."""
        missing: set[int] = set()
        while wanted:
            scale = wanted.pop()
            if scale not in self._sets and scale not in missing:
                missing.add(scale)
                wanted.update(self._made_from(scale))
        return sorted(missing)

    def _checked_scale(self, scale: int) -> int:
        return checked_scale(scale, self.last)

    # --- what depends on the kind of shape --------------------------------------------------

    def _smoother(self) -> Fill:
        """Return what fills in a scale's normals; those that it is made from are there."""
        raise NotImplementedError

    def _made_from(self, scale: int) -> tuple[int, ...]:
        """Return the scales that this one is always made from."""
        return (scale - 1,)


def _nothing(*_: Any) -> None:
    """Fill in the normals of no samples."""
