"""A Dask cluster: one that is there already, or one of this machine's processes."""

from __future__ import annotations

import asyncio
import logging
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import Any

from meshdepict.distributed.attempts import Outcome, Share, Work, attempt, gone
from meshdepict.errors import MeshdepictError
from meshdepict.files.mark import VERSION

__all__ = ["Cluster", "client_of", "dask_setup", "local_client"]

_PATIENCE = 10.0  # seconds until a scheduler has answered, or is said not to
_WORKERS = 30.0  # … and until one worker at least has reported to it

_one_at_a_time = threading.Lock()


class Cluster:
    """Workers of a Dask scheduler that do the same work.

    A part takes all threads of its worker, which does one at a time.

    Parameters
    ----------
    client : distributed.Client
    work : callable
    memory : int or str, optional
        What a part may take; see `Share`.
    """

    def __init__(self, client: Any, work: Work, *, memory: int | str | None = None) -> None:
        from distributed import as_completed

        self._client, self._work, self._memory = client, work, memory
        self._ended = as_completed(loop=client.loop)
        self._numbers: dict[Any, int] = {}

    @property
    def ahead(self) -> int:
        """Two parts for every worker, so that none waits for the next."""
        return 2 * max(1, len(self._client.scheduler_info(n_workers=-1)["workers"]))

    def give(self, number: int, item: Any) -> None:
        """Have a part done."""
        future = self._client.submit(
            _part, self._work, number, item, self._memory, pure=False, retries=0
        )
        self._numbers[future] = number
        self._ended.add(future)

    def take(self) -> Outcome:
        """Wait for what becomes of any part.

        Raises
        ------
        MeshdepictError
            Where the scheduler has gone.
        """
        from distributed import KilledWorker
        from distributed.client import FutureCancelledError

        future = next(self._ended)
        number = self._numbers.pop(future)
        try:
            found: Outcome = future.result()
        except KilledWorker:  # several of them, one after the other
            return gone(number)._replace(lasting=True)
        except (FutureCancelledError, OSError) as error:
            raise MeshdepictError(
                "the scheduler has gone, and with it what was not yet done: run the same command "
                "again when it is back"
            ) from error
        finally:
            future.release()
        return found

    def drop(self) -> None:
        """Let go of all that was given; what a worker has begun it ends."""
        with suppress(Exception):  # whatever is to be said has been said
            self._client.cancel(list(self._numbers), force=True)


def _part(work: Work, number: int, item: Any, memory: int | str | None) -> Outcome:
    from distributed import get_worker

    with _one_at_a_time:
        Share(get_worker().state.nthreads, memory).obey()
        return attempt(work, number, item)


@contextmanager
def client_of(address: str) -> Iterator[Any]:
    """Give a client of a scheduler that has workers with this version of meshdepict.

    Parameters
    ----------
    address : str
        As ``tcp://host:8786``.

    Raises
    ------
    MeshdepictError
        Where nobody answers, it has no workers, or they have another version.
    """
    _needs_dask()
    from distributed import Client

    with _quiet():
        # (A client that reaches nobody waits again as it is thrown away.)
        with ThreadPoolExecutor(1) as apart:
            answers = apart.submit(asyncio.run, _answers(address)).result()
        if not answers:
            raise MeshdepictError(
                f"no Dask scheduler answers at {address!r}: start one (dask scheduler) and give "
                "its address, tcp://host:8786 for instance, or --scheduler local"
            )
        with Client(address, timeout=_PATIENCE, set_as_default=False) as client:
            try:
                client.wait_for_workers(1, timeout=_WORKERS)
            except TimeoutError:
                raise MeshdepictError(
                    f"the scheduler at {address} has no workers: start some (dask worker {address})"
                ) from None
            try:
                found = set(client.run(_version).values())
            except Exception:
                raise MeshdepictError(
                    f"not all workers of {address} can import meshdepict: install it for them, too"
                ) from None
            if found != {VERSION}:
                raise MeshdepictError(
                    f"the workers of {address} have meshdepict {', '.join(sorted(found))}, and "
                    f"this is {VERSION}: they must have the same"
                )
            yield client


@contextmanager
def local_client(count: int, threads: int) -> Iterator[Any]:
    """Give a client of so many processes of this machine, with so many threads each."""
    _needs_dask()
    from distributed import Client, LocalCluster

    with (
        _quiet(),
        LocalCluster(
            n_workers=count, threads_per_worker=threads, processes=True,
            dashboard_address="127.0.0.1:0",  # any free port: the usual one may be taken
            silence_logs=logging.CRITICAL, host="127.0.0.1", preload=[__name__],
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):  # fmt: skip
        yield client


def dask_setup(worker: object) -> None:
    """Leave Ctrl-C to the one who started this worker: Dask calls this in it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


async def _answers(address: str) -> bool:
    """Whether a scheduler is there."""
    from distributed.core import rpc

    try:
        async with asyncio.timeout(_PATIENCE):
            scheduler = rpc(address, timeout=_PATIENCE / 2)
            try:
                return (await scheduler.identity())["type"] == "Scheduler"
            finally:
                await scheduler.close_rpc()
    except Exception:  # whatever it is, it isn't one
        return False


def _version() -> str:
    return VERSION


def _needs_dask() -> None:
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise MeshdepictError(
            "a cluster needs dask: pip install 'meshdepict[cluster]'; without --scheduler "
            "processes of this machine do the work"
        ) from None


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what Dask logs to itself: what matters is said in a sentence."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)
