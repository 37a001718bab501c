"""Files' own normals, where they are asked for."""

import numpy as np
import pytest
import trimesh
from parts import box, plane_normals

import meshdepict as md
from meshdepict.errors import MeshdepictWarning
from meshdepict.shapes.own_normals import with_own_normals
from meshdepict.shapes.parted import parted_at_creases

# A box as OBJ: eight vertices, six normals.
OBJ = """\
v 0 0 0\nv 3 0 0\nv 3 2 0\nv 0 2 0\nv 0 0 1\nv 3 0 1\nv 3 2 1\nv 0 2 1
vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0
f 4//1 3//1 2//1 1//1\nf 5//2 6//2 7//2 8//2\nf 1//3 2//3 6//3 5//3
f 2//4 3//4 7//4 6//4\nf 3//5 4//5 8//5 7//5\nf 4//-1 1//-1 5//-1 8//-1
"""


def flat(mesh):
    corners = mesh.normals[mesh.outward_faces]
    plane = np.broadcast_to(plane_normals(mesh)[:, None], corners.shape)
    np.testing.assert_allclose(corners, plane, atol=1e-6)


def test_obj(tmp_path):
    path = tmp_path / "box.obj"
    path.write_text(OBJ)
    mesh = md.read_mesh(path)
    found = with_own_normals(mesh)
    assert found.added == 16
    flat(found)
    parted = parted_at_creases(mesh, 40)  # another route to the same
    order = [np.lexsort(np.round(np.c_[m.vertices, m.normals], 6).T) for m in (found, parted)]
    for name in ("vertices", "normals"):
        one, two = (getattr(m, name)[k] for m, k in zip((found, parted), order, strict=True))
        np.testing.assert_allclose(one, two, atol=1e-9)
    assert not np.allclose(mesh.normals[0], found.normals[0])  # unless asked for, as ever


def test_ply_keeps_vertices_and_file(tmp_path):
    ball = md.samples.sphere(300)
    lean = ball.vertices + np.array([0.3, 0, 0])
    lean /= np.linalg.norm(lean, axis=1, keepdims=True)
    names = dict(zip(("nx", "ny", "nz"), 5 * lean.T, strict=True))  # of any length
    md.io.write_mesh(
        tmp_path / "ball.ply", md.Mesh(ball.vertices, ball.faces, attributes={"vertex": names})
    )
    mesh = md.read_mesh(tmp_path / "ball.ply")
    found = with_own_normals(mesh)
    assert found.added == 0
    assert found.document is mesh.document
    np.testing.assert_allclose(found.normals, lean, atol=1e-6)
    baked = md.bake(mesh, "lambert", normals="file", light=(0, 0, 1))
    np.testing.assert_allclose(baked.intensity, np.maximum(lean[:, 2], 0), atol=1e-6)
    assert baked.provenance["normals"] == "the file's, 0 vertices added"


def test_vtk_arrays_of_normals():
    pv = pytest.importorskip("pyvista")
    poly = pv.Sphere(theta_resolution=12, phi_resolution=12).compute_normals(cell_normals=False)
    mesh = md.Mesh.from_pyvista(poly)
    found = with_own_normals(mesh)
    np.testing.assert_allclose(found.normals, poly.point_data["Normals"], atol=1e-6)


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_gltf_at_its_place(tmp_path, mirror):
    mesh = parted_at_creases(box(), 40)
    tm = trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_normals=mesh.normals, process=False)
    scene = trimesh.Scene()
    turn = np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]) @ np.diag([mirror * 2, 3, 0.5])
    place = np.eye(4)
    place[:3, :3] = turn
    scene.add_geometry(tm, transform=place)
    (tmp_path / "box.glb").write_bytes(scene.export(file_type="glb", include_normals=True))
    read = md.read_mesh(tmp_path / "box.glb")
    assert {"nx", "ny", "nz"} <= set(read.attributes["vertex"])
    flat(with_own_normals(read))


def test_normals_that_look_inwards_are_turned():
    ball = md.samples.sphere(300)
    names = dict(zip(("nx", "ny", "nz"), -ball.vertices.T, strict=True))
    mesh = md.Mesh(ball.vertices, ball.faces, attributes={"vertex": names})
    with pytest.warns(MeshdepictWarning, match="look inwards: they are turned"):
        found = with_own_normals(mesh)
    assert (found.normals * ball.vertices).sum(axis=1).min() > 0.99


def test_what_is_no_direction_stays_computed():
    ball = md.samples.sphere(300)
    normals = ball.vertices.copy()
    normals[3], normals[7], normals[9] = 0, np.nan, np.inf
    names = dict(zip(("nx", "ny", "nz"), normals.T, strict=True))
    mesh = md.Mesh(ball.vertices, ball.faces, attributes={"vertex": names})
    with pytest.warns(MeshdepictWarning, match="corners have no normal in the file: computed"):
        found = with_own_normals(mesh)
    np.testing.assert_allclose(found.normals[[3, 7, 9]], ball.normals[[3, 7, 9]])
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-12)


def test_obj_normals_out_of_range_stay_computed(tmp_path):
    path = tmp_path / "box.obj"
    path.write_text(OBJ.replace("8//2", "8//77").replace("5//3", "5//-99"))
    mesh = md.read_mesh(path)
    with pytest.warns(MeshdepictWarning, match="2 corners have no normal"):
        found = with_own_normals(mesh)
    assert np.isfinite(found.normals).all()


def test_a_file_without_normals_says_so(tmp_path):
    with pytest.raises(md.MeshdepictError, match="normals='file' needs normals in the file"):
        with_own_normals(md.samples.sphere(100))
    path = tmp_path / "box.obj"
    path.write_text("".join(line for line in OBJ.splitlines(keepends=True) if line[:2] != "vn"))
    with pytest.raises(md.MeshdepictError, match="needs normals in the file"):
        with_own_normals(md.read_mesh(path))
    path.write_text(OBJ.replace("vn 0 0 1", "vn 0 0 up"))
    with pytest.raises(md.MeshdepictError, match="can't be had: the file has a line 'vn'"):
        with_own_normals(md.read_mesh(path))
