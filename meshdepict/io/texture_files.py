"""Pictures that a mesh's file names: where they lie, and what is wrong with them."""

from __future__ import annotations

import os
from pathlib import Path

from meshdepict.errors import MeshdepictError
from meshdepict.files.reach import inside
from meshdepict.images.encoded import kind_of
from meshdepict.shapes.textures import Texture

__all__ = ["file_fault", "held_texture", "named_texture", "texture_notes"]


def named_texture(folder: Path, name: str, wrap: tuple[str, str]) -> Texture:
    """Return the texture that a file in a folder names; its bytes, or why they can't be had."""
    if fault := file_fault(folder, name):
        return Texture(name, None, "", wrap, fault=fault)
    try:
        data = inside(folder, name, "texture").read_bytes()
    except OSError as error:
        fault = f"names the texture {name!r}, which can't be read ({error.strerror or error})"
        return Texture(name, None, "", wrap, fault=fault)
    return held_texture(name, data, wrap)


def held_texture(name: str, data: bytes, wrap: tuple[str, str]) -> Texture:
    """Return a texture whose bytes are at hand."""
    return Texture(name, data, kind_of(data) or Path(name).suffix.lower().removeprefix("."), wrap)


def file_fault(folder: Path, name: str, what: str = "texture") -> str:
    """Say why a file that another one names can't be had, "" where it can; it isn't read."""
    try:
        path = inside(folder, name, what)
        if not path.is_file():
            return f"names the {what} {name!r}, which is not there"
        if not os.access(path, os.R_OK):
            return f"names the {what} {name!r}, which may not be read"
        if path.stat().st_size == 0:
            return f"names the {what} {name!r}, which is empty"
    except MeshdepictError as error:
        return str(error)
    except OSError as error:
        return f"names the {what} {name!r}, which can't be read ({error.strerror or error})"
    return ""


def texture_notes(faults: list[str]) -> list[str]:
    """Return the first of several faults, and how many others there are, as one clause."""
    different = list(dict.fromkeys(fault for fault in faults if fault))
    if not different:
        return []
    more = f" (and {len(different) - 1:,} more like that)" if len(different) > 1 else ""
    return [f"{different[0]}{more}: left out"]
