"""How what a session shows looked before: in its file, else lit plainly."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.look import bake
from meshdepict.baking.own_colors import own_appearance, own_colors
from meshdepict.errors import MeshdepictError
from meshdepict.shading.method import LIGHT
from meshdepict.shapes.mesh import Mesh
from meshdepict.viewer.light_drag import lights_of

if TYPE_CHECKING:
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.shapes.appearance import Appearance
    from meshdepict.viewer.session import Session

__all__ = ["colors_before", "own_look"]


def own_look(session: Session) -> Appearance | None:
    """Return how the mesh looks in its file; None of terrain, and where that says nothing."""
    return own_appearance(session.shape) if isinstance(session.shape, Mesh) else None


def colors_before(session: Session, space: ScaleSpace | None = None) -> NDArray[np.uint8]:
    """Return the shape's own colours, or Lambert's under the (first) light: (n, 3)."""
    try:
        return own_colors(session.shape)
    except MeshdepictError:
        lights = lights_of(session.light)
        light = lights[0] if lights else LIGHT
        space = session.space if space is None else space
        return bake(space, "lambert", light=light, view=session.view, up=session.up).colors
