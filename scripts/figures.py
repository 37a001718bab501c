"""Draw figures of the four papers again, with the objects at hand.

    python scripts/figures.py -o figures/                 # all of them, eight minutes
    python scripts/figures.py ES1 RS4 --size 500
    MESHDEPICT_DATA=scans python scripts/figures.py LLA14

docs/figures.md says what they show, beside what the papers say that theirs do. Scans, environments
and lit spheres are read from the folder that MESHDEPICT_DATA names (mesh/, env/, litsphere/);
without one the golf ball stands in for all of them. Needs no display.
"""

from __future__ import annotations

import argparse
import os
import time
import warnings
from pathlib import Path

import figures_es
import figures_es_uses
import figures_light
import figures_lla
import figures_lw
import figures_rs
import figures_terrain
from figure_parts import FIGURES, Stage

import meshdepict as md

MODULES = (
    figures_es,
    figures_terrain,
    figures_es_uses,
    figures_lw,
    figures_rs,
    figures_lla,
    figures_light,
)  # importing them enters their figures


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw figures of the papers again.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(FIGURES)}")
    parser.add_argument("-o", "--output", type=Path, default=Path("figures"), help="folder")
    parser.add_argument("--size", type=int, default=320, help="of a picture, in pixels")
    given = parser.parse_args()
    unknown = [name for name in given.names if name.upper() not in FIGURES]
    if unknown:
        parser.error(f"no figure is called {', '.join(unknown)}")
    folder = os.environ.get("MESHDEPICT_DATA")
    stage = Stage(given.size, Path(folder) if folder else None)
    given.output.mkdir(parents=True, exist_ok=True)
    for name in [name.upper() for name in given.names] or FIGURES:
        start = time.perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", md.MeshdepictWarning)
            title, draw = FIGURES[name]
            picture = draw(stage)
        path = given.output / f"{name}.png"
        picture.save(path)
        print(f"{path}: {title} ({time.perf_counter() - start:.1f} s)", flush=True)


if __name__ == "__main__":
    main()
