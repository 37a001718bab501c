"""What a method declares to be live: its GLSL, its attributes and its uniforms."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.drawing.shader import Uniforms
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shading.method import declaration
from meshdepict.viewer.live.octahedral import pack_normals

__all__ = [
    "UNHIDDEN", "Attributes", "LiveMethod", "Options", "Uniforms", "original_normals", "packed",
]  # fmt: skip

Options = Mapping[str, Any]
Attributes = dict[str, NDArray[np.float32]]

UNHIDDEN = {"shadows": (False,), "bounces": (0,)}
"""What options are live of light that rays would have to find."""


def packed(sets: Sequence[NDArray[Any]] | NDArray[Any], *, bits: int = 16) -> Attributes:
    """Return sets of normals (k, n, 3) as the attributes normals0, normals1, …."""
    found = pack_normals(sets, bits=bits)
    return {f"normals{i}": numbers for i, numbers in enumerate(found)}


def original_normals(space: ScaleSpace, view: View, options: Options) -> tuple[int, Attributes]:
    """Return the shape's own normals alone."""
    return 1, packed([space.normals_at(0)])


def _none(*_: object) -> dict[str, Any]:
    return {}


@dataclass(frozen=True)
class LiveMethod:
    """A shading function in GLSL.

    Attributes
    ----------
    function : callable
        The function of `meshdepict.shading` that it equals.
    glsl : str
        Defines ``vec3 shade()``, which returns what the function does, before exposure. It may use
        the normals ``n[SETS]``, ``light_direction(k)``, ``light_color(k)``, ``light_count`` and
        ``towards_eye()``.
    attributes : callable (space, view, options) → (number of sets of normals, attributes)
        The one pass over the vertices; made again only where `key` changes.
    key : callable (view, options) → tuple
        What the attributes depend on, beside what the function reads of the scale space.
    bits : {16, 24}
        Of the coordinates of packed normals.
    uniforms : callable (space, options) → uniforms
    defines : callable (options) → {name: int}
        Parts of the shader that are compiled at all.
    only : {option: values}
        Options that have but these values live.
    most : {option: number}
        Options whose larger values are not live.
    several : bool
        Whether it takes several lights, and their colours.
    """

    function: Callable[..., Any]
    glsl: str
    attributes: Callable[[ScaleSpace, View, Options], tuple[int, Attributes]] = original_normals
    key: Callable[[View, Options], tuple[Any, ...]] = lambda view, options: ()
    bits: int = 16
    uniforms: Callable[[ScaleSpace, Options], Uniforms] = _none
    defines: Callable[[Options], dict[str, int]] = _none
    only: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)
    most: Mapping[str, float] = field(default_factory=dict)
    several: bool = False

    def reads(self, space: ScaleSpace, options: Options) -> Reads:
        """Return what the function reads of a scale space."""
        return declaration(self.function).reads(space.last, options)

    @property
    def name(self) -> str:
        """The method's name in `shading.METHODS`."""
        return self.function.__name__
