"""Occluding contours in a depth image: where neighbouring pixels show different surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["connected", "mean_slopes", "whole_windows"]

Floats = NDArray[np.floating[Any]]
Mask = NDArray[np.bool_]

_UNEXPLAINED = 3.0  # times as large as expected, see `connected`
_USUAL = 95  # percentile of steps


def connected(depth: Floats, mask: Mask, axis: int) -> Mask:
    """Return whether each pixel and the next along an axis show one surface: one shorter there.

    Two pixels of the object are parted by an occluding contour if their step is more than three
    times what the slope on either side explains, and more than three times the 95th percentile of
    all steps along that axis (on whole scans that is 7 to 8 pixels, a slope of 82°). Both are
    relative, so that the unit of depth doesn't matter. A resolved slope, however steep, has steep
    neighbours; just inside the silhouette of a sphere a step is at most 2.4 times the next one.
    Where more than one step in twenty is a jump, as in a thicket of hairs, none stands out.
    """
    z, known = np.swapaxes(depth, 0, axis), np.swapaxes(mask, 0, axis)
    pair = known[1:] & known[:-1]
    step = np.where(pair, np.diff(z, axis=0), 0.0)
    size, sign = np.abs(step), np.sign(step)
    explained = np.zeros_like(step)  # only a slope in the same direction explains a step
    explained[1:] = step[:-1] * sign[1:]
    np.maximum(explained[:-1], step[1:] * sign[:-1], out=explained[:-1])
    usual = np.percentile(size[pair], _USUAL) if pair.any() else 0.0
    jump = size > _UNEXPLAINED * np.maximum(explained, usual)
    return np.swapaxes(pair & ~jump, 0, axis)


def whole_windows(mask: Mask, across: Mask, down: Mask, *, reach: int) -> Mask:
    """Return the pixels whose square window holds one surface and nothing else.

    Parameters
    ----------
    mask : (h, w) array of bool
        Where the object is.
    across : (h, w − 1) array of bool
        Whether a pixel and the next to the right are `connected`.
    down : (h − 1, w) array of bool
        The same for the next below.
    reach : int
        Of a window, in pixels to each side. Windows that leave the picture don't count.
    """
    from scipy.ndimage import minimum_filter

    whole = mask.copy()
    for near, far, pair in (
        (whole[:, :-1], whole[:, 1:], across | ~(mask[:, :-1] & mask[:, 1:])),
        (whole[:-1], whole[1:], down | ~(mask[:-1] & mask[1:])),
    ):
        near &= pair
        far &= pair
    size = 2 * reach + 1
    return np.asarray(minimum_filter(whole.view(np.uint8), size, mode="constant"), np.bool_)


def mean_slopes(depth: Floats, across: Mask, down: Mask) -> tuple[Floats, Floats]:
    """Return the slopes along x and y, per pixel: means of those to the connected neighbours."""
    return (
        _mean_slope(depth.T, across.T).T,
        _mean_slope(depth, down),
    )


def _mean_slope(depth: Floats, pair: Mask) -> Floats:
    step = np.where(pair, np.diff(depth, axis=0), 0.0)
    total, count = np.zeros_like(depth), np.zeros(depth.shape)
    total[:-1] += step
    total[1:] += step
    count[:-1] += pair
    count[1:] += pair
    return total / np.maximum(count, 1)
