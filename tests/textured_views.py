"""What renderers have to show of textured meshes: every pixel's colour, looked up by ourselves."""

from __future__ import annotations

import numpy as np
from textured_shapes import picture, sheet

from meshdepict import color
from meshdepict.shapes.appearance import Appearance
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.textures import Textures


def noise(side, seed):
    """A picture of noise; cards find places between texels in steps of a 256th, here 0.3 levels."""
    return np.random.default_rng(seed).integers(96, 161, (side, side, 3), np.uint8)


def hill(n=6):
    """A sheet that is no plane, so that something is to be shaded."""
    return sheet(n, height=lambda x, y: 0.2 * np.sin(4 * x) * np.cos(3 * y))


def wrapped(wrap, *, tinted=False, side=16):
    """A sheet in two materials and none, its pictures wrapped, one of them times a factor."""
    mesh = sheet(6)
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    material = np.where(middle[:, 1] > 2 / 3, -1, (middle[:, 0] > 0.5).astype(np.int64))
    textures = Textures(
        3 * mesh.texcoords - 0.7, material,
        (picture(noise(side, 1), wrap=wrap), picture(noise(side, 2), wrap=wrap)),
        np.array([[1, 1, 1, 1], [0.5, 0.8, 0.2, 1]]), (None, None), np.ones(2), tinted=tinted,
    )  # fmt: skip
    attributes = {}
    if tinted:
        colors = np.random.default_rng(3).integers(100, 256, (len(mesh.vertices), 3), np.uint8)
        attributes["vertex"] = dict(zip(("red", "green", "blue"), colors.T, strict=True))
    return Mesh(mesh.vertices, mesh.faces, attributes=attributes).with_textures(textures)


def looked_up(appearance: Appearance, view, size):
    """What an appearance looks like: (h, w, 3) in grey levels, and where no edge is near.

    Without mipmaps: pictures have to be magnified.
    """
    mesh = appearance.mesh
    buffer = GBuffer.of(mesh, view, size=size)
    triangle, weights = buffer.triangle, buffer.barycentric
    found = np.ones((len(triangle), 3))
    if appearance.textures is not None:
        found = appearance.textures.colors(triangle, weights).astype(np.float64)
    if appearance.colors is not None:
        at = np.einsum("nc,ncx->nx", weights, appearance.colors[mesh.faces[triangle]] / 255)
        light = color.srgb_to_linear(found) * color.srgb_to_linear(at)
        found = np.asarray(color.linear_to_srgb(light))
    image = np.zeros((size[1], size[0], 3))
    hit = buffer.image(np.ones(len(triangle), bool)) != 0
    image[hit] = 255 * found
    inner = hit.copy()
    material = np.zeros(len(mesh.faces)) if appearance.textures is None else (
        appearance.textures.material
    )  # fmt: skip
    which = np.full(hit.shape, -2.0)
    which[hit] = material[triangle]
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(which, step, axis) == which
            inner &= np.roll(hit, step, axis)
    return image, inner


def islands(baked, *, steps=64):
    """Blacken all texels of a baked texture that no place within a triangle needs; whiten those."""
    share = np.arange(steps + 1) / steps
    a, b = (axis.ravel() for axis in np.meshgrid(share, share))
    weights = np.stack([a, b, 1 - a - b], axis=1)[a + b <= 1 + 1e-9]
    size = len(baked.image)
    places = np.einsum("kc,mci->mki", weights, baked.texcoords).reshape(-1, 2)
    column, row = np.floor(np.stack([places[:, 0], 1 - places[:, 1]]) * size - 0.5).astype(int)
    baked.image[...] = 0
    for x in (0, 1):
        for y in (0, 1):
            baked.image[row + y, column + x] = 255
    return baked
