"""A folder of single slices as images: TIFF, BMP, PNG or JPEG, in the order of their names."""

from __future__ import annotations

import re
import warnings
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import check_claim
from meshdepict.io.tiff_pages import Scale
from meshdepict.io.tiff_stack import TIFF, tiff_slice
from meshdepict.io.volume_contents import VolumeContents

__all__ = ["IMAGES", "image_slices", "read_image_stack"]

IMAGES = (".bmp", ".png", ".jpg", ".jpeg")
"""Of slices that the older scanners' programs write; TIFF beside them."""

_MOST = 0.75  # share of a folder's images that are slices; the others, few, are previews and copies


def image_slices(folder: Path) -> list[Path]:
    """Return a folder's images of the kind that there are most of, slice 10 after slice 9."""
    groups: dict[str, list[Path]] = {}
    for path in folder.iterdir():
        suffix = path.suffix.lower()
        if suffix in (*TIFF, *IMAGES) and path.is_file() and not path.name.startswith("."):
            kind = {".tiff": ".tif", ".jpeg": ".jpg"}.get(suffix, suffix)
            groups.setdefault(kind, []).append(path)
    found = max(groups.values(), key=len, default=[])
    if ".tif" in groups and len(groups[".tif"]) > 1:  # what a program made of them is beside
        found = groups[".tif"]
    return sorted(found, key=lambda path: _natural(path.name))


def _natural(name: str) -> list[tuple[int, str]]:
    return [
        (int(digits[:4000] or -1), text)
        for digits, text in re.findall(r"(\d+)|(\D+)", name.lower())
    ]


def read_image_stack(folder: Path) -> VolumeContents:
    """Return the values (nz, ny, nx): y runs down the images, z through them.

    Raises
    ------
    MeshdepictError
        For damaged files, colours, and images that differ in size or type: without the folder.
    """
    notes: list[str] = []
    slices = _alike(image_slices(folder), notes)
    first, scale = _slice(slices[0], [])
    if len(slices) == 1 and len(first) > 1:
        place = {"spacing": scale.spacing} if scale.spacing else {}
        return VolumeContents(first, place, length_unit=scale.unit, notes=notes)
    size = sum(path.stat().st_size for path in slices)
    check_claim(first.nbytes * len(slices), size, "pixels")
    stack = np.empty((len(slices), *first.shape[1:]), first.dtype)
    found: list[str] = []
    for at, name in enumerate(slices):
        page, _ = _slice(name, found)
        if page.shape != (1, *stack.shape[1:]) or page.dtype != stack.dtype:
            raise MeshdepictError(
                f"holds slices of different size or type: {slices[0].name} "
                f"({_described(first)}) and {name.name} ({_described(page)})"
            )
        stack[at] = page[0]
    notes += found[:1]
    place = {"spacing": scale.spacing} if scale.spacing else {}
    return VolumeContents(stack, place, length_unit=scale.unit, notes=notes)


def _alike(paths: list[Path], notes: list[str]) -> list[Path]:
    """Leave out the few images whose names aren't like the others', and say what numbers lack."""
    patterns = Counter(re.sub(r"\d+", "#", path.name.lower()) for path in paths)
    pattern, count = patterns.most_common(1)[0]
    kept = paths
    if count < len(paths) and count >= max(2, _MOST * len(paths)):
        kept = [path for path in paths if re.sub(r"\d+", "#", path.name.lower()) == pattern]
        others = [path.name for path in paths if path not in kept]
        notes.append(
            f"images with other names are left out: {len(others):,}, the first {others[0]}"
        )
    gap = _gap(kept)
    if gap:
        notes.append(f"slices may be missing between {gap[0].name} and {gap[1].name}")
    return kept


def _gap(paths: list[Path]) -> tuple[Path, Path] | None:
    """Return the first neighbours whose numbers are further apart than the others'."""
    numbers = [re.findall(r"\d+", path.stem) for path in paths]
    if len(paths) < 3 or not all(numbers) or len({len(found) for found in numbers}) > 1:
        return None
    steps = [int(b[-1][:18]) - int(a[-1][:18]) for a, b in pairwise(numbers)]
    usual = min(steps)
    if usual <= 0:
        return None
    wider = [at for at, step in enumerate(steps) if step > usual]
    return (paths[wider[0]], paths[wider[0] + 1]) if wider else None


def _slice(path: Path, notes: list[str]) -> tuple[NDArray[Any], Scale]:
    """Return the grey values (1, ny, nx) of an image, or all pages of a TIFF."""
    if path.suffix.lower() in TIFF:
        return tiff_slice(path, notes)
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(path) as image:
                width, height = image.size
                check_claim(4 * width * height, path.stat().st_size, "pixels")
                return _grey(image, path)[None], Scale()
    except MeshdepictError:
        raise
    except Image.DecompressionBombError:
        raise MeshdepictError(
            f"holds an image of too many pixels, {path.name}: save the slices as TIFF"
        ) from None
    except Exception as error:
        text = str(error).replace(str(path), path.name)
        raise MeshdepictError(f"holds a damaged image, {path.name}: {text}") from error


def _grey(image: Any, path: Path) -> NDArray[Any]:
    """Return an image's numbers, of colours that are all grey one channel."""
    if getattr(image, "n_frames", 1) > 1:
        raise MeshdepictError(f"holds an image of several frames, {path.name}")
    if image.mode in ("1", "L", "I", "F", "I;16", "I;16B", "I;16L"):
        array = np.array(image)
        return array.astype(np.uint8) * 255 if array.dtype == bool else array
    channels = np.array(image.convert("RGB"))
    red, green, blue = np.moveaxis(channels, -1, 0)
    if not (np.array_equal(red, green) and np.array_equal(red, blue)):
        raise MeshdepictError(
            f"holds colours, not grey slices: {path.name}; save it as grey values"
        )
    return np.ascontiguousarray(red)


def _described(pages: NDArray[Any]) -> str:
    count, height, width = pages.shape
    return f"{width} x {height} {pages.dtype}" + (f", {count} pages" if count > 1 else "")
