"""Knobs of smoothing: tolerance, facing, scales and their ratio, precision, tiles, the sets."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from tradeoff_subjects import Row, ct, everything, scans, terrain, trade

import meshdepict as md
from meshdepict.baking.accuracy import ACCURACIES
from meshdepict.baking.relief import Relief

TOLERANCES = (3e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
LADDERS = {
    "3, ratio 4": (3, 4.0), "5, ratio 2": (5, 2.0), "7, ratio 1.59": (7, 2 ** (2 / 3)),
    "9, ratio √2": (9, math.sqrt(2)), "17, ratio 1.19": (17, 2**0.25),
}  # fmt: skip


def tolerance() -> Iterator[Row]:
    """Allow smoothed normals an error, in radians; Exaggerated Shading."""
    for one in everything():
        settings = {f"{t:g}": lambda t=t, s=one: s.bake(tolerance=t) for t in TOLERANCES}
        yield from trade("tolerance", one, settings, exact="1e-06")


def facing() -> Iterator[Row]:
    """Keep the two sides of thin sheets apart, or not, which is another picture."""
    for one in scans():
        settings = {str(f): lambda f=f, s=one: s.bake(facing=f) for f in (0, 1)}
        yield from trade("facing", one, settings, exact="1")


def scales() -> Iterator[Row]:
    """Take more scales or fewer, from the same first to the same last."""
    for one in everything():
        settings = {
            name: lambda n=n, r=r, s=one: s.bake(scales=n, ratio=r)
            for name, (n, r) in LADDERS.items()
        }
        yield from trade("scales and ratio", one, settings, exact="17, ratio 1.19")


def precision() -> Iterator[Row]:
    """Round positions and heights to float32, or to 16 bits as quantised files do."""
    for one in (*scans(), terrain()):
        whole = one.shape.vertices if one.is_mesh else one.shape.z
        low, span = np.nanmin(whole), np.nanmax(whole) - np.nanmin(whole)

        def baked(values, s=one):
            if s.is_mesh:
                mesh = md.Mesh(values, s.shape.faces)
                return md.bake(mesh, view=s.buffer.view)
            return md.bake(md.HeightField(values, transform=s.shape.transform))

        exact = np.asarray(whole, np.float64)
        rounded = {
            "float64": exact,
            "float32": exact.astype(np.float32).astype(np.float64),
            "16 bits": low + span / 65535 * np.rint((exact - low) / span * 65535),
        }
        settings = {name: lambda v=v, f=baked: f(v) for name, v in rounded.items()}
        yield from trade("float32 against float64", one, settings, exact="float64")


def tiles() -> Iterator[Row]:
    """Give windows and slabs little memory: smaller ones, the same picture."""
    ground, volume = terrain(), ct()

    def relief(memory):
        parts = Relief(ground.shape, md.Look(), memory=memory)
        picture = np.zeros((*ground.shape.z.shape, 3), np.uint8)
        for part in parts.windows():
            picture[part.rows, part.columns] = part.colors
        return picture

    settings = {f"{m:g} MB": lambda m=m: relief(m * 1e6) for m in (64, 1000)}
    yield from trade("tile size", ground, settings, exact="1000 MB", seen=lambda found: found)
    settings = {
        f"{m:g} MB": lambda m=m: md.bake_volume(volume.shape, memory=m * 1e6) for m in (8, 1000)
    }
    yield from trade("tile size", volume, settings, exact="1000 MB")


def sets() -> Iterator[Row]:
    """Take the named sets; against reference."""
    methods = {
        "exaggerated": {}, "light_alignment": {}, "sky_view": {},
        "lambert, soft shadows": {"shadows": True, "light": "northwest:10"},
    }  # fmt: skip
    for one in (*scans(), terrain(), ct()):
        for name, chosen in methods.items():
            method = name.partition(",")[0]
            if one is not scans()[0] and ("sky" in name or "shadows" in name):
                continue  # which take minutes
            settings = {
                f"{name}: {a}": lambda a=a, m=method, c=chosen, s=one: s.bake(m, accuracy=a, **c)
                for a in ACCURACIES
            }
            yield from trade("accuracy", one, settings, exact=f"{name}: reference")


KNOBS = (tolerance, facing, scales, precision, tiles, sets)
