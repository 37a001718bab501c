"""Looks, and baking by one: from a shape and a method's name to colours, in one line."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeGuard

import numpy as np

from meshdepict.baking.baked import Baked
from meshdepict.baking.baked_together import BakedTogether
from meshdepict.baking.choices import Choices, takes_choices
from meshdepict.baking.objects import OF_THE_SCENE, bake_objects, bake_on_ground, with_own
from meshdepict.baking.recipe import load_recipe, save_recipe
from meshdepict.errors import MeshdepictError
from meshdepict.scales.ladder import MEMORY, Progress

if TYPE_CHECKING:
    from meshdepict.baking.volumes import BakedVolume

__all__ = ["Look", "bake", "bake_together", "bake_volume"]


class Look(Choices):
    """How a shape shall look: frozen, to be baked on any shape, saved and loaded.

    ``Look("exaggerated", light="west", exaggeration=30).bake("scan.ply")``. Parameters are those of
    `Choices`: method, light, view, up, scales, width, ratio, facing, tolerance, colour maps,
    albedo, refine, transfer, and the method's own options.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range.
    """

    def bake(self, shape: object, *, progress: Progress | None = None) -> Baked | BakedVolume:
        """Shade a shape: a surface as `bake` does, a volume as `bake_volume` does.

        Raises
        ------
        MeshdepictError
            As `bake` and `bake_volume`.
        """
        from meshdepict.baking import volumes  # loaded where there is one

        if volumes.is_volume(shape):
            return volumes.bake_grid(shape, self, progress=progress)
        return bake_on_ground(shape, self, progress=progress)

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Write the look as a recipe; see `save_recipe`."""
        save_recipe(path, self, force=force)
        return Path(path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a recipe; see `load_recipe`."""
        return cls(**load_recipe(path))


@takes_choices
def bake(
    shape: object,
    method: str | Callable[..., Any] = "exaggerated",
    *,
    progress: Progress | None = None,
    **chosen: Any,
) -> Baked:
    """Shade a shape by a method and turn the result into colours.

    Parameters
    ----------
    shape : path, Mesh, HeightField, GBuffer, ScaleSpace, pyvista.PolyData or trimesh.Trimesh
        A `ScaleSpace` is used as it is: several bakes can share one. What it was made with can't
        be asked for again.
    method : str or function
        A name of `shading.METHODS`, or a function made by the decorator `meshdepict.method`.
    progress : callable, optional
        ``progress(done, total)``.
    **chosen
        Light, view, scales and so on, as `Look` has them, and the method's own options.

    Returns
    -------
    Baked

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range.
    """
    return bake_on_ground(shape, Look(method, **chosen), progress=progress)


@takes_choices
def bake_together(
    shapes: Iterable[object],
    method: str | Callable[..., Any] = "exaggerated",
    *,
    progress: Progress | None = None,
    **chosen: Any,
) -> BakedTogether:
    """Shade meshes that stand together: each hides light from the others, and sends it on to them.

    Each is smoothed by itself, at widths of its own. Light, view and up are the scene's; names of
    lights refer to the view.

    Parameters
    ----------
    shapes : iterable
        Of each object a path, Mesh, pyvista.PolyData or trimesh.Trimesh; or of one with a look of
        its own a pair: that, and choices and options by name,
        ``(mesh, {"method": "phong", "diffuse": 0.3})``. Shadows, bounces and rays of all objects
        are also those of another method.
    method, progress, **chosen
        As for `bake`.

    Returns
    -------
    BakedTogether
        A sequence: a `Baked` of each. Pictures show all of them.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range, for shapes that are no meshes, and for one object's
        choice of what is the scene's.
    """
    look = Look(method, **chosen)
    if isinstance(shapes, (str, bytes, os.PathLike)) or not np.iterable(shapes):
        raise MeshdepictError(
            f"shapes={shapes!r} is no sequence of meshes: give at least one in []"
        )
    pairs = [each if _is_pair(each) else (each, {}) for each in shapes]
    for number, (_, own) in enumerate(pairs, start=1):
        for name in own:
            if not isinstance(name, str):
                raise MeshdepictError(f"{name!r} of object {number} is no name of a choice")
            if name in OF_THE_SCENE:
                raise MeshdepictError(
                    f"{name} of object {number} is all objects': give it to bake_together itself"
                )
    looks = [with_own(look, own) for _, own in pairs]
    return bake_objects([shape for shape, _ in pairs], looks, progress=progress)


def _is_pair(given: object) -> TypeGuard[tuple[object, dict[str, Any]]]:
    return isinstance(given, tuple) and len(given) == 2 and isinstance(given[1], dict)


@takes_choices
def bake_volume(
    volume: object,
    method: str | Callable[..., Any] = "exaggerated",
    *,
    memory: float = MEMORY,
    progress: Progress | None = None,
    **chosen: Any,
) -> BakedVolume:
    """Shade the voxels that a transfer function shows, in its colours.

    Parameters
    ----------
    volume : path, Volume or GridSpace
        A `GridSpace` is used as it is: a new light or method takes a moment.
    method : str or function
        As for `bake`. Those that cast rays need a surface, and say so.
    memory : float
        Bytes that normals may take. Where they would take more, the volume is shaded slab by slab,
        and every new light starts from the beginning.
    progress : callable, optional
        ``progress(done, total)``.
    **chosen
        As `Look` has them: the transfer function (a `GridSpace` has its own), light, view, scales
        and so on, and the method's own options. z points up unless said otherwise, so that "front"
        is the patient's. Normals point towards lower values.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range, where nothing is shown, and for methods that cannot
        be had slab by slab.
    """
    from meshdepict.baking import volumes

    return volumes.bake_grid(volume, Look(method, **chosen), memory=memory, progress=progress)
