"""Baking: from a shape and a method's name to colours on the shape, in one line."""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.baked import Baked
from meshdepict.baking.provenance import describe, was_baked
from meshdepict.color import colormaps2d as color2d
from meshdepict.errors import MeshdepictError
from meshdepict.options import check, options_of
from meshdepict.scales.making import scale_space
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import as_light, as_lighting, as_view
from meshdepict.scene.view import View

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Baked", "as_mesh", "bake", "own_colors", "refuse_other_scales"]


def bake(
    shape: Any,
    method: str = "exaggerated",
    *,
    light: Any = "northwest",
    view: str | View = "front",
    up: str = "y",
    scales: int | None = None,
    width: float | str | None = None,
    ratio: float | None = None,
    facing: int = 1,
    tolerance: float = 1e-4,
    colormap: str | None = None,
    colormap2d: str | None = None,
    albedo: str = "none",
    refine: float | None = None,
    progress: Callable[[float, float], None] | None = None,
    **options: Any,
) -> Baked:
    """Shade a shape by a method and turn the result into colours.

    Parameters
    ----------
    shape : path, Mesh, GBuffer, ScaleSpace, pyvista.PolyData or trimesh.Trimesh
        A `ScaleSpace` is used as it is: several bakes can share one. What it was made with can't
        be asked for again.
    method : str
        A name of `shading.METHODS`.
    light : str, (3,) array_like, (azimuth, elevation) or Light
        For some methods also a sequence of these, or an Environment or its file (.hdr).
        Names and angles refer to the view.
    view : str or View
        "front", "top", …; fitted to the shape.
    up : {"y", "z", "-y", "-z"}
        Which axis of the shape points up.
    scales, width, ratio, facing, tolerance
        See `scale_space`; None takes what the method declares.
    colormap : str, optional
        Name of a 1D colour map of the result; grey unless given.
    colormap2d : {"dusk", "earth", "swiss"}, optional
        A map of two results: under the light, and under the light turned by 90° clockwise as the
        view sees it (northwest and northeast).
    albedo : {"none", "keep"}
        "keep" multiplies the shape's own vertex colours, in linear light.
    refine : float, optional
        Split the triangles inside which interpolated colours are off by more than so many of 255
        grey levels, until they are not (five times at most); see `Baked.edge_error`. New vertices
        come after the old ones.
    progress : callable, optional
        ``progress(done, total)``.
    **options
        The method's own options.

    Returns
    -------
    Baked

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range.
    """
    from meshdepict.shading.method import declaration
    from meshdepict.shading.registry import find_method

    function = find_method(method)
    declared = declaration(function)
    options = check(function, options, method)
    is_image = _kind(shape) == "image"
    if is_image and "curvature" in options_of(function):
        options = {"curvature": "view"} | options  # as its paper has it; see `features`
    if colormap is not None:
        color.colormap(colormap)
        if colormap2d is not None:
            raise MeshdepictError("colormap and colormap2d exclude each other: give one of them")
    if colormap2d is not None:
        color2d.colormap2d(colormap2d)
    if albedo not in ("none", "keep"):
        raise MeshdepictError(f"albedo={albedo!r} is neither 'keep' nor 'none'")
    if isinstance(shape, ScaleSpace):
        mesh: Any = shape.shape
    else:
        mesh = shape if is_image else as_mesh(shape)
    own = own_colors(mesh) if albedo == "keep" else None
    eye = as_view(view, mesh, up=up)
    lamp = as_lighting(light, eye, up=up) if colormap2d is None else as_light(light, eye)
    if isinstance(shape, ScaleSpace):
        space = shape
        asked = {"scales": scales, "width": width, "ratio": ratio}
        refuse_other_scales(space, asked | {"facing": facing, "tolerance": tolerance})
    else:
        space = scale_space(
            mesh,
            scales=declared.scales if scales is None or declared.scales == 0 else scales,
            width=width,
            ratio=declared.ratio if ratio is None else ratio,
            facing=facing,
            tolerance=tolerance,
            progress=progress,
        )
    needed = {"view": eye} if "view" in inspect.signature(function).parameters else {}

    def shade(lamp: Any, space: ScaleSpace = space) -> NDArray[np.float32]:
        return function(space, lamp, **needed, **options)

    linear = declared.linear
    local = declared.local and colormap2d is None and mesh.kind == "mesh"
    each = functools.partial(shade, lamp)  # of samples of any scale space of the mesh
    if refine is not None:
        if not local:
            raise MeshdepictError(
                "refine is for meshes, one light and methods that shade each sample by itself: "
                f"leave it out with {method if colormap2d is None else 'colormap2d'}"
            )
        from meshdepict.baking.refinement import refine as refined

        mesh, intensity = refined(space, each, linear=linear, levels=refine)
        own = own_colors(mesh) if albedo == "keep" else None
    elif colormap2d is None:
        intensity = shade(lamp)
    else:
        intensity = color2d.both_lights(shade, lamp, eye, colormap2d, linear=linear)
        linear = False
    colors = color.encode(intensity, linear=linear, colormap=colormap)
    if own is not None:
        colors = color.multiply_albedo(colors / np.float32(255), own, linear=False)
    provenance = describe(
        function,
        space,
        options=options,
        light=lamp,
        view=view,
        up=up,
        colormap=colormap or colormap2d,
        albedo=albedo,
    )
    if refine is not None:
        provenance["refined"] = f"to {refine:g} grey levels, {len(mesh.faces)} triangles"
    return Baked(
        mesh, intensity, colors, provenance, eye,
        space=None if refine is not None else space, shade=each if local else None,
        settings={
            "method": method, "light": lamp, "up": up, "colormap": colormap,
            "colormap2d": colormap2d, "albedo": albedo, **options,
        },
    )  # fmt: skip


def _kind(shape: Any) -> str | None:
    """Return what kind of shape it is, or was sampled; None of what is yet to become one."""
    return getattr(shape.shape if isinstance(shape, ScaleSpace) else shape, "kind", None)


def as_mesh(shape: Any) -> Mesh:
    """Return a `Mesh` from a path, a Mesh, a PyVista ``PolyData`` or a ``trimesh.Trimesh``."""
    from meshdepict.shapes.mesh import Mesh

    if isinstance(shape, Mesh):
        return shape
    if isinstance(shape, (str, os.PathLike)):
        from meshdepict.io import read_mesh
        from meshdepict.io.volumes import is_volume_path

        if is_volume_path(shape) and not os.path.isdir(shape):
            raise MeshdepictError(
                f"{os.fspath(shape)} is a volume, not a mesh: take bake_volume (meshdepict volume)"
            )
        return read_mesh(shape)
    if hasattr(shape, "GetPolys") and hasattr(shape, "point_data"):
        return Mesh.from_pyvista(shape)
    if hasattr(shape, "faces") and hasattr(shape, "visual"):
        return Mesh.from_trimesh(shape)
    raise MeshdepictError(
        f"a {type(shape).__name__} is not a shape: give a path, a Mesh, a pyvista.PolyData or a "
        "trimesh.Trimesh"
    )


def own_colors(mesh: Mesh) -> NDArray[np.uint8]:
    """Return the mesh's own vertex colours; those a former bake set aside come first."""
    from meshdepict.shapes.document import as_bytes

    vertex, baked = mesh.attributes["vertex"], was_baked(mesh)
    candidates = [("original_red", "original_green", "original_blue")]
    if not baked:  # else red, green and blue are the former bake's
        candidates.append(("red", "green", "blue"))
    for names in candidates:
        if all(name in vertex for name in names):
            return as_bytes(np.stack([vertex[name] for name in names], axis=1))
    raise MeshdepictError(
        "albedo='keep' needs the object's own vertex colours (red, green, blue); the mesh has "
        + ("only those of a former bake" if baked else "none")
    )


def refuse_other_scales(space: ScaleSpace, asked: Mapping[str, Any]) -> None:
    """Refuse to ask a finished scale space for what it wasn't made with."""
    parameters = inspect.signature(bake).parameters
    for name, value in asked.items():
        if value not in (parameters[name].default, getattr(space, name, None)):
            raise MeshdepictError(
                f"{name}={value!r} comes too late: this ScaleSpace has been made; leave it out, or "
                "bake the mesh"
            )
