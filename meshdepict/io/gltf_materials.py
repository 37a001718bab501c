"""Materials of glTF: the factor and the pictures of a base colour, normal maps, where they lie."""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.io.gltf_buffers import Buffers, pick
from meshdepict.io.texture_files import file_fault, held_texture, named_texture
from meshdepict.shapes.textures import Texture

__all__ = ["WHITE", "Laid", "base_factor", "image_faults", "is_textured", "laid", "texture"]

Floats = NDArray[np.float64]

WHITE = (1.0, 1.0, 1.0, 1.0)
_GLOSSINESS = "KHR_materials_pbrSpecularGlossiness"
_TRANSFORM = "KHR_texture_transform"
_WRAPS = {10497: "repeat", 33071: "clamp", 33648: "mirror"}
# Where another format of the same picture is named, the likeliest to be read first.
_SOURCES = ("EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds", "KHR_texture_basisu")


@dataclass(frozen=True)
class Laid:
    """A texture as a material lays it: which one, in which coordinates, and how those move."""

    index: int
    coordinates: int = 0
    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0  # radians
    scale: tuple[float, float] = (1.0, 1.0)
    strength: float = 1.0  # of a normal map

    @property
    def place(self) -> tuple[Any, ...]:
        """What coordinates follow from: equal for textures that lie alike."""
        return self.coordinates, self.offset, self.rotation, self.scale

    def moved(self, uv: Floats) -> Floats:
        """Return coordinates (n, 2) of the file as (u, v), v up, its transform applied.

        Scaled, turned counter-clockwise as a person sees the picture, and moved.
        """
        u, v = uv[:, 0] * self.scale[0], uv[:, 1] * self.scale[1]
        cosine, sine = math.cos(self.rotation), math.sin(self.rotation)
        across = cosine * u + sine * v + self.offset[0]
        down = cosine * v - sine * u + self.offset[1]
        return np.stack((across, 1.0 - down), axis=1)


def base_factor(material: dict[str, Any]) -> tuple[float, ...]:
    """Return the factor (red, green, blue, alpha) of a material's base colour, linear."""
    factor = material.get("pbrMetallicRoughness", {}).get("baseColorFactor")
    if factor is None:
        glossy = material.get("extensions", {}).get(_GLOSSINESS, {})
        factor = glossy.get("diffuseFactor", WHITE)
    given = tuple(map(float, factor))
    return (given + WHITE[len(given) :])[:4]


def is_textured(header: dict[str, Any]) -> bool:
    """Whether a material seems to lay a base colour or a normal map, right or wrong."""
    for material in header.get("materials", ()):
        if not isinstance(material, dict):
            continue
        parts = (material.get("pbrMetallicRoughness"), material.get("extensions"))
        rough, more = (part if isinstance(part, dict) else {} for part in parts)
        glossy = more.get(_GLOSSINESS)
        if (
            "normalTexture" in material
            or "baseColorTexture" in rough
            or (isinstance(glossy, dict) and "diffuseTexture" in glossy)
        ):
            return True
    return False


def laid(material: dict[str, Any], kind: int) -> Laid | None:
    """Return how a material lays its base colour (0) or its normal map (1); None without one."""
    if kind:
        info = material.get("normalTexture")
    else:
        info = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
        if info is None:
            info = material.get("extensions", {}).get(_GLOSSINESS, {}).get("diffuseTexture")
    if info is None:
        return None
    moved = info.get("extensions", {}).get(_TRANSFORM, {})
    offset, scale = moved.get("offset", (0, 0)), moved.get("scale", (1, 1))
    return Laid(
        info["index"],
        int(moved.get("texCoord", info.get("texCoord", 0))),
        (float(offset[0]), float(offset[1])),
        float(moved.get("rotation", 0)),
        (float(scale[0]), float(scale[1])),
        float(info.get("scale", 1)) if kind else 1.0,
    )


def texture(header: dict[str, Any], buffers: Buffers, index: int) -> Texture:
    """Return a texture with its picture's bytes, or with why they can't be had."""
    described = pick(header, "textures", index)
    sampler = pick(header, "samplers", described["sampler"]) if "sampler" in described else {}
    u, v = (_WRAPS.get(sampler.get(name, 10497), "repeat") for name in ("wrapS", "wrapT"))
    source = _source(described)
    if source is None:
        fault = f"has a texture, number {index}, without a picture"
        return Texture(f"texture {index}", None, "", (u, v), fault=fault)
    image = pick(header, "images", source)
    name = str(image.get("name") or f"image {source}")
    uri = image.get("uri")
    try:
        if uri is None:
            return held_texture(name, bytes(buffers.view(image["bufferView"])), (u, v))
        if uri.startswith("data:"):
            data = base64.b64decode(uri.partition(",")[2])
            return held_texture(name, data, (u, v))
    except (MeshdepictError, LookupError, ValueError):
        fault = f"holds no picture for its texture {name!r}: that part of it is damaged"
        return Texture(name, None, "", (u, v), fault=fault)
    return named_texture(buffers.folder, unquote(uri), (u, v))


def _source(described: dict[str, Any]) -> int | None:
    """Return the image of a texture: WebP first, which stands in for what ``source`` names."""
    extensions = described.get("extensions", {})
    if "source" in extensions.get(_SOURCES[0], {}):
        return int(extensions[_SOURCES[0]]["source"])
    if "source" in described:
        return int(described["source"])
    found = [extensions[name] for name in _SOURCES if "source" in extensions.get(name, {})]
    return int(found[0]["source"]) if found else None


def image_faults(header: dict[str, Any], buffers: Buffers) -> list[str]:
    """Say which pictures that a file names beside it can't be had; none is read."""
    uris = [str(image["uri"]) for image in header.get("images", ()) if "uri" in image]
    return [file_fault(buffers.folder, unquote(uri)) for uri in uris if not uri.startswith("data:")]
