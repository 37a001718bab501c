"""Baking textured files from the command line: what is said, kept, and multiplied."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gltf_builder import FACES, POINTS, Builder, colors_of

import meshdepict as md
from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.images.encoded import encode
from meshdepict.io import read_mesh

RED = np.full((4, 4, 3), (200, 10, 10), np.uint8)


@pytest.fixture
def painted(folder: Path, build: Builder) -> Builder:
    """A tetrahedron all in red, as GLB and as OBJ, in a folder of its own."""
    (folder / "scans").mkdir()
    primitive = build.tetrahedron(material=0)
    primitive["attributes"]["TEXCOORD_0"] = build.accessor(POINTS[:, :2] / 4 + 0.5, "f4")
    build.mesh(primitive)
    build.header |= {
        "nodes": [{"mesh": 0}],
        "images": [{"bufferView": build.view(encode(RED)), "mimeType": "image/png"}],
        "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    }
    (folder / "scans" / "a.glb").write_bytes(build.glb())
    lines = ["mtllib a.mtl", "usemtl paint", *(f"v {x} {y} {z}" for x, y, z in POINTS), "vt 0 0"]
    lines += [f"f {a}/1 {b}/1 {c}/1" for a, b, c in FACES + 1]
    (folder / "scans" / "a.obj").write_text("\n".join(lines) + "\n")
    (folder / "scans" / "a.mtl").write_text("newmtl paint\nmap_Kd red.png\n")
    (folder / "scans" / "red.png").write_bytes(encode(RED))
    return build


@pytest.fixture
def build() -> Builder:
    return Builder()


WORDS = ("-m", "lambert", "--view", "front", "--up", "y")


@pytest.mark.parametrize(
    ("suffix", "where"), [("glb", "in a scene of its own"), ("obj", "beside them")]
)
def test_a_textured_file_is_baked_in_its_colours_with_one_note(run, painted, folder, suffix, where):
    out = f"baked.{suffix}"
    status, _, (note,) = run("bake", f"scans/a.{suffix}", "-o", out, "--albedo", "keep", *WORDS)
    assert status == 0
    assert note.startswith("meshdepict: note: ")
    assert f"{out}: the new colours are at vertices; its textures are kept {where}" in note
    baked = read_mesh(out)
    plain = md.bake(f"scans/a.{suffix}", "lambert", view="front", up="y")
    light = srgb_to_linear(plain.colors / 255) * srgb_to_linear(RED[0, 0] / 255)
    np.testing.assert_allclose(colors_of(baked), 255 * linear_to_srgb(light), atol=1)
    assert baked.textures.base_colors[0].encoded == encode(RED)
    if suffix == "obj":
        assert sorted(path.name for path in folder.iterdir()) == [
            "a.mtl", "baked.obj", "red.png", "scans",
        ]  # fmt: skip


def test_a_baked_file_is_baked_again_in_the_colours_of_its_texture(run, painted):
    for source, out in (("scans/a.glb", "first.glb"), ("first.glb", "second.glb")):
        status, *_ = run("bake", source, "-o", out, "--albedo", "keep", *WORDS)
        assert status == 0
    np.testing.assert_array_equal(*(colors_of(read_mesh(f"{n}.glb")) for n in ("first", "second")))


def test_another_format_is_a_note(run, painted):
    _, _, (note,) = run("bake", "scans/a.glb", "-o", "a.ply", *WORDS)
    assert "a.ply: textures are not kept: save as .glb to keep them" in note


def test_a_picture_that_is_missing_ends_albedo_keep_alone(run, painted, folder):
    (folder / "scans" / "red.png").unlink()
    status, _, errors = run("bake", "scans/a.obj", "-o", "a.obj", "--albedo", "keep", *WORDS)
    assert status == 2
    said = "albedo='keep' needs what can't be had: the mesh's file names the texture 'red.png'"
    assert said in errors[-1] or said in errors[0]
    assert not (folder / "a.obj").exists()
    assert not (folder / "a.mtl").exists()
    status, _, (note,) = run("bake", "scans/a.obj", "-o", "a.obj", *WORDS)
    assert status == 0
    assert "names the texture 'red.png', which is not there: left out" in note


def test_quantised_files_are_for_gltf_alone(run, ball_ply):
    status, _, (error,) = run("bake", "ball.ply", "-o", "ball.ply", "--quantize", "--force")
    assert (status, "--quantize is about .glb and .gltf" in error) == (2, True)
    for words in ((), ("--quantize",)):
        status, *_ = run("bake", "ball.ply", "-o", f"ball{len(words)}.glb", "-m", "lambert", *words)
        assert status == 0
    assert Path("ball1.glb").stat().st_size < 0.8 * Path("ball0.glb").stat().st_size


def test_info_names_textures(run, painted):
    _, lines, _ = run("info", "scans/a.obj")
    assert any("texture coordinates, textures" in line for line in lines)


def test_triangles_that_are_split_lose_their_texture_with_a_note(run, painted):
    status, _, notes = run("bake", "scans/a.obj", "-o", "b.obj", "--refine", "2", *WORDS)
    assert status == 0
    assert any("split triangles have no texture coordinates any more" in note for note in notes)
    assert not any("split triangles" in note for note in run("bake", "scans/a.obj", *WORDS)[2])
