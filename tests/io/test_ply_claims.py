"""PLY: headers that claim too much, words for numbers, free line breaks, and range grids."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import ply, read_mesh, read_provenance, write_mesh

HEADER = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
{}element face 2
property list uchar int vertex_indices
{}end_header
"""
QUALITY = "property float quality\nproperty int label\n"
FACES = ["3 0 1 2", "3 2 1 3"]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "mesh.ply"


def content(
    rows: list[str], faces: list[str] = FACES, of_vertex: str = "", of_face: str = ""
) -> str:
    return HEADER.format(of_vertex, of_face) + "\n".join([*rows, *faces, ""])


ROWS = ["0 0 0", "1 0 0", "0 1 0", "1 1 0"]


# --- claims -------------------------------------------------------------------------------------


@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize("element", ["vertex 4", "face 2"])
def test_absurd_counts_are_named_no_damage_and_not_repeated(path, encoding, element):
    name = element.split()[0]
    text = content(ROWS).replace(f"element {element}", f"element {name} 99999999999")
    body = text.replace("ascii", encoding).encode()
    if encoding != "ascii" and name == "face":
        head, _, _ = body.partition(b"0 0 0")
        body = head + np.zeros(12, "<f4").tobytes() + b"\0" * 30
    path.write_bytes(body)
    with pytest.raises(MeshdepictError, match=f"counts more rows of {name}.* hold") as caught:
        read_mesh(path)
    assert "999" not in str(caught.value)


def test_a_count_of_five_thousand_digits_is_not_understood(path):
    path.write_text(content(ROWS).replace("vertex 4", "vertex " + "9" * 5000))
    with pytest.raises(MeshdepictError, match="line 3 is not understood"):
        read_mesh(path)


@pytest.mark.parametrize("encoding", ["ascii", "binary_big_endian"])
def test_elements_without_properties_take_nothing(path, encoding):
    text = (
        "ply\nformat ascii 1.0\nelement nothing 1000000000000\n" + content(ROWS).split("\n", 2)[2]
    )
    if encoding != "ascii":
        head = text.partition("0 0 0")[0].replace("ascii", encoding).encode()
        faces = b"".join(b"\3" + np.array(f, ">i4").tobytes() for f in ([0, 1, 2], [2, 1, 3]))
        points = np.array([row.split() for row in ROWS], ">f4").tobytes()
        path.write_bytes(head + points + faces)
    else:
        path.write_text(text)
    assert len(read_mesh(path).faces) == 2


def test_time_follows_the_properties():
    """A header and a row of many properties, in the form that was quadratic."""

    def spent(count: int) -> float:
        names = "".join(f"property float p{k}\n" for k in range(count))
        rows = [row + " 0" * count for row in ROWS]
        data = content(rows, of_vertex=names).encode()
        start = time.process_time()
        contents = ply.decode(data, Path("many.ply"))
        assert len(contents.attributes["vertex"]) == count
        return time.process_time() - start

    spent(100)
    # Eight times as many: 64 times the time if it were the square.
    assert spent(8000) < 25 * max(spent(1000), 0.01)


def test_looking_for_provenance_reads_no_byte_twice(path):
    """16 MB of comments without an end: the square of their number of reads would be a minute."""
    path.write_bytes(b"ply\nformat ascii 1.0\n" + b"comment a\n" * 1_600_000)
    start = time.process_time()
    assert read_provenance(path) is None
    assert time.process_time() - start < 5


# --- words for numbers --------------------------------------------------------------------------


@pytest.mark.parametrize("word", ["NA", "1.#QNAN", "null", "--", "?"])
def test_words_for_numbers_where_shading_needs_none(path, tmp_path, word):
    rows = [f"{row} {value} 7" for row, value in zip(ROWS, ("1", word, "3", word), strict=True)]
    path.write_text(content(rows, of_vertex=QUALITY))
    with pytest.warns(MeshdepictWarning, match="a number in 'quality' of vertex: taken as NaN"):
        mesh = read_mesh(path)
    np.testing.assert_array_equal(mesh.attributes["vertex"]["quality"], [1, np.nan, 3, np.nan])
    assert mesh.attributes["vertex"]["label"].tolist() == [7] * 4
    write_mesh(tmp_path / "copy.ply", mesh, colors=np.zeros((4, 3), np.uint8))
    assert f"1.0 0 0 {word} 7 0 0 0".replace("1.0", "1") in (tmp_path / "copy.ply").read_text()


@pytest.mark.parametrize("word", ["many", "nan", "1.5", "99999999999999", "inf"])
def test_whole_numbers_that_are_none_are_kept_but_not_read(path, tmp_path, word):
    rows = [f"{row} 1 {value}" for row, value in zip(ROWS, (1, word, 3, 4), strict=True)]
    path.write_text(content(rows, of_vertex=QUALITY))
    with pytest.warns(MeshdepictWarning, match=r"in 'label' of vertex: kept but not read"):
        mesh = read_mesh(path)
    assert list(mesh.attributes["vertex"]) == ["quality"]
    write_mesh(tmp_path / "copy.ply", mesh)
    assert (tmp_path / "copy.ply").read_bytes() == path.read_bytes()


def test_words_at_faces(path):
    faces = ["3 0 1 2 x", "3 2 1 3 0.5"]
    path.write_text(content(ROWS, faces, of_face="property double error\n"))
    with pytest.warns(MeshdepictWarning, match=r"'x' for a number in 'error' of face"):
        np.testing.assert_array_equal(read_mesh(path).attributes["face"]["error"], [np.nan, 0.5])


def test_a_word_in_a_coordinate_or_in_a_list_is_still_refused(path):
    rows = ["0 0 0 NA 7", "1 O 0 1 7", *(f"{row} 1 7" for row in ROWS[2:])]
    path.write_text(content(rows, of_vertex=QUALITY))
    with pytest.raises(MeshdepictError, match=r"row 1 .* 'O' for 'y', which is no float"):
        read_mesh(path)
    path.write_text(content(ROWS, ["3 0 1 a", FACES[1]]))
    with pytest.raises(MeshdepictError, match=r"row 0 .* 'a' for 'vertex_indices'"):
        read_mesh(path)


# --- vertices that no face uses -----------------------------------------------------------------


@pytest.mark.parametrize("bad", ["nan nan nan", "0 inf 0", "1e200 0 0", "-nan(ind) 0 0", "NaN 1 2"])
def test_strays_are_left_out_and_kept_in_the_file(path, tmp_path, bad):
    rows = [*ROWS, bad]
    path.write_text(content(rows).replace("vertex 4", "vertex 5").replace("float", "double"))
    with pytest.warns(MeshdepictWarning, match="1 vertices that no face uses are NaN, infinite or"):
        mesh = read_mesh(path)
    assert np.isfinite(mesh.vertices).all()
    assert mesh.diagonal == pytest.approx(2**0.5)
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1]] * 5)
    write_mesh(tmp_path / "copy.ply", mesh, colors=np.zeros((5, 3), np.uint8))
    assert f"{bad} 0 0 0\n" in (tmp_path / "copy.ply").read_text()


# --- line breaks --------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", [" ", "\n", "\n\n  "])
def test_line_breaks_anywhere_are_white_space(path, joint):
    head, rows = content([]).split("end_header\n")[0], " ".join([*ROWS, *FACES])
    path.write_text(f"{head}end_header\n" + joint.join(rows.split()))
    mesh = read_mesh(path)
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    assert mesh.faces.tolist() == [[0, 1, 2], [2, 1, 3]]
    write_mesh(path, mesh, colors=np.full((4, 3), 9, np.uint8))
    assert read_mesh(path).attributes["vertex"]["red"].tolist() == [9] * 4


def test_a_mark_in_front_is_no_part_of_the_file(path):
    path.write_bytes(b"\xef\xbb\xbf" + content(ROWS).encode())
    assert len(read_mesh(path).faces) == 2


# --- range grids --------------------------------------------------------------------------------


def grid_file(
    rows: int, columns: int, hole: set[int], *, step: float = 0.0, down: bool = False
) -> str:
    """A grid of points; those in the hole were not seen."""
    seen = [k for k in range(rows * columns) if k not in hole]
    number = {k: n for n, k in enumerate(seen)}
    points = []
    for k in seen:
        r, c = divmod(k, columns)
        points.append(f"{c} {-r if down else r} {step * (c >= columns // 2)}")
    cells = [f"1 {number[k]}" if k in number else "0" for k in range(rows * columns)]
    return (
        f"ply\nformat ascii 1.0\nobj_info num_cols {columns}\nobj_info num_rows {rows}\n"
        f"element vertex {len(seen)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element range_grid {rows * columns}\nproperty list uchar int vertex_indices\nend_header\n"
        + "\n".join([*points, *cells, ""])
    )


@pytest.mark.parametrize("down", [False, True])
@pytest.mark.filterwarnings("ignore:.*holds a range grid")
def test_neighbours_in_a_range_grid_make_triangles_that_face_the_scanner(path, tmp_path, down):
    path.write_text(grid_file(4, 6, {7, 8}, down=down))
    mesh = read_mesh(path)
    a, b, c = (mesh.vertices[corner] for corner in mesh.faces.T)
    cross = np.cross(b - a, c - a)
    assert (cross[:, 2] > 0).all()
    # 15 cells; of the 6 round the hole two have lost both halves and four one.
    assert cross[:, 2].sum() / 2 == pytest.approx(15 - 2 - 4 / 2)
    write_mesh(tmp_path / "copy.ply", mesh)
    assert (tmp_path / "copy.ply").read_bytes() == path.read_bytes()


@pytest.mark.filterwarnings("ignore:.*holds a range grid")
def test_no_triangle_spans_a_jump_in_depth(path):
    path.write_text(grid_file(4, 6, set(), step=50))
    mesh = read_mesh(path)
    assert len(mesh.faces) == 2 * 3 * 4
    assert np.ptp(mesh.vertices[mesh.faces, 2], axis=1).max() == 0


def test_a_range_grid_of_unknown_columns_is_named(path):
    path.write_text(grid_file(4, 6, set()).replace("num_cols 6", "num_cols 5"))
    with pytest.raises(MeshdepictError, match="holds a range grid, but its header doesn't say"):
        read_mesh(path)


def test_the_range_grid_after_a_public_report(data):
    with pytest.warns(MeshdepictWarning, match="holds a range grid"):
        mesh = read_mesh(data / "cases" / "ply-range-grid" / "ply_range_grid.ply")
    assert len(mesh.vertices) == 1145
    assert len(mesh.faces) > 1.7 * 1145
