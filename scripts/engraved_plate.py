"""Build a plate with engraved letters, as CAD systems triangulate it.

    python scripts/engraved_plate.py plate.ply [--text DEPICT] [--depth 0.2]

A thin box. Its top is large triangles, with small ones along the letters' outlines alone; the
letters are steps down of so many per cent of the diagonal. What `--refine` is tried on.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import meshdepict as md
from meshdepict.io import write_mesh

WIDTH, THICK, MARGIN = 10.0, 0.4, 0.6
STEP = 0.06  # of points along outlines, in units of the plate that is WIDTH wide

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def outlines(text: str, width: float) -> list[Array]:
    """Return the closed outlines of letters, so wide in all, from the origin, as (n, 2) points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    font = FontProperties(family="DejaVu Sans", weight="bold")
    path = TextPath((0, 0), text, size=100, prop=font)
    loops = [np.asarray(loop)[:-1] for loop in path.to_polygons(closed_only=True)]
    low = np.min([loop.min(axis=0) for loop in loops], axis=0)
    high = np.max([loop.max(axis=0) for loop in loops], axis=0)
    return [resampled((loop - low) * width / (high - low)[0]) for loop in loops]


def resampled(loop: Array) -> Array:
    """Return a loop with points no further apart than STEP, its corners kept."""
    loop = loop[np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1) > STEP / 20]
    found = []
    for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / STEP)))
        found.append(a + (b - a) * np.arange(count)[:, None] / count)
    return np.concatenate(found)


def inside(points: Array, loops: list[Array]) -> NDArray[np.bool_]:
    """Whether points lie within an odd number of loops."""
    odd = np.zeros(len(points), bool)
    for loop in loops:
        for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            spans = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
            rise = b[1] - a[1] or 1.0
            odd ^= spans & (points[:, 0] < a[0] + (points[:, 1] - a[1]) * (b - a)[0] / rise)
    return odd


def engraved_plate(text: str = "DEPICT", depth: float = 0.2) -> md.Mesh:
    """Return the plate; the depth of its letters in per cent of its diagonal."""
    import pyvista as pv

    loops = [loop + MARGIN for loop in outlines(text, WIDTH - 2 * MARGIN)]
    height = MARGIN + max(float(loop[:, 1].max()) for loop in loops)
    down = depth / 100 * float(np.linalg.norm((WIDTH, height, THICK)))
    frame = np.array([(0, 0), (WIDTH, 0), (WIDTH, height), (0, height)])
    flat = np.concatenate([frame, *loops])
    starts = np.cumsum([4, *map(len, loops)])
    sides = np.concatenate(
        [start + ring(len(loop)) for start, loop in zip(starts[:-1], loops, strict=True)]
    )
    lines = np.concatenate([np.full((len(sides), 1), 2), sides], axis=1)
    level = np.pad(flat, ((0, 0), (0, 1)))
    top = pv.PolyData(level).delaunay_2d(offset=100, edge_source=pv.PolyData(level, lines=lines))
    faces = top.regular_faces.astype(np.int64)
    assert len(top.points) == len(flat)
    a, b, c = flat[faces].swapaxes(0, 1)
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    faces[turned] = faces[turned, ::-1]
    sunk = inside((a + b + c) / 3, loops)

    # The plate's top, the letters' floors (of vertices of their own), walls, sides and bottom.
    count = len(flat)
    floor = np.arange(count) + count  # the frame's copies are the bottom's corners
    points = np.concatenate([level, level - (0, 0, down)])
    points[count : count + 4, 2] = -THICK
    i, j = sides.T
    walls = np.concatenate([np.stack([i, j, floor[j]], 1), np.stack([i, floor[j], floor[i]], 1)])
    # A wall shows itself to the letter, which must lie to the left of its side i → j.
    middle = (flat[i] + flat[j]) / 2
    left = np.stack([-(flat[j] - flat[i])[:, 1], (flat[j] - flat[i])[:, 0]], axis=1)
    wrong = np.tile(~inside(middle + left / 50, loops), 2)
    walls[wrong] = walls[wrong, ::-1]
    k, n = ring(4).T
    box = np.concatenate([np.stack([k, floor[k], floor[n]], 1), np.stack([k, floor[n], n], 1)])
    bottom = floor[np.array([(0, 2, 1), (0, 3, 2)])]
    every = np.concatenate([faces[~sunk], floor[faces[sunk]], walls, box, bottom])
    return md.Mesh(points, every)


def ring(count: int) -> Ints:
    """Return the sides (count, 2) of a closed loop."""
    here = np.arange(count)
    return np.stack([here, (here + 1) % count], axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path, help="a mesh file, .ply for instance")
    parser.add_argument("--text", default="DEPICT")
    parser.add_argument("--depth", type=float, default=0.2, help="per cent of the diagonal")
    given = parser.parse_args()
    plate = engraved_plate(given.text, given.depth)
    write_mesh(given.output, plate)
    print(f"{given.output}: {plate}")


if __name__ == "__main__":
    main()
