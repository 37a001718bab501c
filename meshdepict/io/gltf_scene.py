"""A glTF scene: accessors, nodes and their transforms, taken apart into lists of triangles."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.surface.polygons import Polygons, strip_triangles

__all__ = ["COMPONENTS", "Part", "Scene"]

Floats = NDArray[np.float64]

COMPONENTS = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")


class Part(NamedTuple):
    """Triangles that share one list of points, in world coordinates."""

    points: Floats
    faces: NDArray[np.int64]
    color: Floats | None  # (n, 3) linear
    texture: Floats | None  # (n, 2)


class Scene:
    """The scene that a glTF header describes.

    Parameters
    ----------
    header : dict
        The JSON part. Where it doesn't follow the standard, reading raises what Python raises.
    chunk : bytes
        The binary part, empty if there is none.
    folder : Path
        Where buffers in files of their own lie.
    """

    def __init__(self, header: dict[str, Any], chunk: bytes, folder: Path) -> None:
        self._header = header
        self._folder = folder
        self._buffers = {0: chunk} if chunk else {}
        for extension in header.get("extensionsRequired", ()):
            if extension in _COMPRESSED:
                raise MeshdepictError(
                    f"is compressed ({extension}), which is not read; export it uncompressed"
                )

    def losses(self) -> list[str]:
        """Name what the scene has beside triangles and their colours."""
        names = [name for name in ("textures", "animations", "skins") if self._header.get(name)]
        modes = {
            primitive.get("mode", _TRIANGLES)
            for mesh in self._header.get("meshes", ())
            for primitive in mesh["primitives"]
        }
        return names + (["points and lines"] if modes & {0, 1, 2, 3} else [])

    def parts(self) -> list[Part]:
        """Return the triangles of every node of the scene."""
        nodes = self._header.get("nodes", [])
        scenes = self._header.get("scenes")
        if scenes:
            roots = scenes[self._header.get("scene", 0)].get("nodes", [])
        else:
            children = {child for node in nodes for child in node.get("children", ())}
            roots = [index for index in range(len(nodes)) if index not in children]
        found: list[Part] = []
        waiting = [(index, np.eye(4)) for index in reversed(roots)]
        for _ in range(len(nodes)):  # each node once: no cycle goes on for ever
            if not waiting:
                break
            index, above = waiting.pop()
            node = nodes[index]
            matrix = above @ _local_matrix(node)
            waiting += [(child, matrix) for child in reversed(node.get("children", []))]
            if "mesh" in node:
                found += self._mesh_parts(self._header["meshes"][node["mesh"]], matrix)
        return found

    def _mesh_parts(self, mesh: dict[str, Any], matrix: Floats) -> list[Part]:
        """Return a mesh's triangles; primitives that share their vertices stay one part."""
        shared: dict[tuple[Any, ...], Part] = {}
        for primitive in mesh["primitives"]:
            if primitive.get("mode", _TRIANGLES) < _TRIANGLES:
                continue
            used = primitive["attributes"]
            factor = self._material_color(primitive)
            key = (used["POSITION"], used.get("COLOR_0"), used.get("TEXCOORD_0"), *factor)
            if key not in shared:
                shared[key] = self._part(used, matrix, factor)
            part = shared[key]
            faces = self._faces(primitive, len(part.points))
            if np.linalg.det(matrix[:3, :3]) < 0:  # a mirror turns faces round
                faces = faces[:, ::-1]
            shared[key] = part._replace(faces=np.concatenate((part.faces, faces)))
        return list(shared.values())

    def _part(self, used: dict[str, int], matrix: Floats, factor: list[float]) -> Part:
        points = self.accessor(used["POSITION"]).astype(np.float64)
        color = texture = None
        if "COLOR_0" in used:
            color = self.accessor(used["COLOR_0"], fractions=True)[:, :3] * factor
        if "TEXCOORD_0" in used:
            texture = self.accessor(used["TEXCOORD_0"]).astype(np.float64)
        moved = points @ matrix[:3, :3].T + matrix[:3, 3]
        return Part(moved, np.empty((0, 3), np.int64), color, texture)

    def _faces(self, primitive: dict[str, Any], count: int) -> NDArray[np.int64]:
        index = np.arange(count)
        if "indices" in primitive:
            index = self.accessor(primitive["indices"])[:, 0].astype(np.int64)
        if len(index) and index.max() >= count:
            raise MeshdepictError(f"has a glTF index of {index.max()} with only {count} points")
        mode = primitive.get("mode", _TRIANGLES)
        if mode == _STRIP:
            return strip_triangles(Polygons(index, np.array([0, len(index)])))[0]
        if mode == _FAN:
            first = np.broadcast_to(index[:1], max(len(index) - 2, 0))
            return np.stack((first, index[1:-1], index[2:]), axis=1)
        return index[: len(index) // 3 * 3].reshape(-1, 3)

    def _material_color(self, primitive: dict[str, Any]) -> list[float]:
        if "material" not in primitive:
            return [1.0, 1.0, 1.0]
        material = self._header["materials"][primitive["material"]]
        metallic_roughness = material.get("pbrMetallicRoughness", {})
        factor: list[float] = metallic_roughness.get("baseColorFactor", [1.0, 1.0, 1.0])[:3]
        return factor

    def accessor(self, index: int, *, fractions: bool = False) -> NDArray[Any]:
        """Return an accessor's values as (count, components), normalised where it says so.

        ``fractions`` takes integers as fractions of their range in any case.
        """
        accessor = self._header["accessors"][index]
        kind = np.dtype("<" + COMPONENTS[accessor["componentType"]])
        shape = (accessor["count"], _SIZES[accessor["type"]])
        if "bufferView" in accessor:
            values = self._viewed(accessor, kind, shape)
        else:
            values = np.zeros(shape, kind)
        if sparse := accessor.get("sparse"):
            index_kind = np.dtype("<" + COMPONENTS[sparse["indices"]["componentType"]])
            at = self._viewed(sparse["indices"], index_kind, (sparse["count"], 1))[:, 0]
            values = values.copy()
            values[at] = self._viewed(sparse["values"], kind, (sparse["count"], shape[1]))
        if kind.kind in "iu" and (fractions or accessor.get("normalized")):
            return np.maximum(values / np.iinfo(kind).max, -1.0)
        return values

    def _viewed(
        self, described: dict[str, Any], kind: np.dtype[Any], shape: tuple[int, int]
    ) -> NDArray[Any]:
        view = self._header["bufferViews"][described["bufferView"]]
        buffer = self._buffer(view["buffer"])
        start = view.get("byteOffset", 0) + described.get("byteOffset", 0)
        count, components = shape
        row = kind.itemsize * components
        stride = view.get("byteStride", row)
        if count and start + (count - 1) * stride + row > len(buffer):
            raise MeshdepictError("is cut off: its buffers are shorter than its glTF header says")
        return np.ndarray(shape, kind, buffer, start if count else 0, (stride, kind.itemsize))

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            uri = self._header["buffers"][index].get("uri", "")
            if uri.startswith("data:"):
                self._buffers[index] = base64.b64decode(uri.partition(",")[2])
            else:
                try:
                    self._buffers[index] = (self._folder / unquote(uri)).read_bytes()
                except OSError as error:
                    raise MeshdepictError(
                        f"needs the file {uri!r} beside it, which can't be read ({error.strerror})"
                    ) from None
        return self._buffers[index]


def _local_matrix(node: dict[str, Any]) -> Floats:
    """Return a node's own transform as (4, 4), for columns."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * node.get("scale", (1.0, 1.0, 1.0))
    matrix[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return matrix
