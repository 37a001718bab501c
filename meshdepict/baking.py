"""Baking: from a shape and a method's name to colours on the shape, in one line."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.errors import MeshdepictError
from meshdepict.options import check, nearest
from meshdepict.scales import ScaleSpace, scale_space
from meshdepict.scene import View, as_light, as_view

if TYPE_CHECKING:
    from meshdepict.mesh import Mesh

__all__ = ["Baked", "as_mesh", "bake", "find_method"]


class Baked:
    """Colours on a shape, and how they came about.

    Attributes
    ----------
    shape : Mesh
    colors : (n, 3) array of uint8
        sRGB.
    intensity : (n,) or (n, 3) array of float
        What the method returned, in [0, 1], before colour map and encoding.
    provenance : dict of str
        Version, method, options, light, view, widths and the mesh's digest.
    view : View
        The view that names of lights referred to, and that pictures show.
    """

    def __init__(
        self,
        shape: Mesh,
        intensity: NDArray[Any],
        colors: NDArray[np.uint8],
        provenance: Mapping[str, str],
        view: View,
    ) -> None:
        self.shape = shape
        self.intensity = intensity
        self.colors = colors
        self.provenance = dict(provenance)
        self.view = view

    def __repr__(self) -> str:
        """Return method and size."""
        return f"<Baked: {self.provenance['method']} on {len(self.colors):,} samples>"

    @property
    def comments(self) -> list[str]:
        """The provenance as lines for a file's header."""
        rest = [f"meshdepict {key}: {text}" for key, text in self.provenance.items()]
        return rest

    def save(self, path: str | Path) -> Path:
        """Write the shape with its colours; the suffix decides the format.

        Everything the input file had is kept. An existing file is replaced, once the new one
        is complete.

        Raises
        ------
        MeshdepictError
            For a format that holds no colours, or where the file cannot be written.
        """
        from meshdepict.io import write_mesh

        write_mesh(path, self.shape, colors=self.colors, comments=self.comments)
        return Path(path)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.PolyData`` with point arrays "RGB" and "depict_<method>"."""
        import pyvista as pv

        mesh = self.shape
        if mesh.polygons is None:
            poly = pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces)
        else:
            connectivity, offsets = mesh.polygons
            poly = pv.PolyData(mesh.vertices)
            poly.SetVerts(None)
            poly.SetPolys(pv.CellArray.from_arrays(offsets, connectivity))
        poly.point_data[f"depict_{self.provenance['method']}"] = self.intensity
        poly.point_data["RGB"] = self.colors
        return poly

    def to_trimesh(self) -> Any:
        """Return a ``trimesh.Trimesh`` with vertex colours, vertices in the same order."""
        import trimesh

        return trimesh.Trimesh(
            self.shape.vertices, self.shape.faces, vertex_colors=self.colors, process=False
        )

    def show(self, **plotter: Any) -> Any:
        """Open a PyVista window with the colours as they are, in this bake's view.

        Keyword arguments go to ``pyvista.Plotter``.
        """
        from meshdepict.viewer.picture import plot

        return plot(self, **plotter).show()

    def picture(self, path: str | Path, *, size: tuple[int, int] = (1000, 1000)) -> Path:
        """Render a PNG of this bake in its view, without needing a display."""
        from meshdepict.viewer.picture import save_picture

        return save_picture(self, path, size=size)


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
    albedo: str = "none",
    progress: Callable[[float, float], None] | None = None,
    **options: Any,
) -> Baked:
    """Shade a shape by a method and turn the result into colours.

    Parameters
    ----------
    shape : path, Mesh, ScaleSpace, pyvista.PolyData or trimesh.Trimesh
        A `ScaleSpace` is used as it is: several bakes can share one.
    method : str
        A name of `shading.METHODS`.
    light : str, (3,) array_like, (azimuth, elevation) or Light
        Names and angles refer to the view.
    view : str or View
        "front", "top", …; fitted to the shape.
    up : {"y", "z"}
        Which axis of the shape points up.
    scales, width, ratio, facing, tolerance
        See `scale_space`; None takes what the method declares.
    colormap : str, optional
        Name of a 1D colour map of the result; grey unless given.
    albedo : {"none", "keep"}
        "keep" multiplies the shape's own vertex colours, in linear light.
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
    from meshdepict.shading import declaration

    function = find_method(method)
    declared = declaration(function)
    options = check(function, options, method)
    if colormap is not None:
        color.colormap(colormap)
    if albedo not in ("none", "keep"):
        raise MeshdepictError(f"albedo={albedo!r} is neither 'keep' nor 'none'")
    mesh = shape.shape if isinstance(shape, ScaleSpace) else as_mesh(shape)
    own = _own_colors(mesh) if albedo == "keep" else None
    eye = as_view(view, mesh, up=up)
    lamp = as_light(light, eye)
    if isinstance(shape, ScaleSpace):
        space = shape
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
    intensity = function(space, lamp, **options)
    colors = color.encode(intensity, linear=declared.linear, colormap=colormap)
    if own is not None:
        colors = color.multiply_albedo(colors / np.float32(255), own, linear=False)
    provenance = {
        "version": _version(),
        "method": method,
        "options": _options_text(function, options),
        "scales": _scales_text(space, facing, tolerance),
        "light": str(lamp),
        "view": f"{eye.name or 'given'}, up {up}",
        "colormap": colormap or "gray",
        "albedo": albedo,
        "mesh": f"{len(mesh.vertices)} vertices {len(mesh.faces)} triangles sha256 {digest(mesh)}",
    }
    return Baked(mesh, intensity, colors, provenance, eye)


def find_method(name: str) -> Callable[..., Any]:
    """Return the shading function of a name; raise `MeshdepictError` naming the nearest."""
    from meshdepict.shading import METHODS

    if name not in METHODS:
        raise MeshdepictError(
            f"no method is called {name!r}{nearest(name, METHODS)} (there are {', '.join(METHODS)})"
        )
    return METHODS[name]


def as_mesh(shape: Any) -> Mesh:
    """Return a `Mesh` from a path, a Mesh, a PyVista ``PolyData`` or a ``trimesh.Trimesh``."""
    from meshdepict.mesh import Mesh

    if isinstance(shape, Mesh):
        return shape
    if isinstance(shape, (str, Path)):
        from meshdepict.io import read_mesh

        return read_mesh(shape)
    if hasattr(shape, "GetPolys"):
        return Mesh.from_pyvista(shape)
    if hasattr(shape, "vertices") and hasattr(shape, "faces"):
        return Mesh.from_trimesh(shape)
    raise MeshdepictError(
        f"a {type(shape).__name__} is not a shape: give a path, a Mesh, a pyvista.PolyData or a "
        "trimesh.Trimesh"
    )


def digest(mesh: Mesh) -> str:
    """Return the first 16 digits of the SHA-256 of vertices and triangles."""
    sha = hashlib.sha256(np.ascontiguousarray(mesh.vertices))
    sha.update(np.ascontiguousarray(mesh.faces))
    return sha.hexdigest()[:16]


def _own_colors(mesh: Mesh) -> NDArray[np.uint8]:
    """Return the mesh's own vertex colours; those a former bake set aside come first."""
    from meshdepict.io.document import Document, as_bytes

    vertex = mesh.attributes["vertex"]
    baked = isinstance(mesh.document, Document) and bool(mesh.document.provenance)
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


def _version() -> str:
    from meshdepict import __version__

    return str(__version__)


def _options_text(function: Callable[..., Any], given: Mapping[str, Any]) -> str:
    from meshdepict.options import options_of

    known = options_of(function)
    return " ".join(f"{name}={_short(given.get(name, o.default))}" for name, o in known.items())


def _short(value: Any) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _scales_text(space: ScaleSpace, facing: int, tolerance: float) -> str:
    count = len(space.widths) - 1
    if count == 0:
        return "0"
    return (
        f"{count}, widths {space.widths[1]:.6g} to {space.widths[-1]:.6g}, ratio {space.ratio:.6g}, "
        f"facing {facing}, tolerance {tolerance:g}"
    )
