"""Objects of the figures that are no scans of the data folder: made here, or made of its data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from scipy.ndimage import gaussian_filter

import meshdepict as md
from meshdepict import samples
from meshdepict.shapes.isosurface import isosurface

EMBOSSED = 0.004  # height of letters, in halves of a page's height
BONE = 1150.0  # raw number of the CT head at hand; of Hounsfield units about 200

Heights = NDArray[np.float64]


def sheet(heights: Heights, spacing: float) -> md.Mesh:
    """Return a grid of heights, its first row the northernmost, as a mesh towards z; NaN: a gap."""
    rows, columns = heights.shape
    y, x = np.mgrid[0:rows, 0:columns] * spacing
    points = np.stack([x, -y, heights], axis=-1).reshape(-1, 3)
    number = np.arange(rows * columns).reshape(rows, columns)
    corners = number[1:, :-1], number[1:, 1:], number[:-1, 1:], number[:-1, :-1]
    cells = np.stack(corners, axis=-1).reshape(-1, 4)
    there = np.isfinite(points[:, 2])
    new = np.cumsum(there) - 1
    return md.Mesh(points[there], new[cells[there[cells].all(axis=1)]], winding="keep")


def vase(beside: md.Mesh) -> md.Mesh:
    """Return a vase as high as an object, which stands behind its right side."""
    low, high = beside.vertices.min(axis=0), beside.vertices.max(axis=0)
    extent = high - low
    along, turn = np.linspace(0, 1, 160), np.linspace(0, 2 * np.pi, 241)[:-1]
    radius = extent[1] * (0.15 + 0.16 * np.sin(np.pi * (1.25 * along + 0.05)) ** 2)
    points = np.stack(
        [
            np.outer(radius, np.cos(turn)),
            np.outer(extent[1] * along, np.ones_like(turn)),
            np.outer(radius, np.sin(turn)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    ring, corner = np.mgrid[0 : len(along) - 1, 0 : len(turn)]
    here, there = ring * len(turn), (ring + 1) * len(turn)
    after = (corner + 1) % len(turn)
    faces = np.stack([here + corner, there + corner, there + after, here + after], axis=-1)
    place = [high[0] - 0.05 * extent[0], low[1], (low[2] + high[2]) / 2 - 1.1 * extent[2]]
    return md.Mesh(points + place, faces.reshape(-1, 4))


def manuscript(vertices: int, *, written: bool = True) -> md.Mesh:
    """Return a page that was folded in four and is not flat, letters embossed on it."""
    n = round(vertices**0.5)
    y, x = np.mgrid[1 : -1 : n * 1j, -1 : 1 : n * 1j]
    heights = 0.08 * np.cos(2 * x + y) + 0.02 * np.sin(5 * x - 3 * y)
    heights -= 0.006 * (np.exp(-np.abs(x) / 0.02) + np.exp(-np.abs(y) / 0.02))
    if written:
        heights += EMBOSSED * letters("DEPICT\nSHAPE &\nDETAIL", n)
    return sheet(heights, 2 / (n - 1))


def letters(text: str, size: int) -> Heights:
    """Return letters that fill a square picture, from 0 to 1 with soft edges."""
    from matplotlib import get_data_path

    font = Path(get_data_path(), "fonts", "ttf", "DejaVuSans-Bold.ttf")
    ink = Image.new("L", (4 * size, 4 * size))
    draw = ImageDraw.Draw(ink)
    for line, words in enumerate(text.split("\n")):
        place = 2 * size, (0.85 + 1.15 * line) * size
        draw.text(place, words, 255, ImageFont.truetype(font, 0.75 * size), anchor="mm")
    return gaussian_filter(np.asarray(ink.resize((size, size)), np.float64) / 255, size / 300)


def head(folder: Path | None, size: int) -> tuple[md.Volume, str]:
    """Return a CT head and which axis is up: the one of the data folder, or the phantom."""
    if folder is None:
        return samples.ct_phantom((size, size, size)), "z"
    return md.read_volume(folder / "ct" / "ct_headsq_64x64x93.nrrd"), "-z"


def skull(folder: Path | None, vertices: int) -> md.Mesh:
    """Return the bone of a CT head, which looks towards z, y up."""
    volume, up = head(folder, max(24, round(vertices**0.5 / 2)))
    bone = isosurface(volume, 200.0 if folder is None else BONE)
    turn = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)
    if up == "-z":
        turn[[0, 1]] *= -1
    return md.Mesh(bone.vertices @ turn.T, bone.faces)
