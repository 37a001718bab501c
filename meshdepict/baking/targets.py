"""Files that are to be written: whether that is possible, and whether one may be replaced."""

from __future__ import annotations

import os
from collections.abc import Container, Hashable, Iterable
from os.path import exists, isdir, isfile, realpath  # unlike Path's, these never raise
from pathlib import Path

from meshdepict.drawing.picture_files import PICTURES, read_picture_provenance
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_provenance

__all__ = ["check_target", "identities", "identity"]

# How files without provenance of their own begin, or what their beginning holds, if ours.
_MARKS = {
    ".csv": b"method,mean,",
    ".html": b'<meta name="generator" content="meshdepict',
    ".toml": b"# meshdepict recipe",
    ".vti": b'Name="meshdepict"',
    ".nrrd": b"meshdepict_provenance",
    ".mha": b"meshdepict_provenance",
}

_BEGINNING = 4096  # bytes of a file where its mark is looked for


def identity(path: str | os.PathLike[str]) -> Hashable:
    """Return what is the same for all names of a file: symbolic and hard links are names, too."""
    try:
        found = os.stat(path)
    except (OSError, ValueError):
        return realpath(path)
    return found.st_dev, found.st_ino


def identities(paths: Iterable[Path | None]) -> frozenset[Hashable]:
    """Return the identities of files that are read, for `check_target`."""
    return frozenset(identity(path) for path in paths if path is not None)


def check_target(path: Path, *, force: bool, inputs: Container[Hashable] = ()) -> None:
    """Refuse to replace what others wrote, and to write where that is impossible.

    Parameters
    ----------
    path : Path
    force : bool
        Replace whatever is there.
    inputs : container
        Identities of files that are read.

    Raises
    ------
    MeshdepictError
        With what to do about it.
    """
    if isdir(path):
        raise MeshdepictError(f"{path} is a folder: name a file in it")
    if not isdir(path.parent):
        raise MeshdepictError(f"{path} can't be written: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise MeshdepictError(f"{path} can't be written: {path.parent} may not be written to")
    if force or not exists(path):
        return
    if identity(path) in inputs:
        raise MeshdepictError(
            f"{path} is an input: choose another name, or replace it with --force"
        )
    if not _is_ours(path):
        raise MeshdepictError(
            f"{path} exists and was not written by meshdepict: choose another name, or replace "
            "it with --force"
        )


def _is_ours(path: Path) -> bool:
    """Whether this program wrote an existing file: its provenance says so."""
    if not isfile(path):  # a pipe or a device: looking into it might wait for ever
        return False
    kind = path.suffix.lower()
    if kind in PICTURES:
        return read_picture_provenance(path) is not None
    if kind in (".mp4", ".gif"):
        from meshdepict.drawing.encoding import read_movie_provenance

        return read_movie_provenance(path) is not None
    if kind in _MARKS:
        try:
            with path.open("rb") as stream:
                return _MARKS[kind] in stream.read(_BEGINNING)
        except OSError:
            return False
    try:
        return read_provenance(path) is not None
    except MeshdepictError:  # an empty file, for instance
        return False
