"""Surfaces whose curvature is known exactly, as meshes with their answers.

Every one is a level set F = 0 with outward gradient, so one formula serves all: the shape operator
is P ∇∇F P / ‖∇F‖, P being the projection on the tangent plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshdepict import samples
from meshdepict.shapes.mesh import Mesh

AXES = np.array([1.0, 0.7, 0.5])  # of the ellipsoid
MAJOR, MINOR = 1.0, 0.4  # of the torus


@dataclass
class Exact:
    mesh: Mesh
    normals: np.ndarray
    k1: np.ndarray
    k2: np.ndarray
    d1: np.ndarray
    d2: np.ndarray
    inner: np.ndarray  # which vertices are far from a border

    @property
    def mean(self):
        return (self.k1 + self.k2) / 2


def solved(mesh, gradient, hessian, inner=None):
    """The answers for ∇F (n, 3) and ∇∇F (n, 3, 3) at a mesh's vertices."""
    length = np.linalg.norm(gradient, axis=1)
    n = gradient / length[:, None]
    project = np.eye(3) - n[:, :, None] * n[:, None, :]
    shape = project @ hessian @ project / length[:, None, None]
    # Lift the normal's own eigenvalue (0) out of the way.
    values, vectors = np.linalg.eigh(shape + 1e3 * n[:, :, None] * n[:, None, :])
    k, d = values[:, :2], vectors[:, :, :2]
    swap = np.abs(k[:, 0]) < np.abs(k[:, 1])
    k[swap], d[swap] = k[swap][:, ::-1], d[swap][:, :, ::-1]
    if inner is None:
        inner = np.ones(len(n), bool)
    return Exact(mesh, n, k[:, 0], k[:, 1], d[:, :, 0], d[:, :, 1], inner)


# --- ∇F and ∇∇F at points of each surface -----------------------------------------------------


def _diagonal(*columns):
    matrix = np.zeros((len(columns[0]), 3, 3))
    for axis, column in enumerate(columns):
        matrix[:, axis, axis] = column
    return matrix


def on_ellipsoid(points, axes=AXES):
    weights = np.broadcast_to(1 / np.square(axes), points.shape)
    return points * weights, _diagonal(*weights.T)


def on_sphere(points):
    return on_ellipsoid(points, np.ones(3))


def on_torus(points):
    x, y, z = points.T
    ring = np.hypot(x, y)
    share, bend = 1 - MAJOR / ring, MAJOR / ring**3
    hessian = _diagonal(share + bend * x * x, share + bend * y * y, np.ones(len(x)))
    hessian[:, 0, 1] = hessian[:, 1, 0] = bend * x * y
    return np.stack([x * share, y * share, z], axis=1), hessian


def plane(x, y):
    zero = 0 * x
    return 0.3 * x - 0.2 * y, zero + 0.3, zero - 0.2, zero, zero, zero


def saddle(x, y):
    zero = 0 * x
    return x * x - 0.7 * y * y, 2 * x, -1.4 * y, zero + 2, zero, zero - 1.4


def monkey(x, y):
    return x**3 - 3 * x * y * y, 3 * x * x - 3 * y * y, -6 * x * y, 6 * x, -6 * y, -6 * x


def wavy(x, y, amplitude=0.05, number=8.0):
    sx, cx, sy, cy = np.sin(number * x), np.cos(number * x), np.sin(number * y), np.cos(number * y)
    slope, bend = amplitude * number, -amplitude * number**2
    return (
        amplitude * sx * cy, slope * cx * cy, -slope * sx * sy,
        bend * sx * cy, bend * cx * sy, bend * sx * cy,
    )  # fmt: skip


HEIGHTS = {"plane": plane, "saddle": saddle, "monkey": monkey, "wavy": wavy}
"""Height fields as (h, h_x, h_y, h_xx, h_xy, h_yy)."""


def on_graph(points, height):
    x, y, _ = points.T
    _, hx, hy, hxx, hxy, hyy = height(x, y)
    hessian = _diagonal(-hxx, -hyy, 0 * x)
    hessian[:, 0, 1] = hessian[:, 1, 0] = -hxy
    return np.stack([-hx, -hy, np.ones(len(x))], axis=1), hessian


# --- as meshes ------------------------------------------------------------------------------


def sphere(vertices=2_500, radius=1.0):
    mesh = samples.sphere(vertices, radius=radius)
    return solved(mesh, *on_sphere(mesh.vertices))


def ellipsoid(vertices=2_500):
    ball = samples.sphere(vertices)
    mesh = Mesh(ball.vertices * AXES, ball.faces)
    return solved(mesh, *on_ellipsoid(mesh.vertices))


def torus(vertices=2_500):
    mesh = samples.torus(vertices, major=MAJOR, minor=MINOR)
    return solved(mesh, *on_torus(mesh.vertices))


def graph(name, vertices=2_500):
    """A height field over [−½, ½]², normals up; its outer tenth doesn't count as inner."""
    flat = samples.wavy_sheet(vertices, size=1.0, amplitude=0)
    x, y = flat.vertices[:, 0], flat.vertices[:, 1]
    mesh = Mesh(np.stack([x, y, HEIGHTS[name](x, y)[0]], axis=1), flat.faces)
    inner = np.maximum(abs(x), abs(y)) < 0.4
    return solved(mesh, *on_graph(mesh.vertices, HEIGHTS[name]), inner)


SURFACES = {
    "sphere": sphere,
    "ellipsoid": ellipsoid,
    "torus": torus,
    "plane": lambda n=2_500: graph("plane", n),
    "saddle": lambda n=2_500: graph("saddle", n),
    "monkey": lambda n=2_500: graph("monkey", n),
    "wavy": lambda n=2_500: graph("wavy", n),
}
