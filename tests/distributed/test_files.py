"""A batch leaves what is done alone, by what the files say of themselves."""

import os
import shutil

import pytest
from side_pools import WorkersHere, rows_of

from meshdepict import samples
from meshdepict.baking.look import Look
from meshdepict.distributed.files import FileBatch, Task, bake_file
from meshdepict.io import read_provenance, write_mesh


@pytest.fixture
def finds(folder):
    """Three finds and a broken file between them."""
    paths = []
    for name, count in (("a", 300), ("c", 400), ("d", 500)):
        write_mesh(f"{name}.ply", samples.golf_ball(count, dimples=12))
        paths.append(folder / f"{name}.ply")
    (folder / "b.ply").write_text("ply\nbroken")
    return [paths[0], folder / "b.ply", *paths[1:]]


def batch(paths, look=None, **more):
    look = Look("lambert") if look is None else look
    return FileBatch(inputs=paths, look=look, output="out/", workers=WorkersHere(), **more)


def summary(capsys):
    return capsys.readouterr().err.splitlines()[-1].removeprefix("meshdepict: ")


def test_one_failure_stops_no_other_and_what_is_done_is_skipped(finds, folder, capsys):
    assert batch(finds).run() == 1
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 3
    assert "b.ply is cut off" in err
    assert err.splitlines()[-1] == "meshdepict: 3 baked, 0 done before, 1 failed"
    before = {path.name: path.stat().st_ino for path in (folder / "out").iterdir()}
    assert sorted(before) == [f"{name}-lambert.ply" for name in "acd"]
    assert batch(finds).run() == 1
    assert summary(capsys) == "0 baked, 3 done before, 1 failed"
    assert before == {path.name: path.stat().st_ino for path in (folder / "out").iterdir()}


def test_dates_and_names_do_not_count_but_bytes_and_looks_do(finds, folder, capsys):
    good = [finds[0], finds[2]]
    batch(good).run()
    os.utime(finds[0])
    assert batch(good).run() == 0
    assert summary(capsys) == "0 baked, 2 done before, 0 failed"
    shutil.copy(finds[3], finds[0])  # other bytes
    assert batch(good).run() == 0
    assert summary(capsys) == "1 baked, 1 done before, 0 failed"
    batch(good, Look("lambert", light="east")).run()
    assert summary(capsys) == "2 baked, 0 done before, 0 failed"
    batch(good, Look("lambert", light="east"), again=True).run()
    assert summary(capsys) == "2 baked, 0 done before, 0 failed"
    (folder / "out" / "a-lambert.ply").write_text("half")
    batch(good, Look("lambert", light="east"), force=True).run()
    assert summary(capsys) == "2 baked, 0 done before, 0 failed"  # after `again`, without a mark


def test_what_is_baked_is_what_bake_gives(finds, folder):
    batch([finds[0]]).run()
    Look("lambert").bake(finds[0]).save("single.ply")
    out = folder / "out" / "a-lambert.ply"
    assert rows_of(out) == rows_of(folder / "single.ply")
    lines = read_provenance(out)
    assert [line for line in lines if "made by" not in line] == read_provenance("single.ply")


def test_what_a_killed_process_left_is_taken_away(finds, folder):
    out = folder / "out"
    out.mkdir()
    (out / ".a-lambert.ply.0123abcd.part").write_text("half")
    (out / ".a-lambert.ply.xyz.tiles").mkdir()
    (out / ".other.0123abcd.part").write_text("another's")
    batch([finds[0]]).run()
    assert sorted(os.listdir(out)) == [".other.0123abcd.part", "a-lambert.ply"]


def test_by_tiles_the_same_holds(finds, capsys):
    again = batch(finds, tiles=1_000)
    assert again.run() == 1
    assert summary(capsys) == "3 baked, 0 done before, 1 failed"
    assert again.run() == 1
    assert summary(capsys) == "0 baked, 3 done before, 1 failed"
    auto = batch([finds[0]], Look("lambert", view="auto", up="auto"), tiles=1_000)
    auto.run()
    assert "front and y are taken" in capsys.readouterr().err


def test_an_input_that_went_away_is_a_sentence(finds, folder):
    one = batch([finds[0]])
    (job,) = one.jobs()
    finds[0].unlink()
    with pytest.raises(ValueError, match=r"a\.ply can't be read: No such file"):
        bake_file(Task(one, job, "x"))


# --- the command --------------------------------------------------------------------------------


def test_the_command_says_what_it_wants(run, ball_ply):
    for words, said in (
        ((), "which files?"),
        (("ball.ply", "--dpi", 100), "give --picture, too"),
        (("ball.ply", "--tiles", 5_000, "--picture", "a.png"), "shows the whole mesh"),
        (("ball.ply", "--tiles", 5), "makes no sense"),
        (("ball.ply", "--workers", 0), "at least one"),
        (("ball.ply", "nowhere.ply", "-o", "out.ply"), "no existing folder"),
    ):
        status, out, err = run("batch", *words)
        assert (status, out) == (2, [])
        assert said in err[-1]


@pytest.mark.slow
def test_the_command_bakes_by_processes_and_goes_on(run, ball_ply, folder):
    words = ("batch", "ball.ply", "--method", "lambert", "--workers", 1, "--picture", "ball.png")
    status, out, err = run(*words)
    assert (status, len(out)) == (0, 1)
    assert out[0].startswith("ball-lambert.ply: lambert")
    assert "picture ball.png" in out[0]
    assert err[-1] == "meshdepict: 1 baked, 0 done before, 0 failed"
    status, out, err = run(*words)
    assert (status, out) == (0, [])
    assert err == ["meshdepict: 0 baked, 1 done before, 0 failed"]
    (folder / "ball.png").unlink()
    status, out, err = run(*words)
    assert err[-1] == "meshdepict: 1 baked, 0 done before, 0 failed"
