"""Structure tensors: against loops and numpy's eigenvectors, and on images with exact answers."""

import math

import numpy as np
import pytest

from meshdepict.congruence.structure_tensor import StructureTensor, reach, structure_tensor

ROUNDING = 2.0**-24  # of single precision
MARGIN = reach(1) + reach(5)


def window(width):
    steps = np.arange(-math.ceil(3 * width), math.ceil(3 * width) + 1)
    weights = np.exp(-(steps**2) / (2 * width**2))
    return steps, weights / weights.sum()


def written_out(image, row, column, gradient_width=1.0, width=5.0):
    """The (2, 2) tensor of one pixel: sums over its window, pixel by pixel."""
    near, smooth = window(gradient_width)
    slope = near * smooth / np.sum(near**2 * smooth)
    far, average = window(width)
    tensor = np.zeros((2, 2))
    for dy, wy in zip(far, average, strict=True):
        for dx, wx in zip(far, average, strict=True):
            y, x = row + dy, column + dx
            patch = image[y + near[0] : y + near[-1] + 1, x + near[0] : x + near[-1] + 1]
            gradient = np.array([smooth @ patch @ slope, slope @ patch @ smooth])
            tensor += wy * wx * np.outer(gradient, gradient)
    return tensor


def matrices(tensor):
    return np.stack(
        [np.stack([tensor.xx, tensor.xy], -1), np.stack([tensor.xy, tensor.yy], -1)], -2
    )


@pytest.mark.parametrize("widths", [(1.0, 5.0), (1.5, 2.0)])
def test_equals_the_sums_written_out(rng, widths):
    image = rng.normal(size=(40, 43))
    tensor = structure_tensor(image, gradient_width=widths[0], width=widths[1])
    margin = reach(widths[0]) + reach(widths[1])
    assert tensor.xx.shape == (40 - 2 * margin, 43 - 2 * margin)
    for row, column in [(0, 0), (1, 3), (3, 6)]:
        exact = written_out(image, row + margin, column + margin, *widths)
        found = matrices(tensor)[row, column]
        np.testing.assert_allclose(found, exact, atol=40 * ROUNDING * np.trace(exact))


def test_energy_and_direction_are_those_of_numpy(rng):
    tensor = StructureTensor(*structure_tensor(rng.normal(size=(60, 70))))
    values, vectors = np.linalg.eigh(matrices(tensor).astype(float))
    np.testing.assert_allclose(tensor.energy, values.mean(axis=-1), rtol=1e-5)
    along = np.abs(np.sum(tensor.direction * vectors[..., 1], axis=-1))
    # Where the eigenvalues nearly agree rounding turns the vectors: their gap divides it.
    gap = (values[..., 1] - values[..., 0]) / values[..., 1]
    assert (1 - along <= (8 * ROUNDING / gap) ** 2 + 8 * ROUNDING).all()
    np.testing.assert_allclose(np.linalg.norm(tensor.direction, axis=-1), 1, atol=4 * ROUNDING)


@pytest.mark.parametrize("angle", [0, 17, 45, 90, 120, 179])
def test_a_ramp_has_its_own_gradient_everywhere(angle):
    gradient = 0.3 * np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    y, x = np.mgrid[:50, :60]
    tensor = structure_tensor(gradient[0] * x + gradient[1] * y + 7)
    np.testing.assert_allclose(matrices(tensor), np.broadcast_to(
        np.outer(gradient, gradient), (14, 24, 2, 2)), atol=1e-7)  # fmt: skip
    np.testing.assert_allclose(tensor.energy, 0.09 / 2, rtol=1e-5)
    along = np.abs(tensor.direction @ gradient) / 0.3
    np.testing.assert_allclose(along, 1, atol=1e-6)


def test_a_constant_beside_a_step_is_exactly_flat():
    image = np.full((50, 120), 0.1)
    image[:, 60:] = 0.7
    tensor = structure_tensor(image)
    flat = np.abs(np.arange(MARGIN, 120 - MARGIN) - 59.5) > MARGIN
    assert flat.any()
    assert not any(plane[:, flat].any() for plane in tensor)
    assert not tensor.direction[:, flat].any()
    np.testing.assert_array_equal(
        np.abs(tensor.direction[:, ~flat]), [[(1, 0)] * (~flat).sum()] * 14
    )


def test_turning_the_image_turns_the_tensor(rng):
    image = rng.normal(size=(50, 41))
    upright, turned = structure_tensor(image), structure_tensor(image.T)
    for plane, other in zip(upright, (turned.yy, turned.xy, turned.xx), strict=True):
        np.testing.assert_allclose(plane, other.T, atol=40 * ROUNDING * upright.energy.max())


def test_no_direction_is_x_and_no_variation_is_none():
    alike = StructureTensor(
        np.array([2.0, 3.0, 1e-9]), np.array([0, 1.0, 0]), np.array([2.0, 3, 0])
    )
    np.testing.assert_allclose(alike.direction, [(1, 0), (0.5**0.5, 0.5**0.5), (0, 0)], atol=1e-15)


def test_a_small_image_has_no_whole_window():
    assert structure_tensor(np.zeros((36, 50))).energy.shape == (0, 14)
    assert structure_tensor(np.zeros((37, 37))).energy.shape == (1, 1)
    assert structure_tensor(np.zeros((1, 1))).direction.shape == (0, 0, 2)


def test_works_on_arrays_that_are_read_only_or_not_contiguous(rng):
    image = rng.normal(size=(45, 44))
    image.setflags(write=False)
    expected = structure_tensor(image.copy())
    for given in (image, np.repeat(image, 2, axis=1)[:, ::2], np.asfortranarray(image)):
        for plane, other in zip(structure_tensor(given), expected, strict=True):
            np.testing.assert_array_equal(plane, other)
