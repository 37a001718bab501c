"""Measure the trade of speed for accuracy, knob by knob, and write docs/accuracy.md from it.

    MESHDEPICT_DATA=… python scripts/tradeoff.py                  # all knobs, about ten minutes
    python scripts/tradeoff.py --only tolerance rays              # these alone, measured anew
    python scripts/tradeoff.py --page                             # the page from what was measured

Rows are kept in docs/accuracy.jsonl as they are found, so that an interrupted run goes on where it
was; --anew forgets them. Without MESHDEPICT_DATA samples that the program makes itself stand in for
scans, terrain and CT. Errors are in grey levels of the picture; kernels are loaded before.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path

import tradeoff_light
import tradeoff_page
import tradeoff_pictures
import tradeoff_smoothing
from tables import ROOT
from tradeoff_subjects import Row

import meshdepict as md

KNOBS: dict[str, Callable[[], Iterator[Row]]] = {
    knob.__name__: knob
    for each in (tradeoff_smoothing, tradeoff_light, tradeoff_pictures)
    for knob in each.KNOBS
}
ROWS = ROOT / "docs" / "accuracy.jsonl"


def kept(path: Path) -> dict[str, list[Row]]:
    """Return the rows of those knobs that were measured to their end."""
    found: dict[str, list[Row]] = {}
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            read = json.loads(line)
            found[read["knob"]] = [Row(**row) for row in read["rows"]]
    return found


def keep(path: Path, rows: dict[str, list[Row]]) -> None:
    """Write all rows, a line for each knob."""
    lines = [
        json.dumps({"knob": knob, "rows": [asdict(row) for row in rows[knob]]}, ensure_ascii=False)
        for knob in KNOBS
        if knob in rows
    ]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--only", nargs="*", choices=list(KNOBS), help="these knobs, anew")
    parser.add_argument("--anew", action="store_true", help="forget what was measured")
    parser.add_argument("--page", action="store_true", help="measure nothing")
    parser.add_argument("--rows", type=Path, default=ROWS)
    parser.add_argument("--out", type=Path, default=ROOT / "docs")
    given = parser.parse_args()
    warnings.simplefilter("ignore", md.MeshdepictWarning)
    rows = {} if given.anew else kept(given.rows)
    wanted = given.only or [name for name in KNOBS if name not in rows]
    for name in [] if given.page else wanted:
        begin = time.perf_counter()
        rows[name] = list(KNOBS[name]())
        keep(given.rows, rows)
        print(f"{name}: {time.perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)
    tradeoff_page.write(given.out, rows, {name: knob.__doc__ or "" for name, knob in KNOBS.items()})


if __name__ == "__main__":
    main()
