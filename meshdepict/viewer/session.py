"""What a viewer shows and lets people change: a shape, a method, its options, a light and a view.

Knows neither windows nor pages; both change a `Session` and show its colours.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict import color
from meshdepict.baking.baked import Baked
from meshdepict.baking.choice_list import choice_fields
from meshdepict.baking.choices import Choices
from meshdepict.baking.look import Look, bake
from meshdepict.baking.pixel_widths import measured
from meshdepict.baking.surfaces import as_solid, with_choices
from meshdepict.drawing.framing import is_fitted
from meshdepict.errors import MeshdepictError
from meshdepict.options import check, options_of
from meshdepict.scales.making import scale_space
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightsLike, as_lighting, as_view, has_environment
from meshdepict.scene.rig import Rig
from meshdepict.scene.view import View
from meshdepict.shading.registry import METHODS, find_method
from meshdepict.shading.sampled import AUTO_RAYS
from meshdepict.shapes.height_field import HeightField
from meshdepict.viewer.controls import HEIGHTS, Control, controls, place_option
from meshdepict.viewer.light_drag import carried, dragged

if TYPE_CHECKING:
    from meshdepict.shading.method import Declaration
    from meshdepict.shapes.mesh import Mesh

__all__ = ["UNSHOWN", "Session", "refuse_unshown"]

_SMOOTHING = "smoothing normals"


class Session:
    """A shape under a light, shaded by a method that can be changed.

    Parameters
    ----------
    shape : path, Mesh, HeightField, pyvista.PolyData or trimesh.Trimesh
    method, **chosen
        As for `Look`, but for what no session shows (`UNSHOWN`).
    progress : callable, optional
        ``progress(done, total)``, whenever a scale space is made.

    Attributes
    ----------
    shape : Mesh or HeightField
        Of terrain the heights that are shown, times its z factor.
    method : str
    function : callable
        That the method's name stands for.
    light : Light, several or an Environment
    view : View
    colormap : str or None
    light_fixed_to : {"object", "eye"}
        Whether the light stays where it is when the view changes, or goes with the eye.
    doing : str
        What progress is told of.

    Raises
    ------
    MeshdepictError
        As `bake`.
    """

    def __init__(
        self,
        shape: object,
        method: str | Callable[..., Any] = "exaggerated",
        *,
        progress: Callable[[float, float], None] | None = None,
        **chosen: Any,
    ) -> None:
        look = Look(method, **chosen)
        solid = as_solid(shape)
        look.of_kind(solid.kind)  # refuses what is about other kinds
        self.shape: Mesh | HeightField = with_choices(solid, look)
        _ = self.surface  # what has none can't be shown
        self._begin(look, progress)
        self._first = self.look_now()

    def _begin(self, look: Look, progress: Callable[[float, float], None] | None) -> None:
        """Choose what a look says."""
        refuse_unshown(look)
        look.of_kind(self.shape.kind)  # refuses what is about other kinds
        self._asked = look = measured(look.posed(self.shape), self.shape)
        self.up = look.axis(self.shape.kind)
        self.view = look.eye(self.shape)
        self._lit_from = self.view if look.light is None else None
        self.light = look.lighting(self.view, self.shape.kind)
        self.progress, self.doing = progress, _SMOOTHING
        self._spaces: dict[tuple[int, float], ScaleSpace] = {}
        self._options: dict[str, dict[str, Any]] = {}
        self._follows: dict[str, Any] = {}  # options of the method that follow the kind of shape
        self._baked: Any = None  # a Baked; of volumes a BakedVolume
        self._rays: int | None = None  # that "auto" came to
        self.colormap: str | None = None
        self.light_fixed_to = "object"
        self.use(look.function)
        self.set(**look.options)
        self.paint(look.colormap)

    # --- what can be changed ----------------------------------------------------------------

    def use(self, method: str | Callable[..., Any]) -> None:
        """Shade by another method; each keeps its own options, and its light until one is given."""
        self.function = find_method(method)
        self.method = self.function.__name__
        self._options.setdefault(self.method, {})
        same = Look(self.function, accuracy=self._asked.accuracy)
        self._follows = dict(same.of_kind(self.shape.kind).options)
        if self._lit_from is not None:
            asked = self._asked.replace(method=self.function, light=None)
            self.light = asked.lighting(self._lit_from, self.shape.kind)
        elif isinstance(self.light, Rig) and self.declared.lights == "one":
            self.light = self.light.lamps[0]
        self._baked = self._rays = None

    def set(self, **options: Any) -> None:
        """Change options of the method, or terrain's z_factor; None puts one back to its default.

        Raises
        ------
        MeshdepictError
            For anything unknown or out of range.
        """
        known = options_of(self.function)
        if HEIGHTS.name in options and HEIGHTS.name not in known:
            factor = options.pop(HEIGHTS.name)
            self.raise_heights(HEIGHTS.default if factor is None else factor)
        wanted = {
            name: known[name].default if value is None and name in known else value
            for name, value in options.items()
        }
        self.options.update(check(self.function, wanted, self.method))
        self._baked = self._rays = None

    def raise_heights(self, z_factor: float) -> None:
        """Let terrain stand so many times as high as its ground; the eye stays before its place.

        Raises
        ------
        MeshdepictError
            Of a mesh, and for a factor that is no positive number.
        """
        before = self.shape
        if not isinstance(before, HeightField):
            raise MeshdepictError(f"z_factor is about a height field, and this is a {before.kind}")
        after = (before.before or before).raised(z_factor)
        if after.z_factor == before.z_factor:
            return
        if is_fitted(self.view, before):
            self.view = as_view(self.view.name, after, up=self.up)
        else:
            rise = self.view.focus[2] * (after.z_factor / before.z_factor - 1)
            step = np.array([0, 0, rise])
            self.view = replace(
                self.view, position=self.view.position + step, focus=self.view.focus + step
            )
        self.shape = after
        self._asked = self._asked.replace(z_factor=after.z_factor)
        self._spaces.clear()
        self._baked = None

    def attend(self, point: ArrayLike | None) -> str:
        """Draw attention to a point (3,) of the shape, in world units, or to none any more.

        Returns
        -------
        str
            The option of the method that has changed.

        Raises
        ------
        MeshdepictError
            Where the method has none that is a place, and for what is no point.
        """
        name = place_option(self.function)
        if name is None:
            having = [each for each in METHODS if place_option(each)]
            raise MeshdepictError(
                f"{self.method} draws no attention to a point (these do: {', '.join(having)})"
            )
        self.set(**{name: None if point is None else tuple(np.asarray(point).tolist())})
        return name

    def shine(self, light: LightsLike) -> None:
        """Change the light: anything that `bake` takes."""
        self.light = as_lighting(light, self.view, up=self.up, sampling=self._asked.sampling)
        self._lit_from = None
        self._baked = None
        if has_environment(self.light):
            self._rays = None

    def drag_light(self, drag: ArrayLike) -> None:
        """Turn the light by a drag to the right and up, in heights of the picture.

        Raises
        ------
        MeshdepictError
            Where the light is a panorama.
        """
        self.light, self._lit_from = dragged(self.light, self.view, drag), None
        self._baked = None

    def fix_light(self, to: str) -> None:
        """Fix the light to the "object", or to the "eye" that then carries it along."""
        if not isinstance(to, str) or to not in ("object", "eye"):
            raise MeshdepictError(f"a light is fixed to the 'object' or to the 'eye', not {to!r}")
        self.light_fixed_to = to

    def look(self, view: str | View) -> None:
        """Look from elsewhere; the light stays with the object, or goes with the eye."""
        before, self.view = self.view, as_view(view, self.shape, up=self.up)
        if self.light_fixed_to == "eye":
            light, self.light = self.light, carried(self.light, before, self.view)
            if self._lit_from is not None:
                self._lit_from = self.view
            if self.light is not light:
                self._baked = None
        if self.follows_view:
            self._baked = None
        if self._baked is not None:  # the same colours, seen from elsewhere
            self._baked.view = self.view
            self._baked.provenance["view"] = str(self.view)

    def paint(self, colormap: str | None) -> None:
        """Change the colour map of gray results; None is gray."""
        if colormap is not None:
            color.colormap(colormap)
        self.colormap = colormap
        self._baked = None

    def reset(self) -> None:
        """Go back to what the session began with."""
        self.light_fixed_to = "object"
        self._options.clear()
        self.go_back(self._first)
        self._lit_from = self.view if self._asked.light is None else None

    def look_now(self) -> Look:
        """Return what is chosen, for `go_back`, recipes and bakes."""
        now = self._asked.replace(
            method=self.function, light=self.light, view=self.view, up=self.up
        )
        words = {name: value for name, value in now.words().items() if name not in now.options}
        return Look(self.function, **{**words, "colormap": self.colormap, **self.options})

    def go_back(self, look: Look) -> None:
        """Choose again what `look_now` returned."""
        if isinstance(self.shape, HeightField):
            self.raise_heights(look.z_factor)
        self.use(look.function)
        self.view = as_view(look.view, self.shape, up=self.up)
        self.light = look.lighting(self.view, self.shape.kind)
        self.options.clear()
        self.options.update(look.options)
        self._rays = None
        self.paint(look.colormap)

    def adopt(self, space: ScaleSpace, baked: Baked) -> None:
        """Take over a scale space of the shape, and its bake, which stays as it is."""
        if isinstance(space.shape, HeightField):
            self.shape = space.shape
        self._spaces[len(space.widths) - 1, space.ratio] = space
        self._baked = Baked(
            baked.shape,
            baked.intensity,
            baked.colors,
            baked.provenance,
            baked.view,
            look=baked.look,
        )

    # --- what is shown ----------------------------------------------------------------------

    @property
    def options(self) -> dict[str, Any]:
        """Options of the method that were set."""
        return self._options[self.method]

    @property
    def surface(self) -> Mesh:
        """The shape, or of terrain its ground, as a mesh."""
        return self.shape.mesh if isinstance(self.shape, HeightField) else self.shape

    @property
    def z_factor(self) -> float:
        """Times what terrain is as high as its ground; 1 of a mesh."""
        return self.shape.z_factor if isinstance(self.shape, HeightField) else 1.0

    @property
    def controls(self) -> list[Control]:
        """What a person can set: how high terrain stands, and the options of the method."""
        own = [HEIGHTS] if isinstance(self.shape, HeightField) else []
        return [*own, *controls(self.function)]

    def value(self, control: Control) -> Any:
        """Return what is set, or follows from the kind of shape; None where the method finds it."""
        if control is HEIGHTS:
            return self.z_factor
        chosen = self.options.get(control.name)
        return self._follows.get(control.name, control.default) if chosen is None else chosen

    @property
    def declared(self) -> Declaration:
        """What the method declares."""
        from meshdepict.shading.method import declaration

        return declaration(self.function)

    @property
    def follows_view(self) -> bool:
        """Whether another view gives other colours."""
        return self._asked.replace(method=self.function).sees

    @property
    def two_sided(self) -> bool:
        """Whether the side that is seen is shaded; see `Choices`."""
        return self._asked.two_sided

    @property
    def space(self) -> ScaleSpace:
        """The scale space of the method, with what it reads, and perhaps more.

        Made once for all methods with the same scales.
        """
        space = self._made()
        reads = self.declared.reads(space.last, self.options)
        space.smooth(reads.sets, progress=self.progress)
        return space

    def _made(self) -> ScaleSpace:
        scales, ratio = self._asked.replace(method=self.function).ladder
        if scales == 0:
            if not self._spaces:
                self._spaces[0, ratio] = scale_space(self.shape, scales=0)
            return next(iter(self._spaces.values()))  # any: it uses the shape's own normals alone
        if (scales, ratio) not in self._spaces:
            asked = self._asked
            self._spaces[scales, ratio] = scale_space(
                self.shape, scales=scales, ratio=ratio, width=asked.width, facing=asked.facing,
                tolerance=asked.tolerance, at_once=(),
            )  # fmt: skip
        return self._spaces[scales, ratio]

    def baked(self) -> Baked:
        """Return the bake of what is chosen; made once for each choice."""
        if self._baked is None:
            self._baked = self._bake(self.space)
        return self._baked

    def colors_at(self, space: ScaleSpace) -> NDArray[np.uint8]:
        """Return the (k, 3) sRGB colours of other samples of the shape, such as a preview's."""
        return self._bake(space).colors

    def settled(self) -> Look:
        """Return what is chosen, with the numbers that followed from the whole shape."""
        chosen = {name: value for name, value in self.options.items() if value is not None}
        return self.look_now().replace(**{**self._follows, **chosen}).settled(self.space)

    def recorded(self) -> Look:
        """Return what is `settled`, with the number of rays that "auto" came to."""
        look, known = self.settled(), self.baked().look
        rays = None if known is None else known.options.get("rays")
        return look.replace(rays=rays) if look.options.get("rays") == AUTO_RAYS else look

    def _bake(self, space: ScaleSpace) -> Baked:
        self.doing = "tracing rays"
        try:
            found = self._found(space)
        finally:
            self.doing = _SMOOTHING
        if self.colormap is not None and found.intensity.ndim == 1:  # colours stay as they are
            found.colors = color.encode(
                found.intensity, linear=self.declared.linear, colormap=self.colormap
            )
            found.provenance["colormap"] = self.colormap
        return found

    def _found(self, space: ScaleSpace) -> Baked:
        """Return the bake in grey; a light in hand keeps the number of rays that was found."""
        options = self.settled().options
        automatic = options.get("rays") == AUTO_RAYS
        if automatic and self._rays is not None:
            options = {**options, "rays": self._rays}
        found = bake(
            space,
            self.function,
            light=self.light,
            view=self.view,
            up=self.up,
            two_sided=self._asked.two_sided,
            progress=self.progress,
            **options,
        )
        if automatic and found.look is not None and found.look.options["rays"] != AUTO_RAYS:
            self._rays = found.look.options["rays"]
        return found

    @property
    def colors(self) -> NDArray[np.uint8]:
        """(n, 3) sRGB colours."""
        return self.baked().colors


UNSHOWN = ("colormap2d", "blend", "tint", "albedo", "refine", "budget")
"""What bakes have and sessions don't."""


def refuse_unshown(look: Choices, where: str = "") -> None:
    """Refuse a look that no session can show.

    Parameters
    ----------
    look : Choices
    where : str
        What it comes from.
    """
    for name in UNSHOWN:
        if getattr(look, name) != choice_fields()[name].default:
            raise MeshdepictError(
                f"{where}views and movies have no {name}; bake it, or take it out of the recipe"
            )
