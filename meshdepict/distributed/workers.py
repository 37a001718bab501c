"""Who does the work: processes of this machine, or the workers of a Dask scheduler."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from meshdepict import threads
from meshdepict.distributed.attempts import Pool, Share, Work
from meshdepict.distributed.cluster import Cluster, client_of, local_client
from meshdepict.distributed.processes import Processes
from meshdepict.errors import MeshdepictError

__all__ = ["Workers"]

LOCAL = "local"


@dataclass(frozen=True)
class Workers:
    """Who is to do the work; `at_work` starts them.

    Parameters
    ----------
    scheduler : str, optional
        The address of a Dask scheduler; "local" for one of this machine; without, processes of
        this machine that need no Dask.
    count : int, optional
        How many processes of this machine; one for each core unless given. Those of a cluster are
        as many as it has.
    memory : int or str, optional
        What a part may take; see `files.limits.set_max_memory`.

    Raises
    ------
    MeshdepictError
        For a number that is none of processes, and for one beside the address of a cluster.
    """

    scheduler: str | None = None
    count: int | None = None
    memory: int | str | None = None

    def __post_init__(self) -> None:
        """Refuse what can't be."""
        if self.count is not None and self.count < 1:
            raise MeshdepictError(f"workers={self.count} makes no sense: at least one is needed")
        if self.scheduler not in (None, LOCAL) and self.count is not None:
            raise MeshdepictError(
                f"the scheduler at {self.scheduler} has the workers that it has: leave --workers "
                "out"
            )

    @contextmanager
    def at_work(self) -> Iterator[Callable[[Work], Any]]:
        """Give what makes a pool for some work: ``with workers.at_work() as pool_for: …``.

        Its pools are used in ``with`` statements. At the end all processes that it started end.

        Raises
        ------
        MeshdepictError
            Where the scheduler doesn't answer, or Dask is missing.
        """
        count = self.count or threads.thread_count()
        each = max(1, threads.thread_count() // count)
        if self.scheduler is None:
            share = Share(each, self.memory)
            yield lambda work: Processes(work, count, share)
            return
        local = self.scheduler == LOCAL
        with local_client(count, each) if local else client_of(self.scheduler) as client:
            yield lambda work: self._pool(client, work)

    @contextmanager
    def _pool(self, client: Any, work: Work) -> Iterator[Pool]:
        pool = Cluster(client, work, memory=self.memory)
        try:
            yield pool
        finally:
            pool.drop()
