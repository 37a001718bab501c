"""Volumes drawn by VTK's ray caster: shaded voxels, or plain CT numbers with VTK's own light.

Of a bake the card gets the light at every voxel beside the CT number. Both are interpolated where a
ray passes, and the transfer function is asked there: what is interpolated after it, colours and
opacities of voxels, would show the voxels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.drawing.volume_rays import LEVELS, march, ray_caster, refill, volume_actor

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
    from vtkmodules.vtkRenderingCore import vtkVolume

    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.drawing.painted import PaintedVolume
    from meshdepict.drawing.plotter import Plotter
    from meshdepict.scales.grid_scales import GridSpace
    from meshdepict.voxels.grid import Grid

__all__ = [
    "BakedTexture",
    "add_baked",
    "add_plain",
    "add_rgba",
    "levels_of",
    "repaint",
    "sample_box",
    "texture",
    "transfer_classes",
    "transfer_window",
]

_LIGHT = """
float level_of(vec4 texel) {
  return texel.a;
}

vec4 light_at(vec4 texel, vec3 place) {
  return vec4(texel.rgb, any(greaterThan(texel.rgb, vec3(0.0))) ? 1.0 : 0.0);
}
"""

_FLAT = 128  # light at what is shown but has no normal: the middle, as in `VolumeRecipe.paint`


class BakedTexture(NamedTuple):
    """What the ray caster gets of a bake.

    Attributes
    ----------
    values : (nz, ny, nx, 4) array of uint8
        Display values of light or colour, and level.
    classes : (`LEVELS`, 4) array of float32
        Linear colour, which the first three multiply, and opacity of the levels.
    corner : (x, y, z)
        The box's first voxel.
    """

    values: NDArray[np.uint8]
    classes: NDArray[np.float32]
    corner: tuple[int, int, int]


def texture(baked: PaintedVolume) -> BakedTexture:
    """Return light, levels and their meaning, of the box that is shown.

    Levels stand for CT numbers. Where the transfer function also asks for the gradient, which is
    known at voxels alone, and without one, they stand for opacity, beside the colours as baked.
    """
    transfer = baked.transfer
    box = _box(baked)
    corner = (box[2].start, box[1].start, box[0].start)
    if transfer is None or transfer.gradient_opacity is not None:
        return BakedTexture(_colors(baked, box), transfer_classes(None, (0, 1)), corner)
    window = transfer_window(transfer, baked.shape)
    classes = transfer_classes(transfer, window)
    if baked.space is None:  # shaded slab by slab: colours are all there is
        values = _colors(baked, box)
        classes[:, :3] = 1
    else:
        values = _light(baked, box)
    for to, slab in zip(values, baked.shape.values[box], strict=True):
        to[..., 3] = color.quantise(levels_of(slab, window))
    return BakedTexture(values, classes, corner)


def transfer_classes(
    transfer: TransferFunction | None, window: tuple[float, float]
) -> NDArray[np.float32]:
    """Return linear colour and opacity (`LEVELS`, 4) from one CT number to another.

    Without a transfer function white, and the level itself as opacity.
    """
    classes = np.ones((LEVELS, 4), np.float32)
    places = np.linspace(*window, LEVELS)
    if transfer is None:
        classes[:, 3] = places
    else:
        classes[:, :3] = color.srgb_to_linear(transfer.color(places))
        classes[:, 3] = transfer.opacity(places)
    return classes


def levels_of(values: NDArray[Any], window: tuple[float, float]) -> NDArray[np.float32]:
    """Return where CT numbers lie in a window, in [0, 1]."""
    low, high = np.float32(window[0]), np.float32(window[1])
    levels: NDArray[np.float32] = np.clip((values.astype(np.float32) - low) / (high - low), 0, 1)
    return levels


def transfer_window(transfer: TransferFunction, volume: Grid) -> tuple[float, float]:
    """Return the CT numbers that levels stand for: all, but for metal far beyond the function's.

    What was cut off at the numbers where opacity begins and ends could not be interpolated: the
    surface between air and bone would move to the voxels.
    """
    low, high = volume.range
    first, last = float(transfer.values[0]), float(transfer.values[-1])
    reach = last - min(low, first)
    return max(low, first - 3 * reach), min(high, max(last + reach, low + reach))


def sample_box(space: GridSpace) -> tuple[slice, slice, slice]:
    """Return the box (z, y, x) of the samples, of voxels without a normal, and of those beside.

    Rays begin and end within a step of the box's sides, where they would miss a surface.
    """
    parts = [part for part in (space.samples, space.flat) if len(part)]
    low = np.maximum(np.min([part.low for part in parts], axis=0) - 1, 0)
    high = np.minimum(np.max([part.high for part in parts], axis=0) + 1, space.shape.counts)
    a, b, c = (slice(int(x), int(y)) for x, y in zip(low, high, strict=True))
    return a, b, c


def _box(baked: PaintedVolume) -> tuple[slice, slice, slice]:
    if baked.space is not None:
        return sample_box(baked.space)
    nz, ny, nx = baked.shape.counts
    return slice(0, nz), slice(0, ny), slice(0, nx)


def _colors(baked: PaintedVolume, box: tuple[slice, slice, slice]) -> NDArray[np.uint8]:
    """Return colours and opacity as baked; black as 1, as 0 stands for what was not shaded."""
    values = baked.rgba[box].copy()
    np.maximum(values[..., :3], 1, out=values[..., :3])
    return values


def _light(baked: PaintedVolume, box: tuple[slice, slice, slice]) -> NDArray[np.uint8]:
    """Return an array of the box with the display values of what the method returned."""
    space = baked.space
    assert space is not None
    assert baked.intensity is not None
    low = (box[0].start, box[1].start, box[2].start)
    size = (box[0].stop - low[0], box[1].stop - low[1], box[2].stop - low[2])
    values = np.zeros((*size, 4), np.uint8)
    flat = values.reshape(-1, 4)
    encoded = color.encode(baked.intensity, linear=baked.linear)
    # 0 stands for what was not shaded: between hidden voxels is nothing, whatever the transfer
    # function says of the numbers in between.
    flat[space.samples.flat(size, low), :3] = np.maximum(encoded, 1)
    if len(space.flat):
        flat[space.flat.flat(size, low), :3] = _FLAT
    return values


# --- actors -----------------------------------------------------------------------------------


def add_baked(window: Plotter, baked: PaintedVolume) -> vtkVolume:
    """Add a bake to a plotter, the transfer function asked where rays pass; return the actor."""
    found = texture(baked)
    actor = volume_actor(found.values, baked.shape, found.corner)
    march(actor, baked.shape, found.values[..., 3], found.classes, _LIGHT)
    window.renderer.AddVolume(actor)
    return actor


def repaint(actor: vtkVolume, baked: PaintedVolume) -> None:
    """Give an actor of `add_baked` the light of another bake of the same scale space."""
    refill(actor, texture(baked).values, baked.shape)


def add_rgba(window: Plotter, baked: PaintedVolume) -> vtkVolume:
    """Add a bake to a plotter without a shader of this program's; return the actor.

    Colours are those of voxels, interpolated; opacity follows from the CT number all the same.
    """
    found = texture(baked)
    found.values[..., :3] = baked.rgba[_box(baked)][..., :3]
    actor = volume_actor(found.values, baked.shape, found.corner)
    ray_caster(actor).UseJitteringOn()
    properties = actor.GetProperty()
    properties.IndependentComponentsOff()
    properties.SetScalarOpacity(_opacity(np.linspace(0, 255, LEVELS), found.classes[:, 3]))
    window.renderer.AddVolume(actor)
    return actor


def add_plain(window: Plotter, volume: Grid, transfer: TransferFunction) -> vtkVolume:
    """Add a volume to a plotter with VTK's own shading, for comparison; return the actor."""
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

    actor = volume_actor(volume.values, volume)
    ray_caster(actor).UseJitteringOn()  # grain instead of the wood grain of its regular steps
    places = np.linspace(*transfer_window(transfer, volume), LEVELS)
    colors = vtkColorTransferFunction()
    for place, shade in zip(places, transfer.color(places), strict=True):
        colors.AddRGBPoint(place, *map(float, shade))
    properties = actor.GetProperty()
    properties.SetColor(colors)
    properties.SetScalarOpacity(_opacity(places, transfer.opacity(places)))
    properties.ShadeOn()
    window.renderer.AddVolume(actor)
    return actor


def _opacity(places: NDArray[Any], values: NDArray[Any]) -> vtkPiecewiseFunction:
    from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction

    function = vtkPiecewiseFunction()
    for place, value in zip(places, values, strict=True):
        function.AddPoint(float(place), float(value))
    return function
