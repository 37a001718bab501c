"""A Dask cluster of two worker processes, of which one is killed in the middle of the work."""

import contextlib
import os
import signal
import sys
from contextlib import contextmanager, nullcontext

import numpy as np
import pytest
from side_pools import Here, rows_of

from meshdepict import samples
from meshdepict.baking.look import Look
from meshdepict.baking.relief import Relief
from meshdepict.distributed import cluster as room
from meshdepict.distributed.cluster import Cluster, client_of, local_client
from meshdepict.distributed.files import FileBatch
from meshdepict.distributed.mesh_tiles import bake_by_tiles
from meshdepict.distributed.terrain import save_by_workers, shade_window
from meshdepict.distributed.workers import Workers
from meshdepict.errors import MeshdepictError
from meshdepict.io import write_mesh
from meshdepict.io.terrain import Terrain

distributed = pytest.importorskip("distributed")

pytestmark = pytest.mark.slow
UNPLACED = pytest.mark.filterwarnings("ignore:.*an array says no place")


@pytest.fixture(scope="module")
def team():
    """A client of two processes of one thread each."""
    before = _descriptors()
    with local_client(2, 1) as client:
        yield client
    # What stays open is of Python's own tracker of resources, and of what wakes its loops.
    sockets = [name for name in _descriptors() if name.startswith("socket") and name not in before]
    assert len(sockets) <= 2


def _descriptors() -> list[str]:
    found = []
    for number in os.listdir("/proc/self/fd") if sys.platform == "linux" else ():
        with contextlib.suppress(OSError):  # that of the list itself
            found.append(os.readlink(f"/proc/self/fd/{number}"))
    return found


class Killing(Cluster):
    """A cluster of which a worker is killed while the second part is under way."""

    killed = False

    def take(self):
        found = super().take()
        if not Killing.killed:
            Killing.killed = True
            pid = next(iter(self._client.run(os.getpid).values()))
            os.kill(pid, signal.SIGKILL)
        return found


class Deadly(Workers):
    """Workers of a cluster that loses one."""

    @contextmanager
    def at_work(self):
        Killing.killed = False
        yield lambda work: nullcontext(Killing(TEAM[0], work))
        assert Killing.killed


TEAM = []


@pytest.fixture
def deadly(team):
    TEAM[:] = [team]
    return Deadly()


def test_files_are_all_baked_though_a_worker_is_killed(deadly, folder, capsys):
    for name in "abcdef":
        write_mesh(f"{name}.ply", samples.golf_ball(10 * ord(name), dimples=12))
    (folder / "bad.ply").write_text("ply\nbroken")
    paths = sorted(folder.glob("*.ply"))
    batch = FileBatch(inputs=paths, look=Look(scales=3), output="out/", workers=deadly)
    assert batch.run() == 1
    err = capsys.readouterr().err.splitlines()
    # One that was written when its worker was killed, and not yet told of, is found to be done.
    assert err[-1].endswith("1 failed")
    for path in paths:
        if path.name != "bad.ply":
            Look(scales=3).bake(path).save("single.ply")
            out = folder / "out" / f"{path.stem}-exaggerated.ply"
            assert rows_of(out) == rows_of(folder / "single.ply")
    assert len(os.listdir("out")) == 6


def test_a_mesh_by_tiles_is_the_same_though_a_worker_is_killed(deadly, folder):
    write_mesh("a.ply", samples.golf_ball(4_000, dimples=42))
    look, path = Look(scales=5, tolerance=1e-3), folder / "a.ply"
    with deadly.at_work() as pool_for:
        bake_by_tiles(path, folder / "team.ply", look, pool_for, tile=1_500)
    bake_by_tiles(
        path, folder / "here.ply", look, lambda work: nullcontext(Here(work)), tile=1_500
    )  # fmt: skip
    assert (folder / "team.ply").read_bytes() == (folder / "here.ply").read_bytes()
    assert len(os.listdir()) == 3


@UNPLACED
def test_terrain_is_the_same_though_a_worker_is_killed(deadly, folder):
    z = np.random.default_rng(3).normal(size=(300, 260)).cumsum(axis=0).astype(np.float32)
    np.save("a.npy", z)
    with Terrain("a.npy") as terrain:
        relief = Relief(terrain, Look(scales=2), memory=4e6)
        assert len(relief.cut) >= 4
        save_by_workers(relief, "team.png", deadly)
        relief.save("here.png")
    assert (folder / "team.png").read_bytes() == (folder / "here.png").read_bytes()


@UNPLACED
def test_windows_are_shaded_by_one_who_opens_the_terrain_again(folder):
    np.save("a.npy", np.eye(40))
    import pickle

    with Terrain("a.npy") as terrain:
        relief = Relief(terrain, Look("lambert"))
        window = next(iter(relief.cut.windows()))
        found = shade_window((pickle.dumps(relief), window))
        np.testing.assert_array_equal(found.colors, relief.shade(window).colors)


# --- what isn't there ---------------------------------------------------------------------------


def test_a_cluster_with_an_address_does_the_work(team, folder):
    write_mesh("a.ply", samples.golf_ball(400, dimples=12))
    address = team.scheduler.address
    batch = FileBatch(
        inputs=[folder / "a.ply"], look=Look("lambert"), workers=Workers(address), quiet=True
    )
    assert batch.run() == 0


def test_nobody_who_answers_is_said_within_seconds(monkeypatch):
    monkeypatch.setattr(room, "_PATIENCE", 1.0)
    for address in ("tcp://127.0.0.1:9", "nonsense", ""):
        with (
            pytest.raises(MeshdepictError, match="no Dask scheduler answers at"),
            client_of(address),
        ):
            pass


def test_workers_of_another_version_and_without_it_are_refused(team, monkeypatch):
    address = team.scheduler.address
    monkeypatch.setattr(room, "VERSION", "another")
    with pytest.raises(MeshdepictError, match="this is another"), client_of(address):
        pass
    monkeypatch.setattr(room, "_version", "no function")
    with pytest.raises(MeshdepictError, match="can import meshdepict"), client_of(address):
        pass


def test_a_scheduler_without_workers_is_said(monkeypatch):
    monkeypatch.setattr(room, "_WORKERS", 0.2)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=":0", processes=False) as empty,
        pytest.raises(MeshdepictError, match="has no workers"),
        client_of(empty.scheduler_address),
    ):
        pass


def test_a_scheduler_that_goes_is_said(team):
    pool = Cluster(team, abs)
    pool.give(0, -1)
    with contextlib.suppress(Exception):
        team.cancel(list(pool._numbers), force=True)
    with pytest.raises(MeshdepictError, match="the scheduler has gone"):
        pool.take()


def test_without_dask_one_sentence_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(MeshdepictError, match=r"meshdepict\[cluster\]"), local_client(1, 1):
        pass
