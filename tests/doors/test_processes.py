"""Ctrl-C at any time, closed pipes, names of one file, and what a terminal is told."""

from __future__ import annotations

import os
import shutil
import signal
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from meshdepict import samples
from meshdepict.baking.targets import identities, identity
from meshdepict.files import limits
from meshdepict.io import write_mesh
from meshdepict.viewer.browser.redirect import redirect

posix = pytest.mark.skipif(os.name != "posix", reason="needs POSIX's signals and files")
COMMAND = [sys.executable, "-m", "meshdepict"]


# --- Ctrl-C -------------------------------------------------------------------------------------


@posix
@pytest.mark.parametrize(
    "module", ["cyclopts", "meshdepict.cli", "numpy", "meshdepict.scales.making", "llvmlite"]
)
def test_an_interruption_while_modules_load_is_one_line(ball_ply, module):
    """Python says on stderr what it has just imported."""
    command = [sys.executable, "-X", "importtime", "-m", "meshdepict", "bake", "ball.ply"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    with process:
        for line in process.stderr:
            if line.rstrip().endswith(f" {module}"):
                process.send_signal(signal.SIGINT)
                break
        rest = process.stderr.read()
        assert process.wait(timeout=60) == 130
    said = [line for line in rest.splitlines() if not line.startswith("import time:")]
    assert said == ["meshdepict: interrupted; no file was left half-written"]
    assert not Path("ball-exaggerated.ply").exists()


@posix
def test_an_interruption_that_a_library_swallowed_comes_again():
    code = """
import os, signal, sys, time
from meshdepict import __main__, cli

class Deaf:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)

def main():
    try:
        Deaf()
        time.sleep(20)
    except KeyboardInterrupt:
        print("heard")
        return 130
    return 0

cli.main = main
__main__.run()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "heard\n", "")


@posix
def test_where_interruptions_are_ignored_they_stay_ignored():
    code = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); from meshdepict import "
    code += "cli, __main__; cli.main = lambda: signal.raise_signal(signal.SIGINT) or 0; "
    done = subprocess.run([sys.executable, "-c", f"{code}__main__.run()"], timeout=60, check=False)
    assert done.returncode == 0


def test_the_command_begins_where_ctrl_c_is_answered():
    text = (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    assert 'meshdepict = "meshdepict.__main__:run"' in text


def test_next_to_nothing_is_imported_before_ctrl_c_is_answered():
    """Each of Python's own modules, such as ``signal``, takes milliseconds without an answer."""
    code = "import sys; before = set(sys.modules); import meshdepict.__main__; "
    code += "print(*sorted(set(sys.modules) - before))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert set(done.stdout.split()) <= {
        "__future__", "_signal", "meshdepict", "meshdepict.__main__", "os", "posix", "sys",
    }  # fmt: skip


# --- closed pipes -------------------------------------------------------------------------------


@posix
@pytest.mark.parametrize("words", ["methods", "methods lambert", "info ball.ply", "bake ball.ply"])
def test_a_reader_that_left_is_no_fault(ball_ply, words):
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as pipe:
        done = subprocess.run(
            [*COMMAND, *words.split(), "--quiet"], stdout=pipe, stderr=subprocess.PIPE, timeout=120
        )
    assert (done.returncode, done.stderr) == (141, b"")


@posix
def test_nobody_reads_the_errors_either(folder):
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "w") as pipe:
        command = [*COMMAND, "bake", "missing.ply"]
        assert subprocess.run(command, stdout=pipe, stderr=pipe, timeout=60).returncode == 2


@posix
@pytest.mark.parametrize(
    ("line", "status"),
    [("methods >&-", 0), ("methods >&- 2>&-", 0), ("bake missing.ply 2>&-", 2),
     ("bake missing.ply >&- 2>&-", 2)],
)  # fmt: skip
def test_streams_that_were_closed_before(folder, line, status):
    command = f'"{sys.executable}" -m meshdepict {line}'
    done = subprocess.run(command, shell=True, capture_output=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (status, b"", b"")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs Linux's /dev/full")
def test_a_full_disk_behind_stdout_is_one_line(folder):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*COMMAND, "methods"], stdout=full, stderr=subprocess.PIPE, timeout=60
        )
    said = b"meshdepict: the output: No space left on device\n"
    assert (done.returncode, done.stderr) == (2, said)


# --- one file, several names --------------------------------------------------------------------


@posix
def test_all_names_of_a_file_are_the_file(folder):
    Path("a").write_bytes(b"a")
    Path("other").write_bytes(b"a")
    os.link("a", "hard")
    Path("soft").symlink_to("a")
    assert {identity(name) for name in ("a", "./a", "hard", "soft")} == {identity("a")}
    assert identity("other") != identity("a")
    assert identity("missing") == identity("./missing")
    assert identities([Path("a"), None]) == {identity("a")}


@posix
@pytest.mark.parametrize("link", [os.link, os.symlink])
def test_an_output_that_is_a_link_to_an_input_needs_force(run, folder, link):
    """The input was baked before, so that this program may replace it but for that."""
    write_mesh("ball.ply", samples.sphere(42), colors=np.zeros((42, 3), np.uint8),
               comments=["meshdepict lambert"])  # fmt: skip
    link("ball.ply", "twin.ply")
    before = Path("ball.ply").read_bytes()
    status, out, err = run("bake", "ball.ply", "-m", "lambert", "-o", "twin.ply")
    assert (status, out) == (2, [])
    assert err == [
        "meshdepict: twin.ply is an input: choose another name, or replace it with --force"
    ]
    assert Path("ball.ply").read_bytes() == before
    assert run("bake", "ball.ply", "-m", "lambert", "-o", "twin.ply", "--force")[0] == 0


@posix
def test_a_ct_is_not_written_over_by_its_bake(run, folder):
    pytest.importorskip("SimpleITK")
    from meshdepict.io.volumes import write_volume
    from meshdepict.samples.phantom import ct_phantom

    volume = ct_phantom((12, 12, 12))
    write_volume("ct.nrrd", volume.values, volume, comments=["meshdepict phantom"])
    os.link("ct.nrrd", "twin.nrrd")
    for name in ("ct.nrrd", "twin.nrrd"):
        status, _, err = run("volume", "ct.nrrd", "-m", "lambert", "-o", name)
        assert status == 2
        assert err[-1] == (
            f"meshdepict: {name} is an input: choose another name, or replace it with --force"
        )


@posix
@pytest.mark.parametrize("suffix", [".ply", ".html", ".png"])
def test_a_pipe_in_the_outputs_place_is_not_looked_into(run, ball_ply, suffix):
    os.mkfifo(f"pipe{suffix}")
    output = ["-o", f"pipe{suffix}"] if suffix != ".png" else ["--picture", "pipe.png"]
    status, _, err = run("bake", "ball.ply", "-m", "lambert", *output)
    assert (status, len(err)) == (2, 1)
    assert "exists and was not written by meshdepict" in err[0]


# --- the browser --------------------------------------------------------------------------------


@posix
def test_a_token_is_in_a_file_for_its_owner_alone():
    with redirect("http://127.0.0.1:1234/?token=a&b") as url:
        path = Path(url.removeprefix("file://"))
        assert url.startswith("file://")
        assert "token" not in url
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        assert "http://127.0.0.1:1234/?token=a&amp;b" in path.read_text()
    assert not path.exists()


@posix
def test_a_browser_is_started_without_the_token(folder, ball_ply):
    """A browser that only writes down its command line and what the file there says."""
    pytest.importorskip("trame.app")
    browser = folder / "browser"
    browser.write_text('#!/bin/sh\necho "$@" > words\ncat "${1#file://}" > page\ntouch done\n')
    browser.chmod(0o755)
    code = (
        "import os, sys, time, pathlib; from meshdepict.viewer.browser import serve; "
        "from meshdepict.viewer.session import Session; import signal, threading\n"
        "def ready(address):\n"
        "    print(address, flush=True)\n"
        "    def wait():\n"
        "        while not pathlib.Path('done').exists(): time.sleep(0.05)\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "    threading.Thread(target=wait, daemon=True).start()\n"
        "serve(Session('ball.ply', scales=1), ready=ready)\n"
    )
    environment = {**os.environ, "BROWSER": f"{browser} %s"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=120
    )
    address = done.stdout.splitlines()[-1]
    token = address.split("token=")[1]
    words = Path("words").read_text()
    assert words.startswith("file://")
    assert token not in words
    assert address in Path("page").read_text()
    assert not Path(words.strip().removeprefix("file://")).exists()


# --- terminals ----------------------------------------------------------------------------------


def test_a_files_control_characters_never_reach_a_terminal(data, run, folder):
    shutil.copy(data / "cases" / "hostile" / "terminal-escape.ply", "a.ply")
    for words in (["info", "a.ply"], ["bake", "a.ply", "-m", "lambert", "-o", "b.ply"],
                  ["info", "b.ply"]):  # fmt: skip
        _, out, err = run(*words)  # which looks for escapes itself
        assert "\x07" not in "".join(out + err)


# --- memory -------------------------------------------------------------------------------------


def test_max_memory_bounds_what_a_packed_file_unpacks_to(run, ball_ply):
    write_mesh("ball.ply.gz", ball_ply)
    size = len(Path("ball.ply").read_bytes())
    words = ["bake", "ball.ply.gz", "-m", "lambert", "--max-memory"]
    status, _, err = run(*words, size // 2)
    assert (status, len(err)) == (2, 1)
    assert "ball.ply.gz unpacks to more than" in err[0]
    assert "--max-memory" in err[0]
    assert run(*words, "100MB")[0] == 0
    assert run("bake", "ball.ply.gz", "-m", "lambert")[0] == 0
    assert limits.allowance(1) == min(limits.LEAST, limits.max_memory())  # the next call's own


@pytest.mark.parametrize(
    "words", ["bake ball.ply", "info ball.ply", "methods", "compare ball.ply -o a.png",
              "movie ball.ply -o a.mp4", "view ball.ply", "volume -o a.vti"]
)  # fmt: skip
def test_max_memory_is_understood_everywhere(run, ball_ply, words):
    status, _, err = run(*words.split(), "--max-memory", "much")
    assert (status, err) == (
        2, ["meshdepict: max-memory 'much' is no amount of memory such as 4GB or 500MB"],
    )  # fmt: skip


@posix
def test_a_bomb_is_one_sentence(run, folder):
    import gzip

    with gzip.open("bomb.ply.gz", "wb", 9) as file:
        for _ in range(100):
            file.write(bytes(1 << 20))
    status, _, err = run("info", "bomb.ply.gz", "--max-memory", "10MB")
    assert (status, len(err)) == (2, 1)
    assert "bomb.ply.gz unpacks to more than 10 MB" in err[0]
    assert run("info", "bomb.ply.gz", "--max-memory", "200MB")[2] == [
        "meshdepict: bomb.ply.gz is no PLY file: it doesn't begin with the line 'ply'"
    ]
