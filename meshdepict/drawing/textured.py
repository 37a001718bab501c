"""Drawing surfaces in textures, at their full resolution: bytes as they are, no lighting on top."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Iterator

    from meshdepict.drawing.painted import TexturedMesh
    from meshdepict.drawing.plotter import Plotter
    from meshdepict.shapes.appearance import Appearance, Primitive
    from meshdepict.shapes.data_set import PolyData

__all__ = ["add_appearance", "is_textured", "textured_polydata"]


_PLACE = "tcoordVCVSOutput"  # what VTK's shaders call texture coordinates


def is_textured(baked: object) -> TypeGuard[TexturedMesh]:
    """Whether a bake's colours lie in a texture, and not at vertices."""
    return hasattr(type(baked), "appearance")


def add_appearance(window: Plotter, appearance: Appearance, **looks: Any) -> list[Any]:
    """Add a mesh in its textures to a plotter; return the actors, one for each material.

    In diagonals of the mesh, about the origin. Colours of vertices multiply textures' bytes, which
    is nearly their product in linear light.

    Parameters
    ----------
    window : pyvista.Plotter
    appearance : Appearance
        With textures.
    **looks
        For ``add_mesh``.
    """
    actors = []
    for poly, texture in _parts(appearance):
        usual: dict[str, Any] = {"color": "white"}
        if "RGB" in poly.point_data:
            usual = {"scalars": "RGB", "rgb": True, "show_scalar_bar": False}
        usual |= {"lighting": False, "texture": texture}
        actor: Any = window.add_mesh(poly, **usual | looks)
        if not texture.mipmap:
            _stay_within(actor)
        actors.append(actor)
    return actors


def _stay_within(actor: Any) -> None:
    """Read the texture within triangles, where samples of a pixel beside its middle hit them.

    Beyond their edges lie other triangles' texels, and no mipmaps need even steps.
    """
    shaders = actor.GetShaderProperty()
    for way, replace in (
        ("out", shaders.AddVertexShaderReplacement),
        ("in", shaders.AddFragmentShaderReplacement),
    ):
        said = f"{way} vec2 {_PLACE};"
        replace(said, False, f"centroid {said}", False)  # noqa: FBT003, as VTK has it


def textured_polydata(appearance: Appearance) -> list[PolyData]:
    """Return what `add_appearance` adds, in world units."""
    found = []
    for primitive in appearance.primitives:
        places, _ = _wrapped(primitive)
        found.append(_polydata(appearance, primitive, appearance.mesh.vertices, places))
    return found


def _parts(appearance: Appearance) -> Iterator[tuple[PolyData, Any]]:
    import pyvista as pv

    mesh = appearance.mesh
    points = mesh.recentred(mesh.vertices)
    for primitive in appearance.primitives:
        places, pixels = _wrapped(primitive)
        texture = pv.Texture(pixels)
        texture.interpolate = True
        texture.mipmap = primitive.texture is not None and primitive.texture.mipmaps
        texture.SetMaximumAnisotropicFiltering(1)
        ways = texture.WrapType
        repeats = primitive.wrap != ("clamp", "clamp")
        texture.wrap = ways.REPEAT if repeats else ways.CLAMP_TO_EDGE
        yield _polydata(appearance, primitive, points, places), texture


def _polydata(
    appearance: Appearance,
    primitive: Primitive,
    points: NDArray[np.float64],
    places: NDArray[np.float64],
) -> PolyData:
    import pyvista as pv

    poly = pv.PolyData.from_regular_faces(points[primitive.vertices], primitive.faces)
    poly.active_texture_coordinates = places.astype(np.float32)
    if appearance.colors is not None:
        poly.point_data["RGB"] = appearance.colors[primitive.vertices]
    return poly


def _wrapped(primitive: Primitive) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Return places and pixels for VTK, which wraps pictures the same way along both sides."""
    places, pixels = primitive.texcoords.copy(), primitive.pixels
    for axis, how in enumerate(primitive.wrap):
        side = pixels.shape[1 - axis]
        if how == "mirror":  # twice the picture, the second half mirrored, repeats
            turned = np.flip(pixels, 1 - axis)
            parts = (pixels, turned) if axis == 0 else (turned, pixels)  # rows go down
            pixels, places[:, axis] = np.concatenate(parts, 1 - axis), places[:, axis] / 2
        elif how == "clamp" and primitive.wrap[1 - axis] != "clamp":
            # At vertices alone: between them it is as far beyond the edge as they were.
            places[:, axis] = np.clip(places[:, axis], 0.5 / side, 1 - 0.5 / side)
    return places, pixels
