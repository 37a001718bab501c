"""Digests of what every method bakes on a mesh, a volume and an image.

Two versions that give the same lines give the same pictures, byte for byte::

    python scripts/picture_digests.py > before.txt
    …
    python scripts/picture_digests.py --against before.txt
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import meshdepict as md

LIGHTS = ("northwest", (200, -15))


def digest(*arrays: np.ndarray) -> str:
    found = hashlib.sha256()
    for array in arrays:
        found.update(repr((array.shape, array.dtype.str)).encode())
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()[:16]


def lines() -> Iterator[str]:
    ball = md.samples.golf_ball(3_000)
    phantom = md.samples.ct_phantom((24, 28, 20))
    pixels = md.GBuffer.of(ball, "front", size=(90, 80))
    for name in md.shading.METHODS:
        for light in LIGHTS:
            for shape in (ball, phantom, pixels):
                try:
                    if shape is phantom:
                        voxels = md.bake_volume(phantom, name, light=light)
                        found = digest(voxels.intensity, voxels.rgba)
                    else:
                        baked = md.bake(shape, name, light=light)
                        found = digest(baked.intensity, baked.colors)
                except md.MeshdepictError as error:
                    found = str(error)
                yield f"{name} {light} {shape.kind}: {found}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--against", type=Path, help="an earlier output to compare with")
    against = parser.parse_args().against
    found = list(lines())
    if against is None:
        print("\n".join(found))
        return
    other = [line for line in found if line not in against.read_text(encoding="utf-8").splitlines()]
    print("\n".join(other) or f"all {len(found)} alike")
    sys.exit(bool(other))


if __name__ == "__main__":
    main()
