"""GDAL by way of rasterio, the extra ``[dem]``: imported where it is used, silent, and bounded."""

from __future__ import annotations

import logging
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import max_memory

__all__ = ["gdal", "said"]

_CACHE = 256 << 20  # bytes of blocks kept; GDAL's own default is a share of the machine's memory
_one_at_a_time = threading.RLock()  # its log is one for all threads


class _Log(logging.Handler):
    """What GDAL reports as errors without raising them: a block that a full disk didn't take."""

    def __init__(self, lines: list[str]) -> None:
        super().__init__(logging.ERROR)
        self._lines = lines

    def emit(self, record: logging.LogRecord) -> None:
        self._lines.append(record.getMessage())


@contextmanager
def gdal(what: str, errors: list[str] | None = None) -> Iterator[Any]:
    """Give the module rasterio.

    Parameters
    ----------
    what : str
        What needs it, for the sentence: "reading GeoTIFF".
    errors : list of str, optional
        Gets what GDAL says of errors and doesn't raise.

    Raises
    ------
    MeshdepictError
        Where rasterio is not installed.
    """
    try:
        rasterio: Any = _module()
    except ImportError as error:
        raise MeshdepictError(
            f"{what} needs rasterio, which is not installed: pip install 'meshdepict[dem]'"
        ) from error
    logger, handler = logging.getLogger("rasterio"), _Log([] if errors is None else errors)
    options = {
        "GDAL_CACHEMAX": min(_CACHE, max_memory() // 8),
        "GDAL_VRT_ENABLE_PYTHON": "NO",  # files are no programs
    }
    with _one_at_a_time, warnings.catch_warnings(), rasterio.Env(**options):
        warnings.simplefilter("ignore")  # of rasters without a place: this package says it itself
        propagate, logger.propagate = logger.propagate, False
        logger.addHandler(handler)
        try:
            yield rasterio
        finally:
            logger.removeHandler(handler)
            logger.propagate = propagate


def said(error: BaseException) -> str:
    """Return an error's words as the end of a sentence."""
    text = " ".join(str(error.__cause__ or error).split()) or type(error).__name__
    return text.rstrip(".")[:200]


def _module() -> Any:
    import rasterio.io
    import rasterio.shutil

    return rasterio
