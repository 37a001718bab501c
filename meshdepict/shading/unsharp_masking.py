"""3D unsharp masking (Ritschel, Smith, Ihrke, Grosch, Myszkowski and Seidel, SIGGRAPH 2008)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales import ScaleSpace
from meshdepict.scene import as_light
from meshdepict.shading.method import Exposure, exposed, method, require_smoothing

__all__ = ["surface_mean", "unsharp_masking"]

# Of a smoothed value, relative: at the default amount less than half of one of 256 grey levels.
_ERROR = 1e-3


def surface_mean(space: ScaleSpace, values: NDArray[Any], width: float) -> NDArray[np.float32]:
    """Return values (n,) in [0, 1], averaged over the surface under a Gaussian.

    ``Σ_j A_j G(x_i − x_j) c_j / Σ_j A_j G(x_i − x_j)`` with mixed Voronoi areas A; a point with no
    area in reach keeps its value.

    Parameters
    ----------
    space : ScaleSpace
    values : (n,) array
    width : float
        Standard deviation in world units.
    """
    from meshdepict.gaussian import gaussian_sums

    shape = space.shape
    mass = shape._unit_areas / (shape._unit_areas.max() or 1.0)
    scaled = max(width / (shape.diagonal or 1.0), 1e-18)
    sums = gaussian_sums(shape._unit_points, np.stack([mass, mass * values]), scaled, error=_ERROR)
    some = sums[0] > 0
    mean = np.where(some, sums[1] / np.where(some, sums[0], 1), values)
    return np.clip(mean, 0, 1).astype(np.float32)


@method(scales=5, linear=True, source="3D unsharp masking (Ritschel et al. 2008)")
def unsharp_masking(
    space: ScaleSpace,
    light: Any,
    *,
    amount: Annotated[
        float, Range(0, 1e3, help="k: how much local contrast is raised", soft=(0, 5))
    ] = 1.0,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by Lambert's cosine and raise its contrast to the shading around on the surface.

    ``c + k (c − c_σ)``, c_σ being c averaged over the surface at the coarsest width.

    Parameters
    ----------
    space : ScaleSpace
        With at least one scale; its coarsest width is σ.
    light : str, (3,) array_like, (azimuth, elevation) or Light
    amount : float
    exposure : float

    Returns
    -------
    (n,) array of float32
        Linear values in [0, 1].

    Raises
    ------
    MeshdepictError
        If the scale space has no smoothed scale.
    """
    require_smoothing(space, "unsharp masking", scales=5)
    direction = as_light(light).direction.astype(np.float32)
    c = np.maximum(space.normals[0] @ direction, 0)
    mean = surface_mean(space, c, float(space.widths[-1]))
    return exposed(c + np.float32(amount) * (c - mean), exposure)
