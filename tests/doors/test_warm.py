"""``meshdepict warm``, and what is said where kernels are compiled without it."""

import os
import pty
import subprocess
import sys

import numpy as np
import pytest
from conftest import PATIENCE

from meshdepict.baking import warming
from meshdepict.baking.batch import check_look
from meshdepict.baking.look import Look
from meshdepict.errors import MeshdepictError
from meshdepict.threads import kernel


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "caches"))
    return tmp_path / "caches" / "meshdepict" / "kernels"


@pytest.fixture
def little(monkeypatch):
    """Let warming compile two kernels alone, one of which numba itself has to run."""

    def total(array):
        return array.sum()

    def listed(count):
        return list(range(count))[-1]

    works = (lambda: kernel()(total)(np.arange(3.0)), lambda: kernel()(listed)(3))
    monkeypatch.setattr(warming, "_works", lambda: iter(works))


def test_it_says_what_was_compiled_and_where_then_that_all_is_there(run, folder, little):
    status, (line,), err = run("warm")
    assert (status, err) == (0, [])
    files = [path for path in folder.rglob("*") if path.is_file()]
    size = sum(path.stat().st_size for path in files)
    assert line == f"{folder}: 2 compiled now; {len(files)} files, {size / 1e6:.1f} MB"
    assert run("warm")[1] == [line.replace("2 compiled now", "0 compiled now")]


def test_it_clears(run, folder, little):
    run("warm")
    status, (line,), err = run("warm", "--clear")
    assert (status, err) == (0, [])
    assert line.startswith(f"{folder}: ")
    assert " files deleted, 0.0 MB" in line
    assert not folder.exists()
    assert run("warm", "--clear")[1] == [f"{folder}: 0 files deleted, 0.0 MB"]


def test_a_folder_that_cannot_be_written_is_said(run, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    status, out, (line,) = run("warm")
    assert (status, out) == (2, [])
    assert "can't be written: set NUMBA_CACHE_DIR to a folder that can" in line


def test_no_folder_at_all(run, monkeypatch):
    monkeypatch.setattr("meshdepict.files.cache.cache_folder", lambda: None)
    assert "there is no folder for caches" in run("warm")[2][0]
    with pytest.raises(MeshdepictError, match="the cache can't be written"):
        warming.warm()


def test_its_samples_can_be_baked_by_all_that_it_tries():
    works = [*warming._works()]
    assert len(works) > 50
    looks = {
        (work.args[2], *work.keywords.items()) for work in works if "size" not in work.keywords
    }
    for method, *chosen in looks:  # refused before any work, so a few vertices will do
        check_look(Look(method, **dict(chosen)))
    names = {work.args[2] for work in works}
    assert {"exaggerated", "light_warping", "texture_shading", "sky_view"} <= names


@pytest.mark.slow
def test_a_bake_after_it_loads_no_compiler(folder):
    """What warming bakes first is what most people do: a mesh, as the defaults have it."""
    # In a process of its own: this one may have its kernels from elsewhere.
    first = "from meshdepict.baking import warming; next(warming._works())()"
    subprocess.run([sys.executable, "-c", first], check=True, timeout=PATIENCE)
    code = "import sys; from meshdepict.cli import main; main(['bake', '-o', 'x.ply', '--quiet'])"
    code += "; print(*{'numba', 'scipy', 'igl', 'trimesh', 'finufft'} & {*sys.modules})"
    code = code.replace("'bake', ", "'bake', 'ball.ply', ")
    from meshdepict import bake, samples

    where = folder.parents[2]
    bake(samples.golf_ball(40_000), "lambert").save(where / "ball.ply")
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=where, capture_output=True, text=True, timeout=PATIENCE,
        check=True,
    )  # fmt: skip
    assert done.stdout.splitlines()[-1] == ""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")
@pytest.mark.parametrize(("quiet", "times"), [((), 1), (("--quiet",), 0)])
def test_who_waits_at_a_terminal_is_told_once(tmp_path, quiet, times):
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "meshdepict", "bake", "-m", "lambert", "-o", "x.ply", *quiet]
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "caches")}
    env |= {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    process = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=theirs, env=env, cwd=tmp_path
    )
    os.close(theirs)
    said = b""
    while True:
        try:
            part = os.read(ours, 4096)
        except OSError:  # how Linux says that the other end is closed
            break
        if not part:
            break
        said += part
    assert process.wait(PATIENCE) == 0
    os.close(ours)
    assert said.count(b"kernels are compiled, once") == times
