"""Shared by all tests: real scans where they are at hand, small exact shapes, and two promises."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from hypothesis import settings
from promises import promises, watch_parameters, watched_functions  # noqa: F401
from side_by_side import pytest_xdist_auto_num_workers, share_of_threads  # noqa: F401

from meshdepict import samples, threads
from meshdepict.files import limits
from meshdepict.shapes.mesh import Mesh

DATA = os.environ.get("MESHDEPICT_DATA")

# tests/extremes, for hours.
settings.register_profile("long", max_examples=100_000, deadline=None)

# Seconds until a test gives up on another program or thread. Only one that hangs takes them: on
# two free cores none takes six, and some machines are busy and ten times slower.
PATIENCE = 600

# A shell's background jobs ignore Ctrl-C, and so would the programs that tests interrupt.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# A file of tests that takes anything from here by name draws.
DRAWING = (
    "pyvista", "live_pictures", "meshdepict.drawing.picture", "meshdepict.drawing.movie",
    "meshdepict.drawing.volume_", "meshdepict.viewer.live", "meshdepict.viewer.windows",
)  # fmt: skip

# A test that uses one of these fixtures gets the marker.
MARKERS = {"tab": "browser", "data": "data"}


def draws(file: ModuleType) -> bool:
    """Whether a file of tests has a name from what draws with OpenGL."""
    return any(
        str(
            getattr(thing, "__name__" if isinstance(thing, ModuleType) else "__module__", "")
        ).startswith(DRAWING)
        for thing in vars(file).values()
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what needs a browser or real data, so that it can be left out by name."""
    for item in items:
        watch_parameters(item)
        if draws(item.module):
            item.add_marker("gpu")
        for fixture in MARKERS.keys() & set(getattr(item, "fixturenames", ())):
            item.add_marker(MARKERS[fixture])


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real data, or a skip that says why."""
    if not DATA:
        pytest.skip("real data not at hand: MESHDEPICT_DATA is not set")
    folder = Path(DATA)
    if not folder.is_dir():
        pytest.skip(f"real data not at hand: MESHDEPICT_DATA={DATA} is no folder")
    return folder


@pytest.fixture(scope="session")
def bunny(data: Path) -> Mesh:
    from meshdepict.io import read_mesh

    return read_mesh(data / "mesh" / "bunny_69k.ply")


@pytest.fixture(scope="session")
def sphere() -> Mesh:
    """A unit sphere of about 2,500 vertices."""
    return samples.sphere(2_500)


@pytest.fixture(scope="session")
def ball() -> Mesh:
    """A small golf ball: relief on a closed surface."""
    return samples.golf_ball(6_000)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20061)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty current folder; a command's --threads and --max-memory are not the next test's."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    yield tmp_path
    threads.limit(None)
    limits.set_max_memory(None)


@pytest.fixture
def ball_ply(folder: Path) -> Mesh:
    """A very small golf ball, also as ball.ply in the current folder."""
    from meshdepict.io import write_mesh

    mesh = samples.golf_ball(400, dimples=12)
    write_mesh("ball.ply", mesh)
    return mesh


@pytest.fixture
def run(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, list[str], list[str]]]:
    """Run a command line; return its status and the lines on stdout and stderr."""
    from meshdepict.cli import main

    def run(*words: object) -> tuple[int, list[str], list[str]]:
        status = main([str(word) for word in words])
        out, err = capsys.readouterr()
        assert "\x1b" not in out + err
        assert "Traceback" not in err
        return status, out.splitlines(), err.splitlines()

    return run


def tetrahedron() -> tuple[np.ndarray, np.ndarray]:
    vertices = np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]], float)
    return vertices, np.array([[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]])


def rotation(rng: np.random.Generator) -> np.ndarray:
    """A random rotation matrix."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Angles in radians between unit vectors, accurate for small ones."""
    half = np.linalg.norm(np.asarray(a, float) - np.asarray(b, float), axis=-1) / 2
    return 2 * np.arcsin(np.minimum(half, 1))
