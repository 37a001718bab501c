"""What a shading method declares beside its function: what it needs, and how its values read."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range, check, nearest, options_of
from meshdepict.scales.reads import Reads
from meshdepict.scene.names import LIGHTS
from meshdepict.scene.rig import RIGS
from meshdepict.shading.docstring import completed

if TYPE_CHECKING:
    from meshdepict.scales.space import ScaleSpace

__all__ = [
    "NEEDS", "Declaration", "Exposure", "Lights", "declaration", "exposed", "is_method", "method",
    "require_smoothing",
]  # fmt: skip

Function = TypeVar("Function", bound=Callable[..., Any])
Lights = Literal["one", "several", "none"]
Fits = Callable[[Any, Mapping[str, Any]], Mapping[str, Any]]

NEEDS = {
    "view": "where the eye is",
    "curvature": "how the surface bends",
    "rays": "how open every sample is: rays from it, or an image's own occlusion",
    "surface": "triangles for rays to meet: no image, no volume",
    "areas": "parts of a surface: no volume",
    "heights": "heights on a raster: terrain, no mesh",
}
"""What a method may need beside normals and a light, with its default options."""

LIGHT = "northwest"
"""What lights a bake unless the method or the person says otherwise."""

Exposure = Annotated[float, Range(0, 1e6, help="factor on the result before clipping", soft=(0, 4))]


def _all_sets(last: int, options: Mapping[str, Any] | None = None, /, **_: Any) -> Reads:
    return Reads(normals=frozenset(range(last + 1)))


def _own_normals(last: int, /, **_: Any) -> Reads:
    return Reads(normals=frozenset((0,)))


@dataclass(frozen=True)
class Declaration:
    """What `bake` has to know about a method.

    Attributes
    ----------
    scales : int
        Smoothed sets of normals it is usually given; 0 where it uses only the original ones.
    ratio : float
        From one width to the next.
    linear : bool
        Whether its values are linear light, to be encoded as sRGB, or display values.
    source : str
        The paper.
    local : bool
        Whether a sample's value follows from its own normals and curvature alone, so that some
        samples can be shaded without the others.
    lights : {"one", "several", "none"}
        How many lights it takes at once; "none" looks the same under any.
    needs : frozenset of str
        Of `NEEDS`; "view" is there where the function has such a parameter.
    compared : mapping, optional
        Options with which `compare` shows it unless told otherwise, as papers compare it; None
        where it is compared only when asked for.
    fits : callable (space, options) → options, optional
        What options become that follow the shape where they are None, of a whole scale space; of
        None, for shapes that are never whole at hand, what fits most. Bakes, recipes and viewers
        ask once and keep the numbers.
    light : str
        Name of the light that shows what it is for, under which it is baked unless told otherwise.
    ground : str
        Background of its pictures unless told otherwise: "paper" where much of it is white.
    reads : callable (last, options) → Reads
        What it reads of a scale space with so many smoothed sets, under such options; those that
        are left out have their defaults.
    """

    scales: int
    ratio: float
    linear: bool
    source: str
    local: bool = True
    lights: Lights = "one"
    needs: frozenset[str] = frozenset()
    compared: Mapping[str, Any] | None = None
    light: str = LIGHT
    fits: Fits | None = None
    ground: str = "white"
    reads: Callable[[int, Mapping[str, Any]], Reads] = _all_sets


def method(
    *,
    scales: int = 0,
    ratio: float = math.sqrt(2),
    linear: bool = False,
    local: bool = True,
    lights: Lights = "one",
    needs: Iterable[str] = (),
    compared: Mapping[str, Any] | None = None,
    light: str = LIGHT,
    fits: Fits | None = None,
    ground: str = "white",
    reads: Callable[..., Reads] | None = None,
    source: str,
) -> Callable[[Function], Function]:
    """Declare a shading function: its scales, the kind of its values, its needs and its paper.

    The function then refuses wrong options, and anything but a scale space, with one sentence; and
    its docstring says of every parameter what its annotation says, where it says nothing itself.

    Parameters
    ----------
    scales, ratio, linear, local, lights, needs, compared, light, fits, ground, source
        See `Declaration`.
    reads : callable (last, options) → Reads, optional
        Called with every option of the function. Only what it names is computed before the function
        is called, and is what ``meshdepict info --explain`` tells; what else the function reads is
        computed then. Unless given, all sets of normals, or the shape's own where ``scales`` is 0.

    Raises
    ------
    MeshdepictError
        For a need or a light that is unknown, and a function that does not take a space, a light,
        and its options by keyword.
    """
    if light not in LIGHTS and (lights == "one" or light not in RIGS):
        several = () if lights == "one" else RIGS
        known = (*LIGHTS, *several)
        raise MeshdepictError(
            f"a method can't be shown under {light!r}{nearest(light, known)} (there are "
            f"{', '.join(known)})"
        )
    wanted = frozenset(needs)
    for word in wanted - set(NEEDS):
        raise MeshdepictError(
            f"a method can't need {word!r}{nearest(word, NEEDS)} (it may need {', '.join(NEEDS)})"
        )

    def declare(function: Function) -> Function:
        name, others = _name(function), inspect.signature(function).parameters
        seen = {"view"} & set(others)
        ours = function.__module__.partition(".")[0] == __name__.partition(".")[0]

        @functools.wraps(function)
        def shade(space: Any, light: Any = None, *, two_sided: bool = False, **given: Any) -> Any:
            if not hasattr(space, "widths"):
                raise MeshdepictError(
                    f"{name} shades a ScaleSpace, not a {type(space).__name__}: make one with "
                    "scale_space, or let bake do so"
                )
            if two_sided is not False:
                space = _seen_side(space, two_sided, given, sees="view" in others)
            known = options_of(function)
            options = {
                key: value for key, value in given.items() if key in known or key not in others
            }
            values = function(space, light, **{**given, **check(function, options, name)})
            return values if ours else _proper(values, space.count, name)

        shade.declaration = Declaration(  # type: ignore[attr-defined]
            scales, ratio, linear, source, local, lights, wanted | seen,
            None if compared is None else MappingProxyType(dict(compared)), light, fits,
            ground, _with_defaults(function, reads or (_all_sets if scales else _own_normals)),
        )  # fmt: skip
        shade.__doc__ = completed(function, lights=lights, linear=linear)
        return cast("Function", shade)

    return declare


def _with_defaults(
    function: Function, reads: Callable[..., Reads]
) -> Callable[[int, Mapping[str, Any]], Reads]:
    """Return what a function reads, given some of its options."""
    parameters = inspect.signature(function).parameters.values()
    usual = {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY}

    def declared(last: int, options: Mapping[str, Any]) -> Reads:
        return reads(last, **{**usual, **options})

    return declared


def _seen_side(
    space: ScaleSpace, two_sided: object, given: dict[str, Any], *, sees: bool
) -> ScaleSpace:
    """Return a scale space turned to the eye: what every method does if it is ``two_sided``."""
    from meshdepict.scales.seen_side import SeenSide
    from meshdepict.scene.names import as_view

    if two_sided is not True:
        raise MeshdepictError(f"two_sided={two_sided!r} is neither True nor False")
    view = given.get("view", "front") if sees else given.pop("view", "front")
    return SeenSide(space, as_view(view, space.shape))


def _name(function: Callable[..., Any]) -> str:
    """Return the name of what is to be a method; refuse what can't be called as one."""
    if not inspect.isfunction(function):
        raise MeshdepictError(f"md.method makes methods of functions, not of {function!r:.80}")
    kinds = [(p.kind, p.default) for p in inspect.signature(function).parameters.values()]
    positional, rest = kinds[:2], kinds[2:]
    fits = len(positional) == 2 and all(
        kind in (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
        for kind, _ in positional
    )
    required = inspect.Parameter.empty
    if not fits or any(
        kind is not inspect.Parameter.KEYWORD_ONLY or default is required for kind, default in rest
    ):
        raise MeshdepictError(
            f"{function.__name__} can't be a method as it is: let it take a space, a light, and "
            "after a * its options, each with a default: (space, light, *, exposure=1.0)"
        )
    return function.__name__


def _proper(values: ArrayLike, count: int, name: str) -> NDArray[Any]:
    """Return what a function of others gave back, in floats; refuse what can't be shown."""
    array = np.asarray(values)
    if array.shape not in ((count,), (count, 3)) or array.dtype.kind not in "fiub":
        raise MeshdepictError(
            f"{name} returned {array.dtype} {array.shape} for {count} samples: let it return "
            f"numbers, ({count},) or ({count}, 3)"
        )
    array = array if array.dtype.kind == "f" else array.astype(np.float32)
    if not ((array >= 0) & (array <= 1)).all():
        raise MeshdepictError(
            f"{name} returned values that are not in [0, 1], or no numbers: let it end with "
            "np.clip(values * exposure, 0, 1)"
        )
    return array


def declaration(function: Callable[..., Any]) -> Declaration:
    """Return what a shading function declared."""
    return function.declaration  # type: ignore[attr-defined]


def is_method(function: object) -> bool:
    """Whether something is a shading function that was declared by `method`."""
    return callable(function) and isinstance(getattr(function, "declaration", None), Declaration)


def exposed(values: NDArray[Any], exposure: float) -> NDArray[Any]:
    """Multiply by the exposure and clip to [0, 1]: the last step of every method."""
    return np.clip(values * values.dtype.type(exposure), 0, 1)


def require_smoothing(space: ScaleSpace, what: str, *, scales: int) -> None:
    """Refuse a scale space without any smoothed normals, saying how many are usual."""
    if len(space.widths) < 2:
        raise MeshdepictError(f"{what} needs at least one scale; make more with scales={scales}")
