"""Vectors in kernels against the same on arrays."""

import numpy as np
import pytest

from meshdepict.sums import lanes
from meshdepict.sums.lanes import WIDE, many
from meshdepict.threads import kernel

KINDS = [np.float32, np.float64]


@kernel()
def powers(given, found, like):
    lanes.store(lanes.power_of_two(lanes.load(given, 0, like)), found, 0)


@kernel()
def sums(given, factor, found, like):
    some = lanes.add(lanes.load(given, 0, like), factor, given, WIDE)
    lanes.add_to(some, factor, found, 1)


@kernel()
def each_and_scaled(given, factors, found, like, one):
    none = lanes.nothing(given, like)
    lanes.store_each(lanes.add_each(none, factors, 1, given, 3), found, 0, 20)
    scale = lanes.load(given, 3, one)
    lanes.store_each(lanes.add_scaled(none, scale, factors, 1), found, 100, 20)


@kernel()
def places_within(given, most, like):
    bits = lanes.within(lanes.load(given, 0, like), lanes.fill(most))
    found = np.full(WIDE, -1)
    count = 0
    while bits != 0:
        found[count] = lanes.lowest(bits)
        bits &= bits - 1
        count += 1
    return found[:count]


@kernel()
def of_two(a, b, found, like):
    one, other = lanes.load(a, 0, like), lanes.load(b, 0, like)
    lanes.store(lanes.plus(one, other), found, 0)
    lanes.store(lanes.minus(one, other), found, WIDE)
    lanes.store(lanes.times(one, other), found, 2 * WIDE)
    lanes.store(lanes.larger(one, other), found, 3 * WIDE)


@pytest.mark.parametrize("kind", KINDS)
def test_powers_of_two_are_exact_to_their_precision(kind, rng):
    given = np.append([0, -1, -0.5, -100], -rng.uniform(0, 100, WIDE - 4)).astype(kind)
    found = np.empty(WIDE, kind)
    powers(given, found, many(WIDE))
    np.testing.assert_allclose(found, 2.0 ** given.astype(float), rtol=4 * np.finfo(kind).eps)


@pytest.mark.parametrize("kind", KINDS)
def test_a_power_too_small_for_its_kind_is_tiny_and_a_number(kind):
    found = np.empty(WIDE, kind)
    powers(np.full(WIDE, -1e5, kind), found, many(WIDE))
    assert (found >= 0).all()
    assert (found < 1e-35).all()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [1, 3])
def test_sums_of_several_vectors(kind, count, rng):
    given = rng.random((count + 1) * WIDE).astype(kind)
    found = np.ones(count * WIDE + 2, kind)
    sums(given, kind(0.5), found, many(count * WIDE))
    some = given[:-WIDE] + given[WIDE:] / 2
    expected = np.concatenate([[1], 1 + some / 2, [1]])  # and nothing beside them
    np.testing.assert_allclose(found, expected, rtol=4 * np.finfo(kind).eps)


def test_each_vector_takes_a_factor_of_its_own(rng):
    given, factors = rng.random(40), rng.random(5)
    found = np.zeros(200)
    each_and_scaled(given, factors, found, many(3 * WIDE), many(WIDE))
    for k in range(3):
        expected = factors[1 + k] * given[3 : 3 + WIDE]
        np.testing.assert_allclose(found[20 * k : 20 * k + WIDE], expected, rtol=1e-15)
        np.testing.assert_array_equal(
            found[100 + 20 * k : 100 + 20 * k + WIDE], found[20 * k : 20 * k + WIDE]
        )


def test_bits_say_which_are_within(rng):
    given = rng.random(WIDE)
    np.testing.assert_array_equal(
        places_within(given, 0.4, many(WIDE)), np.flatnonzero(given <= 0.4)
    )
    assert len(places_within(given, -1.0, many(WIDE))) == 0


def test_two_vectors_at_a_time(rng):
    a, b = rng.random((2, WIDE))
    found = np.empty(4 * WIDE)
    of_two(a, b, found, many(WIDE))
    np.testing.assert_array_equal(found, np.concatenate([a + b, a - b, a * b, np.maximum(a, b)]))


@pytest.mark.parametrize(("numbers", "vectors"), [(1, 1), (16, 1), (17, 2), (54, 4)])
def test_as_many_vectors_as_hold_the_numbers(numbers, vectors):
    assert len(many(numbers)) == vectors
