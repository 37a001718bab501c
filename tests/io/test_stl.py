"""STL: corners at equal positions become one vertex."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from conftest import tetrahedron

from meshdepict.io import read_mesh


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
        binary(soup()),
        binary(soup(), b"solid that is binary"),
    ]


@pytest.mark.parametrize("number", range(5))
def test_spellings(tmp_path, number):
    path = tmp_path / "mesh.stl"
    path.write_bytes(spellings()[number])
    mesh = read_mesh(path, winding="keep")
    assert len(mesh.vertices) == 4
    expected = soup() if number < 3 else soup().astype("f4")
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
