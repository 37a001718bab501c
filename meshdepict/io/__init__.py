"""Reading and writing meshes: PLY, OBJ, OFF, STL, GLB, glTF and VTP, each also as ``.gz``.

`volumes` reads and writes volumes, `heightfields` reads terrain.
"""

from __future__ import annotations

import gzip
import importlib
import os
import struct
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.any_numbers import any_numbers, quiet
from meshdepict.files.atomic import atomic_write
from meshdepict.files.companions import Companions
from meshdepict.files.mark import MARK
from meshdepict.files.reach import regular
from meshdepict.io.source import FORMATS, WRITABLE, format_of, opened, suffix_of, unmarked
from meshdepict.io.tiff_pages import TIFF_MARKS
from meshdepict.shapes.document import Contents, Document, Saving

if TYPE_CHECKING:
    from collections.abc import Iterable

    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.volume import Volume

# What damage that nobody thought of makes the parts of a reader raise.
_UNFORESEEN = (
    ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError,
    struct.error,
)  # fmt: skip

__all__ = ["atomic_write", "read", "read_mesh", "read_provenance", "write_mesh"]


def read(path: str | os.PathLike[str], *, winding: str = "auto") -> Mesh | HeightField | Volume:
    """Read whatever a file or a folder holds, by its content and its suffix.

    A mesh as `read_mesh` does (see there for `winding`), a volume as `volumes.read_volume`, or a
    terrain as `heightfields.read_heightfield`, which know more to choose and say what can go
    wrong. A ``.tif`` that says where on a map it lies is a terrain, a stack of pages a volume.
    """
    from meshdepict.io.height_formats import is_single_page, is_tiff_path
    from meshdepict.io.heightfields import is_heightfield_path, read_heightfield
    from meshdepict.io.volumes import is_volume_path, read_volume

    regular(path)
    if is_heightfield_path(path):
        return read_heightfield(path)
    if is_volume_path(path):
        return read_volume(path)
    if is_tiff_path(path):
        if is_single_page(Path(path)):
            raise MeshdepictError(
                f"{path} is a single picture, neither a terrain nor a stack of slices: for slices "
                "give their folder"
            )
        return read_volume(path)
    return read_mesh(path, winding=winding)


def read_mesh(path: str | os.PathLike[str], *, winding: str = "auto") -> Mesh:
    """Read a mesh.

    Vertex colours become the vertex attributes ``red``, ``green`` and ``blue``: in the file's own
    type from PLY, as 8-bit sRGB from other formats.

    Parameters
    ----------
    path : str or path-like
        A PLY, OBJ, OFF, STL, GLB, glTF or VTP file, gzipped or not.
    winding : {"auto", "keep"}
        As for `Mesh`.

    Returns
    -------
    Mesh
        Its ``document`` lets `write_mesh` keep what the file held beside the mesh.

    Raises
    ------
    MeshdepictError
        For a file that is missing, forbidden, empty, cut off, damaged or of an unknown format, and
        for a mesh that `Mesh` refuses: one sentence that begins with the file's name.
    """
    from meshdepict.shapes.mesh import Mesh

    with opened(path) as file:
        data = file.read()
    contents = _decoded(data, path)
    try:
        return Mesh(
            contents.vertices,
            contents.faces,
            attributes=contents.attributes,
            winding=winding,
            document=contents.document,
            length_unit=contents.length_unit,
        )
    except MeshdepictError as error:
        raise MeshdepictError(f"{path}: {error}") from error


def write_mesh(
    path: str | os.PathLike[str],
    mesh: Mesh,
    *,
    colors: ArrayLike | None = None,
    comments: Iterable[str] = (),
    keep_colors: bool = True,
    quantize: bool = False,
) -> None:
    """Write a mesh, wholly or not at all, in the format that the suffix names.

    A mesh that was read from the same format keeps all that its file held; in another folder,
    materials and pictures that it names are copied beside it.

    Parameters
    ----------
    path : str or path-like
        Ends in .ply, .obj, .off, .glb, .gltf or .vtp, or one of these and .gz.
    mesh : Mesh
    colors : (n, 3) array_like of uint8, optional
        New sRGB colours of the vertices.
    comments : iterable of str
        Lines of provenance, each beginning with ``"meshdepict "``; they replace earlier ones.
    keep_colors : bool
        Whether PLY and VTP keep the colours that new ones replace as ``original_red``, …
    quantize : bool
        Whether .glb and .gltf hold positions in 16 bits, where they are written anew.

    Raises
    ------
    MeshdepictError
        For an unknown suffix, STL (which holds no colours), wrong colours, and every failure to
        write: no such folder, no permission, no space left.
    """
    suffix = suffix_of(path)
    if suffix == ".stl":
        raise MeshdepictError(f"{path}: STL can't hold colours; save as .ply instead")
    if suffix not in WRITABLE:
        raise MeshdepictError(
            f"{path}: meshes are not saved as {suffix or 'a file without suffix'}; "
            f"use one of {', '.join(WRITABLE)} (also with .gz)"
        )
    if quantize and suffix not in (".glb", ".gltf"):
        raise MeshdepictError(f"{path}: quantised positions are for .glb and .gltf alone")
    companions = Companions(path)
    saving = Saving(
        _checked_colors(colors, mesh), _checked_comments(comments), keep_colors, suffix,
        companions, quantize,
    )  # fmt: skip
    module = _module(FORMATS[suffix])
    _tell_of_extras(path, mesh, saving)
    with atomic_write(path) as file, any_numbers():
        if Path(path).suffix.lower() == ".gz":
            # Without name and time the same mesh gives the same bytes.
            with gzip.GzipFile("", "wb", 6, file, mtime=0) as packed:
                module.encode(cast("BinaryIO", packed), mesh, saving)
        else:
            module.encode(file, mesh, saving)
        companions.write()


def read_provenance(path: str | os.PathLike[str]) -> list[str] | None:
    """Return the lines that this program wrote about a file into it, None where there are none.

    Reads no further than it must: of a PLY file only the header, of a TIFF its first directory.

    Raises
    ------
    MeshdepictError
        For a file that can't be opened; not for one of another kind.
    """
    with opened(path) as file:
        start = file.peek(4096)  # type: ignore[attr-defined]
        if start[:4] in TIFF_MARKS:
            from meshdepict.io.relief_tiff import tiff_provenance

            return tiff_provenance(Path(path))
        try:
            found = _module(format_of(path, start, -1)).provenance(file)
        except MeshdepictError:  # whatever it is, this program didn't write it
            return None
    return list(found) or None


def _decoded(data: bytes, path: str | os.PathLike[str]) -> Contents:
    """Return what a file's bytes hold, or raise one sentence that begins with its name."""
    try:
        data = unmarked(data)
    except MeshdepictError as error:
        raise MeshdepictError(f"{path} {error}") from error
    name = format_of(path, data[:4096], len(data))
    try:
        with any_numbers():
            contents: Contents = _module(name).decode(data, Path(path))
    except MeshdepictError as error:  # "is cut off …": the file is its subject
        raise MeshdepictError(f"{path} {error}") from error
    except MemoryError as error:
        raise MeshdepictError(f"{path} needs more memory than there is") from error
    except _UNFORESEEN as error:
        raise MeshdepictError(
            f"{path} is damaged or not understood as {name.upper()} "
            f"({type(error).__name__}: {error})"
        ) from error
    attributes = {
        element: {name: quiet(values) for name, values in arrays.items()}
        for element, arrays in contents.attributes.items()
    }
    return contents._replace(vertices=quiet(contents.vertices), attributes=attributes)


def _module(name: str) -> Any:
    return importlib.import_module(f"meshdepict.io.{name}")


def _tell_of_extras(path: str | os.PathLike[str], mesh: Mesh, saving: Saving) -> None:
    """Warn of what is lost in another format, and of textures that hide new colours."""
    document = mesh.document
    if not isinstance(document, Document):
        return
    if saving.suffix in document.formats:
        if saving.colors is not None and document.is_textured:
            beside = "beside them, and viewers may show those: see meshdepict texture"
            where = "in a scene of its own" if ".glb" in document.formats else beside
            warnings.warn(
                f"{path}: the new colours are at vertices; its textures are kept {where}",
                MeshdepictWarning,
                stacklevel=3,
            )
    elif document.extras:
        warnings.warn(
            f"{path}: {', '.join(document.extras)} are not kept: save as {document.formats[0]} to "
            "keep them",
            MeshdepictWarning,
            stacklevel=3,
        )


def _checked_colors(colors: ArrayLike | None, mesh: Mesh) -> NDArray[np.uint8] | None:
    if colors is None:
        return None
    array = np.asarray(colors)
    wanted = (len(mesh.vertices), 3)
    if array.shape != wanted or array.dtype != np.uint8:
        raise MeshdepictError(
            f"colors must be uint8 of shape {wanted}, not {array.dtype} of shape {array.shape}"
        )
    return array


def _checked_comments(comments: Iterable[str]) -> tuple[str, ...]:
    # Names of files may hold bytes that are no text: they are spelled out.
    lines = tuple(line.encode(errors="backslashreplace").decode() for line in comments)
    for line in lines:
        if not line.startswith(MARK) or line.splitlines() != [line]:
            raise MeshdepictError(f"the comment {line!r} is not one line that begins with {MARK!r}")
    return lines
