"""glTF: what a scene means, instances, morphs, skins and colours, and what may be left aside."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from conftest import rotation
from gltf_builder import FACES, POINTS, Builder, colors_of

from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import read_mesh, write_mesh
from meshdepict.shapes.mesh import Mesh

INSTANCING, DRACO = "EXT_mesh_gpu_instancing", "KHR_draco_mesh_compression"


@pytest.fixture
def build() -> Builder:
    return Builder()


# --- extensions ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["EXT_who_knows", "KHR_gaussian_splatting", "CESIUM_RTC", 7])
def test_an_unknown_required_extension_is_refused_by_name(tmp_path, build, name):
    build.mesh(build.tetrahedron())
    build.header |= {"nodes": [{"mesh": 0}], "extensionsRequired": [name]}
    with pytest.raises(MeshdepictError, match=f"needs the glTF extension {name!r}, which is not"):
        build.read(tmp_path)


@pytest.mark.parametrize(
    "name", ["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform", INSTANCING]
)
def test_known_ones_and_unknown_ones_that_are_not_required_pass(tmp_path, build, name):
    build.mesh(build.tetrahedron())
    build.header |= {
        "nodes": [{"mesh": 0}], "extensionsRequired": [name], "extensionsUsed": ["EXT_who_knows"],
    }  # fmt: skip
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)


@pytest.mark.parametrize("name", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_meshopt_is_refused_where_data_are_only_compressed(tmp_path, build, name):
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0}]
    build.header["bufferViews"][0]["extensions"] = {name: {"buffer": 0}}
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)  # the fallback is there
    build.header["buffers"][0]["extensions"] = {name: {"fallback": True}}
    with pytest.raises(MeshdepictError, match=f"is compressed .{name}., which is not read"):
        build.read(tmp_path)
    build.header["extensionsRequired"] = [name]
    with pytest.raises(MeshdepictError, match=f"is compressed .{name}., which is not read"):
        build.read(tmp_path)


@pytest.fixture
def packed(build):
    """A tetrahedron that Draco compressed, with colours."""
    decoder = pytest.importorskip("DracoPy")
    colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [0, 0, 0]], np.uint8)
    data = decoder.encode(POINTS, FACES, quantization_bits=20, colors=colors, preserve_order=True)
    numbers = {a["attribute_type"]: a["unique_id"] for a in decoder.decode(data).attributes}
    primitive = build.tetrahedron()
    primitive["attributes"]["COLOR_0"] = build.accessor(np.zeros((4, 3)), "u1", normalized=True)
    extension = {
        "bufferView": build.view(data),
        "attributes": {"POSITION": numbers[0], "COLOR_0": numbers[2]},
    }
    build.mesh(primitive | {"extensions": {DRACO: extension}})
    build.header |= {"nodes": [{"mesh": 0}], "extensionsRequired": [DRACO]}
    for accessor in build.header["accessors"]:
        del accessor["bufferView"]
    return build


def test_draco_is_unpacked(tmp_path, packed):
    mesh = packed.read(tmp_path)
    np.testing.assert_allclose(mesh.vertices, POINTS, atol=2 / 2**20)  # its quantisation
    np.testing.assert_array_equal(mesh.faces, FACES)
    expected = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [0, 0, 0]]
    assert colors_of(mesh).tolist() == expected


def test_draco_without_its_reader_names_the_extra(tmp_path, packed, monkeypatch):
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    with pytest.raises(MeshdepictError, match=r"pip install 'meshdepict\[gltf\]'"):
        packed.read(tmp_path)
    del packed.header["extensionsRequired"]  # nothing uncompressed to fall back to
    with pytest.raises(MeshdepictError, match=r"pip install 'meshdepict\[gltf\]'"):
        packed.read(tmp_path)


def test_what_lies_uncompressed_beside_draco_is_taken(tmp_path, build, monkeypatch):
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    extension = {"bufferView": build.view(b"DRACO???"), "attributes": {"POSITION": 0}}
    build.mesh(build.tetrahedron(extensions={DRACO: extension}))
    build.header |= {"nodes": [{"mesh": 0}], "extensionsUsed": [DRACO]}
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)


def test_damaged_draco_is_one_sentence(tmp_path, packed):
    for junk in (b"nothing of the kind", packed.chunk[-200:-100]):
        view = packed.header["meshes"][0]["primitives"][0]["extensions"][DRACO]
        view["bufferView"] = packed.view(junk)
        with pytest.raises(MeshdepictError, match="its Draco part can't be decoded"):
            packed.read(tmp_path)


def test_a_draco_attribute_that_is_missing(tmp_path, packed):
    extension = packed.header["meshes"][0]["primitives"][0]["extensions"][DRACO]
    extension["attributes"]["POSITION"] = 77
    with pytest.raises(MeshdepictError, match="its Draco part has no attribute 'POSITION'"):
        packed.read(tmp_path)


# --- places -------------------------------------------------------------------------------------


def test_instances_are_put_where_they_belong(tmp_path, build, rng):
    shifts, sizes = rng.normal(size=(3, 3)), rng.uniform(1, 2, (3, 3))
    half = np.sqrt(0.5)
    turns = np.array([[0, 0, 0, 1], [0, 0, half, half], [1, 0, 0, 0]])
    matrices = [np.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], np.diag([1, -1, -1])]
    build.mesh(build.tetrahedron())
    extension = {
        "attributes": {
            "TRANSLATION": build.accessor(shifts, "f4"),
            "ROTATION": build.accessor(turns, "f4"),
            "SCALE": build.accessor(sizes, "f4"),
        }
    }
    build.header["nodes"] = [
        {"mesh": 0, "extensions": {INSTANCING: extension}, "scale": [2, 2, 2]},
    ]
    with pytest.warns(MeshdepictWarning, match="its 3 parts become one mesh"):
        mesh = build.read(tmp_path)
    expected = [
        2 * ((POINTS * size) @ np.transpose(matrix) + shift)
        for shift, size, matrix in zip(shifts, sizes, matrices, strict=True)
    ]
    np.testing.assert_allclose(mesh.vertices, np.concatenate(expected), atol=1e-6)
    assert len(mesh.faces) == 3 * len(FACES)
    extension["attributes"] = {"TRANSLATION": extension["attributes"]["TRANSLATION"]}
    with pytest.warns(MeshdepictWarning, match="its 3 parts"):
        mesh = build.read(tmp_path)
    expected = [2 * (POINTS + shift) for shift in shifts]
    np.testing.assert_allclose(mesh.vertices, np.concatenate(expected), atol=1e-6)


def test_instances_that_make_no_sense(tmp_path, build):
    build.mesh(build.tetrahedron())
    one, two = build.accessor(np.ones((1, 3)), "f4"), build.accessor(np.ones((2, 3)), "f4")
    bad = build.accessor(np.full((1, 3), np.inf), "f4")
    for used, sentence in (
        ({"TRANSLATION": one, "SCALE": two}, "have different lengths"),
        ({"TRANSLATION": bad}, "the transform of an instance is not finite"),
    ):
        node = {"mesh": 0, "extensions": {INSTANCING: {"attributes": used}}}
        build.header["nodes"] = [node]
        with pytest.raises(MeshdepictError, match=sentence):
            build.read(tmp_path)


def test_morph_weights_of_the_mesh_and_of_the_node_are_applied(tmp_path, build, rng):
    first, second = rng.normal(size=(2, 4, 3))
    targets = [{"POSITION": build.accessor(t, "f4")} for t in (first, second)]
    build.mesh(build.tetrahedron(targets=targets))
    build.header["nodes"] = [{"mesh": 0}]
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)
    build.header["meshes"][0]["weights"] = [0.5, 0.25]
    expected = POINTS + 0.5 * first + 0.25 * second
    np.testing.assert_allclose(build.read(tmp_path).vertices, expected, atol=1e-6)
    build.header["nodes"][0]["weights"] = [0, 2]
    np.testing.assert_allclose(build.read(tmp_path).vertices, POINTS + 2 * second, atol=1e-6)
    targets[1]["POSITION"] = build.accessor(second[:3], "f4")
    with pytest.raises(MeshdepictError, match="a morph target has 3 values for 4 vertices"):
        build.read(tmp_path)


def test_a_skin_is_where_its_joints_are(tmp_path, build, rng):
    """Each vertex hangs on two joints; the node's own transform counts for nothing."""
    poses = np.tile(np.eye(4), (2, 1, 1))
    for pose in poses:
        pose[:3, :3], pose[:3, 3] = rotation(rng), rng.normal(size=3)
    binds = np.tile(np.eye(4), (2, 1, 1))
    binds[:, :3, 3] = rng.normal(size=(2, 3))
    shares = np.array([[1, 0], [0.5, 0.5], [0.25, 0.75], [0, 1]])
    primitive = build.tetrahedron()
    primitive["attributes"] |= {
        "JOINTS_0": build.accessor(np.tile([0, 1, 0, 0], (4, 1)), "u1"),
        "WEIGHTS_0": build.accessor(np.c_[shares, np.zeros((4, 2))], "f4"),
    }
    build.mesh(primitive)
    flat = build.accessor(binds.transpose(0, 2, 1).reshape(8, 4), "f4")
    build.header["accessors"][flat] |= {"type": "MAT4", "count": 2}
    build.header["skins"] = [{"joints": [1, 2], "inverseBindMatrices": flat}]
    joints = [{"matrix": pose.T.reshape(-1).tolist()} for pose in poses]
    build.header["nodes"] = [{"mesh": 0, "skin": 0, "translation": [9, 9, 9]}, *joints]
    mesh = build.read(tmp_path)
    with pytest.warns(MeshdepictWarning, match="skins are not kept"):
        write_mesh(tmp_path / "lost.ply", mesh)
    homogeneous = np.c_[POINTS, np.ones(4)]
    each = [(homogeneous @ (pose @ bind).T)[:, :3] for pose, bind in zip(poses, binds, strict=True)]
    expected = shares[:, :1] * each[0] + shares[:, 1:] * each[1]
    np.testing.assert_allclose(mesh.vertices, expected, atol=1e-5)


def test_hidden_nodes_stay_hidden(tmp_path, build):
    build.mesh(build.tetrahedron())
    hidden = {"extensions": {"KHR_node_visibility": {"visible": False}}, "children": [2]}
    build.header["nodes"] = [{"mesh": 0}, hidden, {"mesh": 0}]
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)


# --- colours and units --------------------------------------------------------------------------


def test_base_colour_factors_are_the_colours_where_vertices_have_none(tmp_path, build):
    factors = [[0.8, 0.1, 0.1, 1], [0.1, 0.1, 0.8, 1]]
    build.header["materials"] = [
        {"pbrMetallicRoughness": {"baseColorFactor": factors[0]}},
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": factors[1]}}},
    ]
    whole = build.tetrahedron()
    build.mesh(whole | {"material": 0}, whole | {"material": 1})
    build.header["nodes"] = [{"mesh": 0}]
    with pytest.warns(MeshdepictWarning, match="2 parts"):
        mesh = build.read(tmp_path)
    expected = np.rint(255 * linear_to_srgb(np.array(factors)[:, :3]))
    np.testing.assert_array_equal(colors_of(mesh), np.repeat(expected, 4, axis=0))
    assert "alpha" not in mesh.attributes["vertex"]


def test_a_white_material_is_no_colour(tmp_path, build):
    build.header["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1]}}]
    build.mesh(build.tetrahedron(material=0))
    build.header["nodes"] = [{"mesh": 0}]
    assert "red" not in build.read(tmp_path).attributes["vertex"]


def test_the_case_of_two_base_colours(data, tmp_path):
    with pytest.warns(MeshdepictWarning, match="2 parts"):
        mesh = read_mesh(data / "cases" / "glb-base-colour-only" / "basecolor.glb")
    colors = colors_of(mesh).astype(int)
    left = mesh.vertices[:, 0] < 1.5
    assert (colors[left, 0] > colors[left, 2] + 50).all()  # red
    assert (colors[~left, 2] > colors[~left, 0] + 50).all()  # blue
    assert left.any()
    assert not left.all()


def test_one_colour_above_one_leaves_the_others(tmp_path, build):
    linear = np.full((4, 3), 0.2)
    for wild in (1.5, 1e30, np.inf, np.nan, -3):
        linear[0, 0] = wild
        primitive = build.tetrahedron()
        primitive["attributes"]["COLOR_0"] = build.accessor(linear, "f4")
        build.header |= {"meshes": [{"primitives": [primitive]}], "nodes": [{"mesh": 0}]}
        colors = colors_of(build.read(tmp_path))
        assert colors[0, 0] == (255 if wild > 1 else 0)
        assert (colors[1:] == 124).all()


def test_alpha_is_kept_and_written_again(tmp_path, build):
    rgba = np.array([[1, 0, 0, 1], [0, 1, 0, 0.5], [0, 0, 1, 0.25], [0, 0, 0, 0]])
    primitive = build.tetrahedron(material=0)
    primitive["attributes"]["COLOR_0"] = build.accessor(rgba, "f4")
    build.header["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}]
    build.mesh(primitive)
    build.header["nodes"] = [{"mesh": 0}]
    mesh = build.read(tmp_path)
    expected = [128, 64, 32, 0]
    assert mesh.attributes["vertex"]["alpha"].tolist() == expected
    for name in ("again.glb", "again.gltf", "again.ply"):
        write_mesh(tmp_path / name, mesh)
        again = read_mesh(tmp_path / name).attributes["vertex"]
        assert again["alpha"].tolist() == expected
        np.testing.assert_array_equal(again["red"], mesh.attributes["vertex"]["red"])


def test_gltf_is_in_metres_and_others_do_not_say(tmp_path, build):
    build.mesh(build.tetrahedron())
    build.header["nodes"] = [{"mesh": 0, "scale": [-1, 1, 1]}]
    mesh = build.read(tmp_path)
    assert mesh.length_unit == "m"
    with pytest.warns(MeshdepictWarning, match="inside out"):
        turned = Mesh(POINTS, FACES[:, ::-1], length_unit="m").rewound()
    assert turned.length_unit == "m"
    write_mesh(tmp_path / "mesh.ply", mesh)
    assert read_mesh(tmp_path / "mesh.ply").length_unit == ""
    assert Mesh(POINTS, FACES).length_unit == ""


# --- nothing to see -----------------------------------------------------------------------------


def test_a_model_of_the_size_of_a_point_is_refused(tmp_path, build):
    build.mesh(build.tetrahedron())
    for node in ({"mesh": 0, "scale": [0, 0, 0]}, {"mesh": 0, "matrix": [0] * 15 + [1]}):
        build.header["nodes"] = [node]
        with pytest.raises(MeshdepictError, match=r"has no size: the corners of its 4 triangles"):
            build.read(tmp_path)


def test_positions_without_data_are_all_at_one_point(tmp_path, build):
    primitive = build.tetrahedron()
    del build.header["accessors"][primitive["attributes"]["POSITION"]]["bufferView"]
    build.mesh(primitive)
    build.header["nodes"] = [{"mesh": 0}]
    with pytest.raises(MeshdepictError, match="has no size"):
        build.read(tmp_path)
