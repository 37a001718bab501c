"""Volumes bigger than memory: the same shading block by block, from and to zarr or mapped files.

Blocks overlap by what a normal reaches, and Gaussians are those of the whole grid, so that the
numbers are those of `bake_volume`. The reach is 8 times the widest width at the default tolerance:
few, large blocks save work.
"""

from __future__ import annotations

import math
import os
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.baking.choices import Choices, takes_choices
from meshdepict.baking.voxel_shading import BESIDE, VoxelShading, voxel_shading
from meshdepict.errors import MeshdepictError
from meshdepict.files.pictures import mapped_array
from meshdepict.files.reach import regular
from meshdepict.io.about_file import about_file
from meshdepict.io.ome_zarr import OME_ZARR, ome_array, ome_zarr, zarr_module
from meshdepict.shapes.place import Place
from meshdepict.voxels.grid import Triple
from meshdepict.voxels.grid_normals import in_voxels
from meshdepict.voxels.grid_sums import Piece, halo

if TYPE_CHECKING:
    pass

__all__ = ["bake_lazily", "bake_out_of_core", "lazy_rgba", "settled_lazily"]

_BLOCK = 1 << 24  # voxels of a block that is chosen here


@takes_choices
def bake_lazily(
    source: Any,
    method: str = "exaggerated",
    *,
    spacing: ArrayLike | None = None,
    origin: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    hounsfield: bool | None = None,
    value_range: tuple[float, float] | None = None,
    chunks: Triple | None = None,
    **chosen: Any,
) -> Any:
    """Return the RGBA (nz, ny, nx, 4) of a volume as a dask.array, shaded where it is asked for.

    Parameters
    ----------
    source, spacing, origin, direction, hounsfield, value_range, chunks, **chosen
        As for `bake_out_of_core`.

    Returns
    -------
    dask.array.Array of uint8

    Raises
    ------
    MeshdepictError
        As `bake_out_of_core`.
    """
    told = {
        "spacing": spacing, "origin": origin, "direction": direction, "hounsfield": hounsfield,
    }  # fmt: skip
    values, shading = _shading(source, Choices(method, **chosen), told, value_range)
    return lazy_rgba(values, shading, chunks=chunks)


@takes_choices
def bake_out_of_core(
    source: Any,
    out: str | Path,
    method: str = "exaggerated",
    *,
    spacing: ArrayLike | None = None,
    origin: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    hounsfield: bool | None = None,
    value_range: tuple[float, float] | None = None,
    chunks: Triple | None = None,
    **chosen: Any,
) -> dict[str, str]:
    """Shade a volume that need not fit into memory, and write RGBA as uint8 (nz, ny, nx, 4).

    Blocks go one by one, on all cores each, unless a Dask client or scheduler is active.

    Parameters
    ----------
    source : path, zarr.Array, dask.array.Array or numpy.ndarray
        Values (nz, ny, nx); paths end in .ome.zarr, .zarr or .npy.
    out : path
        .ome.zarr, .zarr, or .npy, which is mapped into memory and replaces a file once it is
        complete.
    spacing, origin, direction, hounsfield
        As for `Volume`; of an .ome.zarr as it says unless given.
    value_range : (low, high), optional
        Of the values; looked for, block by block, unless given.
    chunks : (z, y, x), optional
        Voxels of a block.
    **chosen
        As for `bake_volume`.

    Returns
    -------
    dict of str
        The provenance; a .zarr has it among its attributes.

    Raises
    ------
    MeshdepictError
        For what can't be read or written, a missing package, and as `bake_volume`.
    """
    told = {
        "spacing": spacing, "origin": origin, "direction": direction, "hounsfield": hounsfield,
    }  # fmt: skip
    values, shading = _shading(source, Choices(method, **chosen), told, value_range)
    import dask  # there, or it has been said that it isn't

    rgba = lazy_rgba(values, shading, chunks=chunks)
    provenance = shading.provenance(None, math.nan)
    del provenance["shaded"]  # nobody has counted
    path = Path(out)
    alone = dask.base.get_scheduler() is None
    with dask.config.set(**({"scheduler": "synchronous"} if alone else {})):
        if path.name.endswith(OME_ZARR):
            _to_ome_zarr(rgba, path, shading, provenance)
        elif path.suffix == ".zarr":
            _to_zarr(rgba, path, provenance)
        elif path.suffix == ".npy":
            _to_npy(rgba, path)
        else:
            raise MeshdepictError(
                f"{path}: RGBA goes to an .ome.zarr, .zarr or .npy, not to {path.suffix!r}"
            )
    return provenance


def _shading(
    source: Any,
    look: Choices,
    told: dict[str, Any],
    value_range: tuple[float, float] | None,
) -> tuple[Any, VoxelShading]:
    """Return a volume as a dask array, and how it is shaded."""
    known: dict[str, Any] = {}
    if isinstance(source, (str, os.PathLike)) and os.fspath(source).endswith(OME_ZARR):
        with about_file(Path(source)):
            source, contents = ome_array(source)
        known = {**contents.place, "hounsfield": contents.hounsfield}
        unit = contents.length_unit
    else:
        unit = ""
    values = _dask_array(source)
    values = values[(0,) * (values.ndim - 3)] if known else values
    if value_range is None:
        value_range = _range(values)
    known |= {name: value for name, value in told.items() if value is not None}
    place = Place(values.shape, value_range, **known)
    place.length_unit = unit
    look = look.of_kind("volume")
    return values, settled_lazily(values, voxel_shading(place, look, transfer=look.transfer))


def settled_lazily(values: Any, shading: VoxelShading) -> VoxelShading:
    """Return a shading with numbers for options that follow the shape: the middle slices are read.

    Parameters
    ----------
    values : dask.array.Array
        (nz, ny, nx).
    shading : VoxelShading
        Of the whole volume.
    """
    shape: Triple = (values.shape[0], values.shape[1], values.shape[2])
    widths = np.array([in_voxels(float(width), shading.shape) for width in shading.widths])
    reach = halo(shape, widths, shading.tolerance)[0] + BESIDE

    def piece_of(begin: int, end: int) -> Piece:
        first = max(0, begin - reach)
        read = np.asarray(values[first : end + reach].compute())
        return Piece(read, (first, 0, 0), shape, shading.shape.range)

    return shading.settled_by(piece_of)


def lazy_rgba(values: Any, shading: VoxelShading, *, chunks: Triple | None = None) -> Any:
    """Return RGBA (nz, ny, nx, 4) as a dask array that is shaded where it is asked for.

    Parameters
    ----------
    values : dask.array.Array
        (nz, ny, nx).
    shading : VoxelShading
        Of the whole volume.
    chunks : (z, y, x), optional
        Voxels of a block; more where normals reach further.

    Raises
    ------
    MeshdepictError
        For methods that need all voxels at once.
    """
    import dask.array as da

    shading.refuse_pieces("this volume is shaded block by block: bake a smaller one in memory")
    shading = settled_lazily(values, shading)
    shape: Triple = (values.shape[0], values.shape[1], values.shape[2])
    widths = np.array([in_voxels(float(width), shading.shape) for width in shading.widths])
    reach = halo(shape, widths, shading.tolerance)
    depth = tuple(min(r + BESIDE, n) for r, n in zip(reach, shape, strict=True))
    values = values.rechunk(_blocks(shape, depth, chunks))
    starts = [np.concatenate(([0], np.cumsum(sizes)))[:-1] for sizes in values.chunks]

    def shade(block: NDArray[Any], block_info: Any = None) -> NDArray[np.uint8]:
        place = block_info[0]["chunk-location"]
        low = tuple(int(s[i]) for s, i in zip(starts, place, strict=True))
        sizes = (values.chunks[axis][i] for axis, i in enumerate(place))
        high = tuple(a + int(n) for a, n in zip(low, sizes, strict=True))
        corner = tuple(max(a - d, 0) for a, d in zip(low, depth, strict=True))
        return shading.rgba(Piece(block, corner, shape, shading.shape.range), low, high)[0]  # type: ignore[arg-type]

    return da.map_overlap(
        shade,
        values,
        depth=dict(enumerate(depth)),
        boundary="none",  # the matrices know the border
        trim=False,
        allow_rechunk=False,
        chunks=(*values.chunks, (4,)),
        new_axis=3,
        dtype=np.uint8,
        meta=np.empty((0, 0, 0, 0), np.uint8),
    )


def _blocks(shape: Triple, depth: tuple[int, ...], chunks: Triple | None) -> Any:
    """Return sizes of blocks along each axis, none of them smaller than what overlaps."""
    if chunks is None:  # slabs, whose neighbours are only two
        thick = max(depth[0], _BLOCK // (shape[1] * shape[2]), 1)
        chunks = (thick, shape[1], shape[2])
    found = []
    for n, d, c in zip(shape, depth, chunks, strict=True):
        count = max(1, n // max(min(c, n), d, 1))
        cuts = [n * i // count for i in range(count + 1)]
        found.append(tuple(b - a for a, b in pairwise(cuts)))
    return tuple(found)


def _dask_array(source: Any) -> Any:
    """Return a dask array of a path, a zarr array, a mapped file or one of its own."""
    try:
        import dask.array as da
    except ImportError:
        raise MeshdepictError(
            "volumes bigger than memory need dask and zarr: pip install 'meshdepict[cluster]'"
        ) from None
    if isinstance(source, (str, os.PathLike)):
        source = _opened(Path(source))
    if not isinstance(source, da.Array):
        if not hasattr(source, "ndim"):
            raise MeshdepictError(
                f"a {type(source).__name__} is not an array: give a path, or an array of zarr, "
                "dask or NumPy"
            )
        # Slabs of whole rows: a mapped file is read from front to back.
        sizes = getattr(source, "chunks", None) or (16, *source.shape[1:])
        source = da.from_array(source, chunks=sizes)
    if source.ndim != 3 or min(source.shape) < 2 or source.dtype.kind not in "biuf":
        raise MeshdepictError(
            f"a volume is a grid (z, y, x) of real numbers, two or more along each axis, not "
            f"{source.dtype} of shape {source.shape}"
        )
    return source


def _opened(path: Path) -> Any:
    regular(path)
    if path.suffix == ".npy":
        try:
            return mapped_array(path)
        except (OSError, ValueError) as error:
            raise MeshdepictError(f"{path} can't be read: {error}") from None
    if path.suffix != ".zarr":
        raise MeshdepictError(f"{path}: volumes bigger than memory are read from .zarr or .npy")
    zarr = zarr_module()
    try:
        found = zarr.open(path, mode="r")
    except Exception as error:  # zarr's versions raise errors of several kinds
        raise MeshdepictError(f"{path} can't be read: {error}") from None
    if not hasattr(found, "ndim"):
        raise MeshdepictError(f"{path} is a zarr group: give the path of an array in it")
    return found


def _range(values: Any) -> tuple[float, float]:
    import dask

    with dask.config.set(**({"scheduler": "threads"} if dask.base.get_scheduler() is None else {})):
        low, high = dask.compute(values.min(), values.max())
    if not (math.isfinite(low) and math.isfinite(high)):
        raise MeshdepictError("the volume has values that are NaN or infinite: replace them")
    if low == high:
        raise MeshdepictError(f"the volume is constant: every voxel is {low}")
    return float(low), float(high)


def _to_zarr(rgba: Any, path: Path, provenance: dict[str, str]) -> None:
    import dask.array as da

    part = path.with_name(f".{path.name}.part")
    if path.exists():
        raise MeshdepictError(f"{path} exists already: a .zarr is not written over")
    # Not the blocks of the work: a viewer wants pieces.
    pieces = (*(min(n, 64) for n in rgba.shape[:3]), 4)
    target = zarr_module().create_array(
        part, shape=rgba.shape, chunks=pieces, dtype="u1", overwrite=True
    )
    target.attrs.update({"meshdepict": provenance, "axes": ["z", "y", "x", "rgba"]})
    da.store(rgba, target, lock=True)
    part.rename(path)


def _to_ome_zarr(rgba: Any, path: Path, shading: VoxelShading, provenance: dict[str, str]) -> None:
    import dask.array as da

    with ome_zarr(path, shading.shape, "u1", rgba=True, comments=provenance) as target:
        da.store(da.moveaxis(rgba, -1, 0), target, lock=True)


def _to_npy(rgba: Any, path: Path) -> None:
    import dask.array as da

    part = path.with_name(f".{path.name}.part")
    try:
        target = np.lib.format.open_memmap(part, mode="w+", dtype=np.uint8, shape=rgba.shape)
    except OSError as error:
        raise MeshdepictError(f"{path} can't be written: {error.strerror}") from None
    try:
        da.store(rgba, target, lock=True)
        target.flush()
        del target
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
