"""The folder where what was computed once for all is kept: compiled kernels, measured constants.

Everything in it can be made again. So a folder that is missing, full or not ours to write is no
error, and whatever has not been used for long is thrown away.
"""

from __future__ import annotations

import os
import secrets
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

__all__ = ["cache_folder", "clear", "keep", "kept", "kept_files", "throw_away_unused"]

_UNUSED = 60 * 86400.0  # seconds after which a file that nobody read is thrown away
_DAY = 86400.0


def cache_folder() -> Path | None:
    """Return the folder: NUMBA_CACHE_DIR's or the user's cache; None where there is no home.

    It need not exist.
    """
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(chosen) / "meshdepict"
    if sys.platform == "win32":
        given, usual = os.environ.get("LOCALAPPDATA"), "AppData/Local"
    elif sys.platform == "darwin":
        given, usual = None, "Library/Caches"
    else:
        given, usual = os.environ.get("XDG_CACHE_HOME"), ".cache"
    if given and os.path.isabs(given):  # others are to be ignored, says the XDG standard
        return Path(given) / "meshdepict"
    try:
        return Path.home() / usual / "meshdepict"
    except RuntimeError:
        return None


def kept(name: str) -> bytes | None:
    """Return what a file of the folder holds; None where there is none that can be read.

    Its time of change is the last day when somebody asked for it.
    """
    folder = cache_folder()
    if folder is None:
        return None
    path = folder / name
    try:
        with path.open("rb") as file:
            data = file.read()
            changed = os.fstat(file.fileno()).st_mtime
    except OSError:
        return None
    if time.time() - changed > _DAY:
        with suppress(OSError):
            os.utime(path)
    return data


def keep(name: str, data: bytes) -> bool:
    """Write a file of the folder, whole or not at all; return whether that was possible.

    Whoever reads or writes the same file meanwhile, in another process, is not disturbed.
    """
    folder = cache_folder()
    if folder is None:
        return False
    path = folder / name
    part = path.with_name(f".{secrets.token_hex(8)}.part")
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        try:
            part.write_bytes(data)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError:
        return False
    return True


def kept_files(within: str) -> Iterator[Path]:
    """Yield the files below a folder in the folder, those of interrupted writers among them."""
    folder = cache_folder()
    if folder is not None:
        with suppress(OSError):
            yield from (path for path in sorted((folder / within).rglob("*")) if path.is_file())


def throw_away_unused(within: str) -> None:
    """Delete the files that nobody has read for two months, as those of older versions."""
    for path in kept_files(within):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > _UNUSED:
                path.unlink()


def clear(within: str) -> tuple[int, int]:
    """Delete all files below a folder in the folder; return how many, and their bytes."""
    count = size = 0
    for path in kept_files(within):
        with suppress(OSError):
            bytes_of_it = path.stat().st_size
            path.unlink()
            count, size = count + 1, size + bytes_of_it
    folder = cache_folder()
    if folder is not None:
        for path in (*sorted((folder / within).rglob("*"), reverse=True), folder / within):
            with suppress(OSError):
                path.rmdir()
    return count, size
