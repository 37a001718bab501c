"""Extensions of glTF: which may be left aside, which are read, and what Draco compressed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError

__all__ = ["DRACO", "INSTANCING", "VISIBILITY", "Unpacked", "check_required", "draco"]

DRACO = "KHR_draco_mesh_compression"
INSTANCING = "EXT_mesh_gpu_instancing"
VISIBILITY = "KHR_node_visibility"
_COMPRESSED = ("EXT_meshopt_compression", "KHR_meshopt_compression")

# Honoured, or about what is no triangle and no colour of a vertex: light, texture, meaning.
_KNOWN = {
    DRACO, INSTANCING, VISIBILITY, "KHR_mesh_quantization",
    "KHR_animation_pointer", "KHR_lights_punctual", "KHR_node_hoverability",
    "KHR_node_selectability", "KHR_texture_basisu", "KHR_texture_transform", "KHR_xmp",
    "KHR_xmp_json_ld", "EXT_instance_features", "EXT_lights_ies", "EXT_lights_image_based",
    "EXT_mesh_features", "EXT_mesh_manifold", "EXT_primitive_voxels_metadata",
    "EXT_structural_metadata", "EXT_texture_avif", "EXT_texture_webp", "CESIUM_primitive_outline",
    "FB_ngon_encoding", "MSFT_lod", "MSFT_texture_dds",
}  # fmt: skip
_MATERIALS = "KHR_materials_"  # how a surface answers light: what shading replaces


class Unpacked(NamedTuple):
    """A primitive that was compressed: triangles, and values by the attribute's name."""

    faces: NDArray[np.int64]
    values: dict[str, NDArray[Any]]


def check_required(names: Iterable[str]) -> None:
    """Refuse a file that can't be understood without what isn't known here.

    Raises
    ------
    MeshdepictError
        With the extension's name.
    """
    for name in names:
        if name in _COMPRESSED:
            raise MeshdepictError(
                f"is compressed ({name}), which is not read; export it uncompressed"
            )
        if name == DRACO:
            _decoder()
        elif name not in _KNOWN and not str(name).startswith(_MATERIALS):
            raise MeshdepictError(
                f"needs the glTF extension {name!r:.80}, which is not known here: export it "
                "without that"
            )


def _decoder() -> Any:
    try:
        import DracoPy
    except ImportError:
        raise MeshdepictError(
            f"is compressed ({DRACO}), which needs DracoPy: pip install 'meshdepict[gltf]', or "
            "export it uncompressed"
        ) from None
    return DracoPy


def draco(data: bytes, attributes: Mapping[str, int]) -> Unpacked:
    """Return what Draco compressed.

    Parameters
    ----------
    data : bytes
    attributes : mapping
        The attributes' names, and their numbers in the compressed data.

    Raises
    ------
    MeshdepictError
        Where DracoPy is missing, or refuses the data.
    """
    decoder = _decoder()
    try:
        found = decoder.decode(data)
        faces = np.asarray(found.faces).astype(np.int64).reshape(-1, 3)
    except Exception as error:  # of DracoPy's own kinds
        raise MeshdepictError(f"is damaged: its Draco part can't be decoded ({error})") from error
    values = {}
    for name, number in attributes.items():
        attribute = found.get_attribute_by_unique_id(number)
        if attribute is None:
            raise MeshdepictError(f"is damaged: its Draco part has no attribute {name!r:.40}")
        array = np.asarray(attribute["data"])
        values[name] = array.reshape(len(array), -1)
    return Unpacked(faces, values)
