"""What a person chooses of a bake's looks: one list of names, with their defaults and their words.

Everything that takes a look or writes one down (bakes, recipes, windows, pages, the command line)
takes `Choices`; nothing lists these names a second time.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from numbers import Real
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from meshdepict import color
from meshdepict.color import colormaps2d
from meshdepict.errors import MeshdepictError
from meshdepict.options import check, options_of
from meshdepict.scales.ladder import FACING, TOLERANCE
from meshdepict.scene.names import as_light, as_lighting, as_view
from meshdepict.scene.upright import upright
from meshdepict.scene.view import View
from meshdepict.shading.method import LIGHT

if TYPE_CHECKING:
    from meshdepict.shading.method import Declaration

__all__ = ["LADDER", "Choices", "choice_fields", "takes_choices"]

MESH, VOLUME = "mesh", "volume"

LADDER = ("scales", "width", "ratio", "facing", "tolerance")
"""Those of the choices that scale spaces are made with."""


def _choice(default: Any, help: str, *, group: str = "Look", only: str = "") -> Any:  # noqa: A002
    """Declare a choice: what it is for, where help lists it, and the kind it is about."""
    return field(default=default, metadata={"help": help, "group": group, "only": only})


@dataclass(frozen=True, init=False, eq=False)
class Choices:
    """How a shape shall look.

    Parameters
    ----------
    method : str or function
        A name of `shading.METHODS`, or a function made by the decorator `meshdepict.method`; the
        attribute `method` is its name, `function` the function.
    light : str, (3,) array_like, (azimuth, elevation) or Light, optional
        For some methods also "studio", "key-and-fill", a sequence of these, or an Environment or
        its file (.hdr). Names and angles refer to the view. Unless given, what the method declares:
        northwest, and lights that show what it is for where one would not.
    view : str or View
        "front", "top", …; fitted to the shape. "auto" looks down on a sheet that lies like a
        terrain, and at the front of anything else.
    up : {"y", "z", "-y", "-z"}, optional
        Which axis of the shape points up; unless given y, and z of a volume, as in a patient's
        frame.
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
    two_sided : bool
        Shade the side that the view sees, also where faces look away from it.
    transfer : str or TransferFunction, optional
        Of volumes: opacity and base colour; a preset's name, a .toml file or a function. "bone"
        unless given.
    **options
        The method's own options.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range.
    """

    method: str = _choice("exaggerated", "How to shade: meshdepict methods lists what there is.")
    light: Any = _choice(
        None,
        "A name (north, northeast, … northwest, front), azimuth,elevation in degrees, x,y,z; where "
        "a method takes several also studio, key-and-fill, a panorama.hdr, or some parted by "
        "semicolons. [default: what the method asks for, mostly northwest]",
    )
    view: str | View = _choice(
        "front",
        "Where names of lights and the picture look from: front, back, left, right, top, bottom, "
        "isometric, or auto: from above where it lies like a terrain, else front.",
    )
    up: Literal["y", "z", "-y", "-z"] | None = _choice(
        None, "Axis of the object that points up: y unless given, and z of a volume."
    )
    colormap: str | None = _choice(
        None, "Colours for dark to bright; grey unless given.", only=MESH
    )
    colormap2d: str | None = _choice(
        None, "Colours for two lights, the other one 90° clockwise: dusk, earth or swiss.",
        only=MESH,
    )  # fmt: skip
    transfer: Any = _choice(
        None,
        "What is shown, and its colours: bone, skin, muscle, lung, micro-ct, or a .toml file; bone "
        "unless given.",
        only=VOLUME,
    )
    scales: int | None = _choice(
        None, "How often to smooth; unless given, as often as the method wants.", group="Detail"
    )
    width: float | str | None = _choice(
        None,
        "First smoothing width in the file's units, or a share of the diagonal such as 0.2%; "
        "unless given, the median edge, or the largest distance of voxels.",
        group="Detail",
    )
    ratio: float | None = _choice(None, "From one width to the next.", group="Detail")
    facing: Literal[0, 1] = _choice(
        FACING, "1 keeps the two sides of thin sheets apart; 0 is the plain sum of the paper.",
        group="Detail", only=MESH,
    )  # fmt: skip
    tolerance: float = _choice(TOLERANCE, "Largest error of a normal, in radians.", group="Detail")
    refine: float | None = _choice(
        None,
        "Split triangles inside which colours would be off by more than so many of 255 grey "
        "levels, 2 for instance.",
        group="Detail",
        only=MESH,
    )
    albedo: Literal["keep", "none"] = _choice(
        "none", "keep: multiply the file's own colours.", group="Files", only=MESH
    )
    two_sided: bool = _choice(
        False,  # noqa: FBT003
        "Shade the side that is seen, also where faces look away from the eye: for open sheets.",
        only=MESH,
    )
    options: Mapping[str, Any] = field(default_factory=dict)
    function: ClassVar[Callable[..., Any]]  # no choice of its own: it follows from the method

    def __init__(self, method: str | Callable[..., Any] = "exaggerated", **chosen: Any) -> None:
        from meshdepict.shading.registry import find_method

        function = find_method(method)
        known = choice_fields()
        for name, each in known.items():
            object.__setattr__(self, name, chosen.pop(name, each.default))
        object.__setattr__(self, "method", function.__name__)
        object.__setattr__(self, "function", function)
        object.__setattr__(self, "options", check(function, chosen, self.method))
        if self.colormap is not None:
            color.colormap(self.colormap)
            if self.colormap2d is not None:
                raise MeshdepictError(
                    "colormap and colormap2d exclude each other: give one of them"
                )
        if self.colormap2d is not None:
            colormaps2d.colormap2d(self.colormap2d)
        if self.up is not None:
            upright(self.up)  # refuses what can't be up
        if not isinstance(self.albedo, str) or self.albedo not in ("none", "keep"):
            raise MeshdepictError(f"albedo={self.albedo!r} is neither 'keep' nor 'none'")
        if not isinstance(self.two_sided, bool):
            raise MeshdepictError(f"two_sided={self.two_sided!r} is neither True nor False")

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
        return self.two_sided or "view" in self.declared.needs

    @property
    def ladder(self) -> tuple[int, float]:
        """How often to smooth and the ratio of the widths: as chosen, else as declared."""
        declared = self.declared
        scales = declared.scales if self.scales is None or not declared.scales else self.scales
        return scales, declared.ratio if self.ratio is None else self.ratio

    def axis(self, kind: str) -> str:
        """Return which axis points up of a kind of shape: as chosen, else as usual."""
        return self.up or ("z" if kind == VOLUME else "y")

    def eye(self, shape: Any) -> View:
        """Return the view of a shape."""
        up, name = self.axis(shape.kind), self.view
        if isinstance(name, str) and name == "auto":
            from meshdepict.baking.sheets import automatic_view

            name = automatic_view(shape, up)
        return as_view(name, shape, up=up)

    @property
    def lit_by(self) -> Any:
        """The light: as chosen, else as the method declares; one where two results are mapped."""
        if self.light is not None:
            return self.light
        return LIGHT if self.colormap2d is not None else self.declared.light

    def lighting(self, view: View, kind: str) -> Any:
        """Return the lights that names stand for in a view of a kind of shape.

        A `Light`, `Lights` or an Environment; one `Light` where two results are mapped.
        """
        if self.colormap2d is not None:
            return as_light(self.lit_by, view)
        return as_lighting(self.lit_by, view, up=self.axis(kind))

    def shade(self, space: Any, light: Any, view: View) -> Any:
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
        fits = self.declared.fits
        return self if fits is None else self.replace(**fits(space, self._every_option))

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
        fields = {
            name: getattr(self, name)
            for name, each in choice_fields().items()
            if name != "method" and getattr(self, name) is not each.default
        }
        return {**fields, **self.options}

    def replace(self, **changes: Any) -> Self:
        """Return other choices: with changes, and of another method without this one's options."""
        from meshdepict.shading.registry import find_method

        method = find_method(changes.pop("method", self.function))
        kept = {name: value for name, value in self.words().items() if name not in self.options}
        options = self.options if method is self.function else {}
        return type(self)(method, **{**kept, **options, **changes})

    def of_kind(self, kind: str) -> Self:
        """Return these choices with what follows from a shape's kind: ladder, up, curvature.

        Parameters
        ----------
        kind : {"mesh", "image", "volume"}

        Raises
        ------
        MeshdepictError
            For a choice that is about another kind.
        """
        for name, each in choice_fields().items():
            only = each.metadata["only"]
            given = getattr(self, name)
            plain = isinstance(given, (str, Real))  # an array compares by element
            usual = given is each.default or (plain and given == each.default)
            if only and (only == VOLUME) != (kind == VOLUME) and not usual:
                raise MeshdepictError(
                    f"{name} is about a {only}, and this is a {kind}: leave it out"
                )
        scales, ratio = self.ladder
        follows: dict[str, Any] = {"scales": scales, "ratio": ratio, "up": self.axis(kind)}
        if kind == VOLUME and self.transfer is None:
            follows["transfer"] = "bone"
        if kind == "image" and "curvature" in options_of(self.function):
            follows["curvature"] = self.options.get("curvature", "view")  # as its paper has it
        return self.replace(**follows)


def _again(kind: type[Choices], method: str | Callable[..., Any], words: dict[str, Any]) -> Choices:
    return kind(method, **words)


@functools.cache
def choice_fields() -> Mapping[str, dataclasses.Field[Any]]:
    """Return the choices by name, but for the options of the method."""
    return {each.name: each for each in dataclasses.fields(Choices) if each.name != "options"}


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
