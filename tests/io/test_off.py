"""OFF: its spellings with normals, colours and texture coordinates, and OFF BINARY."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from meshdepict.errors import MeshdepictWarning
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.polygons import as_polygons

FACES = "3 0 1 2\n4 0 1 3 2\n"
POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5]])


@pytest.fixture
def off(tmp_path: Path):
    def read(content: str | bytes) -> Mesh:
        path = tmp_path / "mesh.off"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        mesh = read_mesh(path, winding="keep")
        np.testing.assert_array_equal(mesh.vertices, POINTS)
        connectivity, offsets = mesh.polygons or as_polygons(mesh.faces)
        assert connectivity.tolist() == [0, 1, 2, 0, 1, 3, 2]
        assert offsets.tolist() == [0, 3, 7]
        return mesh

    return read


def text(keyword: str, tail: str = "", faces: str = FACES) -> str:
    rows = "".join(" ".join(map(repr, row)) + f" {tail}\n" for row in POINTS.tolist())
    return f"{keyword}\n4 2 0\n{rows}{faces}"


@pytest.mark.parametrize(
    "content",
    [
        text("OFF"),
        text("OFF").replace("OFF\n", "OFF "),
        text("OFF").replace("4 2 0", "4 2"),
        text("OFF").replace("\n", "\r\n"),
        text("OFF").replace("\n", "\r"),
        "\n# one\n# two\n" + text("OFF # three").replace("4 2 0", "# four\n\n4 2 0 # five"),
        text("OFF").rstrip(),
        text("OFF") + "\n\n",
        text("OFF", faces="3 0 1 2 7\n4 0 1 3 2\n"),  # an index into a colour map: left out
        text("OFF").replace("OFF\n", "OFF"),  # as ModelNet has it
        text("OFF").replace("OFF\n", "OFF").replace("4 2 0", "4 2"),
        "\ufeff" + text("OFF"),
        text("OFF").replace("\n", " "),  # line breaks anywhere
        text("OFF").replace(" ", "\n"),
        "OFF\n4 2 0\n" + text("OFF").split("\n", 2)[2].replace("\n", " "),
        "OFF\n4 2\n" + text("OFF").split("\n", 2)[2].replace("\n", " "),
        text("OFF", "1"),  # a weight
        text("off"),
    ],
)
def test_spellings(off, content):
    assert off(content).attributes == {"vertex": {}, "face": {}}


@pytest.mark.parametrize(
    ("keyword", "tail", "names"),
    [
        ("COFF", "255 0 128 255", "red green blue"),
        ("COFF", "255 0 128 7", "red green blue alpha"),
        ("COFF", "1 255 0 128", "red green blue"),  # a weight in front
        ("OFF", "1 1.0 0.0 0.5", "red green blue"),
        ("COFF", "1 255 0 128 7", "red green blue alpha"),
        ("COFF", "1.0 0.0 0.5 1.0", "red green blue"),
        ("COFF", "255 0 128", "red green blue"),
        ("OFF", "255 0 128 255", "red green blue"),
        ("NOFF", "0 0 1", "nx ny nz"),
        ("CNOFF", "0 0 1 255 0 128 255", "nx ny nz red green blue"),
        ("STOFF", "0.25 0.75", "s t"),
        ("STCNOFF", "0 0 1 255 0 128 255 0.25 0.75", "nx ny nz s t red green blue"),
    ],
)
def test_what_vertices_carry(off, keyword, tail, names):
    vertex = off(text(keyword, tail)).attributes["vertex"]
    assert list(vertex) == names.split()
    expected = {
        "red": 255,
        "green": 0,
        "blue": 128,
        "alpha": 7,
        "nx": 0,
        "nz": 1,
        "s": 0.25,
        "t": 0.75,
    }
    for name in names.split():
        assert set(vertex[name].tolist()) == {expected.get(name, 0)}
        if name in ("red", "green", "blue", "alpha"):
            assert vertex[name].dtype == np.uint8


@pytest.mark.parametrize("tail", ["255 0 51", "255 0 51 255", "1.0 0.0 0.2 1.0"])
def test_faces_with_colours(off, tmp_path, tail):
    mesh = off(text("OFF", faces=f"3 0 1 2 {tail}\n4 0 1 3 2 {tail}\n"))
    for _ in range(2):  # also after writing
        face = mesh.attributes["face"]
        assert [face[name].tolist() for name in ("red", "green", "blue")] == [
            [255, 255], [0, 0], [51, 51],
        ]  # fmt: skip
        write_mesh(tmp_path / "copy.off", mesh)
        mesh = read_mesh(tmp_path / "copy.off")


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("colored", [False, True])
def test_binary(off, order, colored):
    data = b"OFF BINARY\n" + struct.pack(order + "3i", 4, 2, 0)
    data += POINTS.astype(order + "f4").tobytes()
    for number, face in enumerate(([0, 1, 2], [0, 1, 3, 2])):
        data += struct.pack(f"{order}{1 + len(face)}i", len(face), *face)
        if colored:  # the first has four components, the second none
            data += struct.pack(order + "i4f", 4, 1, 0, 0, 1) if number == 0 else b"\0\0\0\0"
    off(data)


def test_writing_is_exact_and_says_who_wrote_it(tmp_path):
    points = POINTS / 3
    mesh = Mesh(points, [[0, 1, 2], [0, 1, 3, 2]])
    path = tmp_path / "mesh.off"
    colors = np.array([[255, 0, 7], [0, 0, 0], [1, 1, 1], [9, 8, 7]], np.uint8)
    write_mesh(path, mesh, colors=colors, comments=["meshdepict a", "meshdepict b"])
    assert path.read_text().startswith("COFF\n# meshdepict a\n# meshdepict b\n4 2 0\n")
    again = read_mesh(path)
    np.testing.assert_array_equal(again.vertices, points)
    assert [again.attributes["vertex"][name].tolist() for name in ("red", "green", "blue")] == (
        colors.T.tolist()
    )
    assert read_provenance(path) == ["meshdepict a", "meshdepict b"]
    write_mesh(path, again)  # keeps its colours, not the claim about them
    assert path.read_text().startswith("COFF\n4 2 0\n")
    write_mesh(path, mesh)
    assert path.read_text().startswith("OFF\n4 2 0\n")
    assert read_provenance(path) is None


def test_the_real_binary_file(data):
    mesh = read_mesh(data / "formats" / "off_binary_beetle.off", winding="keep")
    assert (len(mesh.vertices), len(mesh.faces)) == (5_105, 9_664)


def test_colours_without_line_breaks(off):
    words = text("COFF", "255 0 128 255").replace("\n", " ")
    assert [set(values.tolist()) for values in off(words).attributes["vertex"].values()] == [
        {255}, {0}, {128},
    ]  # fmt: skip


def test_more_faces_than_counted_are_read_with_a_note(off):
    with pytest.warns(MeshdepictWarning, match="counts 1 faces but holds 2: all are read"):
        off(text("OFF").replace("4 2 0", "4 1 0"))


def test_what_follows_the_faces_is_left_out_with_a_note(off):
    with pytest.warns(MeshdepictWarning, match="goes on after its faces: 2 lines are not read"):
        off(text("OFF") + "7 8\n9\n")


def test_alpha_is_written_again(tmp_path):
    path = tmp_path / "mesh.off"
    path.write_text(text("COFF", "255 0 128 7"))
    mesh = read_mesh(path)
    write_mesh(path, mesh, colors=np.zeros((4, 3), np.uint8), keep_colors=False)
    assert set(read_mesh(path).attributes["vertex"]["alpha"].tolist()) == {7}


@pytest.mark.parametrize(
    ("folder", "name"),
    [
        ("off-free-lines", "off_multiline_faces.off"),
        ("off-modelnet-header", "off_modelnet.off"),
    ],
)
def test_files_after_public_reports_are_read(data, folder, name):
    mesh = read_mesh(data / "cases" / folder / name, winding="keep")
    assert (len(mesh.vertices), len(mesh.faces)) == (922, 1_840)
