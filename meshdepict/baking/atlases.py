"""Which texture coordinates a bake takes: the file's own, or new ones; and whether they do."""

from __future__ import annotations

import threading
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.texture_choices import ATLASES
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.own_texcoords import own_texcoords
from meshdepict.surface.texels import Claims, TexelGrid
from meshdepict.threads import each

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Atlas", "atlas_of"]

Floats = NDArray[np.float64]

_BAND = 1 << 18  # texels that are looked at at once
_GUTTER = 24
_SHARED = 0.01  # of the texels in use that may be of several triangles: rounding, a fold
_SMALL = 0.01  # of the surface that may have no texel before a note says so


@dataclass(frozen=True)
class Atlas:
    """Where the triangles of a mesh lie in a square of texels.

    Attributes
    ----------
    kind : str
        One of `ATLASES`.
    texcoords : (m, 3, 2) array
    grid : TexelGrid
    gutter : int
        How far colours reach beyond the triangles, in texels.
    """

    kind: str
    texcoords: Floats
    grid: TexelGrid
    gutter: int

    @property
    def size(self) -> int:
        """Texels along the side."""
        return self.grid.size

    @property
    def mipmaps(self) -> bool:
        """Whether smaller copies of the texture are of any use."""
        return self.kind != "new"

    @property
    def bands(self) -> list[tuple[int, int]]:
        """Rows that are shaded together: from, to."""
        return _bands(self.size)


def atlas_of(mesh: Mesh, size: int, kind: str | None = None) -> Atlas:
    """Return the atlas of a mesh.

    Parameters
    ----------
    mesh : Mesh
    size : int
        Texels along the side.
    kind : str, optional
        One of `ATLASES`; "own" unless given, and "new" of a mesh without texture coordinates, and,
        with a note, of one whose coordinates cover nothing.

    Raises
    ------
    MeshdepictError
        For coordinates that overlap, or are missing from some triangles, an unknown kind, and more
        triangles than have room.
    """
    if kind is not None and (not isinstance(kind, str) or kind not in ATLASES):
        raise MeshdepictError(f"atlas={kind!r} is none of {', '.join(ATLASES)}")
    own = None if kind in ("new", "xatlas") else _own(mesh, asked=kind == "own")
    if own is not None:
        grid = TexelGrid(own, size)
        if grid.excess > 1 + _SHARED:
            raise MeshdepictError(_overlapping(mesh, f"they fill it {grid.excess:.3g} times"))
        claims = _all_claims(grid)
        used = int(claims.counts.sum())
        if used == 0:
            return _in_place_of(mesh, size, asked=kind == "own")
        if claims.shared > _SHARED * used:
            share = f"{claims.shared / used:.0%} of their texels lie in several"
            raise MeshdepictError(_overlapping(mesh, share))
        if claims.shared:
            warnings.warn(
                f"{np.count_nonzero(claims.disputed):,} triangles overlap others in the atlas, by "
                f"{claims.shared:,} texels",
                MeshdepictWarning,
                stacklevel=2,
            )
        _note_small(mesh, claims)
        grid.fill_in(claims)
        return Atlas("own", own, grid, _GUTTER)
    if kind == "xatlas":
        from meshdepict.surface.charts import charted

        found = charted(mesh.unit_points, mesh.faces, size, gutter=_GUTTER)
        grid = TexelGrid(found, size)
        grid.fill_in(_all_claims(grid))
        return Atlas("xatlas", found, grid, _GUTTER)
    return _new(mesh, size)


def _new(mesh: Mesh, size: int) -> Atlas:
    from meshdepict.surface.triangle_pairs import paired

    found = paired(mesh.unit_points, mesh.faces, size)
    return Atlas("new", found, TexelGrid(found, size, closed=True), _GUTTER)


def _in_place_of(mesh: Mesh, size: int, *, asked: bool) -> Atlas:
    """Return a new atlas with a note, or refuse own coordinates that are asked for and no use."""
    fault = (
        "the mesh's texture coordinates cover no texel, every triangle's lie on a line or at a "
        "point"
    )
    if asked:
        raise MeshdepictError(f"{fault}: let a new atlas be made (--atlas new)")
    warnings.warn(f"{fault}: a new atlas is made", MeshdepictWarning, stacklevel=3)
    return _new(mesh, size)


def _own(mesh: Mesh, *, asked: bool) -> Floats | None:
    """Return the file's own coordinates; None where it has none and nobody asked for them."""
    found = own_texcoords(mesh)
    if found is None or not found[1].any():
        if asked:
            raise MeshdepictError(
                "the mesh has no texture coordinates: leave --atlas own out, and triangles get some"
            )
        return None
    own, placed = found
    if not placed.all():
        raise MeshdepictError(
            f"{np.count_nonzero(~placed):,} of {len(own):,} triangles have no texture coordinates, "
            f"the first is {int(placed.argmin()):,}: let a new atlas be made (--atlas new)"
        )
    return own


def _overlapping(mesh: Mesh, how: str) -> str:
    """Return what is wrong with triangles that share texels, and what can be done."""
    materials = 1 if mesh.textures is None else len(np.unique(mesh.textures.material))
    whose = "mirrored or repeated parts share texels"
    if materials > 1:
        whose = f"its {materials} materials, or mirrored or repeated parts, share texels"
    return (
        f"the mesh's triangles overlap in texture coordinates ({how}): {whose}, and shading needs "
        "one for each place; let a new atlas be made (--atlas new)"
    )


def _note_small(mesh: Mesh, claims: Claims) -> None:
    a, b, c = (mesh.unit_points[corner] for corner in mesh.faces.T)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    share = areas[claims.counts == 0].sum() / (areas.sum() or 1.0)
    if share > _SMALL:
        warnings.warn(
            f"{share:.0%} of the surface, in {np.count_nonzero(claims.counts == 0):,} triangles, "
            "is smaller than a texel in the atlas: a larger --size, or --atlas new, shows more",
            MeshdepictWarning,
            stacklevel=3,
        )


def _bands(size: int) -> list[tuple[int, int]]:
    rows = max(1, _BAND // size)
    return [(a, min(a + rows, size)) for a in range(0, size, rows)]


def _all_claims(grid: TexelGrid) -> Claims:
    """Return who has texels in all rows."""
    total: list[Claims] = []
    one_by_one = threading.Lock()

    def look(begin: int, end: int) -> None:
        found = grid.claims(begin, end)
        with one_by_one:
            total[:] = [total[0] + found] if total else [found]

    each(look, _bands(grid.size))
    return total[0]
