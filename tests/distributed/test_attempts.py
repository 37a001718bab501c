"""Parts are tried again where that may help, and one that fails stops no other."""

import os
import signal
import warnings
from collections import Counter

import pytest
from side_pools import Here

from meshdepict import threads
from meshdepict.distributed import processes
from meshdepict.distributed.attempts import Share, gone, outcomes, results
from meshdepict.distributed.processes import Processes
from meshdepict.distributed.workers import Workers
from meshdepict.errors import MeshdepictError


def double(item):
    return 2 * item


def refuse_odd(item):
    if item % 2:
        raise MeshdepictError(f"{item} is odd")
    return item


def fault(item):
    raise (MemoryError if item else KeyError("no"))


def test_every_part_is_done_once():
    assert sorted(results(Here(double), [1, 2, 3])) == [(0, 2), (1, 4), (2, 6)]


def test_a_refusal_is_lasting_and_stops_no_other():
    found = {each.number: each for each in outcomes(Here(refuse_odd), [0, 1, 2])}
    assert [found[n].error for n in range(3)] == ["", "1 is odd", ""]
    with pytest.raises(MeshdepictError, match="1 is odd"):
        list(results(Here(refuse_odd), [0, 1, 2]))


def test_what_may_pass_is_tried_again():
    tries = Counter()

    def spoil(found):
        tries[found.number] += 1
        return gone(found.number) if found.number == 1 and tries[1] < 3 else found

    assert sorted(results(Here(double, spoil), [1, 2, 3])) == [(0, 2), (1, 4), (2, 6)]
    assert tries == {0: 1, 1: 3, 2: 1}


def test_faults_are_sentences_after_some_tries():
    found = {each.number: each.error for each in outcomes(Here(fault), [0, 1], retries=1)}
    assert "please report it (KeyError" in found[0]
    assert "out of memory" in found[1]
    (lost,) = outcomes(Here(double, lambda found: gone(found.number)), [1])
    assert "the process that worked on it ended" in lost.error


# --- processes ----------------------------------------------------------------------------------


def die_once(flag):
    if flag and not os.path.exists(flag):
        with open(flag, "w"):
            os.kill(os.getpid(), signal.SIGKILL)
    return os.getpid(), threads.thread_count()


@pytest.mark.slow
def test_a_process_that_is_killed_is_replaced(tmp_path):
    with Processes(die_once, 2, Share(1)) as pool:
        found = dict(results(pool, ["", str(tmp_path / "flag"), "", ""]))
    assert sorted(found) == [0, 1, 2, 3]
    pids = {pid for pid, _ in found.values()}
    assert os.getpid() not in pids
    assert {count for _, count in found.values()} == {1}
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def sleep_writing(path):
    from meshdepict.files.atomic import atomic_write

    with atomic_write(path) as file:
        file.write(b"begun")
        file.flush()
        signal.pause()


@pytest.mark.slow
def test_what_is_being_written_when_the_work_ends_is_put_away(tmp_path, monkeypatch):
    monkeypatch.setattr(processes, "_PATIENCE", 60)
    with Processes(sleep_writing, 1, Share(1)) as pool:
        pool.give(0, tmp_path / "result")
        while not list(tmp_path.iterdir()):
            pass
    assert not list(tmp_path.iterdir())


def test_workers_that_make_no_sense_are_refused():
    with pytest.raises(MeshdepictError, match="at least one"):
        Workers(count=0)
    with pytest.raises(MeshdepictError, match="has the workers that it has"):
        Workers("tcp://there:8786", 2)


def test_a_share_is_obeyed():
    with warnings.catch_warnings():
        Share(1).obey()
        assert threads.thread_count() == 1
        threads.limit(None)
