"""Bake for an hour, everything in turn, and say whether the process grows.

``python scripts/soak.py --minutes 60``. Each bake has a random shape, method, light, options,
format to write and read again, and now and then something wrong. Afterwards: how much memory a
hundred bakes add (a line through the process's size after each, once caches have filled), and
which descriptors, threads, child processes and temporary files are left that were not there.
Exits with 1 where anything is, or where memory grows by more than `BOUND`.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import threading
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import meshdepict as md
from meshdepict.shading import METHODS, declaration

BOUND = 2.0
"""Megabytes that a hundred bakes may add. A mesh, its scale space and its rays are 3 to 20 MB: one
that stays in a hundred is found."""

SETTLED = 0.4  # share of the bakes after which caches, arenas and kernels are taken to be there
_LIGHTS = (
    "northwest", "studio", "key-and-fill", "30,40", "0.2,0.5,0.8", "northwest:3", ("north", "east"),
)  # fmt: skip
_VIEWS = ("auto", "front", "top", "isometric")


@dataclass
class Left:
    """What a process holds of the system.

    Attributes
    ----------
    descriptors, threads, children : int
    temporary : set of str
        Names in the folder of temporary files.
    """

    descriptors: int
    threads: int
    children: int
    temporary: set[str]

    @classmethod
    def now(cls) -> Left:
        """Count."""
        fds = Path("/proc/self/fd")
        count = len(list(fds.iterdir())) - 1 if fds.is_dir() else 0
        return cls(count, threading.active_count(), _children(), set(os.listdir(_temporary())))


def _temporary() -> str:
    return tempfile.gettempdir()


def _children() -> int:
    tasks = Path("/proc/self/task")
    if not tasks.is_dir():
        return 0
    found = 0
    for task in tasks.iterdir():
        try:
            found += len((task / "children").read_text().split())
        except OSError:  # a thread that has ended meanwhile
            continue
    return found


def megabytes() -> float:
    """Return how much of the memory the process has now."""
    status = Path("/proc/self/statm")
    if not status.exists():
        return 0.0
    return int(status.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


@dataclass
class Soak:
    """Bakes one after the other, and what was seen on the way."""

    seed: int = 0
    sizes: list[float] = field(default_factory=list)
    done: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Make the shapes that files are written from."""
        self.random = np.random.default_rng(self.seed)
        self.sky = md.Environment(self.random.uniform(0.1, 1, (16, 32, 3)).astype(np.float32))

    def run(self, go_on: Callable[[int], bool], folder: Path) -> None:
        """Bake as long as a function of their number says so."""
        number = 0
        while go_on(number):
            self.one(folder)
            self.sizes.append(megabytes())
            number += 1

    def one(self, folder: Path) -> None:
        """Bake once, right or wrong, and remove what was written."""
        kind = str(self.random.choice(list(_KINDS), p=[k[1] for k in _KINDS.values()]))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", md.MeshdepictWarning)
                _KINDS[kind][0](self, folder)
        except md.MeshdepictError:
            self.done[f"{kind}, refused"] += 1
        except Exception as error:
            self.faults.append(f"{kind}: {type(error).__name__}: {error}")
        else:
            self.done[kind] += 1
        for path in folder.iterdir():
            path.unlink()

    def pick(self, things: Any) -> Any:
        """Return one of some things."""
        return things[int(self.random.integers(len(things)))]

    def mesh(self) -> md.Mesh:
        """Return a mesh that no other bake has."""
        count = int(self.random.integers(300, 4000))
        make = self.pick(
            [md.samples.sphere, md.samples.torus, md.samples.wavy_sheet, md.samples.golf_ball]
        )
        mesh = make(max(count, 1500)) if make is md.samples.golf_ball else make(count)
        shaken = mesh.vertices * self.random.uniform(0.5, 2) + self.random.normal(0, 0.1, 3)
        return md.Mesh(shaken, mesh.faces)

    def choices(self, *, needs: set[str]) -> tuple[str, dict[str, Any]]:
        """Return a method that needs none of these, with a look."""
        names = [name for name in METHODS if not declaration(METHODS[name]).needs & needs]
        name = self.pick(names)
        chosen: dict[str, Any] = {"view": self.pick(_VIEWS)}
        lights = declaration(METHODS[name]).lights
        if lights != "none":
            chosen["light"] = self.pick(_LIGHTS) if lights == "several" else "west"
            if lights == "several" and self.random.random() < 0.3:
                chosen["light"] = self.sky
        if self.random.random() < 0.3:
            chosen["scales"] = int(self.random.integers(1, 7))
        if self.random.random() < 0.1:
            chosen["tolerance"] = 1e-6
        if self.random.random() < 0.2:
            chosen["facing"] = 0
        if name in ("lambert", "phong", "light_warping") and self.random.random() < 0.4:
            chosen |= {"shadows": True, "rays": 16, "bounces": int(self.random.integers(0, 3))}
        return name, chosen

    def surface(self, folder: Path) -> None:
        """Write a mesh, read and bake it, save that and read it again."""
        first = folder / f"in.{self.pick(('ply', 'obj', 'off', 'glb', 'vtp'))}"
        md.bake(self.mesh(), "slope").save(first)
        name, chosen = self.choices(needs={"heights"})
        after = folder / f"out.{self.pick(('ply', 'obj', 'glb', 'vtp', 'ply.gz', 'html'))}"
        md.bake(first, name, **chosen).save(after)
        if after.suffix != ".html":
            md.read_mesh(after)

    def memory(self, _: Path) -> None:
        """Bake a mesh that has no file, then under another light."""
        name, chosen = self.choices(needs={"heights"})
        space = md.scale_space(self.mesh(), scales=5)
        md.bake(space, name, view=chosen["view"])
        md.bake(space, "exaggerated", light="east")

    def ground(self, folder: Path) -> None:
        """Bake terrain to a picture on its grid."""
        name, _ = self.choices(needs={"areas"})
        sides = tuple(int(n) for n in self.random.integers(20, 90, 2))
        md.bake(md.samples.terrain(sides), name).save(folder / "ground.png")

    def volume(self, folder: Path) -> None:
        """Bake a volume."""
        name, _ = self.choices(needs={"heights", "rays", "surface", "areas"})
        sides = tuple(int(n) for n in self.random.integers(12, 28, 3))
        baked = md.bake_volume(md.samples.ct_phantom(sides), name)
        baked.save(folder / "volume.vti")

    def texture(self, folder: Path) -> None:
        """Bake a texture."""
        name, _ = self.choices(needs={"heights", "areas"})
        md.bake_texture(md.samples.sphere(400), name, size=128).save(folder / "texture.glb")

    def wrong(self, folder: Path) -> None:
        """Ask for what can't be."""
        spoiled = folder / "spoiled.ply"
        whole = folder / "whole.ply"
        md.bake(md.samples.sphere(200), "slope").save(whole)
        data = bytearray(whole.read_bytes())
        at = self.random.integers(0, len(data), 20)
        for place in at:
            data[int(place)] = int(self.random.integers(256))
        spoiled.write_bytes(bytes(data[: int(self.random.integers(10, len(data)))]))
        asked: list[Callable[[], object]] = [
            lambda: md.bake(spoiled),
            lambda: md.bake(folder / "missing.ply"),
            lambda: md.bake(md.samples.sphere(100), "nonsense"),
            lambda: md.bake(md.samples.sphere(100), light="nowhere"),
            lambda: md.bake(md.samples.sphere(100)).save(folder / "no" / "such" / "folder.ply"),
            lambda: md.read(spoiled),
        ]
        self.pick(asked)()


_KINDS: dict[str, tuple[Callable[[Soak, Path], None], float]] = {
    "a file": (Soak.surface, 0.4),
    "a mesh in memory": (Soak.memory, 0.2),
    "terrain": (Soak.ground, 0.1),
    "a volume": (Soak.volume, 0.05),
    "a texture": (Soak.texture, 0.05),
    "an error": (Soak.wrong, 0.2),
}


def growth(sizes: list[float]) -> tuple[float, float]:
    """Return the megabytes that a hundred bakes add, and the standard error of that.

    By a line through the sizes once caches are filled.
    """
    late = np.array(sizes[int(len(sizes) * SETTLED) :])
    if len(late) < 3:
        return 0.0, np.inf
    at = np.arange(len(late)) / 100
    at = at - at.mean()
    slope = float(at @ late / (at @ at))
    rest = late - late.mean() - slope * at
    return slope, float(np.sqrt((rest @ rest) / (len(late) - 2) / (at @ at)))


def settle(folder: Path, soak: Soak) -> Left:
    """Bake each kind once, so that what stays for the whole process is there; return what is."""
    for work, _ in _KINDS.values():
        for _ in range(2):
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", md.MeshdepictWarning)
                    work(soak, folder)
            except md.MeshdepictError:
                pass
    for path in folder.iterdir():
        path.unlink()
    return Left.now()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="meshdepict-soak-") as place:
        folder, soak = Path(place), Soak(asked.seed)
        before = settle(folder, soak)
        end = time.monotonic() + 60 * asked.minutes
        soak.run(lambda _: time.monotonic() < end, folder)
        after = Left.now()
    slope, error = growth(soak.sizes)
    print(f"{len(soak.sizes):,} bakes in {asked.minutes:g} minutes:")
    for name, count in sorted(soak.done.items()):
        print(f"  {count:6,} {name}")
    print(f"memory: {soak.sizes[0]:.0f} MB after the first, {soak.sizes[-1]:.0f} MB at the end, "
          f"{max(soak.sizes):.0f} MB at most")  # fmt: skip
    print(f"a hundred bakes add {slope:+.2f} ± {error:.2f} MB (bound {BOUND:g})")
    print(f"descriptors {before.descriptors} → {after.descriptors}, threads {before.threads} → "
          f"{after.threads}, children {before.children} → {after.children}, temporary files left "
          f"{len(after.temporary - before.temporary)}")  # fmt: skip
    for fault in sorted(set(soak.faults)):
        print(f"fault: {fault}")
    grown = after.descriptors > before.descriptors or after.threads > before.threads
    bad = soak.faults or grown or after.children > before.children or slope - 2 * error > BOUND
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
