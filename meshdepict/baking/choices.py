"""How a shape shall look: what was chosen, and what follows from it for a shape at hand."""

from __future__ import annotations

import functools
import inspect
import textwrap
import warnings
from collections.abc import Callable, Iterable, Sequence
from numbers import Real
from typing import TYPE_CHECKING, Any, Self

from meshdepict import color
from meshdepict.baking.accuracy import ACCURACIES, NORMAL, numbers_of
from meshdepict.baking.choice_list import (
    AUTO,
    HEIGHTS,
    IMAGE,
    VOLUME,
    ChoiceList,
    choice_fields,
)
from meshdepict.baking.layer_list import Layer, as_layers, blend_name, kept_blend
from meshdepict.baking.time_limits import as_seconds
from meshdepict.color import colormaps2d
from meshdepict.color.tints import checked_tint
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.options import check, nearest, options_of, real
from meshdepict.scene.environment import SAMPLINGS
from meshdepict.scene.light import Light
from meshdepict.scene.names import Lighting, LightsLike, as_light, as_lighting, as_view
from meshdepict.scene.upright import upright
from meshdepict.scene.view import View
from meshdepict.shading.method import LIGHT
from meshdepict.shading.sampled import AUTO_RAYS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from meshdepict.scales.reads import Reads
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.shading.method import Declaration

__all__ = ["Choices", "takes_choices"]

_ON_TERRAIN = {"one_light": True, "sky": "overhead"}
"""Options that methods take of terrain unless told otherwise."""


class Choices(ChoiceList):
    """How a shape shall look; parameters are those of `ChoiceList`, and the method's options.

    Attributes
    ----------
    taken : dict
        Choices and options that nobody gave and the accuracy chose, by name.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range.
    """

    taken: dict[str, Any]
    _said: frozenset[str]

    def __init__(self, method: str | Callable[..., Any] = "exaggerated", **chosen: Any) -> None:
        from meshdepict.shading.registry import find_method

        function = find_method(method)
        known = choice_fields()
        if chosen.get("accuracy") is None:
            chosen.pop("accuracy", None)
        if chosen.get("blend") is not None:
            chosen["blend"] = kept_blend(chosen["blend"])
            function = _within(as_layers(chosen["blend"]), function)
        if chosen.get("tint") is not None:
            chosen["tint"] = checked_tint(chosen["tint"])
        said = frozenset(name for name, value in chosen.items() if value is not None)
        for name, each in known.items():
            object.__setattr__(self, name, chosen.pop(name, each.default))
        object.__setattr__(self, "method", function.__name__)
        object.__setattr__(self, "function", function)
        object.__setattr__(self, "options", check(function, chosen, self.method))
        self._take_accuracy(said)
        if self.colormap is not None:
            color.colormap(self.colormap)
            if self.colormap2d is not None:
                raise MeshdepictError(
                    "colormap and colormap2d exclude each other: give one of them"
                )
        if self.colormap2d is not None:
            colormaps2d.colormap2d(self.colormap2d)
            if self.blend is not None:
                raise MeshdepictError(
                    "colormap2d shows one method under two lights, and blend several: give one of "
                    "them"
                )
        if self.up is not None and not (isinstance(self.up, str) and self.up == AUTO):
            upright(self.up)  # refuses what can't be up
        if not isinstance(self.albedo, str) or self.albedo not in ("none", "keep"):
            raise MeshdepictError(f"albedo={self.albedo!r} is neither 'keep' nor 'none'")
        if self.creases is not None:
            from meshdepict.shapes.parted import check_creases

            check_creases(self.creases)
        if not isinstance(self.normals, str) or self.normals not in ("computed", "file"):
            raise MeshdepictError(f"normals={self.normals!r} is neither 'computed' nor 'file'")
        if self.creases is not None and self.normals == "file":
            raise MeshdepictError(
                "the file's normals say themselves which edges are sharp: leave creases out"
            )
        if not 0 < (real(self.z_factor) or 0) <= 1e6:
            raise MeshdepictError(f"z_factor={self.z_factor!r} is not a number above 0 up to 1e6")
        if not isinstance(self.sampling, str) or self.sampling not in SAMPLINGS:
            raise MeshdepictError(f"sampling={self.sampling!r} is neither 'lobes' nor 'lights'")
        grounds = ("matt", "mirror")
        if self.ground is not None and not (
            isinstance(self.ground, str) and self.ground in grounds
        ):
            raise MeshdepictError(f"ground={self.ground!r} is neither 'matt' nor 'mirror'")
        if not isinstance(self.two_sided, bool):
            raise MeshdepictError(f"two_sided={self.two_sided!r} is neither True nor False")

    def _take_accuracy(self, said: frozenset[str]) -> None:
        """Take the numbers of an accuracy where nobody said others."""
        accuracy = self.accuracy
        if not isinstance(accuracy, str) or accuracy not in ACCURACIES:
            raise MeshdepictError(
                f"accuracy={accuracy!r} is none of {', '.join(ACCURACIES)}"
                f"{nearest(str(accuracy), ACCURACIES)}"
            )
        if self.budget is not None:
            as_seconds(self.budget)
            if "accuracy" in said and accuracy != NORMAL:
                raise MeshdepictError(
                    f"budget chooses an accuracy, and accuracy={accuracy!r} is chosen: give one of "
                    "them"
                )
        taken = numbers_of(accuracy, self.function, self.options, blended=self.blend is not None)
        if said & {"scales", "ratio"}:  # which belong together
            said |= {"scales", "ratio"}
        taken = {name: value for name, value in taken.items() if name not in said}
        fields = choice_fields()
        for name in taken.keys() & fields.keys():
            object.__setattr__(self, name, taken[name])
        more = {name: value for name, value in taken.items() if name not in fields}
        object.__setattr__(self, "options", {**self.options, **more})
        object.__setattr__(self, "taken", taken)
        object.__setattr__(self, "_said", said)

    def __repr__(self) -> str:
        """Return what differs from the defaults."""
        words = "".join(f", {name}={value!r}" for name, value in self.words().items())
        return f"{type(self).__name__}({self.method!r}{words})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes it again in another process: a method that has a name, by its name."""
        from meshdepict.shading.registry import METHODS

        named = METHODS.get(self.method) is self.function
        return _again, (type(self), self.method if named else self.function, self.words())

    @property
    def declared(self) -> Declaration:
        """What the method declares."""
        from meshdepict.shading.method import declaration

        return declaration(self.function)

    @property
    def sees(self) -> bool:
        """Whether colours depend on where the eye is."""
        if self.blend is not None:
            return any(self.of_layer(layer).sees for layer in self.layers)
        return self.two_sided or "view" in self.declared.needs

    @property
    def lit(self) -> bool:
        """Whether it takes a light at all."""
        if self.blend is not None:
            return any(self.of_layer(layer).lit for layer in self.layers)
        return self.declared.lights != "none"

    @functools.cached_property
    def layers(self) -> tuple[Layer, ...]:
        """The layers of its blend, the first on top; none without a blend."""
        return () if self.blend is None else as_layers(self.blend)

    @property
    def bounces(self) -> bool:
        """Whether light bounces."""
        layers = [self.of_layer(layer) for layer in self.layers] or [self]
        return any(each.options.get("bounces") for each in layers)

    @property
    def title(self) -> str:
        """What pictures and files are named after: the method, or what its blend is called."""
        return self.method if self.blend is None else blend_name(self.blend)

    def of_layer(self, layer: Layer) -> Self:
        """Return these choices for a layer alone."""
        own = self.options if layer.function is self.function else {}
        alone: dict[str, Any] = {"blend": None, "tint": None, "colormap": None, "albedo": "none"}
        if layer.light is not None:
            alone["light"] = layer.light
        words = {name: value for name, value in self.words().items() if name not in self.options}
        return type(self)(layer.function, **{**words, **alone, **own, **layer.options})

    def with_settled(self, looks: Iterable[Choices]) -> Self:
        """Return these choices with what its layers' looks, in their order, found of a shape."""
        layers = []
        for layer, look in zip(self.layers, looks, strict=True):
            found = dict(look.fitted)
            if self.of_layer(layer).options.get("rays") == AUTO_RAYS:
                found["rays"] = look.options["rays"]
            layers.append(layer.replace(options={**layer.options, **found}) if found else layer)
        same = all(new is old for new, old in zip(layers, self.layers, strict=True))
        return self if same else self.replace(blend=tuple(layers))

    @property
    def ladder(self) -> tuple[int, float]:
        """How often to smooth and the ratio of the widths: as chosen, else as declared.

        Of a blend as the layer has it that wants most.
        """
        if self.blend is not None:
            return max(self.of_layer(layer).ladder for layer in self.layers)
        declared = self.declared
        scales = declared.scales if self.scales is None or not declared.scales else self.scales
        return scales, declared.ratio if self.ratio is None else self.ratio

    def axis(self, kind: str) -> str:
        """Return which axis points up of a kind of shape: as chosen, else as usual."""
        return self.up or ("z" if kind in (VOLUME, HEIGHTS) else "y")

    def _on_map(self, kind: str) -> Self:
        """Return these choices of terrain with z up, and the map as the view that nobody turned."""
        if kind != HEIGHTS:
            return self
        sight, free = self.view, self.up in (None, AUTO)
        usual = isinstance(sight, str) and (sight == AUTO or (sight == "front" and free))
        up = "z" if free else self.up
        return self.replace(view="top" if usual else sight, up=up)

    def posed(self, shape: Any) -> Self:
        """Return these choices with what suits a shape where up and view are "auto"."""
        if shape.kind == HEIGHTS:
            return self._on_map(HEIGHTS)
        sight = isinstance(self.view, str) and self.view == AUTO
        if self.up == AUTO:
            from meshdepict.shapes.standing import standing

            found = standing(shape)
            if found.note:
                warnings.warn(found.note, MeshdepictWarning, stacklevel=3)
            return self.replace(up=found.up, **({"view": found.view} if sight else {}))
        if sight:
            from meshdepict.shapes.standing import automatic_view

            return self.replace(view=automatic_view(shape, self.axis(shape.kind)))
        return self

    def eye(self, shape: Any) -> View:
        """Return the view of a shape."""
        look = self.posed(shape)
        return as_view(look.view, shape, up=look.axis(shape.kind))

    @property
    def lit_by(self) -> LightsLike:
        """The light: as chosen, else as the method declares; one where two results are mapped."""
        if self.light is not None:
            return self.light
        for layer in reversed(self.layers):
            if layer.function is self.function and layer.light is not None:
                return layer.light
        return LIGHT if self.colormap2d is not None else self.declared.light

    def lighting(self, view: View, kind: str) -> Lighting:
        """Return the lights that names stand for in a view of a kind of shape.

        A `Light`, `Lights` or an Environment; one `Light` where two results are mapped.

        Raises
        ------
        MeshdepictError
            For what is no light, and for several of a method that takes one.
        """
        if self.colormap2d is not None:
            return as_light(self.lit_by, view)
        found = as_lighting(self.lit_by, view, up=self.axis(kind), sampling=self.sampling)
        if self.declared.lights == "one" and not isinstance(found, Light):
            from meshdepict.shading.method import declaration
            from meshdepict.shading.registry import METHODS

            many = [name for name, each in METHODS.items() if declaration(each).lights == "several"]
            said = textwrap.shorten(str(found).partition(" (")[0], 60, placeholder=" …")
            raise MeshdepictError(
                f"one light is needed here, not several ({said}): {self.method} takes one, "
                f"northwest for instance; several are for {', '.join(many)}"
            )
        return found

    def reads(self, last: int) -> Reads:
        """Return what the method reads of a scale space with so many smoothed sets."""
        return self.declared.reads(last, self.options)

    def shade(self, space: ScaleSpace, light: LightsLike, view: View) -> NDArray[np.float32]:
        """Return what the method makes of a scale space's samples under a light."""
        needed: dict[str, Any] = {"two_sided": True} if self.two_sided else {}
        if needed or "view" in self.declared.needs:
            needed["view"] = view
        return self.function(space, light, **needed, **self.options)

    def settled(self, space: Any) -> Self:
        """Return these choices with numbers for the options that follow a shape's scale space.

        Parameters
        ----------
        space : ScaleSpace or None
            None of a shape that is never at hand as a whole.
        """
        if self.blend is not None:
            looks = [self.of_layer(layer) for layer in self.layers]
            if space is not None:
                looks = [each.of_kind(space.shape.kind) for each in looks]
            return self.with_settled(each.settled(space) for each in looks)
        fits = self.declared.fits
        return self if fits is None else self.replace(**fits(space, self._every_option))

    def with_rays(self, space: ScaleSpace, light: LightsLike, view: View) -> Self:
        """Return these choices with the number of rays that "auto" comes to under a light.

        The space's ``light_errors.found`` says why it is that one. Where nothing goes by rays,
        "auto" stays.
        """
        space.light_errors.found = None
        if self._every_option.get("rays") != AUTO_RAYS:
            return self
        self.shade(space, light, view)
        found = space.light_errors.found
        return self if found is None else self.replace(rays=found.rays)

    @property
    def fitted(self) -> dict[str, Any]:
        """Options that follow the shape unless they are given, with their values; None: open."""
        fits, given = self.declared.fits, self._every_option
        return {} if fits is None else {name: given[name] for name in fits(None, given)}

    @property
    def following(self) -> tuple[str, ...]:
        """Names of the options that are still open, and follow the shape."""
        return tuple(name for name, value in self.fitted.items() if value is None)

    @property
    def _every_option(self) -> dict[str, Any]:
        known = options_of(self.function).items()
        return {name: self.options.get(name, option.default) for name, option in known}

    def words(self) -> dict[str, Any]:
        """Return what differs from the defaults, and the options, as keywords; not the method."""
        chosen = self.accuracy != NORMAL or self.budget is not None
        kept = self._said if chosen else frozenset()  # the usual, too, which wins over an accuracy
        fields = {
            name: getattr(self, name)
            for name, each in choice_fields().items()
            if name not in ("method", *self.taken)
            and (name in kept or not _is(getattr(self, name), each.default))
        }
        options = {name: value for name, value in self.options.items() if name not in self.taken}
        return {**fields, **options}

    def replace(self, **changes: Any) -> Self:
        """Return other choices: with changes.

        Of another method they come without this one's options, and without the blend.
        """
        from meshdepict.shading.registry import find_method

        method = find_method(changes.pop("method", self.function))
        kept = {name: value for name, value in self.words().items() if name not in self.options}
        if method is not self.function:
            kept.pop("blend", None)
        options = self.options if method is self.function else {}
        return type(self)(method, **{**kept, **options, **changes})

    def of_kind(self, kind: str) -> Self:
        """Return these choices with what follows from a shape's kind: ladder, up, curvature.

        Parameters
        ----------
        kind : {"mesh", "image", "volume", "height field"}

        Raises
        ------
        MeshdepictError
            For a choice that is about another kind.
        """
        for name, each in choice_fields().items():
            only = each.metadata["only"]
            usual = _is(getattr(self, name), each.default)
            if not usual and only and kind not in only:
                raise MeshdepictError(
                    f"{name} is about a {only[0]}, and this is {'an' if kind == IMAGE else 'a'} "
                    f"{kind}: leave it out"
                )
        scales, ratio = self.ladder
        if kind == VOLUME and "scales" in self.taken:  # voxels without a scale look otherwise
            scales, ratio = self.declared.scales, self.declared.ratio
        look = self._on_map(kind)
        follows: dict[str, Any] = {
            "scales": scales, "ratio": ratio, "up": look.axis(kind), "view": look.view
        }  # fmt: skip
        if kind == VOLUME and self.transfer is None:
            follows["transfer"] = "bone"
        if kind == "image" and "curvature" in options_of(self.function):
            follows["curvature"] = self.options.get("curvature", "view")  # as its paper has it
        if kind == HEIGHTS:
            known = options_of(self.function).keys() & _ON_TERRAIN.keys()
            unsaid = {name for name in known if self.options.get(name) is None}
            follows.update({name: _ON_TERRAIN[name] for name in unsaid})
        return self.replace(**follows)


def _within(layers: Sequence[Layer], function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the method that a blend has: the lowest layer's, or what somebody named of them."""
    known = [layer.function for layer in layers]
    if function in known:
        return function
    if function.__name__ != choice_fields()["method"].default:
        raise MeshdepictError(
            f"blend has no layer {function.__name__}: leave method out, or name one of "
            f"{', '.join(dict.fromkeys(each.__name__ for each in known))}"
        )
    return known[-1]


def _is(given: object, usual: object) -> bool:
    """Whether what was given is what is usual: by value where words and numbers are compared."""
    plain = isinstance(given, (str, Real))  # an array compares by element
    return given is usual or (plain and given == usual)


def _again(kind: type[Choices], method: str | Callable[..., Any], words: dict[str, Any]) -> Choices:
    return kind(method, **words)


def takes_choices(function: Callable[..., Any]) -> Callable[..., Any]:
    """Say in a function's signature which keywords its ``**chosen`` stands for."""
    signature = inspect.signature(function)
    kept = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
    named = {p.name for p in kept}
    chosen = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=each.default)
        for name, each in choice_fields().items()
        if name not in named
    ]
    rest = inspect.Parameter("options", inspect.Parameter.VAR_KEYWORD)
    front = [p for p in kept if p.kind is not p.KEYWORD_ONLY]
    back = [p for p in kept if p.kind is p.KEYWORD_ONLY]
    shown = signature.replace(parameters=[*front, *chosen, *back, rest])
    function.__signature__ = shown  # type: ignore[attr-defined]
    return function
