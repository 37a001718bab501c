"""`meshdepict plate`: words in, one page out, nobody's file replaced."""

import pytest

from meshdepict.drawing.picture_files import read_picture_provenance


def test_a_plate_of_a_file(run, ball_ply, folder):
    words = ["plate", "ball.ply", "-m", "lambert", "-m", "exaggerated", "--light", "west",
             "--light", "300,20", "--views", "front,right", "--size", "10x12cm", "--dpi", "100",
             "--unit", "mm", "--set", "exaggerated.exaggeration=20", "-o", "plate.svg"]  # fmt: skip
    status, (line,), err = run(*words)
    assert (status, err) == (0, [])
    assert line.startswith("plate.svg: lambert, exaggerated, light west, 300,20, ")
    assert " pixels per mm, " in line
    said = "\n".join(read_picture_provenance("plate.svg"))
    assert "exaggeration=20" in said
    assert said.count("light: west") == 2
    assert run(*words)[0] == 0  # ours: replaced
    (folder / "plate.svg").write_text("<svg/>")
    status, _, (line,) = run(*words)
    assert status == 2
    assert "plate.svg exists and was not written by meshdepict" in line
    assert run(*words, "--force")[0] == 0


def test_names_and_an_option_without_its_method(run, ball_ply, folder):
    words = ["--size", "300x400", "--set", "exaggeration=20"]
    assert run("plate", "ball.ply", *words)[0] == 0
    said = "\n".join(read_picture_provenance("ball-plate.png"))
    assert "exaggeration=20" in said
    assert "view: main " in said
    (folder / "out").mkdir()
    assert run("plate", "ball.ply", "-o", "out", *words)[0] == 0
    assert (folder / "out" / "ball-plate.png").exists()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("-o plate.tif", "end the name with .png, .jpg, .svg or .pdf"),
        ("-o plate.jpg --background transparent", "a JPEG has no transparency"),
        ("--scale 1:2", "needs the unit of the coordinates"),
        ("--views front,over", "'over' is no turn of the main view"),
        ("--set nonsense", "--set wants name=value"),
        ("-m lambert -m toon --set exposure=1", "--set wants METHOD.name=value"),
        ("--size A9", "is not WIDTHxHEIGHT"),
        ("-m nonsense", "nonsense"),
    ],
)
def test_what_is_refused_writes_nothing(run, ball_ply, folder, words, sentence):
    status, out, (line,) = run("plate", "ball.ply", *words.split())
    assert (status, out) == (2, [])
    assert sentence in line
    assert [path.name for path in folder.iterdir()] == ["ball.ply"]


def test_a_missing_file_is_named(run):
    status, _, (line,) = run("plate", "gone.ply")
    assert status == 2
    assert "gone.ply" in line
