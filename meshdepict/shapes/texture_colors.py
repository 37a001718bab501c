"""The colours that a mesh's textures have at its vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.shapes.document import as_bytes

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["texture_colors"]


def texture_colors(mesh: Mesh) -> NDArray[np.uint8] | None:
    """Return the base colours (n, 3) of a mesh's textures at its vertices; None without any.

    Times their factors. Where the corners that meet at a vertex lie at several places of textures,
    along a seam, the mean of the different ones in linear light. White where no face has a texture.

    Raises
    ------
    MeshdepictError
        For a picture that can't be had, or can't be read.
    """
    textures = mesh.textures
    if textures is None or not _colored(textures):
        return None
    face = np.repeat(np.arange(len(mesh.faces)), 3)
    vertex, material = mesh.faces.ravel(), textures.material[face]
    laid = np.flatnonzero(material >= 0)
    u, v = textures.texcoords.reshape(-1, 2).T
    keys = np.stack([vertex, material, u, v])[:, laid]
    order = np.lexsort(keys[::-1])
    keys = keys[:, order]
    fresh = np.ones(len(order), bool)
    fresh[1:] = (keys[:, 1:] != keys[:, :-1]).any(axis=0)
    corner = laid[order[fresh]]
    colors = srgb_to_linear(textures.colors(face[corner], np.eye(3)[corner % 3]))
    count = np.bincount(vertex[corner], minlength=len(mesh.vertices))
    sums = [np.bincount(vertex[corner], channel, len(mesh.vertices)) for channel in colors.T]
    mean = np.stack(sums, axis=1) / np.maximum(count, 1)[:, None]
    mean[count == 0] = 1
    return as_bytes(linear_to_srgb(np.clip(mean, 0, 1)).astype(np.float64))


def _colored(textures: Textures) -> bool:
    """Whether a triangle has a material with a picture, or with a colour other than white."""
    used = np.unique(textures.material[textures.material >= 0])
    return any(textures.base_colors[k] or (textures.factors[k, :3] != 1).any() for k in used)
