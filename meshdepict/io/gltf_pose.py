"""Where things are in a glTF scene: nodes, their instances, morph targets and skins."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.gltf_buffers import Buffers, pick
from meshdepict.io.gltf_extensions import INSTANCING, VISIBILITY

__all__ = ["cofactors", "instances", "mirrors", "morphed", "placed", "skinned"]

Floats = NDArray[np.float64]


def placed(header: dict[str, Any]) -> dict[int, Floats]:
    """Return the nodes that are shown, in order, with their (4, 4) transforms to the world.

    Raises
    ------
    MeshdepictError
        For a transform that isn't finite.
    """
    nodes = header.get("nodes", [])
    scenes = header.get("scenes")
    if scenes:
        roots = pick(header, "scenes", header.get("scene", 0)).get("nodes", [])
    else:
        children = {child for node in nodes for child in node.get("children", ())}
        roots = [index for index in range(len(nodes)) if index not in children]
    found: dict[int, Floats] = {}
    waiting = [(index, np.eye(4)) for index in reversed(roots)]
    while waiting:
        index, above = waiting.pop()
        if index in found:  # each node once: no cycle goes on for ever
            continue
        node = pick(header, "nodes", index)
        if node.get("extensions", {}).get(VISIBILITY, {}).get("visible") is False:
            continue
        matrix = above @ _local(node)
        if not np.isfinite(matrix).all():
            raise MeshdepictError(f"is wrong as glTF: the transform of node {index} is not finite")
        found[index] = matrix
        waiting += [(child, matrix) for child in reversed(node.get("children", []))]
    return found


def _local(node: dict[str, Any]) -> Floats:
    """Return a node's own transform as (4, 4), for columns."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    parts = (
        np.array([node.get(name, usual)], dtype=float).reshape(1, len(usual))
        for name, usual in (
            ("translation", (0.0, 0.0, 0.0)),
            ("rotation", (0.0, 0.0, 0.0, 1.0)),
            ("scale", (1.0, 1.0, 1.0)),
        )
    )
    matrix: Floats = _composed(*parts)[0]
    return matrix


def _composed(translation: Floats, rotation: Floats, scale: Floats) -> Floats:
    """Return (n, 4, 4) transforms: scaled, turned by quaternions (x, y, z, w), and moved."""
    x, y, z, w = rotation.T
    turns = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrices = np.tile(np.eye(4), (len(x), 1, 1))
    matrices[:, :3, :3] = np.moveaxis(turns, 2, 0) * scale[:, None, :]
    matrices[:, :3, 3] = translation
    return matrices


def instances(node: dict[str, Any], buffers: Buffers) -> Floats | None:
    """Return the (n, 4, 4) transforms that put a node's mesh at several places, None without.

    Raises
    ------
    MeshdepictError
        For numbers that aren't finite, and for attributes of different lengths.
    """
    extension = node.get("extensions", {}).get(INSTANCING)
    if extension is None:
        return None
    used = extension["attributes"]
    counts = {buffers.count(index) for index in used.values()}
    if len(counts) != 1:
        raise MeshdepictError(
            f"is wrong as glTF: the attributes of its instances ({INSTANCING}) have different "
            "lengths"
        )
    length = counts.pop()
    buffers.claim(128 * length, "instances")  # what Python needs for each, at least
    parts = []
    for name, usual in (
        ("TRANSLATION", (0.0, 0.0, 0.0)),
        ("ROTATION", (0.0, 0.0, 0.0, 1.0)),
        ("SCALE", (1.0, 1.0, 1.0)),
    ):
        if name in used:
            given = buffers.accessor(used[name], fractions=name == "ROTATION")
            parts.append(given.astype(np.float64).reshape(length, len(usual)))
        else:
            parts.append(np.tile(usual, (length, 1)))
    matrices = _composed(*parts)
    if not np.isfinite(matrices).all():
        raise MeshdepictError("is wrong as glTF: the transform of an instance is not finite")
    return matrices


def morphed(
    values: Floats,
    name: str,
    primitive: dict[str, Any],
    weights: Sequence[float],
    buffers: Buffers,
) -> Floats:
    """Return an attribute's values moved towards the primitive's targets by their weights.

    Raises
    ------
    MeshdepictError
        For a target with another number of values.
    """
    for target, weight in zip(primitive.get("targets", ()), weights, strict=False):
        if not weight or name not in target:
            continue
        offsets = buffers.accessor(target[name], fractions=name == "COLOR_0")
        if offsets.shape[0] != len(values):
            raise MeshdepictError(
                f"is wrong as glTF: a morph target has {offsets.shape[0]:,} values for "
                f"{len(values):,} vertices"
            )
        values = values + weight * offsets[:, : values.shape[1]]
    return values


def skinned(
    points: Floats,
    used: dict[str, int],
    skin: dict[str, Any],
    placed: dict[int, Floats],
    buffers: Buffers,
) -> Floats:
    """Return points where a skin's joints carry them in the scene's pose, in the world."""
    joints = skin["joints"]
    carried = np.stack([placed.get(joint, np.eye(4)) for joint in joints])
    if "inverseBindMatrices" in skin:
        bound = buffers.accessor(skin["inverseBindMatrices"]).astype(np.float64)
        carried = carried @ bound.reshape(-1, 4, 4).transpose(0, 2, 1)[: len(joints)]
    moved, total = np.zeros_like(points), np.zeros((len(points), 1))
    homogeneous = np.c_[points, np.ones(len(points))]
    for number in count():
        if f"JOINTS_{number}" not in used or f"WEIGHTS_{number}" not in used:
            break
        which = buffers.indices(used[f"JOINTS_{number}"])
        shares = buffers.accessor(used[f"WEIGHTS_{number}"], fractions=True)
        for k in range(which.shape[1]):
            share = shares[:, k : k + 1].astype(np.float64)
            place = np.einsum("nij,nj->ni", carried[which[:, k], :3], homogeneous)
            moved += np.where(share != 0, share * place, 0.0)
            total += share
    return moved / np.where(total > 0, total, 1.0)


def cofactors(matrix: Floats) -> Floats:
    """Return what normals are multiplied by where points are by a matrix, but for their length."""
    a, b, c = matrix[:3, :3] / (np.abs(matrix[:3, :3]).max() or 1.0)
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])


def mirrors(matrix: Floats) -> bool:
    """Tell whether a matrix turns a right hand into a left one."""
    largest = np.abs(matrix[:3, :3]).max()
    return bool(largest > 0 and np.linalg.det(matrix[:3, :3] / largest) < 0)
