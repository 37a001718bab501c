"""What light that bounces costs, and how far it is off: rays, bounces and vertices.

    python scripts/light_trade.py > tables.md      # a few minutes

Prints Markdown for docs/light.md. The bunny is read from the folder that MESHDEPICT_DATA names;
without it a golf ball of as many vertices stands in. The surface is matt with albedo 0.8; grey
levels are those of the picture, sRGB, rms over the vertices.
"""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from tables import head, row

import meshdepict as md
from benchmarks import subjects
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.scene.environment import Environment
from meshdepict.transport.radiosity import bounced
from meshdepict.transport.sky_cells import parted_sky
from meshdepict.transport.transfer import Transfer, traced_transfer

Single = NDArray[np.float32]
ALBEDO, BOUNCES, RAYS = 0.8, 3, 64
MANY = 4096
PANORAMAS = ("venice_sunset_1k", "grace_256x128", "studio_small_03_1k", "ennis_256x128")
DIM = 0.2  # of panoramas, so that little is burnt out


def fading(rows: int = 64) -> Environment:
    """Return a sky that falls from 1 above to 0 below."""
    up = np.cos((np.arange(rows) + 0.5) / rows * np.pi)
    return Environment(np.repeat(((1 + up) / 2)[:, None, None], 2 * rows, axis=1).repeat(3, axis=2))


def skies() -> dict[str, Environment]:
    """Return the skies there are, without what is so bright in them that it has shadow rays."""
    found = {"a sky that fades from above": fading()}
    if "MESHDEPICT_DATA" in os.environ:
        for name in PANORAMAS:
            whole = Environment.from_file(
                Path(os.environ["MESHDEPICT_DATA"]) / "env" / f"{name}.hdr"
            )
            dim, _ = parted_sky(whole)
            found[name] = Environment(dim.pixels * np.float32(DIM))
    return found


def arriving(transfer: Transfer, sky: Environment, bounces: int = BOUNCES) -> Single:
    """Return what arrives of a sky at the vertices."""
    return bounced(transfer, transfer.from_sky(sky), albedo=ALBEDO, bounces=bounces)[0]


def levels(light: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return grey levels that are shown of so much light."""
    return 255 * np.asarray(linear_to_srgb(np.clip(ALBEDO * light, 0, 1)), float)


def rms(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """Return the root mean square difference in grey levels."""
    return float(np.sqrt(np.mean((levels(one) - levels(other)) ** 2)))


def by_rays(mesh: md.Mesh) -> None:
    """Print the error of so many rays."""
    truth = traced_transfer(mesh, rays=MANY)
    shown = skies()
    exact = {name: arriving(truth, sky) for name, sky in shown.items()}
    head("rays", "seconds traced", "a bounce", "MB kept", *shown)
    for rays in (16, 32, 64, 128, 256, 512, 1024):
        start = time.perf_counter()
        transfer = traced_transfer(mesh, rays=rays)
        traced = time.perf_counter() - start
        gray = np.ones(len(transfer), np.float32)
        start = time.perf_counter()
        transfer.from_surface(gray)
        bounce = time.perf_counter() - start
        errors = [f"{rms(arriving(transfer, sky), exact[name]):.2f}" for name, sky in shown.items()]
        row(rays, f"{traced:.2f}", f"{bounce:.4f}", f"{transfer.nbytes / 1e6:.1f}", *errors)


def by_bounces(mesh: md.Mesh) -> None:
    """Print what is still to come after so many bounces."""
    transfer, shown = traced_transfer(mesh, rays=RAYS), skies()
    whole = {name: arriving(transfer, sky, 100) for name, sky in shown.items()}
    head("bounces", *shown)
    for bounces in (0, 1, 2, 3, 4, 5, 8):
        errors = [
            f"{rms(arriving(transfer, sky, bounces), whole[name]):.2f}"
            for name, sky in shown.items()
        ]
        row(bounces, *errors)


def by_vertices() -> None:
    """Print what a coarser mesh loses: at the finest one's vertices, each taking the nearest."""
    finest = md.samples.golf_ball(400_000)
    sky = fading()
    exact = arriving(traced_transfer(finest, rays=4 * RAYS), sky)
    head("vertices of a golf ball", "seconds", "grey levels")
    for count in (5_000, 20_000, 80_000):
        mesh = md.samples.golf_ball(count)
        start = time.perf_counter()
        light = arriving(traced_transfer(mesh, rays=4 * RAYS), sky)
        seconds = time.perf_counter() - start
        tree = cKDTree(mesh.vertices)
        distance, near = tree.query(finest.vertices, k=3)
        weight = 1 / np.maximum(distance, 1e-9)
        mixed = np.einsum("nk,nkc->nc", weight / weight.sum(axis=1, keepdims=True), light[near])
        row(f"{count:,}", f"{seconds:.2f}", f"{rms(mixed.astype(np.float32), exact):.2f}")


def main() -> None:
    known = "MESHDEPICT_DATA" in os.environ
    mesh = subjects.mesh("bunny" if known else "golf ball")
    traced_transfer(mesh, rays=2)  # kernels and the tree of triangles
    by_rays(mesh)
    by_bounces(mesh)
    by_vertices()


if __name__ == "__main__":
    main()
