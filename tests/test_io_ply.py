"""PLY: every bit survives; checked against a slow reader and against plyfile."""

from __future__ import annotations

import pickle
import re
import struct
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import plyfile
import pytest
from conftest import tetrahedron

from meshdepict.errors import MeshdepictWarning
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.io.document import Document
from meshdepict.mesh import Mesh
from meshdepict.polygons import Polygons, as_polygons

CODES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I",
    "float": "f", "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
    "int32": "i", "uint32": "I", "float32": "f", "float64": "d",
}  # fmt: skip
ENCODINGS = ("ascii", "binary_little_endian", "binary_big_endian")
OURS = ["meshdepict 0.1 exaggerated", "meshdepict light=northwest"]

Rows = list[dict[str, Any]]


# --- a slow reader and a writer of odd files, to check the fast ones against ----------------------


def slow_read(data: bytes) -> tuple[list[str], dict[str, Rows]]:
    """The comments of a PLY file, and every value of it as the bytes of its type."""
    end = re.search(rb"end_header[ \t]*(\r\n|\n|\r)", data)
    assert end
    header = [line.split() for line in data[: end.start()].decode().splitlines()]
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[
        next(words[1] for words in header if words and words[0] == "format")
    ]
    at = end.end()
    words = data[at:].split() if not order else []

    def value(kind: str) -> bytes:
        nonlocal at
        code = CODES[kind]
        if order:
            size = struct.calcsize(code)
            raw = data[at : at + size]
            at += size
            return raw if order == "<" else raw[::-1]
        word = words.pop(0)
        return struct.pack("<" + code, float(word) if code in "fd" else int(word))

    elements: dict[str, tuple[int, list[list[str]]]] = {}
    for line in header:
        if line[:1] == ["element"]:
            elements[line[1]] = (int(line[2]), [])
        elif line[:1] == ["property"]:
            elements[list(elements)[-1]][1].append(line[1:])
    found: dict[str, Rows] = {}
    for name, (count, properties) in elements.items():
        found[name] = []
        for _ in range(count):
            row: dict[str, Any] = {}
            for item in properties:
                if item[0] == "list":
                    length = int.from_bytes(value(item[1]), "little")
                    row[item[3]] = (item[1:3], [value(item[2]) for _ in range(length)])
                else:
                    row[item[1]] = (item[0], value(item[0]))
            found[name].append(row)
    comments = [" ".join(line) for line in header if line[:1] in (["comment"], ["obj_info"])]
    return comments, found


def odd_file(rng: np.random.Generator, encoding: str, newline: str) -> bytes:
    """A valid PLY file with everything that the format allows and few programs expect."""
    kinds = list(CODES)
    padding = lambda: " " * int(rng.integers(1, 4))  # noqa: E731
    count = int(rng.integers(4, 9))
    faces = int(rng.integers(1, 7))
    ragged = bool(rng.integers(2))

    def extra(names: str) -> list[tuple[str, ...]]:
        found: list[tuple[str, ...]] = []
        for name in names[: rng.integers(0, len(names) + 1)]:
            kind = str(rng.choice(kinds))
            if rng.random() < 0.3:
                found.append(
                    ("list", str(rng.choice(["uchar", "ushort", "int", "uint"])), kind, name)
                )
            else:
                found.append((kind, name))
        return found

    position = [(str(rng.choice(["float", "double", "float32"])), axis) for axis in "xyz"]
    index = ("list", str(rng.choice(["uchar", "int", "uint", "uint8", "short"])),
             str(rng.choice(["int", "uint", "short", "uchar", "int32"])),
             str(rng.choice(["vertex_indices", "vertex_index"])))  # fmt: skip
    elements: list[tuple[str, int, list[tuple[str, ...]]]] = [
        ("camera", int(rng.integers(0, 3)), extra("abc") or [("float", "f")]),
        ("vertex", count, [*extra("pq"), *position, *extra("rst")]),
        ("nothing", 0, [("list", "uchar", "int", "vertex_indices"), ("float", "weight")]),
        ("face", faces, [*extra("uv"), index, *extra("w")]),
        ("edge", int(rng.integers(0, 3)), [("int", "vertex1"), ("int", "vertex2"), *extra("e")]),
    ]
    lines = ["ply", f"format {encoding} 1.0"]
    for name, rows, properties in elements:
        lines.append(f"element{padding()}{name}{padding()}{rows}{padding()}")
        lines += [padding().join(("property", *item)) + padding() for item in properties]
    for number in range(int(rng.integers(0, 5))):
        kind = rng.choice(["comment", "obj_info"])
        lines.insert(int(rng.integers(1, len(lines))), f"{kind} number {number}")
    header = newline.join([*lines, "end_header", ""]).encode()
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[encoding]

    def number(kind: str) -> int | float:
        code = CODES[kind]
        if code in "fd":
            raw = rng.bytes(struct.calcsize(code))
            value = float(struct.unpack("<" + code, raw)[0])
            return value if np.isfinite(value) else 0.5
        size = 8 * struct.calcsize(code)
        low = -(2 ** (size - 1)) if code.islower() else 0
        return int(rng.integers(low, low + 2**size))

    def spell(kind: str, value: float) -> bytes:
        if order:
            return struct.pack(order + CODES[kind], value)
        return (b"%.9g" if CODES[kind] == "f" else b"%r" if CODES[kind] == "d" else b"%d") % value

    body = []
    for name, rows, properties in elements:
        for _ in range(rows):
            row = []
            for item in properties:
                if item == index and name == "face":
                    corners = int(rng.integers(3, 6)) if ragged else 4
                    values: list[int | float] = rng.choice(count, corners).tolist()
                elif item[0] == "list":
                    values = [number(item[2]) for _ in range(int(rng.integers(0, 4)))]
                else:
                    values = [rng.normal() if item[1] in "xyz" else number(item[0])]
                if item[0] == "list":
                    row.append(spell(item[1], len(values)))
                row += [spell(item[-2], value) for value in values]
            body.append((b"" if order else b" ").join(row) + (b"" if order else newline.encode()))
    data = b"".join(body)
    return header + (data.rstrip() if not order and rng.integers(2) else data)


def expected_mesh(rows: dict[str, Rows]) -> tuple[np.ndarray, list[list[int]]]:
    vertices = [
        [struct.unpack("<" + CODES[kind], raw)[0] for kind, raw in (row["x"], row["y"], row["z"])]
        for row in rows["vertex"]
    ]
    faces = []
    for row in rows["face"]:
        (_, kind), items = row.get("vertex_indices") or row["vertex_index"]
        faces.append([struct.unpack("<" + CODES[kind], raw)[0] for raw in items])
    return np.array(vertices), faces


def polygons_of(mesh: Mesh) -> list[list[int]]:
    connectivity, offsets = mesh.polygons or as_polygons(mesh.faces)
    return [part.tolist() for part in np.split(connectivity, offsets[1:-1])]


def random_colors(mesh: Mesh, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)


def colors_of(mesh: Mesh, prefix: str = "") -> np.ndarray:
    vertex = mesh.attributes["vertex"]
    return np.stack([vertex[prefix + name] for name in ("red", "green", "blue")], axis=1)


def without(rows: Rows, names: tuple[str, ...]) -> Rows:
    return [{name: value for name, value in row.items() if name not in names} for row in rows]


# --- odd files --------------------------------------------------------------------------------


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


# --- real files -----------------------------------------------------------------------------------

REAL = {  # vertices, polygons, after the manifest
    "formats/ply_ascii_inside_out_bunny.ply": (35_947, 69_451),
    "formats/ply_big_endian_screwdriver.ply": (6_789, 13_574),
    "formats/ply_tristrips_hippo.ply": (23_105, 46_202),
    "formats/ply_ascii_ngons_shark.ply": (2_560, 2_562),
    "formats/ply_camera_element_rangemap.ply": (62_174, 118_779),
    "mesh/beetle_2k.ply": (1_148, 2_053),
    "mesh/fandisk_13k.ply": (6_475, 12_946),
    "mesh/gears_19k.ply": (9_723, 19_426),
    "mesh/bunny_69k.ply": (35_947, 69_451),
    "mesh/armadillo_86k.ply": (43_243, 86_482),
    "mesh/lucy_100k.ply": (49_987, 99_970),
    "mesh/nefertiti_100k.ply": (49_971, 99_938),
    "mesh/flake1_152k.ply": (75_967, 151_930),
    "mesh/dragon_203k.ply": (100_250, 202_520),
}


def known_lengths(path: Path) -> dict[str, dict[str, int]]:
    return {} if "tristrips" in path.name else {"face": {"vertex_indices": 3}}


def assert_text_kept(path: Path, copy: Path, mesh: Mesh) -> None:
    """Line by line: plyfile would need seconds."""
    old, new = (name.read_bytes().split(b"end_header\n")[1].splitlines() for name in (path, copy))
    count = len(mesh.vertices)
    table = np.loadtxt(old[:count], usecols=(0, 1, 2))
    np.testing.assert_array_equal(mesh.vertices, table.astype(np.float32))
    assert all(line.startswith(former.rstrip()) for line, former in zip(new, old, strict=True))
    assert new[count:] == old[count:]


@pytest.mark.parametrize("name", REAL)
def test_real_files(data, tmp_path, name):
    path, copy = data / name, tmp_path / "copy.ply"
    mesh = read_mesh(path, winding="keep")
    polygons = mesh.polygons or as_polygons(mesh.faces)
    assert (len(mesh.vertices), len(polygons.offsets) - 1) == REAL[name]
    write_mesh(copy, mesh)
    assert copy.read_bytes() == path.read_bytes()
    write_mesh(copy, mesh, colors=random_colors(mesh), comments=OURS)
    if b"format ascii" in path.read_bytes()[:100]:
        assert_text_kept(path, copy, mesh)
        return
    before = plyfile.PlyData.read(str(path), known_list_len=known_lengths(path), mmap="r")
    for axis, coordinate in enumerate("xyz"):
        np.testing.assert_array_equal(mesh.vertices[:, axis], before["vertex"][coordinate])
    after = plyfile.PlyData.read(str(copy), known_list_len=known_lengths(path), mmap="r")
    assert after.comments[: len(OURS)] == OURS
    assert after.comments[len(OURS) :] == before.comments
    assert (after.text, after.byte_order) == (before.text, before.byte_order)
    assert [element.name for element in after] == [element.name for element in before]
    for element in before:
        for item in element.properties:
            theirs, ours = element[item.name], after[element.name][item.name]
            if theirs.dtype == object:
                theirs, ours = np.concatenate(theirs), np.concatenate(ours)
            assert theirs.tobytes() == ours.tobytes()


def test_a_real_gzipped_file(data, tmp_path):
    mesh = read_mesh(data / "formats" / "ply_gz_dragon_res4.ply.gz")
    assert (len(mesh.vertices), len(mesh.faces)) == (5_205, 11_102)
    for name in ("copy.ply.gz", "copy.PLY.GZ"):
        write_mesh(tmp_path / name, mesh, colors=random_colors(mesh), comments=OURS)
        assert (tmp_path / name).read_bytes()[:2] == b"\x1f\x8b"
        np.testing.assert_array_equal(colors_of(read_mesh(tmp_path / name)), random_colors(mesh))
        assert read_provenance(tmp_path / name) == OURS


def test_the_real_file_that_contradicts_its_header(data):
    path = data / "formats" / "ply_ascii_texcoord_facecolour.ply"
    with pytest.raises(
        ValueError, match=r"row 0 \(from 0\) of face has 21 values where 15 are decl"
    ):
        read_mesh(path)


def test_large_files_are_fast(tmp_path):
    """200,000 triangles, and as many mixed polygons, take a fraction of a second."""
    count = 200_000
    rng = np.random.default_rng(0)
    vertices = rng.normal(size=(count // 2, 3))
    faces = rng.integers(0, count // 2, (count, 3))
    mesh = Mesh(vertices, faces, winding="keep")
    path = tmp_path / "large.ply"
    start = time.process_time()
    write_mesh(path, mesh, colors=random_colors(mesh))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_mesh(path, winding="keep")
    # Measured: 0.06 s; one microsecond per value would be 3 s.
    assert time.process_time() - start < 1

    sizes = rng.integers(3, 5, count)
    offsets = np.concatenate(([0], np.cumsum(sizes)))
    corners = rng.integers(0, count // 2, offsets[-1])
    mesh = Mesh(vertices, Polygons(corners, offsets), winding="keep")
    start = time.process_time()
    write_mesh(path, mesh)
    again = read_mesh(path, winding="keep")
    assert time.process_time() - start < 2
    np.testing.assert_array_equal(again.polygons.connectivity, corners)
