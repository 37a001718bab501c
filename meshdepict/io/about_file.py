"""Sentences about a file that can't be read: they begin with its name."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from meshdepict.errors import MeshdepictError

__all__ = ["about_file"]

# What clauses begin with whose subject is the file; others follow a colon.
_VERBS = (
    "is", "has", "holds", "lacks", "says", "names", "counts", "claims", "places", "resamples",
    "declares", "takes", "needs",
)  # fmt: skip


@contextmanager
def about_file(name: str | Path) -> Iterator[None]:
    """Let what is wrong with a file be one sentence that begins with its name."""
    try:
        yield
    except MeshdepictError as error:
        text = str(error)
        if text.startswith((str(name), repr(str(name)))):
            raise
        joint = " " if text.split(" ", 1)[0] in _VERBS else ": "
        raise MeshdepictError(f"{name}{joint}{text}") from error
    except PermissionError:
        raise MeshdepictError(f"{name} may not be read: permission denied") from None
    except OSError as error:
        raise MeshdepictError(f"{name} could not be read: {error.strerror or error}") from error
    except MemoryError:
        raise MeshdepictError(f"{name} takes more memory than there is") from None
