"""Recipes: how a bake looks, in a small TOML file that gives the same bake anywhere, later."""

from __future__ import annotations

import json
import math
import os
import tomllib
from collections.abc import Mapping
from os.path import exists
from pathlib import Path
from typing import Any

from meshdepict.baking.accuracy import ADJUSTABLE, NORMAL
from meshdepict.baking.choice_list import choice_fields
from meshdepict.baking.choices import Choices
from meshdepict.baking.recipe_files import located, named_from
from meshdepict.color.transfer import PRESETS
from meshdepict.color.transfer_function import TransferFunction
from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.mark import VERSION
from meshdepict.files.reach import regular
from meshdepict.options import check, nearest, options_of
from meshdepict.scene.light import Light
from meshdepict.scene.rig import Rig
from meshdepict.scene.view import VIEWS, View
from meshdepict.shading.method import declaration
from meshdepict.shading.registry import find_method

__all__ = ["load_recipe", "merge_recipe", "save_recipe"]

_SIGHT = ("position", "focus", "up", "height_px", "field_of_view", "parallel_scale")

_MARK = "# meshdepict recipe"


def load_recipe(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read a recipe as keyword arguments of `bake`: ``bake(mesh, **load_recipe("look.toml"))``.

    Files that it names are looked for in its own folder, and below. Where it does not say how a
    panorama is sampled, it is as version 0.1 did.

    Raises
    ------
    MeshdepictError
        Where the file can't be read, is no TOML, holds what `bake` doesn't know, or names a file
        that lies elsewhere.
    """
    regular(path)
    try:
        text = Path(path).read_text(encoding="utf-8")
        read = tomllib.loads(text, parse_float=_finite)
    except OSError as error:
        raise MeshdepictError(f"{path} can't be read: {error.strerror}") from None
    except RecursionError:
        raise MeshdepictError(f"{path} is no recipe: it nests too deep") from None
    except UnicodeDecodeError:
        raise MeshdepictError(
            f"{path} is no recipe: it is no text. How a mesh was baked says meshdepict info"
        ) from None
    except ValueError as error:  # TOML's, those of letters, and of numbers of 5,000 digits
        raise MeshdepictError(f"{path} is no recipe in TOML: {error}") from None
    options = read.pop("options", {})
    for name in read:
        if name not in choice_fields():
            raise MeshdepictError(
                f"{path}: recipes have no {name!r}{nearest(name, choice_fields())} (they have "
                f"{', '.join(choice_fields())} and the table [options])"
            )
    if not isinstance(options, Mapping):
        raise MeshdepictError(f"{path}: options must be a table, [options]")
    method = read.setdefault("method", choice_fields()["method"].default)
    try:
        function = find_method(method)
    except MeshdepictError as error:
        raise MeshdepictError(
            f"{path}: {error}; one of your own is known by its name once a package offers it as an "
            "entry point of meshdepict.methods"
        ) from None
    options = check(function, options, f"{path}: {method}")
    if isinstance(read.get("view"), Mapping):
        read["view"] = _view(path, read["view"])
    if isinstance(read.get("light"), Mapping):
        read["light"] = _rig(path, read["light"])
    if isinstance(read.get("light"), list):
        read["light"] = tuple(read["light"])
    if "sampling" not in read and _is_panorama(read.get("light")):
        read["sampling"] = "lights"  # of version 0.1, which had nothing else
    return located({**read, **options}, function, path)


def _is_panorama(light: object) -> bool:
    return isinstance(light, str) and light.lower().endswith(".hdr")


def _finite(text: str) -> float:
    """Return a number; TOML has nan and inf, too, which no choice and no option can be."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is not a finite number")
    return number


def merge_recipe(recipe: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return a recipe with what was given in its place; another method drops its options.

    It drops the recipe's blend, too; and another blend drops the recipe's method. Another accuracy,
    or a budget, drops the numbers that the recipe's own accuracy stands for.
    """
    if given.get("accuracy", given.get("budget")) is not None:
        recipe = _without_accuracy(recipe)
    dropped = set()
    if given.get("method", recipe["method"]) != recipe["method"]:
        dropped = {"blend"}
    elif given.get("blend") is not None and "method" not in given:
        dropped = {"method", "blend"}
    if dropped:
        kept = choice_fields().keys() - dropped
        recipe = {name: value for name, value in recipe.items() if name in kept}
    return {**recipe, **given}


def _without_accuracy(recipe: Mapping[str, Any]) -> dict[str, Any]:
    """Return a recipe without its accuracy and without those numbers that this chose."""
    kept = {name: value for name, value in recipe.items() if name not in ("accuracy", "budget")}
    free = {name: value for name, value in kept.items() if name not in ADJUSTABLE}
    usual = Choices(**free, accuracy=recipe.get("accuracy", NORMAL))
    known = {name: option.default for name, option in options_of(usual.function).items()}
    known |= {name: getattr(usual, name) for name in choice_fields()} | dict(usual.options)
    known["scales"], known["ratio"] = usual.ladder
    same = {name for name in kept.keys() & {*ADJUSTABLE} if kept[name] == known.get(name)}
    return {name: value for name, value in kept.items() if name not in same}


def save_recipe(
    path: str | os.PathLike[str],
    look: Choices | Mapping[str, Any],
    *,
    force: bool = False,
) -> None:
    """Write a look as a recipe, today's defaults included.

    Left out is only what follows from the shape: a width that is the median edge, and which axis
    is up where nobody said.

    Parameters
    ----------
    path : path
    look : Choices or mapping
        A mapping has the keywords of `bake`.
    force : bool
        Whether to replace a file that is no recipe.

    Raises
    ------
    MeshdepictError
        For settings that no file can hold, such as a material, or a file that lies elsewhere than
        in the recipe's folder or below, and where the file may not be replaced or written.
    """
    path = Path(path)
    look = look if isinstance(look, Choices) else Choices(**look)
    declared = look.declared
    fields = {name: getattr(look, name) for name in choice_fields()}
    if look.budget is not None:  # which chooses them anew for each shape
        free = fields.keys() & {*ADJUSTABLE} - look.words().keys()
        fields.update(dict.fromkeys(free))
    if look.blend is not None:  # scales, ratio and light are as each layer declares
        fields["blend"] = _layers(look)
    else:
        if look.budget is None or not {"scales", "ratio"}.isdisjoint(look.words()):
            if look.scales is None or declared.scales == 0:
                fields["scales"] = declared.scales
            fields["ratio"] = look.ratio or declared.ratio
        fields["light"] = look.lit_by
    if isinstance(look.light, Light):
        fields["light"] = _light(look.light)
    elif isinstance(look.light, Rig):
        fields["light"] = look.light.words()
    if isinstance(look.view, View) and look.view.name in VIEWS:
        fields["view"] = look.view.name
    elif isinstance(look.view, View):
        sight = ((name, getattr(look.view, name)) for name in _SIGHT)
        fields["view"] = {name: value for name, value in sight if value is not None}
    if isinstance(look.transfer, TransferFunction) and look.transfer.name in PRESETS:
        fields["transfer"] = look.transfer.name
    options = {name: option.default for name, option in options_of(look.function).items()}
    options |= look.options
    if look.budget is not None:
        options.update(dict.fromkeys(options.keys() & {*ADJUSTABLE} - look.words().keys()))
    options = named_from(options, look.function, path)
    fields = named_from(fields, look.function, path)
    lines = [f"{_MARK}, written by version {VERSION}", *_lines(fields)]
    text = "\n".join([*lines, "", "[options]", *_lines(options), ""])
    if not force and exists(path) and not _is_recipe(path):
        raise MeshdepictError(
            f"{path} exists and is no recipe: choose another name, or replace it with --force"
        )
    with atomic_write(path) as stream:
        stream.write(text.encode())


def _light(light: Light) -> list[float] | str:
    """Return what makes a light again: its direction, and the spread of a disc."""
    direction = light.direction.tolist()
    return f"{','.join(map(repr, direction))}:{light.spread!r}" if light.spread else direction


def _layers(look: Choices) -> list[dict[str, Any]]:
    """Return the layers of a blend as tables, today's defaults included."""
    return [
        layer.recorded(
            look.of_layer(layer).options,
            declaration(layer.function).light if look.light is None else None,
        )
        for layer in look.layers
    ]


def _is_recipe(path: Path) -> bool:
    try:
        regular(path)
        with path.open("rb") as stream:
            return stream.read(len(_MARK)) == _MARK.encode()
    except (OSError, MeshdepictError):
        return False


def _view(path: str | os.PathLike[str], fields: Mapping[str, Any]) -> View:
    for name in fields:
        if name not in _SIGHT:
            raise MeshdepictError(
                f"{path}: a view has no {name!r}{nearest(name, _SIGHT)} "
                f"(it has {', '.join(_SIGHT)})"
            )
    try:
        return View(**fields)
    except (MeshdepictError, TypeError) as error:
        raise MeshdepictError(f"{path}: {error}") from None


def _rig(path: str | os.PathLike[str], words: Mapping[str, Any]) -> Rig:
    try:
        return Rig.of(words)
    except MeshdepictError as error:
        raise MeshdepictError(f"{path}: {error}") from None


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{name} = {_value(name, value)}" for name, value in table.items() if value is not None]


def _value(name: str, value: object) -> str:
    """Return a value as TOML writes it."""
    if isinstance(value, Mapping):
        return (
            "{ " + ", ".join(f"{key} = {_value(key, item)}" for key, item in value.items()) + " }"
        )
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist"):
        items = value.tolist() if hasattr(value, "tolist") else value
        if isinstance(items, (list, tuple)):
            return "[" + ", ".join(_value(name, item) for item in items) + "]"
        value = items
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return repr(value)
    raise MeshdepictError(f"a recipe can't hold {name}={value!r}: give it by name or in numbers")
