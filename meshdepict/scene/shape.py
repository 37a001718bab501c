"""What a view needs to know of a shape: where it is and how large."""

from __future__ import annotations

from typing import Protocol

from meshdepict.scene.vectors import Vector

__all__ = ["Shape", "one_of"]


class Shape(Protocol):
    """A `Mesh`, a `HeightField`, a `Volume` (or its `Grid`) or a `GBuffer`, of whichever kind."""

    @property
    def identity(self) -> str:
        """What it is, in numbers and a fingerprint: what provenance says of it."""

    @property
    def kind(self) -> str:
        """Return "mesh", "height field", "volume" or "image"."""

    @property
    def outline(self) -> Vector:
        """Points (m, 3) among which no other of the shape's lies further out."""

    @property
    def centre(self) -> Vector:
        """Middle (3,) of the box about it."""

    @property
    def diagonal(self) -> float:
        """Length of that box's diagonal; 0 of a point."""

    @property
    def edge_length(self) -> float:
        """Return the shape's own step: the median edge, the largest spacing, a pixel."""

    def recentred(self, points: Vector) -> Vector:
        """Return positions in diagonals from the centre, where single precision is enough."""


def one_of(kind: str) -> str:
    """Return a shape's kind with its article, for a sentence: a mesh, an image."""
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"
