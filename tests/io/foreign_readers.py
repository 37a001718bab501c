"""Read mesh files with one of the programs that people open them in, as its own process.

Usage: ``python foreign_readers.py READER FILE…``. Prints a line of JSON for each file: its path,
the vertices, their colours (or null) and the number of faces.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np


def with_pyvista(path: str) -> tuple[Any, Any, int]:
    import pyvista as pv

    mesh = pv.read(path)
    return mesh.points, mesh.point_data.get("RGB"), mesh.n_cells


def with_trimesh(path: str) -> tuple[Any, Any, int]:
    import trimesh

    mesh = trimesh.load(path, process=False, force="mesh")
    colors = mesh.visual.vertex_colors if mesh.visual.kind == "vertex" else None
    if mesh.visual.kind == "texture":
        colors = mesh.vertex_attributes.get("color")
    return mesh.vertices, colors, len(mesh.faces)


def with_pymeshlab(path: str) -> tuple[Any, Any, int]:
    import pymeshlab

    held = pymeshlab.MeshSet(verbose=False)
    held.load_new_mesh(path)
    mesh = held.current_mesh()
    colors = np.rint(mesh.vertex_color_matrix() * 255) if mesh.has_vertex_color() else None
    return mesh.vertex_matrix(), colors, mesh.face_number()


def with_plyfile(path: str) -> tuple[Any, Any, int]:
    import plyfile

    ply = plyfile.PlyData.read(path)
    vertex = ply["vertex"]
    points, colors = (
        np.stack([np.asarray(vertex[name]) for name in names], axis=1)
        for names in ("xyz", ("red", "green", "blue"))
    )
    return points, colors, len(ply["face"])


def main(reader: str, *paths: str) -> None:
    read = globals()[f"with_{reader}"]
    for path in paths:
        points, colors, faces = read(path)
        colors = None if colors is None else np.asarray(colors)[:, :3].astype(int).tolist()
        row = {
            "path": path,
            "points": np.asarray(points).tolist(),
            "colors": colors,
            "faces": faces,
        }
        print(json.dumps(row), flush=True)  # noqa: T201


if __name__ == "__main__":
    main(*sys.argv[1:])
