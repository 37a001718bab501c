"""What live shading of meshes and of volumes share: methods, checked options, uniforms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from meshdepict.baking.choices import Choices
from meshdepict.drawing.shader import MOST_LIGHTS, caught_errors
from meshdepict.errors import MeshdepictError
from meshdepict.options import check, nearest, options_of
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.light import Light
from meshdepict.scene.names import LightsLike, as_light, as_lights, as_view, has_environment
from meshdepict.scene.view import View
from meshdepict.shading.method import declaration
from meshdepict.shading.registry import find_method
from meshdepict.viewer.live.direct import LIGHT_WARPING, PHONG, RADIANCE_SCALING
from meshdepict.viewer.live.exaggerated import EXAGGERATED
from meshdepict.viewer.live.lambert import HALF_LAMBERT, LAMBERT
from meshdepict.viewer.live.light_alignment import LIGHT_ALIGNMENT
from meshdepict.viewer.live.live_method import LiveMethod

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkActor, vtkVolume

    from meshdepict.drawing.plotter import Plotter

__all__ = [
    "LiveLook", "changed_options", "live_lights", "live_method", "live_methods", "look_uniforms",
    "switches",
]  # fmt: skip

_METHODS = {
    method.name: method
    for method in (
        EXAGGERATED, LIGHT_WARPING, RADIANCE_SCALING, LIGHT_ALIGNMENT, LAMBERT, HALF_LAMBERT, PHONG,
    )
}  # fmt: skip


class LiveLook:
    """A method, its options, a light and a view, which all can change; what shows them is `actor`.

    Parameters
    ----------
    space : ScaleSpace
    method, light, view, colormap
        As in `bake`.
    options : mapping, optional
        The method's own.
    """

    def __init__(
        self,
        space: ScaleSpace,
        method: str | Callable[..., Any],
        *,
        options: Mapping[str, Any] | None = None,
        light: Any = None,
        view: View | str,
        colormap: str | None = None,
    ) -> None:
        self._method, self._space = live_method(method), space
        self._colormap = colormap
        self._options: dict[str, Any] = {
            name: option.default for name, option in options_of(self._method.function).items()
        }
        kind = getattr(space.shape, "kind", "")  # what is no shape is refused where actors are made
        self._options |= Choices(self._method.function).of_kind(kind).options
        # What can't be live is refused before anything is made: windows ask at every frame.
        changed_options(self._method, self._options, options or {})
        self.actor = self._made(space)
        self._view = as_view(view, space.shape)
        self._light = declaration(self._method.function).light if light is None else light
        # What the card has by now.
        self._key: tuple[Any, ...] | None = None
        self._defines: dict[str, int] | None = None
        self._sets = 0
        self._show(options=dict(options or {}))

    def _made(self, space: ScaleSpace) -> vtkActor | vtkVolume:
        """Return an actor of a scale space's shape; refuse other shapes."""
        raise NotImplementedError

    @property
    def method(self) -> str:
        """Name of the method."""
        return self._method.name

    @property
    def options(self) -> dict[str, Any]:
        """All options and their values."""
        return dict(self._options)

    def set_light(self, light: LightsLike) -> None:
        """Light it differently: uniforms only."""
        self._show(light=light)

    def set_options(self, **options: Any) -> None:
        """Change some options; the others stay."""
        self._show(options=options)

    def set_view(self, view: View | str) -> None:
        """Move the eye that highlights, curvature and named lights refer to."""
        self._show(view=as_view(view, self._space.shape))

    def check(self, plotter: Plotter | None = None) -> None:
        """Render a frame and raise if the card doesn't do what it should.

        Parameters
        ----------
        plotter : pyvista.Plotter, optional
            Whose scene has the actor; else a few pixels are rendered off screen.

        Raises
        ------
        MeshdepictError
            With the driver's words where the shader did not compile.
        """
        import pyvista as pv

        with caught_errors(f"{self.method} shading"):
            if plotter is not None:
                plotter.render_window.Render()
                return
            window = pv.Plotter(off_screen=True, window_size=[16, 16])
            try:
                self._enter(window)
                window.show(auto_close=False)
            finally:
                window.close()

    def _enter(self, window: Plotter) -> None:
        """Add the actor to a plotter."""
        raise NotImplementedError

    def _show(self, **changes: Any) -> None:
        """Check changes together, then make them."""
        raise NotImplementedError


def live_methods() -> tuple[str, ...]:
    """Return the names of the methods that can be live."""
    return tuple(_METHODS)


def live_method(method: object) -> LiveMethod:
    """Return a method that can be live, by name or function; raise `MeshdepictError` for others."""
    name = getattr(method, "__name__", method)
    if (
        not isinstance(name, str)
        or name not in _METHODS
        or (callable(method) and method is not find_method(name))
    ):
        raise MeshdepictError(
            f"{name!r} can't be shown live{nearest(str(name), _METHODS)} (these can: "
            f"{', '.join(_METHODS)}); bake it instead"
        )
    return _METHODS[name]


def changed_options(
    method: LiveMethod, options: Mapping[str, Any], given: Mapping[str, Any]
) -> dict[str, Any]:
    """Return options with those given in their place.

    Raises
    ------
    MeshdepictError
        For wrong ones, and for values that can't be live.
    """
    changed = {**options, **check(method.function, given, method.name)}
    for name, values in method.only.items():
        if changed[name] not in values:
            raise MeshdepictError(
                f"{method.name} can't be live with {name}={changed[name]!r}, only with "
                f"{values[0]!r}; bake it instead"
            )
    for name, most in method.most.items():
        if changed[name] > most:
            raise MeshdepictError(
                f"{method.name} can't be live with {name}={changed[name]:g}, only up to {most:g}: "
                "beyond, single precision isn't enough; bake it instead"
            )
    return changed


def live_lights(
    method: LiveMethod, light: LightsLike, view: View, options: Mapping[str, Any]
) -> list[Light]:
    """Return the lights; their colours count where the method looks at them.

    Raises
    ------
    MeshdepictError
        For more than fit.
    """
    if not method.several:
        return [Light(as_light(light, view).direction)]
    if has_environment(light) and "GLOSSY" in method.defines(options):
        raise MeshdepictError(
            "live shading has no highlights of an environment, which are sampled at every point; "
            "bake it instead"
        )
    lights = as_lights(light, view, count=options.get("lights", 54))
    if len(lights) > MOST_LIGHTS:
        raise MeshdepictError(
            f"live shading has at most {MOST_LIGHTS} lights, not {len(lights)}; bake it instead"
        )
    return lights


def look_uniforms(
    method: LiveMethod,
    space: ScaleSpace,
    lights: list[Light],
    view: View,
    options: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the numbers of method, lights and eye that the shader needs."""
    numbers = np.zeros((MOST_LIGHTS, 6))
    for row, lamp in zip(numbers, lights, strict=False):
        row[:3], row[3:] = lamp.direction, lamp.color
    axis = tuple(map(float, view.towards_eye))
    if view.parallel_scale is not None:
        eye = (*axis, 0.0)
    else:
        eye = (*map(float, space.shape.recentred(view.position)), 1.0)
    return {
        **method.uniforms(space, options),
        "lights": numbers.ravel().tolist(),
        "light_count": len(lights),
        "eye": eye,
        "view_axis": axis,
        "exposure": options["exposure"],
    }


def switches(method: LiveMethod, sets: int, options: Mapping[str, Any]) -> dict[str, int]:
    """Return what the shader is compiled with."""
    linear = {"LINEAR": 1} if declaration(method.function).linear else {}
    return {"SETS": sets, **method.defines(options), **linear}
