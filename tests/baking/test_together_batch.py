"""``meshdepict bake a b --together``: a file of each, one picture, all or nothing."""

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict.io import read_provenance, write_mesh


@pytest.fixture
def two(folder):
    """A torus, and a ball in the light that it gets, as files in the current folder."""
    torus, ball = md.samples.torus(500), md.samples.golf_ball(500, dimples=12)
    ball = md.Mesh(ball.vertices + np.array((-2.6, 0.3, 0.2)), ball.faces)
    write_mesh("torus.ply", torus)
    write_mesh("ball.ply", ball)
    return [md.read_mesh("torus.ply"), md.read_mesh("ball.ply")]


WORDS = ("-m", "lambert", "--set", "shadows=true", "--set", "bounces=2", "--view", "front",
         "--up", "y")  # fmt: skip


def colors(path):
    vertex = md.read_mesh(path).attributes["vertex"]
    return np.stack([vertex[name] for name in ("red", "green", "blue")], axis=1)


def test_it_writes_what_the_library_bakes(run, two):
    status, out, err = run("bake", "torus.ply", "ball.ply", "--together", *WORDS, "--quiet")
    assert (status, err) == (0, [])
    assert [line.partition(":")[0] for line in out] == ["torus-lambert.ply", "ball-lambert.ply"]
    baked = md.bake_together(two, "lambert", shadows=True, bounces=2)
    for name, each in zip(("torus", "ball"), baked, strict=True):
        np.testing.assert_array_equal(colors(f"{name}-lambert.ply"), each.colors)
        assert any("together: with" in line for line in read_provenance(f"{name}-lambert.ply"))


def test_the_picture_is_one_of_all(run, two, folder):
    (folder / "out").mkdir()
    status, out, _ = run(
        "bake", "torus.ply", "ball.ply", "--together", *WORDS, "-o", "out", "--picture", "all.png",
        "--size", "200x100",
    )  # fmt: skip
    assert status == 0
    assert "picture all.png" in out[-1]
    assert sum("picture" in line for line in out) == 1
    pixels = np.asarray(Image.open("all.png").convert("L"))
    inked = np.flatnonzero((pixels < 250).any(axis=0))
    gaps = np.flatnonzero(np.diff(inked) > 1)
    assert len(gaps) == 1  # two objects side by side


def test_the_picture_of_a_folder_is_named_after_all(run, two, folder):
    run("bake", "torus.ply", "ball.ply", "--together", *WORDS, "--picture", "p/")
    assert (folder / "p" / "torus-ball-lambert.png").exists()
    for name in "abc":
        write_mesh(f"{name}.ply", two[0])
    run("bake", "a.ply", "b.ply", "c.ply", "ball.ply", "--together", *WORDS, "--picture", "p/")
    assert (folder / "p" / "a-b-2-more-lambert.png").exists()


def test_they_stand_on_one_ground(run, two):
    status, _, err = run(
        "bake",
        "torus.ply",
        "ball.ply",
        "--together",
        "--ground",
        *WORDS,
        "--picture",
        "all.png",
        "--quiet",
    )
    assert (status, err) == (0, [])
    assert any("ground: matt" in line for line in read_provenance("ball-lambert.ply"))


def test_a_width_in_pixels_is_of_the_picture_of_all(run, two):
    status, out, _ = run(
        "bake", "torus.ply", "ball.ply", "--together", "--width", "4px", "--picture", "all.png",
        "--view", "front", "--up", "y", "--size", "300x300",
    )  # fmt: skip
    assert status == 0
    first, second = (line.partition("widths ")[2].split()[0] for line in out)
    assert first == second
    scene = np.ptp(np.concatenate([mesh.vertices for mesh in two])[:, 0])
    assert float(first) == pytest.approx(4 * 1.05 * scene / 300, rel=0.01)


def test_where_one_is_missing_nothing_is_baked(run, two, folder):
    status, out, err = run("bake", "torus.ply", "lost.ply", "--together", *WORDS)
    assert (status, out) == (2, [])
    assert err == ["meshdepict: lost.ply: there is no such file",
                   "meshdepict: nothing is baked: all of them are needed together"]  # fmt: skip
    (folder / "bad.ply").write_text("ply\n")
    status, out, err = run("bake", "torus.ply", "bad.ply", "--together", *WORDS)
    assert (status, out) == (2, [])
    assert "bad.ply" in err[0]
    assert not (folder / "torus-lambert.ply").exists()


def test_one_alone_terrain_and_files_for_several_are_refused(run, two, folder):
    status, _, err = run("bake", "torus.ply", "--together")
    assert status == 2
    assert "--together is about several meshes: give at least two, or leave it" in err[0]
    np.save("hill.npy", np.eye(5))
    status, _, err = run("bake", "torus.ply", "hill.npy", "--together", *WORDS, "--quiet")
    assert status == 2
    assert err == ["meshdepict: hill.npy: only meshes stand together, not terrain"]
    status, _, err = run("bake", "torus.ply", "ball.ply", "--together", "-o", "one.ply")
    assert status == 2
    assert "is no existing folder: several meshes need one" in err[0]
    status, _, err = run(
        "bake", "torus.ply", "ball.ply", "--together", "--albedo", "keep", "--quiet"
    )
    assert status == 2
    assert "torus.ply: albedo='keep' needs the object's own vertex colours" in err[0]


def test_a_fault_of_the_programs_and_full_memory_are_said(run, two, monkeypatch):
    from meshdepict.baking import together_batch

    def broken(*_, **__):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(together_batch, "bake_objects", broken)
    status, out, err = run("bake", "torus.ply", "ball.ply", "--together", *WORDS)
    assert (status, out) == (2, [])
    assert "an unexpected fault, please report it (ZeroDivisionError: division by zero)" in err[0]

    def full(*_, **__):
        raise MemoryError

    monkeypatch.setattr(together_batch, "bake_objects", full)
    status, out, err = run("bake", "torus.ply", "ball.ply", "--together", *WORDS)
    assert (status, out) == (2, [])
    assert "out of memory" in err[0]
