"""The script that measures the cost model prints all of its constants, as the code names them."""

from __future__ import annotations

import importlib
import math
import re
import sys
from pathlib import Path

import pytest
from house import ROOT

from meshdepict import threads


@pytest.fixture(scope="module")
def script():
    sys.path.insert(0, str(ROOT / "scripts"))
    try:
        import cost_constants
    finally:
        sys.path.remove(str(ROOT / "scripts"))
    return cost_constants


@pytest.fixture
def small(script, monkeypatch):
    """Fewer points and cells: the names are wanted here, not the seconds."""
    monkeypatch.setattr(script.Direct, "vertices", 1_000)
    monkeypatch.setattr(script.Points, "count", 5_000)
    monkeypatch.setattr(script.Blocks, "vertices", 2_000)
    monkeypatch.setattr(script, "CELLS", (100_000, 150_000, 200_000, 300_000, 400_000))


def constants(module):
    """The numbers at the top of a module that its comments say are measured."""
    source = Path(importlib.import_module(module).__file__).read_text(encoding="utf-8")
    named = re.search(r"((?:^# .*\n)*^# .*cost_constants\.py.*\n(?:^# .*\n)*)((?:^_\w+ = .*\n)+)",
                      source, flags=re.M)  # fmt: skip
    return re.findall(r"^(_\w+) = ", named[2], flags=re.M)


@pytest.mark.usefixtures("small")
def test_every_constant_of_the_sums_is_printed_once(script):
    found = [*script.neighbours(1), *script.sparse_grids(1), *script.transforms(1)]
    names = [(module, name) for module, name, _ in found]
    assert sorted(names) == sorted(
        (module, name)
        for module in (script.GAUSSIAN, script.GRID, script.SPECTRAL)
        for name in constants(module)
    )
    assert all(math.isfinite(value) for *_, value in found)
    assert threads.thread_count() >= 1


def test_a_prediction_is_made_of_the_constants_that_the_script_prints(script, monkeypatch):
    """Costs that grow as a line are found to be that line."""
    report, count = importlib.import_module(script.REPORT), script.BAKES[0]

    class Command:
        def setup(self, subject):
            nonlocal count
            count = int(subject)

        teardown = time_baking = setup

        def track_memory(self, subject):
            return 5e8 + 700 * int(subject)

    monkeypatch.setattr(script, "Command", Command)
    monkeypatch.setattr(script, "cost", lambda _: script.Cost(0.0, 2.0 + 3e-5 * count))
    found = {name: value for _, name, value in script.bakes(1)}
    assert set(found) == set(constants(script.REPORT))
    assert found == pytest.approx({
        "_START_SECONDS": 2.0, "_VERTEX_SECONDS": 3e-5, "_START_BYTES": 5e8, "_VERTEX_BYTES": 700,
    })  # fmt: skip
    monkeypatch.setattr(report.threads, "thread_count", lambda: 1)
    for name, value in found.items():
        monkeypatch.setattr(report, name, value)
    mesh = type("Shape", (), {"vertices": range(1_000)})()
    assert report.predicted(mesh) == pytest.approx((2.03, 5.007e8))
