"""Shading the layers of a blend, each as it looks alone, on as few scale spaces as that takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
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

__all__ = ["Blend", "Layered", "shade_layers", "shared_ladders"]

Ladder = tuple[int, float]
Floats = NDArray[np.floating]


class Blend(NamedTuple):
    """What the layers of a look make of a shape.

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


class Layered:
    """The layers of a look, for shapes of a kind.

    Parameters
    ----------
    look : Choices
        As it was chosen, with up and view as they suit the shape.
    kind : str
        Of the shape.

    Attributes
    ----------
    look : Choices
    looks : list of Choices
        Of each layer.
    ladders : list of (scales, ratio)
        On which each is shaded; see `shared_ladders`.
    """

    def __init__(self, look: Choices, kind: str) -> None:
        self.look = look
        self.looks = [look.of_layer(layer).of_kind(kind) for layer in look.layers]
        self.ladders = shared_ladders(self.looks)

    def reads(self, ladder: Ladder, last: int) -> Reads:
        """Return what the layers of a ladder read of a space with so many smoothed sets."""
        reads = Reads()
        for each, its in zip(self.looks, self.ladders, strict=True):
            if its == ladder:
                reads |= each.reads(last)
        return reads

    def settle(self, spaces: Mapping[Ladder, ScaleSpace]) -> Choices:
        """Find the options that follow the shape; return the look with them."""
        pairs = zip(self.looks, self.ladders, strict=True)
        self.looks = [each.settled(spaces[its]) for each, its in pairs]
        return self.look.with_settled(self.looks)

    def find_rays(self, spaces: Mapping[Ladder, ScaleSpace], eye: View) -> Choices:
        """Find how many rays each takes that has as many as it takes; return the look with them."""
        found = []
        for each, its in zip(self.looks, self.ladders, strict=True):
            space = spaces[its]
            found.append(each.with_rays(space, each.lighting(eye, space.shape.kind), eye))
        self.looks = found
        return self.look.with_settled(self.looks)

    def values(self, spaces: Mapping[Ladder, ScaleSpace], eye: View) -> NDArray[np.float32]:
        """Return the display values (n,) or (n, 3) of all layers, one laid upon the other."""

        def pictures() -> Iterator[tuple[Floats, str, float]]:
            layers = zip(self.look.layers, self.looks, self.ladders, strict=True)
            for layer, each, its in reversed([*layers]):
                yield _picture(layer, each, spaces[its], eye), layer.mode, layer.opacity

        return flattened(pictures())


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
    look, kind
        See `Layered`.
    eye : View
    make : callable (scales, ratio) → ScaleSpace
        Called once for every ladder that is needed.
    progress : callable, optional
        ``progress(done, total)``, while normals are smoothed.
    """
    layered = Layered(look, kind)
    spaces: dict[Ladder, ScaleSpace] = {}
    for ladder in dict.fromkeys(layered.ladders):
        space = spaces[ladder] = make(*ladder)
        space.smooth(layered.reads(ladder, space.last).sets, progress=progress)
    layered.settle(spaces)
    settled = layered.find_rays(spaces, eye)
    return Blend(layered.values(spaces, eye), spaces[max(spaces)], settled)


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
