"""Words of the command line that several commands take, and how they become values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from cyclopts import Group, Parameter

from meshdepict.errors import MeshdepictError

__all__ = [
    "DETAIL", "EVERYWHERE", "FIGURE", "FILES", "LOOK", "MOTION", "Background", "Colormap",
    "Cores", "Dpi", "Facing", "LightText", "Method", "Number", "Options", "PixelsPerUnit",
    "Quiet", "Ratio", "Refine", "ScaleBar", "Scales", "Size", "Tolerance", "Unit", "Up",
    "View", "Width", "as_light", "as_numbers", "method_options", "number",
    "session_settings",
]  # fmt: skip

FILES, MOTION, LOOK, DETAIL, FIGURE, EVERYWHERE = (
    Group(name, sort_key=place)
    for place, name in enumerate(("Files", "Motion", "Look", "Detail", "Figure", "Everywhere"))
)


def _whole(_: Any, tokens: Sequence[Any]) -> int:
    """Convert a whole number strictly; cyclopts would round 1.5 to 2."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"{tokens[0].value!r} is not a whole number") from None


def number(_: Any, tokens: Sequence[Any]) -> float:
    """Convert a number."""
    try:
        return float(tokens[0].value)
    except ValueError:
        raise ValueError(f"{tokens[0].value!r} is not a number") from None


Quiet = Annotated[
    bool, Parameter(group=EVERYWHERE, show_default=False, help="No notes and no progress bar.")
]
Cores = Annotated[
    int | None,
    Parameter(
        name="--threads",
        converter=_whole,
        group=EVERYWHERE,
        help="Cores to use; all unless given.",
    ),
]

Method = Annotated[
    str,
    Parameter(
        name=["--method", "-m"],
        group=LOOK,
        help="How to shade: meshdepict methods lists what there is.",
    ),
]
LightText = Annotated[
    str,
    Parameter(
        name="--light",
        group=LOOK,
        allow_leading_hyphen=True,
        help="A name (north, northeast, … northwest, front), azimuth,elevation in degrees, x,y,z, "
        "or a panorama.hdr; several, where a method takes them, parted by semicolons.",
    ),
]
View = Annotated[
    str,
    Parameter(
        group=LOOK,
        help="Where names of lights and the picture look from: front, back, left, right, top, "
        "bottom or isometric.",
    ),
]
Up = Annotated[
    Literal["y", "z", "-y", "-z"],
    Parameter(group=LOOK, allow_leading_hyphen=True, help="Axis of the object that points up."),
]
Options = Annotated[
    list[str] | None,
    Parameter(
        name="--set",
        group=LOOK,
        help="An option of the method as name=value; meshdepict methods NAME lists them. "
        "Repeatable.",
    ),
]
Colormap = Annotated[
    str | None,
    Parameter(group=LOOK, help="Colours for dark to bright; grey unless given."),
]
Scales = Annotated[
    int | None,
    Parameter(
        converter=_whole,
        group=DETAIL,
        help="How often to smooth; unless given, as often as the method wants.",
    ),
]
Width = Annotated[
    str | None,
    Parameter(
        group=DETAIL,
        allow_leading_hyphen=True,
        help="First smoothing width in the file's units, or a share of the diagonal such as 0.2%; "
        "unless given, the median edge.",
    ),
]
Ratio = Annotated[
    float | None,
    Parameter(converter=number, group=DETAIL, help="From one width to the next."),
]
Facing = Annotated[
    Literal[0, 1],
    Parameter(
        group=DETAIL,
        help="1 keeps the two sides of thin sheets apart; 0 is the plain sum of the paper.",
    ),
]
Tolerance = Annotated[
    float,
    Parameter(converter=number, group=DETAIL, help="Largest error of a normal, in radians."),
]
Number = Annotated[
    float | None, Parameter(converter=number, group=FILES, allow_leading_hyphen=True)
]
Refine = Annotated[
    float | None,
    Parameter(
        converter=number,
        group=DETAIL,
        help="Split triangles inside which colours would be off by more than so many of 255 grey "
        "levels, 2 for instance.",
    ),
]

Size = Annotated[
    str | None,
    Parameter(
        group=FIGURE,
        help="Width and height: 1200x900 in pixels; 12x9cm, 120x90mm or 5x4in on paper.",
    ),
]
Dpi = Annotated[
    float | None,
    Parameter(
        converter=number,
        group=FIGURE,
        help="Dots per inch on paper; 300 unless given where the size is on paper.",
    ),
]
Background = Annotated[
    str,
    Parameter(group=FIGURE, help="white, paper (pale: white parts show), transparent or #rrggbb."),
]
ScaleBar = Annotated[
    bool, Parameter(group=FIGURE, show_default=False, help="Draw a scale bar below the object.")
]
Unit = Annotated[
    str, Parameter(group=FIGURE, help="Of the file's coordinates, for the scale bar: mm, m, µm.")
]
PixelsPerUnit = Annotated[
    float | None,
    Parameter(
        converter=number,
        group=FIGURE,
        help="Same scale for all objects; the pictures grow as needed unless --size is given.",
    ),
]


def as_light(text: str) -> Any:
    """Return a light's name, its angles or its direction; several where semicolons part them."""
    if ";" in text:
        return [as_light(part.strip()) for part in text.split(";") if part.strip()]
    if "," not in text:
        return text
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in (2, 3):
        raise MeshdepictError(
            f"--light {text} is neither a name, nor azimuth,elevation in degrees, nor x,y,z"
        )
    return numbers


def as_numbers(text: str, option: str, count: int) -> tuple[float, ...]:
    """Return so many numbers from a text such as 0.5,0.5,1."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != count:
        raise MeshdepictError(f"{option} {text} is not {count} numbers separated by commas")
    return numbers


def method_options(method: str, given: Sequence[str]) -> dict[str, Any]:
    """Return the method's options from ``name=value`` texts, checked."""
    from meshdepict.options import check
    from meshdepict.shading.registry import find_method

    function = find_method(method)
    texts = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not equals:
            raise MeshdepictError(f"--set wants name=value, not {text!r}")
        texts[name.strip()] = value.strip()
    return check(function, texts, method)


def session_settings(
    recipe: str, settings: dict[str, Any], given: frozenset[str]
) -> dict[str, Any]:
    """Return the settings of a recipe, what was said first, for a viewer's session.

    Raises
    ------
    MeshdepictError
        For what recipes may have and sessions don't.
    """
    from meshdepict.baking.recipe import load_recipe, merge_recipe

    said = {name: value for name, value in settings.items() if name in given}
    merged = merge_recipe(load_recipe(recipe), said)
    for name, usual in (("colormap2d", None), ("albedo", "none"), ("refine", None)):
        if merged.pop(name, usual) != usual:
            raise MeshdepictError(
                f"{recipe}: views and movies have no {name}; bake it, or take it out of the recipe"
            )
    return merged
