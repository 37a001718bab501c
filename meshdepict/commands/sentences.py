"""What is wrong with a command line, in one sentence, and what was probably meant."""

from __future__ import annotations

import difflib
import os
from collections.abc import Sequence

from cyclopts import CycloptsError, UnknownCommandError, UnknownOptionError

__all__ = ["sentence"]

# As close as cyclopts asks for its own suggestions.
_ALIKE = 0.6
# An option of a method that nobody named: --scale is --scales, --strenght no --set.
_NEARLY, _CLEARLY = 0.75, 0.1


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
    text = text.partition(" Available commands")[0]  # of which a few would be listed
    if isinstance(error, UnknownOptionError):
        text = _unknown(error, words) or text
    return f"{text[:1].lower()}{text[1:]} (see {command} --help)"


def _unknown(error: UnknownOptionError, words: Sequence[str]) -> str | None:
    """Name an option of a method where the word is nearer to that than to any of the command.

    Those of the methods that are said come first, then everybody's.
    """
    word = (error.token.keyword or error.token.value).partition("=")[0]
    own = [name for each in error.argument_collection if each.parse for name in each.names]
    if not word.startswith("--") or "--set" not in own:
        return None
    methods = _options()
    said = [name for name in _said(words) if name in methods]
    best = max(_likeness(word, name) for name in own)
    for among, whose, least in (
        (said, "", max(best, _ALIKE)),
        (methods, ", which {} has", max(best + _CLEARLY, _NEARLY)),
    ):
        found = {name: method for method in reversed(among) for name in methods[method]}
        name = max(found, key=lambda name: _likeness(word, _dashed(name)), default="")
        if name and _likeness(word, _dashed(name)) >= least:
            return f"unknown option: {word}. Did you mean --set {name}={whose.format(found[name])}?"
    return None


def _dashed(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _likeness(word: str, name: str) -> float:
    return difflib.SequenceMatcher(None, word, name).ratio()


def _options() -> dict[str, list[str]]:
    """Return the names of every method's options."""
    from meshdepict.options import options_of
    from meshdepict.shading.registry import METHODS

    return {name: list(options_of(function)) for name, function in METHODS.items()}


def _said(words: Sequence[str]) -> list[str]:
    """Return the methods that a command line says, or the one that it would use."""
    from meshdepict.baking.choices import Choices

    said = [
        text
        for word, after in zip(words, (*words[1:], ""), strict=True)
        for name, equals, value in [word.partition("=")]
        if name in {"-m", "--method", "--explain"}
        for text in [value if equals else after]
    ]
    return said or [Choices().method]
