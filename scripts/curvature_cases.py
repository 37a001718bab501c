"""Surfaces with exact answers, and the estimators that curvature_trade.py puts to them."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import meshdepict as md
from meshdepict import samples
from meshdepict.curvature import principal_curvatures

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from exact_surfaces import (  # noqa: E402
    AXES,
    HEIGHTS,
    MAJOR,
    MINOR,
    Exact,
    on_ellipsoid,
    on_graph,
    on_sphere,
    on_torus,
    solved,
)

SIZES = (1_000, 10_000, 100_000, 1_000_000)
NOISES = (0.0, 1e-4, 1e-3, 1e-2)  # in edges
QUALITIES = ("regular", "random", "slivers")
SURFACES = ("sphere", "ellipsoid", "torus", "monkey", "wavy")
SLOW = 200_000  # vertices beyond which slow estimators are left out

Found = tuple[Any, Any, Any]  # k1, k2 and d1, or None without directions


# --- surfaces ---------------------------------------------------------------------------------


def surface(name: str, count: int, quality: str = "regular", noise: float = 0.0) -> Exact:
    """Return a mesh of a surface, noise along its normals, and the answers without the noise.

    "random" moves every vertex within the surface by up to a third of an edge. "slivers" shears
    or stretches the triangles until most are ten times as long as high.
    """
    rng = np.random.default_rng(2009)
    if name in ("sphere", "ellipsoid"):
        points, faces, form, inner = _ball(count, quality, rng, name)
    elif name == "torus":
        points, faces, form, inner = _torus(count, quality, rng)
    else:
        points, faces, form, inner = _graph(count, quality, rng, name)
    answers = solved(None, *form(points), inner)
    mesh = md.Mesh(points, faces, winding="keep")
    if noise:
        step = noise * mesh.edge_length * rng.normal(size=(len(points), 1))
        mesh = md.Mesh(points + step * answers.normals, faces, winding="keep")
    answers.mesh = mesh
    assert len(mesh.normals) == len(mesh.areas)  # not part of an estimate
    return answers


def _ball(count, quality, rng, name):
    mesh = samples.sphere(count)
    points, faces = np.array(mesh.vertices), mesh.faces
    if quality == "random":
        points += rng.uniform(-1, 1, points.shape) * mesh.edge_length / 3
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    elif quality == "slivers":  # twisted: what lies above turns round what lies below
        x, y, z = points.T
        c, s = np.cos(5 * z), np.sin(5 * z)
        points = np.stack([c * x - s * y, s * x + c * y, z], axis=1)
    if name == "sphere":
        return points, faces, on_sphere, None
    return points * AXES, faces, on_ellipsoid, None


def _torus(count, quality, rng):
    mesh = samples.torus(count, major=MAJOR, minor=MINOR)
    x, y, z = mesh.vertices.T
    u, v = np.arctan2(y, x), np.arctan2(z, np.hypot(x, y) - MAJOR)
    if quality == "random":
        u += rng.uniform(-1, 1, len(u)) * mesh.edge_length / 3 / MAJOR
        v += rng.uniform(-1, 1, len(v)) * mesh.edge_length / 3 / MINOR
    elif quality == "slivers":
        u += 2 * v
    ring = MAJOR + MINOR * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), MINOR * np.sin(v)], axis=1)
    return points, mesh.faces, on_torus, None


def _graph(count, quality, rng, name):
    stretch = 10**0.5 if quality == "slivers" else 1.0
    nx, ny = round(count**0.5 * stretch), round(count**0.5 / stretch)
    x, y = (a.ravel() for a in np.meshgrid(*(np.linspace(-0.5, 0.5, n) for n in (nx, ny))))
    if quality == "random":
        x, y = (a + rng.uniform(-1, 1, len(x)) / 3 / (nx - 1) for a in (x, y))
    number = np.arange(nx * ny).reshape(ny, nx)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    points = np.stack([x, y, HEIGHTS[name](x, y)[0]], axis=1)
    inner = np.maximum(np.abs(x), np.abs(y)) < 0.5 - 4 / ny if ny > 16 else np.ones(len(x), bool)
    return points, faces, lambda p: on_graph(p, HEIGHTS[name]), inner


# --- estimators -------------------------------------------------------------------------------


def ours(method: str, edges: float | None = None) -> Callable[[md.Mesh], Found]:
    def estimate(mesh: md.Mesh) -> Found:
        options: dict[str, Any] = {}
        if edges is not None and method == "tensor":
            options["normals"] = md.smooth_normals(mesh, edges * mesh.edge_length)
        elif edges is not None:
            options["radius"] = edges * mesh.edge_length
        found = principal_curvatures(mesh, method=method, **options)
        return found.k1, found.k2, None if method == "discrete" else found.d1

    return estimate


def libigl(mesh: md.Mesh) -> Found:
    import igl

    d1, d2, k1, k2, _ = igl.principal_curvature(mesh.vertices, mesh.faces)
    return k1, k2, np.where((np.abs(k1) >= np.abs(k2))[:, None], d1, d2)


def vtk(mesh: md.Mesh) -> Found:
    import pyvista as pv

    poly = pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces)
    mean, gaussian = poly.curvature("mean"), poly.curvature("gaussian")
    root = np.sqrt(np.maximum(mean**2 - gaussian, 0))
    return mean + root, mean - root, None


def pymeshlab(method: str) -> Callable[[md.Mesh], Found]:
    def estimate(mesh: md.Mesh) -> Found:
        import pymeshlab as pml

        work = pml.MeshSet(verbose=False)
        work.add_mesh(pml.Mesh(np.array(mesh.vertices), np.array(mesh.faces)))
        values = []
        for color in ("Min Curvature", "Max Curvature"):  # values come as one scalar at a time
            work.compute_curvature_principal_directions_per_vertex(
                method=method, curvcolormethod=color, autoclean=False
            )
            values.append(work.current_mesh().vertex_scalar_array())
        one, other = values
        matrices = work.current_mesh()
        d1 = matrices.vertex_curvature_principal_dir1_matrix()
        d2 = matrices.vertex_curvature_principal_dir2_matrix()
        return one, other, np.where((np.abs(one) >= np.abs(other))[:, None], d1, d2)

    return estimate


ESTIMATORS: dict[str, tuple[Callable[[md.Mesh], Found], bool]] = {
    "tensor": (ours("tensor"), False),
    "tensor at 2 edges": (ours("tensor", 2), True),
    "tensor at 4 edges": (ours("tensor", 4), True),
    "quadric, 2 edges": (ours("quadric", 2), True),
    "quadric, 5 edges": (ours("quadric", 5), True),
    "discrete": (ours("discrete"), False),
    "libigl, 5 rings": (libigl, True),
    "VTK": (vtk, False),
}
if importlib.util.find_spec("pymeshlab"):
    ESTIMATORS["PyMeshLab Taubin"] = (pymeshlab("Taubin approximation"), False)
    ESTIMATORS["PyMeshLab quadric"] = (pymeshlab("Quadric Fitting"), True)
