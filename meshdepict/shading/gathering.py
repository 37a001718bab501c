"""How what the eye sees gathers light: plainly, or as a method enhances it.

A method that enhances light says here what it makes of a light, and of light that comes by rays;
who sums them (`reached`) does not know which method it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.vectors import cosines

if TYPE_CHECKING:
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.scene.environment import Environment
    from meshdepict.scene.light import Light
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Transfer

__all__ = ["PLAIN", "Gathering", "Gathers", "Plain", "fallen"]

Single = NDArray[np.float32]


class Gathers(Protocol):
    """What takes light that comes by rays to samples: a `Transfer`, or what weighs its rays."""

    def __len__(self) -> int:
        """Return the number of samples."""

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return what arrives of what each vertex sends, values (v,) or (v, c)."""

    def from_sky(self, environment: Environment, /) -> Single:
        """Return what arrives (n, 3) of an environment."""


class Gathering(Protocol):
    """What samples, the vertices of a surface or some of them, make of light that reaches them."""

    @property
    def everywhere(self) -> bool:
        """Whether surfaces also send on light that is gathered so, or only show it."""

    def falls(self, normals: NDArray[Any], light: Light) -> Single:
        """Return what (n,) arrives of a light of 1 that nothing hides: plainly ⟨n·l⟩."""

    def traced(self, space: ScaleSpace, rays: int) -> Transfer | Retraced:
        """Return where so many rays go from each vertex of the surface that a space lies on.

        They are those that bring what the eye sees: `ScaleSpace.transport`, or a method's own.
        """

    def along(self, transfer: Transfer, *, again: bool = False) -> Gathers:
        """Return what gathers light that comes by rays.

        Parameters
        ----------
        transfer : Transfer
            Such rays as `traced` returns, from the same samples.
        again : bool
            Whether it is of the second set of rays, which tells the error.
        """

    def at(self, chosen: NDArray[np.int64]) -> Gathering:
        """Return that of some of the samples."""


class Plain:
    """Light as it comes."""

    everywhere = False

    def falls(self, normals: NDArray[Any], light: Light) -> Single:
        """Return ⟨n·l⟩."""
        return np.maximum(cosines(normals, light.direction), 0).astype(np.float32)

    def traced(self, space: ScaleSpace, rays: int) -> Transfer | Retraced:
        """Return the space's own rays."""
        return space.transport(rays)

    def along(self, transfer: Transfer, *, again: bool = False) -> Gathers:
        """Return the rays as they are."""
        return transfer

    def at(self, chosen: NDArray[np.int64]) -> Plain:
        """Return the same."""
        return self


PLAIN = Plain()


def fallen(
    gathering: Gathering,
    normals: NDArray[Any],
    lights: Sequence[Light],
    seen: Sequence[Single | None],
) -> Single:
    """Return what arrives of lights, each as much as it is seen.

    (n,) where none is coloured, else (n, 3).
    """
    colors = np.array([light.color for light in lights], np.float32).reshape(-1, 3)
    gray = bool((colors == colors[:, :1]).all())
    total = np.zeros((len(normals), 1 if gray else 3), np.float32)
    for light, color, share in zip(lights, colors, seen, strict=True):
        falls = gathering.falls(normals, light)
        falls = falls if share is None else falls * share
        total += falls[:, None] * color[: total.shape[1]]
    return total[:, 0] if gray else total
