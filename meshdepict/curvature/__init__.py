"""Curvature of surfaces: estimators on meshes, and what an eye sees of it.

Everywhere: positive where convex (+1/r on a sphere of radius r with outward normals), in 1/length
of the world, |k1| ≥ |k2|. Seen by an eye the sign turns, as in the papers: there a hollow is
positive, and the unit is one over pixels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from meshdepict.curvature.principal import ESTIMATORS, PrincipalCurvatures, principal_curvatures
from meshdepict.curvature.view import ViewCurvature

if TYPE_CHECKING:
    from meshdepict.scene.view import View

__all__ = [
    "ESTIMATORS",
    "PrincipalCurvatures",
    "ViewCurvature",
    "principal_curvatures",
    "view_curvature",
]


class Bending(Protocol):
    """A scale space, as far as an eye sees it bend."""

    def view_curvature(
        self, view: View | str, scale: int = 1, *, foreshortening: float = 1.0
    ) -> ViewCurvature:
        """Return the curvature of a scale as an eye sees it."""


def view_curvature(
    space: Bending, view: View | str, *, scale: int = 1, foreshortening: float = 1.0
) -> ViewCurvature:
    """Return the curvature of a scale space's surface as an eye sees it, per pixel.

    Parameters
    ----------
    space : ScaleSpace
    view : View or str
        Or the name of one, "front" for instance, fitted to the shape.
    scale : int
        Whose normals bend; 0 are the unsmoothed ones.
    foreshortening : float
        The exponent f ≥ 0 of the slope: 1 in Light Warping, 0.4 in Radiance Scaling's shader.

    Returns
    -------
    ViewCurvature

    Raises
    ------
    MeshdepictError
        For an unknown view, a scale that the space doesn't have, f out of 0 … 10.
    """
    return space.view_curvature(view, scale, foreshortening=foreshortening)
