"""A glTF scene: meshes, their materials and their places, taken apart into lists of triangles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.gltf_buffers import Buffers, as_fractions, pick
from meshdepict.io.gltf_extensions import DRACO, Unpacked, check_required, draco
from meshdepict.io.gltf_materials import WHITE, Laid, base_factor, is_textured, laid
from meshdepict.io.gltf_pose import cofactors, instances, mirrors, morphed, placed, skinned
from meshdepict.surface.polygons import Polygons, strip_triangles

__all__ = ["Part", "Scene"]

Floats = NDArray[np.float64]

_TRIANGLES, _STRIP, _FAN = 4, 5, 6


class Part(NamedTuple):
    """Triangles that share one list of points."""

    points: Floats
    faces: NDArray[np.int64]
    color: Floats | None  # (n, 4) linear, with alpha
    texture: Floats | None  # (n, 2)
    normal: Floats | None = None  # (n, 3), of what neither morphs nor bends
    material: NDArray[np.int32] | None = None  # of every triangle, −1 none; where asked for
    uv: Floats | None = None  # (m, 3, 2) of every corner's base colour, NaN where it has none
    normal_uv: Floats | None = None  # and of its normal map
    source: Source | None = None  # None of what isn't drawn as it stands in the file


class Source(NamedTuple):
    """Where a part stands in its file: primitives that share their points, and their place."""

    primitives: tuple[dict[str, Any], ...]
    matrix: Floats | None = None


class Scene:
    """The scene that a glTF header describes.

    Parameters
    ----------
    header : dict
        The JSON part. Where it doesn't follow the standard, reading raises what Python raises.
    buffers : Buffers
        Of the same header.
    textured : bool
        Whether parts say which material their triangles have, and where its textures lie.

    In a scene with textures, factors of base colours stay with them: points are not coloured.
    """

    def __init__(self, header: dict[str, Any], buffers: Buffers, *, textured: bool = False) -> None:
        check_required(header.get("extensionsRequired", ()))
        self._header = header
        self._buffers = buffers
        self._buffers.forget_claims()
        self._textured = textured
        self._factors = not is_textured(header)
        self._parts: dict[int, list[Part]] = {}

    def extras(self) -> list[str]:
        """Name what the file has beside triangles and their colours."""
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
                    found += [
                        self._moved(part, matrix @ instance)._replace(source=None)
                        for instance in several
                    ]
        if not found and DRACO in self._header.get("extensionsRequired", ()):
            raise MeshdepictError(f"is compressed ({DRACO}), but holds no mesh")
        return found

    def _moved(self, part: Part, matrix: Floats) -> Part:
        """Return a part at its place; a mirror turns its faces round."""
        self._buffers.claim(part.points.size + part.faces.size, "triangles at its nodes")
        points = part.points @ matrix[:3, :3].T + matrix[:3, 3]
        turned = mirrors(matrix)
        normal = part.normal
        if normal is not None:
            normal = normal @ cofactors(matrix).T * (-1 if turned else 1)
        source = part.source and part.source._replace(matrix=matrix)
        part = part._replace(points=points, normal=normal, source=source)
        if not turned:
            return part
        uv, normal_uv = (None if uv is None else uv[:, ::-1] for uv in (part.uv, part.normal_uv))
        return part._replace(faces=part.faces[:, ::-1], uv=uv, normal_uv=normal_uv)

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
        pieces: dict[tuple[Any, ...], list[Piece]] = {}
        for primitive in mesh["primitives"]:
            if primitive.get("mode", _TRIANGLES) < _TRIANGLES:
                continue
            used = primitive["attributes"]
            packed = primitive.get("extensions", {}).get(DRACO)
            morphs = tuple(str(target) for target in primitive.get("targets", ()))
            material = self._material(primitive)
            factor = base_factor(material) if self._factors else WHITE
            key = (
                *(used.get(name) for name in ("POSITION", "COLOR_0", "TEXCOORD_0", "NORMAL")),
                *factor, packed and packed["bufferView"], morphs,
            )  # fmt: skip
            unpacked = self._unpacked(primitive, packed) if packed else None
            if key not in shared:
                part = self._part(primitive, factor, weights, unpacked)
                if skin is not None and "JOINTS_0" in used:
                    points = skinned(part.points, used, skin, places or {}, self._buffers)
                    part = part._replace(points=points, normal=None, source=None)
                shared[key] = part
            index = self._faces(primitive, len(shared[key].points), unpacked)
            base = normal = None
            if self._textured:
                lays = [laid(material, kind) for kind in (0, 1)]
                base, normal = (self._uv(used, lay, index, unpacked) for lay in lays)
            pieces.setdefault(key, []).append(Piece(primitive, index, base, normal))
        return [_assembled(part, pieces[key]) for key, part in shared.items()]

    def _uv(
        self,
        used: dict[str, int],
        lay: Laid | None,
        faces: NDArray[np.int64],
        unpacked: Unpacked | None,
    ) -> Floats:
        """Return the coordinates (m, 3, 2) of triangles' corners, NaN where there are none."""
        name = "" if lay is None else f"TEXCOORD_{lay.coordinates}"
        self._buffers.claim(2 * faces.size, "texture coordinates")
        if lay is None or name not in used:
            return np.full((len(faces), 3, 2), np.nan)
        uv = self._values(used, name, unpacked)
        if uv.ndim != 2 or uv.shape[1] != 2 or (faces.size and faces.max() >= len(uv)):
            raise MeshdepictError(f"is wrong as glTF: its {name} don't fit its points")
        return np.asarray(lay.moved(uv)[faces])

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
        if colored or tuple(factor) != WHITE:
            color = np.tile(WHITE, (len(points), 1))
            if colored:
                given = self._values(used, "COLOR_0", unpacked)
                given = morphed(given, "COLOR_0", primitive, weights, self._buffers)
                color[:, : given.shape[1]] = given
            color = color * factor
        if "TEXCOORD_0" in used:
            texture = self._optional(used, "TEXCOORD_0", unpacked, (len(points), 2))
        self._buffers.claim(points.size, "points")
        normal = None
        if "NORMAL" in used:
            normal = self._optional(used, "NORMAL", unpacked, (len(points), 3))
        if normal is not None and any(weights):
            normal = None
        plain = unpacked is None and not any(weights)
        return Part(
            points, np.empty((0, 3), np.int64), color, texture, normal,
            source=Source(()) if plain else None,
        )  # fmt: skip

    def _optional(
        self, used: dict[str, int], name: str, unpacked: Unpacked | None, shape: tuple[int, int]
    ) -> Floats | None:
        """Return what few want of a part's vertices; None where it is damaged."""
        try:
            values = self._values(used, name, unpacked)
        except (MeshdepictError, LookupError, ValueError):
            return None
        return values if values.shape == shape else None

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

    def _material(self, primitive: dict[str, Any]) -> dict[str, Any]:
        if "material" not in primitive:
            return {}
        found: dict[str, Any] = pick(self._header, "materials", primitive["material"])
        return found


class Piece(NamedTuple):
    """The triangles of a primitive among those that share their points."""

    primitive: dict[str, Any]
    faces: NDArray[np.int64]
    uv: Floats | None
    normal_uv: Floats | None


def _assembled(part: Part, pieces: list[Piece]) -> Part:
    part = part._replace(faces=np.concatenate([piece.faces for piece in pieces]))
    if part.source is not None:
        part = part._replace(source=Source(tuple(piece.primitive for piece in pieces)))
    if pieces[0].uv is None:
        return part
    material = [piece.primitive.get("material", -1) for piece in pieces]
    uv, normal_uv = (np.concatenate([piece[at] for piece in pieces]) for at in (2, 3))
    counts = [len(piece.faces) for piece in pieces]
    return part._replace(
        material=np.repeat(np.array(material, np.int32), counts), uv=uv, normal_uv=normal_uv
    )
