"""Shapes with texture coordinates, made here, and pictures for them."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.textures import Texture, Textures


def picture(pixels, *, wrap=("clamp", "clamp"), name="picture.png"):
    """Pixels (h, w, 3) of uint8 as a texture."""
    stream = io.BytesIO()
    Image.fromarray(np.asarray(pixels, np.uint8)).save(stream, "PNG")
    return Texture(name, stream.getvalue(), "png", wrap)


def laid(mesh, texcoords, *, base=None, normal=None, strength=1.0):
    """A mesh with an atlas in one material."""
    count = len(mesh.faces)
    return mesh.with_textures(
        Textures(
            np.asarray(texcoords, np.float64), np.zeros(count, np.int64), (base,), np.ones((1, 4)),
            (normal,), np.array([strength]),
        )
    )  # fmt: skip


def grid(n):
    """Vertex numbers of a grid of n × n cells, and its triangles, counter-clockwise."""
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)  # rows upwards
    a, b, c, d = (
        part.ravel()
        for part in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    )
    return number, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def sheet(n=8, *, height=None):
    """A square (0 … 1)² that looks up, with coordinates x and y; or a graph over it."""
    _, faces = grid(n)
    y, x = (axis.ravel() / n for axis in np.mgrid[: n + 1, : n + 1])
    z = np.zeros_like(x) if height is None else height(x, y)
    return laid(Mesh(np.stack([x, y, z], 1), faces), np.stack([x, y], 1)[faces])


def globe(n=24, *, margin=0.02, **more):
    """A unit sphere of six charts, the sides of a cube, each in a field of its own."""
    _, faces = grid(n)
    v, u = (axis.ravel() / n for axis in np.mgrid[: n + 1, : n + 1])
    a, b = np.tan((u - 0.5) * np.pi / 2), np.tan((v - 0.5) * np.pi / 2)
    points, corners, texcoords = [], [], []
    for side in range(6):
        axis, sign = side // 2, 1 - 2 * (side % 2)
        direction = np.empty((len(u), 3))
        direction[:, axis] = sign
        direction[:, (axis + 1) % 3] = sign * a
        direction[:, (axis + 2) % 3] = b
        points.append(direction / np.linalg.norm(direction, axis=1, keepdims=True))
        field = np.array([side % 3, side // 3])
        size = np.array([1 / 3, 1 / 2])
        place = (field + margin + (1 - 2 * margin) * np.stack([u, v], 1)) * size
        corners.append(faces + side * len(u))
        texcoords.append(place[faces])
    # Vertices of neighbouring sides are at bit-identical positions: they share normals.
    points = np.round(np.concatenate(points), 12)
    return laid(Mesh(points, np.concatenate(corners)), np.concatenate(texcoords), **more)
