"""A ground that is a mirror: it shows the colours of what stands on it, and the sky."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.baked import Baked
from meshdepict.baking.mirror_image import MirrorImage
from meshdepict.options import options_of
from meshdepict.scales.seen_side import towards_eye
from meshdepict.scene.environment import Environment
from meshdepict.scene.names import parted
from meshdepict.shapes.ground_plane import GroundPlane
from meshdepict.shapes.joined import JoinedMesh
from meshdepict.threads import each, spans
from meshdepict.transport.rays import BATCH, ray_scene

__all__ = ["mirrored", "mirrored_picture"]

Single = NDArray[np.float32]

_OFFSET = 1e-5  # of a ray's start from the ground, in diagonals of what stands on it
_BLUR = np.pi / 512  # of an environment: what lies between two vertices


def mirrored(ground: Baked, bakes: Sequence[Baked]) -> Baked:
    """Return the bake of a ground as the mirror that it is, seen as its view sees it.

    A ray from the eye that it turns back meets an object, and shows that in the colours of its
    bake; or it gets away, and shows the environments that there are. Where there are none it is
    black.

    Parameters
    ----------
    ground : Baked
        Of a `GroundPlane`, as if it were matt.
    bakes : sequence of Baked
        Of all that stands together.
    """
    plane, objects = _plane(ground), _objects(bakes)
    surface = JoinedMesh([baked.mesh for baked in objects])
    light = color.srgb_to_linear(_colors(objects) / np.float32(255))
    away, above = _turned_back(ground)
    shown, met = _met(surface, plane.vertices, plane.up, away, light)
    rest = above & ~met
    shown[rest] = _sky(ground, away[rest])
    shown[~above] = 0
    return _in_colors(plane, ground, shown, color.encode(shown, linear=True))


def mirrored_picture(ground: Baked, bakes: Sequence[Baked]) -> Baked:
    """Return what pictures draw of a ground that is a mirror: objects turned over, and the sky.

    Unlike colours at vertices it is as sharp as the objects. Where there is no environment, nothing
    is behind the objects but what pictures lie on.
    """
    plane, objects = _plane(ground), _objects(bakes)
    image = MirrorImage(plane, [baked.mesh for baked in objects], ground.view)
    away, above = _turned_back(ground)
    sky = np.zeros((len(plane.vertices), 3), np.float32)
    sky[above] = _sky(ground, away[above])
    colors = np.concatenate([_colors(objects), color.encode(sky, linear=True)])
    if not _skies(ground):
        image.coverage[-len(sky) :] = 0
    return _in_colors(image, ground, color.srgb_to_linear(colors / np.float32(255)), colors)


def _plane(ground: Baked) -> GroundPlane:
    assert isinstance(ground.shape, GroundPlane)
    return ground.shape


def _objects(bakes: Sequence[Baked]) -> list[Baked]:
    return [baked for baked in bakes if not isinstance(baked.shape, GroundPlane)]


def _colors(bakes: Sequence[Baked]) -> NDArray[np.uint8]:
    return np.concatenate([baked.colors for baked in bakes])


def _in_colors(mesh: Any, ground: Baked, light: NDArray[Any], colors: NDArray[np.uint8]) -> Baked:
    return Baked(mesh, light, colors, ground.provenance, ground.view, look=ground.look)


def _turned_back(ground: Baked) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return where rays (n, 3) from the eye go from the ground, and which are from above."""
    plane = _plane(ground)
    eye = np.broadcast_to(towards_eye(plane.vertices, ground.view), plane.vertices.shape)
    return 2 * (eye @ plane.up)[:, None] * plane.up - eye, eye @ plane.up > 0


def _met(
    surface: JoinedMesh,
    points: NDArray[np.float64],
    up: NDArray[np.float64],
    directions: NDArray[np.float64],
    light: NDArray[Any],
) -> tuple[Single, NDArray[np.bool_]]:
    """Return the light (n, 3) of what rays from points meet, and whether they meet anything."""
    scene, faces = ray_scene(surface), surface.faces
    starts = (surface.recentred(points) + _OFFSET * up).astype(np.float32)
    along = directions.astype(np.float32)
    found, met = np.zeros((len(points), 3), np.float32), np.zeros(len(points), bool)

    def work(begin: int, end: int) -> None:
        hit = scene.run(starts[begin:end], along[begin:end], query="INTERSECT", output=True)
        there = hit["primID"] >= 0
        second, third = hit["u"][there, None], hit["v"][there, None]
        a, b, c = (light[corner] for corner in faces[hit["primID"][there]].T)
        found[begin:end][there] = (1 - second - third) * a + second * b + third * c
        met[begin:end] = there

    each(work, spans(len(points), -(-len(points) // BATCH)))
    return found, met


def _skies(ground: Baked) -> list[Environment]:
    if ground.look is None or ground.look.light is None:
        return []
    return parted(ground.look.light, ground.view)[1]


def _sky(ground: Baked, directions: NDArray[np.float64]) -> Single:
    """Return what environments show (n, 3) in some directions, as bright as the method has it."""
    total = np.zeros((len(directions), 3), np.float32)
    look = ground.look
    if look is not None:
        known = options_of(look.function).get("exposure")
        exposure = look.options.get("exposure", 1.0 if known is None else known.default)
        for sky in _skies(ground):
            total += np.float32(exposure) * sky.lookup(directions, blur=_BLUR)
    return np.clip(total, 0, 1)
