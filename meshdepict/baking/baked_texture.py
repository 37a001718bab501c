"""What baking a texture gives: a picture, the mesh that it lies on, and ways to keep both."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.provenance import comment_lines
from meshdepict.errors import MeshdepictError
from meshdepict.io.textured import TEXTURED

if TYPE_CHECKING:
    from meshdepict.baking.atlases import Atlas
    from meshdepict.baking.choices import Choices
    from meshdepict.shapes.mesh import Mesh

__all__ = ["BakedTexture", "check_texture"]


def check_texture(path: str | Path, map_kind: str = "color") -> None:
    """Refuse to write a texture into a file of another kind, before any work is done."""
    suffix = Path(path).suffix.lower()
    if suffix != ".png" and suffix not in TEXTURED:
        raise MeshdepictError(
            f"{path}: textures are saved with their mesh as {', '.join(TEXTURED)}, or alone as .png"
        )
    if suffix != ".png" and map_kind != "color":
        raise MeshdepictError(
            f"{path}: a map of {map_kind} goes into a picture of its own: end the name with .png"
        )


class BakedTexture:
    """Shading in a mesh's texture, and how it came about.

    Attributes
    ----------
    image : (size, size, 3) array of uint8
        sRGB, row 0 on top; numbers as they are where the map is not one of colours.
    map_kind : str
        One of `MAPS`.
    provenance : dict of str
        Version, method, options, light, view, widths, the mesh's digest and the texture.
    look : Choices
        How it was baked, with what followed from the shape.
    """

    def __init__(
        self,
        source: Mesh,
        atlas: Atlas,
        image: NDArray[np.uint8],
        provenance: Mapping[str, str],
        look: Choices,
        *,
        map_kind: str = "color",
        again: Callable[..., BakedTexture] | None = None,
    ) -> None:
        self.image, self.look, self.map_kind = image, look, map_kind
        self.provenance = dict(provenance)
        self._source, self._atlas, self._again = source, atlas, again

    def __repr__(self) -> str:
        """Return what it shows and its size."""
        shown = self.provenance["method"] if self.map_kind == "color" else self.map_kind
        return f"<BakedTexture: {shown}, {len(self.image):,} x {len(self.image):,} texels>"

    @property
    def comments(self) -> list[str]:
        """The provenance as lines for a file's header."""
        return comment_lines(self.provenance)

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
        assert self._again is not None
        return self._again(**changes)

    @cached_property
    def mesh(self) -> Mesh:
        """The mesh with this texture on it, in place of those that it had."""
        from meshdepict.shapes.textures import Texture, Textures

        stream = io.BytesIO()
        self._write_picture(stream)
        name = f"{self.provenance['method']}.png"
        wrap = ("repeat", "repeat") if self._atlas.kind == "own" else ("clamp", "clamp")
        texture = Texture(name, stream.getvalue(), "png", wrap)
        count = len(self._atlas.texcoords)
        return self._source.with_textures(
            Textures(
                texcoords=self._atlas.texcoords,
                material=np.zeros(count, np.int64),
                base_colors=(texture,),
                factors=np.ones((1, 4)),
                normal_maps=(None,),
                normal_scales=np.ones(1),
            )
        )

    def save(self, path: str | Path) -> Path:
        """Write the mesh with its texture, or the picture alone; the suffix decides.

        Raises
        ------
        MeshdepictError
            For another suffix than .glb, .gltf, .obj, .ply and .png, for maps that are no colours
            unless it is .png, and where a file can't be written.
        """
        check_texture(path, self.map_kind)
        if Path(path).suffix.lower() == ".png":
            from meshdepict.files.atomic import atomic_write

            with atomic_write(path) as file:
                self._write_picture(file)
        else:
            from meshdepict.io.textured import write_textured

            write_textured(path, self.mesh, comments=self.comments, mipmaps=self._atlas.mipmaps)
        return Path(path)

    def _write_picture(self, file: Any) -> None:
        from meshdepict.images.png_files import write_png

        lines = (line.partition(": ") for line in self.comments)
        texts = {key: text for key, _, text in lines}
        write_png(file, self.image, texts, srgb=self.map_kind == "color")
