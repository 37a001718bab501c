"""Sky view: soft light and soft shadows from a part of the sky."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import LightLike, as_light
from meshdepict.shading.ambient_occlusion import Rays
from meshdepict.shading.method import Exposure, exposed, method
from meshdepict.shading.openness import RADIUS, Horizon
from meshdepict.transport.occlusion import sky_openness

__all__ = ["sky_view"]


def _reads(last: int, *, rays: int, sky: str | None, radius: float | None, **_: Any) -> Reads:
    far = RADIUS if sky == "overhead" and radius is None else radius
    return Reads(normals=frozenset((0,)), rays=rays, around=None if far is None else far + 1)


@method(
    local=False,
    needs=("rays", "surface"),
    reads=_reads,
    source="Sky-view factor (Zakšek, Oštir and Kokalj 2011); directional occlusion",
)
def sky_view(
    space: ScaleSpace,
    light: LightLike,
    *,
    spread: Annotated[
        float, Range(1, 90, unit="°", help="half the opening of the cap of sky round the light")
    ] = 90.0,
    rays: Rays = 256,
    sky: Annotated[
        str | None,
        Choice(
            ("light", "overhead"),
            help="soft light from about the light, or how much sky is seen; of terrain the second",
        ),
    ] = None,
    radius: Annotated[
        float | None,
        Range(
            1,
            1e6,
            soft=(1, 100),
            help="how far is looked, in cells or edge lengths; 10 overhead if none, else all",
        ),
    ] = None,
    horizon: Horizon = "lines",
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade under an evenly bright cap of sky round the light: soft shadows, no black but in caves.

    A spread of 90° is half the sky; a small one is directional occlusion, a sun with soft shadows.
    With ``sky="overhead"`` it is the sky-view factor of relief maps: 1 − mean sin max(γ, 0), γ the
    elevation of the horizon, the share of the sky about the zenith that is seen.

    Parameters
    ----------
    light : str, (3,) array_like, (azimuth, elevation) or Light
        The middle of the sky.
    rays : int
        Of terrain under the sky overhead, horizons in √rays directions: 16.
    sky : {"light", "overhead"}, optional
        "light" unless given, as part of the light that an open surface gets that faces the middle:
        directions weigh by their cosine to the surface. "overhead", which bakes of terrain take
        unless told otherwise, weighs all directions alike, whatever the light: about up of terrain
        and of other sheets, and about the normal of any other sample.

    Returns
    -------
    (n,) array of float32
        Display values in [0, 1]; 1 for an open surface that faces the light, or sees all sky.
    """
    if sky == "overhead":
        far = RADIUS if radius is None else radius
        return exposed(space.sky_shares(rays=rays, radius=far, horizon=horizon), exposure)
    if horizon != "lines":
        raise MeshdepictError(
            f"sky_view: horizon={horizon!r} is about the sky overhead: set sky=overhead, or leave "
            "it out"
        )
    towards = as_light(light).direction
    at = space.points, space.normals_at(0)
    reach = None if radius is None else radius * space.shape.edge_length
    found = sky_openness(space.surface, towards, at=at, spread=spread, rays=rays, radius=reach)
    return exposed(found.values, exposure)
