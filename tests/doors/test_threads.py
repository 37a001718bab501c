import os
import threading
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from conftest import PATIENCE

from meshdepict import threads
from meshdepict.errors import MeshdepictError


@pytest.fixture(autouse=True)
def all_cores():
    threads.limit(None)
    yield
    threads.limit(None)


@pytest.fixture(params=[1, 3], ids=["one thread", "three"])
def count(request):
    threads.limit(request.param)
    return request.param


@pytest.mark.parametrize("pieces", [0, 1, 2, 50])
def test_every_piece_is_worked_on_once_and_reported_once(count, pieces):
    worked, done = [], []
    threads.each(
        lambda i, square: worked.append((i, square)),
        [(i, i * i) for i in range(pieces)],
        done.append,
    )
    assert sorted(worked) == [(i, i * i) for i in range(pieces)]
    assert sorted(done) == list(range(pieces))


def test_reports_come_from_the_calling_thread_after_the_work(count):
    finished, reporters = set(), set()

    def report(i):
        assert i in finished
        reporters.add(threading.current_thread())

    threads.each(finished.add, [(i,) for i in range(10)], report)
    assert reporters == {threading.current_thread()}


def test_pieces_run_side_by_side():
    threads.limit(2)
    meeting = threading.Barrier(2, timeout=PATIENCE)
    threads.each(meeting.wait, [(), ()])  # one alone would wait for ever


def test_no_more_threads_than_the_limit_run_at_once():
    threads.limit(2)
    running, most, lock = 0, 0, threading.Lock()
    meeting = threading.Barrier(2, timeout=PATIENCE)

    def work():
        nonlocal running, most
        with lock:
            running += 1
            most = max(most, running)
        meeting.wait()
        time.sleep(0.002)  # for a third to show
        with lock:
            running -= 1

    threads.each(work, [()] * 20)
    assert most == 2


def test_one_thread_is_the_caller_s_own():
    threads.limit(1)
    seen = []
    threads.each(lambda: seen.append(threading.current_thread()), [(), ()])
    assert set(seen) == {threading.current_thread()}


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
@pytest.mark.parametrize("where", ["work", "report"])
def test_an_error_goes_on_and_drops_what_has_not_begun(count, error, where):
    worked = []

    def work(i):
        worked.append(i)
        if where == "work" and i == 3:
            raise error("piece 3")
        time.sleep(0.02)  # ten seconds for all, in which somebody hears of it

    def report(i):
        if where == "report":
            raise error("piece 3")

    with pytest.raises(error, match="piece 3"):
        threads.each(work, [(i,) for i in range(1000)], report)
    assert len(worked) < 500
    threads.each(work, [(0,)])  # and the next ones run


def test_several_callers_at_once():
    threads.limit(2)
    results = []

    def caller():
        mine = []
        threads.each(mine.append, [(i,) for i in range(200)])
        results.append(sorted(mine))

    callers = [threading.Thread(target=caller) for _ in range(4)]
    for thread in callers:
        thread.start()
    for thread in callers:
        thread.join(timeout=PATIENCE)
    assert results == [list(range(200))] * 4


# --- how many ---------------------------------------------------------------------------------


def test_all_cores_unless_limited(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(5)), raising=False)
    assert threads.thread_count() == 5
    threads.limit(3)
    assert threads.thread_count() == 3
    threads.limit(None)
    assert threads.thread_count() == 5


@pytest.mark.parametrize(("cores", "expected"), [(7, 7), (None, 1)])
def test_where_the_system_does_not_tell_which_cores(monkeypatch, cores, expected):
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    assert threads.thread_count() == expected


@pytest.mark.parametrize("wrong", [0, -3, 1.5, True])
def test_a_limit_that_makes_no_sense(wrong):
    with pytest.raises(MeshdepictError, match=f"threads={wrong} makes no sense"):
        threads.limit(wrong)


# --- spans ------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [0, 1, 2, 7, 100, 10**9])
@pytest.mark.parametrize("pieces", [1, 2, 3, 64])
def test_spans_cover_a_range_evenly_without_gap_or_overlap(count, pieces):
    found = threads.spans(count, pieces)
    assert found[0][0] == 0
    assert found[-1][1] == count
    assert all(end == begin for (_, end), (begin, _) in pairwise(found))
    sizes = [end - begin for begin, end in found]
    assert max(sizes) - min(sizes) <= 1
    assert len(found) == max(1, min(pieces, count))


def test_kernels_are_compiled_in_one_place():
    package = Path(threads.__file__).parent
    texts = {path: path.read_text("utf-8") for path in package.rglob("*.py")}
    assert [path for path, text in texts.items() if "import njit" in text] == [
        package / "kernels" / "kernel.py"
    ]
    # Vectors of which kernels are made are what else is asked of numba, when they are compiled.
    assert [path.stem for path, text in texts.items() if "\nfrom numba" in text] == ["lane_code"]
    assert not [path for path, text in texts.items() if "lane_code import" in text]


@pytest.mark.parametrize("rounding", threads._FLAGS)
def test_a_kernel_is_compiled_as_it_asks(rounding):
    @threads.kernel(rounding)
    def total(values):
        found = 0.0
        for value in values:
            found += value
        return found

    flags = total.targetoptions
    assert (flags["nogil"], flags["error_model"]) == (True, "numpy")
    assert total(np.array([1.0, 2.0, 4.0])) == 7.0
