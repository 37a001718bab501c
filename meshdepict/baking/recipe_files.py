"""Files that a recipe names: panoramas, lit spheres, transfer functions. They lie beside it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.files.pictures import is_picture
from meshdepict.files.reach import inside
from meshdepict.options import Choice, Values, options_of
from meshdepict.shading.registry import find_method

__all__ = ["files_named", "located", "named_from"]


def located(
    chosen: Mapping[str, Any], function: Callable[..., Any], recipe: str | os.PathLike[str]
) -> dict[str, Any]:
    """Return what a recipe holds with the files that it names as paths from the current folder.

    Parameters
    ----------
    chosen : mapping
        Choices and options by name.
    function : callable
        The shading function whose options they are.
    recipe : path

    Raises
    ------
    MeshdepictError
        For a file that lies neither in the recipe's folder nor below.
    """
    folder = Path(recipe).parent

    def locate(name: str, what: str) -> str:
        try:
            return str(inside(folder, name, what))
        except MeshdepictError as error:
            raise MeshdepictError(f"{recipe} {error}") from None

    return _changed(chosen, function, locate)


def named_from(
    chosen: Mapping[str, Any], function: Callable[..., Any], recipe: str | os.PathLike[str]
) -> dict[str, Any]:
    """Return the same with paths from the recipe's folder: what `located` takes back.

    Raises
    ------
    MeshdepictError
        For a file that lies elsewhere: the recipe could not be read again.
    """
    folder = os.path.abspath(Path(recipe).parent)

    def name_of(path: str, what: str) -> str:
        try:
            name = os.path.relpath(os.path.abspath(path), folder)
        except ValueError:  # on another drive
            name = os.pardir
        if Path(name).parts[:1] == (os.pardir,):
            raise MeshdepictError(
                f"{recipe}: a recipe names only files in its own folder or below, and the {what} "
                f"{path} is elsewhere: copy it there first"
            )
        return Path(name).as_posix()

    return _changed(chosen, function, name_of)


def files_named(chosen: Mapping[str, Any], function: Callable[..., Any]) -> list[str]:
    """Return the files that choices and options name, in no other order than theirs."""
    found: list[str] = []

    def meet(path: str, what: str) -> str:
        found.append(path)
        return path

    _changed(chosen, function, meet)
    return found


def _changed(
    chosen: Mapping[str, Any], function: Callable[..., Any], change: Callable[[str, str], str]
) -> dict[str, Any]:
    """Return choices and options with the names of files changed."""
    changed = dict(chosen)
    for name, suffix, what in (
        ("light", ".hdr", "panorama"),
        ("transfer", ".toml", "transfer function"),
    ):
        given = changed.get(name)
        if isinstance(given, str) and given.lower().endswith(suffix):
            changed[name] = change(given, what)
    if isinstance(changed.get("blend"), (list, tuple)):
        changed["blend"] = [_changed_layer(layer, change) for layer in changed["blend"]]
    for name, option in options_of(function).items():
        given, accepts = changed.get(name), option.accepts
        if isinstance(accepts, Values) and isinstance(given, str) and is_picture(given):
            changed[name] = change(given, name.replace("_", " "))
        if not isinstance(accepts, Choice) or Path not in accepts.also:
            continue
        if isinstance(given, (str, Path)) and given not in accepts.names:
            changed[name] = change(os.fspath(given), name.replace("_", " "))
    return changed


def _changed_layer(layer: Any, change: Callable[[str, str], str]) -> Any:
    """Return a layer's table with the names of files changed; what is none is refused later."""
    if not isinstance(layer, Mapping) or not isinstance(layer.get("options", {}), Mapping):
        return layer
    function = find_method(layer.get("method", ""))
    chosen = {**layer.get("options", {}), "light": layer.get("light")}
    chosen = _changed(chosen, function, change)
    light = chosen.pop("light")
    return {**layer, "options": chosen, **({} if light is None else {"light": light})}
