"""How exact a look is: named sets of the numbers that trade speed for accuracy (docs/accuracy.md).

Each lies on a knee of the curves that `scripts/tradeoff.py` measures: beyond it seconds grow, and
what a picture shows does not change any more. What somebody says explicitly wins over them. Numbers
that make another picture, and not a rougher one, are in none: facing, bounces, widths.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from meshdepict.options import options_of

__all__ = ["ACCURACIES", "ADJUSTABLE", "BUDGETED", "NORMAL", "Accuracy", "numbers_of"]

Ladder = tuple[int, float]

NORMAL = "normal"


@dataclass(frozen=True)
class Accuracy:
    """What is taken instead of what is usual.

    Attributes
    ----------
    tolerance : float, optional
        Of smoothed normals, radians.
    rays, lights : float
        Times those that a method takes: from each sample, and for an environment.
    ladders : mapping
        Scales and ratio by the method's name: fewer bands of the same span.
    """

    tolerance: float | None = None
    rays: float = 1.0
    lights: float = 1.0
    ladders: Mapping[str, Ladder] = field(default_factory=dict)


ACCURACIES: Mapping[str, Accuracy] = {
    "draft": Accuracy(tolerance=1e-2, rays=1 / 4, lights=1 / 3, ladders={"exaggerated": (5, 2.0)}),
    NORMAL: Accuracy(),
    "reference": Accuracy(rays=16, lights=8),
}
"""From the roughest to the most exact. The tolerance that is usual is off by less than a tenth of a
grey level, so that reference keeps it."""

ADJUSTABLE = ("tolerance", "scales", "ratio", "rays", "lights")
"""What they choose, of choices and of a method's options."""

BUDGETED = ("reference", NORMAL, "draft")
"""In this order a budget tries them."""

_FEWEST_RAYS = {"ambient_occlusion": 256}
"""Below, the grey scale that it fits to the shape is another one: it goes by the noise."""

_UNSAID_RAYS = {"occlusion": 256, "lights": 64}
"""By illumination, where a method has 0 for its usual number."""


def numbers_of(
    name: str, function: Callable[..., Any], options: Mapping[str, Any], *, blended: bool = False
) -> dict[str, Any]:
    """Return the choices and options of a method that an accuracy stands for; none for normal's.

    Parameters
    ----------
    name : {"draft", "normal", "reference"}
    function : function
        The method.
    options : mapping
        Those that somebody chose.
    blended : bool
        Whether it is one of several layers, each of which has numbers of its own.
    """
    accuracy = ACCURACIES[name]
    found: dict[str, Any] = {}
    if accuracy.tolerance is not None:
        found["tolerance"] = accuracy.tolerance
    if blended:
        return found
    method, known = function.__name__, options_of(function)
    scales, ratio = accuracy.ladders.get(method, (0, 0.0))
    numbers = [value for name, value in options.items() if name in known and not known[name].count]
    if scales and all(not isinstance(n, tuple) or len(n) == scales for n in numbers):
        found["scales"], found["ratio"] = scales, ratio  # numbers for each scale are as many
    rays = _usual_rays(function, options)
    if accuracy.rays != 1 and rays:
        found["rays"] = max(round(rays * accuracy.rays), min(rays, _FEWEST_RAYS.get(method, 2)))
    if accuracy.lights != 1 and "lights" in known and known["lights"].kind is int:
        found["lights"] = round(known["lights"].default * accuracy.lights)
    return {name: value for name, value in found.items() if name not in options}


def _usual_rays(function: Callable[..., Any], options: Mapping[str, Any]) -> int:
    """Return how many rays a method takes unless told otherwise; 0 where it takes none."""
    option = options_of(function).get("rays")
    if option is None or option.kind is not int:
        return 0
    if option.default:
        return int(option.default)
    illumination = str(options.get("illumination", "lights"))
    hidden = illumination == "occlusion" or options.get("shadows") or options.get("bounces")
    return _UNSAID_RAYS.get(illumination, 0) if hidden else 0
