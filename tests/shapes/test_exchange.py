"""Meshes of PyVista and trimesh: there and back with polygons, colours and other data."""

import numpy as np
import pytest
import pyvista as pv
import trimesh
from conftest import tetrahedron

from meshdepict import bake, samples
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.mesh import Mesh

# --- from PyVista -----------------------------------------------------------------------------


def mixed_polydata():
    """A vertex, a line, a triangle, a quadrilateral, a pentagon and a strip, with data."""
    points = np.array(
        [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 3, 0], [1, 1, 1], [5, 0, 0], [5, 1, 0],
         [6, 0, 0], [6, 1, 0]], np.float32,
    )  # fmt: skip
    poly = pv.PolyData(
        points,
        verts=[1, 6],
        lines=[2, 6, 7],
        faces=[3, 0, 1, 5, 4, 0, 1, 2, 3, 5, 0, 1, 2, 4, 3],
        strips=[4, 6, 7, 8, 9],
    )
    poly.point_data["height"] = points[:, 2]
    poly.point_data["direction"] = points
    poly.cell_data["id"] = np.arange(6)
    return poly


def test_polygons_strips_and_their_data_come_from_pyvista():
    poly = mixed_polydata()
    before = poly.copy()
    mesh = Mesh.from_pyvista(poly)
    np.testing.assert_array_equal(
        mesh.polygons.connectivity, [0, 1, 5, 0, 1, 2, 3, 0, 1, 2, 4, 3, 6, 7, 8, 8, 7, 9]
    )
    np.testing.assert_array_equal(mesh.polygons.offsets, [0, 3, 7, 12, 15, 18])
    np.testing.assert_array_equal(mesh.vertices, poly.points.astype(float))
    np.testing.assert_array_equal(mesh.attributes["face"]["id"], [2, 3, 4, 5, 5])
    np.testing.assert_array_equal(mesh.attributes["vertex"]["direction"], poly.points)
    assert mesh.attributes["vertex"]["height"].dtype == np.float32
    assert poly == before


def test_the_mesh_does_not_live_in_vtk_s_memory():
    poly = pv.Sphere()
    mesh = Mesh.from_pyvista(poly)
    vertices, normals = mesh.vertices.copy(), mesh.attributes["vertex"]["Normals"].copy()
    poly.points[:] = 0
    poly.point_data["Normals"][:] = 0
    np.testing.assert_array_equal(mesh.vertices, vertices)
    np.testing.assert_array_equal(mesh.attributes["vertex"]["Normals"], normals)


@pytest.mark.parametrize("kind", ["regular", "default", "32 bit"])
def test_every_way_in_which_vtk_stores_triangles(kind, sphere):
    if kind == "regular":
        poly = pv.PolyData.from_regular_faces(sphere.vertices, sphere.faces)
    else:
        padded = np.insert(sphere.faces, 0, 3, axis=1)
        poly = pv.PolyData(sphere.vertices, faces=padded)
    if kind == "32 bit":
        poly.GetPolys().ConvertTo32BitStorage()
    stored = poly.GetPolys().IsStorage64Bit()
    mesh = Mesh.from_pyvista(poly)
    np.testing.assert_array_equal(mesh.faces, sphere.faces)
    assert mesh.polygons is None
    assert poly.GetPolys().IsStorage64Bit() == stored


@pytest.mark.parametrize(("name", "channels"), [("RGB", 3), ("RGBA", 4)])
def test_colours_of_pyvista_are_colours(name, channels):
    poly = pv.Sphere()
    poly.point_data[name] = np.full(
        (poly.n_points, channels), (10, 20, 30, 40)[:channels], np.uint8
    )
    vertex = Mesh.from_pyvista(poly).attributes["vertex"]
    found = [vertex[part][0] for part in ("red", "green", "blue", "alpha") if part in vertex]
    assert found == [10, 20, 30, 40][:channels]
    assert name not in vertex


@pytest.mark.parametrize("library", ["pyvista", "trimesh"])
def test_winding_is_passed_on(library):
    ball = pv.Sphere() if library == "pyvista" else trimesh.creation.icosphere(2)
    faces = ball.regular_faces if isinstance(ball, pv.PolyData) else ball.faces
    if isinstance(ball, pv.PolyData):
        ball.regular_faces = faces[:, ::-1].copy()
    else:
        ball.faces = faces[:, ::-1]
    kept = getattr(Mesh, f"from_{library}")(ball, winding="keep")
    assert (np.einsum("ij,ij->i", kept.normals, kept.vertices) < 0).all()


def test_points_without_faces_are_no_mesh():
    with pytest.raises(MeshdepictError, match="no faces"):
        Mesh.from_pyvista(pv.PolyData(np.eye(3)))
    with pytest.raises(MeshdepictError, match="no vertices"):
        Mesh.from_pyvista(pv.PolyData())


@pytest.mark.parametrize(
    ("make", "wrong", "sentence"),
    [
        (Mesh.from_pyvista, pv.ImageData(), "a pyvista.PolyData, got a ImageData"),
        (Mesh.from_pyvista, trimesh.creation.box(), "got a Trimesh"),
        (Mesh.from_trimesh, trimesh.PointCloud(np.eye(3)), "a trimesh.Trimesh, got a PointCloud"),
        (Mesh.from_trimesh, trimesh.Scene(), "got a Scene"),
        (Mesh.from_trimesh, pv.Sphere(), "got a PolyData"),
    ],
)  # fmt: skip
def test_other_things_are_refused(make, wrong, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        make(wrong)


# --- from trimesh ------------------------------------------------------------------------------


def colored_trimesh(**colors):
    vertices, faces = tetrahedron()
    return trimesh.Trimesh(vertices, faces, process=False, **colors)


@pytest.mark.parametrize("element", ["vertex", "face"])
@pytest.mark.parametrize("alpha", [255, 9])
def test_colours_of_trimesh_are_colours(element, alpha):
    colors = np.arange(16, dtype=np.uint8).reshape(4, 4)
    colors[:, 3] = alpha
    mesh = Mesh.from_trimesh(colored_trimesh(**{f"{element}_colors": colors}))
    found = mesh.attributes[element]
    np.testing.assert_array_equal([found[name] for name in ("red", "green", "blue")], colors.T[:3])
    assert ("alpha" in found) == (alpha == 9)
    assert mesh.attributes["face" if element == "vertex" else "vertex"] == {}


def test_attributes_of_trimesh_that_fit_are_kept():
    tm = colored_trimesh()
    tm.vertex_attributes["age"] = np.arange(4.0)
    tm.vertex_attributes["stale"] = np.arange(9.0)
    tm.face_attributes["part"] = np.arange(4)
    mesh = Mesh.from_trimesh(tm)
    assert set(mesh.attributes["vertex"]) == {"age"}
    np.testing.assert_array_equal(mesh.attributes["face"]["part"], np.arange(4))
    np.testing.assert_array_equal(mesh.vertices, tm.vertices)
    np.testing.assert_array_equal(mesh.faces, tm.faces)
    tm.vertices[0] = 9  # trimesh's own memory
    assert not (mesh.vertices == 9).any()


# --- and back ---------------------------------------------------------------------------------


def box():
    """Quadrilaterals and a pentagon, with data at vertices and faces."""
    vertices = np.array(
        [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2],
         [1, 3, 0]], float,
    )  # fmt: skip
    faces = [[4, 5, 6, 7], [0, 3, 8, 2, 1], [0, 1, 5, 4]]
    attributes = {
        "vertex": {
            "height": vertices[:, 2].astype(np.float32),
            "frame": np.arange(81.0).reshape(9, 3, 3),
            **dict.fromkeys(("red", "green", "blue"), np.arange(9, dtype=np.uint8)),
        },
        "face": {"part": np.array([7, 8, 9])},
    }
    return Mesh(vertices, faces, attributes=attributes, winding="keep")


def test_pyvista_gets_polygons_colours_and_data():
    mesh = box()
    baked = bake(mesh, "lambert")
    poly = baked.to_pyvista()
    assert (poly.n_cells, poly.n_verts, poly.n_points) == (3, 0, 9)
    np.testing.assert_array_equal(poly.faces, [4, 4, 5, 6, 7, 5, 0, 3, 8, 2, 1, 4, 0, 1, 5, 4])
    np.testing.assert_array_equal(poly.points, mesh.vertices)
    assert poly.points.dtype == np.float64
    np.testing.assert_array_equal(poly.point_data["RGB"], baked.colors)
    np.testing.assert_array_equal(poly.point_data["depict_lambert"], baked.intensity)
    np.testing.assert_array_equal(
        poly.point_data["original_RGB"], np.arange(9)[:, None].repeat(3, 1)
    )
    np.testing.assert_array_equal(poly.point_data["height"], mesh.vertices[:, 2])
    np.testing.assert_array_equal(poly.point_data["frame"], np.arange(81).reshape(9, 9))
    np.testing.assert_array_equal(poly.cell_data["part"], [7, 8, 9])
    assert poly.point_data.active_scalars_name == "RGB"


@pytest.mark.parametrize("make", [box, lambda: samples.sphere(42)])
def test_pyvista_gets_copies(make):
    mesh = make()
    vertices, faces = mesh.vertices.copy(), mesh.faces.copy()
    baked = bake(mesh, "lambert")
    colors, intensity = baked.colors.copy(), baked.intensity.copy()
    poly = baked.to_pyvista()
    poly.points[:] = 0
    for name in poly.point_data:
        poly.point_data[name][:] = 0
    pv.convert_array(poly.GetPolys().GetConnectivityArray())[:] = 0
    for array, old in zip(
        (mesh.vertices, mesh.faces, baked.colors, baked.intensity),
        (vertices, faces, colors, intensity),
        strict=True,
    ):
        np.testing.assert_array_equal(array, old)


def test_to_pyvista_and_back_is_the_same_mesh():
    mesh = box()
    again = Mesh.from_pyvista(bake(mesh, "lambert").to_pyvista(), winding="keep")
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    for one, other in zip(again.polygons, mesh.polygons, strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(again.attributes["vertex"]["original_red"], np.arange(9))
    np.testing.assert_array_equal(again.attributes["face"]["part"], [7, 8, 9])


def test_trimesh_gets_vertices_in_order_and_colours(sphere):
    baked = bake(sphere, "lambert")
    tm = baked.to_trimesh()
    np.testing.assert_array_equal(tm.vertices, sphere.vertices)
    np.testing.assert_array_equal(tm.faces, sphere.faces)
    np.testing.assert_array_equal(tm.visual.vertex_colors[:, :3], baked.colors)
    tm.vertices[0] = 7  # its own
    assert not (sphere.vertices[0] == 7).any()


def test_trimesh_gets_unmerged_and_unused_vertices_too():
    vertices, faces = tetrahedron()
    soup = Mesh(
        np.vstack([vertices[faces].reshape(-1, 3), [[9, 9, 9]]]), np.arange(12).reshape(-1, 3)
    )
    assert len(bake(soup, "lambert").to_trimesh().vertices) == 13


# --- and back -----------------------------------------------------------------------------------


def test_a_mesh_goes_to_pyvista_and_comes_back():
    mesh = Mesh.from_pyvista(mixed_polydata())
    again = Mesh.from_pyvista(mesh.to_pyvista())
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    for one, other in zip(again.polygons, mesh.polygons, strict=True):
        np.testing.assert_array_equal(one, other)
    for element in ("vertex", "face"):
        assert again.attributes[element].keys() == mesh.attributes[element].keys()
        for name, values in mesh.attributes[element].items():
            np.testing.assert_array_equal(again.attributes[element][name], values)


def test_what_goes_to_pyvista_is_a_copy():
    mesh = Mesh(*tetrahedron())
    mesh.to_pyvista().points[:] = 7
    mesh.to_trimesh().vertices[:] = 7
    assert not (mesh.vertices == 7).any()


@pytest.mark.parametrize("alpha", [None, [0, 128, 255, 7]])
def test_a_mesh_goes_to_trimesh_and_comes_back(alpha):
    rgb = np.arange(12, dtype=np.uint8).reshape(4, 3)
    colors = dict(zip(("red", "green", "blue"), rgb.T, strict=True))
    if alpha is not None:
        colors["alpha"] = np.array(alpha, np.uint8)
    mesh = Mesh(*tetrahedron(), attributes={"vertex": colors | {"wear": np.arange(4.0)}})
    again = Mesh.from_trimesh(mesh.to_trimesh())
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.faces, mesh.faces)
    assert again.attributes["vertex"].keys() == mesh.attributes["vertex"].keys()
    for name, values in mesh.attributes["vertex"].items():
        np.testing.assert_array_equal(again.attributes["vertex"][name], values)
