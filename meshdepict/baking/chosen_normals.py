"""Which normals a mesh is shaded by: computed, parted at creases, or the file's own."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from meshdepict.baking.choice_list import SIDES, choice_fields
from meshdepict.baking.choices import Choices
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.parted import PartedMesh

if TYPE_CHECKING:
    from meshdepict.scene.shape import Shape
    from meshdepict.shapes.mesh import Mesh

__all__ = ["refuse_other_sides", "sides_of", "with_chosen_normals"]


def with_chosen_normals(mesh: Mesh, look: Choices) -> Mesh:
    """Return a mesh with the normals that a look chooses: parted at creases, or the file's."""
    if isinstance(mesh, PartedMesh):  # made with choices of its own
        chosen = {name: getattr(look, name) for name in SIDES}
        if chosen == sides_of(mesh) or not look.words().keys() & set(SIDES):
            return mesh
        return with_chosen_normals(mesh.before, look)
    if look.normals == "file":
        from meshdepict.shapes.own_normals import with_own_normals

        found = with_own_normals(mesh)
        where = "that have several normals in the file"
    elif look.creases is not None:
        from meshdepict.shapes.parted import parted_at_creases

        found = parted_at_creases(mesh, look.creases)
        where = f"at edges sharper than {look.creases:g}°"
    else:
        return mesh
    if found.added:
        warnings.warn(
            f"{found.added:,} vertices were added for those {where}",
            MeshdepictWarning,
            stacklevel=3,
        )
    return found


def sides_of(shape: Shape) -> dict[str, object]:
    """Return the choices that a shape's normals were made with."""
    if isinstance(shape, PartedMesh):
        return {"creases": shape.creases, "normals": shape.chosen_normals}
    return {name: choice_fields()[name].default for name in SIDES}


def refuse_other_sides(shape: Shape, look: Choices) -> None:
    """Refuse to ask a finished surface for normals that it wasn't made with.

    Raises
    ------
    MeshdepictError
    """
    made = sides_of(shape)
    for name in SIDES:
        value = getattr(look, name)
        if value not in (choice_fields()[name].default, made[name]):
            raise MeshdepictError(
                f"{name}={value!r} is about a mesh that is yet to be sampled: leave it out, or "
                "bake the mesh"
            )
