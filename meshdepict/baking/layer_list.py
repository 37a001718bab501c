"""Layers of a blend in words: ``sky_view:multiply:0.5,exaggerated``, the first on top.

The order is that of the Relief Visualization Toolbox and of image editors. The last one is the
lowest and lies on nothing: it is taken as it is, whatever its mode and opacity.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from meshdepict import color
from meshdepict.baking.combinations import COMBINATIONS
from meshdepict.color.blending import checked_mode, checked_opacity, checked_stretch
from meshdepict.color.spans import parsed_span, span_text
from meshdepict.errors import MeshdepictError
from meshdepict.options import as_text, check, nearest, options_of
from meshdepict.scene.light import Light
from meshdepict.scene.names import LightsLike
from meshdepict.shading.registry import METHODS, find_method

__all__ = ["Layer", "as_layers", "blend_name", "blend_text", "kept_blend"]

_FORM = "method:mode:opacity:low..high"


@dataclass(frozen=True, eq=False)
class Layer:
    """A method's picture in a blend.

    Parameters
    ----------
    method : str or function
        As of `bake`.
    mode : str
        How it is laid upon what is below; see `color.blending`.
    opacity : float
        0 to 1.
    stretch : (low, high), optional
        The display values of the method that become black and white.
    light : optional
        The blend's unless given.
    colormap : str, optional
        Of its grey values.
    options : mapping
        Of the method.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range.
    """

    method: str | Callable[..., Any]
    mode: str = "normal"
    opacity: float = 1.0
    stretch: tuple[float, float] | None = None
    light: LightsLike | None = None
    colormap: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check all of it."""
        function = find_method(self.method)
        if not isinstance(self.options, Mapping):
            raise MeshdepictError(
                f"options={self.options!r} of the layer {function.__name__} is no mapping of names "
                "to values"
            )
        checked = {
            "method": function.__name__ if METHODS.get(function.__name__) is function else function,
            "mode": checked_mode(self.mode),
            "opacity": checked_opacity(self.opacity),
            "stretch": None if self.stretch is None else checked_stretch(self.stretch),
            "light": _numbers(self.light),
            "options": check(function, self.options, function.__name__),
        }
        if self.colormap is not None:
            color.colormap(self.colormap)
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    @property
    def function(self) -> Callable[..., Any]:
        """The shading function."""
        return find_method(self.method)

    def replace(self, **changes: Any) -> Layer:
        """Return the layer with changes."""
        return dataclasses.replace(self, **changes)

    def recorded(self, options: Mapping[str, Any], light: LightsLike | None) -> dict[str, Any]:
        """Return all of it in words that files hold and `as_layers` takes back.

        Parameters
        ----------
        options : mapping
            Those of the blend for this method.
        light : optional
            What lights this layer unless it has a light of its own.
        """
        light = light if self.light is None else self.light
        usual = {name: option.default for name, option in options_of(self.function).items()}
        every = {**usual, **options, **self.options}
        words = {
            "method": self.function.__name__, "mode": self.mode, "opacity": self.opacity,
            "stretch": self.stretch, "colormap": self.colormap,
            "light": light.direction.tolist() if isinstance(light, Light) else light,
            "options": {name: value for name, value in every.items() if value is not None},
        }  # fmt: skip
        return {name: value for name, value in words.items() if value is not None}

    def __str__(self) -> str:
        """Return the layer in words; light, colour map and options in brackets."""
        parts = [self.function.__name__, self.mode, as_text(float(self.opacity))]
        if self.stretch is not None:
            parts.append(span_text(self.stretch))
        more = {"light": self.light, "colormap": self.colormap, **self.options}
        said = [f"{name}={as_text(value)}" for name, value in more.items() if value is not None]
        return ":".join(parts) + (f" ({' '.join(said)})" if said else "")


def as_layers(blend: object) -> tuple[Layer, ...]:
    """Return the layers of a blend, the first on top.

    Parameters
    ----------
    blend : str or sequence
        The name of a combination ("archaeological", "vat_flat", "geomorphological"), or layers as
        a text, ``method[:mode[:opacity[:low..high]]]`` parted by commas, opacity as 0.5 or 50%; or
        a sequence of such texts, `Layer`, mappings of its words, looks, and (method, mode, opacity,
        options).

    Raises
    ------
    MeshdepictError
        With one sentence for what is wrong, naming the nearest that there is.
    """
    if isinstance(blend, str):
        name = blend.strip()
        if name in COMBINATIONS:
            return tuple(Layer(**words) for words in COMBINATIONS[name])
        if not name:
            raise MeshdepictError("blend has no layers: give sky_view:multiply:0.5,exaggerated")
        if name not in METHODS and not {",", ":"} & set(name):
            known = (*COMBINATIONS, *METHODS)
            raise MeshdepictError(
                f"no combination and no method is called {name!r}{nearest(name, known)} "
                f"(combinations: {', '.join(COMBINATIONS)})"
            )
        return tuple(_parsed(part.strip(), blend) for part in name.split(","))
    if not isinstance(blend, Sequence) or not blend:
        raise MeshdepictError(
            f"blend={blend!r:.80} is neither a text such as sky_view:multiply:0.5,exaggerated nor "
            "a sequence of layers"
        )
    return tuple(_layer(each) for each in blend)


def kept_blend(blend: object) -> str | tuple[Layer, ...]:
    """Return a blend as looks keep it: a text as it is, all else as layers; refuse what is none."""
    layers = as_layers(blend)
    return blend if isinstance(blend, str) else layers


def blend_text(layers: Sequence[Layer]) -> str:
    """Return layers in words."""
    return ", ".join(map(str, layers))


def blend_name(blend: object) -> str:
    """Return the name of a combination, "blend" for all else."""
    name = blend.strip() if isinstance(blend, str) else ""
    return name if name in COMBINATIONS else "blend"


def _numbers(light: Any) -> Any:
    """Return a light with numbers of a list or an array as a tuple."""
    light = light.tolist() if hasattr(light, "tolist") else light
    return tuple(light) if isinstance(light, list) else light


def _layer(given: object) -> Layer:
    """Return a layer from any of what may stand for one."""
    if isinstance(given, Layer):
        return given
    if isinstance(given, str):
        return _parsed(given.strip(), given)
    if isinstance(given, Mapping):
        known = [each.name for each in dataclasses.fields(Layer)]
        for name in given:
            if name not in known:
                raise MeshdepictError(
                    f"a layer has no {name!r}{nearest(str(name), known)} (it has "
                    f"{', '.join(known)})"
                )
        if "method" not in given:
            raise MeshdepictError(f"the layer {dict(given)!r:.80} has no method")
        return Layer(**given)
    if isinstance(given, Sequence) and 1 <= len(given) <= 4:
        method, *rest = given
        words = dict(zip(("mode", "opacity", "options"), rest, strict=False))
        return Layer(method, **words)
    if callable(given):
        return Layer(given)
    if hasattr(given, "words") and hasattr(given, "function"):
        return _of_look(given)
    raise MeshdepictError(
        f"{given!r:.80} is no layer: give a text, a look, or (method, mode, opacity, options)"
    )


def _of_look(look: Any) -> Layer:
    """Return the layer of a look: its method, options, light and colour map."""
    words = dict(look.words())
    options = {name: words.pop(name) for name in look.options}
    light, colormap = words.pop("light", None), words.pop("colormap", None)
    for name in words:
        raise MeshdepictError(
            f"{name} is chosen for the whole blend: leave it out of the layer {look.method}"
        )
    return Layer(look.function, light=light, colormap=colormap, options=options)


def _parsed(text: str, whole: str) -> Layer:
    """Return a layer from its words."""
    if not text:
        raise MeshdepictError(f"blend={whole!r} has an empty layer: remove a comma")
    method, *rest = (part.strip() for part in text.split(":"))
    if len(rest) > 3:
        raise MeshdepictError(f"the layer {text!r} has too many parts: it is {_FORM} at most")
    words: dict[str, Any] = {}
    if rest:
        words["mode"] = rest[0]
    if len(rest) > 1:
        words["opacity"] = _opacity(rest[1], text)
    if len(rest) > 2:
        try:
            words["stretch"] = parsed_span(rest[2])
        except MeshdepictError as error:
            raise MeshdepictError(f"the layer {text!r}: {error}") from None
    return Layer(method, **words)


def _opacity(word: str, text: str) -> float:
    number = word.removesuffix("%")
    try:
        share = float(number) / (100 if word.endswith("%") else 1)
        return checked_opacity(share)
    except (ValueError, MeshdepictError):
        raise MeshdepictError(
            f"the layer {text!r}: its opacity {word!r} is neither a number from 0 to 1 nor a "
            "percentage such as 50%"
        ) from None
