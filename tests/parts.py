"""Parts with planes and sharp edges, as a CAD program would write them: as few faces as will do."""

import numpy as np

import meshdepict as md


def extruded(outline, height=1.0):
    """A prism over a polygon (k, 2) that runs counter-clockwise: two polygons and k quads."""
    outline = np.asarray(outline, float)
    count = len(outline)
    i = np.arange(count)
    j = (i + 1) % count
    points = np.concatenate([np.c_[outline, np.full(count, z)] for z in (0.0, height)])
    sides = np.stack([i, j, j + count, i + count], axis=1).tolist()
    return points, [i[::-1].tolist(), (i + count).tolist(), *sides]


def box():
    points, faces = extruded([(0, 0), (3, 0), (3, 2), (0, 2)], 1.5)
    return md.Mesh(points, faces)


def bevelled_box(bevel=0.3):
    """A box whose four upright edges are cut off at 45°."""
    x, y, b = 3, 2, bevel
    outline = [(b, 0), (x - b, 0), (x, b), (x, y - b), (x - b, y), (b, y), (0, y - b), (0, b)]
    return md.Mesh(*extruded(outline, 1.5))


def cylinder(count=48):
    angle = np.arange(count) * (2 * np.pi / count)
    return md.Mesh(*extruded(np.stack([np.cos(angle), np.sin(angle)], axis=1)))


def angle_profile():
    """An L."""
    return md.Mesh(*extruded([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 2.0))


def running_out(n=17, slope=1.2):
    """A sheet with a crease along x = 0 that runs out at y = 0."""
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    z = slope * np.abs(x) * np.maximum(y, 0) ** 2
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + n + 1], 1), np.stack([i, i + n + 1, i + n], 1)])
    return md.Mesh(points, faces, winding="keep")


def plane_normals(mesh):
    """The unit normals (m, 3) of a mesh's triangles."""
    a, b, c = mesh.vertices[mesh.outward_faces].swapaxes(0, 1)
    cross = np.cross(b - a, c - a)
    return cross / np.linalg.norm(cross, axis=1, keepdims=True)
