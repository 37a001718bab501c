"""What a viewer shows and lets people change: a shape, a method, its options, a light and a view.

Knows neither windows nor pages; both change a `Session` and show its colours.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking import Baked, as_mesh, bake, find_method
from meshdepict.options import check, options_of
from meshdepict.scales import ScaleSpace, scale_space
from meshdepict.scene import View, as_lighting, as_view

if TYPE_CHECKING:
    from meshdepict.shading import Declaration

__all__ = ["Session"]


class Session:
    """A shape under a light, shaded by a method that can be changed.

    Parameters
    ----------
    shape : path, Mesh, pyvista.PolyData or trimesh.Trimesh
    method, light, view, up, scales, width, ratio, facing, tolerance, colormap, **options
        As for `bake`.
    progress : callable, optional
        ``progress(done, total)``, whenever a scale space is made.

    Attributes
    ----------
    shape : Mesh
    method : str
    light : Light, several or an Environment
    view : View
    colormap : str or None

    Raises
    ------
    MeshdepictError
        As `bake`.
    """

    def __init__(
        self,
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
        progress: Callable[[float, float], None] | None = None,
        **options: Any,
    ) -> None:
        self.shape = as_mesh(shape)
        self.up = up
        self.view = as_view(view, self.shape, up=up)
        self.light = as_lighting(light, self.view, up=up)
        self.progress = progress
        self._asked: dict[str, Any] = {"scales": scales, "ratio": ratio}
        self._smoothing: dict[str, Any] = {
            "width": width, "facing": facing, "tolerance": tolerance,
        }  # fmt: skip
        self._spaces: dict[tuple[int, float], ScaleSpace] = {}
        self._options: dict[str, dict[str, Any]] = {}
        self._baked: Baked | None = None
        self.method = method
        self.colormap: str | None = None
        self.use(method)
        self.set(**options)
        self.paint(colormap)
        self._first = self.light, self.view, method, dict(self.options), self.colormap

    # --- what can be changed ----------------------------------------------------------------

    def use(self, method: str) -> None:
        """Shade by another method; each keeps its own options."""
        find_method(method)
        self.method = method
        self._options.setdefault(method, {})
        self._baked = None

    def set(self, **options: Any) -> None:
        """Change options of the method; None puts one back to its default."""
        function = find_method(self.method)
        known = options_of(function)
        wanted = {
            name: known[name].default if value is None and name in known else value
            for name, value in options.items()
        }
        self.options.update(check(function, wanted, self.method))
        self._baked = None

    def shine(self, light: Any) -> None:
        """Change the light: anything that `bake` takes."""
        self.light = as_lighting(light, self.view, up=self.up)
        self._baked = None

    def look(self, view: str | View) -> None:
        """Look from elsewhere; the light stays where it is in the world."""
        self.view = as_view(view, self.shape, up=self.up)
        if self.follows_view:
            self._baked = None

    def paint(self, colormap: str | None) -> None:
        """Change the colour map of gray results; None is gray."""
        if colormap is not None:
            color.colormap(colormap)
        self.colormap = colormap
        self._baked = None

    def reset(self) -> None:
        """Go back to what the session began with."""
        self.light, self.view, method, options, colormap = self._first
        self._options.clear()
        self.use(method)
        self.options.update(options)
        self.paint(colormap)

    # --- what is shown ----------------------------------------------------------------------

    @property
    def options(self) -> dict[str, Any]:
        """Options of the method that were set."""
        return self._options[self.method]

    @property
    def declared(self) -> Declaration:
        """What the method declares."""
        from meshdepict.shading import declaration

        return declaration(find_method(self.method))

    @property
    def follows_view(self) -> bool:
        """Whether another view gives other colours."""
        return "view" in inspect.signature(find_method(self.method)).parameters

    @property
    def space(self) -> ScaleSpace:
        """The scale space of the method; made once for all methods with the same scales."""
        declared = self.declared
        ratio = self._asked["ratio"] or declared.ratio
        if declared.scales == 0:
            if not self._spaces:
                self._spaces[0, ratio] = scale_space(self.shape, scales=0)
            return next(iter(self._spaces.values()))  # any: it uses the shape's own normals alone
        scales = self._asked["scales"]
        scales = declared.scales if scales is None else scales
        if (scales, ratio) not in self._spaces:
            self._spaces[scales, ratio] = scale_space(
                self.shape, scales=scales, ratio=ratio, progress=self.progress, **self._smoothing
            )
        return self._spaces[scales, ratio]

    def baked(self) -> Baked:
        """Return the bake of what is chosen; made once for each choice."""
        if self._baked is None:
            found = bake(
                self.space, self.method, light=self.light, view=self.view, up=self.up,
                **self.options,
            )  # fmt: skip
            if self.colormap is not None and found.intensity.ndim == 1:  # colours stay as they are
                found.colors = color.encode(
                    found.intensity, linear=self.declared.linear, colormap=self.colormap
                )
                found.provenance["colormap"] = self.colormap
            self._baked = found
        return self._baked

    def settings(self) -> dict[str, Any]:
        """Return what a recipe of this look holds; see `recipe.save_recipe`."""
        return {
            "method": self.method, "light": self.light, "view": self.view.name or self.view,
            "up": self.up, **self._asked, **self._smoothing, "colormap": self.colormap,
            **self.options,
        }  # fmt: skip

    @property
    def colors(self) -> NDArray[np.uint8]:
        """(n, 3) sRGB colours."""
        return self.baked().colors
