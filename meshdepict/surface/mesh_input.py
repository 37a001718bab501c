"""What a mesh is made of, checked once at the door: vertices, corner indices, attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import real_array
from meshdepict.scene.vectors import frozen
from meshdepict.surface.polygons import Polygons

__all__ = [
    "as_vertices", "check_indices", "checked_attributes", "checked_groups", "is_drawable",
    "place_strays",
]  # fmt: skip

Floats = NDArray[np.float64]

# Beyond it sums and differences of coordinates, and areas, would overflow; within the inverse of it
# areas would vanish, and curvatures overflow.
_LARGEST = 1e150


def as_vertices(vertices: ArrayLike) -> Floats:
    """Return positions as a new (n, 3) array.

    Raises
    ------
    MeshdepictError
        For another shape, other things than numbers, and none at all.
    """
    array = real_array(vertices)
    if array is None:
        raise MeshdepictError("vertices must be an (n, 3) array of numbers")
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshdepictError(f"vertices must have shape (n, 3), not {array.shape}")
    if len(array) == 0:
        raise MeshdepictError("the mesh is empty: it has no vertices")
    return array


def is_drawable(vertices: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether each of (n, 3) positions is finite, and not so far away that squares overflow."""
    with np.errstate(invalid="ignore"):
        drawable: NDArray[np.bool_] = (np.abs(vertices) <= _LARGEST).all(axis=1)
    return drawable


def place_strays(vertices: Floats, used: NDArray[np.bool_]) -> int:
    """Put vertices that no face uses and that can't be drawn amid the others, in place.

    Returns
    -------
    int
        How many there were.

    Raises
    ------
    MeshdepictError
        Where faces use such vertices, and where all those in use lie too close together.
    """
    drawable = is_drawable(vertices)
    if not (drawable | ~used).all():
        odd = used & ~np.isfinite(vertices).all(axis=1)
        if not odd.any():
            raise MeshdepictError(
                f"vertices beyond {_LARGEST:g} leave no room for computing; rescale the mesh"
            )
        first = int(np.argmax(odd))
        raise MeshdepictError(
            f"{int(odd.sum()):,} of {len(vertices):,} vertices are NaN or infinite "
            f"(the first is vertex {first}: {', '.join(f'{x:g}' for x in vertices[first])}); "
            "remove or repair them first"
        )
    low, high = vertices[used].min(axis=0), vertices[used].max(axis=0)
    if 0 < (high - low).max() < 1 / _LARGEST:
        raise MeshdepictError(
            f"all vertices lie within {1 / _LARGEST:g} of each other, which leaves no room for "
            "computing; rescale the mesh"
        )
    vertices[~drawable] = low / 2 + high / 2
    return int(np.count_nonzero(~drawable))


def check_indices(polygons: Polygons, count: int) -> None:
    """Raise `MeshdepictError` where a polygon has a corner outside 0 … count − 1."""
    corners = polygons.connectivity
    bad = (corners < 0) | (corners >= count)
    if bad.any():
        first = int(np.argmax(bad))
        face = int(np.searchsorted(polygons.offsets, first, side="right")) - 1
        raise MeshdepictError(
            f"face {face} refers to vertex {int(corners[first])}, but the mesh has {count:,} "
            f"vertices, numbered from 0 ({int(bad.sum()):,} such corners)"
        )


def checked_attributes(
    given: Mapping[str, Mapping[str, Any]], **counts: int
) -> dict[str, dict[str, NDArray[Any]]]:
    """Return attributes as new read-only arrays.

    Parameters
    ----------
    given : {element: {name: array_like}}
    **counts : int
        How many rows the arrays of each element have to have.

    Raises
    ------
    MeshdepictError
        For another element or another number of rows.
    """
    if not isinstance(given, Mapping) or not all(isinstance(a, Mapping) for a in given.values()):
        raise MeshdepictError("attributes are given as {element: {name: values}}")
    unknown = set(given) - set(counts)
    if unknown:
        raise MeshdepictError(
            f"attributes belong to {' or '.join(map(repr, counts))}, not {unknown.pop()!r}"
        )
    checked: dict[str, dict[str, NDArray[Any]]] = {element: {} for element in counts}
    for element, arrays in given.items():
        for name, values in arrays.items():
            array = np.array(values)
            if array.shape[:1] != (counts[element],):
                raise MeshdepictError(
                    f"{element} attribute {name!r} has shape {array.shape}, expected "
                    f"{counts[element]:,} rows"
                )
            checked[element][name] = frozen(array)
    return checked


def checked_groups(given: object, count: int) -> NDArray[np.int64]:
    """Return a group for each of so many vertices, as a new read-only array.

    Raises
    ------
    MeshdepictError
        For anything but whole numbers from 0 that leave none out, one for each vertex.
    """
    try:
        array = np.array(given)
    except ValueError:  # NumPy refuses rows of different lengths
        array = np.empty(0)
    proper = array.shape == (count,) and array.dtype.kind in "iu" and array.min() >= 0
    if not proper or array.max() >= count or not np.bincount(array).all():
        raise MeshdepictError(
            f"groups must be {count:,} whole numbers from 0 without gaps, one for each vertex"
        )
    return frozen(array.astype(np.int64))
