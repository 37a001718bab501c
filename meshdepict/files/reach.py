"""Which files may be opened: regular ones, and of those a file names only its neighbours."""

from __future__ import annotations

import os
import re
import stat
from pathlib import Path, PureWindowsPath

from meshdepict.errors import MeshdepictError

__all__ = ["inside", "regular"]

_KINDS = {
    stat.S_IFIFO: "a named pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}

_URL = re.compile(r"[a-z][a-z0-9+.-]*://|(?:file|data|https?|ftp):", re.IGNORECASE)

_RULE = "only files in its own folder, or in folders below it, are read"


def regular(path: str | os.PathLike[str]) -> None:
    """Refuse what is neither a file nor a folder, before it is opened: that might wait for ever.

    What doesn't exist, or may not be looked at, passes: opening it says why.

    Raises
    ------
    MeshdepictError
        For a named pipe, a device and a socket: one sentence that begins with the path.
    """
    kind = _special(path)
    if kind:
        raise MeshdepictError(
            f"{path} is {kind}, not a file: save what comes from it as a file, and give that"
        )


def inside(folder: str | os.PathLike[str], name: str, what: str) -> Path:
    """Return where the file lies that another file names: in that one's folder or below.

    Files come from strangers; they are not to choose what is read from a person's disk.

    Parameters
    ----------
    folder : path
        Of the file that names the other.
    name : str
        As written there (of a URI: decoded). Where no file has a name with backslashes, they part
        folders as on Windows.
    what : str
        What is named, for the sentence: "buffer", "material library".

    Returns
    -------
    Path
        Below `folder`; whether it exists is for the one who opens it to say.

    Raises
    ------
    MeshdepictError
        For an absolute path, a URL, ``..``, a symbolic link that leads out of the folder, a named
        pipe, a device and a socket: one clause whose subject is the naming file.
    """
    named = f"names the {what} {name!r}"
    windows = PureWindowsPath(name)  # it knows drives, and both kinds of slashes
    if _URL.match(name):
        raise MeshdepictError(f"{named}, a URL: {_RULE}")
    if windows.drive or windows.root:
        raise MeshdepictError(f"{named}, an absolute path: {_RULE}")
    if ".." in windows.parts:
        raise MeshdepictError(f"{named}, which leads out of its folder: {_RULE}")
    path = Path(folder, name)
    try:
        if "\\" in name and not path.exists():
            path = Path(folder, *windows.parts)
        real, home = Path(os.path.realpath(path)), Path(os.path.realpath(folder))
        kind = _special(path)
    except (OSError, ValueError):  # a NUL character, a name of 5,000 letters
        raise MeshdepictError(f"{named}, which no file can be called") from None
    if not name.strip() or not real.is_relative_to(home):
        leads = "a link out of its folder" if name.strip() else "which is no name"
        raise MeshdepictError(f"{named}, {leads}: {_RULE}")
    if kind:
        raise MeshdepictError(f"{named}, {kind}: {_RULE}")
    return path


def _special(path: str | os.PathLike[str]) -> str | None:
    """Return what a path is if it is neither file nor folder, None where it is one or nothing."""
    try:
        return _KINDS.get(stat.S_IFMT(os.stat(path).st_mode))
    except (OSError, ValueError):
        return None
