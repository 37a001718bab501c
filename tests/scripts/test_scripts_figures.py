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
    *(f"LLA{i}" for i in range(4, 15)),
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


def test_captions_and_rows_make_a_page(parts):
    from PIL import Image

    one = Image.new("RGB", (40, 40), "red")
    page = parts.page([[("a", one), ("b", one)], [("two\nlines", one)]])
    assert page.width == 2 * 40 + 3 * parts.MARGIN
    red = np.all(np.asarray(page) == (255, 0, 0), axis=-1)
    assert red.sum() == 3 * 40 * 40
