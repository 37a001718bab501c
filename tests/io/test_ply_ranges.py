"""PLY by ranges reads what reading all of it reads, and refuses what it can't."""

import numpy as np
import pytest

from meshdepict import samples
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_mesh, write_mesh
from meshdepict.io.ply_ranges import PlyRanges
from meshdepict.shapes.mesh import Mesh

HEAD = "ply\nformat binary_little_endian 1.0\n"
VERTEX = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
FACE = "element face 1\nproperty list uchar int vertex_indices\n"
POINTS = np.eye(3, dtype="<f4").tobytes()
TRIANGLE = b"\3" + np.arange(3, dtype="<i4").tobytes()


def test_ranges_are_parts_of_the_whole(tmp_path):
    path = tmp_path / "a.ply"
    write_mesh(path, samples.golf_ball(600, dimples=12))
    mesh, found = read_mesh(path, winding="keep"), PlyRanges(path)
    assert (found.vertices, found.faces) == (len(mesh.vertices), len(mesh.faces))
    np.testing.assert_array_equal(found.points(slice(7, 100)), mesh.vertices[7:100])
    some = np.array([5, 0, 99])
    np.testing.assert_array_equal(found.points(some), mesh.vertices[some])
    np.testing.assert_array_equal(found.triangles(slice(3, 40)), mesh.faces[3:40])


def test_rows_with_colours_are_written_in_any_order(tmp_path):
    path, out = tmp_path / "a.ply", tmp_path / "b.ply"
    write_mesh(path, samples.sphere(100))
    found = PlyRanges(path)
    header = found.colored_header(["meshdepict method: none"])
    colors = np.arange(3 * found.vertices).reshape(-1, 3).astype(np.uint8)
    with out.open("w+b") as file:
        file.write(header)
        for rows in (slice(50, found.vertices), slice(0, 50)):
            found.write_vertices(file, len(header), rows, colors[rows])
        for rows in (slice(20, found.faces), slice(0, 20)):
            found.write_faces(file, len(header), rows)
    assert out.stat().st_size == found.colored_size(len(header))
    read, given = read_mesh(out, winding="keep"), read_mesh(path, winding="keep")
    np.testing.assert_array_equal(read.vertices, given.vertices)
    np.testing.assert_array_equal(read.faces, given.faces)
    for axis, name in enumerate(("red", "green", "blue")):
        np.testing.assert_array_equal(read.attributes["vertex"][name], colors[:, axis])


@pytest.mark.parametrize(
    ("text", "data", "said"),
    [
        ("ply\nformat ascii 1.0\n" + VERTEX + FACE, b"", "no binary file"),
        (HEAD + VERTEX + FACE + "element edge 0\n", b"", "no binary file"),
        (HEAD + "element vertex 3\nproperty float x\n" + FACE, b"", "without x, y and z"),
        (
            HEAD + VERTEX + "element face 1\nproperty list uchar int strip\n",
            b"", "with other lists",
        ),
        (HEAD + VERTEX + "property float red\n" + FACE, b"", "colours that are no bytes"),
        (HEAD + VERTEX + FACE, POINTS + TRIANGLE[:-1], "cut off"),
        ("ply\nbroken", b"", "cut off in its PLY header"),
        (HEAD + VERTEX.replace("3", "0") + FACE.replace("1", "0"), b"", "has no faces"),
    ],
)  # fmt: skip
def test_a_file_of_another_kind_is_refused(tmp_path, text, data, said):
    path = tmp_path / "a.ply"
    path.write_bytes((text + ("" if "broken" in text else "end_header\n")).encode() + data)
    with pytest.raises(MeshdepictError, match=said):
        PlyRanges(path)


def test_rows_that_make_no_sense_are_refused(tmp_path):
    def made(points, triangle):
        path = tmp_path / "a.ply"
        path.write_bytes((HEAD + VERTEX + FACE + "end_header\n").encode() + points + triangle)
        return PlyRanges(path)

    every = slice(0, 1)
    with pytest.raises(MeshdepictError, match="not all triangles"):
        made(POINTS, b"\4" + TRIANGLE[1:]).triangles(every)
    with pytest.raises(MeshdepictError, match="not there"):
        made(POINTS, b"\3" + np.array([0, 1, 3], "<i4").tobytes()).triangles(every)
    nan = np.full(9, np.nan, "<f4").tobytes()
    with pytest.raises(MeshdepictError, match="NaN or infinite"):
        made(nan, TRIANGLE).points(every)
    with pytest.raises(MeshdepictError, match="can't be read"):
        PlyRanges(tmp_path / "nowhere.ply")


def test_big_endian_and_doubles_are_read(tmp_path):
    path = tmp_path / "a.ply"
    text = HEAD.replace("little", "big") + VERTEX.replace("float", "double") + FACE
    points = np.eye(3, dtype=">f8").tobytes()
    data = points + b"\3" + np.arange(3, dtype=">i4").tobytes()
    path.write_bytes((text + "end_header\n").encode() + data)
    np.testing.assert_array_equal(PlyRanges(path).points(slice(0, 3)), np.eye(3))
    np.testing.assert_array_equal(PlyRanges(path).triangles(slice(0, 1)), [[0, 1, 2]])
    assert isinstance(read_mesh(path), Mesh)
