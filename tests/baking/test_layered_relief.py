"""Layers and tints window by window: those of the whole."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.relief import Relief
from meshdepict.color.tints import parsed_tint
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.height_field import HeightField

COLUMNS, ROWS = np.meshgrid(np.arange(330.0), np.arange(260.0))


@pytest.fixture(scope="module")
def hills():
    z = 9 * np.sin(COLUMNS / 14) * np.cos(ROWS / 11) + np.sin(COLUMNS * ROWS / 900) + ROWS / 7
    z[40:60, 100:180] = np.nan
    return HeightField(z.astype(np.float32), transform=(2, 0, 100, 0, -2, 900))


LOOKS = [
    {"blend": "slope:multiply:0.5,exaggerated", "scales": 3},
    {"blend": "exaggerated:overlay:0.5:0.2..0.9,gooch:luminosity,lambert", "scales": 2},
    {"blend": "slope,lambert", "tint": "swiss"},
    {"method": "aspect", "tint": "earth:0..30"},
    {"method": "lambert", "tint": "desert", "z_factor": 2.0},
    {"blend": "mean_curvature:screen,lambert", "colormap": "sepia"},
]


@pytest.mark.parametrize("words", LOOKS)
def test_windows_are_the_whole(hills, words):
    look = md.Look(**words)
    baked = look.bake(hills)
    relief = Relief(hills, look, memory=8e6)
    assert len(relief.cut) > 1
    colors = np.zeros((*hills.z.shape, 3), np.uint8)
    for part in relief.windows():
        colors[part.rows, part.columns] = part.colors
    found, expected = hills.sample(colors).astype(int), baked.colors
    # Raised heights come back to themselves but for rounding.
    assert np.abs(found - expected).max() <= (1 if "z_factor" in words else 0)
    assert relief.kind == ("color" if np.ptp(expected, axis=1).any() else "gray")
    for name in ("method", "blend"):
        assert relief.provenance.get(name) == baked.provenance.get(name)


def test_a_tint_spans_all_windows(hills):
    relief = Relief(hills, md.Look("lambert", tint="earth"), memory=8e6)
    heights = hills.z[hills.valid]
    assert parsed_tint(relief.look.tint) == ("earth", (heights.min(), heights.max()))
    assert relief.provenance["tint"] == relief.look.tint
    level = HeightField(np.full((5, 5), 3.0))
    assert Relief(level, md.Look("lambert", tint="earth")).look.tint == "earth"


def test_layers_of_other_widths_are_refused(hills):
    blend = "light_alignment:multiply,exaggerated"
    with pytest.raises(
        MeshdepictError, match="light_alignment and exaggerated are smoothed at dif"
    ):
        Relief(hills, md.Look(blend=blend))
    relief = Relief(hills, md.Look(blend=blend, scales=2, ratio=1.5))
    assert relief.provenance["method"] == "blend"
