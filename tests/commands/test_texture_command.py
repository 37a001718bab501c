"""``meshdepict texture``: from a mesh to its texture, by one command."""

import numpy as np
import pytest
from PIL import Image
from textured_shapes import globe, sheet

from meshdepict import samples
from meshdepict.baking.recipe import load_recipe
from meshdepict.baking.textures import bake_texture
from meshdepict.cli import main
from meshdepict.io import read_mesh, read_provenance, write_mesh


@pytest.fixture
def ball(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_mesh("ball.ply", samples.golf_ball(400))
    return "ball.ply"


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def test_one_word_writes_a_glb_and_one_line(ball, capsys):
    assert main(["texture", ball, "--size", "256", "--quiet"]) == 0
    line = capsys.readouterr().out
    assert line.startswith("ball-exaggerated.glb: exaggerated, light northwest")
    assert "9 scales, widths" in line
    assert "256 x 256 texels" in line
    found = read_mesh("ball-exaggerated.glb")
    assert found.textures.base_colors[0].pixels.shape == (256, 256, 3)
    assert any(
        "texture: color, 256 x 256" in words for words in read_provenance("ball-exaggerated.glb")
    )


def test_the_command_and_the_function_give_the_same_picture(ball):
    words = ["-m", "lambert", "--light", "east", "--view", "front", "--up", "y", "-o", "a.png"]
    assert main(["texture", ball, "--size", "200", "--quiet", *words]) == 0
    wanted = bake_texture(ball, "lambert", size=200, light="east").image
    assert np.array_equal(pixels("a.png"), wanted)


@pytest.mark.parametrize("kind", ["normal", "curvature", "occlusion"])
def test_maps_are_pictures(ball, kind, capsys):
    words = ["--set", "rays=16"] if kind == "occlusion" else []
    assert main(["texture", ball, "--size", "128", "--map", kind, "--quiet", *words]) == 0
    assert capsys.readouterr().out.startswith(f"ball-{kind}.png: map of {kind}, ")
    assert pixels(f"ball-{kind}.png").shape == (128, 128, 3)


def test_detail_comes_from_a_finer_file(ball, capsys):
    write_mesh("coarse.ply", samples.sphere(100))
    words = ["--detail", ball, "--cage", "10%", "--size", "256", "-o", "c.png", "--quiet"]
    assert main(["texture", "coarse.ply", *words]) == 0
    assert np.ptp(pixels("c.png")) > 100


def test_a_recipe_gives_the_same_texture(ball):
    said = ["-m", "lambert", "--light", "west"]
    assert (
        main(
            [
                "texture",
                ball,
                "--size",
                "128",
                *said,
                "--save-recipe",
                "r.toml",
                "-o",
                "a.png",
                "--quiet",
            ]
        )
        == 0
    )
    assert load_recipe("r.toml")["method"] == "lambert"
    assert (
        main(["texture", ball, "--size", "128", "--recipe", "r.toml", "-o", "b.png", "--quiet"])
        == 0
    )
    assert np.array_equal(pixels("a.png"), pixels("b.png"))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "which mesh?"),
        (["nowhere.obj"], "nowhere.obj"),
        (["ball.ply", "-o", "a.stl"], "textures are saved with their mesh as .glb"),
        (["ball.ply", "--map", "normal", "-o", "a.glb"], "a map of normal goes into a picture"),
        (["ball.ply", "--map", "normal", "-m", "phong"], "leave phong out"),
        (["ball.ply", "--map", "occlusion", "--colormap", "viridis"], "leave it out"),
        (["ball.ply", "--size", "7"], "size=7 is not a whole number from 16"),
        (["ball.ply", "--size", "2.5"], "is not a whole number"),
        (["ball.ply", "--size", "64"], "have no room on 64 x 64 texels: take --size 128"),
        (["ball.ply", "--atlas", "own"], "no texture coordinates"),
        (["ball.ply", "--cage", "1%"], "give detail, too"),
        (["ball.ply", "--detail", "no.ply"], "no.ply"),
        (["ball.ply", "--albedo", "keep", "--size", "256"], "own vertex colours"),
        (["ball.ply", "-o", "nowhere/a.glb"], "there is no folder nowhere"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_one_line_and_nothing_is_written(ball, tmp_path, words, said, capsys):
    assert main(["texture", *words, "--quiet"]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert [p.name for p in tmp_path.iterdir()] == [ball]


def test_others_files_are_kept_unless_forced(ball, capsys):
    Image.new("RGB", (3, 3)).save("a.png")
    words = ["texture", ball, "-m", "lambert", "--size", "128", "-o", "a.png", "--quiet"]
    assert main(words) == 2
    assert "was not written by meshdepict" in capsys.readouterr().err
    assert main([*words, "--force"]) == 0
    assert main(words) == 0  # it is ours now


def test_overlaps_are_one_line_until_a_new_atlas_is_asked_for(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    folded = sheet(6)
    textures = folded.textures
    vars(textures)["texcoords"] = np.abs(folded.texcoords - (0.5, 0))
    vars(textures)["base_colors"] = bake_texture(sheet(1), size=16).mesh.textures.base_colors
    from meshdepict.io.textured import write_textured

    write_textured("folded.obj", folded.with_textures(textures))
    assert main(["texture", "folded.obj", "--size", "128", "--quiet"]) == 2
    assert "overlap in texture coordinates" in capsys.readouterr().err
    assert main(["texture", "folded.obj", "--size", "128", "--atlas", "new", "--quiet"]) == 0


def test_a_mesh_with_coordinates_keeps_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bake_texture(globe(4), size=64).save("globe.obj")
    assert (
        main(["texture", "globe.obj", "-m", "lambert", "--size", "64", "-o", "b.obj", "--quiet"])
        == 0
    )
    assert np.allclose(read_mesh("b.obj").texcoords, globe(4).texcoords, atol=1e-7)


def test_pictures_are_packed_as_asked(ball, capsys):
    words = ["--size", "128", "--image", "webp", "--quality", "70", "-o", "w.glb", "--quiet"]
    assert main(["texture", ball, *words]) == 0
    assert read_mesh("w.glb").textures.base_colors[0].kind == "webp"
    capsys.readouterr()
    assert main(["texture", ball, "--size", "128", "--quality", "70"]) == 2
    assert "quality=70 is of jpeg and webp: png is exact" in capsys.readouterr().err
