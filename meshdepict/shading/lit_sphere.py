"""Lit sphere (Sloan, Martin, Gooch and Gooch, Graphics Interface 2001), or matcap."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Choice
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.vectors import in_frame
from meshdepict.scene.view import View
from meshdepict.shading.features import sight
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shading.painted import SPHERES, painted, sphere_picture

__all__ = ["lit_sphere"]


@method(lights="none", source="The Lit Sphere (Sloan et al., Graphics Interface 2001)")
def lit_sphere(
    space: ScaleSpace,
    light: object,
    *,
    view: View | str = "front",
    sphere: Annotated[
        str | Path, Choice(SPHERES, help="the painted sphere, or a picture file", also=(str, Path))
    ] = "clay",
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Colour every point as a painted sphere is where it has the same normal.

    Parameters
    ----------
    light : any
        Not looked at: light is part of the painting.
    view : View or str
        Whose right, up and depth the sphere is painted in.
    sphere : str or path
        "clay", "metal", or a picture of a sphere that fills it; transparent corners are filled.

    Returns
    -------
    (n, 3) array of float32
        Display colours in [0, 1].
    """
    frame = sight(view, space, fitted=False).frame.astype(np.float32)
    return exposed(
        painted(
            sphere_picture(sphere),
            in_frame(space.normals_at(0), frame),
        ),
        exposure,
    )
