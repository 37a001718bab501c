"""Noise of light that came by rays, smoothed between neighbours as far as that makes it better.

Neighbours err independently, so that a mean over N of them errs 1/√N as much. How much light comes
to a surface depends on where it looks, though, and most of all if none is in the way: exactly
linearly. So it is no mean that is taken, but the plane through light over normals that fits the
neighbours best, where it is for the sample's own normal. Both sides of a sheet have one, too.

Widths of the Gaussians are tried from narrow to wide. What each washes out is known: a second,
independent set of rays tells of smoothed light how far it is off, as it does of light as it came.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.patches import PatchSums

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["WIDTHS", "LightSmoothing", "calmed"]

Single = NDArray[np.float32]
Floats = NDArray[np.float64]

WIDTHS = (0.35, 0.5, 0.7, 1.0, 1.4)
"""Of the Gaussians, in edge lengths; means of 1.5 to 25 neighbours."""

_ERROR = 1e-4  # of a sum, relative
_LEAST = 1e-6  # of the mass of a large vertex that must be around; else a sample keeps what it has
# Added to the variance of normals: where they differ by less than 3° no slope can be told from
# noise. Found on the bunny: a tenth of it or ten times as much leaves more error.
_RIDGE = 3e-3
_SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class LightSmoothing:
    """Local fits of light over normals, to the vertices of a mesh under a Gaussian.

    Parameters
    ----------
    mesh : Mesh
    normals : (n, 3) array
        Unit, of its vertices.
    width : float
        Standard deviation in world units.

    Attributes
    ----------
    left : float
        Share of the variance of independent errors that is left, on average.
    """

    def __init__(self, mesh: Mesh, normals: NDArray[Any], width: float) -> None:
        self._points, self._patches = mesh.unit_points, getattr(mesh, "patches", None)
        self._width = max(width / (mesh.diagonal or 1.0), 1e-18)
        self._areas = mesh.unit_areas / (mesh.unit_areas.max() or 1.0)
        self._normals = n = np.asarray(normals, np.float64).T
        moments = np.vstack([np.ones_like(n[:1]), n, [n[a] * n[b] for a, b in _SYMMETRIC]])
        sums = self._sums(self._areas * moments)
        self._fits = (self._areas > 0) & (sums[0] > _LEAST)  # not what no face has
        self._mass = np.where(self._fits, sums[0], 1)
        self._mean = sums[1:4] / self._mass
        spread = _matrices(sums[4:] / self._mass) - _outer(self._mean)
        off = (n - self._mean).T[..., None]
        self._slope = np.linalg.solve(spread + _RIDGE * np.eye(3), off)[..., 0].T
        self.left = self._left(moments)

    def __call__(self, values: NDArray[Any]) -> Single:
        """Return values (n,) or (n, c), smoothed."""
        columns = np.array(values, np.float64).reshape(len(values), -1)
        for column in columns.T:
            largest = float(np.abs(column).max(initial=0)) or 1.0
            parts = self._areas * (column / largest)
            sums = self._sums(np.vstack([self._areas, parts, parts * self._normals]))
            mean = sums[1] / self._mass
            slope = sums[2:] / self._mass - self._mean * mean
            fitted = mean + (self._slope * slope).sum(axis=0)
            column[self._fits] = largest * fitted[self._fits]
        return columns.reshape(values.shape).astype(np.float32)

    def _left(self, moments: Floats) -> float:
        """Return the mean of Σ w², w the weight that a fit gives to each neighbour."""
        # A Gaussian's square is a Gaussian of 1/√2 of its width.
        sums = self._sums(self._areas**2 * moments, self._width / math.sqrt(2))
        begin = 1 - (self._slope * self._mean).sum(axis=0)  # w = A G (begin + slope · n) / mass
        square = begin**2 * sums[0] + 2 * begin * (self._slope * sums[1:4]).sum(axis=0)
        square += np.einsum("in,nij,jn->n", self._slope, _matrices(sums[4:]), self._slope)
        share = square[self._fits] / self._mass[self._fits] ** 2
        return float(np.clip(share, 0, 1).mean()) if self._fits.any() else 1.0

    def _sums(self, channels: Floats, width: float | None = None) -> Floats:
        wide = width or self._width
        found = PatchSums(self._patches, self._points, channels, (wide,)).at(wide, error=_ERROR)
        return np.asarray(found, np.float64)


def calmed(
    mesh: Mesh,
    normals: NDArray[Any],
    light: Single,
    told: Callable[[Single, float], float],
    errors: tuple[float, float],
) -> tuple[Single, float]:
    """Return light with as little smoothing as leaves the error that is allowed, and its error.

    Where none does it is the light with the least error, smoothed or as it came.

    Parameters
    ----------
    mesh, normals
        See `LightSmoothing`.
    light : (n,) or (n, c) array
    told : callable (light, share of the variance of noise that is left) → its error
    errors : (float, float)
        In the same units: what is allowed, and what there is.
    """
    allowed, least = errors
    best = light
    for width in WIDTHS:
        if least <= allowed:
            break
        smoothing = LightSmoothing(mesh, normals, width * mesh.edge_length)
        smooth = np.maximum(smoothing(light), 0)
        if (error := told(smooth, smoothing.left)) < least:
            best, least = smooth, error
    return best, least


def _matrices(rows: Floats) -> Floats:
    """Return the symmetric matrices (n, 3, 3) of six rows (6, n)."""
    found = np.empty((rows.shape[1], 3, 3))
    for row, (a, b) in zip(rows, _SYMMETRIC, strict=True):
        found[:, a, b] = found[:, b, a] = row
    return found


def _outer(vectors: Floats) -> Floats:
    """Return the products (n, 3, 3) of vectors (3, n) with themselves."""
    return np.asarray(vectors.T[:, :, None] * vectors.T[:, None, :])
