"""Textures of OBJ files: what materials name, where it lies, and what goes along."""

from __future__ import annotations

import itertools
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh

import meshdepict as md
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.images.encoded import encode
from meshdepict.io import read_mesh, write_mesh
from meshdepict.shapes.mesh import Mesh

INK = np.array([[200, 10, 20], [30, 180, 50], [70, 90, 160], [250, 240, 230]], np.uint8)
PICTURE = INK[[[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]]]  # the square's quarters
SQUARE = """mtllib square.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl painted
f 1/1 2/2 3/3 4/4
"""
NOTE = "the new colours are at vertices; its textures are kept beside them"


@pytest.fixture
def home(tmp_path) -> Path:
    """A folder with a square, its material and its picture."""
    folder = tmp_path / "home"
    folder.mkdir()
    (folder / "square.obj").write_text(SQUARE)
    (folder / "square.mtl").write_text("newmtl painted\nKd 1 1 1\nmap_Kd paint.png\n")
    (folder / "paint.png").write_bytes(encode(PICTURE))
    return folder


def quarters(mesh: Mesh) -> np.ndarray:
    """The colours in the middle of the square's quarters, from the upper left on, as bytes."""
    at = np.array([(0.25, 0.75), (0.75, 0.75), (0.25, 0.25), (0.75, 0.25)])
    found = np.full((4, 3), -1)
    assert mesh.textures is not None
    for number, place in enumerate(at):
        for face, corners in enumerate(mesh.vertices[mesh.faces][..., :2]):
            weights = np.linalg.lstsq(np.vstack([corners.T, np.ones(3)]), [*place, 1], None)[0]
            if (weights > -1e-9).all():
                found[number] = np.rint(255 * mesh.textures.colors([face], [weights])[0])
    return found


def test_a_material_lays_its_picture_on_faces(home):
    mesh = read_mesh(home / "square.obj")
    np.testing.assert_array_equal(quarters(mesh), INK)
    np.testing.assert_array_equal(mesh.texcoords, mesh.vertices[mesh.faces][..., :2])
    (texture,) = mesh.textures.base_colors
    assert (texture.name, texture.kind, texture.wrap) == ("paint.png", "png", ("repeat", "repeat"))


def test_trimesh_agrees(home):
    mesh = read_mesh(home / "square.obj")
    theirs = trimesh.load(home / "square.obj", process=False)
    ours = {
        tuple(row)
        for row in np.concatenate([mesh.vertices[mesh.faces], mesh.texcoords], 2)
        .reshape(-1, 5)
        .round(6)
    }
    assert {tuple(row) for row in np.c_[theirs.vertices, theirs.visual.uv].round(6)} == ours


@pytest.mark.parametrize("name", ["a picture of it.png", "textures/paint.png", "./paint.png"])
@pytest.mark.parametrize(
    "options", ["", "-blendu on ", "-mm 0 1 -texres 512 ", "-imfchan m -boost 2 -t 1 2 3 "]
)
def test_options_come_before_a_name_that_may_have_blanks(home, name, options):
    (home / "textures").mkdir()
    (home / "square.mtl").write_text(f"newmtl painted\n\tmap_Kd {options}{name}\r\n")
    if name != "./paint.png":
        shutil.move(home / "paint.png", home / name)
    np.testing.assert_array_equal(quarters(read_mesh(home / "square.obj")), INK)


def test_offset_scale_and_clamp(home):
    """A quarter of the picture, moved to its upper right, covers the square."""
    (home / "square.mtl").write_text("newmtl painted\nmap_Kd -s 0.5 0.5 1 -o 0.5 0.5 paint.png\n")
    mesh = read_mesh(home / "square.obj")
    assert mesh.texcoords.min() == 0.5
    assert mesh.texcoords.max() == 1
    (home / "square.mtl").write_text("newmtl painted\nmap_Kd -o 1 -clamp on paint.png\n")
    mesh = read_mesh(home / "square.obj")
    assert mesh.textures.base_colors[0].wrap == ("clamp", "clamp")
    np.testing.assert_array_equal(quarters(mesh), INK[[1, 1, 3, 3]])


def test_an_unknown_option_is_a_sentence(home):
    (home / "square.mtl").write_text("newmtl painted\nmap_Kd -wobble 3 paint.png\n")
    with pytest.warns(MeshdepictWarning, match="has a texture with the option '-wobble'"):
        mesh = read_mesh(home / "square.obj")
    with pytest.raises(MeshdepictError, match="the mesh's file has a texture with the option"):
        _ = mesh.textures.base_colors[0].pixels


def test_each_face_has_the_material_before_it(home):
    """A face before any, one of a library's second material, and one of a material unknown."""
    (home / "more.mtl").write_text("newmtl other\nKd 1 0.5 0\nmap_Kd other.png\n")
    (home / "other.png").write_bytes(encode(PICTURE[::-1]))
    head, _ = SQUARE.split("usemtl")
    faces = "f 1/1 2/2 3/3\nusemtl other\nf 1/1 2/2 3/3\nusemtl painted\nf -4/-4 -2/-2 -1/-1\n"
    text = (
        head.replace("square.mtl", "square.mtl more.mtl") + faces + "usemtl none\nf 1/1 2/2 3/3\n"
    )
    (home / "square.obj").write_text(text)
    mesh = read_mesh(home / "square.obj", winding="keep")
    assert mesh.textures.material.tolist() == [-1, 1, 0, -1]
    np.testing.assert_array_equal(mesh.texcoords[2], [[0, 0], [1, 1], [0, 1]])
    factor = mesh.textures.factors[1]
    np.testing.assert_allclose(factor, [1, 0.2140, 0, 1], atol=1e-4)


@pytest.mark.parametrize(
    "grey", ["0 0 0", "0.8 0.8 0.8", "0.4", "xyz 0.2 0.3 0.4", "spectral a.rfl"]
)
def test_a_grey_with_a_picture_means_the_picture(home, grey):
    (home / "square.mtl").write_text(f"newmtl painted\nKd {grey}\nmap_Kd paint.png\n")
    np.testing.assert_array_equal(quarters(read_mesh(home / "square.obj")), INK)


def test_what_trimesh_writes_has_the_pictures_colours(home):
    theirs = trimesh.load(home / "square.obj", process=False)
    theirs.export(home / "theirs.obj", mtl_name="theirs.mtl")
    np.testing.assert_array_equal(quarters(read_mesh(home / "theirs.obj")), INK)


@pytest.mark.parametrize("keyword", ["norm", "map_Bump -bm 0.5", "bump -bm 0.5", "map_Kn"])
def test_a_bump_map_in_colour_is_a_normal_map(home, keyword):
    (home / "square.mtl").write_text(f"newmtl painted\n{keyword} paint.png\n")
    found = read_mesh(home / "square.obj").textures
    assert found.base_colors == (None,)
    np.testing.assert_array_equal(found.normal_maps[0].pixels, PICTURE)
    assert found.normal_scales.tolist() == [0.5 if "-bm" in keyword else 1]


def test_a_bump_map_in_grey_is_heights(home):
    (home / "square.mtl").write_text("newmtl painted\nmap_Bump grey.png\nmap_Kd paint.png\n")
    (home / "grey.png").write_bytes(encode(PICTURE[..., 0]))
    assert read_mesh(home / "square.obj").textures.normal_maps == (None,)


def test_normal_maps_may_lie_elsewhere(home):
    (home / "square.mtl").write_text("newmtl painted\nmap_Kd paint.png\nnorm -s 2 2 paint.png\n")
    found = read_mesh(home / "square.obj").textures
    np.testing.assert_allclose(found.normal_texcoords, 2 * found.texcoords)


def test_polygons_keep_each_corners_coordinates(home):
    """A polygon of eight with a notch: its triangles' corners are where its own are."""
    points = [(0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)]
    lines = ["mtllib square.mtl", "usemtl painted"]
    lines += [f"v {x} {y} 0\nvt {x / 4} {y / 4}" for x, y in points]
    lines.append("f " + " ".join(f"{k}/{k}" for k in range(1, 9)))
    (home / "u.obj").write_text("\n".join(lines) + "\n")
    mesh = read_mesh(home / "u.obj")
    assert len(mesh.faces) == 6
    np.testing.assert_array_equal(mesh.texcoords * 4, mesh.vertices[mesh.faces][..., :2])


# --- what is saved --------------------------------------------------------------------------------


def save(mesh: Mesh, path: Path) -> None:
    with pytest.warns(MeshdepictWarning, match=NOTE):
        write_mesh(path, mesh, colors=np.full((len(mesh.vertices), 3), 9, np.uint8))


def test_materials_and_pictures_go_along(home, tmp_path):
    (home / "sub").mkdir()
    for name in ("square.mtl", "paint.png"):
        shutil.move(home / name, home / "sub" / name)
    (home / "sub" / "square.mtl").write_text(
        "newmtl painted\nmap_Kd paint.png\nmap_Ks shine.png\ndisp missing.png\n"
    )
    (home / "sub" / "shine.png").write_bytes(b"anything")
    (home / "square.obj").write_text(SQUARE.replace("square.mtl", "sub/square.mtl"))
    away = tmp_path / "away"
    away.mkdir()
    mesh = read_mesh(home / "square.obj")
    save(mesh, away / "baked.obj")
    written = sorted(str(path.relative_to(away)) for path in away.rglob("*") if path.is_file())
    assert written == ["baked.obj", "sub/paint.png", "sub/shine.png", "sub/square.mtl"]
    assert (away / "sub/square.mtl").read_bytes() == (home / "sub/square.mtl").read_bytes()
    again = read_mesh(away / "baked.obj")
    np.testing.assert_array_equal(quarters(again), INK)
    assert again.attributes["vertex"]["red"].tolist() == [9] * 4
    before = {path: path.stat().st_mtime_ns for path in away.rglob("*")}
    save(mesh, away / "baked.obj")
    for path in away.rglob("*.*g"):
        assert path.stat().st_mtime_ns == before[path]


def test_in_its_own_folder_nothing_is_copied(home):
    before = sorted(home.iterdir())
    save(read_mesh(home / "square.obj"), home / "baked.obj")
    assert sorted(home.iterdir()) == sorted([*before, home / "baked.obj"])
    np.testing.assert_array_equal(quarters(read_mesh(home / "baked.obj")), INK)


def test_files_of_others_that_have_the_names_are_left(home, tmp_path):
    away = tmp_path / "away"
    away.mkdir()
    for name in ("square.mtl", "paint.png"):
        (away / name).write_bytes(b"newmtl somebody\n")
    save(read_mesh(home / "square.obj"), away / "baked.obj")
    for name in ("square.mtl", "paint.png"):
        assert (away / name).read_bytes() == b"newmtl somebody\n"
    assert "mtllib square-2.mtl" in (away / "baked.obj").read_text()
    assert "map_Kd paint-2.png" in (away / "square-2.mtl").read_text()
    np.testing.assert_array_equal(quarters(read_mesh(away / "baked.obj")), INK)


def test_a_failure_leaves_no_new_file(home, tmp_path, monkeypatch):
    """The picture can't be written: neither are the library and the mesh."""
    away = tmp_path / "away"
    away.mkdir()
    mesh = read_mesh(home / "square.obj")
    calls = itertools.count()

    def full(*_: object) -> None:
        if next(calls):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("meshdepict.files.companions.shutil.copyfileobj", full)
    with (
        pytest.warns(MeshdepictWarning, match=NOTE),
        pytest.raises(MeshdepictError, match="no space is left on the disk"),
    ):
        write_mesh(away / "b.obj", mesh, colors=np.zeros((4, 3), np.uint8))
    assert not list(away.iterdir())


def test_another_format_says_what_is_lost(home, tmp_path):
    with pytest.warns(MeshdepictWarning, match="materials and textures are not kept: save as .obj"):
        write_mesh(tmp_path / "square.ply", read_mesh(home / "square.obj"))


# --- what is wrong --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("gone.png", r"names the texture 'gone\.png', which is not there: left out"),
        ("../paint.png", r"names the texture '\.\./paint\.png', which leads out of its folder"),
        ("/etc/paint.png", "an absolute path: only files in its own folder"),
        ("C:\\paint.png", "an absolute path: only files in its own folder"),
        ("https://a.b/paint.png", "a URL: only files in its own folder"),
        ("empty.png", r"names the texture 'empty\.png', which is empty"),
    ],
)
def test_a_texture_that_cannot_be_had_is_one_sentence(home, name, said):
    (home.parent / "paint.png").write_bytes(encode(PICTURE))
    (home / "empty.png").write_bytes(b"")
    (home / "square.mtl").write_text(f"newmtl painted\nmap_Kd {name}\n")
    with pytest.warns(MeshdepictWarning, match=said) as caught:
        mesh = read_mesh(home / "square.obj")
    assert len(caught) == 1
    assert mesh.textures.base_colors[0].encoded is None
    with pytest.raises(MeshdepictError, match="the mesh's file names the texture"):
        mesh.textures.base_colors[0].lookup([[0, 0]])
    save(mesh, home / "baked.obj")
    assert name in (home / "square.mtl").read_text()


def test_a_picture_that_is_none_is_one_sentence(home):
    (home / "paint.png").write_bytes(b"not a picture")
    mesh = read_mesh(home / "square.obj")
    with pytest.raises(MeshdepictError, match=r"texture 'paint\.png' can't be read as a picture"):
        _ = mesh.textures.base_colors[0].pixels


def test_faces_without_proper_coordinates_go_without(home):
    text = SQUARE.replace("f 1/1 2/2 3/3 4/4", "f 1/1 2/2 3/3\nf 1 3 4\nf 1/5 2/1 3/2")
    (home / "square.obj").write_text(text.replace("usemtl", "vt nan 1\nusemtl"))
    mesh = read_mesh(home / "square.obj", winding="keep")
    with pytest.warns(MeshdepictWarning, match="2 triangles with a texture have no coordinates"):
        found = mesh.textures
    assert found.material.tolist() == [0, -1, -1]
    assert np.isfinite(found.texcoords).all()


def test_textures_without_any_coordinates_are_said(home):
    lines = [line for line in SQUARE.splitlines() if not line.startswith(("vt", "f"))]
    (home / "square.obj").write_text("\n".join([*lines, "f 1 2 3 4"]))
    with pytest.warns(MeshdepictWarning, match="holds no texture coordinates"):
        mesh = read_mesh(home / "square.obj")
    assert mesh.textures is None
    assert mesh.texcoords is None


def test_a_library_that_is_missing_leaves_the_shape(home):
    (home / "square.mtl").unlink()
    mesh = read_mesh(home / "square.obj")
    assert mesh.textures is None
    said = r"the mesh has none, and its file names the material library 'square\.mtl', which is not"
    with pytest.raises(MeshdepictError, match=said):
        md.bake(mesh, "lambert", albedo="keep")
    write_mesh(home / "baked.obj", mesh, colors=np.zeros((4, 3), np.uint8))
    assert "mtllib square.mtl" in (home / "baked.obj").read_text()
