"""How a mesh looks, in bytes for a page: colours at its vertices, or textures and where they lie.

``web/appearance.js`` undoes what is done here. Places are those that `packing.pack_mesh` packs.
"""

from __future__ import annotations

import io
import json
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.viewer.packing import differences

if TYPE_CHECKING:
    from meshdepict.shapes.appearance import Appearance, Primitive
    from meshdepict.shapes.textures import Texture

__all__ = ["PackedAppearance", "pack_appearance"]

_UNIT = 1 << 20  # steps along a picture: 64 in a texel of the largest ones
_FAR = 2000  # pictures away from the first, in 32 bits
_SHOWN = ("png", "jpeg", "webp")  # what browsers read
_ORIENTATION = 0x0112  # of EXIF; browsers turn such pictures, and files of meshes don't mean it
_NARROW = 1 << 16


@dataclass(frozen=True)
class PackedAppearance:
    """What a page is sent.

    Attributes
    ----------
    info : dict
        ``parts``: of each primitive its ``vertices`` and ``faces``, whether its corners are
        ``wide`` (uint32), the number of its ``picture`` (None: white), how it is ``wrap``-ped,
        whether it has ``mipmaps``, its ``factor``, and whether vertices have ``colors``, too.
        No parts are colours of the mesh's own vertices.
    data : bytes
        Three bytes a vertex; of primitives, one after the other: which of the mesh's vertices
        theirs are (uint32) and where they lie on the picture, from its upper left corner (int32,
        `_UNIT` steps along it), then the corners of triangles, all as differences from row to row;
        then perhaps colours. Little endian.
    pictures : tuple of bytes
        Files that browsers read.
    """

    info: dict[str, Any]
    data: bytes
    pictures: tuple[bytes, ...] = ()

    @property
    def whole(self) -> bytes:
        """All in one: the length of the info (uint32), that as JSON, with `sizes`, and the rest."""
        parts = (self.data, *self.pictures)
        said = json.dumps({**self.info, "sizes": [*map(len, parts)]}).encode()
        return b"".join((struct.pack("<I", len(said)), said, *parts))


def pack_appearance(appearance: Appearance) -> PackedAppearance:
    """Pack how a mesh looks."""
    colors = appearance.colors
    if appearance.textures is None:
        assert colors is not None
        return PackedAppearance({"parts": []}, colors.tobytes())
    pictures: dict[int, tuple[int, bytes]] = {}
    parts, data = [], []
    for primitive in appearance.primitives:
        texture = primitive.texture
        number = None
        if texture is not None:
            if id(texture) not in pictures:
                pictures[id(texture)] = len(pictures), _for_browsers(texture)
            number = pictures[id(texture)][0]
        wide = len(primitive.vertices) > _NARROW
        parts.append(
            {
                "vertices": len(primitive.vertices),
                "faces": len(primitive.faces),
                "wide": wide,
                "picture": number,
                "wrap": primitive.wrap,
                "mipmaps": texture is not None and texture.mipmaps,
                "factor": primitive.factor.tolist(),
                "colors": colors is not None,
            }
        )
        corners = primitive.faces.ravel().astype("<u4" if wide else "<u2")
        data += [
            differences(primitive.vertices.astype("<u4")).tobytes(),
            differences(_places(primitive)).tobytes(),
            differences(corners).tobytes(),
        ]
        if colors is not None:
            data.append(colors[primitive.vertices].tobytes())
    files = tuple(picture for _, picture in pictures.values())
    return PackedAppearance({"unit": _UNIT, "parts": parts}, b"".join(data), files)


def _places(primitive: Primitive) -> NDArray[np.int32]:
    """Return where vertices lie on the picture, down from its top."""
    u, v = np.clip(primitive.texcoords, -_FAR, _FAR).T
    return np.rint(np.column_stack([u, 1 - v]) * _UNIT).astype("<i4")


def _for_browsers(texture: Texture) -> bytes:
    """Return a picture's file as it is, where browsers show the same pixels; else as PNG."""
    from meshdepict.images.png_files import write_png

    pixels = texture.pixels
    if texture.encoded is not None and texture.kind in _SHOWN and pixels.dtype == np.uint8:
        if not _is_turned(texture.encoded):
            return texture.encoded
    elif pixels.dtype == np.uint16:
        pixels = np.rint(pixels / 257).astype(np.uint8)
    stream = io.BytesIO()
    write_png(stream, pixels[..., :3])
    return stream.getvalue()


def _is_turned(picture: bytes) -> bool:
    from PIL import Image

    if b"Exif" not in picture[: 1 << 16] and b"eXIf" not in picture[: 1 << 16]:
        return False
    with Image.open(io.BytesIO(picture)) as image:
        return image.getexif().get(_ORIENTATION, 1) != 1
