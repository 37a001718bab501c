"""The command line at the extremes: a picture, or status 1 and one sentence."""

from __future__ import annotations

import numpy as np
import pytest
from odd_meshes import SMALL

import meshdepict as md
from meshdepict.io import write_mesh


@pytest.mark.parametrize("name", ["one triangle", "one point", "a Möbius strip", "1e149"])
def test_odd_meshes_are_baked(name, run, folder):
    write_mesh("odd.ply", md.Mesh(*SMALL[name]()))
    status, _, err = run("bake", "odd.ply", "-o", "out.ply", "--set", "exaggeration=1e30")
    assert status == 0
    assert (folder / "out.ply").exists()
    assert not any("rror" in line for line in err)


def as_text(vertices, face="3 0 1 2"):
    rows = "\n".join(" ".join(map(str, row)) for row in vertices)
    return (
        f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face 1\nproperty list uchar int vertex_indices\nend_header\n{rows}\n{face}\n"
    )


TRIANGLE = np.eye(3)
LATE = [
    (as_text(np.full((3, 3), "nan")), (), "NaN or infinite"),
    (as_text(TRIANGLE * 1e200), (), "leave no room for computing"),
    (as_text(TRIANGLE * 1e-200), (), "leaves no room for computing"),
    (as_text(TRIANGLE, "3 0 1 7"), (), "vertex 7"),
    (as_text(TRIANGLE), ("--width", "0"), "is not a positive length"),
    (as_text(TRIANGLE), ("--width", "nan"), "is not a positive length"),
    (as_text(TRIANGLE), ("--scales", "65"), "0 to 64"),
    (as_text(TRIANGLE), ("--set", "exaggeration=2e30"), "0 … 1e+30"),
    (as_text(TRIANGLE), ("--set", "exaggeration=nan"), "0 … 1e+30"),
    (as_text(TRIANGLE), ("--light", "nan,0"), "light"),
    (as_text(TRIANGLE), ("--tolerance", "1"), "1e-7 to 0.1"),
]


@pytest.mark.parametrize(("text", "words", "said"), LATE)
def test_what_is_beyond_ends_in_one_sentence(text, words, said, run, folder):
    (folder / "odd.ply").write_text(text)
    status, out, err = run("bake", "odd.ply", "-o", "out.ply", *words)
    assert status != 0
    assert said in " ".join(err)
    assert not (folder / "out.ply").exists()
    assert out == []


@pytest.mark.parametrize(
    ("z", "said"),
    [(np.full((4, 4), np.nan), "holds no heights"), (np.full((4, 4), 1e35), "holds no heights")],
)
def test_terrain_beyond_ends_in_one_sentence(z, said, run, folder):
    np.save("odd.npy", z)
    status, _, err = run("relief", "odd.npy", "-o", "out.png")
    assert status != 0
    assert said in " ".join(err)
    assert not (folder / "out.png").exists()


@pytest.mark.parametrize(
    ("values", "said"),
    [(np.zeros((3, 3, 3)), "constant"), (np.full((3, 3, 3), np.nan), "NaN"),
     (np.arange(3.0).reshape(1, 1, 3), "single slice")],
)  # fmt: skip
def test_volumes_beyond_end_in_one_sentence(values, said, run, folder):
    np.save("odd.npy", values)
    status, _, err = run("volume", "odd.npy", "-o", "out.vti")
    assert status != 0
    assert said in " ".join(err)
    assert not (folder / "out.vti").exists()
