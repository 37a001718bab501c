"""A short soak: bakes of every kind, right and wrong, leave nothing behind."""

import sys
import threading
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))

import soak


@pytest.mark.slow
def test_a_hundred_bakes_leave_nothing(tmp_path, monkeypatch):
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    folder = tmp_path / "work"
    folder.mkdir()
    found = soak.Soak(seed=2)
    before = soak.settle(folder, found)
    found.run(lambda number: number < 100, folder)
    after = soak.Left.now()
    assert not found.faults
    assert len(found.done) >= len(soak._KINDS)
    assert (after.descriptors, after.threads, after.children) == (
        before.descriptors, before.threads, before.children
    )  # fmt: skip
    assert after.temporary == before.temporary == set()
    assert not list(folder.iterdir())


def test_what_is_left_is_seen(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    before, stop = soak.Left.now(), threading.Event()
    thread = threading.Thread(target=stop.wait)
    thread.start()
    try:
        with (tmp_path / "left").open("w"):
            after = soak.Left.now()
    finally:
        stop.set()
        thread.join()
    assert after.threads == before.threads + 1
    assert after.temporary - before.temporary == {"left"}
    if Path("/proc/self/fd").is_dir():
        assert after.descriptors == before.descriptors + 1


@pytest.mark.parametrize("slope", [0.0, 3.0, -1.0])
def test_growth_is_told_from_what_fills_and_from_what_swings(slope):
    number = np.arange(1000)
    sizes = 200 + slope * number / 100 + 50 * np.minimum(number / 300, 1)
    sizes += np.random.default_rng(0).normal(0, 5, 1000)
    found, error = soak.growth(list(sizes))
    assert abs(found - slope) < 3 * error
    assert error < 0.3


def test_growth_of_too_few_is_unknown():
    assert soak.growth([1.0, 2.0]) == (0.0, np.inf)
