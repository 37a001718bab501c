"""GLB and glTF as files: all in one, or with buffers and pictures where they were, beside."""

from __future__ import annotations

import base64
import json
import struct
from typing import TYPE_CHECKING, Any, BinaryIO
from urllib.parse import quote, unquote

from meshdepict.errors import MeshdepictError
from meshdepict.images.encoded import KINDS, kind_of
from meshdepict.io.texture_files import named_texture

if TYPE_CHECKING:
    from meshdepict.files.companions import Companions
    from meshdepict.io.gltf_buffers import Buffers

__all__ = ["BIN", "JSON", "embed_pictures", "write_glb", "write_gltf"]

JSON, BIN = b"JSON", b"BIN\0"

Contents = dict[int, bytes]  # of buffers by number


def write_glb(
    file: BinaryIO, header: dict[str, Any], fresh: Contents, buffers: Buffers | None = None
) -> None:
    """Write one file with all buffers in it.

    Parameters
    ----------
    file : binary file
    header : dict
        Changed: its buffers become one.
    fresh : dict
        Contents of buffers that are new.
    buffers : Buffers, optional
        Those of the file that the header comes from.
    """
    parts: list[bytes] = []
    length = 0
    moved: dict[int, tuple[int, int]] = {}  # which buffer it is now, and where it begins there
    kept: list[dict[str, Any]] = [{}]
    for number, buffer in enumerate(header["buffers"]):
        content = fresh.get(number)
        if content is None and buffers is not None:
            try:
                content = buffers.content(number)[: buffer.get("byteLength")]
            except MeshdepictError:  # it has none, or its file has gone: as it was
                moved[number] = len(kept), 0
                kept.append(buffer)
                continue
        assert content is not None
        moved[number] = 0, length
        parts.append(content + b"\0" * (-len(content) % 8))
        length += len(parts[-1])
    for view in header.get("bufferViews", []):
        for described in (view, *view.get("extensions", {}).values()):
            if isinstance(described, dict) and described.get("buffer") in moved:
                described["buffer"], start = moved[described["buffer"]]
                if start or "byteOffset" in described:
                    described["byteOffset"] = described.get("byteOffset", 0) + start
    mark = _mark(header)
    if mark is not None:  # for taking it out again
        last = max(fresh)
        mark["bytes"] = moved[last][1]
        mark["before"]["buffers"] = mark["after"]["buffers"] = len(kept)
    kept[0] = {"byteLength": length}
    header["buffers"] = kept
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    file.write(b"glTF" + struct.pack("<II", 2, 12 + 8 + len(text) + 8 + length))
    file.write(struct.pack("<I", len(text)) + JSON + text)
    file.write(struct.pack("<I", length) + BIN)
    file.writelines(parts)


def _mark(header: dict[str, Any]) -> dict[str, Any] | None:
    """Return what the depiction's scene says about itself, None where it is the only one."""
    extras = header["scenes"][header["scene"]].get("extras") if "scene" in header else None
    found = extras.get("meshdepict") if isinstance(extras, dict) else None
    return found if isinstance(found, dict) else None


def embed_pictures(header: dict[str, Any], fresh: Contents, buffers: Buffers) -> None:
    """Put pictures that lie beside a file into a new buffer of it; those that can't be had stay."""
    parts: list[bytes] = []
    length, number = 0, len(header["buffers"])
    for image in header.get("images", []):
        uri = image.get("uri")
        if not isinstance(uri, str) or uri.startswith("data:"):
            continue
        picture = named_texture(buffers.folder, unquote(uri), ("repeat", "repeat"))
        kind = kind_of(picture.encoded or b"")
        if picture.encoded is None or kind not in KINDS:
            continue
        view = {"buffer": number, "byteOffset": length, "byteLength": len(picture.encoded)}
        parts.append(picture.encoded + b"\0" * (-len(picture.encoded) % 4))
        length += len(parts[-1])
        header.setdefault("bufferViews", []).append(view)
        image |= {"bufferView": len(header["bufferViews"]) - 1, "mimeType": KINDS[kind][0]}
        image.setdefault("name", unquote(uri))
        del image["uri"]
    if parts:
        fresh[number] = b"".join(parts)
        header["buffers"].append({"byteLength": length})


def write_gltf(
    file: BinaryIO, header: dict[str, Any], fresh: Contents, buffers: Buffers | None,
    companions: Companions | None,
) -> None:  # fmt: skip
    """Write the header as text: new buffers within it, the others and pictures where they were.

    Parameters
    ----------
    file, header, fresh, buffers
        As for `write_glb`.
    companions : Companions or None
        Take files that the header names along to another folder.
    """
    for number, buffer in enumerate(header["buffers"]):
        content = fresh.get(number)
        if content is None and buffers is not None and "uri" not in buffer:
            try:
                content = buffers.content(number)
            except MeshdepictError:  # it never had one
                continue
        if content is not None:
            inline = base64.b64encode(content).decode()
            buffer["uri"] = f"data:application/octet-stream;base64,{inline}"
    if buffers is not None and companions is not None:
        for named in (*header["buffers"], *header.get("images", [])):
            uri = named.get("uri")
            if isinstance(uri, str) and not uri.startswith("data:"):
                name = unquote(uri)
                called = companions.copied(buffers.folder, name)
                if called != name:
                    named["uri"] = quote(called)
    file.write(json.dumps(header).encode())
