"""Files that are saved beside a mesh: materials and pictures that it names."""

from __future__ import annotations

import filecmp
import os
import shutil
from contextlib import suppress
from pathlib import Path

from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.reach import inside

__all__ = ["Companions"]

_BEGINNING = 4096  # bytes of a file in which its mark stands


class Companions:
    """What a mesh's file names, on its way to the folder that the mesh is saved in.

    Parameters
    ----------
    path : Path
        Of the mesh that is saved. Beside a device nothing is written.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        target = Path(os.path.realpath(path))
        self._folder = target.parent
        self._off = target.exists() and not target.is_file()
        self._waiting: dict[Path, Path | bytes] = {}  # where to, and what from
        self._called: dict[Path, str] = {}

    def copied(self, folder: Path, name: str) -> str:
        """Let a file that another one names come along; return what it is called from now on.

        Its name, unless another file has that already. What can't be had stays as it is named.

        Parameters
        ----------
        folder : Path
            Of the file that names it.
        name : str
        """
        try:
            source = inside(folder, name, "file")
            there = source.is_file()
        except (MeshdepictError, OSError):
            return name
        if self._off or not there:
            return name
        real = Path(os.path.realpath(source))
        if real not in self._called:
            self._called[real] = self._placed(name, source)
        return self._called[real]

    def written(self, name: str, content: bytes, *, mark: bytes = b"") -> str:
        """Let a new file be written beside the mesh; return what it is called.

        Parameters
        ----------
        name : str
        content : bytes
        mark : bytes
            What begins a file that may be replaced: this program wrote it.
        """
        return name if self._off else self._placed(name, content, mark)

    def _placed(self, name: str, content: Path | bytes, mark: bytes = b"") -> str:
        for number in range(1, 10_000):
            tried = Path(name)
            if number > 1:
                tried = tried.with_stem(f"{tried.stem}-{number}")
            try:
                target = inside(self._folder, str(tried), "file")
            except MeshdepictError:  # a folder there that leads elsewhere
                name = Path(name.replace("\\", "/")).name
                continue
            other = self._waiting.get(target)
            if other is None and (not target.exists() or _is_marked(target, mark)):
                self._waiting[target] = content
                return tried.as_posix()
            if _alike(target if other is None else other, content):
                return tried.as_posix()
        raise MeshdepictError(f"{self._folder} has too many files called {name}")

    def write(self) -> None:
        """Write what is waiting, each file wholly or not at all; after a failure none stays."""
        made: list[Path] = []
        try:
            for target, content in self._waiting.items():
                fresh = not target.exists()
                target.parent.mkdir(parents=True, exist_ok=True)
                with atomic_write(target) as file:
                    if isinstance(content, bytes):
                        file.write(content)
                    else:
                        with content.open("rb") as source:
                            shutil.copyfileobj(source, file, 1 << 20)
                if fresh:
                    made.append(target)
        except BaseException as error:
            for target in made:
                with suppress(OSError):
                    target.unlink()
            if isinstance(error, OSError):
                raise MeshdepictError(
                    f"{target} could not be written: {error.strerror or error}"
                ) from error
            raise


def _is_marked(path: Path, mark: bytes) -> bool:
    """Whether a mark is at the beginning of a file."""
    if not mark or not path.is_file():
        return False
    try:
        with path.open("rb") as file:
            return mark in file.read(_BEGINNING)
    except OSError:
        return False


def _alike(one: Path | bytes, other: Path | bytes) -> bool:
    """Whether two files, or what is to be written into them, are the same."""
    try:
        if isinstance(one, Path) and isinstance(other, Path):
            return os.path.samefile(one, other) or filecmp.cmp(one, other, shallow=False)
        contents = [each.read_bytes() if isinstance(each, Path) else each for each in (one, other)]
    except OSError:
        return False
    return contents[0] == contents[1]
