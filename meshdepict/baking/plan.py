"""What a bake is going to compute, and roughly what that costs: nothing that nobody reads."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking import costs
from meshdepict.baking.choices import Choices
from meshdepict.baking.machine import speed
from meshdepict.baking.pixel_widths import measured
from meshdepict.options import options_of
from meshdepict.scales.ladder import check_ladder, checked_scale, ladder
from meshdepict.scales.reads import Reads
from meshdepict.scene.environment import Environment
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.lengths import resolve_width
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.volume import Volume
from meshdepict.threads import thread_count

__all__ = ["Plan", "Step", "plan"]

Widths = NDArray[np.float64]
SetSeconds = Callable[[int], float]

# Bytes of a sample: a set of normals, curvatures with their directions, colours with what they were
# before; and of a mesh's vertex, and of a cell, in sums of normals at the widest.
_SET_BYTES = 12
_CURVATURE_BYTES = 40
_SEEN_BYTES = 44
_COLOR_BYTES = 40
_SUM_BYTES = 400
_CELL_BYTES = 32

_MEAN_ERROR = 1e-3
_AGAIN = 1.25  # first passes and, on scans, what is summed again with more accuracy
_RAYS_CROWD, _BENDS_CROWD = 0.16, 0.45  # see `crowded`


class Step(NamedTuple):
    """Something to be computed.

    Attributes
    ----------
    what, where : str
        In words.
    seconds : float
        Of one core.
    size : float
        Bytes that stay.
    shared : bool
        Whether all cores do it.
    """

    what: str
    where: str
    seconds: float
    size: float
    shared: bool = False


@dataclass(frozen=True)
class Plan:
    """What shading a shape takes.

    Attributes
    ----------
    reads : Reads
        What the method reads.
    sets : tuple of int
        The scales that are smoothed, those on the way to a coarser one, too.
    widths : (scales + 1,) array
        Of all scales that there are.
    steps : tuple of Step
    working : float
        Bytes that the largest step takes while it goes on.
    """

    reads: Reads
    sets: tuple[int, ...]
    widths: Widths
    steps: tuple[Step, ...]
    working: float

    @property
    def seconds(self) -> float:
        """Of one core, beside reading and writing files."""
        return sum(step.seconds for step in self.steps)

    @property
    def clock(self) -> float:
        """Seconds by the clock, on as many cores as there are."""
        cores = thread_count()
        return sum(step.seconds / (cores if step.shared else 1) for step in self.steps)

    @property
    def size(self) -> float:
        """Bytes at most, beside the shape itself."""
        return sum(step.size for step in self.steps) + self.working


def plan(shape: Mesh | HeightField | GBuffer | Volume, look: Choices) -> Plan:
    """Return what a bake of a shape computes.

    Seconds are those of `costs`, on a machine as fast as this one (`machine.speed`), and mostly
    right within 30 %: docs/accuracy.md says where not. How many samples will be summed again is not
    known before. Not in them is what a method does for itself, such as accessibility's search.

    Parameters
    ----------
    shape : Mesh, HeightField, GBuffer or Volume
    look : Choices

    Raises
    ------
    MeshdepictError
        For what can't be baked so.
    """
    look = look.of_kind(shape.kind)
    if isinstance(shape, HeightField):
        shape = shape.raised(look.z_factor)
    scales, ratio = look.ladder
    check_ladder(scales, ratio, look.facing, look.tolerance)
    width = look.width if isinstance(shape, GBuffer) else measured(look, shape).width
    widths = ladder(scales, ratio, resolve_width(width, shape))
    last = len(widths) - 1
    reads = look.reads(last)
    for scale in sorted(reads.sets, reverse=True):
        checked_scale(scale, last)
    count, seconds, working = _of_kind(shape, look, widths)
    # Volumes are smoothed at each width by itself, and meshes by the paper's sum.
    climbs = shape.kind == "image" or (shape.kind == "mesh" and bool(look.facing))
    sets = sorted(reads.sets - {0})
    if climbs and sets:
        sets = list(range(1, sets[-1] + 1))
    found = _steps(shape, look, reads, sets, widths, count, seconds)
    steps = tuple(step._replace(seconds=step.seconds / speed()) for step in found)
    smoothing = bool(sets or reads.means)
    return Plan(reads, tuple(sets), widths, steps, working * count if smoothing else 0.0)


def _steps(
    shape: Mesh | HeightField | GBuffer | Volume,
    look: Choices,
    reads: Reads,
    sets: list[int],
    widths: Widths,
    count: int,
    seconds: SetSeconds,
) -> Iterator[Step]:
    samples = f"{count:,} samples"
    yield Step("own normals", samples, _own(shape, count), _SET_BYTES * count)
    for scale in sets:
        where = f"scale {scale}, width {widths[scale]:.4g}"
        if scale not in reads.sets:
            where += ", on the way"
        yield Step("normals", where, seconds(scale), _SET_BYTES * count, shared=True)
    # An image's view curvature needs none of its own, unless a smoothed normal faces away.
    own = reads.curvature - reads.seen if shape.kind == "image" else reads.curvature | reads.seen
    for scale in sorted(own):
        crowd = costs.crowded(count, _BENDS_CROWD) if shape.kind == "mesh" else 1.0
        each = costs.CURVATURE_SECONDS[shape.kind] * crowd
        yield Step("curvature", f"scale {scale}", each * count, _CURVATURE_BYTES * count)
    for scale in sorted(reads.seen):
        where = f"scale {scale}, as the eye sees it"
        yield Step("curvature", where, costs.SEEN_SECONDS * count, _SEEN_BYTES * count)
    for scale in sorted(reads.means):
        mean = _mean(shape, widths, scale, count)
        yield Step("mean", f"width {widths[scale]:.4g}", mean, 0.0, shared=True)
    if reads.rays:
        crowd = costs.crowded(count, _RAYS_CROWD) if shape.kind == "mesh" else 1.0
        each = costs.RAY_SECONDS * reads.rays * crowd
        yield Step("rays", f"{reads.rays} of each sample", each * count, 0.0, shared=True)
    if any(value is None for value in look.fitted.values()) and sets:
        typical = costs.TYPICAL_SECONDS * count if shape.kind == "height field" else 0.0
        yield Step("tones", "that follow the shape", costs.TONES_SECONDS + typical, 0.0)
    if reads.seen or reads.curvature:
        yield Step("shading", samples, costs.SHADING_SECONDS * count, 0.0, shared=True)
    if lights := _panorama_lights(look):
        each = costs.LIGHT_SECONDS * lights * max(len(sets), 1)
        yield Step("lights", f"{lights} of an environment", each * count, 0.0, shared=True)
    yield Step("colours", samples, costs.COLOR_SECONDS[shape.kind] * count, _COLOR_BYTES * count)


def _own(shape: Mesh | HeightField | GBuffer | Volume, count: int) -> float:
    """Return the seconds of a shape's own normals: none where a mesh has them already."""
    if isinstance(shape, Mesh) and {"normals", "areas"} <= vars(shape).keys():
        return 0.0
    grid = costs.GRID_SECONDS * shape.values.size if isinstance(shape, Volume) else 0.0
    return costs.OWN_SECONDS[shape.kind] * count + grid


def _panorama_lights(look: Choices) -> int:
    """Return how many lights an environment becomes; 0 where there is none."""
    light, known = look.lit_by, options_of(look.function)
    panorama = isinstance(light, Environment) or (
        isinstance(light, str) and light.lower().endswith(".hdr")
    )
    if not panorama or "lights" not in known:
        return 0
    return int(look.options.get("lights", known["lights"].default))


def _of_kind(
    shape: Mesh | HeightField | GBuffer | Volume, look: Choices, widths: Widths
) -> tuple[int, SetSeconds, float]:
    """Return the number of samples, what a set of normals costs, and a sample's bytes in it."""
    if isinstance(shape, Mesh):
        from meshdepict.sums.gaussian import predicted_seconds

        channels = 9 if look.facing else 4

        def of_mesh(scale: int) -> float:
            width = max(float(widths[scale]) / (shape.diagonal or 1.0), 1e-18)
            found = predicted_seconds(
                shape.unit_points, width, channels=channels, error=look.tolerance / 4
            )
            edges = float(widths[scale]) / (shape.edge_length or 1.0)
            return _AGAIN * found * costs.sums_share(len(shape.vertices), edges)

        return len(shape.vertices), of_mesh, _SUM_BYTES
    if isinstance(shape, Volume):
        from meshdepict.color.transfer import for_volume
        from meshdepict.voxels.grid_samples import shaded_voxels

        shown = shaded_voxels(shape, None, for_volume(look.transfer, shape))
        count = int(np.count_nonzero(shown))
        return count, lambda scale: costs.VOXEL_SECONDS * count, shape.values.nbytes / max(count, 1)
    if isinstance(shape, HeightField):
        return shape.count, lambda scale: costs.CELL_SECONDS * shape.z.size, _CELL_BYTES
    from meshdepict.scales.bilateral import tap_counts

    height, width = shape.cropped(np.ones(len(shape.normals), np.float32)).shape
    taps = tap_counts(widths / shape.edge_length, within=max(height, width))
    pixels = height * width
    return len(shape.normals), lambda scale: costs.TAP_SECONDS * taps[scale - 1] * pixels, 64.0


def _mean(
    shape: Mesh | HeightField | GBuffer | Volume, widths: Widths, scale: int, count: int
) -> float:
    """Return the seconds of an average of one value over a width."""
    if isinstance(shape, Mesh):
        from meshdepict.sums.gaussian import predicted_seconds

        width = max(float(widths[scale]) / (shape.diagonal or 1.0), 1e-18)
        return predicted_seconds(shape.unit_points, width, channels=2, error=_MEAN_ERROR)
    if isinstance(shape, HeightField):
        return 2 * costs.CELL_SECONDS * shape.z.size
    if isinstance(shape, Volume):
        return 2 * costs.VOXEL_SECONDS * count
    taps = 8 * math.ceil(float(widths[scale]) / shape.edge_length) + 1
    return 4 * costs.TAP_SECONDS * taps * count
