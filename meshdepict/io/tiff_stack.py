"""TIFF stacks: one file of many pages, or a folder of single slices in the order of their names."""

from __future__ import annotations

import os
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.itk import array_of, reason, simpleitk

__all__ = ["TIFF", "read_tiff_stack", "tiff_slices"]

TIFF = (".tif", ".tiff")


def tiff_slices(folder: Path) -> list[Path]:
    """Return a folder's TIFF files, slice 10 after slice 9."""
    found = [path for path in folder.iterdir() if path.suffix.lower() in TIFF]
    return sorted(found, key=lambda path: _natural(path.name))


def _natural(name: str) -> list[tuple[int, str]]:
    return [(int(digits or -1), text) for digits, text in re.findall(r"(\d+)|(\D+)", name.lower())]


def read_tiff_stack(path: Path) -> NDArray[Any]:
    """Return the values (nz, ny, nx): y runs down the pages, z through them.

    Raises
    ------
    MeshdepictError
        For a damaged file, colours, and pages that differ in size or type: without the path.
    """
    if path.is_file():
        return _pages(path)
    slices = tiff_slices(path)
    first = _pages(slices[0])
    stack = np.empty((len(slices), *first.shape[1:]), first.dtype)
    for at, name in enumerate(slices):
        page = _pages(name)
        if page.shape != (1, *stack.shape[1:]) or page.dtype != stack.dtype:
            raise MeshdepictError(
                f"holds slices of different size or type: {slices[0].name} "
                f"({_described(first)}) and {name.name} ({_described(page)})"
            )
        stack[at] = page[0]
    return stack


def _pages(path: Path) -> NDArray[Any]:
    _check_pages(path)
    with simpleitk() as sitk:
        try:
            image = sitk.ReadImage(str(path), imageIO="TIFFImageIO")
        except RuntimeError as error:
            raise MeshdepictError(f"is damaged: {path.name}: {reason(error)}") from error
    if image.GetDimension() == 2:
        image = sitk.JoinSeries(image)
    return array_of(image)


def _check_pages(path: Path) -> None:
    """Refuse a file whose chain of pages is broken: ITK follows it as far as it gets.

    A TIFF's header gives the place of the first page's directory; each gives that of the next one
    after its entries.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(16)
        order = {b"II": "<", b"MM": ">"}.get(head[:2], "<")
        is_big = head[2:4] in (b"+\0", b"\0+")  # version 43
        offset, count, entry = ("Q", "Q", 20) if is_big else ("I", "H", 12)
        offset, count = order + offset, order + count
        try:
            at, pages = struct.unpack_from(offset, head, 8 if is_big else 4)[0], 0
            while at and pages < size:
                file.seek(at)
                (entries,) = struct.unpack(count, file.read(struct.calcsize(count)))
                file.seek(entries * entry, os.SEEK_CUR)
                (at,) = struct.unpack(offset, file.read(struct.calcsize(offset)))
                pages += 1
        except (struct.error, OverflowError) as error:
            raise MeshdepictError(f"is cut off or damaged: {path.name}") from error


def _described(pages: NDArray[Any]) -> str:
    count, height, width = pages.shape
    return f"{width} x {height} {pages.dtype}" + (f", {count} pages" if count > 1 else "")
