"""How samples get their colours: all that a look says, but for the samples."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.choices import Choices
from meshdepict.baking.layers import Layered
from meshdepict.baking.tinting import tinted
from meshdepict.color import colormaps2d
from meshdepict.scales.light_errors import FoundRays
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import Lighting, as_light
from meshdepict.scene.view import View

__all__ = ["SampleShading"]

Ladder = tuple[int, float]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SampleShading:
    """What shades the samples of a shape, some of them or all, however they are at hand.

    Attributes
    ----------
    look : Choices
        Of the shape's kind; with numbers for what follows the shape once it was `settled`.
    light : Light, Lights or Environment
    eye : View
    layered : Layered, optional
        The layers of the look's blend.
    """

    look: Choices
    light: Lighting
    eye: View
    layered: Layered | None = None

    @property
    def ladders(self) -> Sequence[Ladder]:
        """Scales and ratio of the spaces that it reads."""
        return [self.look.ladder] if self.layered is None else self.layered.ladders

    @property
    def linear(self) -> bool:
        """Whether values are linear light."""
        return self.layered is None and self.look.colormap2d is None and self.look.declared.linear

    def reads(self, ladder: Ladder, last: int) -> Reads:
        """Return what is read of a space with so many smoothed sets."""
        return self.look.reads(last) if self.layered is None else self.layered.reads(ladder, last)

    def settled(self, spaces: Mapping[Ladder, ScaleSpace]) -> SampleShading:
        """Return the same with numbers for the options that follow the shape."""
        if self.layered is not None:
            return replace(self, look=self.look.replace(blend=self.layered.settle(spaces).blend))
        return replace(self, look=self.look.settled(spaces[self.look.ladder]))

    def sampled(
        self, spaces: Mapping[Ladder, ScaleSpace]
    ) -> tuple[SampleShading, FoundRays | None]:
        """Find how many rays "auto" comes to, and how sure light by rays is.

        The spaces' ``light_errors`` say the latter afterwards.

        Returns
        -------
        SampleShading
            With numbers for "auto".
        FoundRays or None
            What it came to, where a method without layers was asked.
        """
        if self.layered is not None:
            look = self.look.replace(blend=self.layered.find_rays(spaces, self.eye).blend)
            return replace(self, look=look), None
        space = spaces[self.look.ladder]
        look = self.look.with_rays(space, self.light, self.eye)
        if look is not self.look:
            return replace(self, look=look), space.light_errors.found
        if any(look.options.get(name) for name in ("shadows", "bounces")):
            self.values(spaces)
        return self, None

    def values(self, spaces: Mapping[Ladder, ScaleSpace]) -> NDArray[np.float32]:
        """Return what the method makes of some samples, (n,) or (n, 3) in [0, 1]."""
        if self.layered is not None:
            return self.layered.values(spaces, self.eye)
        space = spaces[self.look.ladder]
        if self.look.colormap2d is None:
            return self._shade(self.light, space)
        shade = functools.partial(self._shade, space=space)
        return colormaps2d.both_lights(
            shade, as_light(self.light), self.eye, self.look.colormap2d,
            linear=self.look.declared.linear,
        )  # fmt: skip

    def colors(
        self, values: NDArray[np.float32], heights: Callable[[], Floats]
    ) -> NDArray[np.uint8]:
        """Return the colours (n, 3) of values.

        Parameters
        ----------
        values : (n,) or (n, 3) array
        heights : callable
            How high the samples lie; asked for a tint, which has its heights by now.
        """
        look = self.look
        colors = color.encode(values, linear=self.linear, colormap=look.colormap)
        if look.tint is not None:
            _, tint = tinted(look, heights())
            colors = color.multiply_albedo(colors / np.float32(255), tint, linear=False)
        return colors

    def _shade(self, light: Lighting, space: ScaleSpace) -> NDArray[np.float32]:
        return self.look.shade(space, light, self.eye)
