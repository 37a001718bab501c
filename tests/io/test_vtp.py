"""VTP: polygons, strips, lines and arrays, checked against PyVista."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import read_mesh, read_provenance, vtp, write_mesh
from meshdepict.shapes.mesh import Mesh

OURS = ["meshdepict one", "meshdepict two"]


def random_colors(mesh: Mesh, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)


def colors_of(mesh: Mesh, prefix: str = "") -> np.ndarray:
    vertex = mesh.attributes["vertex"]
    return np.stack([vertex[prefix + name] for name in ("red", "green", "blue")], axis=1)


@pytest.fixture
def everything() -> pv.PolyData:
    """Points, a line, a triangle, a quad and two strips, with arrays on all of them."""
    points = np.random.default_rng(0).normal(size=(12, 3)).astype(np.float32)
    poly = pv.PolyData()
    poly.points = points
    poly.verts = [1, 11]
    poly.lines = [3, 0, 1, 2, 2, 3, 4]
    poly.faces = [3, 0, 1, 2, 4, 2, 1, 3, 4]
    poly.strips = [4, 4, 5, 6, 7, 5, 7, 8, 9, 10, 11]
    poly.point_data["height"] = points[:, 2].astype(np.float64)
    poly.point_data["flow"] = np.arange(36.0).reshape(12, 3)
    poly.point_data["note"] = [f"point {number}" for number in range(12)]
    poly.cell_data["part"] = np.arange(7)
    poly.field_data["made by"] = ["someone"]
    return poly


@pytest.mark.parametrize("binary", [True, False])
def test_polygons_strips_and_arrays(tmp_path, everything, binary):
    path = tmp_path / "everything.vtp"
    everything.save(path, binary=binary)
    mesh = read_mesh(path, winding="keep")
    np.testing.assert_array_equal(mesh.vertices, everything.points)
    connectivity, offsets = mesh.polygons
    faces = [part.tolist() for part in np.split(connectivity, offsets[1:-1])]
    strips = [[4, 5, 6], [6, 5, 7], [7, 8, 9], [9, 8, 10], [9, 10, 11]]
    assert faces == [[0, 1, 2], [2, 1, 3, 4], *strips]
    # Cells are numbered points, lines, polygons, strips.
    assert mesh.attributes["face"]["part"].tolist() == [3, 4, 5, 5, 6, 6, 6]
    assert set(mesh.attributes["vertex"]) == {"height", "flow"}


def test_everything_else_is_kept(tmp_path, everything):
    path = tmp_path / "everything.vtp"
    everything.save(path)
    mesh = read_mesh(path)
    write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
    after = pv.read(path)
    np.testing.assert_array_equal(after["RGB"], random_colors(mesh))
    assert after.active_scalars_name == "RGB"
    for name in ("verts", "lines", "faces", "strips"):
        np.testing.assert_array_equal(getattr(after, name), getattr(everything, name))
    for name in ("height", "flow", "note"):
        np.testing.assert_array_equal(after.point_data[name], everything.point_data[name])
    np.testing.assert_array_equal(after.cell_data["part"], everything.cell_data["part"])
    assert list(after.field_data["made by"]) == ["someone"]
    assert list(after.field_data["meshdepict"]) == OURS


@pytest.mark.parametrize("name", ["RGB", "RGBA", "Colors"])
def test_colours_in_the_usual_arrays(tmp_path, name):
    poly = pv.Plane(i_resolution=2, j_resolution=2)
    poly.point_data.clear()
    channels = 4 if name == "RGBA" else 3
    values = np.random.default_rng(0).integers(0, 256, (9, channels)).astype(np.uint8)
    poly.point_data[name] = values
    poly.set_active_scalars(name)
    path = tmp_path / "plane.vtp"
    poly.save(path)
    mesh = read_mesh(path)
    np.testing.assert_array_equal(colors_of(mesh), values[:, :3])
    assert ("alpha" in mesh.attributes["vertex"]) == (channels == 4)
    assert name not in mesh.attributes["vertex"]

    write_mesh(path, mesh)  # nothing new: the arrays as they were
    assert pv.read(path).point_data.keys() == [name]
    for seed in (1, 2):
        write_mesh(path, mesh, colors=random_colors(mesh, seed), comments=OURS)
        mesh = read_mesh(path)
        np.testing.assert_array_equal(colors_of(mesh), random_colors(mesh, seed))
        np.testing.assert_array_equal(colors_of(mesh, "original_"), values[:, :3])
        assert name == "RGB" or name not in pv.read(path).point_data
    write_mesh(path, mesh, colors=random_colors(mesh), keep_colors=False)
    assert "original_RGB" not in pv.read(path).point_data
    assert read_provenance(path) is None


def test_attributes_of_all_types(tmp_path):
    points = np.random.default_rng(0).normal(size=(4, 3))
    vertex = {
        "mask": np.array([True, False, True, True]),
        "half": np.arange(4, dtype=np.float16),
        "long": np.arange(4) * 10**12,
        "matrix": np.arange(36.0).reshape(4, 3, 3),
        "word": np.array(list("abcd")),
        "red": np.linspace(0, 1, 4),
    }
    mesh = Mesh(points, [[0, 1, 2], [1, 3, 2]], attributes={"vertex": vertex})
    path = tmp_path / "mesh.vtp"
    with pytest.warns(MeshdepictWarning, match="'word' is left out: VTP holds numbers"):
        write_mesh(path, mesh)
    found = read_mesh(path)
    np.testing.assert_array_equal(found.vertices, points)
    assert found.attributes["vertex"]["mask"].tolist() == [1, 0, 1, 1]
    assert found.attributes["vertex"]["long"].tolist() == vertex["long"].tolist()
    assert found.attributes["vertex"]["half"].tolist() == [0, 1, 2, 3]
    assert found.attributes["vertex"]["matrix"].shape == (4, 9)
    np.testing.assert_array_equal(found.attributes["vertex"]["red"], vertex["red"])


def test_points_are_as_precise_as_they_must_be(tmp_path):
    path = tmp_path / "mesh.vtp"
    for points, kind in ((np.eye(3), np.float32), (np.eye(3) / 3, np.float64)):
        write_mesh(path, Mesh(points, [[0, 1, 2]]))
        assert pv.read(path).points.dtype == kind


def test_a_changed_mesh_is_not_mistaken_for_its_file(tmp_path, everything):
    path = tmp_path / "everything.vtp"
    everything.save(path)
    mesh = read_mesh(path, winding="keep")
    moved = Mesh(mesh.vertices + 1, mesh.polygons, document=mesh.document, winding="keep")
    write_mesh(path, moved)
    np.testing.assert_array_equal(read_mesh(path).vertices, moved.vertices)


def test_a_fault_of_vtk_while_writing(tmp_path, monkeypatch):
    @contextmanager
    def failing():
        yield ["out of luck"]

    monkeypatch.setattr(vtp, "vtk_errors", failing)
    with pytest.raises(MeshdepictError, match="VTK could not write the mesh: out of luck"):
        write_mesh(tmp_path / "mesh.vtp", Mesh(np.eye(3), [[0, 1, 2]]))
    assert list(tmp_path.iterdir()) == []


def raw_appended(path: Path, poly: pv.PolyData) -> None:
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(poly)
    writer.SetFileName(str(path))
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.Write()


def test_raw_data_with_any_bytes(tmp_path, everything):
    path = tmp_path / "raw.vtp"
    raw_appended(path, everything)
    assert b"\0" in path.read_bytes()
    np.testing.assert_array_equal(read_mesh(path).vertices, everything.points)


def test_the_real_file(data, tmp_path):
    path, copy = data / "formats" / "vtp_cowhead.vtp", tmp_path / "copy.vtp"
    mesh = read_mesh(path, winding="keep")
    assert (len(mesh.vertices), len(mesh.polygons.offsets) - 1) == (4_074, 7_994)
    write_mesh(copy, mesh, colors=random_colors(mesh), comments=OURS)
    again = read_mesh(copy, winding="keep")
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.faces, mesh.faces)
    curvature = [one.attributes["vertex"]["Gauss_Curvature"] for one in (mesh, again)]
    np.testing.assert_array_equal(*curvature)
    assert read_provenance(copy) == OURS
    assert read_provenance(path) is None
