"""Meshes at the ends of what a file can hold, each by its name: vertices and faces."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from conftest import tetrahedron
from numpy.typing import NDArray

from meshdepict import samples

__all__ = ["LARGE", "SMALL", "strip", "torn_sphere"]

Arrays = tuple[NDArray[np.float64], NDArray[np.int64]]


def arrays(vertices: object, faces: object) -> Arrays:
    return np.array(vertices, float), np.array(faces, np.int64)


def golf_ball(factor: float = 1.0, offset: object = 0.0) -> Arrays:
    ball = samples.golf_ball(120, dimples=12, depth=0.05)
    return ball.vertices * factor + np.asarray(offset, float), ball.faces


def edges_of_all_lengths() -> Arrays:
    """A fan whose spokes grow from 1e-12 to 1 of the diagonal."""
    length = np.geomspace(1e-12, 1, 25)
    turn = np.linspace(0, 1.5 * np.pi, 25)
    rim = np.stack([length * np.cos(turn), length * np.sin(turn), 0.3 * length], axis=1)
    number = np.arange(1, 25)
    return arrays(np.vstack([[0, 0, 0], rim]), np.stack([0 * number, number, number + 1], axis=1))


def strip(count: int, twists: int) -> Arrays:
    """A closed strip of 2·count triangles with so many half twists: one makes a Möbius strip."""
    u = np.arange(count) * 2 * np.pi / count
    sides = []
    for side in (-0.3, 0.3):
        radius = 1 + side * np.cos(twists * u / 2)
        sides.append(np.stack([radius * np.cos(u), radius * np.sin(u),
                               side * np.sin(twists * u / 2)], axis=1))  # fmt: skip
    faces = []
    for i in range(count):
        a, b = i, i + count
        j = (i + 1) % count
        c, d = (j, j + count) if j or twists % 2 == 0 else (j + count, j)
        faces += [[a, c, b], [b, c, d]]
    return arrays(np.vstack(sides), faces)


def klein_bottle(count: int = 12) -> Arrays:
    """The figure of eight turned by half a turn along a circle: closed, with one side."""
    u, v = np.meshgrid(*2 * [np.arange(count) * 2 * np.pi / count], indexing="ij")
    radius = 3 + np.cos(u / 2) * np.sin(v) - np.sin(u / 2) * np.sin(2 * v)
    height = np.sin(u / 2) * np.sin(v) + np.cos(u / 2) * np.sin(2 * v)
    points = np.stack([radius * np.cos(u), radius * np.sin(u), height], axis=-1).reshape(-1, 3)

    def number(i: int, j: int) -> int:  # once round, the eight has turned: v becomes −v
        return (i % count) * count + (j if i < count else -j) % count

    faces = []
    for i in range(count):
        for j in range(count):
            a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
            faces += [[a, b, c], [a, c, d]]
    return arrays(points, faces)


def folded_sheet() -> Arrays:
    """Two halves of a sheet that lie on each other: their normals cancel along the fold."""
    return arrays([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [1, 0, 0], [1, 1, 0]],
                  [[0, 2, 1], [1, 2, 3], [0, 1, 4], [1, 5, 4]])  # fmt: skip


def t_junction() -> Arrays:
    """A long edge on one side of which a vertex lies in the middle, on the other none."""
    return arrays([[0, 0, 0], [2, 0, 0], [1, 1, 0], [1, 0, 0], [0, -1, 0], [2, -1, 0.2]],
                  [[0, 1, 2], [0, 4, 3], [3, 4, 5], [3, 5, 1]])  # fmt: skip


def many(count: int, side: float = 0.1) -> Arrays:
    """So many triangles that touch nowhere, on the cells of a cube."""
    rows = round(count ** (1 / 3)) + 1
    cell = np.stack(np.unravel_index(np.arange(count), (rows, rows, rows)), axis=1).astype(float)
    turn = np.arange(count)[:, None] * 0.1 + np.array([0, 2, 4])
    corners = np.stack([np.cos(turn), np.sin(turn), np.sin(2 * turn)], axis=2) * side
    return (cell[:, None] + corners).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def fan(spokes: int) -> Arrays:
    """A flat cone of so many triangles round one vertex."""
    turn = np.arange(spokes) * 2 * np.pi / spokes
    rim = np.stack([np.cos(turn), np.sin(turn), 0 * turn - 0.3], axis=1)
    number = np.arange(spokes)
    faces = np.stack([0 * number, number + 1, (number + 1) % spokes + 1], axis=1)
    return arrays(np.vstack([[0, 0, 0], rim]), faces)


def torn_sphere(spacing: float = 1e-9) -> Arrays:
    """A sphere whose triangles share no vertices, their copies apart by a rounding."""
    ball = samples.sphere(80)
    points = ball.vertices[ball.faces].reshape(-1, 3)
    shift = spacing * np.sin(np.arange(points.size, dtype=float)).reshape(points.shape)
    return points + shift, np.arange(len(points)).reshape(-1, 3)


def isolated() -> Arrays:
    vertices, faces = golf_ball()
    return np.vstack([vertices, 3 * vertices[:7]]), faces


TETRAHEDRON = arrays(*tetrahedron())
NEEDLE = arrays([[0, 0, 0], [1, 0, 0], [0.5, 1e-12, 0], [0.5, 0, 1e-300]],
                [[0, 1, 2], [0, 3, 1], [1, 3, 2]])  # fmt: skip

SMALL: dict[str, Callable[[], Arrays]] = {
    "one triangle": lambda: arrays(np.eye(3), [[0, 1, 2]]),
    "one triangle of a size of 5e-151": lambda: arrays(5e-151 * np.eye(3) + 1, [[0, 1, 2]]),
    "one point": lambda: arrays(np.full((3, 3), 2.5), [[0, 1, 2]]),
    "one line": lambda: arrays([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]),
    "corners twice": lambda: arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [0, 1, 2]]),
    "needles": lambda: NEEDLE,
    "denormal coordinates": lambda: arrays(
        [[0, 0, 0], [1, 5e-324, 0], [0, 1, 5e-310], [5e-320, 0, 1]], tetrahedron()[1]
    ),
    "all faces the same": lambda: arrays(np.eye(3), np.tile([[0, 1, 2]], (50, 1))),
    "both sides of all faces": lambda: (
        TETRAHEDRON[0], np.vstack([TETRAHEDRON[1], TETRAHEDRON[1][:, ::-1]])
    ),
    "a folded sheet": folded_sheet,
    "a T-junction": t_junction,
    "three faces at an edge": lambda: arrays(
        [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0]],
        [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    ),
    "a Möbius strip": lambda: strip(30, 1),
    "a Klein bottle": klein_bottle,
    "edges from 1e-12 to 1": edges_of_all_lengths,
    "a torn sphere": torn_sphere,
    "isolated vertices": isolated,
    "a far vertex": lambda: arrays(np.vstack([np.eye(3), [[1e149, 0, 0]]]), [[0, 1, 2]]),
    "a far triangle": lambda: arrays(
        np.vstack([np.eye(3), 1e9 + np.eye(3)]), [[0, 1, 2], [3, 4, 5]]
    ),
    "1e-149": lambda: golf_ball(1e-149),
    "1e149": lambda: golf_ball(1e149),
    "1e-149 and flat": lambda: arrays([[0, 0, 0], [1e-149, 0, 0], [0, 1e-320, 0]], [[0, 1, 2]]),
    "1e8 sizes away": lambda: golf_ball(offset=(1e8, -1e8, 1e8)),
    "a cube with a wall of no thickness": lambda: arrays(
        [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 0)],
        [[0, 2, 4], [2, 6, 4], [1, 5, 3], [3, 5, 7]],
    ),
}  # fmt: skip

LARGE: dict[str, Callable[[], Arrays]] = {
    "100,000 components": lambda: many(100_000),
    "a fan of 100,000 spokes": lambda: fan(100_000),
    "100,000 faces the same": lambda: arrays(np.eye(3), np.tile([[0, 1, 2]], (100_000, 1))),
}
