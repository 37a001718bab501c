"""Baking surfaces: meshes, and what images show of them."""

from __future__ import annotations

import copy
import functools
import os
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.baked import Baked
from meshdepict.baking.budget import within_budget
from meshdepict.baking.choice_list import LADDER, choice_fields
from meshdepict.baking.choices import Choices
from meshdepict.baking.chosen_normals import refuse_other_sides, sides_of, with_chosen_normals
from meshdepict.baking.clipping import warn_of_clipping
from meshdepict.baking.discs import warn_of_disc
from meshdepict.baking.layers import shade_layers
from meshdepict.baking.own_colors import own_colors, surface_tints
from meshdepict.baking.provenance import describe
from meshdepict.baking.sampling import Place, sampled
from meshdepict.baking.sheets import warn_of_backs
from meshdepict.baking.tinting import heights_of, tinted
from meshdepict.color import colormaps2d
from meshdepict.errors import MeshdepictError
from meshdepict.scales.ladder import Progress
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import Lighting, as_light
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.ground_plane import GroundPlane
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh

__all__ = [
    "as_mesh", "as_solid", "as_surface", "bake_surface", "refuse_other_scales", "with_choices",
]  # fmt: skip


def bake_surface(
    shape: object,
    look: Choices,
    *,
    place: Place | None = None,
    progress: Progress | None = None,
) -> Baked:
    """Shade a mesh or an image; see `bake`.

    Parameters
    ----------
    shape : path, Mesh, HeightField, GBuffer, ScaleSpace, pyvista.PolyData or trimesh.Trimesh
    look : Choices
        Its ground is nobody's business here; see `objects`.
    place : Place, optional
        Of a mesh among others.
    progress : callable, optional
        ``progress(done, total)``.
    """
    told: list[ScaleSpace] = []
    try:
        return _bake_surface(shape, look, place, progress, told)
    finally:
        for space in told:
            space.progress = None


def _bake_surface(
    shape: object,
    look: Choices,
    place: Place | None,
    progress: Progress | None,
    told: list[ScaleSpace],
) -> Baked:
    """Do what `bake_surface` does; ``told`` are those that know whom to tell how far they are."""
    begun = time.perf_counter()
    made = isinstance(shape, ScaleSpace)
    mesh = as_surface(shape.shape if made else shape)  # type: ignore[attr-defined]
    kind = mesh.kind
    look, allowed = within_budget(look, mesh, spent=time.perf_counter() - begun)
    chosen, look = look, look.of_kind(kind)
    scales, ratio = look.ladder
    if not made:
        mesh = with_choices(mesh, look)
    refuse_other_sides(mesh, look)
    several = "colormap2d" if look.colormap2d is not None else "blend" if look.blend else ""
    local = look.declared.local and not several and not isinstance(mesh, GBuffer)
    if look.refine is not None and not local:
        raise MeshdepictError(
            "refine is for meshes, one light and methods that shade each sample by itself: leave "
            f"it out with {several or look.method}"
        )
    look = look.replace(**sides_of(mesh))
    if isinstance(mesh, HeightField):
        if made and look.z_factor not in (1, mesh.z_factor):
            raise MeshdepictError(
                f"z_factor={look.z_factor:g} comes too late: the heights of this ScaleSpace are "
                f"{mesh.z_factor:g} times the ground's; leave it out, or bake the height field"
            )
        look = look.replace(z_factor=mesh.z_factor)
    own = tints = None
    if look.albedo == "keep":
        own = own_colors(mesh)
        tints = surface_tints(mesh, own)
    look = look.posed(mesh)
    eye = look.eye(mesh) if place is None else place.eye
    lamp = look.lighting(eye, kind)
    if isinstance(shape, ScaleSpace):
        refuse_other_scales(shape, chosen)

    def make(scales: int, ratio: float) -> ScaleSpace:
        if not isinstance(shape, ScaleSpace):
            space = sampled(mesh, look, eye, (scales, ratio), tints=tints, place=place)
        elif tints is None:
            space = shape
        else:
            space = copy.copy(shape)  # others go on using that one
            space.tints = tints
        space.progress = progress
        told.append(space)
        return space

    blend, found = None, None
    if look.blend is not None:
        seen = chosen.replace(view=look.view, up=look.up)
        blend = shade_layers(seen, kind, eye, make, progress=progress)
        space, look = blend.space, look.replace(blend=blend.look.blend)
    else:
        space = make(scales, ratio)
        space.smooth(look.reads(space.last).sets, progress=progress)
        asked = look.settled(space)
        look = asked.with_rays(space, lamp, eye)
        found = None if look is asked else space.light_errors.found
    if not made and blend is None:
        warn_of_disc(look, lamp)
    level = isinstance(mesh, GroundPlane)  # which many views see edge-on
    if not (made or look.two_sided or level):  # viewers turn what they show
        warn_of_backs(space.points, space.normals_at(0), eye)
    linear = look.declared.linear

    def shade(lamp: Lighting, space: ScaleSpace = space) -> NDArray[np.float32]:
        return look.shade(space, lamp, eye)

    each = functools.partial(shade, lamp)  # of samples of any scale space of the mesh
    if blend is not None:
        intensity, linear = blend.values, False
    elif look.refine is not None:
        from meshdepict.baking.refinement import refine as refined

        mesh, intensity = refined(space, each, linear=linear, levels=look.refine)
        own = own_colors(mesh) if look.albedo == "keep" else None
    elif look.colormap2d is None:
        intensity = shade(lamp)
        warn_of_clipping(look, lamp, intensity, lambda other: other.shade(space, lamp, eye))
    else:
        intensity = colormaps2d.both_lights(
            shade, as_light(lamp), eye, look.colormap2d, linear=linear
        )
        linear = False
    colors = color.encode(intensity, linear=linear, colormap=look.colormap)
    if look.tint is not None:
        points = mesh.vertices if look.refine is not None and isinstance(mesh, Mesh) else None
        heights = heights_of(space, look.axis(kind), points)
        if isinstance(mesh, HeightField):
            heights /= mesh.z_factor  # the ground's own
        look, tint = tinted(look, heights)
        colors = color.multiply_albedo(colors / np.float32(255), tint, linear=False)
    if own is not None:
        colors = color.multiply_albedo(colors / np.float32(255), own, linear=False)
    provenance = describe(look, space, light=lamp)
    if allowed is not None:
        provenance["budget"] = str(allowed)
    if found is not None:
        provenance["rays auto"] = str(found)
    if look.refine is not None and isinstance(mesh, Mesh):
        provenance["refined"] = f"to {look.refine:g} grey levels, {len(mesh.faces)} triangles"
    if blend is None:
        look = look.replace(light=lamp)
    else:  # what its layers declare, differently perhaps, stays theirs
        light = None if look.light is None else lamp
        look = look.replace(light=light, scales=chosen.scales, ratio=chosen.ratio)
    return Baked(
        mesh, intensity, colors, provenance, eye,
        space=None if look.refine is not None else space, shade=each if local else None,
        look=look,
    )  # fmt: skip


def as_surface(shape: object) -> Mesh | GBuffer | HeightField:
    """Return a surface to be shaded: an image as it is, all else as `as_solid` does."""
    return shape if isinstance(shape, GBuffer) else as_solid(shape)


def as_solid(shape: object, *, winding: str = "auto") -> Mesh | HeightField:
    """Return a surface that can be turned: a height field, or all else that has one as a mesh.

    Parameters
    ----------
    shape : path, Mesh, HeightField, or what PyVista, trimesh or xarray hold
    winding : {"auto", "keep"}
        How files of meshes are read.
    """
    if isinstance(shape, HeightField):
        return shape
    if isinstance(shape, (str, os.PathLike)):
        from meshdepict.io import read_mesh
        from meshdepict.io.source import begins_as_ply

        if begins_as_ply(shape):  # the usual case: no reader of anything else is loaded
            return read_mesh(shape, winding=winding)
        from meshdepict.io.heightfields import is_heightfield_path, read_heightfield

        if is_heightfield_path(shape):
            return read_heightfield(shape)
        _refuse_volume(shape)
        return read_mesh(shape, winding=winding)
    found = _terrain(shape)
    return as_mesh(shape) if found is None else found


def _terrain(shape: object) -> HeightField | None:
    """Return the terrain that a DataArray of xarray or an even grid of PyVista holds, if it is."""
    from meshdepict.io.data_arrays import from_data_array, is_data_array
    from meshdepict.shapes.height_grids import image_ground, is_layer, structured_ground
    from meshdepict.shapes.sheet import scalar_array

    if is_data_array(shape):
        return from_data_array(shape)
    if not is_layer(shape):
        return None
    image = hasattr(shape, "direction_matrix")
    grid: Any = shape
    found, _ = image_ground(grid, *scalar_array(grid)) if image else structured_ground(grid)
    return found if isinstance(found, HeightField) else None


def with_choices(shape: Mesh | GBuffer | HeightField, look: Choices) -> Any:
    """Return a surface with what a look chooses of it: its sides, or how high it stands."""
    if isinstance(shape, HeightField):
        return shape.raised(look.z_factor)
    return with_chosen_normals(shape, look) if isinstance(shape, Mesh) else shape


def as_mesh(shape: object) -> Mesh:
    """Return a `Mesh` from a path, a Mesh, or what PyVista or trimesh hold that has a surface."""
    from meshdepict.shapes.foreign import is_of_pyvista, is_of_trimesh

    if isinstance(shape, Mesh):
        return shape
    if isinstance(shape, (str, os.PathLike)):
        from meshdepict.io import read_mesh

        _refuse_volume(shape)
        return read_mesh(shape)
    if is_of_pyvista(shape):
        return Mesh.from_pyvista(shape)
    if is_of_trimesh(shape):
        return Mesh.from_trimesh(shape)
    raise MeshdepictError(
        f"a {type(shape).__name__} is not a shape: give a path, a Mesh, a pyvista.PolyData or a "
        "trimesh.Trimesh"
    )


def _refuse_volume(path: str | os.PathLike[str]) -> None:
    from meshdepict.io.volumes import is_volume_path

    if is_volume_path(path) and not os.path.isdir(path):
        raise MeshdepictError(
            f"{os.fspath(path)} is a volume, not a mesh: take bake_volume (meshdepict volume)"
        )


def refuse_other_scales(space: ScaleSpace, chosen: Choices) -> None:
    """Refuse to ask a finished scale space for what it wasn't made with."""
    for name in LADDER:
        if name in chosen.taken:
            continue  # nobody asked for it by name
        value = getattr(chosen, name)
        if value not in (choice_fields()[name].default, getattr(space, name, None)):
            raise MeshdepictError(
                f"{name}={value!r} comes too late: this ScaleSpace has been made; leave it out, or "
                "bake the mesh"
            )
