"""What else a file holds, once a texture was baked for its mesh and saved in the same format."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from PIL import Image

from meshdepict.baking.textures import bake_texture
from meshdepict.errors import MeshdepictWarning
from meshdepict.io import read_mesh, read_provenance

# A folded strip of a square, a triangle and a square.
OBJ = """# a find
mtllib old.mtl
o vessel
v 0 0 0 0.5 0.25 1
v 1 0 0 1 1 1
v 1 1 0 0 0 0
v 0 1 0 0 1 0
v 2 0 1 0 0 1
v 2 1 1 1 0 0
vt 0 0
vt 0.45 0
vt 0.45 1
vt 0 1
vt 0.9 0
vt 0.9 0.9
vn 0 0 1
vn 0 1 0
g rim
usemtl clay
s 1
f 1/1/1 2/2/1 3/3/1 4/4/1
usemtl glaze
s off
f 2/2/2 \\
5/5/2 6/6/2 # the lid
f 2/2 6/6 3/3
l 1/1 2/2
p 6
vp 0.1 0.2
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "find.obj").write_text(OBJ)
    (tmp_path / "old.mtl").write_text("newmtl clay\nmap_Kd old.png\nnewmtl glaze\nmap_Kd old.png\n")
    Image.new("RGB", (4, 4), (9, 99, 199)).save(tmp_path / "old.png")
    return tmp_path


def saved(folder, source, out, **words):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshdepictWarning)
        mesh = read_mesh(folder / source)
        baked = bake_texture(mesh, "lambert", size=64, **words)
    return mesh, baked, baked.save(folder / out)


def same_places(baked, mesh, path):
    """What is read again has the texture where it was baked."""
    found = read_mesh(path)
    np.testing.assert_array_equal(found.vertices, mesh.vertices)
    np.testing.assert_array_equal(found.faces, mesh.faces)
    np.testing.assert_allclose(found.texcoords, baked.texcoords, atol=1e-6)
    shown = {texture.name for texture in found.textures.base_colors if texture is not None}
    assert len(shown) == 1
    for texture in found.textures.base_colors:
        np.testing.assert_array_equal(texture.pixels[..., :3], baked.image)
    assert read_provenance(path) == baked.comments
    return found


def without(text, *keywords):
    return [line for line in text.splitlines() if line.split()[:1] not in [[k] for k in keywords]]


def test_an_obj_with_its_own_coordinates_stays_line_by_line(folder):
    mesh, baked, path = saved(folder, "find.obj", "out.obj")
    same_places(baked, mesh, path)
    text = path.read_text().split("mtllib out.mtl\n")[1]
    assert text == OBJ.replace("mtllib old.mtl\n", "")
    library = (folder / "out.mtl").read_text()
    assert [line for line in library.splitlines() if line.startswith(("newmtl", "map_Kd"))] == [
        "newmtl clay", "map_Kd out.png", "newmtl glaze", "map_Kd out.png",
    ]  # fmt: skip


def test_an_obj_with_a_new_atlas_keeps_all_but_coordinates(folder):
    mesh, baked, path = saved(folder, "find.obj", "out.obj", atlas="new")
    found = same_places(baked, mesh, path)
    assert found.polygons is None
    text = path.read_text()
    kept = without(text, "mtllib", "vt", "f", "l")
    assert kept[len(baked.comments) :] == without(
        OBJ.replace(" \\\n5/5/2", " 5/5/2"), "mtllib", "vt", "f", "l"
    )
    faces = [line.split("#") for line in text.splitlines() if line.startswith("f ")]
    corners = [[word.split("/") for word in face[0].split()[1:]] for face in faces]
    assert [[int(word[0]) for word in face] for face in corners] == (mesh.faces + 1).tolist()
    # Of the square, which is two triangles now, of the lid, and of the last, which has none.
    assert [[word[2:] for word in face] for face in corners] == [
        [["1"]] * 3, [["1"]] * 3, [["2"]] * 3, [[]] * 3,
    ]  # fmt: skip
    assert [face[1:] for face in faces] == [[], [], [" the lid"], []]
    assert "\nl 1 2\n" in text
    order = [line.split()[0] for line in text.splitlines() if line[:2] in ("f ", "us", "s ", "g ")]
    assert order == ["g", "usemtl", "s", "f", "f", "usemtl", "s", "f", "f"]


def test_an_obj_whose_material_scales_coordinates_gets_them_scaled(folder):
    (folder / "old.mtl").write_text(
        "newmtl clay\nmap_Kd -s 0.5 0.5 old.png\nnewmtl glaze\nmap_Kd -s 0.5 0.5 old.png\n"
    )
    mesh, baked, path = saved(folder, "find.obj", "out.obj")
    found = same_places(baked, mesh, path)
    assert found.polygons is not None  # the square stays one
    assert "f 1/1/1 2/" in path.read_text()


def test_faces_without_a_material_get_one(folder):
    for name in ("first", "no"):
        text = OBJ.replace("usemtl clay\n", "")
        (folder / f"{name}.obj").write_text(
            text.replace("usemtl glaze\n", "") if name == "no" else text
        )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, count in (("first", 2), ("no", 1)):
            mesh, baked, path = saved(folder, f"{name}.obj", f"{name}-out.obj", atlas="new")
            same_places(baked, mesh, path)
            assert path.read_text().count("usemtl") == count


def test_colours_of_a_former_bake_go_and_a_second_texture_replaces_the_first(folder):
    import meshdepict as md

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        md.bake(folder / "find.obj", "lambert").save(folder / "colored.obj")
    mesh, baked, path = saved(folder, "colored.obj", "out.obj")
    found = same_places(baked, mesh, path)
    assert "red" not in found.attributes["vertex"]
    first = path.read_text()
    _, again, _ = saved(folder, "out.obj", "out.obj", light="east")
    assert path.read_text().split("mtllib")[1] == first.split("mtllib")[1]
    same_places(again, mesh, path)
    assert sorted(p.name for p in folder.glob("out*")) == ["out.mtl", "out.obj", "out.png"]


def test_carriage_returns_stay(folder):
    (folder / "dos.obj").write_bytes(OBJ.replace("\n", "\r\n").encode())
    for atlas in (None, "new"):
        mesh, baked, path = saved(folder, "dos.obj", "out.obj", atlas=atlas)
        same_places(baked, mesh, path)
        assert b"vp 0.1 0.2\r\n" in path.read_bytes()
    (folder / "mac.obj").write_bytes(OBJ.replace("\n", "\r").encode())
    mesh, baked, path = saved(folder, "mac.obj", "out.obj", atlas="new")
    same_places(baked, mesh, path)


# --- PLY ----------------------------------------------------------------------------------------

HEADER = """ply
format {format} 1.0
comment a find
comment TextureFile old.png
obj_info scanned twice
element vertex 6
property float x
property float y
property float z
property float quality
property uchar red
property uchar green
property uchar blue
{vertex}element camera 1
property double focal
property list uchar int marks
element face 3
property list uchar int vertex_indices
property uchar label
{face}element corner_of_a_room 2
property int number
end_header
"""
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 1), (2, 1, 1)]
UV = [(0, 0), (0.45, 0), (0.45, 1), (0, 1), (0.9, 0), (0.9, 0.9)]
FACES = [(0, 1, 2, 3), (1, 4, 5), (1, 5, 2)]


def ply(layout):
    """An ASCII file with texture coordinates of faces, or of vertices, or with none."""
    of_faces, of_vertices = layout == "faces", layout == "vertices"
    lines = [
        HEADER.format(
            format="ascii",
            vertex="property float s\nproperty float t\n" if of_vertices else "",
            face="property list uchar float texcoord\nproperty int texnumber\n" if of_faces else "",
        ).rstrip()
    ]
    for number, point in enumerate(POINTS):
        more = UV[number] if of_vertices else ()
        lines.append(" ".join(map(str, (*point, number / 2, number, 9, 200, *more))))
    lines.append("35.5 2 7 8")
    for number, face in enumerate(FACES):
        row = [len(face), *face, number]
        if of_faces:
            row += [2 * len(face), *(x for corner in face for x in UV[corner]), 0]
        lines.append(" ".join(map(str, row)))
    return "\n".join([*lines, "41", "42"]) + "\n"


def elements(path):
    """All numbers of a file by element and property, and its header."""
    from plyfile import PlyData

    held = PlyData.read(str(path))
    found = {}
    for element in held.elements:
        for item in element.properties:
            found[element.name, item.name] = [
                np.asarray(v).tolist() for v in element.data[item.name]
            ]
    return found, held


def binary(folder, order):
    from plyfile import PlyData

    held = PlyData.read(str(folder / "find.ply"))
    PlyData(held.elements, text=False, byte_order=order, comments=held.comments).write(
        str(folder / "find.ply")
    )


@pytest.mark.parametrize("encoding", ["", "<", ">"])
@pytest.mark.parametrize("layout", ["faces", "vertices"])
def test_a_ply_with_its_own_coordinates_stays_but_for_the_pictures_name(folder, layout, encoding):
    pytest.importorskip("plyfile")
    (folder / "find.ply").write_text(ply(layout))
    if encoding:
        binary(folder, encoding)
    before = (folder / "find.ply").read_bytes()
    mesh, baked, path = saved(folder, "find.ply", "out.ply")
    same_places(baked, mesh, path)
    after = path.read_bytes()
    lines = [line for line in after.split(b"\n") if not line.startswith(b"comment meshdepict ")]
    assert b"\n".join(lines) == before.replace(b"TextureFile old.png", b"TextureFile out.png")


@pytest.mark.parametrize("encoding", ["", "<", ">"])
@pytest.mark.parametrize("layout", ["faces", "vertices", "none"])
def test_a_ply_with_a_new_atlas_keeps_all_but_coordinates(folder, layout, encoding):
    pytest.importorskip("plyfile")
    (folder / "find.ply").write_text(ply(layout))
    if encoding:
        binary(folder, encoding)
    before, _ = elements(folder / "find.ply")
    mesh, baked, path = saved(folder, "find.ply", "out.ply", atlas="new")
    same_places(baked, mesh, path)
    after, held = elements(path)
    assert held.text == (not encoding)
    gone = {("vertex", "s"), ("vertex", "t"), ("face", "texnumber")}
    expected = {key: values for key, values in before.items() if key not in gone}
    expected["face", "vertex_indices"] = mesh.faces.tolist()
    expected["face", "label"] = [0, 0, 1, 2]
    uv = after.pop(("face", "texcoord"))
    expected.pop(("face", "texcoord"), None)
    assert after == expected
    np.testing.assert_allclose(np.reshape(uv, (-1, 3, 2)), baked.texcoords, atol=1e-6)
    assert "a find" in held.comments


def test_lists_of_polygons_go_with_their_triangles(folder):
    text = ply("none").replace("property uchar label", "property list uchar short label")
    for was, now in (("3 0\n", "3 2 5 6\n"), ("5 1\n", "5 1 4\n"), ("2 2\n", "2 1 9\n")):
        assert was in text
        text = text.replace(was, now)
    (folder / "find.ply").write_text(text)
    pytest.importorskip("plyfile")
    saved(folder, "find.ply", "out.ply", atlas="new")
    assert elements(folder / "out.ply")[0]["face", "label"] == [[5, 6], [5, 6], [4], [9]]


def test_elements_of_coordinates_alone_go_where_these_are_new(folder):
    text = ply("none").replace(
        "end_header\n",
        "element multi_texture_vertex 1\nproperty float u\nproperty float v\n"
        "element multi_texture_face 1\nproperty uchar tx\nproperty uint tn\n"
        "property list uchar int texture_vertex_indices\nend_header\n",
    )
    (folder / "find.ply").write_text(text + "0.5 0.5\n0 0 3 0 0 0\n")
    mesh, baked, path = saved(folder, "find.ply", "out.ply", atlas="new")
    same_places(baked, mesh, path)
    assert b"multi_texture" not in path.read_bytes()
    assert b"element corner_of_a_room 2" in path.read_bytes()


def test_colours_of_a_former_bake_go_and_the_objects_come_back(folder):
    import meshdepict as md

    (folder / "find.ply").write_text(ply("faces"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        md.bake(folder / "find.ply", "lambert").save(folder / "colored.ply")
    for atlas in (None, "new"):
        mesh, baked, path = saved(folder, "colored.ply", "out.ply", atlas=atlas)
        found = same_places(baked, mesh, path).attributes["vertex"]
        assert found["red"].tolist() == [0, 1, 2, 3, 4, 5]
        assert "original_red" not in found


def test_a_file_without_a_picture_gets_one(folder):
    text = ply("vertices").replace("comment TextureFile old.png\n", "")
    (folder / "find.ply").write_text(text)
    mesh, baked, path = saved(folder, "find.ply", "out.ply")
    same_places(baked, mesh, path)
    assert path.read_bytes().count(b"TextureFile") == 1


def test_grids_and_strips_are_written_anew(folder):
    strip = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element tristrips 1
property list int int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
1 1 0
4 0 1 2 3
"""
    (folder / "strip.ply").write_text(strip)
    mesh, baked, path = saved(folder, "strip.ply", "out.ply")
    same_places(baked, mesh, path)
    assert b"tristrips" not in path.read_bytes()
