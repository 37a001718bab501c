"""The one exception that wrong input raises, the one warning for odd input, and what both show."""

from __future__ import annotations

import re

__all__ = ["MeshdepictError", "MeshdepictWarning", "printable"]

# What moves a terminal's cursor, colours or renames it, or turns the direction of reading: control
# characters of both kinds, marks of direction, line separators.
_UNSEEN = re.compile(r"[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]")


def printable(text: str, *, keep: str = "") -> str:
    r"""Return a text with the characters that steer a terminal spelled out: ``\x1b`` for ESC.

    Names in a file, and names of files, are somebody else's words. Line ends become blanks.

    Parameters
    ----------
    text : str
    keep : str
        Characters to leave as they are, such as line ends.
    """
    return _UNSEEN.sub(lambda found: found[0] if found[0] in keep else _spelled(found[0]), text)


def _spelled(letter: str) -> str:
    return " " if letter in "\t\n\v\f\r" else letter.encode("unicode_escape").decode()


def _words(arguments: tuple[object, ...]) -> tuple[object, ...]:
    return tuple(
        printable(re.sub(r"\s*[\r\n]\s*", " ", word)) if isinstance(word, str) else word
        for word in arguments
    )


class MeshdepictError(ValueError):
    """Wrong input: one readable sentence saying what is wrong, where, and what to do.

    Whatever is quoted in it, an array for instance, it stays one line.
    """

    def __init__(self, *arguments: object) -> None:
        super().__init__(*_words(arguments))


class MeshdepictWarning(UserWarning):
    """Odd but usable input: one readable sentence saying what was assumed."""

    def __init__(self, *arguments: object) -> None:
        super().__init__(*_words(arguments))
