"""What people take away from a viewer: a picture, the shape with its colours, the look as a recipe.

Nothing is ever replaced: a name that is taken gets a number.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from meshdepict.baking.baked import Baked
from meshdepict.baking.baked_texture import BakedTexture
from meshdepict.baking.recipe import save_recipe
from meshdepict.baking.volumes import BakedVolume
from meshdepict.drawing.picture import save_picture
from meshdepict.drawing.volume_picture import save_volume_picture
from meshdepict.viewer.session import Session

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPlane

__all__ = [
    "free_path", "save_look", "save_mesh", "save_snapshot", "save_texture", "save_voxels",
]  # fmt: skip


def free_path(stem: str, suffix: str, folder: str | Path = ".") -> Path:
    """Return ``stem + suffix`` in a folder, or the first of ``stem-2``, ``stem-3``, … not there."""
    path = Path(folder) / f"{stem}{suffix}"
    numbers = count(2)
    while path.exists():
        path = Path(folder) / f"{stem}-{next(numbers)}{suffix}"
    return path


def save_snapshot(
    session: Session,
    name: str,
    size: tuple[int, int],
    *,
    planes: Sequence[vtkPlane] = (),
    folder: str | Path = ".",
) -> Path:
    """Save the picture as ``<name>-<method>.png`` of a size in pixels; return its path.

    Of a volume planes (vtkPlane) cut off what is on their negative sides.
    """
    path = free_path(f"{name}-{session.method}", ".png", folder)
    baked: Baked | BakedVolume = session.baked()
    if isinstance(baked, BakedVolume):
        return save_volume_picture(baked, path, size=size, planes=planes)
    return save_picture(baked, path, size=size)


def save_mesh(session: Session, name: str, *, folder: str | Path = ".") -> Path:
    """Save the mesh with its colours as ``<name>-<method>.ply``; return its path."""
    return session.baked().save(free_path(f"{name}-{session.method}", ".ply", folder))


def save_texture(
    texture: BakedTexture,
    session: Session,
    name: str,
    suffix: str,
    *,
    size: tuple[int, int] | None = None,
    folder: str | Path = ".",
) -> Path:
    """Save a texture of what a session shows: .glb, or a picture in its view; return its path."""
    path = free_path(f"{name}-{session.method}", suffix, folder)
    if suffix == ".png":
        texture.view = session.view
        return texture.picture(path, size=size)
    return texture.save(path)


def save_voxels(session: Session, name: str, *, folder: str | Path = ".") -> Path:
    """Save the shaded voxels as ``<name>-<method>.vti``; return its path."""
    return session.baked().save(free_path(f"{name}-{session.method}", ".vti", folder))


def save_look(session: Session, name: str, *, folder: str | Path = ".") -> Path:
    """Save what `bake` has to be told as ``<name>-<method>.toml``; return its path.

    Raises
    ------
    MeshdepictError
        For what no recipe can hold: several lights, a panorama or a material of one's own.
    """
    path = free_path(f"{name}-{session.method}", ".toml", folder)
    save_recipe(path, session.recorded())
    return path
