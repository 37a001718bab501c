"""Reading takes a time that follows the file's size, whatever is in it."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.io import obj, off, ply, stl

TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    b"property float z\nelement face %d\nproperty list uchar int vertex_indices\n%send_header\n"
)

# Each gave the square of its size, or gives it to a reader that is written without care.
FILES: dict[str, tuple[ModuleType, int, Callable[[int], bytes]]] = {
    "stl: newlines after a word": (
        stl, 100_000, lambda n: b"solid a\nfacet\nvertex" + b"\n" * n + b"x\nendsolid"
    ),
    "stl: blanks after a word": (
        stl, 100_000, lambda n: b"solid a\nfacet\nvertex " + b" " * n + b"x\nendsolid"
    ),
    "stl: blank lines": (stl, 100_000, lambda n: b"solid a\n" + b" \n" * n + b"endsolid"),
    "stl: many words": (stl, 100_000, lambda n: b"solid a\n" + b"vertex " * n + b"endsolid"),
    "obj: blanks": (obj, 200_000, lambda n: TRIANGLE + b" " * n + b"x\\\n"),
    "obj: blank lines": (obj, 200_000, lambda n: TRIANGLE + b" \t\n" * n + b"f 1 2 3\n"),
    "obj: continuations": (obj, 20_000, lambda n: TRIANGLE + b"f 1 2 3 " + b"\\\n 1 " * n + b"\n"),
    "obj: continued comments": (obj, 50_000, lambda n: TRIANGLE + b"# a\\\n" * n + b"f 1 2 3\n"),
    "obj: backslashes": (obj, 200_000, lambda n: TRIANGLE + b"\\" * n + b"\nf 1 2 3\n"),
    "obj: slashes": (obj, 100_000, lambda n: TRIANGLE + b"f " + b"1/" * n + b"\n"),
    "ply: elements": (
        ply, 3000, lambda n: PLY
        % (1, b"".join(b"element e%d 1\nproperty int a\n" % k for k in range(n)))
        + b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n" + b"1\n" * n
    ),
    "ply: short lines": (
        ply, 50_000, lambda n: PLY % (n, b"") + b"0 0 0\n1 0 0\n0 1 0\n" + b"3\n0 1 2\n" * n
    ),
    "ply: words": (
        ply, 50_000, lambda n: PLY % (n, b"property float q\n")
        + b"0 0 0\n1 0 0\n0 1 0\n" + b"".join(b"3 0 1 2 w%d\n" % k for k in range(n))
    ),
    "off: line breaks": (
        off, 50_000, lambda n: b"OFF 3 %d 0 0 0 0 1 0 0 0 1 0" % n + b" 3 0 1 2" * n
    ),
    "off: comments": (off, 100_000, lambda n: b"#\n" * n + b"OFF"),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
@pytest.mark.filterwarnings("ignore")
def test_four_times_the_file_takes_no_more_than_eight_times_the_time(name):
    module, size, make = FILES[name]

    def spent(count: int) -> float:
        data = make(count)
        gc.collect()
        gc.disable()  # what it takes follows from what other tests have left behind
        try:
            start = time.process_time()
            with suppress(MeshdepictError):  # what is no mesh has to be refused as fast
                module.decode(data, Path("file"))
            return time.process_time() - start
        finally:
            gc.enable()

    spent(10)
    short, long = spent(size), spent(4 * size)
    # The square would be 16, and seconds; half of it leaves room for caches, and 0.15 s for noise.
    assert long < 8 * short + 0.15
    assert long < 10
