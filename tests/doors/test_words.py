"""What somebody else wrote into a file, or called it, steers no terminal."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path

import pytest

from meshdepict.errors import MeshdepictError, MeshdepictWarning, printable
from meshdepict.io import read_mesh

ESCAPE = "\x1b]0;pwned\x07\x1b[31m"
PLY = (
    "ply\nformat ascii 1.0\ncomment meshdepict {0}\nelement vertex 3\nproperty float x\n"
    "property float y\nproperty float z\nproperty float {0}\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0 {1}\n1 0 0 1\n0 1 0 1\n3 0 1 2\n"
)


def controls(text: str) -> list[str]:
    """The characters of a text that are seen by nobody."""
    return [letter for letter in text if unicodedata.category(letter) in ("Cc", "Cf", "Zl", "Zp")]


def test_every_control_character_is_spelled_out_and_nothing_else_changes():
    for code in range(0x3000):
        letter = chr(code)
        shown = printable(letter)
        if letter in "\t\n\v\f\r":
            assert shown == " "
        elif unicodedata.category(letter) in ("Cc", "Zl", "Zp") or 0x202A <= code <= 0x202E:
            assert re.fullmatch(r"\\(x[0-9a-f]{2}|u[0-9a-f]{4})", shown)
        elif unicodedata.category(letter) != "Cf":
            assert shown == letter
    assert printable("a\nb\x1b", keep="\n") == "a\nb\\x1b"


@pytest.mark.parametrize("kind", [MeshdepictError, MeshdepictWarning])
def test_errors_and_warnings_are_printable_from_the_start(kind):
    assert str(kind(f"name {ESCAPE}")) == "name \\x1b]0;pwned\\x07\\x1b[31m"
    assert str(kind("one\nline")) == "one line"


@pytest.mark.parametrize("command", ["info", "bake"])
def test_no_command_passes_them_on(run, folder, command):
    for value in ("1", "what?"):
        Path("escape.ply").write_text(PLY.format(ESCAPE, value))
        status, out, err = run(command, "escape.ply")
        assert (status, controls("".join(out + err))) == (0, [])
    broken = Path(f"{ESCAPE.replace('/', '')}.ply")
    broken.write_text(PLY.format(ESCAPE, 1).replace("element vertex 3", f"{ESCAPE} 3"))
    status, out, err = run(command, str(broken))
    assert (status, controls("".join(out + err))) == (2, [])
    assert len(err) == 1
    assert "pwned" in err[0]


def test_the_notes_of_a_file_are_one_line(run, folder):
    """An odd property, what follows the rows, and what shading makes of doubled faces."""
    text = PLY.format("quality", "what?").replace("element face 1", "element face 2")
    Path("odd.ply").write_text(text + "3 2 1 0\nand more\n")
    status, _, err = run("bake", "odd.ply", "-m", "lambert")
    assert status == 0
    assert len(err) == 1
    assert err[0].startswith("meshdepict: note: odd.ply ")
    for said in ("goes on after", "'what?' for a number in 'quality'", "1 faces are there twice"):
        assert said in err[0]


def test_the_hostile_file_is_read_and_its_property_kept(data):
    mesh = read_mesh(data / "cases" / "hostile" / "terminal-escape.ply")
    assert list(mesh.attributes["vertex"]) == [ESCAPE]
