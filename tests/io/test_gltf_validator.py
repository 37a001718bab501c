"""Khronos' own validator finds nothing wrong with what is written.

It needs node and ``npm install gltf-validator``, see `node_packages`; else these tests are skipped.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_builder import Builder
from node_packages import node_package
from test_gltf_textures import textured
from textured_shapes import globe

import meshdepict as md
from meshdepict.io import read_mesh, write_mesh

_VALIDATE = """
const fs = require("fs"), path = require("path"), name = process.argv[1];
require("gltf-validator").validateBytes(new Uint8Array(fs.readFileSync(name)), {
  uri: name, externalResourceFunction: (uri) => Promise.resolve(
    new Uint8Array(fs.readFileSync(path.join(path.dirname(name), decodeURIComponent(uri))))),
}).then((report) => console.log(JSON.stringify(report.issues)));
"""


def issues(path: Path) -> list[dict[str, Any]]:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not at hand")
    where = os.environ | {"NODE_PATH": str(node_package("gltf-validator").parent)}
    command = [node, "-e", _VALIDATE, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, env=where)
    assert done.returncode == 0, done.stderr
    found: list[dict[str, Any]] = json.loads(done.stdout)["messages"]
    return [each for each in found if each["severity"] <= 1]  # errors and warnings


def save(path: Path, mesh: md.Mesh, **words: Any) -> Path:
    grays = np.linspace(0, 255, len(mesh.vertices)).astype(np.uint8)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that textures are kept
        write_mesh(
            path,
            mesh,
            colors=np.repeat(grays[:, None], 3, axis=1),
            comments=["meshdepict a"],
            **words,
        )
    return path


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize("quantize", [False, True])
def test_new_files(tmp_path, suffix, quantize):
    ball = md.samples.golf_ball(200, dimples=12)
    assert issues(save(tmp_path / f"ball{suffix}", ball, quantize=quantize)) == []


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_files_with_a_depiction_beside_textures(tmp_path, suffix):
    """The builder's own file has no warning, and neither has what becomes of it."""
    build = textured(Builder())
    build.header["nodes"] = [
        {"mesh": 0, "rotation": [0, 0, 0.6, 0.8], "scale": [1, 2, 1], "name": "a"},
        {"mesh": 0, "translation": [0, 4, 0.1]},
    ]
    build.header["scenes"] = [{"nodes": [0, 1]}]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that two parts become one mesh
        mesh = build.read(tmp_path)
        first = save(tmp_path / f"first{suffix}", mesh)
        second = save(tmp_path / f"second{suffix}", read_mesh(first))
    allowed = issues(tmp_path / "built.glb")
    codes = {each["code"] for each in allowed}
    for path in (first, second):
        assert [each for each in issues(path) if each["code"] not in codes] == []


def test_pictures_that_lay_beside(tmp_path):
    from meshdepict.images.encoded import encode

    (tmp_path / "a b.png").write_bytes(encode(np.zeros((4, 4, 3), np.uint8)))
    mesh = textured(Builder(), image={"uri": "a%20b.png"}).read(tmp_path)
    (tmp_path / "away").mkdir()
    for suffix in (".glb", ".gltf"):
        codes = {each["code"] for each in issues(tmp_path / "built.glb")}
        found = issues(save(tmp_path / "away" / f"baked{suffix}", mesh))
        assert [each for each in found if each["code"] not in codes] == []


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize("image", ["png", "jpeg", "webp"])
def test_textures(tmp_path, suffix, image):
    baked = md.bake_texture(globe(6), "lambert", size=64)
    assert issues(baked.save(tmp_path / f"ball{suffix}", image=image)) == []
