"""Connected components against SciPy's, numbers and all."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from meshdepict.surface.components import connected


@pytest.mark.parametrize("links", [0, 1, 30, 90, 100, 400])
@pytest.mark.parametrize("kind", [np.int32, np.int64])
def test_components_are_scipy_s(links, kind):
    i, j = np.random.default_rng(links).integers(0, 100, (2, links)).astype(kind)
    graph = coo_array((np.ones(links), (i, j)), shape=(100, 100))
    expected = connected_components(graph, directed=False)[1]
    found = connected(100, i, j)
    np.testing.assert_array_equal(found, expected)


def test_a_long_chain_linked_from_its_end():
    n = 200_000
    chain = np.arange(n - 1)[::-1]
    assert not connected(n, chain + 1, chain).any()
    np.testing.assert_array_equal(connected(n, chain[:0], chain[:0]), np.arange(n))


def test_no_nodes_at_all():
    none = np.zeros(0, np.int64)
    assert connected(0, none, none).shape == (0,)
