"""Meshes that are saved with a baked texture."""

import json
import os

import numpy as np
import pytest
from PIL import Image
from textured_shapes import globe, sheet

from meshdepict import samples
from meshdepict.baking.textures import bake_texture
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.io.textured import TEXTURED, write_textured
from meshdepict.shapes.mesh import Mesh


@pytest.fixture(scope="module")
def baked():
    return bake_texture(globe(6), size=128)


def header(path):
    data = path.read_bytes()
    return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


@pytest.mark.parametrize("suffix", TEXTURED)
def test_what_was_saved_is_read_back_with_its_texture(baked, tmp_path, suffix):
    path = baked.save(tmp_path / f"ball{suffix}")
    found = read_mesh(path)
    corners = found.vertices[found.faces]
    assert np.abs(corners - baked.mesh.vertices[baked.mesh.faces]).max() < 1e-6
    assert np.abs(found.texcoords - baked.texcoords).max() < 1e-6
    (texture,) = (each for each in found.textures.base_colors if each is not None)
    assert np.array_equal(texture.pixels[..., :3], baked.image)
    assert read_provenance(path) == baked.comments


def test_png_holds_the_texture_alone_and_where_it_came_from(baked, tmp_path):
    from meshdepict.drawing.picture_files import read_picture_provenance

    path = baked.save(tmp_path / "ball.png")
    with Image.open(path) as image:
        assert np.array_equal(np.asarray(image.convert("RGB")), baked.image)
    assert read_picture_provenance(path) == baked.comments


def test_glb_is_unlit_and_says_how_to_sample(baked, tmp_path):
    own = header(baked.save(tmp_path / "own.glb"))
    (material,) = own["materials"]
    assert material["extensions"] == {"KHR_materials_unlit": {}}
    assert material["pbrMetallicRoughness"] == {"baseColorTexture": {"index": 0}}
    assert own["samplers"][0]["minFilter"] == 9987
    assert own["images"][0]["mimeType"] == "image/png"
    pairs = bake_texture(samples.golf_ball(200), size=128)
    new = header(pairs.save(tmp_path / "pairs.glb"))
    assert new["samplers"][0] | {"name": ""} == {
        "magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071, "name": "",
    }  # fmt: skip
    assert "COLOR_0" not in new["meshes"][0]["primitives"][0]["attributes"]


def test_a_glb_keeps_its_own_scene_beside_and_a_later_bake_replaces_the_texture(baked, tmp_path):
    first = baked.save(tmp_path / "first.glb")
    given = read_mesh(first)
    second = bake_texture(given, "lambert", size=64).save(tmp_path / "second.glb")
    assert len(header(second)["scenes"]) == 2
    again = read_mesh(second)
    assert np.array_equal(again.vertices, given.vertices)
    assert np.array_equal(
        again.textures.base_colors[0].pixels, given.textures.base_colors[0].pixels
    )
    third = bake_texture(again, "lambert", size=64).save(tmp_path / "third.glb")
    assert header(third) == header(second)


def middles(points, texcoords, faces):
    """Places and coordinates in the middle of triangles, in an order of their own."""
    rows = np.column_stack([points[faces].mean(axis=1), texcoords[faces].mean(axis=1)])
    return rows[np.lexsort(np.round(rows, 4).T)]


def agree(baked, points, texcoords, faces):
    """The same coordinates at the same places."""
    count = len(baked.mesh.faces)
    own = np.arange(3 * count).reshape(-1, 3)
    corners = baked.mesh.vertices[baked.mesh.faces].reshape(-1, 3)
    wanted = middles(corners, baked.texcoords.reshape(-1, 2), own)
    np.testing.assert_allclose(middles(points, texcoords, faces), wanted, atol=2e-6)


@pytest.mark.parametrize("suffix", [".glb", ".obj", ".ply"])
def test_trimesh_reads_the_texture(baked, tmp_path, suffix):
    trimesh = pytest.importorskip("trimesh")
    path = baked.save(tmp_path / f"ball{suffix}")
    found = trimesh.load(path, force="mesh", process=False)
    shown = found.visual.material
    image = getattr(shown, "baseColorTexture", None) or getattr(shown, "image", None)
    assert np.array_equal(np.asarray(image.convert("RGB")), baked.image)
    agree(baked, found.vertices, found.visual.uv, found.faces)


@pytest.mark.parametrize("suffix", [".glb", ".obj", ".ply"])
def test_vtk_reads_the_coordinates(baked, tmp_path, suffix):
    import pyvista as pv

    block = pv.read(baked.save(tmp_path / f"ball{suffix}"))
    while isinstance(block, pv.MultiBlock):
        block = block[0]
    places = np.array(block.active_texture_coordinates)
    if suffix == ".glb":  # whose v is down
        places = places * (1, -1) + (0, 1)
    agree(baked, np.array(block.points), places, block.regular_faces)


def test_obj_keeps_polygons_and_names_a_material_and_a_picture_beside(tmp_path):
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]], float)
    (tmp_path / "quad.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0 1\nvt 1 0\nmtllib old.mtl\nusemtl old\n"
        "f 1/1 2/2 3/3 4/4\nf 2/2 5/5 3/3\n"
    )
    (tmp_path / "old.mtl").write_text("newmtl old\nmap_Kd old.png\n")
    Image.new("RGB", (4, 4)).save(tmp_path / "old.png")
    mesh = read_mesh(tmp_path / "quad.obj")
    baked = bake_texture(mesh, "lambert", size=32)
    assert baked.provenance["texture"].endswith("atlas own")
    path = baked.save(tmp_path / "out.obj")
    text = path.read_text()
    assert "mtllib out.mtl" in text
    assert "old.mtl" not in text
    assert "usemtl old" in text
    assert "newmtl old\n" in (tmp_path / "out.mtl").read_text()
    assert [len(line.split()) - 1 for line in text.splitlines() if line.startswith("f ")] == [4, 3]
    assert "map_Kd out.png" in (tmp_path / "out.mtl").read_text()
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "old.mtl", "old.png", "out.mtl", "out.obj", "out.png", "quad.obj",
    ]  # fmt: skip
    found = read_mesh(path)
    assert np.allclose(found.texcoords, mesh.texcoords)


def test_saving_again_replaces_our_files_and_no_others(baked, tmp_path):
    Image.new("RGB", (2, 2)).save(tmp_path / "ball.png")
    theirs = (tmp_path / "ball.png").read_bytes()
    for _ in range(2):
        baked.save(tmp_path / "ball.obj")
    assert (tmp_path / "ball.png").read_bytes() == theirs
    assert sorted(os.listdir(tmp_path)) == ["ball-2.png", "ball.mtl", "ball.obj", "ball.png"]
    assert np.array_equal(
        read_mesh(tmp_path / "ball.obj").textures.base_colors[0].pixels, baked.image
    )


def test_ply_keeps_what_is_known_at_vertices(tmp_path):
    flat = sheet(3)
    quality = np.arange(16, dtype=np.float32)
    mesh = Mesh(flat.vertices, flat.faces, attributes={"vertex": {"quality": quality}})
    baked = bake_texture(mesh.with_textures(flat.textures), size=32)
    found = read_mesh(baked.save(tmp_path / "flat.ply"))
    assert np.array_equal(found.attributes["vertex"]["quality"], quality)
    assert b"comment TextureFile flat.png\n" in (tmp_path / "flat.ply").read_bytes()
    assert b"property list uchar float texcoord\n" in (tmp_path / "flat.ply").read_bytes()


@pytest.mark.parametrize("name", ["a.stl", "a.off", "a", "a.ply.gz"])
def test_files_that_hold_no_texture_are_refused(baked, tmp_path, name):
    with pytest.raises(MeshdepictError, match=r"textures are saved with their mesh as \.glb"):
        baked.save(tmp_path / name)
    with pytest.raises(MeshdepictError, match=r"meshes with textures are saved as \.glb"):
        write_textured(tmp_path / name, baked.mesh)
    assert not list(tmp_path.iterdir())


def test_maps_that_are_no_colours_are_pictures(tmp_path):
    found = bake_texture(globe(4), size=64, map="normal")
    with pytest.raises(MeshdepictError, match="a map of normal goes into a picture of its own"):
        found.save(tmp_path / "a.glb")
    with Image.open(found.save(tmp_path / "a.png")) as image:
        assert "srgb" not in image.info


def test_a_failure_leaves_nothing_half_written(baked, tmp_path, monkeypatch):
    from meshdepict.files import companions

    written = companions.atomic_write
    monkeypatch.setattr(
        companions, "atomic_write", lambda path: written(path.parent / "gone" / path.name)
    )
    for suffix in (".obj", ".ply"):
        with pytest.raises(MeshdepictError, match="no such folder"):
            baked.save(tmp_path / f"ball{suffix}")
    assert not list(tmp_path.iterdir())


# --- colours of vertices beside a baked texture ---------------------------------------------------


@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".ply", ".obj"])
def test_own_colours_stay_the_objects_beside_a_baked_texture(tmp_path, suffix):
    """Baked once more, the file is shaded in the colours that it had, and not refused."""
    flat = sheet(4)
    rng = np.random.default_rng(5)
    own = dict(zip(("red", "green", "blue"), rng.integers(0, 256, (3, 25), np.uint8), strict=True))
    mesh = Mesh(flat.vertices, flat.faces, attributes={"vertex": own}).with_textures(flat.textures)
    write_mesh(tmp_path / f"own{suffix}", mesh)
    given = read_mesh(tmp_path / f"own{suffix}")
    words = {"size": 64, "albedo": "keep", "light": (0, 0, 1)}
    first = bake_texture(given, "lambert", **words)
    again = read_mesh(first.save(tmp_path / f"baked{suffix}"))
    assert read_provenance(tmp_path / f"baked{suffix}")
    assert not again.document.is_recolored
    if suffix in (".glb", ".gltf"):
        assert np.array_equal(bake_texture(again, "lambert", **words).image, first.image)
    found = again.attributes["vertex"]
    assert all(np.abs(found[name].astype(int) - own[name]).max() <= 1 for name in own)
