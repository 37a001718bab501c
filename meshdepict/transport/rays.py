"""Rays that leave samples: an even set on a hemisphere or a cap, turned for each by a shift.

The rays of a point are a Fibonacci lattice, shifted by two numbers that depend on the point's
position alone: the same mesh gives the same values whatever the order of its vertices or the number
of threads, and neighbours err independently. A second set, shifted independently of the first,
tells how much. Two halves of one set won't do: the rays of one fill the gaps of the other, and
their difference is 1.4 to 2.3 times too large.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.surface.welding import same_position

if TYPE_CHECKING:
    from embreex.rtcore_scene import EmbreeScene

    from meshdepict.shapes.mesh import Mesh

__all__ = [
    "AGAIN",
    "AHEAD",
    "BATCH",
    "FIRST",
    "MOST_RAYS",
    "OFFSET",
    "Bundle",
    "RaySet",
    "Steps",
    "checked_rays",
    "cosine_weighted",
    "half_even",
    "lifted",
    "probed",
    "ray_scene",
    "started",
]  # fmt: skip

Floats = NDArray[np.float64]
Single = NDArray[np.float32]
Steps = NDArray[np.float64]

MOST_RAYS = 65_536
BATCH = 65_536
"""Rays that are traced at once: three megabytes, however large the mesh."""

OFFSET = 1e-5  # of a ray's start from the surface, in diagonals: 100 roundings in float32
AHEAD = np.float32(0.25 * OFFSET)
"""Of a ray that begins further on: less than what lifts a start off the walls of its corner."""
_GOLDEN = (math.sqrt(5) - 1) / 2
_GRID = 2.0**20  # positions this share of a diagonal apart have different shifts
# Powers of the roots of xⁿ = x + 1, n = 4 … 7: their multiples fill the unit interval evenly. Two
# rows make a set's shifts.
_STEPS = np.array(
    [
        [0.8191725133961645, 0.6710436067037893, 0.5497004779019703],
        [0.8566748838545029, 0.7338918566271260, 0.6287067210378087],
        [0.8812714616335696, 0.7766393890897682, 0.6844301295853426],
        [0.8986537126286993, 0.8075784952213448, 0.7257334129697598],
    ]
)
FIRST, AGAIN = _STEPS[:2], _STEPS[2:]
"""What shifts the set that values come from, and the one that tells their error."""

_AGREE = 0.1  # least cosine between a normal and the mean of those at its position
_PROBES = 1024  # points, at least, at which the error is looked at: it is then known to 5 %

_scenes: WeakKeyDictionary[Mesh, EmbreeScene] = WeakKeyDictionary()


class Bundle(NamedTuple):
    """The rays of some points, all of a point one after the other: they meet the same boxes.

    Attributes
    ----------
    origins : (n · rays, 3) array of float32
    directions : (n, rays, 3) array of float32
    """

    origins: Single
    directions: Single

    @property
    def flat(self) -> tuple[Single, Single]:
        """Origins and directions as Embree takes them."""
        return self.origins, self.directions.reshape(-1, 3)


class RaySet:
    """Directions about an axis, the same for every point but for how they are turned.

    Parameters
    ----------
    rays : int
    height : callable
        Turns a share in [0, 1] of all rays into their cosine to the axis, from 1 downwards.
    """

    def __init__(self, rays: int, height: Callable[[Floats], Floats]) -> None:
        self.rays, self._height = rays, height
        self._number = np.arange(rays, dtype=np.float32)
        angle = 2 * np.pi * (np.arange(rays) * _GOLDEN % 1)
        self._cos, self._sin = np.cos(angle).astype(np.float32), np.sin(angle).astype(np.float32)

    def leaving(
        self,
        points: Floats,
        lifts: Floats,
        axes: Floats,
        steps: Steps,
        *,
        ahead: bool = False,
        bend: Callable[[Single], None] | None = None,
    ) -> Bundle:
        """Return the rays from points a little above a surface.

        Parameters
        ----------
        points : (n, 3) array
            In a mesh's unit frame.
        lifts, axes : (n, 3) arrays
            Unit vectors: away from the surface, and in the middle of the rays.
        steps : (2, 3) array
            `FIRST` or `AGAIN`.
        ahead : bool
            Whether rays also begin a little further on: from a point within another part's face,
            as at the foot of what stands on a table, that is on the side to which they go.
        bend : callable, optional
            Turns directions (n, rays, 3), in place, before rays leave along them.
        """
        turn, shift = (np.floor(points * _GRID) @ steps.T % 1).T.astype(np.float32)
        frame = _frames(axes, turn)
        up = self._height((self._number + shift[:, None]) / np.float32(self.rays))
        level = np.sqrt(np.maximum(1 - up * up, 0))
        local = level * self._cos, level * self._sin, up
        directions = np.empty((*up.shape, 3), np.float32)
        for axis in range(3):  # rather than over (…, 3) at once, which takes twice as long
            x, y, z = (v[:, axis, None] for v in frame)
            directions[..., axis] = local[0] * x + local[1] * y + local[2] * z
        if bend is not None:
            bend(directions)
        origins = np.repeat(started(points, lifts), self.rays, axis=0)
        if ahead:
            origins += AHEAD * directions.reshape(-1, 3)
        return Bundle(origins, directions)


def started(points: Floats, lifts: Floats) -> Single:
    """Return where rays from points (n, 3) start, off the surface along unit vectors."""
    return (points + OFFSET * lifts).astype(np.float32)


def cosine_weighted(share: Floats) -> Floats:
    """Return heights of directions that are as dense as light from them counts."""
    return np.sqrt(1 - share)


def half_even(share: Floats) -> Floats:
    """Return heights u of directions of which half are cosine-weighted, and half evenly spread.

    Above u are (1 − u²)/2 + (1 − u)/2 of them: u² + u = 2 (1 − share).
    """
    return (np.sqrt(9 - 8 * share) - 1) / 2


def ray_scene(mesh: Mesh) -> EmbreeScene:
    """Return Embree's tree of a mesh's triangles, which is kept as long as the mesh."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = _scenes.get(mesh)
    if scene is None:
        scene = EmbreeScene()
        TriangleMesh(scene, mesh.unit_points.astype(np.float32), mesh.faces.astype(np.int32))
        # The tree is grown at the first ray: here, and not by two threads at once.
        scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32), query="OCCLUDED")
        _scenes[mesh] = scene
    return scene


def lifted(points: Floats, normals: NDArray[Any]) -> Floats:
    """Return the directions (n, 3) in which rays from points leave the surface.

    Where several points are at one position, as along a crease, it is off all that meets there: off
    one wall alone a ray starts within the next one, and might go through it. Points whose normals
    look away from the others' mean have their own.
    """
    own = np.asarray(normals, np.float64)
    position = same_position(points)
    if position is None:
        return own
    mean: Floats = np.stack([np.bincount(position, part) for part in own.T], axis=1)
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    mean = (mean / np.where(length > 0, length, 1))[position]
    agree = np.einsum("ij,ij->i", mean, own) > _AGREE
    return np.where(agree[:, None], mean, own)


def probed(count: int) -> NDArray[np.int64]:
    """Return which of so many points are looked at again for their error: a thousand or all."""
    return np.arange(0, count, max(1, count // _PROBES))


def checked_rays(rays: Any) -> int:
    """Return a number of rays.

    Raises
    ------
    MeshdepictError
        For none from 2 to 65536.
    """
    if isinstance(rays, bool) or int(rays) != rays or not 2 <= rays <= MOST_RAYS:
        raise MeshdepictError(f"rays={rays!r} is not a whole number from 2 to {MOST_RAYS}")
    return int(rays)


def _frames(axes: Floats, turn: Floats) -> tuple[Single, ...]:
    """Return right-handed frames (x, y, z), each (n, 3), z along the axes, x and y turned."""
    helper = np.eye(3)[np.abs(axes).argmin(axis=1)]  # never parallel to the axis
    x = np.cross(helper, axes)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(axes, x)
    cos, sin = np.cos(2 * np.pi * turn)[:, None], np.sin(2 * np.pi * turn)[:, None]
    return tuple(v.astype(np.float32) for v in (cos * x + sin * y, cos * y - sin * x, axes))
