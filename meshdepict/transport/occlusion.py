"""What the surface hides from itself, asked with rays: ambient occlusion and the view of the sky.

The rays of a point are a Fibonacci lattice on the hemisphere, shifted by two numbers that depend on
the point's position alone: the same mesh gives the same values whatever the order of its vertices
or the number of threads, and neighbours err independently.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.threads import each, spans

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["MOST_RAYS", "Openness", "ambient_openness", "sky_openness", "zenith_angles"]

Floats = NDArray[np.float64]
At = tuple[NDArray[Any], NDArray[Any]]

MOST_RAYS = 65_536
_OFFSET = 1e-5  # of a ray's start from the surface, in diagonals: 100 roundings in float32
_BATCH = 65_536  # rays that are traced at once: three megabytes, however large the mesh
_GOLDEN = (math.sqrt(5) - 1) / 2
_GRID = 2.0**20  # positions this share of a diagonal apart have different shifts
# Powers of the roots of xⁿ = x + 1, n = 4 … 7: their multiples fill the unit interval evenly. Two
# rows make a set's shifts: those of the values, and those of the set that tells their error.
_STEPS = np.array(
    [
        [0.8191725133961645, 0.6710436067037893, 0.5497004779019703],
        [0.8566748838545029, 0.7338918566271260, 0.6287067210378087],
        [0.8812714616335696, 0.7766393890897682, 0.6844301295853426],
        [0.8986537126286993, 0.8075784952213448, 0.7257334129697598],
    ]
)
_PROBES = 1024  # points, at least, at which the error is looked at: it is then known to 5 %


class Openness(NamedTuple):
    """The share of the light from all around that reaches each point.

    Attributes
    ----------
    values : (n,) array of float32
        In [0, 1]: 1 where nothing is in the way.
    error : float
        Root mean square error over the points, estimated from a second set of as many rays,
        shifted independently, at a thousand of the points. Two halves of one set won't do: the
        rays of one fill the gaps of the other, and their difference is 1.4 to 2.3 times too large.
    """

    values: NDArray[np.float32]
    error: float


def ambient_openness(
    mesh: Mesh,
    *,
    at: At | None = None,
    rays: int = 256,
    done: Callable[[int], None] | None = None,
) -> Openness:
    """Return (1/π) ∫ max(0, n·ω) V(ω) dω at every point, V being 1 where a ray gets away.

    Parameters
    ----------
    mesh : Mesh
        What rays can meet.
    at : two (n, 3) arrays, optional
        World positions and unit normals; the mesh's vertices unless given.
    rays : int
        Per point, 2 … 65536, cosine-weighted. The error falls about as rays^−¾.
    done : callable, optional
        Called with the number of a finished batch.

    Raises
    ------
    MeshdepictError
        For another number of rays.
    """
    count = _checked(rays)

    def height(share: Floats) -> Floats:
        return np.sqrt(1 - share)

    points, normals = _places(mesh, at)
    return _traced(mesh, (points, normals), count, height, normals, weigh=False, done=done)


def sky_openness(
    mesh: Mesh,
    towards: NDArray[Any],
    *,
    at: At | None = None,
    spread: float = 90.0,
    rays: int = 256,
    even: bool = False,
    radius: float | None = None,
    done: Callable[[int], None] | None = None,
) -> Openness:
    """Return the share of the light of a cap of sky that reaches every point.

    ∫ max(0, n·ω) V(ω) dω over the directions within ``spread`` of ``towards``, relative to what an
    open surface that faces the cap's middle gets; ``even``, the share of the cap that is seen.

    Parameters
    ----------
    mesh : Mesh
        What rays can meet.
    towards : (3,) or (n, 3) array
        Unit vectors to the middle of the sky.
    at : two (n, 3) arrays, optional
        World positions and unit normals; the mesh's vertices unless given.
    spread : float
        Half the cap's opening in degrees, up to 90.
    rays : int
        Per point, 2 … 65536, evenly over the cap.
    even : bool
        Whether directions weigh the same, whatever their angle to the surface.
    radius : float, optional
        Farther away nothing hides the sky; in world units.
    done : callable, optional
        Called with the number of a finished batch.

    Raises
    ------
    MeshdepictError
        For another number of rays.
    """
    count = _checked(rays)
    least = math.cos(math.radians(spread))

    def height(share: Floats) -> Floats:
        return 1 - share * (1 - least)

    points, normals = _places(mesh, at)
    axes = np.broadcast_to(towards, normals.shape)
    return _traced(
        mesh, (points, normals), count, height, axes,
        weigh=not even, reach=_reach(mesh, radius), done=done,
    )  # fmt: skip


def zenith_angles(
    mesh: Mesh,
    towards: NDArray[Any],
    *,
    at: At,
    rays: int = 256,
    radius: float | None = None,
    done: Callable[[int], None] | None = None,
) -> NDArray[np.float32]:
    """Return how far from the zenith the sky is seen, on average round about: openness, in degrees.

    Rays leave evenly over azimuths and zenith angles from 0 to 180°; the share of those that get
    away, times 180°, is mean(90° − γ) with γ the horizon's elevation where nothing overhangs.

    Parameters
    ----------
    mesh, at, rays, radius, done
        As for `sky_openness`.
    towards : (3,) or (n, 3) array
        Unit vectors to the zenith.

    Returns
    -------
    (n,) array of float32
        90 on a plane.
    """
    count = _checked(rays)

    def height(share: Floats) -> Floats:
        return np.cos(np.pi * share)

    points, normals = _places(mesh, at)
    axes = np.broadcast_to(towards, normals.shape)
    found = _traced(
        mesh, (points, normals), count, height, axes,
        weigh=False, reach=_reach(mesh, radius), done=done,
    )  # fmt: skip
    return found.values * np.float32(180)


def _reach(mesh: Mesh, radius: float | None) -> float | None:
    """Return a radius in the mesh's unit frame."""
    return None if radius is None else radius / (mesh.diagonal or 1.0)


def _places(mesh: Mesh, at: At | None) -> tuple[Floats, Floats]:
    """Return positions in the mesh's unit frame, and normals."""
    if at is None:
        return mesh.unit_points, mesh.normals
    points, normals = at
    return mesh.recentred(points), np.asarray(normals)


def _checked(rays: int) -> int:
    if isinstance(rays, bool) or int(rays) != rays or not 2 <= rays <= MOST_RAYS:
        raise MeshdepictError(f"rays={rays!r} is not a whole number from 2 to {MOST_RAYS}")
    return int(rays)


def _traced(
    mesh: Mesh,
    places: tuple[Floats, Floats],
    rays: int,
    height: Callable[[Floats], Floats],
    axes: Floats,
    *,
    weigh: bool,
    reach: float | None = None,
    done: Callable[[int], None] | None,
) -> Openness:
    """Trace rays round each point's axis; weigh them by the cosine to its normal where asked to.

    ``height`` turns a share in [0, 1] of all rays into their cosine to the axis, from 1 downwards.
    """
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    points, normals = places
    scene = EmbreeScene()
    TriangleMesh(scene, mesh.unit_points.astype(np.float32), mesh.faces.astype(np.int32))
    number = np.arange(rays, dtype=np.float32)
    angle = 2 * np.pi * (np.arange(rays) * _GOLDEN % 1)
    cos, sin = np.cos(angle).astype(np.float32), np.sin(angle).astype(np.float32)
    whole = np.ones(rays) if not weigh else height((np.arange(rays) + 0.5) / rays)

    def shares(here: slice, steps: Floats) -> Floats:
        turn, shift = (np.floor(points[here] * _GRID) @ steps.T % 1).T.astype(np.float32)
        frame = _frames(axes[here], turn)
        up = height((number + shift[:, None]) / np.float32(rays))
        level = np.sqrt(np.maximum(1 - up * up, 0))
        local = level * cos, level * sin, up
        # All rays of a point one after the other: they meet the same boxes of Embree's tree.
        directions = np.empty((*up.shape, 3), np.float32)
        for axis in range(3):  # rather than over (…, 3) at once, which takes twice as long
            x, y, z = (v[:, axis, None] for v in frame)
            directions[..., axis] = local[0] * x + local[1] * y + local[2] * z
        starts = (points[here] + _OFFSET * normals[here]).astype(np.float32)
        origins = np.repeat(starts, rays, axis=0)
        far = {} if reach is None else {"dists": np.full(len(origins), reach, np.float32)}
        if not weigh:
            hit = scene.run(origins, directions.reshape(-1, 3), query="OCCLUDED", **far)
            light = (hit < 0).reshape(up.shape)
        else:
            light = np.einsum("ij,ikj->ik", normals[here].astype(np.float32), directions)
            lit = np.flatnonzero(light > 0)
            if len(lit):
                rays_lit = origins[lit], directions.reshape(-1, 3)[lit]
                few = {name: limit[: len(lit)] for name, limit in far.items()}
                light.flat[lit[scene.run(*rays_lit, query="OCCLUDED", **few) >= 0]] = 0
            light = np.maximum(light, 0)
        # Every other ray first: in double precision the two sums stay what they always were.
        sums = light[:, ::2].sum(axis=1).astype(float) + light[:, 1::2].sum(axis=1)
        return np.asarray(sums / whole.sum())

    values, again = np.zeros(len(points)), np.zeros(len(points))
    batch = max(1, _BATCH // rays)
    apart = max(1, len(points) // _PROBES)

    def work(begin: int, end: int) -> None:
        values[begin:end] = shares(slice(begin, end), _STEPS[:2])

    def probe(begin: int, end: int) -> None:
        here = slice(begin * apart, end * apart, apart)
        again[here] = shares(here, _STEPS[2:])

    each(work, spans(len(points), -(-len(points) // batch)), done)
    probes = len(points[::apart])
    each(probe, spans(probes, -(-probes // batch)))
    difference = (values - again)[::apart]
    error = float(np.sqrt(np.mean(difference**2) / 2))
    return Openness(np.clip(values, 0, 1).astype(np.float32), error)


def _frames(axes: Floats, turn: Floats) -> tuple[NDArray[np.float32], ...]:
    """Return right-handed frames (x, y, z), each (n, 3), z along the axes, x and y turned."""
    helper = np.eye(3)[np.abs(axes).argmin(axis=1)]  # never parallel to the axis
    x = np.cross(helper, axes)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(axes, x)
    cos, sin = np.cos(2 * np.pi * turn)[:, None], np.sin(2 * np.pi * turn)[:, None]
    return tuple(v.astype(np.float32) for v in (cos * x + sin * y, cos * y - sin * x, axes))
