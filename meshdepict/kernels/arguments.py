"""Arguments of kernels: their types as keys, and as the numbers that numba's functions take.

An array is handed over as its struct, field by field (the owner and the parent, which stay empty,
number and size of the elements, the place of the first, lengths and strides), a tuple as what is in
it, a type as an empty pointer. Whatever else a function of numba's may take is `Unsupported`.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["NUMBA", "Key", "Unsupported", "flattened", "key_of", "types_of"]

Key = tuple[Any, ...]

NUMBA = "numba"
"""What is kept in place of machine code that can't stand alone: numba runs it."""


class Unsupported(Exception):  # noqa: N818  # never seen outside: numba takes over
    """Kept machine code can't be called that way."""


_SCALARS: dict[str, Any] = {
    "bool": ctypes.c_uint8,
    "int8": ctypes.c_int8, "uint8": ctypes.c_uint8,
    "int16": ctypes.c_int16, "uint16": ctypes.c_uint16,
    "int32": ctypes.c_int32, "uint32": ctypes.c_uint32,
    "int64": ctypes.c_int64, "uint64": ctypes.c_uint64,
    "float32": ctypes.c_float, "float64": ctypes.c_double,
}  # fmt: skip
_PYTHON = {bool: "bool", int: "int64", float: "float64"}
_ELEMENTS = {*_SCALARS, "complex64", "complex128"}
_seen: dict[Any, Key] = {}  # of arrays, by what tells them apart at once
_LAYOUTS = {(True, True): "C", (True, False): "C", (False, True): "F", (False, False): "A"}


def key_of(value: Any) -> Key:
    """Return the type of an argument as numba sees it, to be hashed and written down."""
    kind = type(value)
    if kind is np.ndarray:
        mark = value.dtype, value.ndim, value.flags.num
        key = _seen.get(mark)
        if key is None:
            key = _seen[mark] = _array_key(value)
        return key
    if name := _PYTHON.get(kind):
        if kind is int and not -(2**63) <= value < 2**63:
            raise Unsupported
        return (name,)
    if issubclass(kind, np.generic) and kind.__name__.rstrip("_") in _SCALARS:
        return (value.dtype.name,)
    if kind is tuple:
        return ("tuple", *map(key_of, value))
    if kind is type and issubclass(value, np.generic):
        return ("type", value.__name__)
    raise Unsupported


def _array_key(value: NDArray[Any]) -> Key:
    flags = value.flags
    if value.dtype.name not in _ELEMENTS or not value.dtype.isnative or not flags.aligned:
        raise Unsupported
    layout = _LAYOUTS[flags.c_contiguous, flags.f_contiguous]
    return ("array", value.dtype.name, value.ndim, layout, flags.writeable)


def types_of(key: Key) -> Iterator[Any]:
    """Yield the C types of an argument's parts."""
    kind, *rest = key
    if kind == "array":
        dimensions = rest[1]
        yield from (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64)
        yield ctypes.c_void_p
        yield from (ctypes.c_int64,) * (2 * dimensions)
    elif kind == "tuple":
        for part in rest:
            yield from types_of(part)
    elif kind == "type":
        yield ctypes.c_void_p
    else:
        yield _SCALARS[kind]


def flattened(values: tuple[Any, ...]) -> list[Any]:
    """Return the parts of arguments whose keys are known."""
    flat: list[Any] = []
    for value in values:
        if type(value) is np.ndarray:
            flat += (None, None, value.size, value.itemsize, value.ctypes.data)
            flat += value.shape
            flat += value.strides
        elif type(value) is tuple:
            flat += flattened(value)
        elif type(value) is type:
            flat.append(None)
        else:
            flat.append(value.item() if isinstance(value, np.generic) else value)
    return flat
