"""A surface's own colours: those of its file, at its vertices or in its textures."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.provenance import was_baked
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.appearance import Appearance
from meshdepict.shapes.colors import vertex_colors
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh

__all__ = ["own_appearance", "own_colors", "surface_tints"]


def own_colors(shape: Mesh | GBuffer | HeightField) -> NDArray[np.uint8]:
    """Return a mesh's own vertex colours, or an image's own, or those of the mesh that it shows."""
    if isinstance(shape, Mesh):
        return _mesh_colors(shape)
    if isinstance(shape, HeightField):
        raise MeshdepictError("albedo='keep' needs colours of its own, and a height field has none")
    if shape.colors is not None:
        return shape.colors
    if shape.mesh is None:
        raise MeshdepictError(
            "albedo='keep' needs the image's own colours: give them as from_images(colors=…)"
        )
    linear = color.srgb_to_linear(_mesh_colors(shape.mesh) / np.float32(255))
    return color.encode(shape.sample(linear), linear=True)


def surface_tints(
    shape: Mesh | GBuffer | HeightField, own: NDArray[np.uint8]
) -> NDArray[np.float32] | None:
    """Return the own colours (v, 3) of the vertices that light bounces from, in linear light.

    Of a mesh they are those of its samples. None of an image of something that has none.
    """
    found: NDArray[np.uint8] | None = own
    if isinstance(shape, GBuffer):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about colours of faces: said where they are shown
            mesh = shape.mesh
            try:
                found = None if mesh is None else _mesh_colors(mesh)
            except MeshdepictError:
                found = None
    if found is None:
        return None
    return np.asarray(color.srgb_to_linear(found / np.float32(255)), np.float32)


def _mesh_colors(mesh: Mesh) -> NDArray[np.uint8]:
    """Return the mesh's own colours at its vertices: theirs, else its textures', else its faces'.

    Those that a former bake set aside come first. In glTF a texture is multiplied by the vertices'.
    """
    from meshdepict.shapes.texture_colors import texture_colors

    baked = was_baked(mesh)
    found = vertex_colors(mesh, baked=baked, faces=False)
    tinted = found is not None and mesh.textures is not None and mesh.textures.tinted
    if found is None or tinted:
        try:
            painted = texture_colors(mesh)
        except MeshdepictError as error:
            raise MeshdepictError(f"albedo='keep' needs what can't be had: {error}") from error
        if painted is not None and found is not None:
            return color.multiply_albedo(painted / np.float32(255), found, linear=False)
        found = painted if found is None else found
    if found is None:
        found = vertex_colors(mesh, baked=baked)
    if found is None:
        lacks = str(getattr(mesh.document, "lacks", ""))
        lacks = f", and its file {lacks}" if lacks else ""
        raise MeshdepictError(
            "albedo='keep' needs the object's own vertex colours (red, green, blue) or a texture; "
            "the mesh has " + ("only those of a former bake" if baked else "none") + lacks
        )
    return found


def own_appearance(mesh: Mesh) -> Appearance | None:
    """Return how a mesh looks in its file; None where that has neither textures nor colours.

    Textures come first; what can't be had of them is as if it weren't there. A former bake's
    colours are not the file's own.
    """
    textures = mesh.textures
    if textures is not None and any(textures.base_colors):
        try:
            for texture in textures.base_colors:
                _ = None if texture is None else texture.pixels
        except MeshdepictError:
            pass
        else:
            tints = None
            if textures.tinted:
                tints = vertex_colors(mesh, baked=was_baked(mesh), faces=False)
            return Appearance(mesh, tints, textures)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "the mesh's own colours are at its faces")
            return Appearance(mesh, own_colors(mesh))
    except MeshdepictError:
        return None
