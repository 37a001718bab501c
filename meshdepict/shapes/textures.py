"""Textures: the pictures that a mesh's file lays on its faces, and where."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.any_numbers import real_array
from meshdepict.images.encoded import decode

__all__ = ["WRAPS", "Texture", "Textures", "laid_textures"]

Floats = NDArray[np.float64]

WRAPS = ("repeat", "clamp", "mirror")
"""What lies beyond a picture's edge: it again, its last pixels, or it the other way round."""

_LARGEST = 1e18  # of coordinates, factors and scales: squares are single precision's
_CALLED = {
    "texcoords": "texture coordinates", "normal_texcoords": "texture coordinates",
    "factors": "factors of base colours", "normal_scales": "scales of normal maps",
}  # fmt: skip
_BLOCK = 1 << 18  # coordinates at a time: temporaries stay small


@dataclass(frozen=True, eq=False)
class Texture:
    """One picture as a mesh's file names it.

    Attributes
    ----------
    name : str
        Of the file, or what the glTF calls it.
    encoded : bytes or None
        The picture's file, kept for saving again as it was; None where it couldn't be had.
    kind : str
        "png", "jpeg", "webp", "tiff" …; "" where that isn't known.
    wrap : (str, str)
        Along u and v, each one of `WRAPS`.
    fault : str
        Why there is no picture, a clause whose subject is the mesh's file; "" where there is one.
    mipmaps : bool
        Whether smaller copies of the picture are of any use.
    """

    name: str
    encoded: bytes | None
    kind: str = ""
    wrap: tuple[str, str] = ("repeat", "repeat")
    fault: str = field(default="", kw_only=True)
    mipmaps: bool = field(default=True, kw_only=True)

    @classmethod
    def of_pixels(
        cls,
        pixels: NDArray[Any],
        wrap: tuple[str, str] = ("clamp", "clamp"),
        *,
        mipmaps: bool = True,
    ) -> Texture:
        """Return a texture that was never a file: (h, w, 3 or 4) of uint8 or uint16."""
        found = cls("", None, "", wrap, mipmaps=mipmaps)
        vars(found)["pixels"] = pixels
        return found

    @cached_property
    def pixels(self) -> NDArray[Any]:
        """(h, w, 3 or 4) of uint8 or uint16, row 0 on top; decoded when first asked for.

        Raises
        ------
        MeshdepictError
            Where the picture can't be had, or can't be read: one sentence.
        """
        if self.encoded is None:
            fault = self.fault or f"holds no picture for the texture {self.name!r}"
            raise MeshdepictError(f"the mesh's file {fault}")
        try:
            found = decode(self.encoded)
        except MeshdepictError as error:
            raise MeshdepictError(f"the texture {self.name!r} {error}") from error
        found.setflags(write=False)
        return found

    def lookup(self, texcoords: ArrayLike) -> NDArray[np.float32]:
        """Return the colours (n, 3) at texture coordinates (n, 2), in [0, 1].

        As they are stored (sRGB is not undone), bilinear between the centres of texels, beyond the
        edges as `wrap` says. Coordinates that aren't finite count as 0.
        """
        pixels = self.pixels
        largest = np.float32(np.iinfo(pixels.dtype).max)
        given = np.asarray(texcoords, np.float64).reshape(-1, 2)
        found = np.empty((len(given), 3), np.float32)
        height, width = pixels.shape[:2]
        for start in range(0, len(given), _BLOCK):
            uv = given[start : start + _BLOCK]
            uv = np.where(np.isfinite(uv), uv, 0.0)
            left, right, x = _between(uv[:, 0], width, self.wrap[0])
            upper, lower, y = _between(1.0 - uv[:, 1], height, self.wrap[1])
            above = _mixed(pixels[upper, left, :3], pixels[upper, right, :3], x)
            below = _mixed(pixels[lower, left, :3], pixels[lower, right, :3], x)
            found[start : start + _BLOCK] = _mixed(above, below, y) / largest
        return found


def _between(
    along: Floats, count: int, wrap: str
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float32]]:
    """Return the texels before and after places (fractions of a picture), and how far between."""
    if wrap == "clamp":
        along = np.clip(along, 0.0, 1.0)
    else:  # what repeats is brought near first: far away, numbers have no digits for texels
        along = along - (np.floor(along) if wrap == "repeat" else 2 * np.floor(along / 2))
    at = along * count - 0.5
    first = np.floor(at)
    share = (at - first).astype(np.float32)[:, None]
    before = first.astype(np.int64)
    ends = []
    for index in (before, before + 1):
        if wrap == "repeat":
            ends.append(index % count)
        elif wrap == "mirror":
            turned = index % (2 * count)
            ends.append(np.minimum(turned, 2 * count - 1 - turned))
        else:
            ends.append(np.clip(index, 0, count - 1))
    return ends[0], ends[1], share


def _mixed(
    one: NDArray[Any], other: NDArray[Any], share: NDArray[np.float32]
) -> NDArray[np.float32]:
    start = one.astype(np.float32)
    mixed: NDArray[np.float32] = start + share * (other.astype(np.float32) - start)
    return mixed


@dataclass(frozen=True, eq=False)
class Textures:
    """The textures of a mesh of m triangles, in k materials.

    Attributes
    ----------
    texcoords : (m, 3, 2) array
        Of every corner of every triangle: u to the right, v up (glTF's is turned on reading).
        Always finite; 0 where the file has none, with −1 as the material.
    material : (m,) array of int
        Of every triangle, an index of the following; −1 where it has none.
    base_colors : tuple of k Texture or None
    factors : (k, 4) array
        What each base colour is multiplied by, in linear light; 1 where the file says nothing.
    normal_maps : tuple of k Texture or None
        In tangent space, OpenGL's green up.
    normal_scales : (k,) array
        What x and y of each normal map are multiplied by.
    normal_texcoords : (m, 3, 2) array or None
        Where normal maps have coordinates of their own.
    tinted : bool
        Whether colours of vertices multiply the textures, as glTF's do; else they stand for them.
    """

    texcoords: Floats
    material: NDArray[np.int64]
    base_colors: tuple[Texture | None, ...]
    factors: Floats
    normal_maps: tuple[Texture | None, ...]
    normal_scales: Floats
    normal_texcoords: Floats | None = None
    tinted: bool = False

    def __post_init__(self) -> None:
        """Check that all parts fit together.

        Raises
        ------
        MeshdepictError
            Where they don't.
        """
        for name in ("texcoords", "factors", "normal_scales", "normal_texcoords"):
            given = getattr(self, name)
            array = None if given is None else real_array(given)
            if given is not None and (array is None or not (np.abs(array) <= _LARGEST).all()):
                raise MeshdepictError(
                    f"{_CALLED[name]} are NaN or infinite, beyond {_LARGEST:g} or no numbers"
                )
            object.__setattr__(self, name, array)
        material = np.asarray(self.material)
        if material.ndim != 1 or material.dtype.kind not in "iu":
            raise MeshdepictError("materials of triangles are whole numbers, one for each")
        count, k = len(self.material), len(self.base_colors)
        shapes = self.texcoords.shape == (count, 3, 2) and self.factors.shape == (k, 4)
        if self.normal_texcoords is not None:
            shapes &= self.normal_texcoords.shape == (count, 3, 2)
        if not shapes or len(self.normal_maps) != k or self.normal_scales.shape != (k,):
            raise MeshdepictError(
                "textures need coordinates (m, 3, 2), a material (m,) of every triangle, and of k "
                "materials a base colour, factors (k, 4), a normal map and its scale each"
            )
        if count and not -1 <= self.material.min() <= self.material.max() < k:
            raise MeshdepictError(f"a triangle's material is none of the {k:,} that textures have")

    def parts(self, owner: NDArray[np.int64], shares: Floats) -> Textures:
        """Return the textures of parts of the triangles.

        Parameters
        ----------
        owner : (k,) array
            The triangle that each part belongs to.
        shares : (k, 3, 3) array
            Where its corners lie there, in barycentric coordinates.
        """
        uv, normal_uv = (
            None if each is None else np.einsum("kco,koi->kci", shares, each[owner])
            for each in (self.texcoords, self.normal_texcoords)
        )
        assert uv is not None
        return replace(
            self, texcoords=uv, material=self.material[owner], normal_texcoords=normal_uv
        )

    def colors(self, faces: ArrayLike, weights: ArrayLike) -> NDArray[np.float32]:
        """Return the base colours (n, 3) as sRGB in [0, 1] at places within triangles.

        The texture's times its factor; white where a triangle has no material.

        Parameters
        ----------
        faces : (n,) array_like of int
        weights : (n, 3) array_like
            Barycentric coordinates.
        """
        from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear

        triangles = np.asarray(faces, np.int64)
        material = self.material[triangles]
        found = np.ones((len(triangles), 3), np.float32)
        share = np.asarray(weights, np.float64)
        for k in np.unique(material[material >= 0]):
            chosen = material == k
            texture, factor = self.base_colors[k], self.factors[k, :3]
            if texture is not None:
                at = self.texcoords[triangles[chosen]]
                found[chosen] = texture.lookup(np.einsum("ni,nij->nj", share[chosen], at))
            if (factor != 1).any():
                linear = srgb_to_linear(found[chosen]) * factor
                found[chosen] = linear_to_srgb(np.clip(linear, 0, 1))
        return found


def laid_textures(
    texcoords: Floats,
    material: NDArray[Any],
    base_colors: Sequence[Texture | None],
    factors: Floats,
    normal_maps: Sequence[Texture | None],
    normal_scales: Floats,
    normal_texcoords: Floats | None = None,
    *,
    tinted: bool = False,
) -> Textures | None:
    """Return `Textures` of what a file says, right or wrong; None where it lays none anywhere.

    Coordinates that are NaN or infinite mean that a corner has none: its triangle has no texture,
    which is said where its material has one. What is no number of a material is none.
    """
    own = np.where((material >= 0) & (material < len(base_colors)), material, -1).astype(np.int64)
    has = [
        np.array([texture is not None for texture in each] + [False], bool)[own]
        for each in (base_colors, normal_maps)
    ]
    if normal_texcoords is None:
        bad = ~np.isfinite(texcoords).all(axis=(1, 2)) & (has[0] | has[1])
    else:
        wrong = [~np.isfinite(uv).all(axis=(1, 2)) for uv in (texcoords, normal_texcoords)]
        bad = (wrong[0] & has[0]) | (wrong[1] & has[1])
        # Where only one of the two is laid, its coordinates serve for both.
        texcoords = np.where(has[0][:, None, None], texcoords, normal_texcoords)
        normal_texcoords = np.where(has[1][:, None, None], normal_texcoords, texcoords)
    laid = (has[0] | has[1]) & ~bad
    if bad.any():
        count = int(np.count_nonzero(bad))
        what = f"{count:,} triangles with a texture have"
        if not laid.any():
            what = "all triangles with a texture have"
        elif count == 1:
            what = "1 triangle with a texture has"
        warnings.warn(
            f"{what} no coordinates in it, or such as are no numbers: shown without",
            MeshdepictWarning,
            stacklevel=2,
        )
    if not laid.any():
        return None
    own[bad] = -1
    texcoords = np.where(np.isfinite(texcoords), texcoords, 0.0)
    if normal_texcoords is not None:
        normal_texcoords = np.where(np.isfinite(normal_texcoords), normal_texcoords, 0.0)
        if np.array_equal(texcoords, normal_texcoords):
            normal_texcoords = None
    return Textures(
        texcoords, own, tuple(base_colors), factors, tuple(normal_maps), normal_scales,
        normal_texcoords, tinted=tinted,
    )  # fmt: skip
