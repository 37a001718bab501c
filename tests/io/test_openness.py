"""Outputs open where people open them: PyVista, trimesh, PyMeshLab and plyfile, in full colour.

Each reads in a process of its own: two of them have ended with a segmentation fault.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from odd_ply import random_colors
from scipy.spatial import cKDTree

from meshdepict.io import read_mesh, write_mesh
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.icosahedron import icosphere

SCRIPT = Path(__file__).with_name("foreign_readers.py")

# Which of the formats that we write each of them reads, and in which it finds vertex colours.
READS = {
    "pyvista": {".ply": True, ".obj": False, ".vtp": True},
    # (Of GLB linear ones, in 16 bit.)
    "trimesh": {".ply": True, ".obj": True, ".off": False, ".glb": False},
    "pymeshlab": {".ply": True, ".obj": True, ".off": True},
    "plyfile": {".ply": True},
}
KEEPS_POLYGONS = ("pyvista", "plyfile")

# A house: walls of four corners, gables of five, a roof of triangles.
CORNERS = [(x, y, z) for x in (0, 4) for z in (0, 6) for y in (0, 3)] + [(2, 5, 0), (2, 5, 6)]
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 2, 6, 4]]
GABLES = [[0, 4, 5, 8, 1], [2, 3, 9, 7, 6]]
ROOF = [[1, 8, 9], [1, 9, 3], [8, 5, 7], [8, 7, 9]]
HOUSE = QUADS + GABLES + ROOF
LARGE = [list(range(300))[::-1], *([k, (k + 1) % 300, 300] for k in range(300))]  # a cone


def cone() -> np.ndarray:
    angle = np.arange(300) * (2 * np.pi / 300)
    ring = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
    return np.concatenate((ring, [[0, 0, 2]]))


def obj(faces: list[list[int]], textured: str) -> str:
    """An OBJ of the house: texture coordinates at all, at some or at none of its faces."""
    lines = ["v {} {} {}".format(*corner) for corner in CORNERS]
    lines += [f"vt {k / 7:.3f} {k % 3 / 3:.3f}" for k in range(20)]
    for number, face in enumerate(faces):
        if textured == "all" or (textured == "some" and number % 2):
            lines.append("f " + " ".join(f"{v + 1}/{(v + number) % 20 + 1}" for v in face))
        else:
            lines.append("f " + " ".join(str(v + 1) for v in face))
    return "\n".join(lines) + "\n"


def ply(faces: str, rows: str, *, colored: bool = False) -> str:
    names = "".join(f"property uchar {name}\n" for name in ("red", "green", "blue") if colored)
    points = [" ".join(map(str, c)) + " 200 100 50" * colored for c in CORNERS]
    return (
        "ply\nformat ascii 1.0\nelement vertex 10\nproperty float x\nproperty float y\n"
        f"property float z\n{names}{faces}end_header\n" + "\n".join(points) + "\n" + rows
    )


def listed(faces: list[list[int]]) -> str:
    return "".join(" ".join(map(str, [len(face), *face])) + "\n" for face in faces)


FACES = "element face {}\nproperty list uchar int vertex_indices\n"
INPUTS = {
    "triangles.obj": obj(ROOF, "none"),
    "quads.obj": obj(QUADS, "none"),
    "mixed.obj": obj(HOUSE, "none"),
    "triangles_textured.obj": obj(ROOF, "all"),
    "triangles_partly_textured.obj": obj(ROOF, "some"),
    "quads_textured.obj": obj(QUADS, "all"),
    "mixed_textured.obj": obj(HOUSE, "all"),
    "mixed_partly_textured.obj": obj(HOUSE, "some"),
    "mixed.ply": None,  # fresh, below
    "colored.ply": ply(FACES.format(len(ROOF)), listed(ROOF), colored=True),
    "quads.off": f"OFF\n10 {len(QUADS)} 0\n"
    + "".join("{} {} {}\n".format(*corner) for corner in CORNERS)
    + listed(QUADS),
    "strips.ply": ply(
        "element tristrips 1\nproperty list int int vertex_indices\n", "7 1 8 3 9 -1 8 5\n"
    ),
    "large.off": None,
}


def sources(folder: Path) -> list[Path]:
    """Write the inputs."""
    for name, content in INPUTS.items():
        if content is not None:
            (folder / name).write_text(content)
    attributes = {"face": {"part": np.arange(len(HOUSE))}}
    house = Mesh(np.array(CORNERS, float) / 3, HOUSE, attributes=attributes, winding="keep")
    write_mesh(folder / "mixed.ply", house)
    write_mesh(folder / "large.off", Mesh(cone(), LARGE, winding="keep"))
    return [folder / name for name in INPUTS]


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, tuple[Mesh, np.ndarray]]:
    """Every kind of input in every format that holds colours."""
    folder = tmp_path_factory.mktemp("openness")
    written = {}
    for source in sources(folder):
        mesh = read_mesh(source, winding="keep")
        if source.name == "strips.ply":  # else they stay strips, which only PyMeshLab reads
            mesh = mesh.as_triangles()
        colors = random_colors(mesh)
        for suffix in (".ply", ".obj", ".off", ".glb", ".vtp"):
            path = folder / f"{source.stem}-{source.suffix[1:]}{suffix}"
            write_mesh(path, mesh, colors=colors, keep_colors=False)
            written[path] = (mesh, colors)
    return written


def by_position(points: np.ndarray, colors: np.ndarray) -> dict[tuple[float, ...], set[bytes]]:
    """The colours at every position, in single precision as all of them read."""
    found: dict[tuple[float, ...], set[bytes]] = {}
    for point, color in zip(np.float32(points).tolist(), np.uint8(colors), strict=True):
        found.setdefault(tuple(point), set()).add(color.tobytes())
    return found


def _largest(mesh: Mesh) -> int:
    return 3 if mesh.polygons is None else int(np.diff(mesh.polygons.offsets).max())


@pytest.mark.parametrize("reader", READS)
def test_others_read_all_vertices_colours_and_faces(outputs, reader):
    if importlib.util.find_spec(reader) is None:
        pytest.skip(f"{reader} is not installed")
    paths = [path for path in outputs if path.suffix in READS[reader]]
    if reader == "trimesh":  # its OFF reader fails on five corners and more, wherever they are from
        paths = [p for p in paths if p.suffix != ".off" or _largest(outputs[p][0]) < 5]
    if reader == "pymeshlab":  # its PLY reader counts corners in a byte
        paths = [p for p in paths if p.suffix != ".ply" or _largest(outputs[p][0]) < 256]
    done = subprocess.run(
        [sys.executable, str(SCRIPT), reader, *map(str, paths)],
        capture_output=True, text=True, errors="replace", check=False,
    )  # fmt: skip
    rows = {Path(row["path"]): row for row in map(json.loads, done.stdout.splitlines())}
    assert done.returncode == 0, f"after {len(rows)} of {len(paths)}: {done.stderr[-500:]}"
    assert list(rows) == paths
    for path, row in rows.items():
        mesh, colors = outputs[path]
        polygons = len(mesh.faces if mesh.polygons is None else mesh.polygons.offsets[1:])
        expected = polygons if reader in KEEPS_POLYGONS else len(mesh.faces)
        assert row["faces"] == expected, path.name
        used = np.unique(mesh.faces)
        distance, _ = cKDTree(row["points"]).query(mesh.vertices[used])
        assert distance.max() < 1e-5, path.name  # OBJ and GLB, as they read them: single precision
        textured_obj = path.suffix == ".obj" and "textured" in path.name
        if READS[reader][path.suffix] and not (reader == "trimesh" and textured_obj):
            assert row["colors"] is not None, path.name
            theirs = by_position(row["points"], row["colors"])
            ours = by_position(mesh.vertices[used], colors[used])
            assert {at: theirs[at] for at in ours} == ours, path.name


def test_a_real_ball_of_mixed_polygons_with_texture_coordinates_is_read_again(tmp_path):
    """Our own reader finds in the new layout what was in the old file."""
    points, faces = icosphere(200)
    polygons = [faces[0].tolist(), [*faces[1].tolist(), 0], *faces[2:].tolist()]
    lines = ["v {!r} {!r} {!r}".format(*point) for point in points.tolist()]
    lines += [f"vt {k / 64} {k / 128}" for k in range(64)]
    lines += [
        "f " + " ".join(f"{v + 1}/{(v + number) % 64 + 1}" for v in polygon)
        for number, polygon in enumerate(polygons)
    ]
    (tmp_path / "ball.obj").write_text("\n".join(lines))
    mesh = read_mesh(tmp_path / "ball.obj", winding="keep")
    write_mesh(tmp_path / "ball.ply", mesh, colors=random_colors(mesh))
    again = read_mesh(tmp_path / "ball.ply", winding="keep")
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.polygons.connectivity, mesh.polygons.connectivity)
    (texture, corner), (texture_2, corner_2) = mesh.document.texcoords, again.document.texcoords
    np.testing.assert_array_equal(texture[corner], texture_2[corner_2])
