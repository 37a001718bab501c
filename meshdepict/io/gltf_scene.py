"""A glTF scene: meshes, their materials and their places, taken apart into lists of triangles."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.gltf_buffers import Buffers, as_fractions, pick
from meshdepict.io.gltf_extensions import DRACO, Unpacked, check_required, draco
from meshdepict.io.gltf_pose import instances, morphed, placed, skinned
from meshdepict.surface.polygons import Polygons, strip_triangles

__all__ = ["Part", "Scene"]

Floats = NDArray[np.float64]

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_WHITE = (1.0, 1.0, 1.0, 1.0)
_GLOSSINESS = "KHR_materials_pbrSpecularGlossiness"


class Part(NamedTuple):
    """Triangles that share one list of points."""

    points: Floats
    faces: NDArray[np.int64]
    color: Floats | None  # (n, 4) linear, with alpha
    texture: Floats | None  # (n, 2)
    normal: Floats | None = None  # (n, 3), of what neither morphs nor bends


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
    size : int
        Of the file, in bytes.
    """

    def __init__(self, header: dict[str, Any], chunk: bytes, folder: Path, size: int) -> None:
        check_required(header.get("extensionsRequired", ()))
        self._header = header
        self._buffers = Buffers(header, chunk, folder, size)
        self._parts: dict[int, list[Part]] = {}

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
        """Return the triangles of every node of the scene, in world coordinates."""
        found: list[Part] = []
        places = placed(self._header)
        for index, matrix in places.items():
            node = pick(self._header, "nodes", index)
            if "mesh" not in node:
                continue
            if "skin" in node:  # its joints say where it is, the node doesn't
                found += self._skinned_parts(node, places)
                continue
            several = instances(node, self._buffers)
            for part in self._node_parts(node):
                if several is None:
                    found.append(self._moved(part, matrix))
                else:
                    found += [self._moved(part, matrix @ instance) for instance in several]
        if not found and DRACO in self._header.get("extensionsRequired", ()):
            raise MeshdepictError(f"is compressed ({DRACO}), but holds no mesh")
        return found

    def _moved(self, part: Part, matrix: Floats) -> Part:
        """Return a part at its place; a mirror turns its faces round."""
        self._buffers.claim(part.points.size + part.faces.size, "triangles at its nodes")
        points = part.points @ matrix[:3, :3].T + matrix[:3, 3]
        turned = _mirrors(matrix)
        normal = part.normal
        if normal is not None:
            normal = normal @ _cofactors(matrix).T * (-1 if turned else 1)
        faces = part.faces[:, ::-1] if turned else part.faces
        return part._replace(points=points, faces=faces, normal=normal)

    def _skinned_parts(self, node: dict[str, Any], places: dict[int, Floats]) -> list[Part]:
        mesh = pick(self._header, "meshes", node["mesh"])
        skin = pick(self._header, "skins", node["skin"])
        return self._mesh_parts(mesh, node.get("weights", mesh.get("weights", ())), skin, places)

    def _node_parts(self, node: dict[str, Any]) -> list[Part]:
        """Return the triangles of a node's mesh in the mesh's own coordinates."""
        index = node["mesh"]
        mesh = pick(self._header, "meshes", index)
        if node.get("weights"):
            return self._mesh_parts(mesh, node["weights"])
        if index not in self._parts:
            self._parts[index] = self._mesh_parts(mesh, mesh.get("weights", ()))
        return self._parts[index]

    def _mesh_parts(
        self,
        mesh: dict[str, Any],
        weights: Sequence[float],
        skin: dict[str, Any] | None = None,
        places: dict[int, Floats] | None = None,
    ) -> list[Part]:
        """Return a mesh's triangles; primitives that share their vertices stay one part."""
        shared: dict[tuple[Any, ...], Part] = {}
        faces: dict[tuple[Any, ...], list[NDArray[np.int64]]] = {}
        for primitive in mesh["primitives"]:
            if primitive.get("mode", _TRIANGLES) < _TRIANGLES:
                continue
            used = primitive["attributes"]
            packed = primitive.get("extensions", {}).get(DRACO)
            morphs = tuple(str(target) for target in primitive.get("targets", ()))
            factor = self._material_color(primitive)
            key = (
                *(used.get(name) for name in ("POSITION", "COLOR_0", "TEXCOORD_0", "NORMAL")),
                *factor, packed and packed["bufferView"], morphs,
            )  # fmt: skip
            unpacked = self._unpacked(primitive, packed) if packed else None
            if key not in shared:
                part = self._part(primitive, factor, weights, unpacked)
                if skin is not None and "JOINTS_0" in used:
                    points = skinned(part.points, used, skin, places or {}, self._buffers)
                    part = part._replace(points=points, normal=None)
                shared[key] = part
            faces.setdefault(key, []).append(
                self._faces(primitive, len(shared[key].points), unpacked)
            )
        return [part._replace(faces=np.concatenate(faces[key])) for key, part in shared.items()]

    def _unpacked(self, primitive: dict[str, Any], packed: dict[str, Any]) -> Unpacked | None:
        """Return what Draco compressed, None where the file holds the same uncompressed, too."""
        position = primitive["attributes"]["POSITION"]
        plain = "bufferView" in pick(self._header, "accessors", position)
        if plain and DRACO not in self._header.get("extensionsRequired", ()):
            return None
        numbers = 3 * self._buffers.count(position)
        if "indices" in primitive:
            numbers += self._buffers.count(primitive["indices"])
        return draco(self._buffers.packed(packed["bufferView"], numbers), packed["attributes"])

    def _part(
        self,
        primitive: dict[str, Any],
        factor: Sequence[float],
        weights: Sequence[float],
        unpacked: Unpacked | None,
    ) -> Part:
        used = primitive["attributes"]
        colored = "COLOR_0" in used
        points = self._values(used, "POSITION", unpacked)[:, :3]
        points = morphed(points, "POSITION", primitive, weights, self._buffers)
        color = texture = None
        if colored or tuple(factor) != _WHITE:
            color = np.tile(_WHITE, (len(points), 1))
            if colored:
                given = self._values(used, "COLOR_0", unpacked)
                given = morphed(given, "COLOR_0", primitive, weights, self._buffers)
                color[:, : given.shape[1]] = given
            color = color * factor
        if "TEXCOORD_0" in used:
            texture = self._values(used, "TEXCOORD_0", unpacked)
        self._buffers.claim(points.size, "points")
        normal = self._normals(used, unpacked, len(points)) if "NORMAL" in used else None
        if normal is not None and any(weights):
            normal = None
        return Part(points, np.empty((0, 3), np.int64), color, texture, normal)

    def _normals(
        self, used: dict[str, int], unpacked: Unpacked | None, count: int
    ) -> Floats | None:
        """Return the normals of a part's vertices; None where they are damaged: few want them."""
        try:
            normal = self._values(used, "NORMAL", unpacked)
        except (MeshdepictError, LookupError, ValueError):
            return None
        return normal if normal.shape == (count, 3) else None

    def _values(self, used: dict[str, int], name: str, unpacked: Unpacked | None) -> Floats:
        """Return an attribute of all vertices; colours as fractions whatever their type."""
        fractions = name == "COLOR_0"
        if unpacked is None or name not in unpacked.values:
            values = self._buffers.accessor(used[name], fractions=fractions)
        else:
            values = unpacked.values[name]
            if fractions or pick(self._header, "accessors", used[name]).get("normalized"):
                values = as_fractions(values)
        return values.astype(np.float64)

    def _faces(
        self, primitive: dict[str, Any], count: int, unpacked: Unpacked | None
    ) -> NDArray[np.int64]:
        if unpacked is not None:
            index = unpacked.faces.reshape(-1)
        elif "indices" in primitive:
            index = self._buffers.indices(primitive["indices"])[:, 0]
        else:
            index = np.arange(count)
        wrong = (index < 0) | (index >= count)
        if wrong.any():
            raise MeshdepictError(
                f"has a glTF index of {index[np.argmax(wrong)]} with only {count} points"
            )
        self._buffers.claim(3 * len(index), "triangles")
        mode = primitive.get("mode", _TRIANGLES)
        if mode == _STRIP and unpacked is None:
            return strip_triangles(Polygons(index, np.array([0, len(index)])))[0]
        if mode == _FAN:
            first = np.broadcast_to(index[:1], max(len(index) - 2, 0))
            return np.stack((first, index[1:-1], index[2:]), axis=1)
        return index[: len(index) // 3 * 3].reshape(-1, 3)

    def _material_color(self, primitive: dict[str, Any]) -> tuple[float, ...]:
        """Return the factor (red, green, blue, alpha) of a primitive's colours."""
        if "material" not in primitive:
            return _WHITE
        material = pick(self._header, "materials", primitive["material"])
        factor = material.get("pbrMetallicRoughness", {}).get("baseColorFactor")
        if factor is None:
            glossy = material.get("extensions", {}).get(_GLOSSINESS, {})
            factor = glossy.get("diffuseFactor", _WHITE)
        given = tuple(map(float, factor))
        return given + _WHITE[len(given) :]


def _cofactors(matrix: Floats) -> Floats:
    """Return what normals are multiplied by where points are by a matrix, but for their length."""
    a, b, c = matrix[:3, :3] / (np.abs(matrix[:3, :3]).max() or 1.0)
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])


def _mirrors(matrix: Floats) -> bool:
    largest = np.abs(matrix[:3, :3]).max()
    return bool(largest > 0 and np.linalg.det(matrix[:3, :3] / largest) < 0)
