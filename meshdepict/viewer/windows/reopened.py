"""A session that goes on from a finished bake: it begins with its colours, and can change all."""

from __future__ import annotations

from meshdepict.baking.baked import Baked, Depiction
from meshdepict.baking.volumes import BakedVolume
from meshdepict.errors import MeshdepictError
from meshdepict.scene.environment import Environment
from meshdepict.shapes.height_field import HeightField
from meshdepict.viewer.session import Session
from meshdepict.viewer.windows.volume_session import VolumeSession

__all__ = ["session_of"]


def session_of(baked: Depiction) -> Session:
    """Return a session that shows a bake, with the method, options and light it was made with.

    Parameters
    ----------
    baked : Baked of a mesh or a height field, or BakedVolume

    Raises
    ------
    MeshdepictError
        For what a session can't change: two-dimensional colour maps, the object's own colours, a
        panorama, a refined bake, and a volume shaded slab by slab or without a transfer function.
    """
    look = baked.look
    space = baked.space if isinstance(baked, (Baked, BakedVolume)) else None
    if space is None or look is None or baked.shape.kind == "image" or look.albedo != "none":
        raise MeshdepictError(
            "only a mesh as it is, without its own colours, or a volume shaded at once can be lit "
            "anew"
        )
    if look.colormap2d is not None:
        raise MeshdepictError("a colour map of two lights can't be lit anew")
    if isinstance(look.light, Environment):
        raise MeshdepictError("a panorama can't be turned by hand")
    count = len(space.widths) - 1
    made = {
        "scales": count or None, "ratio": space.ratio if count else None,
        "width": float(space.widths[1]) if count else None, "tolerance": space.tolerance,
    }  # fmt: skip
    again = look.replace(view=baked.view, **made)
    if isinstance(baked, BakedVolume):
        if baked.transfer is None:
            raise MeshdepictError("a volume without a transfer function can't be lit anew")
        return VolumeSession(baked, again.function, **again.words())
    assert isinstance(baked, Baked)
    shape = baked.shape
    if isinstance(shape, HeightField):
        shape = shape.before or shape  # which the look raises again
    else:
        again = again.replace(facing=space.facing)
    session = Session(shape, again.function, **again.words())
    session.adopt(space, baked)
    return session
