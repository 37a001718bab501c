"""Objects that users of PyVista and trimesh hold: taken by their surface, or told what to call."""

import numpy as np
import pytest
import pyvista as pv
import trimesh
from pyvista import examples

from meshdepict import Mesh, MeshdepictError, MeshdepictWarning, bake

CUBES = pv.ImageData(dimensions=(4, 4, 4))  # 27 cells, of which 26 are seen: 54 squares


def solids():
    warped = CUBES.cast_to_structured_grid()
    warped.points = warped.points + 0.1 * np.sin(3 * warped.points[:, [1, 2, 0]])
    return {
        "unstructured": CUBES.cast_to_unstructured_grid(),
        "structured": warped,
        "tetrahedra": examples.cells.Tetrahedron(),
    }


@pytest.mark.parametrize("name", ["unstructured", "structured", "tetrahedra"])
def test_the_surface_of_solid_cells_is_taken_with_a_note(name):
    grid = solids()[name]
    grid.point_data["height"] = grid.points[:, 2]
    grid.cell_data["number"] = np.arange(grid.n_cells)
    with pytest.warns(MeshdepictWarning, match=f"{grid.n_cells} cells the surface is taken"):
        mesh = Mesh.from_pyvista(grid)
    polygons = len(mesh.faces) if mesh.polygons is None else len(mesh.polygons.offsets) - 1
    assert polygons == (4 if name == "tetrahedra" else 54)
    np.testing.assert_allclose(mesh.attributes["vertex"]["height"], mesh.vertices[:, 2], atol=1e-6)
    assert set(mesh.attributes["face"]["number"].tolist()) <= set(range(grid.n_cells))
    with pytest.warns(MeshdepictWarning, match="the surface is taken"):
        assert np.isfinite(bake(grid, "lambert").intensity).all()


def test_blocks_are_taken_together():
    ball, cone = pv.Sphere(), pv.Cone(center=(3, 0, 0))
    blocks = pv.MultiBlock([ball, None, pv.MultiBlock([cone]), CUBES.cast_to_unstructured_grid()])
    with pytest.warns(MeshdepictWarning, match="MultiBlock of 4 blocks the surface is taken"):
        mesh = Mesh.from_pyvista(blocks)
    count = len(mesh.faces) if mesh.polygons is None else len(mesh.polygons.offsets) - 1
    assert count == ball.n_cells + cone.n_cells + 54


def test_data_of_vtk_itself_are_taken():
    from vtkmodules.vtkFiltersSources import vtkSphereSource

    source = vtkSphereSource()
    source.Update()
    assert len(bake(source.GetOutput(), "lambert").colors) == 50


@pytest.mark.parametrize(
    ("shape", "sentence"),
    [
        (CUBES, r"got a ImageData, which is a volume: .*\.contour"),
        (CUBES.cast_to_rectilinear_grid(), "RectilinearGrid, which is a volume"),
        (pv.PointSet(np.eye(3)), "PointSet, which has no faces: .*reconstruct_surface"),
        (pv.Table({"a": np.arange(2)}), "Table, which has no faces"),
        (pv.MultiBlock([pv.PointSet(np.eye(3))]), "the mesh is empty"),
        (pv.MultiBlock(), "the mesh is empty"),
        (pv.PolyData(np.eye(3)), "the mesh has no faces"),
        (trimesh.PointCloud(np.eye(3)), "PointCloud, which has no faces: .*reconstruct_surface"),
        (trimesh.load_path(np.eye(3)), "Path3D, which has no faces"),
        (trimesh.Scene(), "Scene, which holds no mesh"),
        (trimesh.Scene([trimesh.PointCloud(np.eye(3))]), "Scene, which holds no mesh"),
    ],
)
@pytest.mark.filterwarnings("ignore:of the")
def test_what_has_no_surface_is_told_what_makes_one(shape, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        bake(shape, "lambert")


def test_the_meshes_of_a_scene_become_one_where_they_stand():
    box = trimesh.creation.box()
    box.visual.vertex_colors = [200, 100, 50, 255]
    scene = trimesh.Scene()
    scene.add_geometry(box)
    scene.add_geometry(box.copy(), transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    with pytest.warns(MeshdepictWarning, match="all 2 meshes of the Scene are taken as one"):
        mesh = Mesh.from_trimesh(scene)
    assert len(mesh.faces) == 24
    assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(6)
    assert set(mesh.attributes["vertex"]["red"].tolist()) == {200}
    assert len(bake(trimesh.Scene([box]), "lambert").shape.faces) == 12  # one needs no word
