"""Opening pictures and arrays that may be anything: what is wrong with them is one exception."""

from __future__ import annotations

import os
import struct
import tokenize
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.files.limits import check_claim
from meshdepict.files.reach import regular

__all__ = ["ODD", "is_picture", "mapped_array", "opened_picture"]

# What the readers of pictures and of arrays raise where a file isn't what they think it is.
ODD = (
    ArithmeticError, AttributeError, EOFError, LookupError, MemoryError, NotImplementedError,
    RecursionError, SyntaxError, TypeError, struct.error, tokenize.TokenError,
)  # fmt: skip
_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".npy")
_DEEP = 16  # bytes of a pixel in four channels of floats


def is_picture(name: str) -> bool:
    """Whether this is what a file of a picture, or of an array, would be called."""
    return name.lower().endswith(_SUFFIXES)


@contextmanager
def opened_picture(path: str | os.PathLike[str]) -> Iterator[Any]:
    """Open a picture as a ``PIL.Image``, none of whose pixels has been read yet.

    Raises
    ------
    MeshdepictError
        For what is no file, and for a size that the file can't hold.
    OSError, ValueError
        For whatever is wrong with the file, here or in the body.
    """
    from PIL import Image

    regular(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Pillow's, of odd metadata and of more than 89 megapixels
        try:
            with Image.open(path) as image:
                width, height = image.size
                check_claim(_DEEP * width * height, os.path.getsize(path), "pixels")
                yield image
        except (*ODD, Image.DecompressionBombError) as error:
            raise ValueError(str(error) or type(error).__name__) from error


def mapped_array(path: str | os.PathLike[str]) -> NDArray[Any]:
    """Return an array saved as .npy, mapped into memory and read-only.

    Raises
    ------
    MeshdepictError
        For what is no file.
    OSError, ValueError
        For whatever is wrong with it.
    """
    regular(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # NumPy's, of files from Python 2
        try:
            found = np.load(Path(path), mmap_mode="r", allow_pickle=False)
        except ODD as error:
            raise ValueError("its header can't be read") from error
    if not isinstance(found, np.ndarray):
        found.close()
        raise ValueError("an archive of several arrays (.npz), not one")
    return found
