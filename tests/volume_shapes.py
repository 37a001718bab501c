"""Small volumes of known shape, put in the world in every way that files can."""

import numpy as np
from conftest import rotation

from meshdepict.color.transfer import TransferFunction
from meshdepict.shapes.volume import Volume

DIRECTIONS = {
    "straight": np.eye(3),
    "left-handed": np.diag((1.0, 1.0, -1.0)),
    "axes exchanged": np.eye(3)[[2, 0, 1]],
    "oblique": rotation(np.random.default_rng(1)),
    "oblique, left-handed": rotation(np.random.default_rng(2)) * (1, -1, 1),
}

EDGE = 100.0
"""The surface of `blobs` lies where opacity begins, between 99 and 101."""

SOLID = TransferFunction(
    [(EDGE - 1, 0.0, "#c08040"), (EDGE + 1, 1.0, "#c08040")], name="solid", unit="raw"
)
WHITE = TransferFunction(
    [(EDGE - 1, 0.0, "#ffffff"), (EDGE + 1, 1.0, "#ffffff")], name="white", unit="raw"
)


def blobs(direction="straight", *, kind="i2") -> Volume:
    """Three balls of different sizes in a box of 24 x 28 x 20 voxels: no two sides look alike."""
    spacing = np.array((0.5, 0.4, 0.7))
    z, y, x = np.mgrid[:20, :28, :24]
    places = np.stack((x, y, z), axis=-1) * spacing
    values = np.zeros(x.shape)
    for centre, radius in (((4, 5, 5), 2.6), ((8.5, 5.5, 7), 1.9), ((5, 8.5, 10), 1.6)):
        away = np.linalg.norm(places - centre, axis=-1)
        values = np.maximum(values, EDGE + 60 * (radius - away))
    return Volume(
        np.rint(np.clip(values, 0, 250)).astype(kind),
        spacing=spacing,
        origin=(100, -50, 20),
        direction=DIRECTIONS[direction],
    )
