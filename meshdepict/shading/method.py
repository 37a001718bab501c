"""What a shading method declares beside its function: what it needs, and how its values read."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range, check, options_of

__all__ = ["Declaration", "Exposure", "declaration", "exposed", "method", "require_smoothing"]

Function = TypeVar("Function", bound=Callable[..., Any])

Exposure = Annotated[float, Range(0, 1e6, help="factor on the result before clipping", soft=(0, 4))]


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
    """

    scales: int
    ratio: float
    linear: bool
    source: str
    local: bool = True


def method(
    *,
    scales: int = 0,
    ratio: float = math.sqrt(2),
    linear: bool = False,
    local: bool = True,
    source: str,
) -> Callable[[Function], Function]:
    """Declare a shading function: its scales, the kind of its values and its paper.

    The function then refuses wrong options, and anything but a scale space, with one sentence.
    """

    def declare(function: Function) -> Function:
        name, others = function.__name__, inspect.signature(function).parameters

        @functools.wraps(function)
        def shade(space: Any, light: Any = None, **given: Any) -> Any:
            if not hasattr(space, "widths"):
                raise MeshdepictError(
                    f"{name} shades a ScaleSpace, not a {type(space).__name__}: make one with "
                    "scale_space, or let bake do so"
                )
            known = options_of(function)
            options = {
                key: value for key, value in given.items() if key in known or key not in others
            }
            return function(space, light, **{**given, **check(function, options, name)})

        shade.declaration = Declaration(scales, ratio, linear, source, local)  # type: ignore[attr-defined]
        return cast("Function", shade)

    return declare


def declaration(function: Callable[..., Any]) -> Declaration:
    """Return what a shading function declared."""
    return function.declaration  # type: ignore[attr-defined]


def exposed(values: NDArray[Any], exposure: float) -> NDArray[Any]:
    """Multiply by the exposure and clip to [0, 1]: the last step of every method."""
    return np.clip(values * values.dtype.type(exposure), 0, 1)


def require_smoothing(space: Any, what: str, *, scales: int) -> None:
    """Refuse a scale space without any smoothed normals, saying how many are usual."""
    if len(space.widths) < 2:
        raise MeshdepictError(f"{what} needs at least one scale; make more with scales={scales}")
