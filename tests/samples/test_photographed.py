"""The tablet of the samples: a closed surface, textured as photogrammetry does it."""

import numpy as np
import pytest

from meshdepict import samples
from meshdepict.baking.textures import bake_texture
from meshdepict.errors import MeshdepictError


@pytest.fixture(scope="module")
def tablet():
    return samples.photographed_tablet(600, texels=64)


def test_it_is_closed_and_looks_outwards(tablet):
    edges = np.concatenate([tablet.faces[:, [k, (k + 1) % 3]] for k in range(3)])
    assert {*map(tuple, edges)} == {*map(tuple, edges[:, ::-1])}
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert len(tablet.vertices) - len(edges) // 2 + len(tablet.faces) == 2
    a, b, c = tablet.vertices[tablet.faces].transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0
    assert not tablet.orientation.flipped.any()
    assert len(tablet.vertices) == 6 * 10**2 + 2


def test_two_materials_lie_in_one_square_that_repeats(tablet):
    textures = tablet.textures
    assert set(textures.material) == {0, 1}
    assert textures.texcoords.min() < 0
    assert textures.texcoords.max() > 1
    assert [texture.pixels.shape for texture in textures.base_colors] == [(64, 64, 3)] * 2
    baked = bake_texture(tablet, "lambert", size=128, albedo="keep")
    assert baked.provenance["texture"].endswith("atlas own")
    facing = tablet.vertices[tablet.faces].mean(axis=1)
    assert (textures.material[facing[:, 2] > 0.23] == 0).all()


def test_its_pictures_go_on_beyond_their_edges():
    for texture in samples.photographed_tablet(600, texels=256).textures.base_colors:
        pixels = texture.pixels.astype(float)
        across = np.abs(pixels[:, 0] - pixels[:, -1]).mean()
        assert across < 2 * np.abs(np.diff(pixels, axis=1)).mean()


def test_it_is_the_same_every_time_and_refuses_nonsense(tablet):
    again = samples.photographed_tablet(600, texels=64)
    np.testing.assert_array_equal(again.vertices, tablet.vertices)
    assert [t.encoded for t in again.textures.base_colors] == [
        t.encoded for t in tablet.textures.base_colors
    ]
    assert len(samples.photographed_tablet(8, texels=1).vertices) == 8
    for words in ({"vertices": 7}, {"texels": 0}, {"texels": 9000}):
        with pytest.raises(MeshdepictError, match=f"photographed_tablet: {next(iter(words))}="):
            samples.photographed_tablet(**words)
