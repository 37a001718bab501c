"""Principal curvatures of a mesh by a choice of estimators, with one sign, unit and order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import any_numbers, real_array
from meshdepict.options import nearest

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["ESTIMATORS", "PrincipalCurvatures", "principal_curvatures"]

ESTIMATORS = ("tensor", "quadric", "discrete")

_UNIT = 1e-3  # how far a unit normal's length may be off: single precision and more


class PrincipalCurvatures(NamedTuple):
    """Curvatures in 1/length of the world, positive where convex, and their directions.

    Attributes
    ----------
    k1, k2 : (n,) array of float64
        ``|k1| ≥ |k2|``; on a sphere of radius r with outward normals both are +1/r.
    d1, d2 : (n, 3) array of float32
        Unit vectors in the tangent plane; d1, d2 and the normal are right-handed. A direction
        has no sense: d1 and −d1 say the same. Where d1 is not determined (see `anisotropy`) the
        pair is any orthonormal one, the same in every run.
    """

    k1: NDArray[np.float64]
    k2: NDArray[np.float64]
    d1: NDArray[np.float32]
    d2: NDArray[np.float32]

    @property
    def mean(self) -> NDArray[np.float64]:
        """Mean curvature (k1 + k2)/2."""
        return (self.k1 + self.k2) / 2

    @property
    def gaussian(self) -> NDArray[np.float64]:
        """Gaussian curvature k1·k2."""
        return self.k1 * self.k2

    @property
    def anisotropy(self) -> NDArray[np.float64]:
        """k1² − k2² ≥ 0, zero wherever d1 is not determined: at umbilics and where k1 = −k2.

        What weights d1 in eq. 9 of Exaggerated Shading.
        """
        return (self.k1 - self.k2) * (self.k1 + self.k2)


def principal_curvatures(
    mesh: Mesh,
    *,
    normals: ArrayLike | None = None,
    method: str = "tensor",
    radius: float | str | None = None,
) -> PrincipalCurvatures:
    """Estimate the principal curvatures and directions at every vertex.

    Vertices at one position share one curvature, as they share one normal. A vertex that no
    proper face meets has zero curvature.

    Parameters
    ----------
    mesh : Mesh
    normals : (n, 3) array_like, optional
        Unit normals whose change is measured, those of a scale of a `ScaleSpace` for instance;
        the mesh's own unless given. For "tensor" alone: the other estimators take positions.
    method : {"tensor", "quadric", "discrete"}
        "tensor": how the normals change over each face, averaged (Rusinkiewicz 2004). Fast,
        and exact on a sphere; the noise of raw normals is to be tamed by their scale.
        "quadric": a quadric fitted to the positions within `radius`, as in libigl (Panozzo et
        al. 2010). Slow; smooths by itself.
        "discrete": mean-curvature normal and angle defect (Meyer et al. 2002). Positions of the
        one-ring only, an independent check; its d1, d2 are any tangent frame.
    radius : float or str, optional
        Of "quadric" alone: in world units, or "0.2%" of the diagonal. Five median edges unless
        given.

    Returns
    -------
    PrincipalCurvatures

    Raises
    ------
    MeshdepictError
        For an unknown method, an argument that the method has no use for, a radius that is no
        length or holds too many vertices, and normals of the wrong shape or not of unit length.
    """
    if method not in ESTIMATORS:
        raise MeshdepictError(
            f"no curvature estimator is called {method!r}{nearest(method, ESTIMATORS)} "
            f"(there are {', '.join(ESTIMATORS)})"
        )
    if normals is not None and method != "tensor":
        raise MeshdepictError(
            f"method={method!r} measures positions, not normals: leave out normals, or take "
            "method='tensor'"
        )
    if radius is not None and method != "quadric":
        raise MeshdepictError(f"radius belongs to method='quadric'; method={method!r} has none")
    if method == "quadric":
        from meshdepict.curvature.quadric import quadric_curvatures

        return _result(*quadric_curvatures(mesh, radius))
    if method == "discrete":
        from meshdepict.curvature.discrete import discrete_curvatures

        return _result(*discrete_curvatures(mesh))
    return _from_normals(mesh, normals)


def _from_normals(mesh: Mesh, normals: ArrayLike | None) -> PrincipalCurvatures:
    from meshdepict.curvature.tensor import tensor_curvatures
    from meshdepict.curvature.welded import Welded

    surface = Welded(mesh)
    if normals is None:
        unit = surface.gathered(mesh.normals)
    else:
        unit = surface.gathered(_checked_normals(normals, len(mesh.vertices)))
    unit.setflags(write=False)  # or the kernel would be compiled twice, for both kinds
    k, d = tensor_curvatures(surface.points, surface.faces, unit)
    k /= mesh.diagonal or 1.0
    return _result(*(surface.spread(part) for part in (*k, *d)))


def _checked_normals(normals: ArrayLike, count: int) -> NDArray[np.float64]:
    array = real_array(normals)
    if array is None:
        raise MeshdepictError("normals must be an (n, 3) array of numbers")
    if array.shape != (count, 3):
        raise MeshdepictError(
            f"normals have shape {array.shape}; the mesh's {count:,} vertices want ({count}, 3)"
        )
    with any_numbers():
        squared = np.einsum("ij,ij->i", array, array)
    bad = ~(np.abs(squared - 1) < 2 * _UNIT)  # also refuses NaN
    if bad.any():
        first = int(np.argmax(bad))
        raise MeshdepictError(
            f"{int(bad.sum()):,} of {count:,} normals are not of unit length (the first is "
            f"{first}: length {np.sqrt(squared[first]):.4g}); normalise them first"
        )
    return array


def _result(
    k1: NDArray[np.float64], k2: NDArray[np.float64], d1: NDArray[Any], d2: NDArray[Any]
) -> PrincipalCurvatures:
    arrays = (k1, k2, d1.astype(np.float32, copy=False), d2.astype(np.float32, copy=False))
    for array in arrays:
        array.setflags(write=False)  # scale spaces keep and share them
    return PrincipalCurvatures(*arrays)
