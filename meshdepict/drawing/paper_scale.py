"""Scales on paper, such as 1:2: they need the unit of the coordinates and the dots of an inch."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from meshdepict.errors import MeshdepictError
from meshdepict.voxels.length_unit import MILLIMETRES

if TYPE_CHECKING:
    from meshdepict.drawing.figure import Figure

__all__ = ["PaperScale", "paper_scale", "pixels_at"]

_RATIO = re.compile(r"(\d+(?:\.\d+)?)\s*[:/]\s*(\d+(?:\.\d+)?)")
_INCH = 25.4  # mm


@dataclass(frozen=True)
class PaperScale:
    """How many pixels a unit takes at 1:1."""

    life: float

    def text(self, pixels_per_unit: float) -> str:
        """Return a scale in words: "1:2.5", "2:1"."""
        ratio = pixels_per_unit / self.life
        return f"{ratio:.4g}:1" if ratio > 1 + 1e-9 else f"1:{1 / ratio:.4g}"

    def rounded(self, pixels_per_unit: float) -> float:
        """Return the next smaller scale of two digits, 1:2.4 for 1:2.37, in pixels per unit."""
        ratio = pixels_per_unit / self.life
        if ratio >= 1:
            return self.life * _two_digits(ratio, math.floor)
        return self.life / _two_digits(1 / ratio, math.ceil)

    def fitting(self, pixels_per_unit: float) -> str:
        """Return the largest plain scale that isn't larger than this one."""
        ratio = pixels_per_unit / self.life
        return f"{math.floor(ratio)}:1" if ratio >= 1 else f"1:{math.ceil(1 / ratio)}"


def _two_digits(number: float, rounding: Callable[[float], int]) -> float:
    digits = 1 - math.floor(math.log10(number))
    return round(rounding(round(number * 10.0**digits, 9)) * 10.0**-digits, 12)


def paper_scale(figure: Figure, unit: str) -> PaperScale | None:
    """Return what scales on paper are measured by, None where unit or paper isn't known."""
    if figure.dpi is None or unit not in MILLIMETRES:
        return None
    return PaperScale(MILLIMETRES[unit] * figure.dpi / _INCH)


def pixels_at(scale: str, figure: Figure, unit: str) -> float:
    """Return the pixels per unit of a scale such as "1:2".

    Raises
    ------
    MeshdepictError
        For any other text, and where unit or paper isn't known.
    """
    match = _RATIO.fullmatch(str(scale).strip())
    if match is None or not all(float(number) for number in match.groups()):
        raise MeshdepictError(f"scale={scale!r} is not a scale on paper such as 1:2 or 2:1")
    paper = paper_scale(figure, unit)
    if paper is None and figure.dpi is None:
        raise MeshdepictError(
            f"a scale of {scale} needs a size on paper, such as A4 or 210x297mm, or dots per inch"
        )
    if paper is None:
        raise MeshdepictError(
            f"a scale of {scale} needs the unit of the coordinates, which the file doesn't say: "
            "give it, --unit mm for instance"
        )
    return paper.life * float(match[1]) / float(match[2])
