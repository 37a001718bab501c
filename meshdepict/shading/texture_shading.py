"""Texture shading (Brown 2010): ridges and canyons of every size, without a light."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.heights.fractional_laplacian import texture
from meshdepict.options import Range
from meshdepict.scales.reads import Reads
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import Exposure, exposed, method

__all__ = ["settle", "texture_shading"]

_DETAIL = 0.8
_REFERENCES = (1e-30, 1e30)
_MOST = 1e15  # of x: its square is a number in single precision, and all beyond it black or white
_USUAL = 0.3  # of terrain that is never whole at hand, in m^0.2: hills of 30 m cells


def settle(space: ScaleSpace | None, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the texture that half of the grey scale belongs to: as given, else the shape's rms."""
    if options.get("reference") is not None:
        return {"reference": options["reference"]}
    if space is None:
        return {"reference": _USUAL}
    values = _texture(space.typical(), options.get("detail", _DETAIL)).astype(np.float64)
    found = math.sqrt(float(np.mean(values**2))) if len(values) else 0.0
    least, most = _REFERENCES
    return {"reference": min(max(float(f"{found:.4g}"), least), most) if found else 1.0}


def _texture(space: ScaleSpace, detail: float) -> NDArray[np.float32]:
    return space.from_heights(lambda field: texture(
        field.z, None if field.whole else field.valid, field.spacing, detail=detail
    ))  # fmt: skip


@method(
    local=False, lights="none", needs=("heights",), fits=settle,
    reads=lambda last, **_: Reads(around=math.inf),
    source="Texture shading (Brown 2010)",
)  # fmt: skip
def texture_shading(
    space: ScaleSpace,
    light: Any,
    *,
    detail: Annotated[
        float, Range(0, 2, help="power of the frequency: 0 heights, 2 their curvature")
    ] = _DETAIL,
    contrast: Annotated[
        float, Range(0, 1e6, help="factor on texture before the grey scale", soft=(0, 4))
    ] = 1.0,
    reference: Annotated[
        float | None, Range(*_REFERENCES, help="texture at ±0.35 from grey; its rms if none")
    ] = None,
    exposure: Exposure = 1.0,
) -> NDArray[np.float32]:
    """Shade by the fractional Laplacian of heights: crests bright, canyons dark, of whatever size.

    Each wave of the ground is scaled by ``|ω|^detail``, in a transform whose edges mirror: ``½ + ½
    x/√(1 + x²)``, x = contrast · texture/reference.

    Parameters
    ----------
    reference : float, optional
        In metres^(1 − detail); unless given, the root mean square over the shape.
    """
    del light
    given = settle(space, {"detail": detail, "reference": reference})["reference"]
    factor = contrast / given
    x, most = _texture(space, detail), np.float32(_MOST)
    if factor > 1:  # before they are multiplied, so that nothing overflows
        x = np.clip(x, np.float32(-_MOST / factor), np.float32(_MOST / factor))
    x = np.clip(x * np.float32(factor), -most, most)
    return exposed((1 + x / np.sqrt(1 + x * x)) / 2, exposure)
