"""Which texels lie in which triangle of an atlas."""

import numpy as np
import pytest
from textured_shapes import grid

from meshdepict.errors import MeshdepictError
from meshdepict.surface.texels import TexelGrid


def cut_square(n=23, seed=0):
    """A square cut into triangles at random points, as an atlas."""
    _, faces = grid(n)
    places = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * 2), -1).copy()
    jitter = np.random.default_rng(seed).uniform(-0.2, 0.2, places.shape) / n
    places[1:-1, 1:-1] += jitter[1:-1, 1:-1]
    return places.reshape(-1, 2)[faces]


def centres(texels, size, begin=0):
    """Coordinates of the texels' centres."""
    row, column = np.divmod(texels.place, size)
    return np.stack([(column + 0.5) / size, 1 - (row + begin + 0.5) / size], 1)


@pytest.mark.parametrize("size", [16, 100, 333])
def test_every_texel_of_a_square_that_is_cut_into_triangles_belongs_to_one(size):
    atlas = TexelGrid(cut_square(), size)
    claims = atlas.claims(0, size)
    assert claims.shared == 0
    assert not claims.disputed.any()
    assert claims.counts.sum() == size**2
    assert atlas.excess == pytest.approx(1, abs=1e-3)


def test_weights_lead_back_to_the_texels_centre():
    texcoords, size = cut_square(), 200
    found = TexelGrid(texcoords, size).texels(0, size)
    at = np.einsum("nc,ncx->nx", found.weights, texcoords[found.triangle])
    # Corners are snapped to 1/1024 of a texel.
    assert np.abs(at - centres(found, size)).max() * size < 2e-3
    assert np.allclose(found.weights.sum(axis=1), 1, atol=1e-6)
    assert found.weights.min() >= 0


def test_bands_of_rows_give_what_the_whole_gives():
    texcoords, size = cut_square(), 96
    atlas = TexelGrid(texcoords, size)
    whole = atlas.texels(0, size)
    parts = [atlas.texels(a, a + 32) for a in (0, 32, 64)]
    assert np.array_equal(whole.triangle, np.concatenate([part.triangle for part in parts]))
    assert np.array_equal(whole.weights, np.concatenate([part.weights for part in parts]))
    counts = sum((atlas.claims(a, a + 32).counts for a in (0, 32, 64)), start=0)
    assert np.array_equal(counts, atlas.claims(0, size).counts)


def test_mirrored_triangles_and_whole_squares_further_on_have_the_same_texels():
    texcoords, size = cut_square(), 128
    upright = TexelGrid(texcoords, size).texels(0, size)
    for turned, order in (
        (texcoords[:, [0, 2, 1]], [0, 2, 1]),
        (np.add(texcoords, (3, -2)), [0, 1, 2]),
    ):
        found = TexelGrid(turned, size).texels(0, size)
        assert np.array_equal(found.triangle, upright.triangle)
        assert np.allclose(found.weights[:, order], upright.weights, atol=1e-4)


def test_of_triangles_that_overlap_the_first_has_the_texels_and_all_are_counted():
    once = cut_square(5)
    atlas = TexelGrid(np.concatenate([once, once[:, [0, 2, 1]]]), 64)
    claims = atlas.claims(0, 64)
    assert claims.shared == 64**2
    assert not claims.disputed[: len(once)].any()
    assert claims.disputed[len(once) :].all()
    assert atlas.excess == pytest.approx(2, abs=1e-3)
    both = atlas.claims(0, 20) + atlas.claims(20, 64)
    assert both.shared == claims.shared
    assert np.array_equal(both.disputed, claims.disputed)


def test_a_triangle_between_texels_has_the_one_at_its_middle_unless_that_is_taken():
    size = 32
    tiny = np.array([[10.1, 10.1], [10.2, 10.1], [10.1, 10.2]]) / size
    flat = np.array([[20.5, 4.5]] * 3) / size
    atlas = TexelGrid(np.stack([tiny, flat, tiny]), size)
    claims = atlas.claims(0, size)
    assert claims.counts.tolist() == [0, 0, 0]
    assert len(atlas.texels(0, size).place) == 0
    atlas.fill_in(claims)
    found = atlas.texels(0, size)
    assert sorted(zip(*np.divmod(found.place, size), strict=True)) == [(21, 10), (27, 20)]
    assert set(found.triangle.tolist()) == {0, 1}
    assert np.allclose(found.weights, 1 / 3)


def test_closed_triangles_have_the_texels_on_their_borders():
    size = 16
    corner = (np.array([[2, 2], [6, 2], [2, 6]]) + 0.5) / size
    assert TexelGrid(corner[None], size, closed=True).claims(0, size).counts[0] == 15
    assert TexelGrid(corner[None], size).claims(0, size).counts[0] < 15


def test_coordinates_far_outside_are_refused():
    with pytest.raises(MeshdepictError, match=r"reach as far as 40 \(triangle 1\).*--atlas new"):
        TexelGrid(np.stack([np.zeros((3, 2)), np.full((3, 2), -40.0)]), 16)
