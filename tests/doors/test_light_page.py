"""docs/light.md: its commands are run, and so is its Python."""

from __future__ import annotations

import re
import shlex

import numpy as np
from house import ROOT
from PIL import Image

import meshdepict as md
from meshdepict.cli import main
from meshdepict.io import write_mesh

PAGE = (ROOT / "docs" / "light.md").read_text(encoding="utf-8")


def test_its_commands_run(folder, capsys):
    for name, away in (("dragon", 0.0), ("vase", 2.5)):
        ball = md.samples.golf_ball(400, dimples=12)
        write_mesh(f"{name}.ply", md.Mesh(ball.vertices + np.array((away, 0, 0)), ball.faces))
    blocks = re.findall(r"^```sh\n(.*?)^```", PAGE, flags=re.S | re.M)
    commands = [line for block in blocks for line in block.splitlines()]
    assert len(commands) > 1
    for command in commands:
        program, *words = shlex.split(command, comments=True)
        assert program == "meshdepict"
        assert main(words) == 0, (command, capsys.readouterr().err)
        if "--picture" in words:
            assert (folder / words[words.index("--picture") + 1]).is_file()


def test_its_python_draws_a_scene_in_which_red_bleeds(folder):
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.S | re.M)
    assert blocks
    for block in blocks:
        exec(compile(block, "light.md", "exec"), {})
    red, green, _ = np.moveaxis(np.asarray(Image.open("scene.png"), float), 2, 0)
    white = green > 120  # the ball and the ground: the globe is darker
    assert (red[white] >= green[white] - 1).mean() > 0.99
    assert (red[white] > green[white] + 20).sum() > 500
