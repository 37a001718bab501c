"""What the trade of speed for accuracy is measured on, and how: bytes of pictures that people see.

Three scans, a terrain and a CT of the folder that MESHDEPICT_DATA names; without it shapes that
the program makes itself stand in for them.
"""

from __future__ import annotations

import functools
import os
import time
import tracemalloc
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tables import ROOT

import meshdepict as md
from meshdepict.shapes.gbuffer import GBuffer

assert ROOT

Bytes = NDArray[np.uint8]
Work = Callable[[], Any]

SIDE = 600  # pixels of a picture
LONG = 3.0  # seconds, beside which whatever else the machine does is little
LARGE = 1024  # cells along a terrain, at most: the middle of larger ones


@dataclass(frozen=True)
class Row:
    """What one setting of a knob costs and gives.

    Attributes
    ----------
    knob, subject, setting : str
    seconds, core_seconds : float
        By the clock, and of all processors together.
    size : float
        Bytes that arrays take beyond those of the shape, at most.
    rms, most : float
        Difference to the knob's most exact setting in grey levels of the picture: root mean square,
        and the 99th percentile.
    """

    knob: str
    subject: str
    setting: str
    seconds: float
    core_seconds: float
    size: float
    rms: float
    most: float


@dataclass(frozen=True, eq=False)
class Subject:
    """A shape, and what a picture of it shows."""

    name: str
    shape: Any
    up: str

    @functools.cached_property
    def buffer(self) -> GBuffer:
        """What the pixels of a mesh's picture see."""
        view = md.View.fitted("front", self.shape, up=self.up, height_px=SIDE)
        return GBuffer.of(self.shape, view, size=(SIDE, SIDE))

    @property
    def is_mesh(self) -> bool:
        """Whether it has triangles of its own."""
        return bool(self.shape.kind == "mesh")

    def seen(self, found: Any) -> Bytes:
        """Return the bytes that a picture shows of a bake, or of colours at a mesh's vertices."""
        if hasattr(found, "rgba"):
            return found.rgba[found.rgba[..., 3] > 0][:, :3]
        colors = found if isinstance(found, np.ndarray) else found.colors
        if not self.is_mesh:
            return colors
        return np.rint(self.buffer.sample(colors.astype(np.float32))).astype(np.uint8)

    def bake(self, method: str = "exaggerated", **chosen: Any) -> Any:
        """Bake it as it is seen."""
        view = {"view": self.buffer.view} if self.is_mesh else {}
        return md.Look(method, **view, **chosen).bake(self.shape)


def trade(
    knob: str,
    subject: Subject,
    settings: Mapping[str, Work],
    *,
    exact: str,
    seen: Callable[[Any], Bytes] | None = None,
) -> Iterator[Row]:
    """Yield a row for each setting of a knob.

    Parameters
    ----------
    settings : mapping of str to callable
        Each does all the work.
    exact : str
        The one that the others are compared with.
    seen : callable, optional
        From what the work returns to bytes; the subject's own way unless given.
    """
    seen = seen or subject.seen
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        first, clock, cores = cost(settings[exact])
        reference = seen(first).astype(np.float32)
        for setting, work in settings.items():
            known = setting == exact and clock > LONG  # else it loaded kernels, perhaps
            found, *times = (first, clock, cores) if known else cost(work)
            off = np.abs(seen(found).astype(np.float32) - reference)
            yield Row(
                knob, subject.name, setting, *times, peak(work),
                float(np.sqrt(np.mean(off**2))), float(np.percentile(off, 99)),
            )  # fmt: skip


def cost(work: Work) -> tuple[Any, float, float]:
    """Return what a piece of work gives, its seconds by the clock and of all processors."""
    clock, cores = time.perf_counter(), time.process_time()
    found = work()
    return found, time.perf_counter() - clock, time.process_time() - cores


def peak(work: Work) -> float:
    """Return the bytes that a piece of work takes at most."""
    tracemalloc.start()
    try:
        work()
        return float(tracemalloc.get_traced_memory()[1])
    finally:
        tracemalloc.stop()


# --- the subjects --------------------------------------------------------------------------------

SCANS = {
    "bunny": ("mesh/bunny_69k.ply", "y"),
    "armadillo": ("mesh/armadillo_86k.ply", "y"),
    "flake": ("mesh/flake1_152k.ply", "z"),
}
TERRAIN, CT = "dem/dem_st_helens_30m.tif", "ct/ct_headsq_64x64x93.nrrd"


def data() -> Path | None:
    """Return the folder of real data; None where there is none."""
    return Path(os.environ["MESHDEPICT_DATA"]) if "MESHDEPICT_DATA" in os.environ else None


@functools.cache
def scans() -> tuple[Subject, ...]:
    """Return three surfaces."""
    folder = data()
    if folder is not None:
        return tuple(
            _ready(Subject(name, md.read(folder / path), up)) for name, (path, up) in SCANS.items()
        )
    samples = md.samples
    made = {
        "golf ball": samples.golf_ball(20_000), "ridges": samples.radiating_ridges(),
        "wavy sheet": samples.wavy_sheet(),
    }  # fmt: skip
    return tuple(_ready(Subject(name, shape, "y")) for name, shape in made.items())


@functools.cache
def terrain() -> Subject:
    """Return a terrain."""
    folder = data()
    if folder is not None:
        return Subject("terrain", md.read(folder / TERRAIN), "z")
    rng = np.random.default_rng(1980)
    z = np.zeros((256, 320))
    for size in (2, 4, 8, 16, 32):
        z += np.kron(rng.normal(size=(size, size * 5 // 4)), np.ones((256 // size,) * 2)) / size
    return Subject("terrain", md.HeightField(100 * z), "z")


@functools.cache
def ct() -> Subject:
    """Return a CT."""
    folder = data()
    shape = md.samples.ct_phantom((64, 64, 64)) if folder is None else md.read(folder / CT)
    return Subject("CT", shape, "z")


def everything() -> tuple[Subject, ...]:
    """Return the scans, the terrain and the CT."""
    return (*scans(), terrain(), ct())


def _ready(subject: Subject) -> Subject:
    mesh = subject.shape
    assert len(mesh.normals) == len(mesh.areas)
    assert mesh.edge_length > 0
    return subject
