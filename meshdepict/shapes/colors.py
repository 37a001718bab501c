"""Which of a mesh's arrays are the object's own colours, however a program has called them."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.errors import MeshdepictWarning
from meshdepict.shapes.document import COLOR, as_bytes

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["after_position", "vertex_colors"]

Arrays = Mapping[str, NDArray[Any]]

# Three arrays, in any case; in front may stand one of the words below. (An ambient or a specular
# colour is not the object's.)
_TRIPLES = (COLOR, ("r", "g", "b"), ("0", "1", "2"))
_WORDS = ("diffuse", "color", "colour", "colors", "colours", "vertex_color", "base_color", "rgb")
# One array of three or four numbers, or of one that packs them: 0x00RRGGBB.
_TABLES = ("rgb", "rgba", "color", "colors", "colour", "colours", "vertex_color", "vertex_colors",
           "vertex_colour", "vertex_colours", "diffuse", "base_color")  # fmt: skip
_PACKED = ("rgb", "rgba")


def vertex_colors(mesh: Mesh, *, baked: bool, faces: bool = True) -> NDArray[np.uint8] | None:
    """Return the object's own colours, (n, 3), or None where it has none.

    Those that a former bake set aside come first, then the vertices', then the faces', which are
    averaged over each vertex's faces by their areas, in linear light.

    Parameters
    ----------
    mesh : Mesh
    baked : bool
        Whether red, green and blue of the vertices are a former bake's.
    faces : bool
        Whether the faces' are taken.
    """
    vertex = mesh.attributes["vertex"]
    own = {name: values for name, values in vertex.items() if not (baked and name in COLOR)}
    for candidate in (
        {name.removeprefix("original_"): own[name] for name in own if name.startswith("original_")},
        own,
    ):
        found = next(_colors(candidate), None)
        if found is not None:
            return as_bytes(found)
    of_faces = next(_colors(mesh.attributes["face"]), None) if faces else None
    if of_faces is None:
        return None
    warnings.warn(
        "the mesh's own colours are at its faces: they are averaged to its vertices",
        MeshdepictWarning,
        stacklevel=3,
    )
    return _averaged(mesh, as_bytes(of_faces))


def _colors(arrays: Arrays) -> Iterator[NDArray[Any]]:
    """Yield what may be colours, (n, 3), the likeliest first."""
    named = {name.lower(): values for name, values in reversed(list(arrays.items()))}
    for word in ("", *(f"{word}{link}" for word in _WORDS for link in ("_", ".", ""))):
        for triple in _TRIPLES[: 3 if word else 2]:
            parts = [named.get(word + letter) for letter in triple]
            if all(part is not None and part.ndim == 1 for part in parts):
                yield np.stack(parts, axis=1)  # type: ignore[arg-type]
    for name in _TABLES:
        table = named.get(name)
        if table is not None and table.ndim == 2 and table.shape[1] in (3, 4):
            yield table[:, :3]
    for name in _PACKED:
        packed = named.get(name)
        if packed is not None and packed.ndim == 1 and packed.dtype.itemsize == 4:
            bits = packed.view(np.uint32)
            yield np.stack([bits >> shift & 255 for shift in (16, 8, 0)], axis=1).astype(np.uint8)


def _averaged(mesh: Mesh, colors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the mean of each vertex's faces; that of all for one without any."""
    linear = srgb_to_linear(colors[mesh._owner] / np.float32(255))
    corners = [mesh.recentred(mesh.vertices[corner]) for corner in mesh.faces.T]
    area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]), axis=1)
    area += np.finfo(np.float64).tiny  # degenerate faces count where there are no others
    n = len(mesh.vertices)
    weight = sum(np.bincount(corner, area, n) for corner in mesh.faces.T)
    total = np.stack(
        [sum(np.bincount(c, area * channel, n) for c in mesh.faces.T) for channel in linear.T],
        axis=1,
    )
    mean = total / np.where(weight > 0, weight, 1.0)[:, None]
    mean[weight == 0] = np.average(linear, axis=0, weights=area)
    return as_bytes(linear_to_srgb(np.clip(mean, 0, 1)))


def after_position(extra: NDArray[Any], *, w_first: bool) -> NDArray[Any] | None:
    """Return the colours among what follows x, y and z in a row of a vertex, or None.

    Formats of text don't say what ``x y z 1 0.5 0.2 1`` means: a weight w and a colour, or a
    colour and its opacity. What is 1 (or, of an opacity, 255) at every vertex is no colour.

    Parameters
    ----------
    extra : (n, k) array
        w; red, green, blue; w and these; these and alpha; or w and these and alpha.
    w_first : bool
        What it is where either reading fits.

    Returns
    -------
    (n, 3) or (n, 4) array or None
        Red, green, blue and, where not everywhere opaque, alpha.
    """
    width = extra.shape[1]
    if width == 4:
        weighted = bool((extra[:, 0] == 1).all())
        opaque = any((extra[:, 3] == full).all() for full in (1, 255))
        extra = extra[:, 1:] if weighted and (w_first or not opaque) else extra
    elif width == 5:
        extra = extra[:, 1:]
    elif width != 3:
        return None
    if extra.shape[1] == 4 and any((extra[:, 3] == full).all() for full in (1, 255)):
        extra = extra[:, :3]
    return extra
