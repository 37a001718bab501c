"""What scripts/texture_trade.py measures, on small shapes: the aims of textures hold there, too."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import meshdepict as md

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.fixture(scope="module")
def trade():
    sys.path.insert(0, str(SCRIPTS))
    try:
        import texture_trade
    finally:
        sys.path.remove(str(SCRIPTS))
    return texture_trade


@pytest.fixture(scope="module")
def tablet():
    return md.samples.photographed_tablet(800, texels=16)


@pytest.mark.parametrize("method", ["exaggerated", "lambert", "radiance_scaling"])
@pytest.mark.parametrize("atlas", ["own", "new"])
def test_a_tablet_is_shaded_as_its_pixels_are(trade, tablet, method, atlas):
    baked = md.bake_texture(tablet, method, size=1024, atlas=atlas)
    off = np.concatenate([trade.errors(tablet, baked, view, 200) for view in trade.VIEWS])
    assert np.sqrt(np.mean(off**2)) <= 1
    assert np.mean(off <= 3) >= 0.99


def test_its_seams_show_no_more_than_its_charts_do(trade, tablet):
    baked = md.bake_texture(tablet, size=1024)
    for times in range(5):
        over, within = trade.seams(tablet, baked, times)
        assert over <= within + 2


def test_seams_are_seen_where_there_are_any(trade, tablet):
    """A picture whose left half is black: charts there meet white ones."""
    baked = md.bake_texture(tablet, size=1024)
    baked.image[:, :512] = 0
    baked.image[:, 512:] = 255
    over, within = trade.seams(tablet, baked, 0)
    assert over > within + 50
