"""The plate of scripts/engraved_plate.py: closed, coarse, and legible once refined."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

import meshdepict as md
from meshdepict.surface.edges import is_balanced

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.fixture(scope="module")
def engraved():
    """The module, and its plate with two letters."""
    pytest.importorskip("matplotlib")
    sys.path.insert(0, str(SCRIPTS))
    try:
        import engraved_plate
    finally:
        sys.path.remove(str(SCRIPTS))
    return engraved_plate, engraved_plate.engraved_plate("DE")


@pytest.fixture(scope="module")
def outline(engraved):
    """Points all along the letters' outlines."""
    module, _ = engraved
    loops = [loop + module.MARGIN for loop in module.outlines("DE", 10 - 2 * module.MARGIN)]
    share = np.arange(60)[:, None] / 60
    return KDTree(
        np.concatenate(
            [a + share * (b - a)
             for loop in loops for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True)]
        )
    )  # fmt: skip


def test_the_plate_is_closed_wound_outwards_and_coarse(engraved):
    _, plate = engraved
    assert is_balanced(plate.faces, len(plate.vertices))
    assert not plate.orientation.flipped.any()
    lengths = np.linalg.norm(np.ptp(plate.vertices[plate.faces], axis=1), axis=1)
    assert lengths.max() > 50 * plate.edge_length
    floor = plate.vertices[(plate.vertices[:, 2] < 0) & (plate.vertices[:, 2] > -0.3), 2]
    np.testing.assert_allclose(floor, -0.002 * plate.diagonal, rtol=1e-6)


@pytest.mark.parametrize("method", ["lambert", "exaggerated", "light_alignment"])
def test_engraved_letters_are_legible(method, engraved, outline):
    _, plate = engraved
    fine = md.bake(plate, method, refine=6)
    shown, vertices = fine.colors[:, 0].astype(float), fine.shape.vertices
    off, _ = outline.query(vertices[:, :2])
    top = vertices[:, 2] > -1e-9
    inner = (np.minimum(vertices, np.ptp(plate.vertices, axis=0) - vertices) > 0.3)[:, :2].all(1)
    plane, line = top & inner & (off > 0.25), top & (off < 1e-3)
    assert plane.sum() > 50
    assert line.sum() > 500
    # The plane may brighten slowly, for wide Gaussians see its rim, but has no steps …
    _, pair = KDTree(vertices[plane]).query(vertices[plane], k=2)
    assert np.quantile(np.abs(shown[plane][pair[:, 1]] - shown[plane]), 0.95) <= 4
    # … and the outline stands out from what is round it.
    _, near = KDTree(vertices[plane]).query(vertices[line])
    assert np.quantile(np.abs(shown[plane][near] - shown[line]), 0.5) > 20
