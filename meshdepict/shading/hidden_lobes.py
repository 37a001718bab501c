"""Highlights of an environment that is hidden in part, and of light that bounced.

The samples are those of `lobes`, and each is asked what it meets: there it takes what the surface
sends, else the environment. What they met is kept, so that another light costs no ray.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from meshdepict.files.limits import max_memory
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.shading.lobe_samples import LobeSamples
from meshdepict.threads import each, kernel, spans

__all__ = ["hidden_lobes"]

Single = NDArray[np.float32]
Sampled = Callable[[Environment], list[LobeSamples]]

_AT_ONCE = 65_536  # samples, as rays are traced
_KEPT = 1 / 16  # of the memory that is allowed
_WEIGHTS = 65_535  # of a barycentric coordinate of 1
_A_HIT = 8  # bytes
_DARK = Environment(np.zeros((4, 8, 3), np.float32), name="darkness")


class _Met(NamedTuple):
    """What the samples of some points met that count, one after the other."""

    triangle: NDArray[np.int32]
    weights: NDArray[np.uint16]


_kept: WeakKeyDictionary[ScaleSpace, tuple[tuple[Any, ...], list[list[_Met]]]] = WeakKeyDictionary()


def hidden_lobes(
    space: ScaleSpace,
    environments: Sequence[Environment],
    sampled: Sampled,
    *,
    sent: NDArray[Any] | None,
    question: tuple[Any, ...],
) -> Single:
    """Return Σ ρ_s L over the lobe of every point, L what is met there.

    Parameters
    ----------
    space : ScaleSpace
    environments : sequence of Environment
    sampled : callable
        Returns samples of an environment, as `lobes.lobe_samples` does: the same of each but for
        where they are looked up.
    sent : (v,) or (v, c) array, optional
        What the vertices of the surface send; nothing unless given.
    question : tuple
        All that samples depend on, numbers and arrays: what they met is kept until it differs.

    Returns
    -------
    (n,) array, (n, 3) in colour
    """
    light = np.zeros((len(space.surface.vertices), 1), np.float32)
    if sent is not None:
        light = np.ascontiguousarray(sent.reshape(len(sent), -1), np.float32)
    total = np.zeros((space.count, 1), np.float32)
    for number, environment in enumerate(environments or [_DARK]):
        parts = sampled(environment)
        known = _known(space, question)
        met = known or [[] for _ in parts]
        for part, some in zip(parts, met, strict=True):
            found = _summed(space, part, some, light if number == 0 else light[:, :1] * 0)
            total = total + (found[:, :1] if environment.gray and light.shape[1] == 1 else found)
        if not known and sum(_bytes(each) for each in met) <= _KEPT * max_memory():
            _kept[space] = tuple(np.copy(each) for each in question), met
    return total[:, 0] if total.shape[1] == 1 else total


def _known(space: ScaleSpace, question: tuple[Any, ...]) -> list[list[_Met]] | None:
    """Return what was met when the same was asked before."""
    former, met = _kept.get(space, ((), []))
    same = len(former) == len(question) and all(map(np.array_equal, former, question))
    return met if same else None


def _bytes(met: list[_Met]) -> int:
    return sum(part.triangle.nbytes + part.weights.nbytes for part in met)


def _summed(space: ScaleSpace, samples: LobeSamples, met: list[_Met], light: Single) -> Single:
    """Return the sums (n, 3); what was not yet met is asked, and added."""
    from meshdepict.transport.paths import HIDDEN, mirrored_paths, starting
    from meshdepict.transport.rays import lifted

    surface, own, normals = space.surface, space.normals_at(0), space.surface_normals
    points = surface.recentred(space.ray_points())
    lifts = lifted(points, own)
    matt = np.zeros(len(surface.faces), bool)
    faces = surface.faces.astype(np.int32)
    out = np.zeros((samples.points, 3), np.float32)
    most = samples.samples * samples.parts
    pieces = spans(samples.points, -(-samples.points * most // _AT_ONCE))
    asked = not met
    if asked:
        met.extend([_Met(np.empty(0, np.int32), np.empty((0, 2), np.uint16))] * len(pieces))

    def work(number: int, begin: int, end: int) -> None:
        towards, values, places = samples.told(begin, end)
        if asked:
            point, sample = np.nonzero(values > 0)
            along, at = towards[point, sample], point + begin
            # A Phong highlight reaches below the horizon, where no light is seen.
            above = np.einsum("ij,ij->i", along, own[at]) > 0
            at, along = at[above], along[above]
            paths = mirrored_paths(
                surface, starting(points[at], lifts[at], along), along,
                normals=normals, mirrors=matt, bounces=0,
            )  # fmt: skip
            triangle = np.full(len(above), HIDDEN, np.int32)
            weights = np.zeros((len(above), 2), np.uint16)
            triangle[above], weights[above] = paths.triangle, paths.weights * _WEIGHTS
            met[number] = _Met(triangle, weights)
        _sum(values, places, samples.texels, *met[number], faces, light, out[begin:end])

    each(work, [(i, *piece) for i, piece in enumerate(pieces)])
    return out


@kernel("contracted")
def _sum(values, places, texels, triangle, weights, faces, light, out):  # type: ignore[no-untyped-def]
    """Sum what samples show: the light of vertices where they met a triangle, else texels."""
    share, unit = np.float32(1 / np.pi), np.float32(1 / _WEIGHTS)
    gray, number = light.shape[1] == 1, 0
    for i in range(len(values)):
        for k in range(values.shape[1]):
            if not values[i, k] > 0:
                continue
            value = values[i, k] * share
            f = triangle[number]
            if f < 0:
                if f == -1:  # away; else hidden by what sends nothing
                    for channel in range(3):
                        out[i, channel] += value * texels[places[i, k], channel]
            else:
                second, third = weights[number, 0] * unit, weights[number, 1] * unit
                first = max(np.float32(1) - second - third, np.float32(0))
                for channel in range(3):
                    c = 0 if gray else channel
                    out[i, channel] += value * (
                        first * light[faces[f, 0], c] + second * light[faces[f, 1], c]
                        + third * light[faces[f, 2], c]
                    )  # fmt: skip
            number += 1
