"""Small meshes as (points, faces), and what can be wrong with their winding."""

import numpy as np

from meshdepict.surface.icosahedron import icosphere
from meshdepict.surface.orientation import orient

BALL = icosphere(500)


def both(*meshes):
    """Put (points, faces) side by side in one mesh."""
    starts = np.cumsum([0, *(len(points) for points, _ in meshes)])
    faces = [faces + start for (_, faces), start in zip(meshes, starts, strict=False)]
    return np.concatenate([points for points, _ in meshes]), np.concatenate(faces)


def turned(faces, which):
    which = np.broadcast_to(which, len(faces))
    return np.where(which[:, None], faces[:, ::-1], faces)


def inside_out(mesh):
    points, faces = mesh
    return points, faces[:, ::-1]


def scrambled(faces, share=0.3, seed=0):
    which = np.random.default_rng(seed).random(len(faces)) < share
    return turned(faces, which), which


def opened(mesh, height):
    """Take off the cap of a unit ball above z = height, and what is no longer used."""
    points, faces = mesh
    return points, faces[points[faces, 2].max(axis=1) < height]


def moved(mesh, offset, scale=1.0):
    return mesh[0] * scale + np.asarray(offset), mesh[1]


def sheet(side=20, height=lambda x, y: 0 * x):
    x, y = (axis.ravel() for axis in np.mgrid[0 : 1 : side * 1j, 0 : 1 : side * 1j])
    a = np.arange(side * side).reshape(side, side)[:-1, :-1].ravel()
    faces = np.concatenate(
        (
            np.stack((a, a + side, a + side + 1), axis=1),
            np.stack((a, a + side + 1, a + 1), axis=1),
        )
    )
    return np.stack((x, y, height(x, y)), axis=1), faces


def tube(length, around=24, along=60):
    turn = np.arange(around) * (2 * np.pi / around)
    z = np.linspace(0, length, along)
    points = [(np.cos(t), np.sin(t), h) for h in z for t in turn]
    number = np.arange(around * along).reshape(along, around)
    a, b = number[:-1].ravel(), np.roll(number, -1, axis=1)[:-1].ravel()
    faces = np.concatenate(
        (np.stack((a, b, b + around), axis=1), np.stack((a, b + around, a + around), axis=1))
    )
    return np.array(points), faces


CUBE = (
    np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float),
    np.array(
        [
            *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
            *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
        ]
    ),
)


def flips(mesh):
    points, faces = mesh
    before = points.copy(), faces.copy()
    found = orient(points, faces)
    np.testing.assert_array_equal(points, before[0])
    np.testing.assert_array_equal(faces, before[1])
    assert found.flipped.shape == (len(faces),)
    assert found.flipped.dtype == bool
    assert (found.message is None) == (not found.flipped.any())
    if found.message:
        assert found.message.startswith(f"winding of {found.flipped.sum():,} faces was turned: ")
    return found.flipped
