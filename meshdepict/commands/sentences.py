"""What is wrong with a command line, in one sentence, and what was probably meant."""

from __future__ import annotations

import difflib
import os
from collections.abc import Sequence

from cyclopts import CycloptsError, UnknownCommandError, UnknownOptionError

__all__ = ["sentence"]

# As close as cyclopts asks for its own suggestions.
_ALIKE = 0.6


def sentence(error: CycloptsError, words: Sequence[str]) -> str:
    """Return what is wrong with a command line, and where help is."""
    if isinstance(error, UnknownCommandError):
        word = words[0]
        if word.startswith("-"):
            return f"unknown option {word}: options follow the command (see meshdepict --help)"
        if os.path.exists(word):
            return f"no command is called {word!r}; did you mean: meshdepict bake {word}"
    command = " ".join(("meshdepict", *(error.command_chain or ())))
    text = str(error).strip().rstrip(".")
    if isinstance(error, UnknownOptionError):
        text = _unknown(error, words) or text
    return f"{text[:1].lower()}{text[1:]} (see {command} --help)"


def _unknown(error: UnknownOptionError, words: Sequence[str]) -> str | None:
    """Name an option of the method where the word is nearer to that than to any of the command."""
    word = (error.token.keyword or error.token.value).partition("=")[0]
    own = [name for each in error.argument_collection if each.parse for name in each.names]
    if not word.startswith("--") or "--set" not in own:
        return None
    found = {f"--{name.replace('_', '-')}": name for name in _options(words)}
    likeness = {name: difflib.SequenceMatcher(None, word, name).ratio() for name in (*own, *found)}
    nearest = max(likeness, key=lambda name: likeness[name])
    if nearest not in found or likeness[nearest] < _ALIKE:
        return None
    return f"unknown option: {word}. Did you mean --set {found[nearest]}=?"


def _options(words: Sequence[str]) -> list[str]:
    """Return the names of the options of the method that a command line says, or would use."""
    from meshdepict.baking.choices import Choices
    from meshdepict.errors import MeshdepictError
    from meshdepict.options import options_of
    from meshdepict.shading.registry import find_method

    said = [
        text
        for word, after in zip(words, (*words[1:], ""), strict=True)
        for name, equals, value in [word.partition("=")]
        if name in {"-m", "--method"}
        for text in [value if equals else after]
    ]
    method = said[-1] if said else Choices().method
    try:
        return list(options_of(find_method(method)))
    except MeshdepictError:
        return []
