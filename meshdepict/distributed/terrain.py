"""Relief of a terrain by windows that several processes shade, and one writes."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path

from meshdepict.baking.relief import Relief, Shaded
from meshdepict.baking.windows import Window
from meshdepict.distributed.attempts import results
from meshdepict.distributed.workers import Workers
from meshdepict.scales.ladder import Progress

__all__ = ["save_by_workers", "shade_window"]


def save_by_workers(
    relief: Relief,
    path: str | Path,
    workers: Workers,
    *,
    values: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Shade a terrain by workers and write it; see `Relief.save`.

    Numbers are those of one process. Here no more windows are held than workers have.

    Parameters
    ----------
    relief : Relief
        Of a terrain in files that all workers see.
    path, values, progress
        As for `Relief.save`.
    workers : Workers

    Raises
    ------
    MeshdepictError
        As `Relief.save`, and where workers can't be had.
    """
    with workers.at_work() as pool_for, pool_for(shade_window) as pool:
        how = pickle.dumps(relief)

        def each(windows: Iterable[Window]) -> Iterator[Shaded]:
            for _, part in results(pool, [(how, window) for window in windows]):
                yield part

        return relief.save(path, values=values, progress=progress, each=each)


def shade_window(item: tuple[bytes, Window]) -> Shaded:
    """Shade a window of a terrain that this process opens once."""
    how, window = item
    return _opened(how).shade(window)


@lru_cache(maxsize=1)
def _opened(how: bytes) -> Relief:
    found: Relief = pickle.loads(how)
    return found
