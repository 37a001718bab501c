"""What a person chooses of a texture beside its look."""

from __future__ import annotations

from typing import Literal, get_args

__all__ = [
    "ATLASES", "CAGE", "IMAGES", "MAPS", "MOST_TEXELS", "QUALITY", "SIZE", "AtlasKind", "ImageKind",
    "MapKind",
]  # fmt: skip

AtlasKind = Literal["own", "new", "xatlas"]
"""Texture coordinates: the file's own, a new place for every triangle, or charts by xatlas."""

MapKind = Literal["color", "normal", "curvature", "occlusion"]
"""What a texture shows: the method's colours, or numbers that other programs understand."""

ImageKind = Literal["png", "jpeg", "webp"]
"""How a texture's picture is packed: exactly, or smaller."""

ATLASES: tuple[str, ...] = get_args(AtlasKind)
MAPS: tuple[str, ...] = get_args(MapKind)

IMAGES: tuple[str, ...] = get_args(ImageKind)

QUALITY = 90
"""Of JPEG and WebP unless somebody says otherwise."""

SIZE = 4096
"""Texels along the side of a texture unless somebody says otherwise."""

MOST_TEXELS = 16_384
"""… and at most: what graphics cards take."""

CAGE = "2%"
"""How far detail may be unless somebody says otherwise, of the coarse mesh's diagonal."""
