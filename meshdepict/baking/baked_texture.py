"""What baking a texture gives: a picture, the mesh that it lies on, and ways to keep both."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.baked import PAGES, Baked, Depiction
from meshdepict.baking.own_colors import own_appearance
from meshdepict.baking.texture_choices import IMAGES, ImageKind
from meshdepict.errors import MeshdepictError
from meshdepict.io.textured import TEXTURED
from meshdepict.shapes.appearance import Appearance
from meshdepict.shapes.textures import Texture, Textures

if TYPE_CHECKING:
    from meshdepict.baking.atlases import Atlas
    from meshdepict.baking.choices import Choices
    from meshdepict.drawing.figure import Figure
    from meshdepict.drawing.page import Page
    from meshdepict.scene.view import View
    from meshdepict.shapes.mesh import Mesh

__all__ = ["BakedTexture", "check_packing", "check_texture"]


_ALONE = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".webp": "webp"}


def check_texture(path: str | Path, map_kind: str = "color") -> None:
    """Refuse to write a texture into a file of another kind, before any work is done."""
    suffix = Path(path).suffix.lower()
    if suffix not in (*_ALONE, *TEXTURED, *PAGES):
        raise MeshdepictError(
            f"{path}: textures are saved with their mesh as {', '.join(TEXTURED)}, alone as "
            f"{', '.join(_ALONE)}, or as a page that turns, {PAGES[0]}"
        )
    if suffix != ".png" and map_kind != "color":
        raise MeshdepictError(
            f"{path}: a map of {map_kind} goes into a picture of its own: end the name with .png"
        )


def check_packing(path: str | Path, image: str, quality: int | None) -> None:
    """Refuse how a picture is to be packed, before any work is done."""
    from meshdepict.images.encoded import encode

    if image not in IMAGES:
        raise MeshdepictError(f"image={image!r} is none of {', '.join(IMAGES)}")
    kind = _ALONE.get(Path(path).suffix.lower(), image)
    if quality is not None and kind == "png":
        raise MeshdepictError(f"quality={quality} is of jpeg and webp: png is exact")
    if kind != "png":
        encode(np.zeros((1, 1, 3), np.uint8), kind, quality=quality)


class BakedTexture(Depiction):
    """Shading in a mesh's texture, and how it came about.

    Attributes
    ----------
    shape : Mesh
        What was shaded, with the textures that it came with.
    image : (size, size, 3) array of uint8
        sRGB, row 0 on top; numbers as they are where the map is not one of colours.
    map_kind : str
        One of `MAPS`.
    provenance : dict of str
        Version, method, options, light, view, widths, the mesh's digest and the texture.
    view : View
        The view that names of lights referred to, and that pictures show.
    look : Choices
        How it was baked, with what followed from the shape.
    """

    shape: Mesh
    look: Choices

    def __init__(
        self,
        source: Mesh,
        atlas: Atlas,
        image: NDArray[np.uint8],
        provenance: Mapping[str, str],
        look: Choices,
        view: View,
        *,
        again: Callable[..., BakedTexture],
        at_vertices: Callable[[], Baked],
        map_kind: str = "color",
        given: Mesh | None = None,
    ) -> None:
        super().__init__(source, provenance, view, look)
        self.image, self.map_kind = image, map_kind
        self._atlas, self._again, self._at_vertices = atlas, again, at_vertices
        self._given = source if given is None else given  # whose polygons became triangles, maybe

    def __repr__(self) -> str:
        """Return what it shows and its size."""
        shown = self.provenance["method"] if self.map_kind == "color" else self.map_kind
        return f"<BakedTexture: {shown}, {len(self.image):,} x {len(self.image):,} texels>"

    @property
    def texcoords(self) -> NDArray[np.float64]:
        """(m, 3, 2) coordinates of the triangles' corners, v up."""
        return self._atlas.texcoords

    def with_look(self, **changes: Any) -> BakedTexture:
        """Return the same texture in another light, or with other options of the method.

        Nothing is smoothed again, and no atlas made.

        Parameters
        ----------
        **changes
            As for `bake_texture`: ``light``, ``view``, ``colormap`` and the method's options.

        Raises
        ------
        MeshdepictError
            For what scale spaces are made with, and another method.
        """
        return self._again(**changes)

    @cached_property
    def mesh(self) -> Mesh:
        """The mesh with this texture on it, in place of those that it had."""
        return self._with_picture("png", None)

    @cached_property
    def vertices(self) -> Baked:
        """The same look at the mesh's vertices: what the texture is finer than."""
        return self._at_vertices()

    @cached_property
    def appearance(self) -> Appearance:
        """How the mesh looks in this texture."""
        wrap, mipmaps = self._wrap, self._atlas.mipmaps
        texture = Texture.of_pixels(self.image, wrap, mipmaps=mipmaps)
        return Appearance(self.shape, textures=self._laid(texture))

    @property
    def _wrap(self) -> tuple[str, str]:
        return ("repeat", "repeat") if self._atlas.kind == "own" else ("clamp", "clamp")

    def _with_picture(self, kind: str, quality: int | None) -> Mesh:
        return self.shape.with_textures(self._laid(self._texture(kind, quality)))

    def _texture(self, kind: str, quality: int | None) -> Texture:
        from meshdepict.images.encoded import KINDS

        name = self.provenance["method"] + KINDS[kind][1]
        packed, mipmaps = self._packed(kind, quality), self._atlas.mipmaps
        return Texture(name, packed, kind, self._wrap, mipmaps=mipmaps)

    def _laid(self, texture: Texture) -> Textures:
        count = len(self._atlas.texcoords)
        return Textures(
            texcoords=self._atlas.texcoords,
            material=np.zeros(count, np.int64),
            base_colors=(texture,),
            factors=np.ones((1, 4)),
            normal_maps=(None,),
            normal_scales=np.ones(1),
        )

    def save(
        self, path: str | Path, *, image: ImageKind = "png", quality: int | None = None
    ) -> Path:
        """Write the mesh with its texture, or the picture alone; the suffix decides.

        Parameters
        ----------
        path : str or Path
            .glb, .gltf, .obj or .ply; of the picture alone .png, .jpg or .webp; .html is a page
            that turns, offline, in any browser, where a line parts the texture and what the mesh
            looks like at its vertices, or in its file.
        image : {"png", "jpeg", "webp"}
            How the picture in or beside a mesh is packed. In glTF WebP needs a reader that knows
            the extension EXT_texture_webp.
        quality : int, optional
            Of JPEG and WebP, 1 … 100; 90, about a grey level, unless given.

        Raises
        ------
        MeshdepictError
            For another suffix, kind or quality, for maps that are no colours unless it is .png, and
            where a file can't be written.
        """
        check_texture(path, self.map_kind)
        check_packing(path, image, quality)
        alone = _ALONE.get(Path(path).suffix.lower())
        if alone is not None:
            from meshdepict.files.atomic import atomic_write

            packed = self._packed(alone, quality)
            with atomic_write(path) as file:
                file.write(packed)
        elif Path(path).suffix.lower() in PAGES:
            self._save_compared(path, self._texture(image, quality))
        else:
            from meshdepict.io.textured import write_textured

            mesh = self.mesh if image == "png" else self._with_picture(image, quality)
            write_textured(
                path, mesh, given=self._given, comments=self.comments, mipmaps=self._atlas.mipmaps
            )
        return Path(path)

    def _save_compared(self, path: str | Path, texture: Texture) -> None:
        """Write a page of this texture, the same look at vertices, and what the file shows."""
        mesh, method = self.vertices.mesh, self.look.title.replace("_", " ")
        appearances = {
            method: Appearance(mesh, textures=self._laid(texture)),
            f"{method} at the vertices": Appearance(mesh, self.vertices.colors),
        }
        own = own_appearance(mesh)
        if own is not None:
            appearances = {method: appearances.pop(method), own.name: own, **appearances}
        self._save_page(path, mesh, appearances)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.PolyData`` with texture coordinates, for ``pyvista.Texture(image)``.

        A vertex for each place that corners have in the texture.
        """
        from meshdepict.drawing.textured import textured_polydata

        (poly,) = textured_polydata(self.appearance)
        return poly

    def _page(self, figure: Figure) -> Page:
        from meshdepict.drawing.picture import draw_page

        return draw_page(self, figure)

    def _packed(self, kind: str, quality: int | None) -> bytes:
        """Return the picture as a file's bytes; a PNG with its provenance."""
        if kind != "png":
            from meshdepict.images.encoded import encode

            return encode(self.image, kind, quality=quality)
        from meshdepict.images.png_files import write_png

        lines = (line.partition(": ") for line in self.comments)
        texts = {key: text for key, _, text in lines}
        stream = io.BytesIO()
        write_png(stream, self.image, texts, srgb=self.map_kind == "color")
        return stream.getvalue()
