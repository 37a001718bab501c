"""Shading the layers of a blend, each as it looks alone, on as few scale spaces as that takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.choices import Choices
from meshdepict.baking.clipping import warn_of_clipping
from meshdepict.baking.layer_list import Layer
from meshdepict.color.blending import flattened, stretched
from meshdepict.scales.ladder import Progress
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View

__all__ = ["Blend", "shade_layers", "shared_ladders"]

Ladder = tuple[int, float]
Floats = NDArray[np.floating]


class Blend(NamedTuple):
    """What the layers of a look make.

    Attributes
    ----------
    values : (n,) or (n, 3) array of float32
        Display values in [0, 1].
    space : ScaleSpace
        The one with most scales of those that were shaded.
    look : Choices
        With numbers for options of its layers that follow the shape.
    """

    values: NDArray[np.float32]
    space: ScaleSpace
    look: Choices


def shade_layers(
    look: Choices,
    kind: str,
    eye: View,
    make: Callable[[int, float], ScaleSpace],
    *,
    progress: Progress | None = None,
) -> Blend:
    """Shade the layers of a look, and lay one upon the other.

    Parameters
    ----------
    look : Choices
        As it was chosen, with up and view as they suit the shape.
    kind : str
        Of the shape.
    eye : View
    make : callable (scales, ratio) → ScaleSpace
        Called once for every ladder that is needed; see `shared_ladders`.
    progress : callable, optional
        ``progress(done, total)``, while normals are smoothed.
    """
    looks = [look.of_layer(layer).of_kind(kind) for layer in look.layers]
    ladders = shared_ladders(looks)
    spaces: dict[Ladder, ScaleSpace] = {}
    for ladder in dict.fromkeys(ladders):
        space = spaces[ladder] = make(*ladder)
        reads = Reads()
        for each, its in zip(looks, ladders, strict=True):
            if its == ladder:
                reads |= each.reads(space.last)
        space.smooth(reads.sets, progress=progress)
    looks = [each.settled(spaces[its]) for each, its in zip(looks, ladders, strict=True)]

    def pictures() -> Iterator[tuple[Floats, str, float]]:
        for layer, each, its in reversed([*zip(look.layers, looks, ladders, strict=True)]):
            yield _picture(layer, each, spaces[its], eye), layer.mode, layer.opacity

    values = flattened(pictures())
    return Blend(values, spaces[max(spaces)], look.with_settled(looks))


def shared_ladders(looks: Sequence[Choices]) -> list[Ladder]:
    """Return the ladder, scales and ratio, on which each look is shaded.

    Its own, or a longer one of another look on which it reads the same: of a method that reads the
    first scale it doesn't matter how many follow. What reads the shape's own normals alone goes
    with any.
    """
    found: dict[int, Ladder] = {}
    made: list[Ladder] = []
    for place in sorted(range(len(looks)), key=lambda i: looks[i].ladder, reverse=True):
        look = looks[place]
        scales, ratio = look.ladder
        reads = look.reads(scales)
        single = not (reads.sets | reads.means) - {0}
        shared = (
            ladder
            for ladder in made
            if (single or ladder[1] == ratio) and look.reads(ladder[0]) == reads
        )
        found[place] = next(shared, (scales, ratio))
        if found[place] not in made:
            made.append(found[place])
    return [found[place] for place in range(len(looks))]


def _picture(layer: Layer, look: Choices, space: ScaleSpace, eye: View) -> Floats:
    """Return the display values of a layer, grey or in colour."""
    lamp = look.lighting(eye, space.shape.kind)
    values: Floats = look.shade(space, lamp, eye)
    warn_of_clipping(look, lamp, values, lambda other: other.shade(space, lamp, eye))
    if look.declared.linear:
        values = color.linear_to_srgb(values)
    if layer.stretch is not None:
        values = stretched(values, *layer.stretch)
    if layer.colormap is not None:
        values = color.encode(values, linear=False, colormap=layer.colormap) / np.float32(255)
    return values
