"""Colours beside the charts of a texture."""

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt, gaussian_filter

from meshdepict.images.gutters import fill_gutters

pytestmark = pytest.mark.unwatched  # the picture is filled in


def blobs(shape=(150, 210), seed=3):
    field = gaussian_filter(np.random.default_rng(seed).normal(size=shape), 4)
    return field > np.quantile(field, 0.93)


@pytest.mark.parametrize("width", [0, 2, 24, 100])
def test_texels_outside_take_a_colour_that_is_as_near_as_any(width):
    inside = blobs()
    # Every texel has its own colour: its place.
    place = np.arange(inside.size).reshape(inside.shape)
    image = np.stack([place % 256, place // 256 % 256, place // 65536], -1).astype(np.uint8)
    before, mean = image.copy(), np.rint(image[inside].mean(axis=0))
    fill_gutters(image, inside, width)
    assert np.array_equal(image[inside], before[inside])
    distance = distance_transform_edt(~inside)
    near = ~inside & (distance <= width)
    from_place = (image.astype(np.int64) * (1, 256, 65536)).sum(axis=-1)[near]
    rows, columns = np.divmod(from_place, inside.shape[1])
    assert inside[rows, columns].all()
    there = np.hypot(*(a - b for a, b in zip(np.nonzero(near), (rows, columns), strict=True)))
    assert np.allclose(there, distance[near])
    assert (image[distance > width] == mean).all()


def test_a_picture_with_nothing_inside_is_grey():
    image = np.zeros((20, 30, 3), np.uint8)
    fill_gutters(image, np.zeros((20, 30), bool), 5)
    assert (image == 128).all()
