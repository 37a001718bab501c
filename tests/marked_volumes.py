"""A volume with three marked voxels, put in the world in every way that files can."""

from __future__ import annotations

import struct

import numpy as np
from conftest import rotation

from meshdepict.shapes.volume import Volume

MARKS = {1001: (1, 2, 3), 1002: (4, 0, 6), 1003: (0, 5, 1)}  # value: voxel x, y, z

DIRECTIONS = {
    "straight": np.eye(3),
    "half a turn": np.diag((-1.0, -1.0, 1.0)),
    "upside down": np.diag((1.0, -1.0, -1.0)),
    "left-handed": np.diag((1.0, 1.0, -1.0)),
    "axes exchanged": np.eye(3)[[2, 0, 1]],
    "oblique": rotation(np.random.default_rng(1)),
    "oblique, left-handed": rotation(np.random.default_rng(2)) * (1, -1, 1),
}


def marked(kind="i2") -> np.ndarray:
    values = np.random.default_rng(0).integers(0, 200, (7, 6, 5)).astype(kind)
    for value, (x, y, z) in MARKS.items():
        values[z, y, x] = value
    return values


def placed(direction, **options) -> Volume:
    return Volume(
        marked(options.pop("kind", "i2")),
        spacing=(0.5, 0.75, 2.5),
        origin=(10, -20, 30),
        direction=direction,
        **options,
    )


def places(volume: Volume) -> dict[int, np.ndarray]:
    return {value: volume.to_world(np.argwhere(volume.values == value)[0][::-1]) for value in MARKS}


def assert_same_places(found: Volume, wanted: Volume, atol: float) -> None:
    for value, place in places(wanted).items():
        np.testing.assert_allclose(places(found)[value], place, atol=atol)
    np.testing.assert_allclose(found.centre, wanted.centre, atol=atol)


def assert_same(found: Volume, wanted: Volume, atol: float) -> None:
    np.testing.assert_array_equal(found.values, wanted.values)
    assert found.values.dtype == wanted.values.dtype
    assert_same_places(found, wanted, atol)
    for name in ("spacing", "origin", "direction"):
        np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), atol=atol)


def nifti(values, matrix, *, slope=1.0, inter=0.0, quaternion=None) -> bytes:
    """Write a NIfTI-1 file after its standard: what ITK writes can't test what ITK reads."""
    header = bytearray(352)
    nz, ny, nx = values.shape
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, nx, ny, nz, 1, 1, 1, 1)
    struct.pack_into(
        "<hh", header, 70, {"int16": 4, "uint8": 2}[str(values.dtype)], 8 * values.itemsize
    )
    spacing = np.linalg.norm(matrix[:, :3], axis=0)
    struct.pack_into("<8f", header, 76, 1, *spacing, 1, 1, 1, 1)
    struct.pack_into("<3f", header, 108, 352, slope, inter)
    struct.pack_into("<hh", header, 252, 0, 1)
    for row in range(3):
        struct.pack_into("<4f", header, 280 + 16 * row, *matrix[row])
    header[344:348] = b"n+1\0"
    return bytes(header) + values.tobytes()
