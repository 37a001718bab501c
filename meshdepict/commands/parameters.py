"""Words of the command line that several commands take, and how they become values.

The words of a look are those of `Choices`, the only list of them: a command says which it takes. A
word that was not said is None, so that defaults stand in one place, too.
"""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from cyclopts import Group, Parameter

from meshdepict import threads
from meshdepict.baking.choice_list import AUTO, choice_fields
from meshdepict.baking.choices import Choices
from meshdepict.commands.values import as_light, method_options
from meshdepict.files import limits

if TYPE_CHECKING:
    from meshdepict.baking.look import Look
    from meshdepict.drawing.figure import Figure

__all__ = [
    "EVERYWHERE", "FIGURE", "FILES", "LOOK", "MOTION", "Everywhere", "FigureWords",
    "LookWords", "Number", "Options", "number", "said_look", "spelled_out", "takes_words",
]  # fmt: skip

_GROUPS = {
    name: Group(name, sort_key=place)
    for place, name in enumerate(("Files", "Motion", "Look", "Detail", "Figure", "Everywhere"))
}
FILES, MOTION, LOOK, DETAIL, FIGURE, EVERYWHERE = _GROUPS.values()

Command = TypeVar("Command", bound=Callable[..., Any])


def whole(_: Any, tokens: Sequence[Any]) -> int:
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


Number = Annotated[
    float | None, Parameter(converter=number, group=FILES, allow_leading_hyphen=True)
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


# --- everywhere -------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Everywhere:
    """What every command takes."""

    quiet: Annotated[
        bool, Parameter(group=EVERYWHERE, show_default=False, help="No notes and no progress bar.")
    ] = False
    cores: Annotated[
        int | None,
        Parameter(
            name="--threads",
            converter=whole,
            group=EVERYWHERE,
            help="Cores to use; all unless given.",
        ),
    ] = None
    max_memory: Annotated[
        str | None,
        Parameter(
            group=EVERYWHERE,
            help="What a file's contents, or a window of terrain, may take, 4GB for instance; "
            "unless given, a hundred times the file's size and half of the memory at most.",
        ),
    ] = None

    def obey(self) -> None:
        """Limit what the program may take of the machine."""
        threads.limit(self.cores)
        limits.set_max_memory(self.max_memory)


# --- figures ----------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class FigureWords:
    """How a picture is laid out; see `Figure`."""

    size: Annotated[
        str | None,
        Parameter(
            group=FIGURE,
            help="Width and height: 1200x900 in pixels; 12x9cm, 120x90mm, 5x4in or A4 on paper.",
        ),
    ] = None
    dpi: Annotated[
        float | None,
        Parameter(
            converter=number,
            group=FIGURE,
            help="Dots per inch on paper; 300 unless given where the size is on paper.",
        ),
    ] = None
    background: Annotated[
        str | None,
        Parameter(
            group=FIGURE,
            help="white or another name that CSS has, paper (pale: white parts show), transparent "
            "or #rrggbb; unless given white, and paper for methods that leave much white.",
        ),
    ] = None
    scale_bar: Annotated[
        bool, Parameter(group=FIGURE, show_default=False, help="Draw a scale bar below the object.")
    ] = False
    unit: Annotated[
        str | None,
        Parameter(
            group=FIGURE,
            help="Of the file's coordinates, for the scale bar: mm, m, µm; unless given, as the "
            "file says.",
        ),
    ] = None
    pixels_per_unit: Annotated[
        float | None,
        Parameter(
            converter=number,
            group=FIGURE,
            help="Same scale for all objects; the pictures grow as needed unless --size is given.",
        ),
    ] = None
    caption: Annotated[
        str | None,
        Parameter(
            group=FIGURE,
            help="A text below the picture; auto: method, light and widths.",
        ),
    ] = None

    @property
    def said(self) -> dict[str, Any]:
        """What was said, by name."""
        return {name: value for name, value in vars(self).items() if value not in (None, False)}

    def figure(self, **usual: Any) -> Figure:
        """Return the figure; what was not said is as usual for the command."""
        from meshdepict.drawing.figure import Figure

        return Figure(**{**usual, **self.said})


# --- looks ------------------------------------------------------------------------------------


def _name(each: dataclasses.Field[Any]) -> str:
    return f"--{each.name.replace('_', '-')}"


def _literal(hint: Any) -> Any:
    """Return the part of a type that lists values, or None."""
    kinds = (hint, *typing.get_args(hint))
    return next((kind for kind in kinds if typing.get_origin(kind) is Literal), None)


def _word(each: dataclasses.Field[Any], hint: Any) -> tuple[str, Any, None]:
    """Return a choice as a word of the command line: its name, its type and None."""
    kinds, literal = typing.get_args(hint) or (hint,), _literal(hint)
    converter: Any = None
    if literal is not None:
        kind = literal
    elif bool in kinds:
        kind = bool
    elif int in kinds:
        kind, converter = int, whole
    elif float in kinds and str not in kinds:
        kind, converter = float, number
    else:
        kind = str
    default = AUTO if each.name in ("view", "up") else each.default
    usual = "" if default in (None, False) else f" [default: {default}]"
    names = {"method": ["--method", "-m"], "colormap2d": "--colormap2d"}
    parameter = Parameter(
        name=names.get(each.name, _name(each)),
        converter=converter,
        group=_GROUPS[each.metadata["group"]],
        allow_leading_hyphen=True,
        help=each.metadata["help"] + usual,
        show_default=False,
    )
    return each.name, Annotated[kind | None, parameter], None


def spelled_out(words: Sequence[str]) -> tuple[str, ...]:
    """Return the words of a command line, with a value after each that may stand alone."""
    hints, found = typing.get_type_hints(Choices), list(words)
    for each in choice_fields().values():
        usual, word = each.metadata["alone"], _name(each)
        if usual and word in found:
            at = found.index(word)
            if not {*found[at + 1 : at + 2]} & {*typing.get_args(_literal(hints[each.name]))}:
                found[at] = f"{word}={usual}"
    return tuple(found)


class LookWords:
    """What was said of a look; a command has those fields that it takes."""

    options: list[str] | None = None

    @property
    def said(self) -> dict[str, Any]:
        """What was said, by name, but for the method's options."""
        said = {
            name: getattr(self, name)
            for name in choice_fields()
            if getattr(self, name, None) is not None
        }
        if "light" in said:
            said["light"] = as_light(said["light"])
        return said


def takes_words(
    *, without: Sequence[str] = (), options: bool = True
) -> Callable[[Command], Command]:
    """Give a command the words that its `LookWords`, `FigureWords` and `Everywhere` stand for.

    Parameters
    ----------
    without : sequence of str
        Choices of a look that the command has not.
    options : bool
        Whether it has ``--set``.
    """

    def dress(command: Command) -> Command:
        classes = {"LookWords": None, "FigureWords": FigureWords, "Everywhere": Everywhere}
        for name, hint in command.__annotations__.items():
            if hint in classes:
                kind: Any = classes[hint] or _look_words(without, options=options)
                command.__annotations__[name] = Annotated[kind, Parameter(name="*")]
                command.__kwdefaults__ = {**(command.__kwdefaults__ or {}), name: kind()}
        return command

    return dress


def _look_words(without: Sequence[str], *, options: bool) -> Any:
    hints = typing.get_type_hints(Choices)
    fields = [
        _word(each, hints[each.name])
        for each in choice_fields().values()
        if each.name not in without
    ]
    more = [("options", Options, None)] if options else []
    return dataclasses.make_dataclass(
        "Look", fields + more, bases=(LookWords,), kw_only=True, frozen=True,
        namespace={"__doc__": "What was said of a look.", "__module__": __name__},
    )  # fmt: skip


def said_look(words: LookWords, recipe: str | None = None) -> Look:
    """Return the look that was asked for: a recipe's, with what was said in its place."""
    from meshdepict.baking.look import Look
    from meshdepict.baking.recipe import load_recipe, merge_recipe

    chosen: Mapping[str, Any] = words.said
    usual: dict[str, Any] = {"view": AUTO, "up": AUTO}  # in Python nothing changes with the shape
    if recipe is not None:
        read = load_recipe(recipe)
        if "view" in read:
            del usual["up"]  # a recipe says both, but for an axis that is up as usual
        chosen = merge_recipe(read, chosen)
    chosen = {**usual, **chosen}
    method = chosen.get("method", choice_fields()["method"].default)
    options = method_options(method, words.options or [])
    return Look(**{**chosen, "method": method, **options})
