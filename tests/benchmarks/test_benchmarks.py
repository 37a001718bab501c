"""Benchmarks run, each on something small: what nobody runs for months doesn't rot."""

from __future__ import annotations

import importlib
import inspect
import itertools
import pkgutil
import subprocess
import sys
from collections.abc import Iterator

import pytest
from house import ROOT

sys.path.insert(0, str(ROOT))
import benchmarks
from benchmarks import subjects, timing

KINDS = ("time_", "timeraw_", "peakmem_", "track_")


def found() -> Iterator[tuple[type, str]]:
    """Every benchmark: its class and the name of its method."""
    for module in pkgutil.iter_modules(benchmarks.__path__):
        for _, each in inspect.getmembers(importlib.import_module(f"benchmarks.{module.name}")):
            if inspect.isclass(each) and each.__module__ == f"benchmarks.{module.name}":
                yield from ((each, name) for name in vars(each) if name.startswith(KINDS))


ALL = {f"{each.__module__}.{each.__name__}.{name}": (each, name) for each, name in found()}
# Whole processes of several seconds: the others of their classes stand for them.
LONG = {"Method": "time_baking", "Command": "time_first_baking", "Page": "track_turning"}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The same subjects with 300 vertices, no scans."""
    monkeypatch.delenv("MESHDEPICT_DATA", raising=False)
    monkeypatch.setattr(subjects, "BALLS", dict.fromkeys(subjects.BALLS, 300))
    for cached in (subjects.path, subjects.mesh):
        cached.cache_clear()
    yield
    for cached in (subjects.path, subjects.mesh):
        cached.cache_clear()


def smallest(each: type) -> tuple[object, ...]:
    """The first of a benchmark's parameters that asks for no scans, sizes and pixels the least."""
    params = getattr(each, "params", ())
    sizes = {"size": 24, "side": 40}
    return tuple(
        sizes.get(name, values[0])
        for name, values in zip(getattr(each, "param_names", ()), params, strict=True)
    )


def test_what_people_wait_for_has_a_benchmark():
    """The expensive step, a new light, whole processes, CT and pixels; memory of each shape."""
    modules = {name.split(".")[1] for name in ALL}
    assert modules >= {
        "browser", "curvatures", "lights", "live", "pixels", "processes", "scale_spaces",
        "terrain_files", "volumes",
    }  # fmt: skip
    peaks = {name.split(".")[1] for name in ALL if ".peakmem_" in name}
    assert peaks == {"scale_spaces", "volumes", "pixels", "terrain_files"}


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("name", ALL)
def test_a_benchmark_runs(name, monkeypatch):
    each, method = ALL[name]
    if method == LONG.get(each.__name__, ""):
        pytest.skip("a whole process as long as the other")
    if name.startswith("benchmarks.volumes.Scipy"):
        monkeypatch.setattr(each, "params", ((24,),))
    if method.startswith("timeraw_"):
        assert timing.statement_seconds(getattr(each(), method)(), runs=1) > 0
        return
    try:
        assert timing.best(each(), method, *smallest(each), runs=1) > 0
    except NotImplementedError as missing:
        pytest.skip(str(missing))


def test_asv_finds_what_python_finds():
    pytest.importorskip("asv", reason="asv is in the extra bench")
    done = subprocess.run(
        [sys.executable, "-m", "asv", "check", "--python=same"],
        cwd=ROOT / "benchmarks", capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "No problems found" in done.stdout


def test_scripts_time_nothing_that_a_benchmark_times():
    """A clock in a script says how long the script takes, no more."""
    for path in (ROOT / "scripts").glob("*_speed.py"):
        assert "perf_counter" not in path.read_text(encoding="utf-8"), path.name
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "scripts").glob("*.py")]
    clocks = itertools.chain.from_iterable(source.splitlines() for source in sources)
    assert not any("min(times)" in line for line in clocks)


def test_a_refused_setup_is_torn_down_no_further():
    class Refused:
        def setup(self) -> None:
            raise NotImplementedError("nothing here")

        def teardown(self) -> None:
            raise AssertionError("nothing to tear down")

        def time_nothing(self) -> None:
            raise AssertionError("not set up")

    with pytest.raises(NotImplementedError, match="nothing here"):
        timing.best(Refused(), "time_nothing")
