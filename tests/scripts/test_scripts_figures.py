"""The figures of scripts/figures.py, small and with the golf ball in place of the scans."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
ES, LW, RS = range(1, 14), (6, 9, 10, 11), (*range(2, 10), *range(12, 15))
NAMES = (
    *(f"ES{i}" for i in ES), *(f"LW{i}" for i in LW), *(f"RS{i}" for i in RS),
    *(f"LLA{i}" for i in range(4, 15)), "LW9GI", "RS10", "RS11", "LLA11GI",
)  # fmt: skip


@pytest.fixture(scope="module")
def parts() -> Iterator[Any]:
    """The module figure_parts, all figures entered."""
    sys.path.insert(0, str(SCRIPTS))
    try:
        import figure_parts
        import figures  # noqa: F401
    finally:
        sys.path.remove(str(SCRIPTS))
    yield figure_parts
    figure_parts.mesh.cache_clear()


def test_every_figure_is_there(parts):
    assert sorted(parts.FIGURES) == sorted(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_figure_shows_something(name, parts):
    """Pictures of black, white or background alone have no shades between."""
    title, draw = parts.FIGURES[name]
    picture = draw(parts.Stage(size=40, vertices=2_000))
    assert title
    assert min(picture.size) >= 40
    assert len(np.unique(np.asarray(picture.convert("L")))) > 30


def test_figures_know_their_environment_by_its_brightness(parts):
    """Matt white shows one half on average, whichever environment."""
    shot = parts.Stage(size=40, vertices=2_000).look("golf ball")
    light = shot.environment("any")
    shown = light.irradiance(shot.buffer.normals) / np.pi
    assert shown.mean() == pytest.approx(0.5, rel=0.05)


def test_a_part_of_a_picture_is_where_its_centre_says(parts):
    """Zoomed in on a place, its middle pixel is that place of the whole picture."""
    stage = parts.Stage(size=41, vertices=2_000)
    whole = stage.look("golf ball").buffer
    part = stage.look("golf ball", zoom=4, centre=(0.3, 0.2)).buffer
    right, up, _ = whole.view.frame @ (part.view.focus - whole.view.focus)
    assert (right, up) == pytest.approx(
        (0.3 * whole.view.parallel_scale, 0.2 * whole.view.parallel_scale)
    )
    assert whole.view.parallel_scale == pytest.approx(4 * part.view.parallel_scale)


# --- fig. 3 of Exaggerated Shading ------------------------------------------------------------


@pytest.fixture(scope="module")
def terrain(parts) -> Any:
    """The module figures_terrain."""
    return sys.modules["figures_terrain"]


@pytest.fixture(scope="module")
def hill(terrain) -> Any:
    """The ridges, and their normals at six scales, the widest a ninth of a ridge."""
    from meshdepict import scale_space

    return scale_space(terrain.ridges(600), scales=5)


def saturated(terrain, hill, exaggeration, light):
    """Which ridges have a·sin(slope)·|sin δ| ≥ 1 on both sides at every scale: METHODS' condition.

    δ lies between ridge and light. Slopes are the gentlest where contrast is measured.
    """
    field = hill.shape
    least = np.full(terrain.RIDGES, np.inf)
    for scale in range(hill.last + 1):
        steep = np.hypot(*hill.normals_at(scale)[:, :2].T)
        at = [terrain.flanks(field, side) for side in (-1, 1)]
        found = [[steep[one].min() for one in each] for each in at]
        least = np.minimum(least, np.min(found, axis=0))
    ridge = np.radians(terrain.TURN + 10 * np.arange(terrain.RIDGES))
    across = np.abs(np.sin(ridge - np.arctan2(light[1], light[0])))
    return exaggeration * least * across >= 1


@pytest.mark.parametrize("azimuth", [315, 310, 270])
@pytest.mark.parametrize("exaggeration", [25.0, 40.0])
def test_the_soft_toon_makes_ridges_of_all_directions_equal(terrain, hill, exaggeration, azimuth):
    """All but those along the light; side-to-side contrast within 20 %, as the figure claims."""
    from meshdepict.shading import exaggerated

    turn = np.radians(azimuth)
    light = np.array([np.sin(turn), np.cos(turn), 0])
    values = exaggerated(hill, light, exaggeration=exaggeration, one_light=True)
    found = terrain.contrasts(hill.shape, values)
    equal = saturated(terrain, hill, exaggeration, light)
    assert equal.sum() == (34 if azimuth == 315 else 36)
    assert found[equal].min() > 0.8 * found.max()
    one_scale = terrain.contrasts(
        hill.shape, 0.5 + 0.5 * np.clip(exaggeration * hill.normals_at(0) @ light, -1, 1)
    )
    assert one_scale[equal].min() > 0.8 * one_scale.max()


def test_ridges_along_the_light_have_no_sides_and_others_differ_without_the_toon(terrain, hill):
    """Light from the northwest: as |sin δ| with cosine shading, and with scaled heights, too."""
    normals, field = hill.normals_at(0), hill.shape
    along = [13, 31]  # 135 and 315 degrees
    across = np.abs(np.sin(np.radians(terrain.TURN + 10 * np.arange(36) - 135)))
    for shade in (terrain.cosine, terrain.scaled):
        found = terrain.contrasts(field, shade(normals))
        # Means of one and the same flank, lit from other sides: a sine, but for the raster's cells.
        np.testing.assert_allclose(found / found.max(), across, atol=0.03)
        assert (found > 0.8 * found.max()).sum() == (across > 0.8).sum() == 14
    toon = terrain.contrasts(field, terrain.toon(normals, 25.0))
    assert toon[along].max() < 0.1 < 0.8 * toon.max()


def test_captions_and_rows_make_a_page(parts):
    from PIL import Image

    one = Image.new("RGB", (40, 40), "red")
    page = parts.page([[("a", one), ("b", one)], [("two\nlines", one)]])
    assert page.width == 2 * 40 + 3 * parts.MARGIN
    red = np.all(np.asarray(page) == (255, 0, 0), axis=-1)
    assert red.sum() == 3 * 40 * 40
