"""Files that are either wholly written or left as they were."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from meshdepict.errors import MeshdepictError

__all__ = ["atomic_write"]

_REASONS = {
    errno.EACCES: "may not be written: permission denied",
    errno.EPERM: "may not be written: permission denied",
    errno.EROFS: "may not be written: the disk is read-only",
    errno.ENOENT: "can't be written: there is no such folder",
    errno.ENOTDIR: "can't be written: a part of its path is a file, not a folder",
    errno.EISDIR: "is a folder; give the name of a file in it",
    errno.ENOSPC: "could not be written: no space is left on the disk",
    errno.EDQUOT: "could not be written: no space is left in your disk quota",
    errno.ENAMETOOLONG: "can't be written: its name is too long",
}


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Give a file to write to, which takes the name ``path`` only when all went well.

    The data go to a temporary file in the same folder. Any exception, Ctrl-C and a full disk among
    them, removes it and leaves an earlier file whole. A replaced file's permissions are kept, and
    where ``path`` is a symbolic link its target is replaced. What is no regular file (a device, a
    pipe) is written directly.

    Parameters
    ----------
    path : str or path-like

    Yields
    ------
    binary file
        Its ``name`` is the temporary file's path.

    Raises
    ------
    MeshdepictError
        For every operating-system error, raised here or in the body: one sentence.
    """
    target = Path(os.path.realpath(path))
    try:
        mode = _mode_of(target)
        if mode is not None and not stat.S_ISREG(mode):
            with target.open("wb") as file:
                yield file
            return
        name = f".{target.name[:100]}.{secrets.token_hex(4)}.part"
        with (target.parent / name).open("xb", buffering=1 << 20) as file:
            temporary = Path(file.name)
            try:
                if mode is not None:
                    shutil.copymode(target, temporary)
                yield file
                file.close()  # a full disk may show only here
                temporary.replace(target)
            except BaseException:
                with suppress(OSError):  # flushing what is deleted anyway
                    file.close()
                temporary.unlink(missing_ok=True)
                raise
    except OSError as error:
        reason = _REASONS.get(error.errno or 0, f"could not be written: {error.strerror or error}")
        raise MeshdepictError(f"{path} {reason}") from error


def _mode_of(target: Path) -> int | None:
    """Return the mode of an existing file that may be written, None where there is none."""
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not os.access(target, os.W_OK):  # renaming over it would succeed: its owner said no
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    return mode
