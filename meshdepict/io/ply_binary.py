"""The rows of one element of a binary PLY file, as columns and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.io.ply_header import Element, Property
from meshdepict.io.ply_rows import Column, Ragged, as_ragged, cut_off, layout_of, walk

__all__ = ["decode_binary", "encode_binary"]


def decode_binary(
    data: bytes, start: int, element: Element, order: str
) -> tuple[dict[str, Column], int]:
    """Read an element's rows from binary data.

    Returns
    -------
    columns : {property: Column}
        Where all lists are as long as in the first row, views of ``data``.
    stop : int
        Where the next element starts.

    Raises
    ------
    MeshdepictError
        Where the data end too early.
    """
    if not element.properties:
        return {}, start
    shortest = sum(_width(item.count or item.kind) for item in element.properties)
    if element.count * shortest > len(data) - start:
        raise cut_off(element, len(data) - start)

    def reader(item: Property) -> Callable[[int], int]:
        if item.count == "u1":
            return data.__getitem__
        width, signed = _width(item.count), str(item.count).startswith("i")
        end = "big" if order == ">" else "little"
        return lambda at: int.from_bytes(data[at : at + width], end, signed=signed)  # type: ignore[arg-type]

    first = walk(element, min(element.count, 1), start, len(data), _width, reader)
    sizes = {name: int(lengths.sum()) for name, lengths in first.items()}
    row = _row_type(element.properties, order, sizes)
    stop = start + element.count * row.itemsize
    if stop <= len(data):
        records = np.frombuffer(data, row, element.count, start)
        if all((records[_count(name)] == size).all() for name, size in sizes.items()):
            return {name: records[name] for name in element.names}, stop
    lengths = walk(element, element.count, start, len(data), _width, reader)
    layout = layout_of(element, lengths, start, _width)
    return layout.gathered(element, lambda kind: _anywhere(data, order + kind)), layout.stop


def encode_binary(element: Element, columns: Mapping[str, Column], order: str) -> NDArray[np.uint8]:
    """Return an element's rows as the file's bytes."""
    lists = [item.name for item in element.properties if item.count]
    if not any(isinstance(columns[name], Ragged) for name in lists):
        sizes = {name: np.shape(columns[name])[1] for name in lists}
        records = np.empty(element.count, _row_type(element.properties, order, sizes))
        for item in element.properties:
            records[item.name] = columns[item.name]
            if item.count:
                records[_count(item.name)] = sizes[item.name]
        return records.view(np.uint8) if records.size else np.empty(0, np.uint8)
    ragged = {name: as_ragged(columns[name]) for name in lists}
    lengths = {name: np.diff(column.offsets) for name, column in ragged.items()}
    layout = layout_of(element, lengths, 0, _width)
    data = np.empty(layout.stop, np.uint8)
    for item in element.properties:
        place = layout.places[item.name]
        if item.count:
            _anywhere(data, order + item.count)[place] = lengths[item.name]
            _anywhere(data, order + item.kind)[layout.items[item.name]] = ragged[item.name].values
        else:
            _anywhere(data, order + item.kind)[place] = columns[item.name]
    return data


def _width(kind: str | None) -> int:
    return np.dtype(kind).itemsize


def _count(name: str) -> str:
    return f"{name}\n"  # the field of a list's length: no property can be called so


def _row_type(
    properties: Sequence[Property], order: str, sizes: Mapping[str, int]
) -> np.dtype[Any]:
    fields: list[Any] = []
    for item in properties:
        if item.count:
            fields.append((_count(item.name), order + item.count))
            fields.append((item.name, order + item.kind, (sizes[item.name],)))
        else:
            fields.append((item.name, order + item.kind))
    return np.dtype(fields)


def _anywhere(data: Any, kind: str) -> NDArray[Any]:
    """View bytes as values of a type, one starting at every byte."""
    fitting = max(len(data) - _width(kind) + 1, 0)
    return np.ndarray((fitting,), kind, data, strides=(1,))
