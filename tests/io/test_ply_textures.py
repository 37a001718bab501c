"""Textures of PLY files: every place where programs put coordinates, and what goes along."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.images.encoded import encode
from meshdepict.io import read_mesh, write_mesh
from meshdepict.shapes.mesh import Mesh

INK = np.array([[200, 10, 20], [30, 180, 50], [70, 90, 160], [250, 240, 230]], np.uint8)
PICTURE = INK[[[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]]]
OTHER = np.full((2, 2, 3), 77, np.uint8)
POINTS = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"]
UV = ["0 0", "1 0", "1 1", "0 1"]
FACES = [[0, 1, 2], [0, 2, 3]]
NOTE = "the new colours are at vertices; its textures are kept beside them"


def header(*lines: str, vertex: tuple[str, ...] = (), count: int = 2) -> list[str]:
    named = [*(f"property float {name}" for name in ("x", "y", "z", *vertex))]
    return [
        "ply", "format ascii 1.0", "comment TextureFile paint.png", "comment TextureFile b c.png",
        "element vertex 4", *named, f"element face {count}",
        "property list uchar int vertex_indices", *lines, "end_header",
    ]  # fmt: skip


def wedges() -> list[str]:
    """Coordinates of corners, as MeshLab writes them; the second face has the other picture."""
    rows = []
    for number, face in enumerate(FACES):
        corners = " ".join(map(str, face))
        rows.append(f"3 {corners} 6 {' '.join(UV[k] for k in face)} {number}")
    lists = ("property list uchar float texcoord", "property int texnumber")
    return [*header(*lists), *POINTS, *rows]


def vertices(*names: str) -> list[str]:
    points = [f"{point} {uv}" for point, uv in zip(POINTS, UV, strict=True)]
    return [*header(vertex=names), *points, *(f"3 {' '.join(map(str, face))}" for face in FACES)]


def elements(*, turned: bool) -> list[str]:
    """Coordinates in elements of their own, the faces' in another order."""
    more = (
        "element multi_texture_vertex 4", "property uchar tx", "property float u",
        "property float v", "element multi_texture_face 2", "property uchar tx",
        "property uint tn", "property list uchar int texture_vertex_indices",
    )  # fmt: skip
    points = [f"0 {uv}" for uv in UV]
    rows = [f"{n} {n} 3 {' '.join(map(str, face))}" for n, face in enumerate(FACES)]
    faces = [f"3 {' '.join(map(str, face))}" for face in FACES]
    return [*header(*more), *POINTS, *faces, *points, *(rows[::-1] if turned else rows)]


@pytest.fixture
def home(tmp_path) -> Path:
    folder = tmp_path / "home"
    folder.mkdir()
    (folder / "paint.png").write_bytes(encode(PICTURE))
    (folder / "b c.png").write_bytes(encode(OTHER))
    return folder


def read(folder: Path, lines: list[str]) -> Mesh:
    (folder / "square.ply").write_text("\n".join(lines) + "\n")
    return read_mesh(folder / "square.ply", winding="keep")


@pytest.mark.parametrize(
    ("lines", "second"),
    [
        (wedges(), 1),
        (vertices("s", "t"), 0),
        (vertices("u", "v"), 0),
        (vertices("texture_u", "texture_v"), 0),
        (elements(turned=False), 1),
        (elements(turned=True), 1),
    ],
)
def test_coordinates_are_found_wherever_programs_put_them(home, lines, second):
    mesh = read(home, lines)
    found = mesh.textures
    assert [texture.name for texture in found.base_colors] == ["paint.png", "b c.png"]
    assert found.material.tolist() == [0, second]
    np.testing.assert_array_equal(mesh.texcoords, mesh.vertices[mesh.faces][..., :2])
    lower = np.rint(255 * found.colors([0], [[0.25, 0.5, 0.25]]))  # at (¾, ¼)
    np.testing.assert_array_equal(lower[0], INK[3])
    upper = np.rint(255 * found.colors([1], [[0.25, 0.25, 0.5]]))  # at (¼, ¾)
    np.testing.assert_array_equal(upper[0], [77] * 3 if second else INK[0])


def test_a_polygons_wedges(home):
    lines = header("property list uchar float texcoord", count=1)
    mesh = read(home, [*lines, *POINTS, f"4 0 1 2 3 8 {' '.join(UV)}"])
    assert len(mesh.faces) == 2
    np.testing.assert_array_equal(mesh.texcoords, mesh.vertices[mesh.faces][..., :2])


def test_what_meshlab_writes_is_read(home):
    """From an OBJ with two pictures."""
    pytest.importorskip("pymeshlab")
    (home / "two.mtl").write_text("newmtl a\nmap_Kd paint.png\nnewmtl b\nmap_Kd b c.png\n")
    corners = [" ".join(f"{k + 1}/{k + 1}" for k in face) for face in FACES]
    lines = ["mtllib two.mtl", *(f"v {point}" for point in POINTS), *(f"vt {uv}" for uv in UV)]
    lines += ["usemtl a", f"f {corners[0]}", "usemtl b", f"f {corners[1]}"]
    (home / "two.obj").write_text("\n".join(lines) + "\n")
    code = (
        "import sys, pymeshlab; held = pymeshlab.MeshSet(verbose=False); "
        "held.load_new_mesh(sys.argv[1]); held.save_current_mesh(sys.argv[2])"
    )
    paths = str(home / "two.obj"), str(home / "theirs.ply")
    subprocess.run([sys.executable, "-c", code, *paths], check=True, capture_output=True)
    ours, theirs = (read_mesh(path).textures for path in paths)
    np.testing.assert_allclose(theirs.texcoords, ours.texcoords)
    assert (theirs.base_colors[0].pixels == PICTURE).all()


def test_numbers_of_pictures_that_there_are_not(home):
    lines = wedges()
    lines[-1] = lines[-1].rsplit(" ", 1)[0] + " 7"
    assert read(home, lines).textures.material.tolist() == [0, -1]


def test_lists_that_do_not_fit_are_left_out(home):
    lines = wedges()
    lines[-1] = "3 0 2 3 4 0 0 1 1 0"
    mesh = read(home, lines)
    with pytest.warns(MeshdepictWarning, match="1 triangle with a texture has no coordinates"):
        assert mesh.textures.material.tolist() == [0, -1]


def test_a_file_is_kept_with_what_it_names(home, tmp_path):
    away = tmp_path / "away"
    away.mkdir()
    mesh = read(home, wedges())
    (away / "b c.png").write_bytes(b"somebody's")
    with pytest.warns(MeshdepictWarning, match=NOTE):
        write_mesh(away / "baked.ply", mesh, colors=np.full((4, 3), 5, np.uint8))
    assert (away / "paint.png").read_bytes() == encode(PICTURE)
    assert (away / "b c.png").read_bytes() == b"somebody's"
    text = (away / "baked.ply").read_text()
    assert "comment TextureFile paint.png\ncomment TextureFile b c-2.png\n" in text
    again = read_mesh(away / "baked.ply")
    np.testing.assert_array_equal(again.texcoords, mesh.texcoords)
    assert (again.textures.base_colors[1].pixels == OTHER).all()
    with pytest.warns(MeshdepictWarning, match=NOTE):
        write_mesh(home / "baked.ply", mesh, colors=np.full((4, 3), 5, np.uint8))
    assert sorted(path.name for path in home.iterdir()) == [
        "b c.png", "baked.ply", "paint.png", "square.ply",
    ]  # fmt: skip


def test_pictures_that_are_missing_or_elsewhere_are_one_note(home):
    (home / "paint.png").unlink()
    lines = [line.replace("b c.png", "../b c.png") for line in wedges()]
    with pytest.warns(MeshdepictWarning, match="names the texture 'paint.png', which is not there "
                      r"\(and 1 more like that\): left out") as caught:  # fmt: skip
        mesh = read(home, lines)
    assert len(caught) == 1
    with pytest.raises(MeshdepictError, match="which leads out of its folder"):
        _ = mesh.textures.base_colors[1].pixels


def test_pictures_without_coordinates_are_said(home):
    lines = [*header(), *POINTS, *(f"3 {' '.join(map(str, face))}" for face in FACES)]
    with pytest.warns(MeshdepictWarning, match="names textures, but holds no texture coordinates"):
        assert read(home, lines).textures is None


def test_another_format_says_what_is_lost(home, tmp_path):
    with pytest.warns(MeshdepictWarning, match="textures are not kept: save as .ply to keep them"):
        write_mesh(tmp_path / "square.vtp", read(home, wedges()))
