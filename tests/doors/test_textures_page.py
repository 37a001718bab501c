"""docs/textures.md: every command of it is run, and so is its Python."""

from __future__ import annotations

import re
import shlex

import pytest
from house import ROOT
from textured_shapes import globe, picture

from meshdepict import samples
from meshdepict.baking.textures import bake_texture
from meshdepict.cli import main
from meshdepict.io import write_mesh

PAGE = (ROOT / "docs" / "textures.md").read_text(encoding="utf-8")


def commands() -> list[str]:
    """The page's commands, in order."""
    blocks = re.findall(r"^```sh\n(.*?)^```", PAGE, flags=re.S | re.M)
    return [line for block in blocks for line in block.splitlines()]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("textures")
    bake_texture(globe(6, base=picture([[[200, 100, 50]]])), "lambert", size=64).save(
        folder / "find.obj"
    )
    write_mesh(folder / "reduced.ply", samples.sphere(100))
    return folder


@pytest.mark.parametrize("line", commands())
def test_a_command_of_the_page_runs(line, files, monkeypatch, capsys):
    monkeypatch.chdir(files)
    words = shlex.split(line, comments=True)
    assert words[:2] == ["meshdepict", "texture"]
    given = words[1:] if "--size" in words else [*words[1:], "--size", "256"]
    assert main([*given, "--quiet", "--force"]) == 0
    said = capsys.readouterr().out
    written = re.search(r"→ (\S+)", line)
    if written:
        assert said.startswith(f"{written[1]}: ")


def test_the_python_of_the_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for block in re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.S | re.M):
        exec(block, {})
    assert (tmp_path / "ball-east.glb").exists()


def test_the_page_names_every_atlas_and_every_map():
    from meshdepict.baking.texture_choices import ATLASES, MAPS

    for kind in ATLASES:
        assert f"--atlas {kind}" in PAGE
    for kind in set(MAPS) - {"color"}:
        assert f"--map {kind}" in PAGE
