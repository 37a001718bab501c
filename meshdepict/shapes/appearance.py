"""What a surface looks like: colours at its vertices, textures on its triangles, or both."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Texture, Textures

__all__ = ["Appearance", "Primitive", "whole_turns"]

Floats = NDArray[np.float64]


class Primitive(NamedTuple):
    """Triangles in one material, with a vertex for each place that corners have on its picture.

    Attributes
    ----------
    vertices : (k,) array of int
        Which of the mesh's vertices each one is.
    texcoords : (k, 2) array
        v up.
    faces : (m, 3) array of int
        Of these vertices.
    texture : Texture or None
        White where there is none.
    factor : (3,) array
        What the picture is multiplied by, in linear light.
    """

    vertices: NDArray[np.int64]
    texcoords: Floats
    faces: NDArray[np.int64]
    texture: Texture | None
    factor: Floats

    @property
    def wrap(self) -> tuple[str, str]:
        """Along u and v, what lies beyond the picture's edge: see `WRAPS`."""
        return ("clamp", "clamp") if self.texture is None else self.texture.wrap

    @property
    def pixels(self) -> NDArray[np.uint8]:
        """The picture (h, w, 3) in 8 bits, times the factor; one white texel without a texture."""
        if self.texture is None:
            found = np.full((1, 1, 3), 255, np.uint8)
        else:
            found = self.texture.pixels[..., :3]
        if found.dtype == np.uint8 and (self.factor == 1).all():
            return found
        most = np.iinfo(found.dtype).max
        linear = srgb_to_linear(np.arange(most + 1, dtype=np.float32) / np.float32(most))
        times = np.clip(np.asarray(linear)[:, None] * self.factor, 0, 1)
        levels = np.rint(255 * np.asarray(linear_to_srgb(times))).astype(np.uint8)
        return np.stack([levels[found[..., i], i] for i in range(3)], axis=2)


@dataclass(frozen=True, eq=False)
class Appearance:
    """How a mesh of n vertices looks, unlit.

    Attributes
    ----------
    mesh : Mesh
    colors : (n, 3) array of uint8, optional
        sRGB at the vertices; they multiply textures, in linear light.
    textures : Textures, optional
    """

    mesh: Mesh
    colors: NDArray[np.uint8] | None = None
    textures: Textures | None = None

    @property
    def name(self) -> str:
        """What it is called as the mesh's own."""
        return "its own colours" if self.textures is None else "its own texture"

    @cached_property
    def primitives(self) -> tuple[Primitive, ...]:
        """The triangles of each material that there is; without textures there are none."""
        textures = self.textures
        if textures is None:
            return ()
        return tuple(self._primitive(textures, int(k)) for k in np.unique(textures.material))

    def _primitive(self, textures: Textures, k: int) -> Primitive:
        triangles = np.flatnonzero(textures.material == k)
        texture = textures.base_colors[k] if k >= 0 else None
        factor = textures.factors[k, :3] if k >= 0 else np.ones(3)
        vertex = self.mesh.faces[triangles].reshape(-1)
        uv = np.zeros((len(vertex), 2))
        if texture is not None:
            near = textures.texcoords[triangles]
            uv = (near - whole_turns(near, texture.wrap)).reshape(-1, 2)
        order = np.lexsort((uv[:, 1], uv[:, 0], vertex))
        rows = np.column_stack([vertex, uv])[order]
        new = np.concatenate([[True], (rows[1:] != rows[:-1]).any(axis=1)])
        number = np.empty(len(order), np.int64)
        number[order] = np.cumsum(new) - 1
        first = order[new]
        return Primitive(vertex[first], uv[first], number.reshape(-1, 3), texture, factor)


def whole_turns(texcoords: Floats, wrap: tuple[str, str]) -> Floats:
    """Return what far-away coordinates (m, 3, 2) of triangles can do without, (m, 1, 2).

    Single precision has no digits for texels far from 0, and where a picture repeats, a triangle
    may as well lie near. What lies near already stays.
    """
    low = texcoords.min(axis=1, keepdims=True)
    found: NDArray[Any] = np.zeros_like(low)
    for axis, how in enumerate(wrap):
        if how != "clamp":
            step = 2 if how == "mirror" else 1  # after which the picture is as it was
            turns = step * np.floor(low[..., axis] / step)
            found[..., axis] = np.where(np.abs(turns) > _NEAR, turns, 0)
    return found


_NEAR = 64
