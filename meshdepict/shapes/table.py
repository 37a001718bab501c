"""Rows of words as a table: in columns of text, and as HTML for notebooks."""

from __future__ import annotations

import html
from collections.abc import Sequence

__all__ = ["Rows", "columns", "html_table"]

Rows = Sequence[Sequence[str]]
"""Cells of text; of each row as many."""

_CELL = "text-align: left; vertical-align: top"


def columns(rows: Rows, indent: str = "") -> str:
    """Return rows as lines, every column but the last as wide as its widest cell."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    padded = ([cell.ljust(width) for cell, width in zip(row, widths, strict=True)] for row in rows)
    return "\n".join((indent + "  ".join(cells)).rstrip() for cells in padded)


def html_table(rows: Rows, title: str, head: Sequence[str] = ()) -> str:
    """Return rows as an HTML table, the first cell of each as its heading."""
    parts = [f'<table><caption style="{_CELL}"><b>{html.escape(title)}</b></caption>']
    if head:
        names = "".join(f'<th style="{_CELL}">{html.escape(name)}</th>' for name in head)
        parts.append(f"<thead><tr>{names}</tr></thead>")
    for first, *others in rows:
        cells = "".join(f'<td style="{_CELL}">{html.escape(cell)}</td>' for cell in others)
        parts.append(f'<tr><th style="{_CELL}">{html.escape(first)}</th>{cells}</tr>')
    return "\n".join([*parts, "</table>"])
