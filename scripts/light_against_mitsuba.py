"""Compare light that bounces with Mitsuba 3's path tracer, at every vertex of a mesh.

    pip install mitsuba
    python scripts/light_against_mitsuba.py [MESH] > table.md      # some minutes

In an environment of its own, with meshdepict. Prints Markdown for docs/light.md. The golf ball is
taken where no mesh is named. The surface is matt with albedo 0.8 and is lit by a sky that fades
from 1 above to 0 below; three bounces. Mitsuba's rays start a little above each vertex and look
back at it.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tables import head, row

import meshdepict as md
from meshdepict.scene.environment import Environment
from meshdepict.transport.radiosity import bounced
from meshdepict.transport.transfer import traced_transfer

try:
    import mitsuba as mi
except ImportError:
    sys.exit("This comparison needs Mitsuba 3, which meshdepict does not: pip install mitsuba")

mi.set_variant("llvm_ad_rgb")

Floats = NDArray[np.float64]
ALBEDO, BOUNCES, ROWS = 0.8, 3, 256
MANY = 4096  # paths, or rays, that the truth is made of
SOME = (16, 64, 256)


def fading_sky() -> NDArray[np.float32]:
    """Return radiance that falls from 1 at the zenith to 0 at the nadir."""
    up = np.cos((np.arange(ROWS) + 0.5) / ROWS * np.pi)
    return np.repeat(((1 + up) / 2)[:, None, None], 2 * ROWS, axis=1).repeat(3, axis=2).astype("f4")


def ours(mesh: md.Mesh, rays: int) -> tuple[Floats, float]:
    """Return what arrives at the vertices, and seconds."""
    start = time.perf_counter()
    transfer = traced_transfer(mesh, rays=rays)
    light = transfer.from_sky(Environment(fading_sky()))[:, 0]
    arriving, _ = bounced(transfer, light, albedo=ALBEDO, bounces=BOUNCES)
    return arriving.astype(float), time.perf_counter() - start


class PathTracer:
    """Mitsuba's scene of a mesh, and rays that look at its vertices."""

    def __init__(self, mesh: md.Mesh) -> None:
        shape = mi.Mesh(
            "mesh", len(mesh.vertices), len(mesh.faces), has_vertex_normals=True,
            props=_props(),
        )  # fmt: skip
        self.points = mesh.unit_points
        outward = mesh.outward_faces
        params = mi.traverse(shape)
        params["vertex_positions"] = self.points.astype(np.float32).ravel()
        params["vertex_normals"] = mesh.normals.astype(np.float32).ravel()
        params["faces"] = outward.astype(np.uint32).ravel()
        params.update()
        # Mitsuba's panorama turns about y, too; this one looks the same all round.
        sky = {"type": "envmap", "bitmap": mi.Bitmap(fading_sky()), "scale": 1.0}
        self.scene = mi.load_dict({"type": "scene", "mesh": shape, "sky": sky})
        self.integrator = mi.load_dict(
            {"type": "path", "max_depth": BOUNCES + 2, "rr_depth": 1000, "hide_emitters": False}
        )
        # A face of each vertex, and a place within it a thousandth of the way to its middle: a ray
        # at the vertex itself might pass between two faces.
        face = np.zeros(len(self.points), np.int64)
        face[outward] = np.arange(len(outward))[:, None]
        middle = self.points[outward[face]].mean(axis=1)
        self.places = self.points + 1e-2 * (middle - self.points)
        self.normals = mesh.normals.astype(float)

    def arriving(self, paths: int, seed: int) -> tuple[Floats, float]:
        """Return what arrives at the vertices, and seconds."""
        start = time.perf_counter()
        count = len(self.places)
        each = max(1, min(paths, 4_000_000 // count))
        total, done = np.zeros(count), 0
        while done < paths:
            now = min(each, paths - done)
            sampler = mi.load_dict({"type": "independent", "sample_count": now})
            sampler.seed(seed + done, count * now)
            origins = self.places + 1e-4 * self.normals
            rays = mi.RayDifferential3f(
                mi.Point3f(*_repeated(origins, now)), mi.Vector3f(*_repeated(-self.normals, now))
            )
            radiance, _, _ = self.integrator.sample(self.scene, sampler, rays)
            red = np.array(radiance.x, float)
            total += red.reshape(count, now).sum(axis=1)
            done += now
        return total / paths / ALBEDO, time.perf_counter() - start


def _props() -> Any:
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(
        {"type": "diffuse", "reflectance": {"type": "rgb", "value": [ALBEDO] * 3}}
    )
    return props


def _repeated(vectors: Floats, times: int) -> list[Any]:
    return [mi.Float(np.repeat(part, times).astype(np.float32)) for part in vectors.T]


def rms(values: Floats, truth: Floats) -> float:
    """Return the root mean square difference."""
    return float(np.sqrt(np.mean((values - truth) ** 2)))


def main() -> None:
    mesh = md.read_mesh(sys.argv[1]) if len(sys.argv) > 1 else md.samples.golf_ball(36_000)
    tracer = PathTracer(mesh)
    mine, _ = ours(mesh, MANY)
    theirs, _ = tracer.arriving(MANY, seed=1)
    print(f"{len(mesh.vertices):,} vertices, Mitsuba {mi.__version__}, {MANY} paths of each: ")
    print(f"both differ by {rms(mine, theirs):.4f} (rms), mean {np.mean(mine - theirs):+.4f}.")
    head("rays or paths", "ours", "seconds", "Mitsuba", "seconds")
    for count in SOME:
        one, seconds = ours(mesh, count)
        other, took = tracer.arriving(count, seed=7)
        row(count, f"{rms(one, mine):.4f}", f"{seconds:.2f}", f"{rms(other, theirs):.4f}",
            f"{took:.2f}")  # fmt: skip


if __name__ == "__main__":
    main()
