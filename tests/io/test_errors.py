"""Every way in which a file can be wrong gives one sentence that begins with its name."""

from __future__ import annotations

import gzip
import struct
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from conftest import tetrahedron

from meshdepict.errors import MeshdepictError
from meshdepict.io import read, read_mesh, read_provenance, text, write_mesh
from meshdepict.shapes.mesh import Mesh

HEADER = b"""ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
"""
ROWS = b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
FLOATS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
BINARY = HEADER.replace(b"ascii", b"binary_little_endian")

STL = b"\0" * 80 + struct.pack("<I", 1) + b"\0" * 50
ASCII_STL = b"""solid one
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid one
"""
OFF = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
GLB = struct.pack("<4sII", b"glTF", 2, 100)
VTP = (
    b'<VTKFile type="PolyData" version="0.1"><PolyData><Piece NumberOfPoints="0" NumberOfPolys="0">'
    b"</Piece></PolyData></VTKFile>"
)

WRONG = {
    # any format
    "empty.ply": (b"", "is empty"),
    "unknown.xyz": (b"0 0 0\n", "format is unknown; meshes are read from .ply, .obj"),
    "no_suffix": (b"what is this", "format is unknown"),
    "utf16.off": ("OFF 1 1 0".encode("utf-16"), "is text in UTF-16: save it as plain text"),
    "cut.ply.gz": (gzip.compress(HEADER + ROWS)[:-20], "is damaged: unpacking it failed"),
    "damaged.ply.gz": (b"\x1f\x8b" + b"\xff" * 50, "is damaged: unpacking it failed"),
    # PLY: the header
    "page.ply": (b"<html>", "is no PLY file"),
    "half_header.ply": (HEADER[:60], "is cut off in its PLY header"),
    "format.ply": (HEADER.replace(b"ascii", b"EBCDIC") + ROWS, "line 2 is not understood"),
    "no_format.ply": (HEADER.replace(b"format ascii 1.0\n", b"") + ROWS, "without the line 'form"),
    "type.ply": (HEADER.replace(b"float y", b"real y") + ROWS, "line 5 .* 'property real y'"),
    "list.ply": (HEADER.replace(b"list uchar", b"list float") + ROWS, "line 8 is not understood"),
    "count.ply": (HEADER.replace(b"vertex 3", b"vertex -3") + ROWS, "line 3 is not understood"),
    "orphan.ply": (b"ply\nformat ascii 1.0\nproperty int x\nend_header\n", "line 3"),
    "keyword.ply": (HEADER.replace(b"end_header", b"hello\nend_header") + ROWS, "'hello'"),
    "twice.ply": (HEADER.replace(b"float y", b"float x") + ROWS, "two properties of vertex call"),
    "elements.ply": (HEADER.replace(b"face 1", b"vertex 1") + ROWS, "two elements called 'vertex'"),
    "no_z.ply": (HEADER.replace(b"float z", b"float w") + ROWS, "no vertices with x, y and z"),
    "no_vertex.ply": (HEADER.replace(b"vertex 3", b"point 3") + ROWS, "no vertices with x, y"),
    # PLY: the rows
    "few_lines.ply": (HEADER + ROWS[:-8], "is cut off: it ends within the 1 rows of face"),
    "short_line.ply": (HEADER + ROWS.replace(b"1 0 0", b"1 0"), "row 1 .* has 2 values where 3"),
    "long_line.ply": (HEADER + ROWS[:-1] + b" 7\n", "face has 5 values where 4"),
    "word.ply": (HEADER + ROWS.replace(b"1 0 0", b"1 O 0"), "row 1 .* 'O' for 'y', which is no fl"),
    "negative.ply": (HEADER + ROWS.replace(b"3 0 1 2", b"-1 0 1 2"), "list 'vertex_indices' of -1"),
    "fraction.ply": (HEADER + ROWS.replace(b"0 1 2", b"0 1.5 2"), "'1.5' for 'vertex_indices'"),
    "range.ply": (
        HEADER.replace(b"int vertex", b"uchar vertex") + ROWS.replace(b"0 1 2", b"0 1 256"),
        "'256' for 'vertex_indices', which is no uchar",
    ),
    "cut_vertices.ply": (BINARY + FLOATS[:-1], "is cut off: it ends within the 3 rows of vertex"),
    "cut_faces.ply": (BINARY + FLOATS + b"\3" + b"\0" * 11, "is cut off: .* the 1 rows of face"),
    "cut_list.ply": (
        BINARY.replace(b"uchar", b"int") + FLOATS + struct.pack("<i", 10**9),
        "is cut off: .* the 1 rows of face",
    ),
    "negative_list.ply": (
        BINARY.replace(b"list uchar", b"list char").replace(b"face 1", b"face 2")
        + FLOATS
        + b"\3" + b"\0" * 12 + b"\xff" + b"\0" * 12,
        "contradicts its PLY header: a list in face is negative",
    ),
    "ragged_cut.ply": (
        BINARY.replace(b"face 1", b"face 3") + FLOATS + b"\1\0\0\0\0" + b"\3" + b"\0" * 12 + b"\3",
        "is cut off: .* the 3 rows of face",
    ),
    # the mesh in the file
    "cloud.ply": (HEADER.replace(b"face 1", b"face 0") + ROWS[:-8], ": the mesh has no faces"),
    "index.ply": (HEADER + ROWS.replace(b"0 1 2", b"0 1 3"), ": face 0 refers to vertex 3"),
    "nan.ply": (HEADER + ROWS.replace(b"1 0 0", b"1 nan 0"), ": 1 of 3 vertices are NaN"),
    "float_faces.ply": (HEADER.replace(b"int v", b"float v") + ROWS, ": faces must hold whole num"),
    # OBJ
    "empty.obj": (b"# nothing\n", "holds no vertices"),
    "short.obj": (b"v 1 2\nf 1 1 1\n", "a line 'v' with something else than 3 numbers"),
    "word.obj": (b"v 1 2 x\n", "a line 'v' with something else than 3 numbers"),
    "face.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 a 3\n", "a face, number 2, .*'1 a 3'"),
    "slashes.obj": (b"v 0 0 0\nf 1/1/1/1 1 1\n", "a face, number 1, that is not understood"),
    "zero.obj": (b"v 0 0 0\nv 1 0 0\nf 1 2 1\nf 0 1 2\n", "a face, number 2, with the index 0"),
    "beyond.obj": (b"v 0 0 0\nf 1 -2 1\n", ": face 0 refers to vertex -1"),
    # OFF
    "no_word.off": (b"3 1 0\n0 0 0\n", "is no OFF file"),
    "no_counts.off": (b"OFF\nthree one\n", "no numbers of vertices and faces"),
    "few.off": (OFF[:-9], "is cut off: 3 vertices and 1 faces are due"),
    "vertex.off": (OFF.replace(b"1 0 0\n", b"1 0\n"), "among the 3 vertices that doesn't fit"),
    "plane.off": (b"OFF 2 1 0\n0 0\n1 1\n3 0 1 1\n", "among the 2 vertices that doesn't fit"),
    "face.off": (OFF.replace(b"3 0 1 2", b"4 0 1 2"), "among the 1 faces that doesn't fit OFF"),
    "word.off": (OFF.replace(b"3 0 1 2", b"3 0 b 2"), "among the 1 faces that doesn't fit OFF"),
    "five.off": (b"OFF 1 1 0\n0 0 0 1 2\n3 0 0 0\n", "vertices of 5 numbers, which is unclear"),
    "absurd.off": (OFF.replace(b"3 1", b"99999999999 1"), "claims more vertices and faces below"),
    "huge.off": (OFF.replace(b"3 1", b"9" * 5000 + b" 1"), "no numbers of vertices|claims more"),
    "one_more.off": (
        OFF.replace(b"3 1 0", b"2 1 0") + b"3 0 1 2\n", "contradicts itself: below its 2 vertices"
    ),
    "half.off": (OFF.replace(b"3 0 1 2", b"3 0 1.5 2"), "among the 1 faces that doesn't fit OFF"),
    "endless.off": (OFF.replace(b"3 0 1 2", b"inf 0 1 2"), "among the 1 faces that doesn't fit"),
    "four.off": (b"4OFF\n", "points of other than three dimensions"),
    "binary.off": (b"OFF BINARY\n" + struct.pack("<3i", 5, 1, 0), "wrong as OFF BINARY"),
    "short_binary.off": (b"OFF BINARY\n1234", "wrong as OFF BINARY"),
    "cut_binary.off": (
        b"OFF BINARY\n" + struct.pack("<3i3f4i3i", 1, 2, 0, 0, 0, 0, 3, 0, 0, 0, 3, 0, 0),
        "wrong as OFF BINARY",
    ),
    "negative_binary.off": (
        b"OFF BINARY\n" + struct.pack("<3i3f5i", 1, 2, 0, 0, 0, 0, 3, 0, 0, 0, -3),
        "wrong as OFF BINARY",
    ),
    # STL
    "cut.stl": (STL[:-1], "is cut off or no STL: 134 bytes are due, but 133 are there"),
    "short.stl": (b"\0" * 40, "is cut off or no STL"),
    "cut_ascii.stl": (ASCII_STL[:-14], "wrong as ASCII STL: 1 facets with 3 corners, no endsolid"),
    "corners.stl": (ASCII_STL.replace(b"vertex 1 0 0\n", b""), "1 facets with 2 corners"),
    "word_ascii.stl": (ASCII_STL.replace(b"1 0 0", b"1 0 o"), "that is not three numbers"),
    # glTF
    "cut.glb": (GLB, "is cut off: 100 bytes are due, but 12 are there"),
    "version.glb": (struct.pack("<4sII", b"glTF", 1, 12), "is GLB of version 1"),
    "json.gltf": (b'{"asset": {"version": "2.0"}, ', "wrong as glTF: its JSON part"),
    "list.gltf": (b'["asset"]', "wrong as glTF: its JSON part"),
    "draco.gltf": (
        b'{"asset": {}, "extensionsRequired": ["KHR_draco_mesh_compression"]}',
        "is compressed .KHR_draco",
    ),
    "key.gltf": (b'{"asset": {}, "nodes": [{"mesh": 0}]}', "is wrong as glTF .KeyError: 'meshes'"),
    "nothing.gltf": (b'{"asset": {}}', ": the mesh is empty"),
    # VTP
    "cut.vtp": (VTP[:-5], "is cut off: it doesn't end with </VTKFile>"),
    "image.vtp": (VTP.replace(b"PolyData", b"ImageData"), "other VTK data than PolyData"),
    "wrong.vtp": (VTP.replace(b"<PolyData>", b"<PolyData><<"), "is wrong as VTP: .*Error parsing"),
    "nothing.vtp": (VTP, ": the mesh is empty"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_one_sentence(tmp_path: Path, name: str, capfd: pytest.CaptureFixture[str]):
    content, message = WRONG[name]
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(MeshdepictError, match=message) as caught:
        read(path)
    sentence = str(caught.value)
    assert sentence.startswith(str(path))
    assert "\n" not in sentence
    assert capfd.readouterr() == ("", "")  # VTK prints on stderr if it is let
    assert path.read_bytes() == content


def test_no_such_file(tmp_path):
    for function in (read_mesh, read_provenance):
        with pytest.raises(MeshdepictError, match="there is no such file"):
            function(tmp_path / "missing.ply")


def test_a_folder(tmp_path):
    with pytest.raises(MeshdepictError, match="is a folder, not a file"):
        read_mesh(tmp_path)
    with pytest.raises(MeshdepictError, match="holds no DICOM images"):
        read(tmp_path)


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (PermissionError(13, "Permission denied"), "may not be read: permission denied"),
        (OSError(5, "Input/output error"), "could not be read: Input/output error"),
    ],
)
def test_a_file_that_may_not_be_read(tmp_path, monkeypatch, fault, message):
    def refuse(*_args: object) -> None:
        raise fault

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(MeshdepictError, match=message):
        read_mesh(tmp_path / "mesh.ply")


def test_numbers_that_older_numpy_only_warns_of(monkeypatch):
    """Before 2.4 it returned what came before the misfit."""

    def before(*_args: object, **_options: object) -> None:
        warnings.warn("string or file could not be read to its end", DeprecationWarning, 2)

    monkeypatch.setattr(np, "fromstring", before)
    for parse in (text.floats, text.integers):
        with pytest.raises(ValueError, match="could not be read to its end"):
            parse(b"1 2 x")


def test_every_cut_of_a_file_is_noticed(tmp_path):
    """Wherever a binary file is cut, it is one sentence, never another mesh or exception."""
    mesh = Mesh(*tetrahedron(), attributes={"vertex": {"quality": np.arange(4.0)}})
    for suffix in (".ply", ".glb"):
        path = tmp_path / f"whole{suffix}"
        write_mesh(path, mesh)
        whole = path.read_bytes()
        for size in range(1, len(whole)):
            path.write_bytes(whole[:size])
            with pytest.raises(MeshdepictError):
                read_mesh(path)


def test_content_beats_the_suffix(tmp_path):
    contents = {
        "ply": HEADER + ROWS, "off": OFF, "binary stl": STL, "stl": ASCII_STL,
        "gz": gzip.compress(OFF),
    }  # fmt: skip
    for suffix in (".stl", ".ply", ".obj", ".txt", ""):
        for kind, content in contents.items():
            path = tmp_path / f"mesh{suffix}"
            path.write_bytes(content)
            assert len(read_mesh(path).faces) == 1, (kind, suffix)


# --- writing ------------------------------------------------------------------------------------


@pytest.fixture
def mesh() -> Mesh:
    return Mesh(*tetrahedron())


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("mesh.stl", "STL can't hold colours; save as .ply instead"),
        ("mesh.stl.gz", "STL can't hold colours"),
        (
            "mesh.xyz",
            "meshes are not saved as .xyz; use one of .ply, .obj, .off, .glb",
        ),
        ("mesh", "not saved as a file without suffix"),
        ("missing/mesh.ply", "there is no such folder"),
    ],
)
def test_where_a_mesh_can_not_be_saved(tmp_path, mesh, name, message):
    with pytest.raises(MeshdepictError, match=message):
        write_mesh(tmp_path / name, mesh)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "colors",
    [np.zeros((3, 3), np.uint8), np.zeros((4, 4), np.uint8), np.zeros((4, 3))],
    ids=["rows", "columns", "type"],
)
def test_wrong_colors(tmp_path, mesh, colors):
    with pytest.raises(MeshdepictError, match=r"colors must be uint8 of shape \(4, 3\)"):
        write_mesh(tmp_path / "mesh.ply", mesh, colors=colors)


@pytest.mark.parametrize(
    "comment",
    [
        "made by me",
        "meshdepict 1\nelement face 3",
        "meshdepict 1\r",
        "meshdepict\t",
        "Meshdepict 1",
    ],
)
def test_wrong_comments(tmp_path, mesh, comment):
    with pytest.raises(MeshdepictError, match="is not one line that begins with 'meshdepict '"):
        write_mesh(tmp_path / "mesh.ply", mesh, comments=[comment])


# --- provenance ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["page.ply", "unknown.xyz", "cut.glb", "cut.vtp", "json.gltf"])
def test_what_others_wrote_has_no_provenance(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(WRONG[name][0])
    assert read_provenance(path) is None


def test_stl_has_no_provenance(tmp_path):
    path = tmp_path / "mesh.stl"
    path.write_bytes(STL)
    assert read_provenance(path) is None


# --- imports ------------------------------------------------------------------------------------


def test_importing_and_reading_ply_is_light(tmp_path):
    path = tmp_path / "mesh.ply"
    path.write_bytes(HEADER + ROWS)
    script = (
        "import sys; from meshdepict.io import read_mesh; read_mesh(sys.argv[1]);"
        "heavy = {'trimesh', 'pyvista', 'vtkmodules', 'plyfile', 'scipy', 'numba', 'igl'};"
        "print(sorted(heavy & set(sys.modules)))"
    )
    found = subprocess.run(
        [sys.executable, "-c", script, str(path)], capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == "[]"
