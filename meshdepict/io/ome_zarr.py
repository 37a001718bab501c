"""OME-Zarr: volumes in chunks, with their place, as microscopy and viewers in browsers have them.

Written is NGFF 0.4 (zarr's format 2) with one level; read are 0.4 and 0.5, their finest level. NGFF
has no direction of axes: this program writes it beside, and other programs pass it over.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import as_text, max_memory
from meshdepict.io.volume_contents import VolumeContents, several_values
from meshdepict.voxels.grid import Grid
from meshdepict.voxels.length_unit import length_unit

__all__ = [
    "OME_ZARR", "is_zarr", "ome_array", "ome_zarr", "read_ome_zarr", "write_ome_zarr",
    "zarr_module",
]  # fmt: skip

OME_ZARR = ".ome.zarr"
"""How names of such folders end."""

_CHUNK = 64  # voxels along an axis
_MARK = "meshdepict"
_UNITS = {
    "nm": "nanometer", "µm": "micrometer", "mm": "millimeter", "cm": "centimeter",
    "dm": "decimeter", "m": "meter", "km": "kilometer", "in": "inch", "ft": "foot",
}  # fmt: skip
_RGBA = (("red", "FF0000"), ("green", "00FF00"), ("blue", "0000FF"), ("opacity", "FFFFFF"))


def is_zarr(path: str | os.PathLike[str]) -> bool:
    """Whether this is a folder with an array of zarr, or a group of them."""
    return any(os.path.exists(Path(path) / name) for name in (".zgroup", ".zarray", "zarr.json"))


def zarr_module() -> Any:
    """Return the module zarr.

    Raises
    ------
    MeshdepictError
        Where it is not installed.
    """
    try:
        import zarr
    except ImportError:
        raise MeshdepictError(
            "reading and writing .zarr needs zarr: pip install 'meshdepict[cluster]'"
        ) from None
    return zarr


def ome_array(path: str | os.PathLike[str]) -> tuple[Any, VolumeContents]:
    """Return the array (z, y, x) of an OME-Zarr, not read yet, and what is known of it.

    Parameters
    ----------
    path : path

    Returns
    -------
    array : zarr.Array
        With as many axes as the file has; those before z are of length 1.
    contents : VolumeContents
        Without values.

    Raises
    ------
    MeshdepictError
        For what is no OME-Zarr of a volume: a clause whose subject is the file.
    """
    zarr = zarr_module()
    try:
        group = zarr.open(Path(path), mode="r")
        attributes = dict(group.attrs)
    except Exception as error:  # zarr's versions raise errors of several kinds
        raise MeshdepictError(f"can't be read as zarr: {error}") from None
    if hasattr(group, "ndim"):
        raise MeshdepictError("is a zarr array and no OME-Zarr, which is a group with multiscales")
    try:
        told = dict(attributes.get("ome", attributes))["multiscales"][0]
        level = told["datasets"][0]
        axes = [dict(axis) for axis in told["axes"]]
        array = group[level["path"]]
        steps = [*level.get("coordinateTransformations", ())]
        steps += told.get("coordinateTransformations", ())
        scale, moved = _transformed(steps, len(axes))
    except (KeyError, IndexError, TypeError, ValueError, AttributeError):
        raise MeshdepictError("is a zarr group without the multiscales of OME-Zarr") from None
    names = [str(axis.get("name")) for axis in axes]
    if names[-3:] != ["z", "y", "x"] or array.ndim != len(axes):
        raise MeshdepictError(f"has the axes {', '.join(names)}, and a volume ends with z, y, x")
    if several := [int(n) for n in array.shape[:-3] if n > 1]:
        raise several_values(several[0])
    place: dict[str, Any] = {"spacing": scale[:-4:-1], "origin": moved[:-4:-1]}
    ours = attributes.get(_MARK, {})
    if isinstance(ours, Mapping) and "direction" in ours:
        place["direction"] = ours["direction"]
        place["origin"] = ours["origin"]
    return array, VolumeContents(
        np.empty((0, 0, 0)), place,
        hounsfield=isinstance(ours, Mapping) and bool(ours.get("hounsfield")),
        length_unit=length_unit(str(axes[-1].get("unit", ""))),
    )  # fmt: skip


def read_ome_zarr(path: Path) -> VolumeContents:
    """Read the finest level of an OME-Zarr.

    Raises
    ------
    MeshdepictError
        As `ome_array`, and for more than memory may hold.
    """
    array, contents = ome_array(path)
    needed = int(np.prod([int(n) for n in array.shape])) * array.dtype.itemsize
    if needed > max_memory():
        raise MeshdepictError(
            f"takes {as_text(needed)} of memory, and {as_text(max_memory())} are allowed: shade it "
            "block by block (bake_out_of_core), or allow more with --max-memory"
        )
    try:
        contents.values = np.asarray(array[(0,) * (array.ndim - 3)])
    except Exception as error:  # a chunk that is damaged, in any codec
        raise MeshdepictError(f"is damaged: {error}") from None
    return contents


def _transformed(steps: Sequence[Mapping[str, Any]], axes: int) -> tuple[list[float], list[float]]:
    """Return the scale and the translation that transformations, one after the other, come to."""
    scale, moved = np.ones(axes), np.zeros(axes)
    for step in steps:
        kind = step["type"]
        if kind == "scale":
            factor = np.array(step["scale"], np.float64)
            scale, moved = scale * factor, moved * factor
        elif kind == "translation":
            moved = moved + np.array(step["translation"], np.float64)
        elif kind != "identity":
            raise ValueError(kind)
    if scale.shape != (axes,) or moved.shape != (axes,):
        raise ValueError(axes)
    return scale.tolist(), moved.tolist()


@contextmanager
def ome_zarr(
    path: str | os.PathLike[str], like: Grid, kind: str, *, rgba: bool, comments: Mapping[str, str]
) -> Iterator[Any]:
    """Give an array to fill, which takes the name ``path`` only when all went well.

    Parameters
    ----------
    path : path
        Nothing may be there.
    like : Grid
        Where the voxels are.
    kind : str
        Of numbers, as NumPy names it.
    rgba : bool
        Whether the array has four channels, (4, nz, ny, nx); else it is (nz, ny, nx).
    comments : mapping of str
        How the values came about.

    Raises
    ------
    MeshdepictError
        For a path where something is, and every failure to write.
    """
    zarr, path = zarr_module(), Path(path)
    if path.exists():
        raise MeshdepictError(f"{path} exists already: a .zarr is not written over")
    if not path.parent.is_dir():  # zarr would make it
        raise MeshdepictError(f"{path} can't be written: there is no folder {path.parent}")
    part = path.with_name(f".{path.name}.part")
    channels = (4,) if rgba else ()
    shape = (*channels, *like.counts)
    try:
        shutil.rmtree(part, ignore_errors=True)
        group = zarr.open_group(part, mode="w", zarr_format=2)
        array = group.create_array(
            "0", shape=shape, dtype=kind,
            chunks=(*channels, *(min(n, _CHUNK) for n in like.counts)),
            chunk_key_encoding={"name": "v2", "separator": "/"},
        )  # fmt: skip
        group.attrs.update(_attributes(path, like, kind, rgba=rgba, comments=comments))
        yield array
        part.rename(path)
    except OSError as error:
        raise MeshdepictError(f"{path} could not be written: {error.strerror or error}") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _attributes(
    path: Path, like: Grid, kind: str, *, rgba: bool, comments: Mapping[str, str]
) -> dict[str, Any]:
    unit = _UNITS.get(str(getattr(like, "length_unit", "")))
    space = [{"name": name, "type": "space", **({"unit": unit} if unit else {})} for name in "zyx"]
    first = [1.0] if rgba else []
    scale = [*first, *(float(step) for step in like.spacing[::-1])]
    moved = [*(0.0 for _ in first), *(float(at) for at in like.origin[::-1])]
    straight = bool(np.array_equal(like.direction, np.eye(3)))
    ours: dict[str, Any] = {"provenance": dict(comments)}
    if like.hounsfield and not rgba:
        ours["hounsfield"] = True
    if not straight:
        ours |= {"direction": np.asarray(like.direction).tolist(), "origin": moved[:-4:-1]}
    levels = [
        {
            "path": "0",
            "coordinateTransformations": [
                {"type": "scale", "scale": scale}, {"type": "translation", "translation": moved},
            ],
        }
    ]  # fmt: skip
    axes = ([{"name": "c", "type": "channel"}] if rgba else []) + space
    name = path.name.removesuffix(OME_ZARR)
    told = {"version": "0.4", "name": name, "axes": axes, "datasets": levels}
    found: dict[str, Any] = {"multiscales": [told], _MARK: ours}
    if rgba:
        window = {"min": 0, "max": 255, "start": 0, "end": 255}
        found["omero"] = {
            "version": "0.4",
            "channels": [
                {"label": label, "color": color, "active": label != "opacity", "window": window}
                for label, color in _RGBA
            ],
        }
    return found


def write_ome_zarr(path: Path, values: NDArray[Any], like: Grid, comments: Sequence[str]) -> None:
    """Write scalars (nz, ny, nx) or RGBA (nz, ny, nx, 4); see `write_volume`."""
    rgba = values.ndim == 4
    facts = dict(line.removeprefix("meshdepict ").partition(": ")[::2] for line in comments)
    with ome_zarr(path, like, values.dtype.str, rgba=rgba, comments=facts) as array:
        array[...] = np.moveaxis(values, -1, 0) if rgba else values
