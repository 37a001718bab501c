"""Scale space: the normals of a shape smoothed by Gaussians of growing width.

The only step that knows what kind of shape it has. Everything after it works on samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from meshdepict.mesh import Mesh

__all__ = ["ScaleSpace", "resolve_width", "scale_space", "smooth_normals"]

Progress = Callable[[float, float], None]

# An angle is as accurate as the sums are small against the resultant ‖m‖: METHODS' rule says that
# below this share of the mass the tolerance no longer binds …
_LEAST_RESULTANT = 1e-3
# … and that below this one the direction is meaningless and the next finer normal is kept.
_NO_RESULTANT = 1e-6


class ScaleSpace:
    """Positions and unit normals of samples at every scale, from fine to coarse.

    Made by `scale_space`. Shading functions take it and ask for nothing else.

    Attributes
    ----------
    shape : Mesh
        What was sampled.
    points : (n, 3) array of float64
        World positions of the samples.
    ratio : float
        From one width to the next.
    widths : (scales + 1,) array of float64
        Gaussian widths in world units; ``widths[0]`` is 0, the shape's own normals.
    normals : (scales + 1, n, 3) array of float32
        Unit normals, fine to coarse.
    """

    def __init__(
        self,
        shape: Mesh,
        points: NDArray[np.float64],
        widths: NDArray[np.float64],
        ratio: float,
        planes: NDArray[np.float32],
    ) -> None:
        self.shape = shape
        self.points = points
        self.widths = widths
        self.ratio = ratio
        # Stored as (scale, axis, sample), so that kernels read each component in one sweep.
        self._planes = planes
        self._planes.setflags(write=False)

    @property
    def normals(self) -> NDArray[np.float32]:
        """Unit normals (scales + 1, n, 3), a read-only view."""
        return np.moveaxis(self._planes, 1, 2)

    @cached_property
    def turns(self) -> NDArray[np.float32]:
        """(scales, n) cosines n_i·n_{i+1} between the normals of consecutive scales."""
        return np.einsum("sax,sax->sx", self._planes[:-1], self._planes[1:])

    @property
    def finest_width(self) -> float:
        """σ_0 = σ_1 / ratio: what formulas that need a width for the unsmoothed scale take."""
        return float(self.widths[1]) / self.ratio if len(self.widths) > 1 else 0.0

    def __repr__(self) -> str:
        """Return the number of samples and the range of widths."""
        count = len(self.widths) - 1
        widths = f", widths {self.widths[1]:.4g} … {self.widths[-1]:.4g}" if count else ""
        return f"<ScaleSpace: {len(self.points):,} samples, {count} scales{widths}>"


def scale_space(
    shape: Mesh,
    *,
    scales: int = 9,
    width: float | str | None = None,
    ratio: float = math.sqrt(2),
    facing: int = 1,
    tolerance: float = 1e-4,
    progress: Progress | None = None,
) -> ScaleSpace:
    """Smooth the normals of a shape at a geometric series of widths (Exaggerated Shading, §3).

    For vertex i with mixed Voronoi areas A and normals n the smoothed normal is the direction of
    ``Σ_j A_j F(r_i·n_j) exp(−‖x_i − x_j‖² / 2σ²) n_j``, r_i being the next finer scale's normal.

    Parameters
    ----------
    shape : Mesh
    scales : int
        Number of smoothed sets, ≥ 0; the original normals come before them.
    width : float or str, optional
        First width σ_1 in world units, or "0.2%" of the bounding box's diagonal.
        Default: the median edge length.
    ratio : float
        From one width to the next, > 1; √2 in Exaggerated Shading, 1.7 in Local Light Alignment.
    facing : {0, 1}
        1: F(u) = (1 + u)/2, which keeps the two sides of a thin sheet apart.
        0: F = 1, the paper's formula to the letter.
    tolerance : float
        Largest angular error of a normal in radians, 1e-7 … 0.1.
    progress : callable, optional
        ``progress(done, total)``, called as the work goes on.

    Returns
    -------
    ScaleSpace

    Raises
    ------
    MeshdepictError
        For a parameter out of its range.
    """
    _check(scales, ratio, facing, tolerance)
    first = resolve_width(width, shape)
    with np.errstate(over="ignore"):
        widths = np.concatenate(([0.0], first * ratio ** np.arange(scales, dtype=float)))
    if not np.isfinite(widths).all():
        raise MeshdepictError(f"{scales} scales of ratio {ratio:g} grow beyond all numbers")
    planes = np.empty((scales + 1, 3, len(shape.vertices)), np.float32)
    planes[0] = shape.normals.T
    sums = _NormalSums(shape, facing, tolerance) if scales else None
    reference = shape.normals.T
    for scale in range(1, scales + 1):
        assert sums is not None
        reference = sums.direction(widths[scale], reference, _reporter(progress, scale, scales))
        planes[scale] = reference
    return ScaleSpace(shape, shape.vertices, widths, float(ratio), planes)


def smooth_normals(
    mesh: Mesh, width: float | str, *, facing: int = 1, tolerance: float = 1e-4
) -> NDArray[np.float32]:
    """Smooth the normals at one width, climbing to it by a ladder of ratio √2.

    The last rung of a `scale_space` whose widths are width·√2^−j, as long as they are no smaller
    than the median edge.

    Returns
    -------
    (n, 3) array of float32
        Unit normals.
    """
    last = resolve_width(width, mesh)
    rungs = 1 + max(0, math.floor(2 * math.log2(last / mesh.edge_length) + 1e-9))
    first = last * math.sqrt(2) ** (1 - rungs)
    space = scale_space(mesh, scales=rungs, width=first, facing=facing, tolerance=tolerance)
    return space.normals[-1]


def resolve_width(width: float | str | None, shape: Mesh) -> float:
    """Return a width in world units: a number, "0.2%" of the diagonal, or None, the median edge."""
    if width is None:
        return float(shape.edge_length)
    try:
        if isinstance(width, str) and width.strip().endswith("%"):
            resolved = float(width.strip()[:-1]) / 100 * shape.diagonal
        else:
            resolved = float(width)
    except (TypeError, ValueError):
        resolved = math.nan
    if not (0 < resolved < math.inf):
        raise MeshdepictError(
            f"width={width!r} is not a positive length, such as 0.5 (world units) or '0.2%' "
            "(of the diagonal)"
        )
    return resolved


class _NormalSums:
    """Area-weighted Gaussian sums of a mesh's normals, and the directions they point in."""

    def __init__(self, mesh: Mesh, facing: int, tolerance: float) -> None:
        self.points = mesh._unit_points
        self.unit = mesh.diagonal or 1.0
        self.facing = facing
        self.tolerance = tolerance
        areas = mesh._unit_areas / (mesh._unit_areas.max() or 1.0)
        n = mesh.normals.T
        mass = [areas]
        first = list(areas * n)
        # F is linear in r·n_j: facing needs the second moments Σ A G n nᵀ and nothing else.
        second = [areas * n[a] * n[b] for a, b in _SYMMETRIC] if facing else []
        self.channels = np.array(mass + first + second)

    def direction(
        self, width: float, reference: NDArray[Any], done: Callable[[float], None] | None
    ) -> NDArray[np.float64]:
        """Return the (3, n) unit normals at one width; ``reference`` are the next finer ones."""
        from meshdepict.gaussian import gaussian_sums

        # A first pass for resultants that are a fair share of the mass …
        error = self.tolerance / 4
        # Narrower than any two distinct positions can be apart, a Gaussian is a single point.
        scaled = max(width / self.unit, 1e-18)
        sums = gaussian_sums(self.points, self.channels, scaled, error=error, done=done)
        vector, mass = self._resultant(sums, reference)
        length = np.linalg.norm(vector, axis=0)
        # … and a second for those that cancel: there the sums must be that much finer.
        some = mass > 0  # nowhere else is there a direction, or an error
        share = np.maximum(length, _LEAST_RESULTANT * mass) / np.where(some, mass, 1.0)
        weak = some & (error > self.tolerance * share)
        if weak.any():
            finer = float(self.tolerance * share[weak].min())
            again = gaussian_sums(
                self.points, self.channels, scaled,
                error=finer, targets=weak, heaviest=float(sums[0].max()),
            )  # fmt: skip
            vector = vector.astype(np.float64)
            v, mass[weak] = self._resultant(again[:, weak], reference[:, weak])
            vector[:, weak] = v
            length = np.linalg.norm(vector, axis=0)
        firm = length > _NO_RESULTANT * mass
        return np.where(firm, vector / np.where(firm, length, 1.0), reference)

    def _resultant(
        self, sums: NDArray[Any], reference: NDArray[Any]
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return m = Σ A F G n (3, n) and its mass Σ A F G (n,)."""
        mass, m1 = sums[0], sums[1:4]
        if not self.facing:
            return m1.copy(), mass.copy()
        vector = m1.copy()
        for row, (a, b) in zip(sums[4:], _SYMMETRIC, strict=True):
            vector[a] += row * reference[b]
            if a != b:
                vector[b] += row * reference[a]
        return vector / 2, (mass + np.einsum("ij,ij->j", m1, reference)) / 2


_SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def _check(scales: int, ratio: float, facing: int, tolerance: float) -> None:
    if isinstance(scales, bool) or int(scales) != scales or not 0 <= scales <= 64:
        raise MeshdepictError(f"scales={scales!r} is not a whole number from 0 to 64")
    if not 1 < ratio <= 10:
        raise MeshdepictError(f"ratio={ratio!r} is not a number above 1 and up to 10")
    if facing not in (0, 1):
        raise MeshdepictError(f"facing={facing!r} is neither 0 (the paper's sum) nor 1")
    if not 1e-7 <= tolerance <= 0.1:
        raise MeshdepictError(f"tolerance={tolerance!r} is not an angle from 1e-7 to 0.1 radians")


def _reporter(progress: Progress | None, scale: int, scales: int) -> Callable[[float], None] | None:
    """Turn shares of one scale's work into ``progress(done, total)`` over all scales."""
    if progress is None:
        return None
    finished = 0.0

    def done(share: float) -> None:
        nonlocal finished
        finished = min(finished + share, 1.0)
        progress(scale - 1 + finished, scales)

    return done
