"""PLY: colours and what becomes of the old ones, new files, strips, comments."""

from __future__ import annotations

import pickle
import re
import struct

import numpy as np
import plyfile
import pytest
from conftest import tetrahedron
from odd_ply import ENCODINGS, OURS, colors_of, polygons_of, random_colors

from meshdepict.errors import MeshdepictWarning
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.shapes.document import Document
from meshdepict.shapes.mesh import Mesh

# --- colours ------------------------------------------------------------------------------------

COLORED = """ply
format {} 1.0
element vertex 3
property float x
property ushort green
property float y
property ushort red
property float z
property ushort blue
property uchar alpha
element face 1
property list uchar int vertex_indices
end_header
"""
COLORED_ROWS = [
    (0, 500, 0, 400, 0, 600, 7),
    (1, 501, 0, 401, 0, 601, 8),
    (0, 502, 1, 402, 0, 602, 9),
]


def colored_file(encoding: str) -> bytes:
    header = COLORED.format(encoding).encode()
    if encoding == "ascii":
        rows = "".join(" ".join(map(str, row)) + "\n" for row in COLORED_ROWS)
        return header + rows.encode() + b"3 0 1 2\n"
    order = "<" if encoding.endswith("little_endian") else ">"
    rows = b"".join(struct.pack(order + "fHfHfHB", *row) for row in COLORED_ROWS)
    return header + rows + struct.pack(order + "B3i", 3, 0, 1, 2)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_the_files_own_colours_become_original(tmp_path, encoding):
    path = tmp_path / "colored.ply"
    path.write_bytes(colored_file(encoding))
    mesh = read_mesh(path)
    own = colors_of(mesh)
    assert own.dtype == np.uint16
    assert own.tolist() == [[row[3], row[1], row[5]] for row in COLORED_ROWS]

    for seed in (1, 2):  # the second time they are this program's
        write_mesh(path, mesh, colors=random_colors(mesh, seed), comments=OURS)
        mesh = read_mesh(path)
        np.testing.assert_array_equal(colors_of(mesh), random_colors(mesh, seed))
        np.testing.assert_array_equal(colors_of(mesh, "original_"), own)
        assert colors_of(mesh).dtype == np.uint8
        assert colors_of(mesh, "original_").dtype == np.uint16
        assert mesh.attributes["vertex"]["alpha"].tolist() == [7, 8, 9]

    write_mesh(path, mesh, colors=random_colors(mesh, 3), comments=OURS, keep_colors=False)
    assert set(read_mesh(path).attributes["vertex"]) == {"alpha", "red", "green", "blue"}


def test_originals_stay_where_another_program_lost_the_provenance(tmp_path):
    path = tmp_path / "colored.ply"
    path.write_bytes(colored_file("ascii"))
    mesh = read_mesh(path)
    write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
    path.write_bytes(re.sub(rb"comment meshdepict[^\n]*\n", b"", path.read_bytes()))
    assert read_provenance(path) is None
    again = read_mesh(path)
    write_mesh(path, again, colors=random_colors(mesh, 2), comments=OURS)
    np.testing.assert_array_equal(colors_of(read_mesh(path), "original_"), colors_of(mesh))


def test_without_colours_the_file_stays_as_it_is(tmp_path):
    path, copy = tmp_path / "colored.ply", tmp_path / "copy.ply"
    path.write_bytes(colored_file("ascii"))
    mesh = read_mesh(path)
    write_mesh(copy, mesh)
    assert copy.read_bytes() == path.read_bytes()
    write_mesh(copy, mesh, comments=OURS)
    assert read_provenance(copy) == OURS
    assert copy.read_bytes().replace(b"comment meshdepict", b"") != path.read_bytes()
    np.testing.assert_array_equal(colors_of(read_mesh(copy)), colors_of(mesh))


def test_old_provenance_does_not_outlive_its_colours(tmp_path):
    path = tmp_path / "colored.ply"
    path.write_bytes(colored_file("ascii"))
    mesh = read_mesh(path)
    write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
    write_mesh(path, read_mesh(path), colors=random_colors(mesh, 2))
    assert read_provenance(path) is None


# --- meshes from elsewhere ------------------------------------------------------------------------


def test_new_files_are_little_endian_and_exact(tmp_path):
    vertices, faces = tetrahedron()
    path = tmp_path / "new.ply"
    for scale, kind in ((0.5, "f4"), (0.1, "f8")):
        write_mesh(path, Mesh(vertices * scale, faces))
        theirs = plyfile.PlyData.read(str(path), mmap=False)
        assert theirs.byte_order == "<"
        assert theirs["vertex"]["x"].dtype == kind
        np.testing.assert_array_equal(read_mesh(path).vertices, vertices * scale)
        np.testing.assert_array_equal(np.stack(theirs["face"]["vertex_indices"]), faces)


def test_polygons_stay_polygons(tmp_path):
    vertices = np.random.default_rng(0).normal(size=(300, 3))
    path = tmp_path / "new.ply"
    for faces in ([[0, 1, 2], [3, 2, 1, 0], [0, 1, 2, 3, 4]], [[0, 1, 2, 3], [3, 2, 4, 5]],
                  [list(range(300)), [5, 6, 7]]):  # fmt: skip
        write_mesh(path, Mesh(vertices, faces, winding="keep"))
        assert polygons_of(read_mesh(path)) == faces
        theirs = plyfile.PlyData.read(str(path), mmap=False)
        assert [face.tolist() for face in theirs["face"]["vertex_indices"]] == faces


@pytest.mark.unwatched  # a NaN is written, and read as it is
def test_attributes_become_properties_of_their_type(tmp_path):
    vertices, faces = tetrahedron()
    vertex = {
        "quality": np.array([1.5, np.nan, -np.inf, 0.1]),
        "half": np.array([0.5, 1, 2, 3], np.float16),
        "label": np.array([1, -2, 3, 2**31 - 1]),
        "big": np.array([0, 1, 2, 2**32 - 1]),
        "huge": np.array([0, 1, 2, 2**40]),
        "mask": np.array([True, False, True, True]),
        "swapped": np.arange(4, dtype=">i2"),
        "Normals": vertices / 3**0.5,
        "two words": np.arange(8).reshape(4, 2),
        "x": np.arange(4.0),
    }
    face = {"group": np.arange(4, dtype=np.uint8)}
    path = tmp_path / "new.ply"
    write_mesh(path, Mesh(vertices, faces, attributes={"vertex": vertex, "face": face}))
    mesh = read_mesh(path)
    found = {name: values.dtype.str[1:] for name, values in mesh.attributes["vertex"].items()}
    assert found == {
        "quality": "f8", "half": "f4", "label": "i4", "big": "u4", "huge": "f8", "mask": "u1",
        "swapped": "i2", "nx": "f8", "ny": "f8", "nz": "f8", "two_words_0": "i4",
        "two_words_1": "i4", "x_2": "f8",
    }  # fmt: skip
    for name in ("quality", "half", "label", "big", "huge", "mask", "swapped"):
        np.testing.assert_array_equal(mesh.attributes["vertex"][name], vertex[name])
    np.testing.assert_array_equal(mesh.attributes["vertex"]["nz"], vertex["Normals"][:, 2])
    np.testing.assert_array_equal(mesh.attributes["face"]["group"], face["group"])


def test_text_is_left_out_with_a_warning(tmp_path):
    mesh = Mesh(*tetrahedron(), attributes={"vertex": {"name": np.array(list("abcd"))}})
    with pytest.warns(MeshdepictWarning, match="'name' is left out: PLY holds numbers"):
        write_mesh(tmp_path / "new.ply", mesh)
    assert read_mesh(tmp_path / "new.ply").attributes["vertex"] == {}


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_new_attributes_join_the_files(tmp_path, encoding):
    path = tmp_path / "colored.ply"
    path.write_bytes(colored_file(encoding))
    mesh = read_mesh(path)
    weight = np.array([0.1, 1 / 3, 1e-300])
    more = {
        "vertex": {**mesh.attributes["vertex"], "weight": weight, "single": weight.astype("f4")},
        "face": {"part": np.array([5], np.int16)},
    }
    write_mesh(path, Mesh(mesh.vertices, mesh.faces, attributes=more, document=mesh.document))
    found = read_mesh(path).attributes
    np.testing.assert_array_equal(found["vertex"]["weight"], weight)
    np.testing.assert_array_equal(found["vertex"]["single"], weight.astype("f4"))
    np.testing.assert_array_equal(found["face"]["part"], [5])
    np.testing.assert_array_equal(colors_of(read_mesh(path)), colors_of(mesh))


@pytest.mark.parametrize("change", ["vertices", "faces"])
def test_a_changed_mesh_is_not_mistaken_for_its_file(tmp_path, change):
    path = tmp_path / "colored.ply"
    path.write_bytes(colored_file("ascii"))
    mesh = read_mesh(path)
    vertices = mesh.vertices + (change == "vertices")
    faces = mesh.faces[:, ::-1] if change == "faces" else mesh.faces
    changed = Mesh(vertices, faces, attributes=mesh.attributes, document=mesh.document)
    write_mesh(path, changed)
    np.testing.assert_array_equal(read_mesh(path).vertices, vertices)
    np.testing.assert_array_equal(read_mesh(path).faces, faces)
    np.testing.assert_array_equal(colors_of(read_mesh(path)), colors_of(mesh))


class Elsewhere(Document):
    """A reader's that knows texture coordinates, but not for which polygons."""

    texcoords = (np.zeros((1, 2)), np.zeros(12, int))


def test_texture_coordinates_of_other_polygons_are_left_out(tmp_path):
    write_mesh(tmp_path / "new.ply", Mesh(*tetrahedron(), document=Elsewhere()))
    assert read_mesh(tmp_path / "new.ply").document.texcoords is None


# --- strips, rests, comments ----------------------------------------------------------------------


def test_strips_are_triangles_and_stay_strips(tmp_path):
    header = (
        b"ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
        b"property float z\nelement tristrips 2\nproperty list int int vertex_indices\nend_header\n"
    )
    rows = b"0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n7 0 1 2 3 -1 2 3\n6 -1 2 3 4 4 -1\n"
    path, copy = tmp_path / "strips.ply", tmp_path / "copy.ply"
    path.write_bytes(header + rows)
    mesh = read_mesh(path)
    assert mesh.faces.tolist() == [[0, 1, 2], [2, 1, 3], [2, 3, 4]]
    write_mesh(copy, mesh, colors=random_colors(mesh))
    assert copy.read_bytes().endswith(b"7 0 1 2 3 -1 2 3\n6 -1 2 3 4 4 -1\n")
    np.testing.assert_array_equal(read_mesh(copy).faces, mesh.faces)


def test_faces_and_strips_together(tmp_path):
    data = (
        b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        b"property float z\nelement face 1\nproperty list uchar int vertex_index\n"
        b"property int part\nelement tristrips 1\nproperty list int int vertex_indices\n"
        b"end_header\n"
        b"0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 3 2 9\n3 3 2 1\n"
    )
    path = tmp_path / "both.ply"
    path.write_bytes(data)
    mesh = read_mesh(path)
    assert polygons_of(mesh) == [[0, 1, 3, 2], [3, 2, 1]]
    assert mesh.attributes["face"] == {}  # strips have none
    write_mesh(path, mesh)
    assert path.read_bytes() == data


def test_what_follows_the_last_element_is_kept(tmp_path):
    path, copy = tmp_path / "more.ply", tmp_path / "copy.ply"
    for encoding in ENCODINGS:
        path.write_bytes(colored_file(encoding) + b"and more")
        with pytest.warns(MeshdepictWarning, match="goes on after what its PLY header declares"):
            mesh = read_mesh(path)
        write_mesh(copy, mesh)
        assert copy.read_bytes() == path.read_bytes()


def test_numbers_that_are_whole_but_written_as_fractions(tmp_path):
    path = tmp_path / "colored.ply"
    path.write_bytes(colored_file("ascii").replace(b"3 0 1 2\n", b"3.0 0 1e0 2.\n"))
    assert read_mesh(path).faces.tolist() == [[0, 1, 2]]


def test_letters_beyond_ascii_in_comments(tmp_path):
    path = tmp_path / "colored.ply"
    for odd in ("Élan – σ=2".encode(), "Élan".encode("latin-1")):
        comment = b"comment " + odd + b"\n"
        path.write_bytes(colored_file("ascii").replace(b"element face", comment + b"element face"))
        mesh = read_mesh(path)
        write_mesh(path, mesh, colors=random_colors(mesh), comments=["meshdepict σ=2"])
        assert comment in path.read_bytes()
        assert read_provenance(path) == ["meshdepict σ=2"]


def test_provenance_reads_only_the_header(tmp_path):
    path = tmp_path / "cut.ply"
    mesh = Mesh(*tetrahedron())
    write_mesh(path, mesh, comments=OURS)
    end = path.read_bytes().index(b"end_header\n") + 11
    path.write_bytes(path.read_bytes()[:end])
    assert read_provenance(path) == OURS


def test_a_header_longer_than_one_read(tmp_path):
    path = tmp_path / "long.ply"
    lines = b"".join(b"comment %060d\n" % number for number in range(1000))
    path.write_bytes(colored_file("ascii").replace(b"element face", lines + b"element face"))
    mesh = read_mesh(path)
    write_mesh(path, mesh, comments=OURS)
    assert read_provenance(path) == OURS
    assert path.read_bytes().count(b"comment 0") == 1000


def test_documents_travel_to_other_processes(tmp_path):
    path = tmp_path / "colored.ply"
    path.write_bytes(colored_file("ascii"))
    document = read_mesh(path).document
    assert pickle.loads(pickle.dumps(document)) == document
