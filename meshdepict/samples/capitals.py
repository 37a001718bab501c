"""Roman capitals as strokes: what a cutter's chisel or a die's engraver follows."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

__all__ = ["ALPHABET", "distance_to_strokes", "strokes"]

Floats = NDArray[np.float64]
Line = list[tuple[float, float]]


def _arc(x: float, y: float, rx: float, ry: float, start: float, end: float) -> Line:
    """Points along an ellipse from an angle to another, in degrees from the right, upwards."""
    angles = np.radians(np.linspace(start, end, max(3, int(abs(end - start) / 15) + 1)))
    return list(
        zip((x + rx * np.cos(angles)).tolist(), (y + ry * np.sin(angles)).tolist(), strict=True)
    )


# Width of each letter, its height being 1, and its strokes from (0, 0), the foot on the left.
_LETTERS: dict[str, tuple[float, list[Line]]] = {
    "A": (0.80, [[(0, 0), (0.4, 1), (0.8, 0)], [(0.16, 0.38), (0.64, 0.38)]]),
    "B": (0.55, [[(0, 0), (0, 1)], [(0, 1), *_arc(0.25, 0.77, 0.25, 0.23, 90, -90), (0, 0.54)],
                 [(0, 0.54), *_arc(0.27, 0.27, 0.28, 0.27, 90, -90), (0, 0)]]),
    "C": (0.75, [_arc(0.5, 0.5, 0.5, 0.5, 50, 310)]),
    "D": (0.75, [[(0, 0), (0, 1)], [(0, 1), *_arc(0.25, 0.5, 0.5, 0.5, 90, -90), (0, 0)]]),
    "E": (0.50, [[(0.5, 1), (0, 1), (0, 0), (0.5, 0)], [(0, 0.52), (0.42, 0.52)]]),
    "F": (0.48, [[(0.48, 1), (0, 1), (0, 0)], [(0, 0.52), (0.4, 0.52)]]),
    "G": (0.80, [[*_arc(0.5, 0.5, 0.5, 0.5, 50, 322), (0.88, 0.45), (0.62, 0.45)]]),
    "H": (0.72, [[(0, 0), (0, 1)], [(0.72, 0), (0.72, 1)], [(0, 0.52), (0.72, 0.52)]]),
    "I": (0.0, [[(0, 0), (0, 1)]]),
    "J": (0.3, [[(0.3, 1), *_arc(0.05, 0.2, 0.25, 0.2, 0, -120)]]),
    "K": (0.62, [[(0, 0), (0, 1)], [(0.56, 1), (0, 0.48), (0.62, 0)]]),
    "L": (0.48, [[(0, 1), (0, 0), (0.48, 0)]]),
    "M": (0.90, [[(0, 0), (0.12, 1), (0.45, 0.1), (0.78, 1), (0.9, 0)]]),
    "N": (0.74, [[(0, 0), (0, 1), (0.74, 0), (0.74, 1)]]),
    "O": (0.98, [_arc(0.49, 0.5, 0.49, 0.5, 0, 360)]),
    "P": (0.52, [[(0, 0), (0, 1), *_arc(0.26, 0.74, 0.26, 0.26, 90, -90), (0, 0.48)]]),
    "Q": (0.98, [_arc(0.49, 0.5, 0.49, 0.5, 0, 360), [(0.5, 0.12), (0.8, -0.12), (1.1, -0.2)]]),
    "R": (0.62, [[(0, 0), (0, 1), *_arc(0.26, 0.75, 0.26, 0.25, 90, -90), (0, 0.5)],
                 [(0.24, 0.5), (0.64, 0)]]),
    "S": (0.48, [[*_arc(0.25, 0.76, 0.23, 0.24, 35, 270)[:-1],
                  *_arc(0.23, 0.26, 0.26, 0.26, 90, -145)]]),
    "T": (0.70, [[(0, 1), (0.7, 1)], [(0.35, 1), (0.35, 0)]]),
    "U": (0.68, [[(0, 1), *_arc(0.34, 0.34, 0.34, 0.34, 180, 360), (0.68, 1)]]),
    "V": (0.78, [[(0, 1), (0.39, 0), (0.78, 1)]]),
    "W": (1.10, [[(0, 1), (0.3, 0), (0.55, 0.85), (0.8, 0), (1.1, 1)]]),
    "X": (0.72, [[(0, 0), (0.72, 1)], [(0, 1), (0.72, 0)]]),
    "Y": (0.72, [[(0, 1), (0.36, 0.5), (0.72, 1)], [(0.36, 0.5), (0.36, 0)]]),
    "Z": (0.62, [[(0, 1), (0.62, 1), (0, 0), (0.62, 0)]]),
    "·": (0.0, [[(0, 0.46), (0, 0.52)]]),
    " ": (0.2, []),
}  # fmt: skip

ALPHABET = "".join(_LETTERS)
"""What can be written: capitals, a point between words, a space."""

_BETWEEN = 0.3  # letters, in heights


def strokes(text: str, where: str) -> tuple[Floats, float]:
    """Return the straight pieces of a line of capitals of height 1 from (0, 0), and its width.

    Parameters
    ----------
    text : str
        Letters of `ALPHABET`; small ones are written as capitals.
    where : str
        Whose text it is, for the error's sentence.

    Returns
    -------
    pieces : (m, 2, 2) array
        Start and end of each piece, x to the right and y up.
    width : float

    Raises
    ------
    MeshdepictError
        For a letter that the alphabet lacks.
    """
    pieces: list[Floats] = []
    right = 0.0
    for letter in text.upper():
        if letter not in _LETTERS:
            raise MeshdepictError(f"{where}: {letter!r} can't be written, only {ALPHABET}")
        width, lines = _LETTERS[letter]
        for line in lines:
            points = np.array(line) + np.array((right, 0.0))
            pieces.append(np.stack((points[:-1], points[1:]), axis=1))
        right += width + _BETWEEN
    joined = np.concatenate(pieces) if pieces else np.empty((0, 2, 2))
    return joined, max(right - _BETWEEN, 0.0)


def distance_to_strokes(x: Floats, y: Floats, pieces: Iterable[Floats], reach: float) -> Floats:
    """Return how far each place is from the nearest piece, `reach` where that is farther.

    Parameters
    ----------
    x, y : (n,) array
    pieces : iterable of (2, 2) array
        Start and end of each.
    reach : float
    """
    found = np.full(len(x), reach)
    for start, end in pieces:
        low, high = np.minimum(start, end) - reach, np.maximum(start, end) + reach
        near = np.flatnonzero((x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1]))
        off = np.stack((x[near], y[near]), axis=1) - start
        along = end - start
        length = along @ along
        share = np.clip(off @ along / length, 0, 1) if length > 0 else np.zeros(len(near))
        away = np.hypot(*(off - share[:, None] * along).T)
        found[near] = np.minimum(found[near], away)
    return found
