"""Textures of GLB and glTF: what they show where, what is kept, and a depiction beside it."""

from __future__ import annotations

import base64
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from gltf_builder import Builder, colors_of

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.images.encoded import encode
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.shapes.mesh import Mesh

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float)  # glTF's v runs down
INK = np.array([[200, 10, 20], [30, 180, 50], [70, 90, 160], [250, 240, 230]], np.uint8)
NOTE = "its textures are kept in a scene of its own"


@pytest.fixture
def build() -> Builder:
    return Builder()


def picture() -> np.ndarray:
    """Four quarters of four texels each: upper left, upper right, lower left, lower right."""
    return INK[[[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]]]


def textured(
    build: Builder, *, uv: Any = UV, kind: str = "f4", image: dict[str, Any] | None = None,
    sampler: dict[str, int] | None = None, **info: Any,
) -> Builder:  # fmt: skip
    """A square of two triangles with the picture on it."""
    primitive = {
        "attributes": {
            "POSITION": build.accessor(SQUARE, "f4", min=[0, 0, 0], max=[1, 1, 0]),
            "TEXCOORD_0": build.accessor(uv, kind, normalized=kind != "f4"),
        },
        "indices": build.accessor(HALVES.reshape(-1), "u2"),
        "material": 0,
    }
    build.mesh(primitive)
    if image is None:
        image = {"bufferView": build.view(encode(picture())), "mimeType": "image/png"}
    build.header |= {
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "images": [image],
        "samplers": [sampler or {}],
        "textures": [{"source": 0, "sampler": 0}],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0} | info}}
        ],
    }  # fmt: skip
    return build


def seen(mesh: Mesh, *places: tuple[float, float]) -> np.ndarray:
    """The colours at places of the square, as bytes."""
    assert mesh.textures is not None
    at = np.array(places)
    upper = at[:, 1] > at[:, 0]
    weights = np.where(
        upper[:, None],
        np.c_[1 - at[:, 1], at[:, 0], at[:, 1] - at[:, 0]],
        np.c_[1 - at[:, 0], at[:, 0] - at[:, 1], at[:, 1]],
    )
    return np.rint(255 * mesh.textures.colors(upper.astype(int), weights)).astype(int)


QUARTERS = [(0.25, 0.75), (0.75, 0.75), (0.25, 0.25), (0.75, 0.25)]


@pytest.mark.parametrize("kind", ["f4", "u1", "u2"])
def test_a_texture_lies_as_the_standard_says(tmp_path, build, kind):
    """Its upper left texel is at (0, 0), which is the square's corner (0, 1)."""
    scale = 1 if kind == "f4" else np.iinfo(kind).max
    mesh = textured(build, uv=UV * scale, kind=kind).read(tmp_path)
    np.testing.assert_array_equal(seen(mesh, *QUARTERS), INK)
    np.testing.assert_allclose(mesh.texcoords, SQUARE[HALVES][..., :2])


@pytest.mark.parametrize("suffix", ["png", "jpeg", "webp"])
def test_pictures_are_inside_as_text_or_beside(tmp_path, build, suffix):
    data = encode(picture(), suffix, quality=None if suffix == "png" else 100)
    textured(build)
    off = 3 if suffix == "jpeg" else 0
    (tmp_path / "my picture.bin").write_bytes(data)
    inline = f"data:image/{suffix};base64,{base64.b64encode(data).decode()}"
    images = [{"uri": "my%20picture.bin"}, {"uri": inline}, {"bufferView": build.view(data)}]
    for image in images:
        build.header["images"] = [image]
        mesh = build.read(tmp_path)
        assert np.abs(seen(mesh, *QUARTERS) - INK).max() <= off
        assert mesh.textures.base_colors[0].kind == suffix
        assert mesh.textures.base_colors[0].encoded == data


def test_webp_stands_in_for_the_picture_that_others_read(tmp_path, build):
    textured(build)
    other = build.view(encode(picture()[::-1], "webp", quality=100))
    build.header["images"].append({"bufferView": other, "mimeType": "image/webp"})
    build.header["textures"][0]["extensions"] = {"EXT_texture_webp": {"source": 1}}
    build.header["extensionsUsed"] = ["EXT_texture_webp"]
    np.testing.assert_array_equal(seen(build.read(tmp_path), *QUARTERS), INK[[2, 3, 0, 1]])


def test_a_transform_turns_scales_and_moves(tmp_path, build):
    """The extension's own example: the lower left quarter, turned clockwise by 90°."""
    transform = {"offset": [0, 1], "rotation": math.pi / 2, "scale": [0.5, 0.5]}
    textured(build, extensions={"KHR_texture_transform": transform})
    mesh = build.read(tmp_path)
    np.testing.assert_allclose(mesh.texcoords.min(axis=(0, 1)), 0, atol=1e-9)
    np.testing.assert_allclose(mesh.texcoords.max(axis=(0, 1)), 0.5)
    # The square's upper left corner, (0, 0) for the standard, goes to the picture's (0, 1).
    np.testing.assert_allclose(mesh.texcoords[1, 2], [0, 0], atol=1e-9)
    # Its upper right, (1, 0), goes up from there: the picture is seen turned clockwise.
    np.testing.assert_allclose(mesh.texcoords[1, 1], [0, 0.5], atol=1e-9)


def test_a_material_chooses_its_coordinates(tmp_path, build):
    textured(build, texCoord=1)
    used = build.header["meshes"][0]["primitives"][0]["attributes"]
    used["TEXCOORD_1"] = build.accessor(UV[::-1], "f4")
    mesh = build.read(tmp_path)
    np.testing.assert_array_equal(seen(mesh, *QUARTERS), INK[[2, 3, 0, 1]])
    info = build.header["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    info["extensions"] = {"KHR_texture_transform": {"texCoord": 0}}
    np.testing.assert_array_equal(seen(build.read(tmp_path), *QUARTERS), INK)


@pytest.mark.parametrize(
    ("code", "wrap", "far"),
    [(10497, "repeat", [0, 1]), (33071, "clamp", [1, 1]), (33648, "mirror", [1, 0])],
)
def test_what_lies_beyond_the_edge_is_as_the_sampler_says(tmp_path, build, code, wrap, far):
    """The square shows the picture from 1 to 2: one to the right of it."""
    textured(build, uv=UV + np.array([1, 0]), sampler={"wrapS": code, "wrapT": 33071})
    mesh = build.read(tmp_path)
    assert mesh.textures.base_colors[0].wrap == (wrap, "clamp")
    np.testing.assert_array_equal(seen(mesh, (0.25, 0.75), (0.75, 0.75)), INK[far])


def test_several_materials_and_their_factors(tmp_path, build):
    """One half is textured and halved in light, the other has a colour alone."""
    textured(build)
    whole = build.header["meshes"][0]["primitives"][0]
    halves = [build.accessor(half, "u2") for half in HALVES]
    build.header["meshes"][0]["primitives"] = [
        whole | {"indices": half, "material": k} for k, half in enumerate(halves)
    ]
    rough = build.header["materials"][0]["pbrMetallicRoughness"]
    rough["baseColorFactor"] = [0.5, 1, 1, 1]
    build.header["materials"].append({"pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}})
    mesh = build.read(tmp_path)
    assert len(mesh.vertices) == 4
    assert mesh.textures.material.tolist() == [0, 1]
    assert not {"red", "green", "blue"} & set(mesh.attributes["vertex"])
    lower, upper = seen(mesh, (0.75, 0.25), (0.25, 0.75))
    assert upper.tolist() == [0, 255, 0]
    assert lower[1:].tolist() == INK[3, 1:].tolist()
    assert abs(lower[0] - 255 * ((0.9608 * 0.5) ** (1 / 2.2))) < 4


def test_normal_maps_with_scale_and_coordinates_of_their_own(tmp_path, build):
    textured(build)
    build.header["images"].append({"bufferView": build.view(encode(picture()))})
    build.header["textures"].append({"source": 1})
    used = build.header["meshes"][0]["primitives"][0]["attributes"]
    used["TEXCOORD_3"] = build.accessor(UV / 2, "f4")
    build.header["materials"][0]["normalTexture"] = {"index": 1, "texCoord": 3, "scale": 0.75}
    found = build.read(tmp_path).textures
    assert found.normal_scales.tolist() == [0.75]
    assert found.normal_maps[0].pixels.shape == (4, 4, 3)
    np.testing.assert_allclose(found.normal_texcoords[0], [[0, 0.5], [0.5, 0.5], [0.5, 1]])
    del build.header["materials"][0]["pbrMetallicRoughness"]
    alone = build.read(tmp_path).textures
    assert alone.base_colors == (None,)
    assert alone.normal_texcoords is None
    np.testing.assert_allclose(alone.texcoords[0], [[0, 0.5], [0.5, 0.5], [0.5, 1]])


def test_a_mirrored_node_keeps_each_corners_place(tmp_path, build):
    textured(build)
    build.header["nodes"] = [{"mesh": 0, "scale": [-1, 1, 1]}]
    mesh = build.read(tmp_path)
    for face, corners in zip(mesh.faces, mesh.texcoords, strict=True):
        at = mesh.vertices[face][:, :2] * [-1, 1]
        np.testing.assert_allclose(corners, at)


def test_draco_holds_texture_coordinates(tmp_path, build):
    draco = pytest.importorskip("DracoPy")
    textured(build)
    primitive = build.header["meshes"][0]["primitives"][0]
    packed = draco.encode(
        SQUARE.astype(np.float32), HALVES.astype(np.uint32), tex_coord=UV,
        quantization_bits=16, preserve_order=True,
    )  # fmt: skip
    found = draco.decode(packed)
    ids = {a["attribute_type"]: a["unique_id"] for a in found.attributes}
    numbers = {"POSITION": ids[0], "TEXCOORD_0": ids[3]}
    view = build.view(packed)
    primitive["extensions"] = {
        "KHR_draco_mesh_compression": {"bufferView": view, "attributes": numbers}
    }
    build.header["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    for name in numbers:
        del build.header["accessors"][primitive["attributes"][name]]["bufferView"]
    mesh = build.read(tmp_path)
    bake(mesh, tmp_path / "baked.glb")  # the original stays packed, the depiction isn't
    again = read_mesh(tmp_path / "baked.glb")
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    for found in (mesh, again):
        for face, corners in zip(found.faces, found.texcoords, strict=True):
            np.testing.assert_allclose(corners, found.vertices[face][:, :2], atol=1e-4)


def test_nothing_is_decoded_by_reading(tmp_path, build, monkeypatch):
    def forbidden(_: bytes) -> np.ndarray:
        raise AssertionError

    monkeypatch.setattr("meshdepict.shapes.textures.decode", forbidden)
    mesh = textured(build).read(tmp_path)
    assert mesh.textures.base_colors[0].name == "image 0"
    with pytest.raises(AssertionError):
        _ = mesh.textures.base_colors[0].pixels


# --- what is saved --------------------------------------------------------------------------------


def header_of(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    if not data.startswith(b"glTF"):
        return json.loads(data)
    return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


def bake(mesh: Mesh, path: Path, level: int = 90) -> None:
    """Save a mesh in one grey, as a bake would."""
    colors = np.full((len(mesh.vertices), 3), level, np.uint8)
    colors[0] = 7
    with pytest.warns(MeshdepictWarning, match=NOTE):
        write_mesh(path, mesh, colors=colors, comments=["meshdepict test"])


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_a_depiction_is_a_scene_beside_the_original(tmp_path, build, suffix):
    """The one is shown first, in unlit colours; the other is as it was, without them."""
    mesh = textured(build).read(tmp_path)
    path = tmp_path / f"baked{suffix}"
    bake(mesh, path)
    header = header_of(path)
    assert header["scene"] == 1
    assert [scene["name"] for scene in header["scenes"]] == ["original", "depiction"]
    node = header["nodes"][header["scenes"][1]["nodes"][0]]
    (primitive,) = header["meshes"][node["mesh"]]["primitives"]
    assert header["materials"][primitive["material"]]["extensions"] == {"KHR_materials_unlit": {}}
    assert set(primitive["attributes"]) == {"POSITION", "COLOR_0"}
    (own,) = header["meshes"][0]["primitives"]
    assert "COLOR_0" not in own["attributes"]
    assert primitive["attributes"]["POSITION"] == own["attributes"]["POSITION"]
    assert header["materials"][0] == build.header["materials"][0]
    again = read_mesh(path)
    assert read_provenance(path) == ["meshdepict test"]
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.faces, mesh.faces)
    assert colors_of(again).tolist() == [[7] * 3] + [[90] * 3] * 3
    np.testing.assert_array_equal(seen(again, *QUARTERS), INK)
    assert again.textures.base_colors[0].encoded == mesh.textures.base_colors[0].encoded


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_baking_again_replaces_the_depiction(tmp_path, build, suffix):
    textured(build).read(tmp_path)
    first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
    bake(read_mesh(tmp_path / "built.glb"), first)
    bake(read_mesh(first), second)
    write_mesh(tmp_path / f"third{suffix}", read_mesh(second))
    for path in (second, tmp_path / f"third{suffix}"):
        assert header_of(path) == header_of(first)
        assert path.stat().st_size == first.stat().st_size


def test_what_else_a_file_had_is_kept(tmp_path, build):
    textured(build)
    line = {"attributes": {"POSITION": build.accessor(SQUARE, "f4")}, "mode": 1}
    build.header["meshes"].append({"primitives": [line]})
    build.header["nodes"].append({"mesh": 1, "name": "a line", "extras": {"a": [1.5, None]}})
    build.header["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
    build.header["materials"][0]["emissiveFactor"] = [0.25, 0, 0]
    build.header["asset"] |= {"copyright": "somebody", "extras": {"a": "b"}}
    path = tmp_path / "baked.glb"
    bake(build.read(tmp_path), path)
    found = header_of(path)
    for name in ("nodes", "meshes", "materials", "images", "samplers", "textures", "cameras"):
        assert found[name][: len(build.header[name])] == build.header[name]
    assert found["asset"]["copyright"] == "somebody"
    assert found["asset"]["extras"] == {"a": "b", "meshdepict": ["meshdepict test"]}
    write_mesh(tmp_path / "plain.glb", build.read(tmp_path))
    plain = header_of(tmp_path / "plain.glb")
    for name in build.header:
        if name != "buffers":
            assert plain[name] == build.header[name]


def test_own_colours_stay_in_their_scene(tmp_path, build):
    textured(build)
    used = build.header["meshes"][0]["primitives"][0]["attributes"]
    used["COLOR_0"] = build.accessor(np.tile([255, 0, 0], (4, 1)), "u1", normalized=True)
    path = tmp_path / "baked.glb"
    bake(build.read(tmp_path), path)
    held = read_mesh(path).attributes["vertex"]
    assert held["original_red"].tolist() == [255] * 4
    assert held["red"].tolist() == [7, 90, 90, 90]
    assert header_of(path)["meshes"][0]["primitives"][0]["attributes"] == used


def test_external_files_go_along(tmp_path, build):
    textured(build)
    home, away = tmp_path / "home", tmp_path / "away"
    (home / "maps").mkdir(parents=True)
    away.mkdir()
    (home / "maps" / "a b.png").write_bytes(encode(picture()))
    build.header["images"] = [{"uri": "maps/a%20b.png"}]
    build.header["buffers"] = [{"uri": "square.bin", "byteLength": len(build.chunk)}]
    (home / "square.bin").write_bytes(build.chunk)
    (home / "square.gltf").write_text(json.dumps(build.header))
    mesh = read_mesh(home / "square.gltf")
    bake(mesh, away / "baked.gltf")
    assert (away / "maps" / "a b.png").read_bytes() == encode(picture())
    assert (away / "square.bin").read_bytes() == build.chunk
    np.testing.assert_array_equal(seen(read_mesh(away / "baked.gltf"), *QUARTERS), INK)
    bake(mesh, home / "baked.gltf")
    assert sorted(path.name for path in home.iterdir()) == [
        "baked.gltf", "maps", "square.bin", "square.gltf",
    ]  # fmt: skip
    bake(mesh, away / "all.glb")
    for path in (*away.glob("*/*"), away / "square.bin"):
        path.unlink()
    again = read_mesh(away / "all.glb")
    np.testing.assert_array_equal(seen(again, *QUARTERS), INK)
    assert header_of(away / "all.glb")["images"][0]["mimeType"] == "image/png"


def test_a_file_of_another_that_has_the_name_is_left(tmp_path, build):
    textured(build)
    home, away = tmp_path / "home", tmp_path / "away"
    home.mkdir()
    away.mkdir()
    (home / "a.png").write_bytes(encode(picture()))
    (away / "a.png").write_bytes(b"somebody's")
    build.header["images"] = [{"uri": "a.png"}]
    build.read(home)
    bake(read_mesh(home / "built.glb"), away / "baked.gltf")
    assert (away / "a.png").read_bytes() == b"somebody's"
    assert header_of(away / "baked.gltf")["images"][0]["uri"] == "a-2.png"
    np.testing.assert_array_equal(seen(read_mesh(away / "baked.gltf"), *QUARTERS), INK)


def test_turned_sheared_and_repeated_parts_are_drawn_where_they_are(tmp_path, build):
    """A part in a sheared place can't be shared: no node may have such a matrix."""
    textured(build)
    turn = [0, 0, math.sin(0.4), math.cos(0.4)]
    build.header["nodes"] = [
        {"children": [1, 2], "scale": [1, 3, 1]},
        {"mesh": 0, "rotation": turn, "translation": [5, 0, 1]},
        {"mesh": 0, "translation": [0, 4, 0.1]},
    ]
    with pytest.warns(MeshdepictWarning, match="2 parts"):
        mesh = build.read(tmp_path)
    path = tmp_path / "baked.glb"
    bake(mesh, path)
    with pytest.warns(MeshdepictWarning, match="2 parts"):
        again = read_mesh(path)
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    header = header_of(path)
    assert ["matrix" in header["nodes"][at] for at in header["scenes"][1]["nodes"]] == [False, True]
    scene = trimesh.load_scene(path, process=False)
    theirs = np.concatenate([part.vertices for part in scene.dump()])
    order = [np.lexsort(points.round(4).T) for points in (theirs, mesh.vertices)]
    np.testing.assert_allclose(theirs[order[0]], mesh.vertices[order[1]], atol=1e-6)


# --- what others read -----------------------------------------------------------------------------


def test_trimesh_reads_the_depiction_as_colours_beside_a_material(tmp_path, build):
    """In 16 bits and linear, and before its scene becomes one mesh, which drops them."""
    mesh = textured(build).read(tmp_path)
    bake(mesh, tmp_path / "baked.glb")
    scene = trimesh.load_scene(tmp_path / "baked.glb", process=False)
    (name,) = scene.graph.nodes_geometry
    shown = scene.geometry[scene.graph[name][1]]
    np.testing.assert_allclose(shown.vertices, mesh.vertices)
    assert shown.visual.kind == "texture"
    color = shown.visual.vertex_attributes["color"]
    linear = ((np.array([7, *[90] * 3]) / 255 + 0.055) / 1.055) ** 2.4
    linear[0] = 7 / 255 / 12.92
    np.testing.assert_allclose(color[:, 0] / 65535, linear, atol=1e-5)
    own = trimesh.load_scene(tmp_path / "built.glb", process=False).dump()[0]
    picture_seen = np.asarray(own.visual.material.baseColorTexture.convert("RGB"))
    np.testing.assert_array_equal(picture_seen, picture())
    theirs = own.visual.uv[own.faces]  # v up, as here
    np.testing.assert_allclose(theirs, mesh.texcoords)


def test_pyvista_reads_the_depiction(tmp_path, build):
    import pyvista as pv

    mesh = textured(build).read(tmp_path)
    bake(mesh, tmp_path / "baked.glb")
    shown = pv.read(tmp_path / "baked.glb").combine(merge_points=False)
    np.testing.assert_allclose(shown.points, mesh.vertices)
    assert shown.point_data["COLOR_0"].shape == (4, 4)
    assert shown.n_cells == 2  # of the depiction's scene alone


# --- quantised positions --------------------------------------------------------------------------


def test_quantised_positions_are_within_half_a_step(tmp_path, rng):
    """A step is a 65,535th of the longest side, whatever the place."""
    points = rng.normal(size=(50, 3)) * [1, 20, 0.01] + [5e5, 3e6, 0]
    faces = rng.permutation(150).reshape(50, 3) % 50
    mesh = Mesh(points, faces, winding="keep")
    colors = rng.integers(0, 256, (50, 3)).astype(np.uint8)
    for suffix in (".glb", ".gltf"):
        small, usual = (tmp_path / f"{name}{suffix}" for name in ("small", "usual"))
        write_mesh(usual, mesh, colors=colors)
        write_mesh(small, mesh, colors=colors, quantize=True)
        assert small.stat().st_size < usual.stat().st_size
        again = read_mesh(small, winding="keep")
        half = np.ptp(points, axis=0).max() / 65535 / 2
        assert np.abs(again.vertices - points).max() <= half * (1 + 1e-9) + 1e-9
        np.testing.assert_array_equal(again.faces, faces)
        np.testing.assert_array_equal(colors_of(again), colors)
        header = header_of(small)
        assert header["extensionsRequired"] == ["KHR_mesh_quantization"]
        accessor = header["accessors"][0]
        assert (accessor["componentType"], "normalized" in accessor) == (5123, False)
        assert header["bufferViews"][0]["byteStride"] == 8
        scene = trimesh.load_scene(small, process=False)
        np.testing.assert_allclose(scene.to_mesh().vertices, again.vertices, atol=1e-6)


def test_quantised_positions_are_for_gltf_alone(tmp_path, build):
    with pytest.raises(MeshdepictError, match=r"positions are for \.glb and \.gltf alone"):
        write_mesh(tmp_path / "mesh.ply", textured(build).read(tmp_path), quantize=True)


# --- what is wrong --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("image", "said"),
    [
        (
            {"uri": "gone.png"},
            r"names the texture 'gone\.png', which is not there: left out",
        ),
        ({"uri": "../up.png"}, r"names the texture '\.\./up\.png', which leads out of its folder"),
        ({"uri": "%2Fetc%2Fhosts"}, "an absolute path: only files in its own folder"),
        ({"uri": "https://a.b/c.png"}, "a URL: only files in its own folder"),
        ({"uri": "empty.png"}, r"names the texture 'empty\.png', which is empty"),
    ],
)
def test_a_picture_that_cannot_be_had_is_one_note(tmp_path, build, image, said):
    (tmp_path / "empty.png").write_bytes(b"")
    textured(build, image=image)
    with pytest.warns(MeshdepictWarning, match=said) as caught:
        mesh = build.read(tmp_path)
    assert len(caught) == 1
    with pytest.raises(MeshdepictError, match="the mesh's file names the texture"):
        _ = mesh.textures.base_colors[0].pixels
    for suffix in (".glb", ".gltf"):
        bake(mesh, tmp_path / f"baked{suffix}")
        assert header_of(tmp_path / f"baked{suffix}")["images"] == [image]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"images": [{"bufferView": 99}]}, "holds no picture for its texture 'image 0'"),
        ({"images": [{"uri": "data:image/png;base64,AAA"}]}, "holds no picture for its texture"),
        ({"textures": [{}]}, "has a texture, number 0, without a picture"),
    ],
)
def test_a_picture_that_is_damaged_is_one_sentence(tmp_path, build, change, said):
    textured(build).header |= change
    mesh = build.read(tmp_path)
    with pytest.raises(MeshdepictError, match=said):
        _ = mesh.textures.base_colors[0].pixels


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"textures": []}, "refers to number 0 of its 0 textures"),
        ({"textures": [{"source": 5}]}, "refers to number 5 of its 1 images"),
        ({"materials": [{"normalTexture": {}}]}, r"is wrong as glTF \(KeyError: 'index'\)"),
        ({"materials": [{"normalTexture": 7}]}, "a value of the wrong kind"),
    ],
)
def test_a_wrong_texture_leaves_the_shape(tmp_path, build, change, said):
    textured(build).header |= change
    mesh = build.read(tmp_path)
    assert len(mesh.faces) == 2
    with pytest.raises(MeshdepictError, match=said):
        _ = mesh.textures


def test_coordinates_that_are_missing_or_no_numbers(tmp_path, build):
    textured(build, uv=np.where(np.arange(8).reshape(4, 2) == 2, np.nan, UV))
    mesh = build.read(tmp_path)
    with pytest.warns(MeshdepictWarning, match="1 triangle with a texture has no coordinates"):
        assert mesh.textures.material.tolist() == [-1, 0]
    textured(other := Builder(), texCoord=4)
    mesh = other.read(tmp_path)
    with pytest.warns(MeshdepictWarning, match="all triangles with a texture have no coordinates"):
        assert mesh.textures is None
    used = build.header["meshes"][0]["primitives"][0]["attributes"]
    used["TEXCOORD_0"] = build.accessor(UV[:2], "f4")
    mesh = build.read(tmp_path)
    with pytest.raises(MeshdepictError, match="its TEXCOORD_0 don't fit its points"):
        _ = mesh.textures


def test_a_depiction_that_another_program_has_moved_is_read_as_it_is(tmp_path, build):
    """Its mark no longer fits: the file is kept whole, and depicted anew beside."""
    mesh = textured(build).read(tmp_path)
    bake(mesh, tmp_path / "baked.gltf")
    for change in ("node", "scene", "kind"):
        header = header_of(tmp_path / "baked.gltf")
        mark = header["scenes"][1]["extras"]["meshdepict"]
        if change == "node":
            header["nodes"].append({"name": "theirs"})
        elif change == "scene":
            mark["former"]["scene"] = 9
        else:
            header["scenes"][1]["extras"]["meshdepict"] = {"before": 3}
        header["asset"]["generator"] = "another"
        (tmp_path / "moved.gltf").write_text(json.dumps(header))
        moved = read_mesh(tmp_path / "moved.gltf")
        assert colors_of(moved)[1].tolist() == [90] * 3
        write_mesh(tmp_path / "kept.gltf", moved)
        assert header_of(tmp_path / "kept.gltf")["nodes"] == header["nodes"]


def test_a_depiction_without_its_original_is_read(tmp_path, build):
    """The file beside it, with the original's data, is gone."""
    textured(build)
    build.header["meshes"].append(build.header["meshes"][0])
    bake(build.read(tmp_path), tmp_path / "baked.gltf")
    header = header_of(tmp_path / "baked.gltf")
    header["meshes"][0]["primitives"][0]["indices"] = 99
    (tmp_path / "broken.gltf").write_text(json.dumps(header))
    assert colors_of(read_mesh(tmp_path / "broken.gltf"))[1].tolist() == [90] * 3
