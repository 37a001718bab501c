"""STL: corners at equal positions become one vertex."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from conftest import tetrahedron

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import read_mesh
from meshdepict.surface.icosahedron import icosphere


def binary(corners: np.ndarray, title: bytes = b"") -> bytes:
    rows = b"".join(
        struct.pack("<12fH", 0, 0, 0, *triangle.astype("f4").reshape(-1), 7) for triangle in corners
    )
    return title.ljust(80) + struct.pack("<I", len(corners)) + rows


def ascii_text(corners: np.ndarray) -> str:
    lines = ["solid a thing with facet in its name"]
    for triangle in corners.tolist():
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["  vertex " + " ".join(map(repr, corner)) for corner in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid a thing", ""])


def soup() -> np.ndarray:
    vertices, faces = tetrahedron()
    return vertices[faces] / 3


def spellings() -> list[bytes]:
    text = ascii_text(soup())
    return [
        text.encode(),
        text.replace("\n", "\r\n").encode(),
        text.upper().replace("E-", "e-").encode(),
        text.replace("\n", "\r").encode(),
        b"\xef\xbb\xbf" + text.encode(),
        text.replace("facet normal", "facet  \tnormal").replace("\n", " \n\n\t").encode(),
        text.replace("a thing", "vertex 1 2 3 facet").encode() + b"\n\0\0",
        b"solid\n" + " ".join(text.split("\n")[1:]).encode(),  # all facets on one line
        binary(soup()),
        binary(soup(), b"solid that is binary"),
        binary(soup(), b"solid with a line feed at its end") + b"\n",
    ]


@pytest.mark.parametrize("number", range(11))
def test_spellings(tmp_path, number):
    path = tmp_path / "mesh.stl"
    path.write_bytes(spellings()[number])
    mesh = read_mesh(path, winding="keep")
    assert len(mesh.vertices) == 4
    expected = soup() if number < 8 else soup().astype("f4")
    np.testing.assert_array_equal(mesh.vertices[mesh.faces], expected)


def test_vertices_come_in_the_order_of_their_appearance(tmp_path):
    path = tmp_path / "mesh.stl"
    path.write_bytes(binary(soup()))
    _, first = np.unique(read_mesh(path).faces, return_index=True)
    assert (np.diff(first) > 0).all()


def test_only_equal_positions_are_joined(tmp_path):
    corners = np.array(
        [[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[-0.0, 0, 0], [0, 1, 0], [1 + 2.0**-23, 0, 0]]]
    )
    path = tmp_path / "mesh.stl"
    path.write_bytes(binary(corners))
    assert read_mesh(path, winding="keep").faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_nothing_to_join(tmp_path):
    path = tmp_path / "mesh.stl"
    path.write_bytes(binary(np.arange(18.0).reshape(2, 3, 3) ** 2))
    assert read_mesh(path, winding="keep").faces.tolist() == [[0, 1, 2], [3, 4, 5]]


def test_two_solids_and_bytes_after_the_last_triangle(tmp_path):
    path = tmp_path / "mesh.stl"
    path.write_text(ascii_text(soup()[:2]) + ascii_text(soup()[2:]))
    assert len(read_mesh(path).faces) == 4
    path.write_bytes(binary(soup()) + b"more")
    assert len(read_mesh(path).faces) == 4


@pytest.mark.parametrize(
    ("name", "vertices", "faces"),
    [("stl_ascii_tray.stl", 2_216, 4_520), ("stl_binary_featuretype.stl", 2_010, 3_476)],
)
def test_real_files(data, name, vertices, faces):
    mesh = read_mesh(data / "formats" / name, winding="keep")
    assert (len(mesh.vertices), len(mesh.faces)) == (vertices, faces)


# --- a header's count is a claim ----------------------------------------------------------------


def ball_corners(count: int = 400) -> np.ndarray:
    points, faces = icosphere(count)
    return points[faces].astype("f4")


def counted(data: bytes, count: int) -> bytes:
    return data[:80] + struct.pack("<I", count) + data[84:]


@pytest.mark.parametrize("count", [0, 1, 100])
@pytest.mark.parametrize("tail", [b"", b"\n", b"\0" * 49])
def test_all_triangles_are_read_where_the_header_counts_too_few(tmp_path, count, tail):
    corners = ball_corners()
    path = tmp_path / "mesh.stl"
    path.write_bytes(counted(binary(corners), count) + tail)
    expected = f"counts {count:,} triangles in its header but holds {len(corners):,}: all are read"
    with pytest.warns(MeshdepictWarning, match=expected):
        mesh = read_mesh(path)
    np.testing.assert_array_equal(mesh.vertices[mesh.faces], corners)


@pytest.mark.parametrize(
    "tail",
    [b"\0" * 500, b"made by a program that says so at length, twice. " * 9, b"\xff" * 130],
    ids=["zeros", "text", "NaN"],
)
def test_what_follows_the_triangles_and_is_none_is_left_out_with_a_note(tmp_path, tail):
    corners = ball_corners()
    path = tmp_path / "mesh.stl"
    path.write_bytes(binary(corners) + tail)
    with pytest.warns(MeshdepictWarning, match=f"goes on after the {len(corners)} triangles"):
        assert len(read_mesh(path).faces) == len(corners)


def test_a_program_that_did_not_know_the_count_is_understood(tmp_path):
    corners = ball_corners()
    path = tmp_path / "mesh.stl"
    path.write_bytes(counted(binary(corners), 2**32 - 1))
    with pytest.warns(MeshdepictWarning, match="counts no triangles in its header"):
        assert len(read_mesh(path).faces) == len(corners)


@pytest.mark.parametrize("tail", [b"", b"1"])
def test_no_absurd_count_reaches_a_sentence(tmp_path, tail):
    path = tmp_path / "mesh.stl"
    path.write_bytes(counted(binary(soup()), 728_051_681) + tail)
    with pytest.raises(MeshdepictError, match="is no STL") as caught:
        read_mesh(path)
    assert "36,402" not in str(caught.value)
    path.write_bytes(counted(binary(soup()), 5))
    with pytest.raises(MeshdepictError, match="is cut off or no STL: 334 bytes are due, but 284"):
        read_mesh(path)


@pytest.mark.parametrize(
    ("folder", "names"),
    [
        ("stl-count-too-small", ["stl_count_small.stl"]),
        ("stl-solid-with-tail", ["stl_solid_tail.stl"]),
        ("stl-ascii-bom-or-cr", ["stl_ascii_bom.stl", "stl_ascii_cr.stl"]),
    ],
)
@pytest.mark.filterwarnings("ignore:.*counts 460 triangles")
def test_files_after_public_reports_hold_all_their_triangles(data, folder, names):
    good = read_mesh(data / "cases" / "soup-with-tiny-gaps" / "stl_ok.stl", winding="keep")
    for name in names:
        mesh = read_mesh(data / "cases" / folder / name, winding="keep")
        np.testing.assert_array_equal(mesh.faces, good.faces)
        np.testing.assert_allclose(mesh.vertices, good.vertices, atol=1e-6)  # of six digits
