"""Spoil files of every format as often as one likes, and count how reading them ended.

    python scripts/fuzz.py --files 100000

Files are numbered: ``--first 2999 --files 1`` tries one of them again, ``--keep FOLDER`` writes
those that were neither read nor refused in a sentence.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1] / "tests"
sys.path[:0] = [str(TESTS), str(TESTS / "fuzz")]

from campaign import GOOD, outcomes  # noqa: E402
from mutated_files import mutated, seeds  # noqa: E402


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--files", type=int, default=3_000)
    parser.add_argument("--keep", type=Path, help="where files go that ended badly")
    given = parser.parse_args()
    start, counts = time.perf_counter(), Counter()
    with tempfile.TemporaryDirectory() as folder:
        good = seeds(Path(folder)) if given.keep else {}
    for found in outcomes(given.first, given.first + given.files):
        counts[found.ending] += 1
        if found.ending not in GOOD:
            print(*found, sep="\t", flush=True)
            if given.keep:
                given.keep.mkdir(parents=True, exist_ok=True)
                path = given.keep / f"{found.number}-{found.seed}"
                path.write_bytes(mutated(good[found.seed], found.number))
    seconds = time.perf_counter() - start
    words = ", ".join(f"{count:,} {ending}" for ending, count in counts.most_common())
    print(f"{counts.total():,} files in {seconds:.0f} s: {words}")
    sys.exit(any(ending not in GOOD for ending in counts))


if __name__ == "__main__":
    main()
