"""A glTF file as it was read: its header, its buffers, and the textures of its triangles."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import any_numbers
from meshdepict.io.gltf_buffers import Buffers, pick
from meshdepict.io.gltf_materials import WHITE, base_factor, is_textured, laid, texture
from meshdepict.io.gltf_scene import Part, Scene
from meshdepict.shapes.document import Document, same_vertices
from meshdepict.shapes.textures import Texture, Textures, laid_textures
from meshdepict.surface.polygons import Polygons, as_polygons

__all__ = ["GltfDocument", "joined_faces", "joined_points", "wrong_as_gltf"]

Floats = NDArray[np.float64]


@contextmanager
def wrong_as_gltf() -> Iterator[None]:
    """Let whatever a header that doesn't follow the standard leads to be one clause."""
    try:
        yield
    except MeshdepictError:
        raise
    except (LookupError, ValueError) as error:
        said = " ".join(f"{type(error).__name__}: {error}".split())
        raise MeshdepictError(f"is wrong as glTF ({said:.200})") from error
    except (ArithmeticError, AttributeError, TypeError) as error:
        raise MeshdepictError(
            "is wrong as glTF: its JSON part holds a value of the wrong kind"
        ) from error


def joined_points(parts: list[Part]) -> Floats:
    """Return the points of all parts."""
    return np.concatenate([np.empty((0, 3)), *(part.points for part in parts)])


def joined_faces(parts: list[Part]) -> NDArray[np.int64]:
    """Return the triangles of all parts, as indices of the joined points."""
    before = np.cumsum([0, *(len(part.points) for part in parts)])
    return np.concatenate(
        [np.empty((0, 3), np.int64)]
        + [part.faces + first for part, first in zip(parts, before, strict=False)]
    )


@dataclass(frozen=True, kw_only=True)
class GltfDocument(Document):
    """A glTF file without the depiction that this program put beside its own scenes.

    Attributes
    ----------
    header : dict
        Of the file; not to be changed.
    buffers : Buffers
        Of the header.
    depicted : bool
        Whether there was such a depiction: the mesh's colours are its.
    """

    header: dict[str, Any]
    buffers: Buffers
    depicted: bool = False
    formats: tuple[str, ...] = (".glb", ".gltf")

    @any_numbers()
    def parts(self, *, textured: bool = False) -> list[Part]:
        """Return the triangles of the file's scene again; see `Scene`."""
        with wrong_as_gltf():
            return Scene(self.header, self.buffers, textured=textured).parts()

    def describes(self, vertices: Floats | None, polygons: Polygons) -> bool:
        """Whether these are the file's vertices (if given) and polygons, not changed ones."""
        try:
            parts = self.parts()
        except MeshdepictError:  # a buffer in a file of its own has gone
            return False
        faces = as_polygons(joined_faces(parts))
        return same_vertices(vertices, joined_points(parts)) and all(
            map(np.array_equal, faces, polygons)
        )

    @property
    def extras(self) -> tuple[str, ...]:
        """What the file holds that no other format keeps."""
        with wrong_as_gltf():
            return tuple(Scene(self.header, self.buffers).extras())

    @property
    def is_textured(self) -> bool:
        """Whether a material of the file lays a texture."""
        return is_textured(self.header)

    @any_numbers()
    def textures(self, corners: NDArray[np.int64]) -> Textures | None:
        """Return what the file lays on its triangles, or None."""
        if not self.is_textured:
            return None
        parts = self.parts(textured=True)
        with wrong_as_gltf():
            return self._textures(parts)

    def _textures(self, parts: list[Part]) -> Textures | None:
        materials = self.header.get("materials", [])
        base: list[Texture | None] = []
        normal: list[Texture | None] = []
        scales = []
        for number in range(len(materials)):
            material = pick(self.header, "materials", number)
            lays = laid(material, 0), laid(material, 1)
            for found, lay in zip((base, normal), lays, strict=True):
                found.append(texture(self.header, self.buffers, lay.index) if lay else None)
            scales.append(lays[1].strength if lays[1] else 1.0)
        own, uv, normal_uv = (
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("material", "uv", "normal_uv")
        )
        factors = [base_factor(material) for material in materials] or [WHITE]
        return laid_textures(
            uv, own, base, np.array(factors), normal, np.array(scales), normal_uv, tinted=True
        )
