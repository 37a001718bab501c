"""OBJ: every spelling of a face, and files that keep all their other lines."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import plyfile
import pytest
from conftest import tetrahedron

from meshdepict.errors import MeshdepictWarning
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.shapes.mesh import Mesh

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


@pytest.fixture
def obj(tmp_path: Path):
    """Write a text as OBJ and read it."""

    def read(text: str | bytes) -> Mesh:
        path = tmp_path / "mesh.obj"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_mesh(path, winding="keep")

    return read


def colors_of(mesh: Mesh) -> list[list[int]]:
    vertex = mesh.attributes["vertex"]
    return np.stack([vertex[name] for name in ("red", "green", "blue")], axis=1).tolist()


def random_colors(mesh: Mesh) -> np.ndarray:
    return np.random.default_rng(3).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)


# --- faces --------------------------------------------------------------------------------------

CORNERS = [
    "{i}",
    "{i}/{i}",
    "{i}//{i}",
    "{i}/{i}/{i}",
    "{n}",
    "{n}/{n}",
    "{n}//{n}",
    "{i}/",
    "{n}/{i}/",
]


@pytest.mark.parametrize("corner", CORNERS)
def test_every_spelling_of_a_corner(obj, corner):
    corners = " ".join(corner.format(i=i, n=i - 5) for i in (1, 2, 3, 4))
    more = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + "vn 0 0 1\n" * 4
    mesh = obj(f"{SQUARE}{more}f {corners}\n")
    assert mesh.polygons.connectivity.tolist() == [0, 1, 2, 3]


def test_spellings_mixed_even_within_a_face(obj):
    faces = [" ".join(row) for row in itertools.permutations(["1", "2/1", "3//1", "4/1/1"], 3)]
    mesh = obj(SQUARE + "vt 0 0\nvn 0 0 1\n" + "".join(f"f {face}\n" for face in faces))
    expected = [list(row) for row in itertools.permutations(range(4), 3)]
    assert mesh.faces.tolist() == expected


def test_negative_indices_count_from_where_they_stand(obj):
    mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nf -1 -2 1\n")
    assert mesh.faces.tolist() == [[0, 1, 2], [4, 3, 0]]


def test_polygons_of_all_sizes(obj):
    mesh = obj(SQUARE + "v 2 2 0\nf 1 2 3\nf 1 2 3 4\nf 1 2 5 3 4\nf 1 2\n")
    assert mesh.polygons.offsets.tolist() == [0, 3, 7, 12, 14]
    assert len(mesh.faces) == 1 + 2 + 3


def test_vertices_are_not_split_at_seams(obj):
    mesh = obj(SQUARE + "vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/2 4/2\n")
    assert len(mesh.vertices) == 4


# --- lines --------------------------------------------------------------------------------------


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
@pytest.mark.parametrize("indent", ["", "  ", "\t"])
def test_line_ends_indents_comments_and_continuations(obj, tmp_path, newline, indent):
    text = (
        "# C:\\folder\\\n"
        "mtllib some.mtl\no thing\n"
        "v 0 0 0 # the origin\n"
        "v\t1   0\t0\n"
        "v 1 1 0\nvn 0 0 1\nvp 1\n"
        "g one\nusemtl red\ns off\n"
        "f 1 2 3 # a face\n"
        "l 1 2\np 1"
    )
    if newline != "\r":
        text = text.replace("v 1 1 0", "v 1 \\\n1 \\\n0").replace("f 1 2 3", "f 1 2 \\\n 3")
    text = "".join(indent + line for line in text.splitlines(keepends=True))
    mesh = obj(text.replace("\n", newline))
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
    assert mesh.faces.tolist() == [[0, 1, 2]]

    path = tmp_path / "mesh.obj"
    write_mesh(path, mesh, colors=random_colors(mesh), comments=["meshdepict one"])
    again = read_mesh(path, winding="keep")
    assert colors_of(again) == random_colors(mesh).tolist()
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    assert read_provenance(path) == ["meshdepict one"]
    kept = path.read_text()
    others = ("# C:\\folder\\", "mtllib some.mtl", "o thing", "vn 0 0 1", "vp 1", "s off", "l 1 2")
    for line in (*others, "# the origin", "# a face"):
        assert line in kept


def test_all_other_lines_are_kept_byte_for_byte(obj, tmp_path):
    text = "# made by hand\n\nv 0 0 0\nv 1.50 0 0\t\nvn 0 0 1\nv 0 1e0 0\nf 1//1 2//1 3//1\n\n# end"
    mesh = obj(text)
    path = tmp_path / "mesh.obj"
    write_mesh(path, mesh)
    assert path.read_text() == text
    colors = np.array([[0, 51, 255]] * 3, np.uint8)
    write_mesh(path, mesh, colors=colors, comments=["meshdepict one", "meshdepict two"])
    tail = " 0.000000 0.200000 1.000000\n"
    assert path.read_text() == (
        f"# meshdepict one\n# meshdepict two\n# made by hand\n\nv 0 0 0{tail}v 1.50 0 0{tail}"
        f"vn 0 0 1\nv 0 1e0 0{tail}f 1//1 2//1 3//1\n\n# end"
    )


def test_a_second_bake_replaces_the_first(obj, tmp_path):
    mesh = obj(SQUARE + "f 1 2 3 4\n")
    path = tmp_path / "mesh.obj"
    write_mesh(path, mesh, colors=random_colors(mesh), comments=["meshdepict one"])
    first = read_mesh(path)
    write_mesh(path, first, colors=255 - random_colors(mesh), comments=["meshdepict two"])
    assert colors_of(read_mesh(path)) == (255 - random_colors(mesh)).tolist()
    assert read_provenance(path) == ["meshdepict two"]
    assert path.read_bytes().count(b"\n") == 6


# --- colours ------------------------------------------------------------------------------------


def test_colours_as_fractions_and_as_bytes(obj):
    fractions = "v 0 0 0 0 0.5 1\nv 1 0 0 1 0 0.2\nv 0 1 0 0 0 0\nf 1 2 3\n"
    as_bytes = "v 0 0 0 0 128 255\nv 1 0 0 255 0 51\nv 0 1 0 0 0 0\nf 1 2 3\n"
    expected = [[0, 128, 255], [255, 0, 51], [0, 0, 0]]
    assert colors_of(obj(fractions)) == colors_of(obj(as_bytes)) == expected


def test_colours_only_where_every_vertex_has_one(obj):
    mesh = obj("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1.0\nf 1 2 3\n")
    assert mesh.attributes["vertex"] == {}
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def test_own_colours_that_are_lost_are_warned_of(obj, tmp_path):
    mesh = obj("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n")
    path = tmp_path / "mesh.obj"
    with pytest.warns(MeshdepictWarning, match="OBJ holds one colour per vertex"):
        write_mesh(path, mesh, colors=random_colors(mesh))
    write_mesh(path, mesh, colors=random_colors(mesh), keep_colors=False)
    assert colors_of(read_mesh(path)) == random_colors(mesh).tolist()
    write_mesh(path, mesh)
    assert colors_of(read_mesh(path)) == [[255, 0, 0]] * 3


# --- texture coordinates ------------------------------------------------------------------------


def test_texture_coordinates_become_an_element_in_ply(obj, tmp_path):
    mesh = obj(
        SQUARE + "vt 0 0\nvt 0.5 0 0\nvt 1 1\n"
        "f 1/1 2/2 3/3\nf 1 2 3\nf 1/-3 2/2 3/-1 4/1\nf 1/1 2 3/3\nf 1/1 2/9 3/3\n"
    )
    path = tmp_path / "mesh.ply"
    write_mesh(path, mesh)
    theirs = plyfile.PlyData.read(str(path), mmap=False)
    none = [np.nan, np.nan]
    np.testing.assert_array_equal(
        np.stack([theirs["corner"][name] for name in ("s", "t")], axis=1),
        [
            *([0, 0], [0.5, 0], [1, 1]),
            *(none, none, none),
            *([0, 0], [0.5, 0], [1, 1], [0, 0]),
            *([0, 0], none, [1, 1]),  # one of its corners has none
            *([0, 0], none, [1, 1]),  # one of them doesn't exist
        ],
    )
    assert [row.tolist() for row in theirs["face"]["vertex_indices"]][2] == [0, 1, 2, 3]
    texture, corner = read_mesh(path).document.texcoords
    known = corner >= 0
    np.testing.assert_array_equal(known, np.isfinite(theirs["corner"]["s"]))
    np.testing.assert_array_equal(texture[corner[known], 1], theirs["corner"]["t"][known])


def test_texture_coordinates_stay_exact(obj, tmp_path):
    mesh = obj(SQUARE + "vt 0.1 0.7\nf 1/1 2/1 3/1\n")
    write_mesh(tmp_path / "mesh.ply", mesh)
    texture, corner = read_mesh(tmp_path / "mesh.ply").document.texcoords
    assert texture[corner].tolist() == [[0.1, 0.7]] * 3


@pytest.mark.parametrize("source", ["mesh.obj", "mesh.ply"])
def test_another_mesh_does_not_get_the_files_lines(obj, tmp_path, source):
    mesh = obj(SQUARE + "vt 0 0\nvt 1 0\nf 1/1 2/1 3/2\n")
    write_mesh(tmp_path / "mesh.ply", mesh)
    mesh = read_mesh(tmp_path / source, winding="keep")
    turned = Mesh(mesh.vertices, mesh.faces[:, ::-1], document=mesh.document, winding="keep")
    moved = Mesh(mesh.vertices + 1, mesh.faces, document=mesh.document, winding="keep")
    for changed in (turned, moved):
        for suffix in (".obj", ".ply"):
            path = tmp_path / f"changed{suffix}"
            write_mesh(path, changed)
            again = read_mesh(path, winding="keep")
            np.testing.assert_array_equal(again.vertices, changed.vertices)
            np.testing.assert_array_equal(again.faces, changed.faces)
        # Texture coordinates belong to corners: they may move, but not be turned.
        assert (again.document.texcoords is None) == (changed is turned)
    copied = Mesh(mesh.vertices, mesh.faces, document=mesh.document, winding="keep")
    write_mesh(tmp_path / "copied.ply", copied)
    texture, corner = read_mesh(tmp_path / "copied.ply").document.texcoords
    assert texture[corner].tolist() == [[0, 0], [0, 0], [1, 0]]


def test_doubles_survive(tmp_path):
    vertices, faces = tetrahedron()
    mesh = Mesh(vertices / 3 * 10.0 ** np.arange(-9, 3).reshape(4, 3), faces)
    write_mesh(tmp_path / "mesh.obj", mesh)
    np.testing.assert_array_equal(read_mesh(tmp_path / "mesh.obj").vertices, mesh.vertices)


# --- real files ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "vertices", "polygons", "triangles"),
    [
        ("obj_quads_quadknot.obj", 1_440, 1_440, 2_880),
        ("obj_mixed_greek_helmet.obj", 5_021, 4_856, 9_608),
        ("obj_ngons_trumpet.obj", 11_908, 11_362, 23_696),
        ("obj_dup_vertices_teapot.obj", 3_644, 6_320, 6_320),
    ],
)
def test_real_files(data, tmp_path, name, vertices, polygons, triangles):
    path, copy = data / "formats" / name, tmp_path / "copy.obj"
    mesh = read_mesh(path, winding="keep")
    found = len(mesh.faces) if mesh.polygons is None else len(mesh.polygons.offsets) - 1
    assert (len(mesh.vertices), found, len(mesh.faces)) == (vertices, polygons, triangles)
    write_mesh(copy, mesh)
    assert copy.read_bytes() == path.read_bytes()
    write_mesh(copy, mesh, colors=random_colors(mesh), keep_colors=False)
    assert colors_of(read_mesh(copy, winding="keep")) == random_colors(mesh).tolist()
    old, new = path.read_bytes().split(b"\n"), copy.read_bytes().split(b"\n")
    for before, after in zip(old, new, strict=True):
        if before.startswith(b"v "):
            assert after.split()[:4] == before.split()[:4]
        else:
            assert after == before
