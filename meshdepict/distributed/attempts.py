"""Doing a part of the work: what becomes of it, and whether to try again."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, Protocol

from meshdepict import threads
from meshdepict.baking.batch import MEMORY, unexpected
from meshdepict.errors import MeshdepictError
from meshdepict.files import limits

__all__ = ["RETRIES", "Outcome", "Pool", "Share", "Work", "attempt", "gone", "outcomes", "results"]

Work = Callable[[Any], Any]

RETRIES = 2
"""How often a part is tried again whose process ended, or that met a fault."""


class Share(NamedTuple):
    """What a part of the work may take of its machine.

    Attributes
    ----------
    threads : int
        Of kernels.
    memory : int or str, optional
        As `files.limits.set_max_memory` takes it.
    """

    threads: int
    memory: int | str | None = None

    def obey(self) -> None:
        """Take no more from now on."""
        threads.limit(self.threads)
        limits.set_max_memory(self.memory)


class Outcome(NamedTuple):
    """What became of a part.

    Attributes
    ----------
    number : int
        Which part it was.
    value : object
        What the work returned.
    error : str
        One sentence, where it failed.
    lasting : bool
        Whether it would fail again: of a broken file, not of a process that ended.
    """

    number: int
    value: Any = None
    error: str = ""
    lasting: bool = True


class Pool(Protocol):
    """Processes that do the same work on one part after the other."""

    @property
    def ahead(self) -> int:
        """How many parts they are given at once."""

    def give(self, number: int, item: Any) -> None:
        """Have a part done."""

    def take(self) -> Outcome:
        """Wait for what becomes of any part that was given."""


def attempt(work: Work, number: int, item: Any) -> Outcome:
    """Do a part; whatever happens is an outcome."""
    try:
        return Outcome(number, work(item))
    except MeshdepictError as error:
        return Outcome(number, error=str(error))
    except MemoryError:
        return Outcome(number, error=MEMORY, lasting=False)
    except Exception as error:  # a fault of this program's, or of the machine's
        return Outcome(number, error=str(unexpected(error)), lasting=False)


def gone(number: int) -> Outcome:
    """Return what becomes of a part whose process ended."""
    text = "the process that worked on it ended, for want of memory perhaps: give fewer --workers"
    return Outcome(number, error=text, lasting=False)


def outcomes(pool: Pool, items: Sequence[Any], *, retries: int = RETRIES) -> Iterator[Outcome]:
    """Yield what became of every part, in the order in which they end.

    Parameters
    ----------
    pool : Pool
    items : sequence
        The parts.
    retries : int
        How often one is tried again that failed for no lasting reason.
    """
    waiting, tries, busy = deque(range(len(items))), Counter[int](), 0
    while waiting or busy:
        while waiting and busy < pool.ahead:
            number = waiting.popleft()
            pool.give(number, items[number])
            busy += 1
        found = pool.take()
        busy -= 1
        if found.error and not found.lasting and tries[found.number] < retries:
            tries[found.number] += 1
            waiting.append(found.number)
        else:
            yield found


def results(
    pool: Pool, items: Sequence[Any], *, retries: int = RETRIES
) -> Iterator[tuple[int, Any]]:
    """Yield every part's number and result, where all of them are needed.

    Raises
    ------
    MeshdepictError
        For the first that fails.
    """
    for found in outcomes(pool, items, retries=retries):
        if found.error:
            raise MeshdepictError(found.error)
        yield found.number, found.value
