"""Gutters: texels beside a chart take its colours, so that filters and mipmaps find no seam."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdepict.threads import each, kernel, spans, thread_count

__all__ = ["MOST", "fill_gutters", "put_texels"]

MOST = 100
"""Texels that a gutter may be wide."""

_ROWS = 64  # that are filled at a time


def put_texels(
    image: NDArray[np.uint8],
    inside: NDArray[np.bool_],
    place: NDArray[np.int32],
    colors: NDArray[np.uint8],
) -> None:
    """Give some texels their colours, and let them be inside.

    Parameters
    ----------
    image : (h, w, 3) array
        Modified.
    inside : (h, w) array of bool
        Modified.
    place : (n,) array of int
        Numbers of texels, row by row.
    colors : (n, 3) array
    """
    _put(image.reshape(-1, 3), inside.reshape(-1), place, colors)


@kernel()
def _put(image, inside, place, colors):  # type: ignore[no-untyped-def]
    for i in range(len(place)):
        at = place[i]
        inside[at] = True
        image[at, 0], image[at, 1], image[at, 2] = colors[i, 0], colors[i, 1], colors[i, 2]


def fill_gutters(image: NDArray[np.uint8], inside: NDArray[np.bool_], width: int) -> None:
    """Give texels outside, and near enough, the colour of the nearest one inside.

    What is further away gets the mean colour of those inside.

    Parameters
    ----------
    image : (h, w, 3) array
        Modified.
    inside : (h, w) array of bool
    width : int
        How far a texel may be from the nearest one inside, up to `MOST`.
    """
    assert width <= MOST
    height = len(image)
    mean = _mean(image, inside)
    beside = np.empty(inside.shape, np.int8)  # to the nearest one inside of the same row
    pieces = spans(height, -(-height // _ROWS))
    each(lambda a, b: _along_rows(inside, width, beside, a, b), pieces)
    # Texels inside alone are read, and others alone written: rows go in any order.
    occupied = _occupied(inside, width)
    each(lambda a, b: _fill(image, beside, occupied, width, mean, a, b), pieces)


def _occupied(inside: NDArray[np.bool_], side: int) -> NDArray[np.bool_]:
    """Return which blocks of texels have one inside in them or in the blocks around."""
    side = max(side, 1)
    height, width = (-(-n // side) for n in inside.shape)
    around = np.zeros((height + 2, width + 2), bool)
    for row in range(height):
        some = np.flatnonzero(inside[row * side : (row + 1) * side].any(axis=0)) // side
        around[row + 1, some + 1] = True
    near = around[:-2] | around[1:-1] | around[2:]
    found: NDArray[np.bool_] = near[:, :-2] | near[:, 1:-1] | near[:, 2:]
    return found


def _mean(image: NDArray[np.uint8], inside: NDArray[np.bool_]) -> NDArray[np.uint8]:
    sums = np.zeros((len(image), 4))
    each(lambda a, b: _row_sums(image, inside, sums, a, b), spans(len(image), 4 * thread_count()))
    total = sums.sum(axis=0)
    if total[3] == 0:
        return np.full(3, 128, np.uint8)
    return np.rint(total[:3] / total[3]).astype(np.uint8)


@kernel()
def _row_sums(image, inside, sums, begin, end):  # type: ignore[no-untyped-def]
    for row in range(begin, end):
        red = green = blue = count = 0
        for column in range(image.shape[1]):
            if inside[row, column]:
                red += image[row, column, 0]
                green += image[row, column, 1]
                blue += image[row, column, 2]
                count += 1
        sums[row, 0], sums[row, 1], sums[row, 2], sums[row, 3] = red, green, blue, count


@kernel()
def _along_rows(inside, most, beside, begin, end):  # type: ignore[no-untyped-def]
    """Find how many texels to the right, or left where negative, the nearest one inside is."""
    count = inside.shape[1]
    for row in range(begin, end):
        since = most + 1
        for column in range(count):
            since = 0 if inside[row, column] else since + 1
            beside[row, column] = -since if since <= most else 127
        since = most + 1
        for column in range(count - 1, -1, -1):
            since = 0 if inside[row, column] else since + 1
            if since <= most and since < abs(beside[row, column]):
                beside[row, column] = since


@kernel()
def _fill(image, beside, occupied, most, mean, begin, end):  # type: ignore[no-untyped-def]
    height, width = beside.shape
    for row in range(begin, end):
        for column in range(width):
            if beside[row, column] == 0:
                continue
            least = most * most + 1
            from_row = from_column = -1
            near = occupied[row // max(most, 1), column // max(most, 1)]
            for step in range(most + 1 if near else 0):
                if step * step >= least:
                    break
                for sign in range(-1, 2, 2):
                    other = row + sign * step
                    if 0 <= other < height and beside[other, column] != 127:
                        along = int(beside[other, column])
                        squared = along * along + step * step
                        if squared < least:
                            least, from_row, from_column = squared, other, column + along
                    if step == 0:
                        break
            if from_row < 0:
                for channel in range(3):
                    image[row, column, channel] = mean[channel]
            else:
                for channel in range(3):
                    image[row, column, channel] = image[from_row, from_column, channel]
