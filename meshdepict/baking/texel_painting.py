"""What colours a texture's texels: a method's shading, the mesh's own colours, or normals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.choice_list import MESH
from meshdepict.baking.own_colors import own_colors
from meshdepict.baking.provenance import was_baked
from meshdepict.baking.sample_shading import SampleShading
from meshdepict.baking.texel_sampling import Ladder, Places
from meshdepict.baking.tinting import heights_of
from meshdepict.errors import MeshdepictError
from meshdepict.scales.mapped_normals import TangentFrames
from meshdepict.shapes.colors import vertex_colors

if TYPE_CHECKING:
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["normal_painter", "own_texel_colors", "shading_painter"]

Bytes = NDArray[np.uint8]


def own_texel_colors(mesh: Mesh, textures: Textures | None) -> Callable[[Places], NDArray[Any]]:
    """Return what gives the mesh's own colours at places: its textures', else its vertices'."""
    laid = textures if textures is not None and any(textures.base_colors) else None
    linear = None
    if laid is None:
        linear = color.srgb_to_linear(own_colors(mesh) / np.float32(255))
    else:
        for texture in laid.base_colors:
            try:
                _ = None if texture is None else texture.pixels
            except MeshdepictError as error:  # before any work is done
                raise MeshdepictError(f"albedo='keep' needs what can't be had: {error}") from error
        found = vertex_colors(mesh, baked=was_baked(mesh), faces=False)
        if laid.tinted and found is not None:
            linear = color.srgb_to_linear(found / np.float32(255))

    def colors(places: Places) -> NDArray[Any]:
        found: NDArray[Any] = np.ones(1, np.float32)
        if linear is not None:
            at = linear[mesh.faces[places.shaded_triangle]]
            found = np.einsum("nc,ncx->nx", places.shaded_weights, at)
        if laid is not None:
            painted = laid.colors(places.shaded_triangle, places.shaded_weights)
            found = found * color.srgb_to_linear(painted)
        return np.asarray(color.linear_to_srgb(found))

    return colors


def shading_painter(
    shading: SampleShading,
    whole: Mapping[Ladder, ScaleSpace],
    albedo: Callable[[Places], NDArray[Any]] | None,
) -> Callable[[Places, Mapping[Ladder, ScaleSpace]], Bytes]:
    """Return what shades texels."""
    look = shading.look
    looks = [look] if shading.layered is None else shading.layered.looks
    # What looks at the samples around, and casts no rays, is shaded at the vertices.
    alone = all(each.declared.local or "rays" in each.declared.needs for each in looks)
    at_vertices = None if alone else shading.values(whole)

    def paint(places: Places, spaces: Mapping[Ladder, ScaleSpace]) -> Bytes:
        space = next(iter(spaces.values()))
        if at_vertices is None:
            values = shading.values(spaces)
        else:
            values = np.clip(space.of_vertices(at_vertices), 0, 1).astype(np.float32)
        colors = shading.colors(values, lambda: heights_of(space, look.axis(MESH)))
        if albedo is not None:
            colors = color.multiply_albedo(
                colors / np.float32(255), np.clip(albedo(places), 0, 1), linear=False
            )
        return colors

    return paint


def normal_painter(
    frames: TangentFrames,
) -> Callable[[Places, Mapping[Ladder, ScaleSpace]], Bytes]:
    """Return what writes the coarsest normals into a tangent-space map."""

    def paint(places: Places, spaces: Mapping[Ladder, ScaleSpace]) -> Bytes:
        space = next(iter(spaces.values()))
        wanted = space.normals_at(space.last).astype(np.float64)
        basis = np.stack(frames.at(places.triangle, places.weights), axis=2)
        # So that a viewer's x T + y B + z N, not made unit before, points there.
        firm = np.abs(np.linalg.det(basis)) > 1e-9
        basis[~firm] = np.eye(3)
        local = np.linalg.solve(basis, wanted[..., None])[..., 0]
        local[~firm] = (0, 0, 1)
        local /= np.maximum(np.linalg.norm(local, axis=1, keepdims=True), 1e-12)
        return np.rint(255 * np.clip(local / 2 + 0.5, 0, 1)).astype(np.uint8)

    return paint
