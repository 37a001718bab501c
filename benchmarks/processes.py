"""Whole processes, as people start them: the import, a command, every method."""

from __future__ import annotations

import functools
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks import subjects
from meshdepict.shading import METHODS, declaration

# Lambert with the scale space that the method declares, which it then doesn't look at.
BASELINE = """
import sys
from dataclasses import replace
from meshdepict.cli import main
scales, ratio, *words = sys.argv[1:]
if int(scales):  # as the command would be: it loads no method before it parses
    from meshdepict.shading import lambert
    lambert.declaration = replace(lambert.declaration, scales=int(scales), ratio=float(ratio))
sys.exit(main(words))
"""


# What a process had at most. One that is started has what its parent had then, so a small one does.
PEAK = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


@functools.cache
def _bytecode() -> tempfile.TemporaryDirectory[str]:
    """Return a folder of compiled modules, as an installed package has them."""
    return tempfile.TemporaryDirectory(prefix="meshdepict-bytecode-")


class _Processes:
    """A folder to work in."""

    number, repeat, warmup_time, timeout = 1, (1, 5, 60.0), 0.0, 300

    def setup(self, *_: str) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="meshdepict-processes-")

    def teardown(self, *_: str) -> None:
        self.folder.cleanup()

    def run(self, *words: str, cache: Path | None = None) -> str:
        """Run Python with these words; with a cache of compiled kernels other than the usual."""
        env = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
        env |= {"NUMBA_CACHE_DIR": str(cache)} if cache else {}
        env["PYTHONPYCACHEPREFIX"] = _bytecode().name
        line = [sys.executable, *words]
        done = subprocess.run(
            line, check=True, env=env, cwd=self.folder.name, stdout=subprocess.PIPE, text=True
        )
        return done.stdout


class Import:
    """The import alone, without Python's own start."""

    def timeraw_package(self) -> str:
        return "import meshdepict"

    def timeraw_command_line(self) -> str:
        return "import meshdepict.cli"


class Command(_Processes):
    """``meshdepict bake``, with its caches, and the very first time, without."""

    params = (("golf ball", "bunny"),)
    param_names = ("subject",)

    def setup(self, subject: str) -> None:
        super().setup()
        file = str(subjects.path(subject).resolve())
        self.words = ("-m", "meshdepict", "bake", file, "-o", "out.ply", "--force", "--quiet")
        self.run(*self.words)

    def time_baking(self, subject: str) -> None:
        self.run(*self.words)

    def track_memory(self, subject: str) -> int:
        return 1024 * int(self.run("-c", PEAK, sys.executable, *self.words).split()[-1])

    track_memory.unit = "bytes"

    def time_first_baking(self, subject: str) -> None:
        with tempfile.TemporaryDirectory(dir=self.folder.name) as empty:
            self.run(*self.words, cache=Path(empty))


class Method(_Processes):
    """A method's bake, and Lambert's with as many scales: the method itself costs the difference.

    Parameters
    ----------
    subject : str
        Of `subjects`, or the path of a mesh.
    """

    params = (tuple(METHODS),)
    param_names = ("method",)

    def __init__(self, subject: str = "golf ball") -> None:
        self.subject = subject

    def setup(self, method: str) -> None:
        super().setup()
        file, declared = str(subjects.path(self.subject).resolve()), declaration(METHODS[method])
        words = ("bake", file, "-o", "out.ply", "--force", "--quiet", "-m")
        self.own = ("-m", "meshdepict", *words, method)
        self.base = (
            "-c", BASELINE, str(declared.scales), str(declared.ratio), *words, "lambert",
        )  # fmt: skip
        self.time_baking(method)
        self.time_lambert_with_its_scales(method)

    def time_baking(self, method: str) -> None:
        self.run(*self.own)

    def time_lambert_with_its_scales(self, method: str) -> None:
        self.run(*self.base)
