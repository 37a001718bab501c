"""TIFF stacks: one file of many pages, or a folder of single slices in the order of their names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.library_noise import library_noise
from meshdepict.files.limits import check_claim
from meshdepict.io.itk import array_of, reason, simpleitk
from meshdepict.io.tiff_pages import Page, Scale, scale_of, tiff_pages
from meshdepict.io.volume_contents import VolumeContents, check_amount, several_values

__all__ = ["TIFF", "read_tiff", "tiff_slice"]

TIFF = (".tif", ".tiff")

_PALETTE = 3


def read_tiff(path: Path) -> VolumeContents:
    """Return the values (nz, ny, nx): y runs down the pages, z through them.

    ImageJ's and OME's spacings are believed.

    Raises
    ------
    MeshdepictError
        For a damaged file, colours, and pages that differ in size or type: without the path.
    """
    notes: list[str] = []
    values, scale = _pages(path, notes)
    return VolumeContents(
        values,
        {"spacing": scale.spacing} if scale.spacing else {},
        length_unit=scale.unit,
        notes=notes,
    )


def tiff_slice(path: Path, notes: list[str]) -> tuple[NDArray[Any], Scale]:
    """Return the pages of one of a folder's files, and its scale."""
    return _pages(path, notes)


def _pages(path: Path, notes: list[str]) -> tuple[NDArray[Any], Scale]:
    pages = tiff_pages(path)
    first, scale = pages[0], scale_of(pages[0])
    if scale.several:
        raise MeshdepictError(
            f"holds several {scale.several}: save one of them as a stack of its own"
        )
    samples = first.get("samples", 1)
    if samples != 1 or first.get("photometric", 1) == 2:
        raise several_values(max(samples, 3))
    if first.get("photometric", 1) == 0:
        raise MeshdepictError(f"counts white as zero: {path.name}; save it with black as zero")
    if not first.kind:
        raise MeshdepictError(
            f"has {first.get('bits', 1)} bits in a pixel: {path.name}; save it with 8, 16 or 32"
        )
    for number, page in enumerate(pages, 1):
        if page.alike != first.alike:
            raise MeshdepictError(
                f"holds pages of different size or type: page 1 ({described(first)}) and page "
                f"{number} ({described(page)})"
            )
    if all(page.get("compression", 1) == 1 and "tile" not in page.entries for page in pages):
        return _plain(path, pages, scale, notes), scale
    if first.get("photometric", 1) == _PALETTE:
        raise MeshdepictError(
            f"holds numbers of colours, compressed: {path.name}; save it as grey values"
        )
    return _unpacked(path, pages, notes), scale


def _plain(path: Path, pages: list[Page], scale: Scale, notes: list[str]) -> NDArray[Any]:
    """Return what lies in the file as it is."""
    first, size = pages[0], path.stat().st_size
    kind = np.dtype(first.kind).newbyteorder(first.order)  # type: ignore[arg-type]
    rows, columns = first.shape
    slice_ = rows * columns * kind.itemsize
    if len(pages) == 1 and scale.slices > 1:  # ImageJ's way round TIFF's 4 GB
        start = first.get("offsets", 0)
        if not start:
            raise MeshdepictError(f"is damaged: {path.name} doesn't say where its pixels are")
        there = min(max(size - start, 0), scale.slices * slice_)  # its directory is behind them
        check_amount((columns, rows, scale.slices), kind.itemsize, there, [])
        return np.fromfile(path, kind, scale.slices * rows * columns, offset=start).reshape(
            scale.slices, rows, columns
        )
    if scale.slices > 1 and scale.slices != len(pages):
        notes.append(f"its first page says {scale.slices:,} slices, and {len(pages):,} are there")
    if slice_ * len(pages) > size:
        raise MeshdepictError(
            f"is cut off or damaged: {path.name}, its pages claim more pixels than the file holds"
        )
    check_claim(slice_ * len(pages), size, "pixels")
    stack = np.empty((len(pages), rows, columns), np.dtype(first.kind))
    with path.open("rb") as file:
        for at, page in enumerate(pages):
            data = bytearray()
            offsets, lengths = (page.entries.get(name, []) for name in ("offsets", "lengths"))
            if len(offsets) == 1 and not lengths:
                lengths = [slice_]
            for offset, length in zip(offsets, lengths, strict=False):
                file.seek(offset)
                data += file.read(min(length, slice_ - len(data)))
            if len(data) < slice_:
                raise MeshdepictError(f"is cut off or damaged: {path.name}, page {at + 1}")
            stack[at] = np.frombuffer(data, kind).reshape(rows, columns)
    return stack


def _unpacked(path: Path, pages: list[Page], notes: list[str]) -> NDArray[Any]:
    """Let ITK unpack compressed and tiled pages."""
    first, size = pages[0], path.stat().st_size
    rows, columns = first.shape
    needed = len(pages) * rows * columns * np.dtype(first.kind).itemsize
    check_claim(needed, size, "pixels")
    noise: list[str] = []
    with simpleitk([]) as sitk:
        try:
            with library_noise(noise):
                image = sitk.ReadImage(str(path), imageIO="TIFFImageIO")
        except RuntimeError as error:
            why = noise[0] if noise else reason(error)
            raise MeshdepictError(f"is damaged: {path.name}: {why}") from error
        if noise:
            notes.append(f"unpacking {path.name} met damage: {noise[0]}")
        if image.GetDimension() == 2:
            image = sitk.JoinSeries(image)
    values = array_of(image)
    if values.shape != (len(pages), rows, columns) or values.dtype != first.kind:
        raise MeshdepictError(
            f"is damaged: {path.name}, its pages unpack to another size than they claim"
        )
    return values


def described(page: Page) -> str:
    """Return a page's size and type."""
    rows, columns = page.shape
    return f"{columns} x {rows} {np.dtype(page.kind or 'u1')}"
