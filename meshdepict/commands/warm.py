"""``meshdepict warm``: compile the kernels before they are needed."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from meshdepict.commands.parameters import Everywhere, takes_words
from meshdepict.console import progress_bar, say
from meshdepict.errors import MeshdepictError

__all__ = ["warm"]


@takes_words()
def warm(
    *,
    clear: Annotated[bool, Parameter(show_default=False)] = False,
    everywhere: Everywhere,
) -> None:
    """Compile all kernels once, so that no later command waits for it.

    They are compiled anyway when they are first needed, and kept in the folder of caches:
    NUMBA_CACHE_DIR, if that is set, or the user's.

    Parameters
    ----------
    clear
        Delete what is kept instead.
    """
    from meshdepict.files import cache
    from meshdepict.kernels.kernel import FOLDER

    everywhere.obey()
    folder = cache.cache_folder()
    if folder is None:
        raise MeshdepictError("there is no folder for caches: set NUMBA_CACHE_DIR to one")
    place = folder / FOLDER
    if clear:
        count, size = cache.clear(FOLDER)
        say(f"{place}: {_files(count)} deleted, {size / 1e6:.1f} MB")
        return
    from meshdepict.baking import warming

    with progress_bar("compiling kernels", quiet=everywhere.quiet) as progress:
        found = warming.warm(progress=progress)
    say(
        f"{place}: {found.compiled:,} compiled now; {_files(found.kept)}, {found.size / 1e6:.1f} MB"
    )


def _files(count: int) -> str:
    return "1 file" if count == 1 else f"{count:,} files"
