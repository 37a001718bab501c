"""A depiction as a scene of its own in a glTF file, beside the scenes that were there.

Viewers can switch scenes, or a material, but no vertex colours: so the file's own scene stays as it
was, and another one, shown first, has the same triangles in unlit colours. It takes positions and
indices from where they are in the file. What was added is marked, so that it can be replaced.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.images.encoded import KINDS
from meshdepict.io.gltf_buffers import COMPONENTS
from meshdepict.io.gltf_scene import Part
from meshdepict.io.ply_properties import exact_float

if TYPE_CHECKING:
    from meshdepict.shapes.textures import Texture

__all__ = ["UNLIT", "Additions", "Laid", "depict", "undepicted"]

Floats = NDArray[np.float64]

UNLIT = "KHR_materials_unlit"
WEBP = "EXT_texture_webp"
_QUANTIZED = "KHR_mesh_quantization"
_COMPONENT_TYPES = {kind: number for number, kind in COMPONENTS.items()}
_LINEAR, _LINEAR_MIPMAPS = 9729, 9987
_WRAPS = {"repeat": 10497, "clamp": 33071, "mirror": 33648}
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_LISTS = (
    "scenes", "nodes", "meshes", "materials", "textures", "samplers", "images", "accessors",
    "bufferViews", "buffers",
)  # fmt: skip
_MARK = "meshdepict"
_ORIGINAL = "original"
_SQUARE = 1e-6  # how far axes may be from right angles where a node's matrix has them


class Additions:
    """What is added to a header: entries of its lists, and a buffer of its own.

    Parameters
    ----------
    header : dict
        Changed by what is added.
    """

    def __init__(self, header: dict[str, Any]) -> None:
        self.header = header
        self.buffer = len(header.setdefault("buffers", []))
        header["buffers"].append({"byteLength": 0})
        self.parts: list[bytes] = []
        self._length = 0

    def add(self, name: str, entry: dict[str, Any]) -> int:
        """Add an entry to one of the header's lists; return its number."""
        listed = self.header.setdefault(name, [])
        listed.append(entry)
        return len(listed) - 1

    def view(self, data: bytes, **more: int) -> int:
        """Add bytes as a buffer view; return its number."""
        described = {"buffer": self.buffer, "byteOffset": self._length, "byteLength": len(data)}
        self.parts.append(data + b"\0" * (-len(data) % 4))
        self._length += len(self.parts[-1])
        self.header["buffers"][self.buffer]["byteLength"] = self._length
        return self.add("bufferViews", described | more)

    def accessor(self, array: NDArray[Any], *, indices: bool = False, **more: Any) -> int:
        """Add numbers (n, k) as an accessor, rows at multiples of four bytes; return its number."""
        count, components = array.shape
        width = array.itemsize * components
        views: dict[str, int] = {"target": _ELEMENT_BUFFER if indices else _ARRAY_BUFFER}
        data = array
        if width % 4 and not indices:
            data = np.zeros((count, (width + 3) // 4 * 4), np.uint8)
            data[:, :width] = np.ascontiguousarray(array).view(np.uint8).reshape(count, width)
            views["byteStride"] = data.shape[1]
        described = {
            "bufferView": self.view(data.tobytes(), **views),
            "componentType": _COMPONENT_TYPES[array.dtype.str[1:]],
            "type": "SCALAR" if components == 1 else f"VEC{components}",
            "count": count,
        }
        return self.add("accessors", described | more)

    def uses(self, extension: str, *, required: bool = False) -> None:
        """Name an extension."""
        for name in ("extensionsUsed", *(("extensionsRequired",) if required else ())):
            listed = self.header.setdefault(name, [])
            if extension not in listed:
                listed.append(extension)


class Laid(NamedTuple):
    """A picture on points.

    Attributes
    ----------
    picture : Texture
    texcoords : (n, 2) array
        v up.
    mipmaps : bool
        Whether smaller copies of the picture are of any use.
    """

    picture: Texture
    texcoords: Floats
    mipmaps: bool = True


def depict(
    additions: Additions, parts: Iterable[Part], colors: NDArray[np.uint16] | None, *,
    quantize: bool, title: str = "", texture: Laid | None = None,
) -> None:  # fmt: skip
    """Add a scene of the parts in unlit colours, or with a texture, and show it first.

    Parameters
    ----------
    additions : Additions
    parts : iterable of Part
    colors : (n, 4) array or None
        Of all parts' points, linear.
    quantize : bool
        Whether positions that have to be written are whole numbers of 16 bits.
    title : str
        Of the scene, where others are beside it; "" where it is the only one.
    texture : Laid, optional
        On the parts' points.
    """
    header = additions.header
    before = {name: len(header[name]) for name in _LISTS if name in header}
    before["buffers"] -= 1  # the additions' own
    former = {"scene": header.get("scene")}
    extensions = {
        name: list(header[name]) for name in ("extensionsUsed", "extensionsRequired")
        if name in header
    }  # fmt: skip
    if title:
        former["named"] = _name_original(header)
    additions.uses(UNLIT)
    shown: dict[str, Any] = {"extensions": {UNLIT: {}}, "doubleSided": True}
    if texture is not None:
        shown["pbrMetallicRoughness"] = {
            "baseColorTexture": {"index": _picture(additions, texture)}
        }
    material = additions.add("materials", shown)
    nodes, first = [], 0
    for part in parts:
        count = len(part.points)
        node, primitives = _shared(part) or _fresh(additions, part, quantize=quantize)
        color = None
        if colors is not None:
            color = additions.accessor(colors[first : first + count], normalized=True)
        place = None
        if texture is not None:  # v downwards, as the standard wants
            at = texture.texcoords[first : first + count] * (1, -1) + (0, 1)
            place = additions.accessor(at.astype("<f4"))
        first += count
        for primitive in primitives:
            primitive["material"] = material
            if color is not None:
                primitive["attributes"]["COLOR_0"] = color
            if place is not None:
                primitive["attributes"]["TEXCOORD_0"] = place
        node["mesh"] = additions.add("meshes", {"primitives": primitives})
        nodes.append(additions.add("nodes", node))
    scene: dict[str, Any] = {"nodes": nodes}
    if title:
        after = {name: len(header[name]) + (name == "scenes") for name in _LISTS if name in header}
        scene |= {"name": title}
        scene["extras"] = {
            _MARK: {"before": before, "after": after, "former": former, "extensions": extensions}
        }
    header["scene"] = additions.add("scenes", scene)


def _picture(additions: Additions, texture: Laid) -> int:
    """Add a picture with its sampler as a texture; return its number."""
    picture = texture.picture
    assert picture.encoded is not None
    image = {
        "bufferView": additions.view(picture.encoded),
        "mimeType": KINDS[picture.kind][0],
        "name": picture.name,
    }
    sampler = {
        "magFilter": _LINEAR,
        "minFilter": _LINEAR_MIPMAPS if texture.mipmaps else _LINEAR,
        "wrapS": _WRAPS[picture.wrap[0]],
        "wrapT": _WRAPS[picture.wrap[1]],
    }
    source: dict[str, Any] = {"source": additions.add("images", image)}
    if picture.kind == "webp":  # and no other picture for who can't read that
        additions.uses(WEBP, required=True)
        source = {"extensions": {WEBP: source}}
    return additions.add("textures", {"sampler": additions.add("samplers", sampler), **source})


def _name_original(header: dict[str, Any]) -> bool:
    """Give the file's own scene a name for people to choose by; return whether it had none."""
    if not header.get("scenes"):
        nodes = header.get("nodes", [])
        children = {child for node in nodes for child in node.get("children", ())}
        header["scenes"] = [{"nodes": [at for at in range(len(nodes)) if at not in children]}]
    scene = header["scenes"][header.get("scene", 0)]
    if scene.get("name"):
        return False
    scene["name"] = _ORIGINAL
    return True


def _shared(part: Part) -> tuple[dict[str, Any], list[dict[str, Any]]] | None:
    """Return a node and primitives that draw a part from where it is; None where that can't be."""
    source = part.source
    if source is None or source.matrix is None:
        return None
    axes = source.matrix[:3, :3].T
    lengths = np.linalg.norm(axes, axis=1)
    if not (lengths > 0).all():
        return None
    angles = (axes / lengths[:, None]) @ (axes / lengths[:, None]).T - np.eye(3)
    if np.abs(angles).max() > _SQUARE:  # sheared: no node may have such a matrix
        return None
    primitives = []
    for given in source.primitives:
        primitive: dict[str, Any] = {"attributes": {"POSITION": given["attributes"]["POSITION"]}}
        primitive |= {name: given[name] for name in ("indices", "mode") if name in given}
        primitives.append(primitive)
    same = np.array_equal(source.matrix, np.eye(4))
    return ({} if same else {"matrix": source.matrix.T.reshape(-1).tolist()}), primitives


def _fresh(
    additions: Additions, part: Part, *, quantize: bool
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return a node and a primitive of a part's points and triangles, written anew.

    Single precision, as the standard wants: relative to the node's translation where digits would
    be lost otherwise.
    """
    points = part.points
    node: dict[str, Any] = {}
    if quantize:
        stored, node = _whole(points)
        additions.uses(_QUANTIZED, required=True)
    else:
        if exact_float(points) != "f4":
            centre = points.min(axis=0) / 2 + points.max(axis=0) / 2
            node = {"translation": centre.tolist()}
            points = points - centre
        stored = points.astype("<f4")
    box = {"min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist()}
    small = quantize and len(points) < 65_535
    index = part.faces.astype("<u2" if small else "<u4").reshape(-1, 1)
    primitive = {
        "attributes": {"POSITION": additions.accessor(stored, **box)},
        "indices": additions.accessor(index, indices=True),
    }
    return node, [primitive]


def _whole(points: Floats) -> tuple[NDArray[np.uint16], dict[str, Any]]:
    """Return points as whole numbers of 16 bits, and the node that puts them at their place."""
    low = points.min(axis=0)
    step = float((points.max(axis=0) - low).max()) / 65535 or 1.0
    whole = np.rint((points - low) / step).astype("<u2")
    return whole, {"translation": low.tolist(), "scale": [step] * 3}


# --- taking it out again ------------------------------------------------------------------------


def undepicted(header: dict[str, Any], chunk: bytes) -> tuple[dict[str, Any], bytes] | None:
    """Return a file's header and chunk without the scene that `depict` added, None without one.

    Also None where another program has moved things since.
    """
    scenes = header.get("scenes")
    last = scenes[-1] if isinstance(scenes, list) and scenes else None
    extras = last.get("extras") if isinstance(last, dict) else None
    mark = extras.get(_MARK) if isinstance(extras, dict) else None
    if not isinstance(mark, dict):
        return None
    try:
        return _without(header, chunk, mark)
    except (AttributeError, LookupError, TypeError, ValueError):
        return None


def _without(
    header: dict[str, Any], chunk: bytes, mark: dict[str, Any]
) -> tuple[dict[str, Any], bytes] | None:
    before, after, former = mark["before"], mark["after"], mark["former"]
    found = dict(header)
    for name in _LISTS:
        if name not in after:
            continue
        count = before.get(name, 0)
        if len(header[name]) != after[name] or not 0 <= count <= after[name]:
            return None
        found[name] = list(header[name][:count])
        if not count:
            del found[name]
    for name in ("extensionsUsed", "extensionsRequired"):
        found.pop(name, None)
        if name in mark["extensions"]:
            found[name] = list(mark["extensions"][name])
    found.pop("scene")
    if former["scene"] is not None:
        found["scene"] = former["scene"]
        if not 0 <= former["scene"] < len(found["scenes"]):
            return None
    if former["named"] and "scenes" in found:
        at = found.get("scene", 0)
        found["scenes"][at] = {k: v for k, v in found["scenes"][at].items() if k != "name"}
    if "bytes" in mark:
        size = int(mark["bytes"])
        if not 0 <= size <= len(chunk):
            return None
        chunk = chunk[:size]
        found["buffers"][0] = found["buffers"][0] | {"byteLength": size}
    return found, chunk
