"""GLB and glTF: transforms, every way to store numbers, and files that viewers show as baked."""

from __future__ import annotations

import base64
import io
import json
import struct
from typing import Any

import numpy as np
import pytest
import trimesh
from conftest import rotation
from gltf_builder import FACES, KINDS, POINTS, Builder, colors_of

from meshdepict.color.srgb import srgb_to_linear
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.shapes.mesh import Mesh


@pytest.fixture
def build() -> Builder:
    return Builder()


# --- numbers ------------------------------------------------------------------------------------


def test_every_type_of_index_and_position(tmp_path, build):
    for kind in ("u1", "u2", "u4"):
        build.header["meshes"].clear()
        build.header["nodes"] = [{"mesh": 0}]
        primitive = build.tetrahedron(indices=build.accessor(FACES.reshape(-1), kind))
        build.mesh(primitive)
        np.testing.assert_array_equal(build.read(tmp_path).faces, FACES)
    for kind in ("i1", "i2"):  # KHR_mesh_quantization
        whole = build.accessor(POINTS * 100, kind)
        build.header["meshes"][0]["primitives"] = [
            build.tetrahedron(attributes={"POSITION": whole})
        ]
        np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS * 100)
        fraction = build.accessor(POINTS * np.iinfo(kind).max, kind, normalized=True)
        build.header["meshes"][0]["primitives"] = [
            build.tetrahedron(attributes={"POSITION": fraction})
        ]
        np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)


def test_strides_and_offsets(tmp_path, build):
    rows = np.zeros(4, [("skip", "<u4"), ("point", "<f4", 3), ("normal", "<f4", 3)])
    rows["point"] = POINTS
    view = build.view(rows.tobytes(), byteStride=28)
    primitive = build.tetrahedron()
    build.header["accessors"][primitive["attributes"]["POSITION"]] |= {
        "bufferView": view, "byteOffset": 4,
    }  # fmt: skip
    build.mesh(primitive)
    build.header["nodes"] = [{"mesh": 0}]
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)


def test_sparse_accessors(tmp_path, build):
    primitive = build.tetrahedron()
    accessor = build.header["accessors"][primitive["attributes"]["POSITION"]]
    sparse = {
        "count": 2,
        "indices": {"bufferView": build.view(b"\1\3"), "componentType": KINDS["u1"]},
        "values": {"bufferView": build.view(np.full((2, 3), 7, "<f4").tobytes())},
    }
    accessor["sparse"] = sparse
    build.mesh(primitive)
    build.header["nodes"] = [{"mesh": 0}]
    expected = POINTS.copy()
    expected[[1, 3]] = 7
    np.testing.assert_array_equal(build.read(tmp_path).vertices, expected)
    del accessor["bufferView"]  # then all others are zero
    expected[[0, 2]] = 0
    np.testing.assert_array_equal(build.read(tmp_path).vertices, expected)


def test_strips_fans_and_no_indices(tmp_path, build):
    points = build.accessor(np.random.default_rng(0).normal(size=(6, 3)), "f4")
    order = build.accessor([0, 1, 2, 3, 4], "u1")
    triangles = {
        (4, False): [[0, 1, 2], [3, 4, 5]],
        (5, True): [[0, 1, 2], [2, 1, 3], [2, 3, 4]],
        (6, True): [[0, 1, 2], [0, 2, 3], [0, 3, 4]],
    }
    build.header["nodes"] = [{"mesh": 0}]
    for (mode, indexed), expected in triangles.items():
        primitive = {"attributes": {"POSITION": points}, "mode": mode}
        build.header["meshes"] = [
            {"primitives": [primitive | ({"indices": order} if indexed else {})]}
        ]
        assert build.read(tmp_path).faces.tolist() == expected


# --- the scene ----------------------------------------------------------------------------------


def test_transforms_multiply_along_the_tree(tmp_path, build, rng):
    matrix = np.eye(4)
    matrix[:3, :3] = rotation(rng) * 2
    matrix[:3, 3] = 5, 6, 7
    half = np.sqrt(0.5)
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [
        {"matrix": matrix.T.reshape(-1).tolist(), "children": [1]},
        {"rotation": [0, 0, half, half], "scale": [1, 2, 3], "translation": [1, 0, 0], "mesh": 0},
    ]
    turned = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) @ np.diag([1, 2, 3])
    expected = (POINTS @ turned.T + [1, 0, 0]) @ matrix[:3, :3].T + matrix[:3, 3]
    np.testing.assert_allclose(build.read(tmp_path).vertices, expected, atol=1e-12)
    build.header |= {"scenes": [{"nodes": []}, {"nodes": [1]}], "scene": 1}
    expected = POINTS @ turned.T + [1, 0, 0]
    np.testing.assert_allclose(build.read(tmp_path).vertices, expected, atol=1e-12)


def test_a_mirror_turns_faces_so_that_they_stay_outside(tmp_path, build):
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0, "scale": [-1, 1, 1]}]
    mesh = build.read(tmp_path)
    np.testing.assert_array_equal(mesh.faces, FACES[:, ::-1])
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    mirrored = np.einsum("ij,ij->", a, np.cross(b, c))
    a, b, c = (POINTS[FACES[:, k]] for k in range(3))
    assert mirrored == pytest.approx(np.einsum("ij,ij->", a, np.cross(b, c)))


def test_several_parts_become_one_and_say_so(tmp_path, build):
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]
    with pytest.warns(MeshdepictWarning, match=r"built\.glb: its 2 parts become one mesh"):
        mesh = build.read(tmp_path)
    np.testing.assert_array_equal(
        mesh.vertices, np.concatenate((POINTS, POINTS + np.array([5, 0, 0])))
    )
    np.testing.assert_array_equal(mesh.faces, np.concatenate((FACES, FACES + 4)))


def test_primitives_that_share_their_vertices_stay_one_part(tmp_path, build):
    whole = build.tetrahedron()
    halves = [build.accessor(part.reshape(-1), "u1") for part in (FACES[:2], FACES[2:])]
    build.mesh(*(whole | {"indices": half} for half in halves))
    build.header["nodes"] = [{"mesh": 0}]
    mesh = build.read(tmp_path)
    assert len(mesh.vertices) == 4
    np.testing.assert_array_equal(mesh.faces, FACES)


def test_what_is_lost_is_said(tmp_path, build):
    line = {"attributes": {"POSITION": build.accessor(POINTS, "f4")}, "mode": 1}
    build.mesh(build.tetrahedron(), line)
    build.header |= {"nodes": [{"mesh": 0}], "textures": [{}], "animations": [{}]}
    mesh = build.read(tmp_path)
    np.testing.assert_array_equal(mesh.faces, FACES)
    write_mesh(tmp_path / "kept.glb", mesh)
    said = "textures, animations, points and lines are not kept: save as .glb to keep them"
    with pytest.warns(MeshdepictWarning, match=said):
        write_mesh(tmp_path / "lost.ply", mesh)


def test_a_cycle_of_nodes_ends(tmp_path, build):
    build.mesh(build.tetrahedron())
    build.header |= {"nodes": [{"mesh": 0, "children": [0]}], "scenes": [{"nodes": [0]}]}
    assert len(build.read(tmp_path).faces) == 4


def test_an_index_beyond_its_own_part(tmp_path, build):
    """It must not reach into the next part's points."""
    build.mesh(build.tetrahedron(indices=build.accessor([0, 1, 4], "u1")), build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0}]
    with pytest.raises(MeshdepictError, match="has a glTF index of 4 with only 4 points"):
        build.read(tmp_path)


def test_buffers_that_are_too_short(tmp_path, build):
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0}]
    build.header["accessors"][0]["count"] = 10**6
    with pytest.raises(MeshdepictError, match="its buffers are shorter than its glTF header says"):
        build.read(tmp_path)


# --- colours ------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["u1", "u2", "f4"])
@pytest.mark.parametrize("channels", [3, 4])
def test_colours_are_linear_and_read_as_srgb(tmp_path, build, kind, channels):
    linear = np.array([[0, 0.2, 1, 1], [1, 0.2, 0, 0], [0.2, 0.2, 0.2, 1], [0, 0, 0, 1]])
    scale = 1 if kind == "f4" else np.iinfo(kind).max
    primitive = build.tetrahedron()
    color = build.accessor((linear * scale)[:, :channels], kind, normalized=kind != "f4")
    primitive["attributes"]["COLOR_0"] = color
    build.mesh(primitive)
    build.header["nodes"] = [{"mesh": 0}]
    expected = np.array([[0, 124, 255], [255, 124, 0], [124, 124, 124], [0, 0, 0]])
    assert np.abs(colors_of(build.read(tmp_path)).astype(int) - expected).max() <= (kind == "u1")

    build.header["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0.5, 1]}}]
    primitive["material"] = 0
    found = colors_of(build.read(tmp_path))
    assert (found[:, 0] == 0).all()
    assert found[0, 2] == 188  # half of the light


def test_parts_without_colours_are_white_beside_others(tmp_path, build):
    colored = build.tetrahedron()
    colored["attributes"]["COLOR_0"] = build.accessor(np.zeros((4, 3)), "f4")
    build.mesh(colored)
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0}, {"mesh": 1}]
    with pytest.warns(MeshdepictWarning, match="2 parts"):
        mesh = build.read(tmp_path)
    assert colors_of(mesh).tolist() == [[0, 0, 0]] * 4 + [[255, 255, 255]] * 4


def test_texture_coordinates_are_kept_as_attributes(tmp_path, build):
    primitive = build.tetrahedron()
    primitive["attributes"]["TEXCOORD_0"] = build.accessor(POINTS[:, :2] / 4, "f4")
    build.mesh(primitive)
    build.header["nodes"] = [{"mesh": 0}]
    vertex = build.read(tmp_path).attributes["vertex"]
    np.testing.assert_array_equal(np.stack((vertex["s"], vertex["t"]), 1), POINTS[:, :2] / 4)


# --- glTF files ---------------------------------------------------------------------------------


def test_buffers_beside_the_file_and_inside(tmp_path, build):
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0}]
    path = tmp_path / "scene.gltf"
    (tmp_path / "a buffer.bin").write_bytes(build.chunk)
    inside = "data:application/octet-stream;base64," + base64.b64encode(build.chunk).decode()
    for uri in ("a%20buffer.bin", inside):
        build.header["buffers"] = [{"uri": uri, "byteLength": len(build.chunk)}]
        path.write_text(json.dumps(build.header, indent=1))
        np.testing.assert_array_equal(read_mesh(path, winding="keep").vertices, POINTS)
    build.header["buffers"] = [{"uri": "missing.bin"}]
    path.write_text(json.dumps(build.header))
    with pytest.raises(MeshdepictError, match=r"needs the file 'missing\.bin' beside it"):
        read_mesh(path)


# --- what is written ----------------------------------------------------------------------------


@pytest.fixture
def written(tmp_path) -> tuple[dict[str, Any], bytes, np.ndarray]:
    colors = np.array([[0, 1, 2], [255, 128, 64], [9, 9, 9], [200, 100, 50]], np.uint8)
    path = tmp_path / "mesh.glb"
    write_mesh(path, Mesh(POINTS, FACES), colors=colors, comments=["meshdepict one"])
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + length]), data, colors


def test_the_layout_follows_the_standard(written):
    header, data, _ = written
    assert struct.unpack("<4sII", data[:12]) == (b"glTF", 2, len(data))
    start = 20 + struct.unpack("<I", data[12:16])[0]
    length, kind = struct.unpack("<I4s", data[start : start + 8])
    assert (kind, start + 8 + length, length % 4, start % 4) == (b"BIN\0", len(data), 0, 0)
    assert header["buffers"][0]["byteLength"] == length
    for view in header["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= length
    position = header["accessors"][0]
    assert (position["min"], position["max"]) == ([-1, -1, -1], [1, 1, 1])


def test_colours_are_linear_16_bit_and_unlit(written):
    header, data, colors = written
    primitive = header["meshes"][0]["primitives"][0]
    material = header["materials"][primitive["material"]]
    assert material["extensions"] == {"KHR_materials_unlit": {}}
    assert header["extensionsUsed"] == ["KHR_materials_unlit"]
    accessor = header["accessors"][primitive["attributes"]["COLOR_0"]]
    assert (accessor["componentType"], accessor["normalized"]) == (KINDS["u2"], True)
    view = header["bufferViews"][accessor["bufferView"]]
    start = len(data) - header["buffers"][0]["byteLength"] + view["byteOffset"]
    stored = np.frombuffer(data, "<u2", 16, start).reshape(4, 4)
    np.testing.assert_allclose(stored[:, :3] / 65535, srgb_to_linear(colors / 255), atol=1e-5)
    assert (stored[:, 3] == 65535).all()
    assert header["asset"]["extras"] == {"meshdepict": ["meshdepict one"]}


def test_trimesh_reads_what_is_written(tmp_path):
    points = POINTS / 3 + [5e5, 0, 0]
    write_mesh(tmp_path / "mesh.glb", Mesh(points, FACES))
    scene = trimesh.load_scene(tmp_path / "mesh.glb", process=False)
    theirs = scene.to_mesh()
    np.testing.assert_allclose(theirs.vertices, points, rtol=0, atol=1e-7)
    np.testing.assert_array_equal(theirs.faces, FACES)


def test_what_trimesh_writes_is_read(tmp_path, rng):
    scene = trimesh.Scene()
    expected = []
    for _ in range(2):
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = rotation(rng), rng.normal(size=3)
        scene.add_geometry(trimesh.Trimesh(POINTS, FACES, process=False), transform=matrix)
        expected.append(POINTS @ matrix[:3, :3].T + matrix[:3, 3])
    path = tmp_path / "theirs.glb"
    path.write_bytes(trimesh.exchange.gltf.export_glb(scene))
    with pytest.warns(MeshdepictWarning, match="2 parts"):
        mesh = read_mesh(path, winding="keep")
    np.testing.assert_allclose(mesh.vertices, np.concatenate(expected), atol=1e-6)


def test_big_coordinates_keep_their_digits(tmp_path):
    """Floats alone would round these to 1/32."""
    points = POINTS / 7 + [500_000.1, 5_000_000.2, 0]
    path = tmp_path / "mesh.gltf"
    write_mesh(path, Mesh(points, FACES))
    np.testing.assert_allclose(read_mesh(path).vertices, points, rtol=0, atol=2e-8)


def test_provenance_of_others_is_none(tmp_path):
    path = tmp_path / "mesh.gltf"
    for extras in ("a word", {"other": 1}, None):
        path.write_text(json.dumps({"asset": {"version": "2.0", "extras": extras}}))
        assert read_provenance(path) is None


def test_provenance_reads_no_geometry(tmp_path, written):
    _, data, _ = written
    path = tmp_path / "cut.glb"
    path.write_bytes(data[: 20 + struct.unpack("<I", data[12:16])[0]])
    assert read_provenance(path) == ["meshdepict one"]
    assert io.BytesIO(data).read(4) == b"glTF"
