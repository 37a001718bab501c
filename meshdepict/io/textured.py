"""Writing a mesh with one texture on it: GLB and glTF, OBJ with its material, PLY as MeshLab's."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import any_numbers
from meshdepict.files.atomic import atomic_write
from meshdepict.files.companions import Companions
from meshdepict.files.mark import MARK
from meshdepict.images.encoded import KINDS
from meshdepict.io.source import suffix_of
from meshdepict.shapes.document import Saving

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Texture

__all__ = ["TEXTURED", "write_textured"]

Floats = NDArray[np.float64]

TEXTURED = (".glb", ".gltf", ".obj", ".ply")
"""Suffixes of files that hold a mesh with its texture, or name it."""


def write_textured(
    path: str | os.PathLike[str],
    mesh: Mesh,
    *,
    given: Mesh | None = None,
    comments: Iterable[str] = (),
    mipmaps: bool = True,
) -> None:
    """Write a mesh with the first of its base colours on it, wholly or not at all.

    GLB and glTF embed the picture, and keep the scenes of the file that the mesh was read from
    beside; OBJ and PLY name it, it is written beside them, and they keep what else was in the file
    of their format that the mesh was read from. In other formats vertices and their data stay.

    Parameters
    ----------
    path : path
        Ends in one of `TEXTURED`.
    mesh : Mesh
        With textures.
    given : Mesh, optional
        As it was read, with the same triangles, where its polygons became triangles since.
    comments : iterable of str
        Lines of provenance.
    mipmaps : bool
        Whether smaller copies of the picture are of any use; only glTF can say so.

    Raises
    ------
    MeshdepictError
        For another suffix, and every failure to write.
    """
    suffix = suffix_of(path)
    if suffix not in TEXTURED or Path(path).suffix.lower() == ".gz":
        raise MeshdepictError(
            f"{path}: meshes with textures are saved as {', '.join(TEXTURED)}, not packed"
        )
    assert mesh.textures is not None
    picture = mesh.textures.base_colors[0]
    assert picture is not None
    companions = Companions(path)
    saving = Saving(None, tuple(comments), suffix=suffix, companions=companions)
    with atomic_write(path) as file, any_numbers():
        source = mesh if given is None else given
        if suffix == ".obj":
            from meshdepict.io.textured_obj import encode_textured_obj

            named = _beside(path, picture, companions)
            encode_textured_obj(file, mesh, source, saving, named, Path(path).stem)
        elif suffix == ".ply":
            from meshdepict.io.textured_ply import encode_textured_ply

            encode_textured_ply(file, mesh, source, saving, _beside(path, picture, companions))
        else:
            _encode_gltf(file, mesh, saving, picture, mipmaps=mipmaps)
        companions.write()


def _beside(path: str | os.PathLike[str], picture: Texture, companions: Companions) -> str:
    """Let a picture be written beside a mesh's file, called as that is; return its name."""
    assert picture.encoded is not None
    name = Path(path).stem + KINDS[picture.kind][1]
    return companions.written(name, picture.encoded, mark=MARK.encode())


def _encode_gltf(
    file: BinaryIO, mesh: Mesh, saving: Saving, picture: Texture, *, mipmaps: bool
) -> None:
    from meshdepict.io.gltf import encode
    from meshdepict.io.gltf_depiction import Laid
    from meshdepict.io.gltf_scene import Part

    assert mesh.texcoords is not None
    # A vertex for each pair of place and coordinates.
    corners = np.column_stack([mesh.faces.reshape(-1), mesh.texcoords.reshape(-1, 2)])
    order = np.lexsort(corners.T[::-1])
    ranked = corners[order]
    new = np.concatenate([[True], (ranked[1:] != ranked[:-1]).any(axis=1)])
    number = np.empty(len(corners), np.int64)
    number[order] = np.cumsum(new) - 1
    first = order[new]
    part = Part(mesh.vertices[mesh.faces.reshape(-1)[first]], number.reshape(-1, 3), None, None)
    laid = Laid(picture, mesh.texcoords.reshape(-1, 2)[first], mipmaps)
    encode(file, mesh, saving, laid=(part, laid))
