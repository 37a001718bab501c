"""``meshdepict relief``: from an elevation model to relief on its grid, by one command."""

import numpy as np
import pytest

from meshdepict.baking.recipe import load_recipe
from meshdepict.cli import main


@pytest.fixture
def dem(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    y, x = np.mgrid[:60, :80]
    np.save("hills.npy", (5 * np.sin(x / 9) * np.cos(y / 7)).astype(np.float32))
    return "hills.npy"


def test_one_word_writes_relief_and_one_line(dem, capsys):
    rasterio = pytest.importorskip("rasterio")
    assert main(["relief", dem, "--quiet"]) == 0
    line = capsys.readouterr().out
    assert line.startswith("hills-exaggerated.tif: exaggerated, light northwest")
    assert "9 scales, widths 1 to 16 m, 80 x 60 cells" in line
    with rasterio.open("hills-exaggerated.tif") as file:
        assert (file.width, file.height) == (80, 60)
        assert [band.name for band in file.colorinterp] == ["gray", "alpha"]


def test_a_light_is_given_as_on_maps(dem, capsys):
    assert main(["relief", dem, "--light", "315/45", "-o", "a.png", "--quiet"]) == 0
    assert "azimuth 315 elevation 45" in capsys.readouterr().out
    assert main(["relief", dem, "--light", "315,45", "-o", "b.png", "--quiet"]) == 0
    from PIL import Image

    with Image.open("a.png") as a, Image.open("b.png") as b:
        assert np.array_equal(np.asarray(a), np.asarray(b))


def test_a_recipe_gives_the_same_relief(dem):
    assert (
        main(
            [
                "relief",
                dem,
                "-m",
                "exaggerated",
                "-o",
                "a.png",
                "--save-recipe",
                "a.toml",
                "--quiet",
            ]
        )
        == 0
    )
    assert main(["relief", dem, "--recipe", "a.toml", "-o", "b.png", "--quiet"]) == 0
    from PIL import Image

    with Image.open("a.png") as a, Image.open("b.png") as b:
        assert np.array_equal(np.asarray(a), np.asarray(b))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "which elevation model"),
        (["hills.npy", "-o", "relief.ply"], "relief is written as GeoTIFF, PNG or JPEG"),
        (["hills.npy", "-o", "nowhere/relief.png"], "no folder"),
        (["none.tif"], "none.tif"),
        (["hills.npy", "-m", "hilshade", "-o", "a.png"], "hillshade"),
        (["hills.npy", "--z-factor", "0", "-o", "a.png"], "z_factor"),
        (["hills.npy", "--values", "-o", "a.png"], "values"),
        (["hills.npy", "--band", "2", "-o", "a.png"], "band"),
        (["hills.npy", "--height-unit", "ell", "-o", "a.png"], "ell"),
    ],
)
def test_wrong_words_get_one_sentence(dem, capsys, words, said):
    assert main(["relief", *words]) == 2
    error = capsys.readouterr().err
    assert said in error.replace("-", "_") or said in error
    assert error.count("\n") <= 2


def test_a_file_of_others_is_kept(dem, capsys):
    from pathlib import Path

    Path("a.png").write_bytes(b"mine")
    assert main(["relief", dem, "-o", "a.png", "--quiet"]) == 2
    assert Path("a.png").read_bytes() == b"mine"
    assert main(["relief", dem, "-o", "a.png", "--quiet", "--force"]) == 0


def test_tiles_are_one_model(dem, capsys):
    rasterio = pytest.importorskip("rasterio")
    z = np.load(dem)
    for name, columns in (("west.tif", slice(0, 40)), ("east.tif", slice(40, 80))):
        with rasterio.open(
            name, "w", driver="GTiff", height=60, width=40, count=1, dtype="float32",
            transform=rasterio.Affine(1, 0, columns.start, 0, -1, 60), crs="EPSG:3794",
        ) as file:  # fmt: skip
            file.write(z[:, columns], 1)
    assert main(["relief", "west.tif", "east.tif", "-o", "both.png", "--quiet"]) == 0
    assert main(["relief", dem, "-o", "one.png", "--quiet"]) == 0
    from PIL import Image

    with Image.open("both.png") as both, Image.open("one.png") as one:
        assert np.array_equal(np.asarray(both), np.asarray(one))


def test_a_recipe_holds_what_was_said_and_fits_every_model_anew(dem):
    words = ["-o", "a.png", "--scales", "2", "--quiet"]
    assert main(["relief", dem, *words, "--save-recipe", "look.toml"]) == 0
    look = load_recipe("look.toml")
    assert look["scales"] == 2
    assert "exaggeration" not in look  # it follows the terrain
    np.save("steep.npy", 20 * np.load(dem))
    for words in (["--scales", "2"], ["--recipe", "look.toml"]):
        assert main(["relief", "steep.npy", *words, "-o", f"{words[0][2:]}.png", "--quiet"]) == 0
    from PIL import Image

    with Image.open("scales.png") as own, Image.open("recipe.png") as told:
        assert np.array_equal(np.asarray(own), np.asarray(told))
