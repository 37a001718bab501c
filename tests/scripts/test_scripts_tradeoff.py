"""The trade of speed for accuracy: rows are kept, knob by knob, and the page shows all of them."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from house import ROOT

from meshdepict import samples


@pytest.fixture(scope="module")
def scripts():
    sys.path.insert(0, str(ROOT / "scripts"))
    try:
        import tradeoff
        import tradeoff_page
        import tradeoff_subjects
    finally:
        sys.path.remove(str(ROOT / "scripts"))
    return tradeoff, tradeoff_page, tradeoff_subjects


@pytest.fixture
def rows(scripts):
    """What three ways of adding a third cost, of which the last is exact."""
    *_, subjects = scripts
    ball = subjects.Subject("ball", samples.sphere(40), "y")
    count = len(ball.shape.vertices)
    settings = {
        name: lambda level=level: np.full((count, 3), level, np.uint8)
        for name, level in {"far": 97, "near": 101, "exact": 100}.items()
    }
    return list(subjects.trade("tolerance", ball, settings, exact="exact"))


def test_errors_are_those_of_the_bytes_that_pixels_show(rows):
    assert [row.rms for row in rows] == pytest.approx([3, 1, 0])
    assert [row.most for row in rows] == pytest.approx([3, 1, 0])
    assert all(row.size > 0 for row in rows)


def test_rows_are_kept_and_read_again(scripts, rows, tmp_path):
    tradeoff, *_ = scripts
    path = tmp_path / "rows.jsonl"
    assert tradeoff.kept(path) == {}
    tradeoff.keep(path, {"tolerance": rows, "rays": rows[:1]})
    assert tradeoff.kept(path) == {"tolerance": rows, "rays": rows[:1]}


def test_the_page_has_every_row(scripts, rows, tmp_path):
    _, page, _ = scripts
    page.write(tmp_path, {"tolerance": rows}, {"tolerance": "Allow an error.", "rays": "Send."})
    text = (tmp_path / "accuracy.md").read_text(encoding="utf-8")
    assert "### Tolerance" in text
    assert "Send." not in text
    assert all(f"| {row.setting} |" in text for row in rows)
    assert (tmp_path / "accuracy.png").stat().st_size > 0
