"""The textures of an OBJ file: its faces' materials, and the pictures that these name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.images.encoded import is_color
from meshdepict.io.obj_lines import Lines
from meshdepict.io.obj_materials import Library, Map, Material, libraries
from meshdepict.io.texture_files import file_fault, named_texture
from meshdepict.shapes.textures import Texture, Textures, laid_textures

__all__ = ["library_faults", "obj_textures", "texture_faults"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def texture_faults(found: list[Library], folder: Path) -> list[str]:
    """Say which pictures of base colours and normals can't be had; none is read."""
    laid = [
        (library, one)
        for library in found
        for material in library.materials.values()
        for one in (material.base, material.normal, material.bump)
        if one is not None
    ]
    return [one.fault or file_fault(folder, library.beside(one.name)) for library, one in laid]


def library_faults(found: list[Library]) -> list[str]:
    """Say which libraries can't be had."""
    return [library.fault for library in found if library.fault]


def obj_textures(
    data: bytes, folder: Path, texture: Floats, corner: Ints, owner: Ints
) -> Textures | None:
    """Return what an OBJ file lays on its triangles, or None.

    Parameters
    ----------
    data : bytes
    folder : Path
        Of the file: only what lies there, or below, is read.
    texture : (t, 2) array
        The ``vt`` lines.
    corner : (m, 3) array
        Which of them each corner of the triangles has, −1 none.
    owner : (m,) array
        The face that each triangle comes from.
    """
    materials: dict[str, tuple[Library, Material]] = {}
    for library in libraries(data, folder):
        for name, material in library.materials.items():
            materials.setdefault(name, (library, material))
    held = list(materials.values())
    base = [_picture(folder, library, material.base) for library, material in held]
    normals = [_normals(folder, library, material) for library, material in held]
    if not any(base) and not any(maps for _, maps in normals):
        return None
    numbers = {name: number for number, name in enumerate(materials)}
    lines = Lines(data)
    used = [row.strip() for row in lines.bodies(b"usemtl").split(b"\n")[:-1]]
    named = [numbers.get(word.decode("utf-8", "surrogateescape"), -1) for word in used]
    own = np.array([-1, *named])[lines.before(b"f", b"usemtl")][owner]
    known = (corner >= 0) & (corner < len(texture))
    uv = np.full((*corner.shape, 2), np.nan)
    uv[known] = texture[corner[known]]
    base_uv, normal_uv = uv.copy(), uv.copy()
    for number, ((_, material), (normal, _)) in enumerate(zip(held, normals, strict=True)):
        chosen = own == number
        for where, laid in ((base_uv, material.base), (normal_uv, normal)):
            if laid is not None:
                where[chosen] = laid.moved(uv[chosen])
    return laid_textures(
        base_uv,
        own,
        base,
        np.array([material.factor for _, material in held]),
        [maps for _, maps in normals],
        np.array([1.0 if laid is None else laid.strength for laid, _ in normals]),
        normal_uv,
    )


def _picture(folder: Path, library: Library, laid: Map | None) -> Texture | None:
    if laid is None:
        return None
    if laid.fault:
        return Texture(laid.name, None, "", laid.wrap, fault=laid.fault)
    return named_texture(folder, library.beside(laid.name), laid.wrap)


def _normals(
    folder: Path, library: Library, material: Material
) -> tuple[Map | None, Texture | None]:
    """Return a material's normal map: what it calls so, else a bump map that has colours."""
    if material.normal is not None:
        return material.normal, _picture(folder, library, material.normal)
    found = _picture(folder, library, material.bump)
    if found is None or found.encoded is None:
        return None, None
    try:
        colored = is_color(found.encoded)
    except MeshdepictError:
        colored = False
    return (material.bump, found) if colored else (None, None)
