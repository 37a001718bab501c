"""Objects of PyVista and trimesh that are no mesh yet: their surface, or what makes one of them."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, TypeGuard

from meshdepict.errors import MeshdepictError, MeshdepictWarning

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkDataObject

    from meshdepict.shapes.data_set import PolyData

__all__ = ["as_polydata", "as_trimesh", "is_of_pyvista", "is_of_trimesh"]

_SOLIDS = ("vtkUnstructuredGrid", "vtkStructuredGrid", "vtkExplicitStructuredGrid")
_GRIDS = ("vtkImageData", "vtkRectilinearGrid")
_TREES = ("vtkMultiBlockDataSet", "vtkPartitionedDataSet", "vtkPartitionedDataSetCollection")


def is_of_pyvista(shape: object) -> TypeGuard[vtkDataObject]:
    """Whether something is a data set of VTK, PyVista's or its own."""
    return hasattr(shape, "GetDataObjectType") and hasattr(shape, "IsA")


def is_of_trimesh(shape: object) -> bool:
    """Whether something is a mesh, a scene, a cloud or a path of trimesh."""
    return type(shape).__module__.partition(".")[0] == "trimesh" or all(
        hasattr(shape, name) for name in ("faces", "visual")
    )


def _is_polydata(data: object) -> TypeGuard[PolyData]:
    return all(hasattr(data, name) for name in ("GetPolys", "point_data", "n_cells"))


def as_polydata(data: object) -> PolyData:
    """Return a ``pyvista.PolyData`` as it is, or the surface of another data set with a note.

    Raises
    ------
    MeshdepictError
        For what has no surface, or more than one: a sentence with the call that makes a mesh of it.
    """
    if _is_polydata(data):
        return data
    name = type(data).__name__
    if not is_of_pyvista(data):
        raise MeshdepictError(f"expected a pyvista.PolyData, got a {name}")
    import pyvista as pv

    if any(map(data.IsA, _GRIDS)):
        raise MeshdepictError(
            f"expected a pyvista.PolyData, got a {name}, which is a volume: take one of its "
            "surfaces, .contour([value]), or bake it with bake_volume"
        )
    if not any(map(data.IsA, ("vtkPolyData", *_SOLIDS, *_TREES))):
        raise MeshdepictError(
            f"expected a pyvista.PolyData, got a {name}, which has no faces: make a mesh of its "
            "points first, pyvista.PolyData(points).reconstruct_surface() for instance"
        )
    wrapped: Any = pv.wrap(data)
    if data.IsA("vtkPolyData"):
        return wrapped
    what = f"{wrapped.n_blocks:,} blocks" if any(map(data.IsA, _TREES)) else _cells(wrapped)
    if any(map(data.IsA, _TREES)):
        wrapped = wrapped.combine(merge_points=False)
    surface = wrapped.extract_surface(pass_pointid=False, pass_cellid=False, algorithm="geometry")
    warnings.warn(f"of the {name} of {what} the surface is taken", MeshdepictWarning, stacklevel=4)
    return surface


def _cells(wrapped: Any) -> str:
    return f"{wrapped.n_cells:,} cells"


def as_trimesh(tm: Any) -> Any:
    """Return a ``trimesh.Trimesh`` as it is, or all meshes of a scene as one with a note.

    Raises
    ------
    MeshdepictError
        For what has no faces: a sentence with what makes a mesh of it.
    """
    if all(hasattr(tm, name) for name in ("vertices", "faces", "visual")):
        return tm
    name = type(tm).__name__
    if not is_of_trimesh(tm):
        raise MeshdepictError(f"expected a trimesh.Trimesh, got a {name}")
    if not (hasattr(tm, "geometry") and hasattr(tm, "graph")):
        raise MeshdepictError(
            f"expected a trimesh.Trimesh, got a {name}, which has no faces: make a mesh of its "
            "points first, pyvista.PolyData(points).reconstruct_surface() for instance"
        )
    meshes = [part for part in tm.geometry.values() if hasattr(part, "faces")]
    if not meshes:
        raise MeshdepictError(f"expected a trimesh.Trimesh, got a {name}, which holds no mesh")
    whole = tm.to_mesh() if hasattr(tm, "to_mesh") else tm.dump(concatenate=True)
    if len(meshes) > 1:
        warnings.warn(
            f"all {len(meshes):,} meshes of the Scene are taken as one",
            MeshdepictWarning,
            stacklevel=4,
        )
    return whole
