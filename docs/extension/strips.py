"""Pictures of the manual: samples seen once, shaded often; pixels take what vertices have."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from contact_sheet import Seen
from PIL import Image

import meshdepict as md
from meshdepict import samples

SIZE = 640  # pixels drawn; strips are half of it
EDGE = 12  # of ground above and below a find

_MESHES = {
    "coin": lambda: samples.coin(60_000),
    "golf_ball": lambda: samples.golf_ball(30_000),
    "inscription": lambda: samples.inscription(90_000),
    "knapped_core": lambda: samples.knapped_core(60_000),
    "tablet": lambda: samples.tablet(90_000),
}


@cache
def _seen(sample: str) -> Seen:
    return Seen(_MESHES[sample](), "y", "front", SIZE)


@cache
def _ground() -> md.HeightField:
    return samples.terrain((320, 320))


def picture(sample: str, method: str, **chosen: Any) -> Image.Image:
    """Return a sample as a method shows it, as it is unless something is chosen."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", md.MeshdepictWarning)
        if sample == "terrain":
            return _terrain(method, chosen)
        seen = _seen(sample)
        image = seen.picture(seen.bake(method, **chosen))
    rows = np.flatnonzero(seen.buffer.mask.any(axis=1))  # a wide find has no use for a square
    top, bottom = max(rows[0] - EDGE, 0), min(rows[-1] + 1 + EDGE, SIZE)
    return image.crop((0, top, SIZE, bottom))


def save(image: Image.Image, path: Path, width: int = SIZE) -> None:
    """Write a picture in the width in which it is shown."""
    path.parent.mkdir(parents=True, exist_ok=True)
    height = round(image.height * width / image.width)
    image.resize((width, height), Image.Resampling.LANCZOS).save(path, quality=88, method=4)


def plain(sample: str) -> str:
    """Return the method that shows a sample without any art."""
    return "hillshade" if sample == "terrain" else "lambert"


def _terrain(method: str, chosen: dict[str, Any]) -> Image.Image:
    baked = md.bake(_ground(), method, **chosen)
    rows, columns = _ground().z.shape
    return Image.fromarray(baked.colors.reshape(rows, columns, 3))
