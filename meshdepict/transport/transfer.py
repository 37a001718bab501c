"""Light from surface to surface and from the sky, as rays that are traced once.

R rays leave each sample, cosine-weighted mostly. What they meet is kept, so that any light that
goes from sample to sample, and any sky, costs a sum and no ray:

    (T B)_i = (1/R) Σ_hits Σ_corners w B_corner        S_i = (1/R) Σ_misses L(d)

A ray that meets a triangle is eight bytes (its number, and two barycentric weights of 16 bits), one
that gets away is two (the cell of the sky): a million faces with 64 rays take at most 256 MB, and
twice that while they are traced.

A face that is seen from behind sends nothing, unless its part of the surface is open: then both of
its sides are real, and alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import as_text, max_memory
from meshdepict.threads import each, kernel, spans, thread_count
from meshdepict.transport.rays import (
    AGAIN,
    BATCH,
    FIRST,
    RaySet,
    Steps,
    checked_rays,
    cosine_weighted,
    lifted,
    probed,
    ray_scene,
)
from meshdepict.transport.sky_cells import cell, sky_colors

if TYPE_CHECKING:
    from meshdepict.scene.environment import Environment
    from meshdepict.shapes.mesh import Mesh

__all__ = [
    "RAY_BYTES",
    "USUAL",
    "Leaving",
    "Probes",
    "Transfer",
    "fits_memory",
    "places",
    "probe_places",
    "traced_part",
    "traced_transfer",
]

Floats = NDArray[np.float64]
Single = NDArray[np.float32]
Ints = NDArray[np.int64]
Places = tuple[Floats, NDArray[Any], Floats]
Bend = Callable[[Single, Ints], None]

_WEIGHTS = 65_535  # of a barycentric coordinate of 1
RAY_BYTES = 16
"""What a ray takes at most while it is traced: 8 as it is kept, 8 until all are put together."""

_ANY = np.float32(-2)  # cosine that every ray's to the normal is above
_HORIZON = np.float32(0)


class Leaving(NamedTuple):
    """How rays leave samples.

    Attributes
    ----------
    height : callable
        How dense they are; see `rays.RaySet`. Whoever takes another than `cosine_weighted` has to
        weigh what they bring.
    bend : callable, optional
        Turns the directions (k, rays, 3) of the samples of some numbers (k,), in place, before rays
        leave along them. What goes below the horizon of the normal then counts for nothing: it
        brings no light, and is among the rays.
    samples : array of int, optional
        The samples' numbers; from 0 on unless given.
    """

    height: Callable[[Floats], Floats] = cosine_weighted
    bend: Bend | None = None
    samples: Ints | None = None

    def of(self, some: Ints) -> Leaving:
        """Return that of some of the samples."""
        return self._replace(samples=some if self.samples is None else self.samples[some])

    def turned(self, begin: int, end: int) -> Callable[[Single], None] | None:
        """Return what turns the directions of samples [begin, end)."""
        bend, numbers = self.bend, self.samples
        if bend is None:
            return None
        here = np.arange(begin, end) if numbers is None else numbers[begin:end]
        return lambda directions: bend(directions, here)


USUAL = Leaving()


@dataclass(frozen=True, eq=False)
class Transfer:
    """Where the rays from samples go: the operator T of light, and the sky that they see.

    Attributes
    ----------
    rays : int
        Of each sample.
    points, normals, lifts : (n, 3) arrays
        Of the samples: positions in the mesh's unit frame, unit normals, and where rays start off.
    surface : (v, 3) array
        Positions of the vertices that rays meet.
    faces : (m, 3) array of int32
        The triangles that rays meet.
    hits : (n + 1,) array of int64
        Where each sample's begin among the next two.
    triangle : (h,) array of int32
    weights : (h, 2) array of uint16
        Of a triangle's second and third corner, in 1/65535.
    misses : (n + 1,) array of int64
        Where each sample's begin among the next.
    sky : (s,) array of uint16
        Cells of the sky; see `sky_cells`.
    probes : Probes, optional
        What tells the error.
    """

    rays: int
    points: Floats
    normals: Single
    lifts: Single
    surface: Floats
    faces: NDArray[np.int32]
    hits: NDArray[np.int64]
    triangle: NDArray[np.int32]
    weights: NDArray[np.uint16]
    misses: NDArray[np.int64]
    sky: NDArray[np.uint16]
    probes: Probes | None = None

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.points)

    @property
    def nbytes(self) -> int:
        """Bytes that it takes beside the samples and the faces."""
        return sum(
            a.nbytes for a in (self.hits, self.triangle, self.weights, self.misses, self.sky)
        )

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return T B: what arrives of light that the surface sends, values (v,) or (v, c)."""
        columns = np.ascontiguousarray(values.reshape(len(values), -1), np.float32)
        out = np.empty((len(self), columns.shape[1]), np.float32)
        each(
            lambda a, b: _gather(
                self.hits, self.triangle, self.weights, self.faces, columns,
                np.float32(1 / self.rays), a, b, out,
            ),
            spans(len(self), thread_count()),
        )  # fmt: skip
        return out.reshape(len(self), *values.shape[1:])

    def from_sky(self, environment: Environment) -> Single:
        """Return S (n, 3): what arrives of an environment, 1 under an open sky of radiance 1."""
        colors, out = sky_colors(environment, self.rays), np.empty((len(self), 3), np.float32)
        each(
            lambda a, b: _seen_sky(
                self.misses, self.sky, colors, np.float32(1 / self.rays), a, b, out
            ),
            spans(len(self), thread_count()),
        )
        return out

    @property
    def sky_share(self) -> Single:
        """(n,) shares of the rays that get away."""
        return (np.diff(self.misses) / self.rays).astype(np.float32)


@dataclass(frozen=True, eq=False)
class Probes:
    """A second, independent set of rays from some of the samples.

    Attributes
    ----------
    chosen : (k,) array of int
        Which samples.
    transfer : Transfer or Retraced
        Of those, as many rays from each.
    """

    chosen: NDArray[np.int64]
    transfer: Any

    def error(self, values: NDArray[Any], again: NDArray[Any]) -> float:
        """Return the rms error of values (n, …), from those (k, …) that the second set found."""
        if not len(self.chosen):
            return 0.0
        difference = np.asarray(values, np.float64)[self.chosen] - again
        return float(np.sqrt(np.mean(difference**2) / 2))


def fits_memory(samples: int, rays: int) -> bool:
    """Whether so many rays from each of so many samples can be kept in the memory allowed."""
    return RAY_BYTES * rays * samples <= max_memory()


def traced_transfer(
    mesh: Mesh,
    *,
    normals: NDArray[Any] | None = None,
    rays: int = 64,
    part: slice = slice(None),
    how: Leaving = USUAL,
    done: Callable[[int], None] | None = None,
) -> Transfer:
    """Trace the rays from the vertices of a mesh, and of a thousand of them once more.

    Parameters
    ----------
    mesh : Mesh
    normals : (n, 3) array, optional
        Unit, of its vertices, in place of its own.
    rays : int
        Per vertex, 2 … 65536.
    part : slice
        Of which vertices; all unless given.
    how : Leaving
        Cosine-weighted unless given.
    done : callable, optional
        Called with the number of a finished batch.

    Raises
    ------
    MeshdepictError
        For another number of rays, and for more than memory holds.
    """
    count = checked_rays(rays)
    at = places(mesh, normals, part)
    if not fits_memory(len(at[0]), count):
        needed = RAY_BYTES * count * len(at[0])
        raise MeshdepictError(
            f"rays={count} from {len(at[0]):,} samples may take {as_text(needed)}, more "
            f"than the {as_text(max_memory())} of memory that are allowed: take fewer, or allow "
            "more with --max-memory"
        )
    chosen, again, steps = probe_places(at)
    second = traced_part(mesh, again, count, steps=steps, how=how.of(chosen))
    return _traced(mesh, *at, count, FIRST, how=how, probes=Probes(chosen, second), done=done)


def places(mesh: Mesh, normals: NDArray[Any] | None = None, part: slice = slice(None)) -> Places:
    """Return points, normals and where rays start off (n, 3) of a mesh's vertices, or of a part."""
    where = mesh.normals if normals is None else np.asarray(normals)
    return mesh.unit_points[part], where[part], lifted(mesh.unit_points, where)[part]


def probe_places(at: Places) -> tuple[NDArray[np.int64], Places, Steps]:
    """Return which samples tell the error, what `places` says of them, and by which rays."""
    chosen = probed(len(at[0]))
    points, normals, lifts = (each[chosen] for each in at)
    return chosen, (points, normals, lifts), AGAIN


def traced_part(
    mesh: Mesh,
    at: Places,
    rays: int,
    *,
    steps: Steps = FIRST,
    how: Leaving = USUAL,
    done: Callable[[int], None] | None = None,
) -> Transfer:
    """Trace the rays of some samples; ``at`` as `places` has them."""
    return _traced(mesh, *at, rays, steps, how=how, done=done)


def _traced(
    mesh: Mesh,
    points: Floats,
    normals: NDArray[Any],
    lifts: Floats,
    rays: int,
    steps: Steps,
    *,
    how: Leaving,
    probes: Probes | None = None,
    done: Callable[[int], None] | None = None,
) -> Transfer:
    scene, ray_set = ray_scene(mesh), RaySet(rays, how.height)
    least = _ANY if how.bend is None else _HORIZON
    outward = mesh.outward_faces
    a, b, c = (mesh.unit_points[corner] for corner in outward.T)
    facing = np.cross(b - a, c - a)
    largest = np.abs(facing).max(axis=1, keepdims=True)
    facing = (facing / np.where(largest > 0, largest, 1)).astype(np.float32)
    facing[mesh.open_faces] = 0  # never seen from behind
    # Embree counts u and v from the corners as the scene has them, turned or not.
    faces = mesh.faces.astype(np.int32)
    batch = max(1, BATCH // rays)
    pieces = spans(len(points), -(-len(points) // batch))
    parts: list[Any] = [None] * len(pieces)

    def work(number: int, begin: int, end: int) -> None:
        here = slice(begin, end)
        axes = np.asarray(normals[here], np.float64)
        bundle = ray_set.leaving(
            points[here], lifts[here], axes, steps, ahead=True, bend=how.turned(begin, end)
        )
        met = scene.run(*bundle.flat, query="INTERSECT", output=True)
        size = (end - begin) * rays
        counts = np.zeros((2, end - begin), np.int64)
        triangle, weights = np.empty(size, np.int32), np.empty((size, 2), np.uint16)
        sky = np.empty(size, np.uint16)
        hit, missed = _sorted_out(
            bundle.directions, axes.astype(np.float32), least, met["primID"], met["u"], met["v"],
            facing, counts, triangle, weights, sky,
        )  # fmt: skip
        parts[number] = counts, triangle[:hit].copy(), weights[:hit].copy(), sky[:missed].copy()

    each(work, [(i, *piece) for i, piece in enumerate(pieces)], done)
    counts = np.concatenate([part[0] for part in parts], axis=1)
    hits, misses = np.concatenate([np.zeros((2, 1), np.int64), counts.cumsum(axis=1)], axis=1)
    triangle, weights, sky = (np.concatenate([part[i] for part in parts]) for i in (1, 2, 3))
    found = Transfer(
        rays, points, np.asarray(normals, np.float32), np.asarray(lifts, np.float32),
        mesh.unit_points, faces, hits, triangle, weights, misses, sky,
        probes,
    )  # fmt: skip
    for array in (found.normals, found.lifts, faces, hits, triangle, weights, misses, sky):
        array.setflags(write=False)
    return found


@kernel()
def _sorted_out(  # type: ignore[no-untyped-def]
    directions, normals, least, met, u, v, facing, counts, triangle, weights, sky
):
    """Part the rays of a batch into those that meet a face and those that get away."""
    samples, rays = directions.shape[:2]
    hit = missed = 0
    for i in range(samples):
        for j in range(rays):
            k = i * rays + j
            f = met[k]
            x, y, z = directions[i, j, 0], directions[i, j, 1], directions[i, j, 2]
            if x * normals[i, 0] + y * normals[i, 1] + z * normals[i, 2] <= least:
                continue
            if f < 0:
                sky[missed] = cell(x, y, z)
                missed += 1
                counts[1, i] += 1
            elif x * facing[f, 0] + y * facing[f, 1] + z * facing[f, 2] <= 0:
                triangle[hit] = f
                second = min(max(u[k], np.float32(0)), np.float32(1))
                third = min(max(v[k], np.float32(0)), np.float32(1) - second)
                weights[hit, 0] = int(second * _WEIGHTS + 0.5)
                weights[hit, 1] = int(third * _WEIGHTS)
                hit += 1
                counts[0, i] += 1
    return hit, missed


@kernel("contracted")
def _gather(hits, triangle, weights, faces, values, share, begin, end, out):  # type: ignore[no-untyped-def]
    """Sum what the rays of samples [begin, end) meet."""
    unit = np.float32(1 / _WEIGHTS)
    for i in range(begin, end):
        for channel in range(values.shape[1]):
            total = np.float32(0)
            for k in range(hits[i], hits[i + 1]):
                f = triangle[k]
                second, third = weights[k, 0] * unit, weights[k, 1] * unit
                first = max(np.float32(1) - second - third, np.float32(0))
                total += (
                    first * values[faces[f, 0], channel]
                    + second * values[faces[f, 1], channel]
                    + third * values[faces[f, 2], channel]
                )
            out[i, channel] = total * share


@kernel()
def _seen_sky(misses, sky, colors, share, begin, end, out):  # type: ignore[no-untyped-def]
    """Sum the sky that the rays of samples [begin, end) see."""
    for i in range(begin, end):
        red = green = blue = np.float32(0)
        for k in range(misses[i], misses[i + 1]):
            c = sky[k]
            red += colors[c, 0]
            green += colors[c, 1]
            blue += colors[c, 2]
        out[i, 0], out[i, 1], out[i, 2] = red * share, green * share, blue * share
