"""A file that leads the browser to a page: command lines are for all to see, its contents aren't.

Whoever is on the machine may list processes and their arguments. A token in the address that a
browser is started with would be known to all.
"""

from __future__ import annotations

import html
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["redirect"]

_PAGE = """<!DOCTYPE html>
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}">
<title>meshdepict</title>
<p><a href="{address}">Go to the page</a></p>
"""


@contextmanager
def redirect(address: str) -> Iterator[str]:
    """Give the URL of a file that only its owner may read and that leads to an address.

    The file is removed at the end.

    Parameters
    ----------
    address : str

    Yields
    ------
    str
        Without anything of the address in it.
    """
    handle, name = tempfile.mkstemp(prefix="meshdepict-", suffix=".html")  # of mode 600
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(_PAGE.format(address=html.escape(address)))
        yield Path(name).as_uri()
    finally:
        Path(name).unlink(missing_ok=True)
