"""The groups of a plate: one shape in one look, baked and drawn from all sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.baked import Baked
from meshdepict.baking.choice_list import LADDER, choice_fields
from meshdepict.baking.look import Look
from meshdepict.baking.plate_input import notes_about
from meshdepict.baking.surfaces import bake_surface
from meshdepict.baking.volumes import BakedVolume, bake_grid
from meshdepict.drawing.arrangement import Arrangement
from meshdepict.drawing.canvas import on_ground
from meshdepict.drawing.framing import Framing
from meshdepict.drawing.page import Color, Part, Picture
from meshdepict.drawing.picture import drawn
from meshdepict.drawing.plate_layout import Spot
from meshdepict.drawing.volume_picture import draw_voxels
from meshdepict.files.mark import VERSION
from meshdepict.scales.ladder import Progress
from meshdepict.scales.making import scale_space
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.volume import Volume

__all__ = ["Group", "draw_groups"]


@dataclass(frozen=True)
class Group:
    """One shape in one look, with its main view and its turns."""

    shape: Mesh | HeightField | Volume
    look: Look
    eye: View
    arrangement: Arrangement
    name: str

    @property
    def caption(self) -> str:
        """What stands below it: method and light, and the name if it has one."""
        said = self.look.title
        if self.look.lit:
            light = self.look.lighting(self.eye, self.shape.kind)
            said += f", light {str(light).partition(' (')[0]}"
        return f"{self.name}: {said}" if self.name else said


def draw_groups(
    groups: Sequence[Group],
    spots: Sequence[Spot],
    ground: Color | None,
    progress: Progress | None,
) -> tuple[list[Part], dict[str, str]]:
    """Bake and draw every view; return the pictures and what the file says of them."""
    from PIL import Image

    pictures: list[Part] = []
    facts = {"version": VERSION}
    spaces: dict[tuple[int, int, float], ScaleSpace] = {}
    main = -1
    for done, spot in enumerate(spots):
        group = groups[spot.group]
        for key in [key for key in spaces if key[0] != id(group.shape)]:
            del spaces[key]  # of a shape that is done
        with notes_about(group.name):
            baked = _baked(group, spot.view, spaces)
        pixels = on_ground(_pixels(baked, spot), ground)
        pictures.append(Picture(Image.fromarray(pixels), spot.left, spot.top))
        number = f"{spot.group + 1} " if len(groups) > 1 else ""
        if spot.group != main:
            main = spot.group
            facts |= {f"{number}{key}": said for key, said in baked.provenance.items()
                      if key != "version"}  # fmt: skip
        else:
            facts[f"{number}view"] += f"; {spot.view.name}"
        if progress:
            progress(done + 1, len(spots))
    return pictures, facts


def _baked(
    group: Group, view: View, spaces: dict[tuple[int, int, float], ScaleSpace]
) -> Baked | BakedVolume:
    """Bake a view; scale spaces are made once for each shape and ladder."""
    look, shape = group.look.replace(view=view), group.shape
    usual = {name: choice_fields()[name].default for name in LADDER}
    key = (id(shape), *look.ladder)
    if isinstance(shape, Volume):
        known = spaces.get(key)
        if known is not None:
            return bake_grid(known, look.replace(**usual, transfer=None))
        volume = bake_grid(shape, look)
        if volume.space is not None:  # none where the volume was shaded slab by slab
            spaces[key] = volume.space
        return volume
    if key not in spaces:
        scales, ratio = look.ladder
        spaces[key] = scale_space(
            shape, scales=scales, width=look.width, ratio=ratio, facing=look.facing,
            tolerance=look.tolerance, view=view, at_once=(),
        )  # fmt: skip
    return bake_surface(spaces[key], look.replace(**usual))


def _pixels(baked: Baked | BakedVolume, spot: Spot) -> NDArray[np.uint8]:
    """Draw a view: colour times coverage, and coverage."""
    if isinstance(baked, BakedVolume):
        return draw_voxels(baked, Framing(spot.view, spot.size))
    return drawn(baked, spot.view, spot.size)
