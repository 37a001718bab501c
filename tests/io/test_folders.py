"""A folder that is given for a file names the files in it."""

from __future__ import annotations

import pytest

from meshdepict.io.folders import MAPS, SCANS, held
from meshdepict.io.source import MESHES


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ((), ""),
        (("notes.txt", "a.docx"), ""),
        (("a.ply",), "; did you mean {}/a.ply?"),
        (("a.PLY", "b.ply", "read.me"), "; for its 2 meshes give {}/*.ply"),
        (("a.ply.gz", "b.ply.gz"), "; for its 2 meshes give {}/*.ply.gz"),
        (("a.ply", "b.ply", "c.obj"), "; for its 2 meshes of one kind give {}/*.ply"),
        (("b.obj", "a.ply"), "; did you mean {}/a.ply?"),
        (("a.tif", "b.tif", "a.tfw"), "; for its 2 elevation models give {}/*.tif"),
        (("a.tif", "b.tif", "a.stl"), "; did you mean {}/a.stl?"),  # meshes were asked for first
        (("head.nii.gz",), "; did you mean {}/head.nii.gz?"),
    ],
)
def test_the_first_kind_that_is_there_is_named(folder, names, words):
    for name in names:
        (folder / name).write_bytes(b"x")
    assert held(folder, MESHES | MAPS | SCANS) == words.format(folder)


def test_no_folder_holds_nothing(folder):
    assert held(folder / "gone", MESHES) == ""


@pytest.mark.parametrize(
    "words",
    ["bake heaps", "info heaps", "compare heaps -m lambert", "plate heaps", "relief heaps"],
)
def test_every_command_names_the_terrain_of_a_folder(run, folder, words):
    (folder / "heaps").mkdir()
    (folder / "heaps/a.asc").write_text("ncols 2")
    status, _, err = run(*words.split())
    assert status == 2
    assert "did you mean heaps/a.asc?" in err[-1]
