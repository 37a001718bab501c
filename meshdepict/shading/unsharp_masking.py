"""3D unsharp masking (Ritschel, Smith, Ihrke, Grosch, Myszkowski and Seidel, SIGGRAPH 2008)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.scene.vectors import cosines
from meshdepict.shading.method import Exposure, exposed, method, require_smoothing

__all__ = ["unsharp_masking"]


def _reads(last: int, *, amount: float, **_: Any) -> Reads:
    """Return the shape's own normals, and the widest mean unless it has no weight."""
    return Reads(normals=frozenset((0,)), means=frozenset((last,) if amount else ()))


@method(
    local=False,
    scales=5,
    linear=True,
    reads=_reads,
    source="3D unsharp masking (Ritschel et al. 2008)",
)
def unsharp_masking(
    space: ScaleSpace,
    light: LightLike,
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

    Raises
    ------
    MeshdepictError
        If the scale space has no smoothed scale.
    """
    require_smoothing(space, "unsharp masking", scales=5)
    direction = as_light(light).direction.astype(np.float32)
    c = np.maximum(cosines(space.normals_at(0), direction), 0)
    if not amount:
        return exposed(c, exposure)
    mean = np.clip(space.mean(c, float(space.widths[-1])), 0, 1).astype(np.float32)
    return exposed(c + np.float32(amount) * (c - mean), exposure)
