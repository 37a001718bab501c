"""docs/formats.md says what the code does."""

from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs" / "formats.md"


def test_the_tables_are_what_writing_and_reading_gives():
    pytest.importorskip("SimpleITK")
    pytest.importorskip("rasterio")
    from io_tables import tables

    lines = DOCS.read_text(encoding="utf-8").splitlines()
    for line in tables():
        assert line in lines
