"""A weathered clay tablet with photographs laid on it: what photogrammetry gives, without a find.

Its triangles are coarse and uneven, its texture is in six charts and of two materials.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.images.encoded import encode
from meshdepict.options import Range, check
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.textures import Texture, Textures

__all__ = ["photographed_tablet"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_MOST = 10_000_000
_HALF = np.array([1.0, 0.7, 0.25])  # of its length, height and thickness
_SQUARENESS = 4  # |x/a|⁴ + |y/b|⁴ + |z/c|⁴ = 1
_UNEVEN = 0.2  # of a cell by which vertices lie elsewhere than on a grid
_WAVES, _WEATHERED = 24, 0.0015
_ROWS, _SIGNS, _CARVED = 4, 7, 0.04
_MARGIN = 0.06  # of a chart's field
_CLAY, _GLAZE = (176, 128, 92), (112, 126, 118)


def photographed_tablet(
    vertices: Annotated[int, Range(8, _MOST)] = 3_000,
    *,
    texels: Annotated[int, Range(1, 8192, help="along the sides of its pictures")] = 512,
) -> Mesh:
    """Return a tablet about the origin, two wide, with wedges pressed into its front (+z).

    Its texture is as files have it: the six sides of a cube are charts in one square, some of them
    beyond its edges, where it repeats; front and back show one picture, the rim another.

    Parameters
    ----------
    vertices : int
        About how many: 6 n² + 2 with n whole.
    texels : int

    Raises
    ------
    MeshdepictError
        For an argument out of its range.
    """
    given = check(
        photographed_tablet, {"vertices": vertices, "texels": texels}, "photographed_tablet"
    )
    count, side = int(given["vertices"]), int(given["texels"])
    cells = max(1, round(((count - 2) / 6) ** 0.5))
    chance = np.random.default_rng(16)
    places, faces, texcoords = _cube(cells)
    lattice, number = np.unique(places, axis=0, return_inverse=True)
    uneven = chance.uniform(-_UNEVEN, _UNEVEN, lattice.shape) * 2 / cells
    directions = (2 * lattice / cells - 1 + uneven) * _HALF
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    radius = (np.abs(directions / _HALF) ** _SQUARENESS).sum(axis=1) ** (-1 / _SQUARENESS)
    points = directions * radius[:, None]
    waves = chance.normal(0, 8, (3, _WAVES))
    rough = np.sin(points @ waves + chance.uniform(0, 2 * np.pi, _WAVES)).sum(axis=1)
    points += _WEATHERED * rough[:, None] * directions
    points[:, 2] -= np.where(points[:, 2] > 0, _CARVED, 0) * _wedges(points[:, :2], chance)
    material = np.repeat([1, 1, 1, 1, 0, 0], len(faces) // 6)
    pictures = [
        Texture(f"{name}.png", encode(_photograph(side, color, chance)), "png")
        for name, color in (("written", _CLAY), ("rim", _GLAZE))
    ]
    return Mesh(points, number.reshape(-1)[faces]).with_textures(
        Textures(texcoords, material, tuple(pictures), np.ones((2, 4)), (None, None), np.ones(2))
    )


def _cube(cells: int) -> tuple[Ints, Ints, Floats]:
    """Return points of a cube's lattice, the triangles of its sides, and where these are laid."""
    along = np.arange(cells + 1)
    u, v = (axis.ravel() for axis in np.meshgrid(along, along))
    grid = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = (
        part.ravel() for part in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1])
    )
    cut = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    places, faces, texcoords = [], [], []
    for side in range(6):
        axis, far = side // 2, side % 2 == 0
        point = np.empty((len(u), 3), np.int64)
        point[:, axis] = cells if far else 0
        point[:, (axis + 1) % 3] = u if far else cells - u
        point[:, (axis + 2) % 3] = v
        places.append(point)
        faces.append(cut + side * len(u))
        inner = _MARGIN + (1 - 2 * _MARGIN) * np.stack([u, v], 1) / cells
        field = (np.array([side % 3, side // 3]) + inner) * (1 / 3, 1 / 2)
        texcoords.append((field + np.array([side % 2, -(side // 4)]))[cut])
    return np.concatenate(places), np.concatenate(faces), np.concatenate(texcoords)


def _wedges(points: Floats, chance: np.random.Generator) -> Floats:
    """Return how deep (n,) wedges are pressed at points (n, 2), as a share of the deepest."""
    depth = np.zeros(len(points))
    for y in np.linspace(-0.48, 0.48, _ROWS):
        for x in np.linspace(-0.75, 0.75, _SIGNS):
            turn = chance.uniform(-0.6, 0.6) + chance.integers(2) * np.pi / 2
            off = points - (x, y) - chance.uniform(-0.03, 0.03, 2)
            along = off @ (np.cos(turn), np.sin(turn))
            across = off @ (-np.sin(turn), np.cos(turn))
            depth = np.maximum(depth, np.exp(-((along / 0.09) ** 2) - (across / 0.045) ** 2))
    return depth


def _photograph(
    side: int, color: tuple[int, int, int], chance: np.random.Generator
) -> NDArray[np.uint8]:
    """Return a picture (side, side, 3) of weathered stuff that goes on beyond its edges."""
    noise = np.fft.rfft2(chance.standard_normal((side, side)))
    rows, columns = np.fft.fftfreq(side)[:, None], np.fft.rfftfreq(side)[None]
    falling = 1 / np.maximum(np.hypot(rows, columns), 1 / side) ** 1.2
    falling[0, 0] = 0
    stains = np.fft.irfft2(noise * falling, (side, side))
    stains /= stains.std() or 1.0
    specks = chance.random((side, side, 1)) > 0.995
    shown = np.array(color) * (1 + 0.12 * stains[..., None]) - 60 * specks
    return np.clip(np.rint(shown), 0, 255).astype(np.uint8)
