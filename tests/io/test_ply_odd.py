"""PLY files with everything that the format allows: read right, and rewritten bit for bit."""

from __future__ import annotations

import re
import warnings

import numpy as np
import plyfile
import pytest
from odd_ply import (
    CODES,
    ENCODINGS,
    OURS,
    colors_of,
    expected_mesh,
    odd_file,
    polygons_of,
    random_colors,
    slow_read,
    without,
)

from meshdepict.io import read_mesh, read_provenance, write_mesh


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("seed", range(12))
def test_odd_files_are_read_and_rewritten_exactly(tmp_path, encoding, newline, seed):
    rng = np.random.default_rng([seed, len(newline), len(encoding)])
    data = odd_file(rng, encoding, newline)
    path, copy = tmp_path / "odd.ply", tmp_path / "copy.ply"
    path.write_bytes(data)
    comments, rows = slow_read(data)
    vertices, faces = expected_mesh(rows)

    mesh = read_mesh(path, winding="keep")
    np.testing.assert_array_equal(mesh.vertices, vertices)
    assert polygons_of(mesh) == faces
    for element in ("vertex", "face"):
        for name, values in mesh.attributes[element].items():
            kind, _ = rows[element][0][name]
            assert values.dtype == np.dtype(
                CODES[kind] if isinstance(kind, str) else CODES[kind[1]]
            )
            for row, value in zip(rows[element], values, strict=True):
                raw = row[name][1]
                assert np.asarray(value).tobytes() == (
                    raw if isinstance(raw, bytes) else b"".join(raw)
                )

    write_mesh(copy, mesh)
    assert copy.read_bytes().rstrip() == data.rstrip()

    write_mesh(copy, mesh, colors=random_colors(mesh), comments=OURS)
    new_comments, new_rows = slow_read(copy.read_bytes())
    assert [text for text in new_comments if "meshdepict" not in text] == comments
    assert list(new_rows) == list(rows)
    colored = read_mesh(copy, winding="keep")
    np.testing.assert_array_equal(colors_of(colored), random_colors(mesh))
    new_rows["vertex"] = without(new_rows["vertex"], ("red", "green", "blue"))
    assert new_rows == rows
    assert read_provenance(copy) == OURS

    # A second bake replaces the first one's colours and lines.
    write_mesh(copy, colored, colors=random_colors(mesh, 2), comments=OURS[:1])
    new_rows = slow_read(copy.read_bytes())[1]
    np.testing.assert_array_equal(
        colors_of(read_mesh(copy, winding="keep")), random_colors(mesh, 2)
    )
    new_rows["vertex"] = without(new_rows["vertex"], ("red", "green", "blue"))
    assert new_rows == rows
    assert read_provenance(copy) == OURS[:1]


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("seed", range(6))
def test_odd_files_agree_with_plyfile(tmp_path, encoding, seed):
    path = tmp_path / "odd.ply"
    data = odd_file(np.random.default_rng([seed, 77]), encoding, "\n")
    path.write_bytes(re.sub(rb"obj_info[^\n]*\n", b"", data))  # plyfile wants it at the top only
    mesh = read_mesh(path, winding="keep")
    write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "loadtxt: input contained no data")  # an empty list
        theirs = plyfile.PlyData.read(str(path), mmap=False)
    assert [text for text in theirs.comments if text.startswith("meshdepict")] == OURS
    for channel, column in zip(("red", "green", "blue"), random_colors(mesh).T, strict=True):
        np.testing.assert_array_equal(theirs["vertex"][channel], column)
    np.testing.assert_array_equal(theirs["vertex"]["y"], mesh.vertices[:, 1])
