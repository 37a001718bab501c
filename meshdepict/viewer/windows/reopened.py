"""A session that goes on from a finished bake: it begins with its colours, and can change all."""

from __future__ import annotations

from typing import TYPE_CHECKING

from meshdepict.errors import MeshdepictError
from meshdepict.scene.environment import Environment
from meshdepict.viewer.session import Session

if TYPE_CHECKING:
    from meshdepict.baking.baked import Baked

__all__ = ["session_of"]


def session_of(baked: Baked) -> Session:
    """Return a session that shows a bake, with the method, options and light it was made with.

    Parameters
    ----------
    baked : Baked
        Of a mesh.

    Raises
    ------
    MeshdepictError
        For what a session can't change: two-dimensional colour maps, the object's own colours, a
        panorama, a refined bake.
    """
    space, look = baked.space, baked.look
    if space is None or look is None or baked.shape.kind != "mesh" or look.albedo != "none":
        raise MeshdepictError("only a mesh as it is, without its own colours, can be lit anew")
    if look.colormap2d is not None:
        raise MeshdepictError("a colour map of two lights can't be lit anew")
    if isinstance(look.light, Environment):
        raise MeshdepictError("a panorama can't be turned by hand")
    count = len(space.widths) - 1
    made = {
        "scales": count or None, "ratio": space.ratio if count else None,
        "width": float(space.widths[1]) if count else None, "facing": space.facing,
        "tolerance": space.tolerance,
    }  # fmt: skip
    again = look.replace(view=baked.view, **made)
    session = Session(baked.shape, again.function, **again.words())
    session.adopt(space, baked)
    return session
