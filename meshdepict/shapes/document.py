"""What a reader tells the writers beside the mesh, and which colours a file ends up with."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.mark import MARK
from meshdepict.surface.mesh_input import is_drawable
from meshdepict.surface.polygons import FacesLike

if TYPE_CHECKING:
    from meshdepict.files.companions import Companions
    from meshdepict.shapes.textures import Textures
    from meshdepict.surface.polygons import Polygons

__all__ = [
    "COLOR",
    "Contents",
    "Document",
    "Saving",
    "as_bytes",
    "new_names",
    "only_colors",
    "recolored",
    "restored_names",
    "same_vertices",
]

COLOR = ("red", "green", "blue")
_ORIGINALS = tuple(f"original_{channel}" for channel in COLOR)


class Contents(NamedTuple):
    """What a format's reader found: the arguments of `Mesh`."""

    vertices: NDArray[Any]
    faces: FacesLike
    attributes: Mapping[str, Mapping[str, Any]]
    document: Document
    length_unit: str = ""  # of the coordinates, where the format or the file says so


class Saving(NamedTuple):
    """How a mesh is to be saved, beside the mesh itself.

    ``companions`` take along what a file names; ``quantize`` lets glTF hold positions in 16 bits.
    """

    colors: NDArray[np.uint8] | None = None
    comments: tuple[str, ...] = ()
    keep_colors: bool = True
    suffix: str = ""
    companions: Companions | None = None
    quantize: bool = False


@dataclass(frozen=True, kw_only=True)
class Document:
    """What a file held beside its mesh.

    ``provenance`` holds the lines that this program wrote into the file. ``up`` is the axis that
    points up where the file's format has one. ``formats`` are the suffixes of files that keep what
    no other format does.
    """

    provenance: tuple[str, ...] = ()
    up: str = ""
    formats: tuple[str, ...] = ()

    @property
    def is_recolored(self) -> bool:
        """Whether the file's red, green and blue are a former bake's, not the object's.

        They are where this program wrote the file, unless it baked a texture.
        """
        textured = any(line.startswith(f"{MARK}texture: ") for line in self.provenance)
        return bool(self.provenance) and not textured

    @property
    def extras(self) -> tuple[str, ...]:
        """What the file holds that no other format keeps: "textures", for instance."""
        return ("textures",) if self.is_textured else ()

    @property
    def lacks(self) -> str:
        """What the file names and can't be had, a clause whose subject it is, "" for nothing."""
        return ""

    @property
    def is_textured(self) -> bool:
        """Whether the file lays pictures on its faces, be they there or not."""
        return False

    @property
    def texcoords(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
        """(t, 2) texture coordinates, and which of them each corner has (−1: none), or None."""
        return None

    @property
    def own_normals(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
        """(t, 3) normals, and which of them each corner has (−1: none), or None."""
        return None

    def textures(self, corners: NDArray[np.int64]) -> Textures | None:
        """Return what the file lays on its triangles, or None.

        Parameters
        ----------
        corners : (m, 3) array
            Which of the corners of the file's polygons those of the triangles are.
        """
        return None

    @property
    def has_strips(self) -> bool:
        """Whether triangle strips are among the file's faces."""
        return False

    def describes(self, vertices: NDArray[np.float64] | None, polygons: Polygons) -> bool:
        """Whether these are the file's vertices (if given) and polygons, not changed ones."""
        return False


def same_vertices(vertices: NDArray[np.float64] | None, own: NDArray[Any]) -> bool:
    """Whether a mesh has a file's vertices; None stands for any.

    Where a file has none that can be drawn, because no face uses it, a mesh has some position.
    """
    if vertices is None or np.array_equal(vertices, own):
        return True
    return vertices.shape == own.shape and bool(
        ((vertices == own) | ~is_drawable(own)[:, None]).all()
    )


def new_names(names: Iterable[str], *, ours: bool, keep: bool) -> dict[str, str]:
    """Return what the properties of a file's vertices are called once it gets new colours.

    The file's own colours become ``original_…`` where they are kept. A former bake's are dropped;
    ``original_red`` shows one, too, if the lines that said so were lost on the way.
    """
    names = list(names)
    ours = ours or any(f"original_{channel}" in names for channel in COLOR)
    originals = {f"original_{channel}" for channel in COLOR}
    renamed = {name: name for name in names if keep or name not in originals}
    for channel in COLOR:
        if channel in renamed:
            if ours or not keep:
                del renamed[channel]
            else:
                renamed[channel] = f"original_{channel}"
    return renamed


def restored_names(names: Iterable[str]) -> dict[str, str]:
    """Return what the properties of vertices are called without a former bake's colours."""
    return {
        name: name.removeprefix("original_") if name in _ORIGINALS else name
        for name in names if name not in COLOR
    }  # fmt: skip


def recolored(attributes: Mapping[str, Any], saving: Saving, *, ours: bool) -> dict[str, Any]:
    """Return a mesh's vertex attributes with the new colours as red, green and blue."""
    if saving.colors is None:
        return dict(attributes)
    names = new_names(attributes, ours=ours, keep=saving.keep_colors)
    kept = {names[name]: values for name, values in attributes.items() if name in names}
    return kept | dict(zip(COLOR, saving.colors.T, strict=True))


_WHITE = 65535.0  # of 16 bits: what is brighter is no brighter


def as_bytes(values: NDArray[Any]) -> NDArray[np.uint8]:
    """Return colours of any type as 8 bit: fractions, numbers up to 255, or up to 65,535.

    Which of them they are, most of the numbers above zero decide: one that is out of range is cut
    off at white, and darkens no other. NaN counts as black.

    Raises
    ------
    MeshdepictError
        For what is no number.
    """
    if values.dtype == np.uint8:
        return values
    if values.dtype.kind not in "biuf":
        raise MeshdepictError(f"colours must be real numbers, not {values.dtype}")
    whole = values.dtype.kind in "iu"
    wide = values.astype(np.float32) if values.dtype == np.float16 else values
    finite = values if whole else np.nan_to_num(wide, posinf=255, neginf=0).clip(0, _WHITE)
    lit = finite[finite > 0]
    usual = np.median(lit) if lit.size else 0.0
    if usual > 255:
        finite = finite / 257
    elif usual <= 1 and not whole:
        finite = finite * 255.0
    return np.clip(finite + (0.0 if whole else 0.5), 0, 255).astype(np.uint8)


def only_colors(
    attributes: Mapping[str, Any], document: object, saving: Saving, name: str
) -> NDArray[np.uint8] | None:
    """Return the (n, 3) colours to write into a format that holds one set of them, or None.

    Parameters
    ----------
    attributes : mapping
        Of the vertices.
    document : object
        What the mesh came with.
    saving : Saving
    name : str
        Of the format.

    Warns where that loses colours which should be kept.
    """
    own = all(channel in attributes for channel in COLOR)
    if saving.colors is not None:
        ours = isinstance(document, Document) and document.is_recolored
        kept = new_names(attributes, ours=ours, keep=saving.keep_colors).values()
        if any(f"original_{channel}" in kept for channel in COLOR):
            warnings.warn(
                f"the mesh's own colours are lost: {name} holds one colour per vertex "
                "(save as .ply or .vtp to keep them)",
                MeshdepictWarning,
                stacklevel=2,
            )
        return saving.colors
    if not own:
        return None
    return as_bytes(np.stack([attributes[channel] for channel in COLOR], axis=1))
