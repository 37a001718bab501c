"""Slices through a volume: CT numbers in gray, the shaded voxels in their colours over them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from meshdepict.drawing.painted import PaintedVolume

__all__ = ["AXES", "draw_slice"]

AXES = ("x", "y", "z")
_DARKEST, _BRIGHTEST = 0.5, 99.5  # percentiles of the slice that are shown black and white


def draw_slice(baked: PaintedVolume, axis: str, share: float) -> Any:
    """Return a ``PIL.Image`` of one slice of the grid, in its own proportions.

    Parameters
    ----------
    baked : PaintedVolume
    axis : {"x", "y", "z"}
        Which of the grid's axes the slice is perpendicular to.
    share : float
        Where along the axis, 0 … 1.

    Raises
    ------
    MeshdepictError
        For another axis or place.
    """
    from PIL import Image

    volume = baked.shape
    if axis not in AXES:
        raise MeshdepictError(f"a slice is perpendicular to x, y or z, not to {axis!r}")
    if isinstance(share, bool) or not 0 <= share <= 1:
        raise MeshdepictError(f"a slice lies at a share from 0 to 1 of the axis, not at {share!r}")
    along = 2 - AXES.index(axis)
    number = round(share * (volume.counts[along] - 1))
    values = np.take(volume.values, number, axis=along).astype(np.float64)
    rgba = np.take(baked.rgba, number, axis=along).astype(np.float64)
    low, high = np.percentile(values, (_DARKEST, _BRIGHTEST))
    gray = np.clip((values - low) / max(high - low, 1e-300), 0, 1)[..., None] * 255
    alpha = rgba[..., 3:] / 255
    image = np.rint(gray * (1 - alpha) + rgba[..., :3] * alpha).astype(np.uint8)
    # The first row is at the top: so is the end of the upper axis.
    image = image[::-1] if axis != "z" else image
    across, down = (s for i, s in enumerate(volume.spacing) if i != 2 - along)
    height, width = image.shape[:2]
    unit = min(across, down)
    size = max(1, round(width * across / unit)), max(1, round(height * down / unit))
    return Image.fromarray(np.ascontiguousarray(image)).resize(size, Image.Resampling.BICUBIC)
