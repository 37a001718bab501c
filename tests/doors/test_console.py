"""Messages on stderr: a bar for long work on a terminal, single lines, nothing of others."""

import io
import sys
import time
import warnings
from pathlib import Path

import pytest
from conftest import PATIENCE

import meshdepict as md
from meshdepict import console
from meshdepict.baking import batch
from meshdepict.cli import main
from meshdepict.io import read_mesh


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("quiet", [True, False])
def test_long_work_shows_a_bar_on_a_terminal(ball_ply, monkeypatch, capsys, quiet):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(console, "_PATIENCE", 0.0)

    def read(*_, **__):
        """Give the bar's thread the time to appear; where none should, a little."""
        end = time.monotonic() + (0.2 if quiet else PATIENCE)
        while not terminal.getvalue() and time.monotonic() < end:
            time.sleep(0.01)
        return ball_ply

    monkeypatch.setattr(batch, "as_solid", read)
    assert main(["bake", "ball.ply", *["--quiet"] * quiet]) == 0
    assert ("ball.ply" in terminal.getvalue()) is not quiet
    assert capsys.readouterr().out.startswith("ball-exaggerated.ply: ")


def test_short_work_shows_no_bar(ball_ply, monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(console, "_PATIENCE", 60.0)
    assert main(["bake", "ball.ply"]) == 0
    assert terminal.getvalue() == ""


def test_the_warnings_of_others_stay_away(run, ball_ply, monkeypatch):
    def read(path, **_):
        warnings.warn("about\nnothing", RuntimeWarning, stacklevel=1)
        warnings.warn("about\nthe mesh", md.MeshdepictWarning, stacklevel=1)
        return read_mesh(path)

    monkeypatch.setattr(batch, "as_solid", read)
    status, _, err = run("bake", "ball.ply")
    assert (status, err) == (0, ["meshdepict: note: ball.ply: about the mesh"])


def test_notes_that_repeat_in_a_batch_are_said_once_and_counted(run, ball_ply, monkeypatch):
    names = ["a.ply", "b.ply", "c.ply", "d.ply"]
    for name in names:
        Path(name).write_bytes(Path("ball.ply").read_bytes())

    def read(path, **_):
        odd = {"a.ply": "12 vertices are odd", "b.ply": "1,300.5 vertices are odd"}
        text = odd.get(path.name, "all is even")
        warnings.warn(f"{path}: {text}", md.MeshdepictWarning, stacklevel=1)
        return read_mesh(path)

    monkeypatch.setattr(batch, "as_solid", read)
    status, out, err = run("bake", *names)
    assert (status, len(out)) == (0, 4)
    assert err == [
        "meshdepict: note: a.ply: 12 vertices are odd",
        "meshdepict: note: c.ply: all is even",
        "meshdepict: note: of 1 more file, too: 12 vertices are odd",
        "meshdepict: note: of 1 more file, too: all is even",
        "meshdepict: 4 of 4 baked",
    ]
    assert run("bake", *names, "--quiet")[2] == []


def test_a_message_names_its_file_once():
    path = Path("a")
    assert console.about(path, "a is empty") == "a is empty"
    assert console.about(path, "a: no") == "a: no"
    assert console.about(path, "albedo is missing") == "a: albedo is missing"
    assert console.about(None, "no") == "no"
