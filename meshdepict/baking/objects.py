"""Baking objects that stand together, or on a ground: each by itself, rays meet all of them."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any, TypeVar

from meshdepict.baking.baked import Baked
from meshdepict.baking.baked_together import BakedTogether
from meshdepict.baking.budget import Predicted, within_budget
from meshdepict.baking.choice_list import AUTO, MESH
from meshdepict.baking.choices import Choices
from meshdepict.baking.chosen_normals import sides_of
from meshdepict.baking.mirror_ground import mirrored, mirrored_picture
from meshdepict.baking.own_colors import own_colors, surface_tints
from meshdepict.baking.sampling import Place, sampled
from meshdepict.baking.surfaces import as_surface, bake_surface, with_choices
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.options import options_of
from meshdepict.scales.company import Company
from meshdepict.scales.ladder import Progress
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.shape import one_of
from meshdepict.shading.registry import find_method
from meshdepict.shapes.ground_plane import GroundPlane, ground_under
from meshdepict.shapes.joined import JoinedMesh
from meshdepict.shapes.mesh import Mesh

__all__ = [
    "OF_THE_SCENE",
    "bake_objects",
    "bake_on_ground",
    "scene_look",
    "scene_meshes",
    "with_own",
]

Look = TypeVar("Look", bound=Choices)

OF_THE_SCENE = ("light", "sampling", "view", "up", "ground", "accuracy", "budget")
"""Choices that all objects of a scene share."""

_OF_LIGHT = ("shadows", "bounces", "rays")
"""Options that methods share: how light goes through a scene."""

_SMALL = 1 / 300  # of the scene: rays start off it by a three hundredth of its size

_SHOWS_GROUND = "isometric"  # which from the side would be a line


@dataclass
class _Object:
    """A mesh, how it shall look, and where it stands."""

    mesh: Mesh
    look: Choices
    place: Place


def bake_on_ground(shape: object, look: Choices, *, progress: Progress | None = None) -> Baked:
    """Shade a surface as `bake_surface` does, on a ground if the look has one."""
    if look.ground is None:
        return bake_surface(shape, look, progress=progress)
    return bake_objects([shape], [look], progress=progress)[0]


def bake_objects(
    shapes: Sequence[object], looks: Sequence[Choices], *, progress: Progress | None = None
) -> BakedTogether:
    """Shade objects that stand together.

    Parameters
    ----------
    shapes : sequence of path, Mesh, pyvista.PolyData or trimesh.Trimesh
    looks : sequence of Choices
        Of each; what is of the scene is the same in all.
    progress : callable, optional
        ``progress(done, total)``, for each object anew.

    Raises
    ------
    MeshdepictError
        For shapes that are no meshes, and for what one object alone can have.
    """
    if not shapes:
        raise MeshdepictError("nothing stands together: give at least one object")
    meshes = []
    for number, (shape, look) in enumerate(zip(shapes, looks, strict=True), start=1):
        with _named(number, len(shapes)):
            meshes.append(_mesh(shape, look))
    looks, allowed = _within_budget(meshes, _posed(meshes, looks))
    company = Company(scene_meshes(meshes, looks[0]))
    _warn_of_small(meshes, company.surface)
    if looks[0].ground is not None:
        # A ground has no colours of its own, and is fine enough.
        looks.append(looks[0].replace(albedo="none", refine=None))
    eye = looks[0].eye(company.surface)
    objects = [
        _Object(mesh, look, Place(company, number, eye))
        for number, (mesh, look) in enumerate(zip(company.surface.meshes, looks, strict=True))
    ]
    for number, each in enumerate(objects, start=1):
        with _named(number, len(shapes)):
            _rehearse(each, progress)
    bakes: list[Baked] = []
    for number, each in enumerate(objects):
        look = each.look if number < len(meshes) else _as_settled(each.look, bakes[0])
        with _named(number + 1, len(shapes)):
            bakes.append(bake_surface(each.mesh, look, place=each.place, progress=progress))
    shown = list(bakes)
    for number, baked in enumerate(bakes):
        if isinstance(baked.shape, GroundPlane) and baked.shape.mirror:
            shown[number] = mirrored_picture(baked, bakes)
            bakes[number] = mirrored(baked, bakes)
    if allowed is not None:
        for baked in bakes:
            baked.provenance["budget"] = str(allowed)
    ground = None if looks[0].ground is None else bakes.pop()
    return BakedTogether(bakes, shown, eye, ground=ground)


def with_own(look: Look, own: Mapping[str, Any]) -> Look:
    """Return the look of an object that has choices and options of its own."""
    if not own:
        return look
    method = find_method(own.get("method", look.function))
    shared = {
        name: look.options[name] for name in _OF_LIGHT
        if name in look.options and name in options_of(method)
    }  # fmt: skip
    return look.replace(**{**shared, **own})


def scene_meshes(meshes: Sequence[Mesh], look: Choices) -> list[Mesh]:
    """Return the meshes of a scene: objects, and the ground if a look with an up has one."""
    if look.ground is None:
        return [*meshes]
    ground = ground_under(meshes, up=look.axis(MESH), mirror=look.ground == "mirror")
    return [*meshes, ground]


def _within_budget(
    meshes: Sequence[Mesh], looks: list[Choices]
) -> tuple[list[Choices], Predicted | None]:
    """Return the looks with the accuracy that a budget allows for all objects together."""
    first, allowed = within_budget(looks[0], JoinedMesh([*meshes]))
    if allowed is None:
        return looks, None
    return [look.replace(accuracy=first.accuracy, budget=None) for look in looks], allowed


def _mesh(shape: object, look: Choices) -> Mesh:
    """Return an object as a mesh with the sides that its look chooses."""
    if isinstance(shape, ScaleSpace):
        raise MeshdepictError(
            "this ScaleSpace is of what stands alone: give its shape, and it is sampled anew"
        )
    mesh = as_surface(shape)
    choices = look.of_kind(mesh.kind)  # which refuses a ground under other kinds
    if not isinstance(mesh, Mesh):
        raise MeshdepictError(
            f"only meshes stand together, and this is {one_of(mesh.kind)}: bake it by itself"
        )
    found: Mesh = with_choices(mesh, choices)
    return found


def _warn_of_small(meshes: Sequence[Mesh], scene: JoinedMesh) -> None:
    for number, mesh in enumerate(meshes, start=1):
        if mesh.diagonal < _SMALL * scene.diagonal:
            warnings.warn(
                f"object {number} is {mesh.diagonal / scene.diagonal:.1g} of the scene: light "
                "between its own parts is rough",
                MeshdepictWarning,
                stacklevel=4,
            )


@contextmanager
def _named(number: int, count: int) -> Iterator[None]:
    """Say which of several objects a refusal is about."""
    try:
        yield
    except MeshdepictError as error:
        if count == 1:
            raise
        raise MeshdepictError(f"object {number}: {error}") from None


def scene_look(meshes: Sequence[Mesh], look: Look) -> Look:
    """Return a look with the up and the view that a scene has where they are "auto"."""
    return _posed(meshes, [look])[0]


def _posed(meshes: Sequence[Mesh], looks: Sequence[Look]) -> list[Look]:
    """Return the looks with one up, one view and one light for the whole scene."""
    standing = [mesh for mesh in meshes if not isinstance(mesh, GroundPlane)] or meshes
    posed = looks[0].posed(JoinedMesh(standing))
    view, given = posed.view, looks[0].view
    free = isinstance(given, str) and given == AUTO
    if free and looks[0].ground is not None and view != "top":
        view = _SHOWS_GROUND
    shared: dict[str, Any] = {"up": posed.up, "view": view}
    light = looks[0].lit_by
    if not all(look.lit_by is light or _same_name(look.lit_by, light) for look in looks):
        shared["light"] = light
    return [look.replace(**shared) for look in looks]


def _same_name(one: object, other: object) -> bool:
    return isinstance(one, str) and isinstance(other, str) and one == other


def _as_settled(look: Choices, baked: Baked) -> Choices:
    """Return the look of a ground with what followed from an object: a plane has no contrast."""
    assert baked.look is not None
    if look.blend is not None:
        return look.replace(blend=baked.look.blend)
    return look.replace(**baked.look.fitted)


def _rehearse(one: _Object, progress: Progress | None) -> None:
    """Sample an object, and hear what it sends on.

    Of a blend the lowest layer speaks that has a matt material.
    """
    if isinstance(one.mesh, GroundPlane) and one.mesh.mirror:
        one.place.company.mirrors.add(one.place.member)  # it sends no light to every side
        return
    look = one.look.of_kind(MESH).replace(**sides_of(one.mesh))
    layers = [look.of_layer(layer).of_kind(MESH) for layer in reversed(look.layers)] or [look]
    speaks = next((each for each in layers if "bounces" in options_of(each.function)), None)
    if speaks is None:
        return
    tints = None
    if look.albedo == "keep":
        tints = surface_tints(one.mesh, own_colors(one.mesh))
    place, bounces = one.place, max(1, int(speaks.options.get("bounces", 0)))
    space = sampled(one.mesh, speaks, place.eye, speaks.ladder, tints=tints, place=place)
    space.smooth(speaks.reads(space.last).sets, progress=progress)
    look = speaks.settled(space).replace(bounces=bounces)  # others may ask for some
    with place.company.rehearsal(), suppress(*_silent(speaks)):
        look.shade(space, speaks.lighting(place.eye, MESH), place.eye)


def _silent(look: Choices) -> tuple[type[Exception], ...]:
    """Return what an object is silent about that has no bounces itself: that it can't have any."""
    return () if look.options.get("bounces") else (MeshdepictError,)
