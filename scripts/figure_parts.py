"""What the figures are made of: objects, views of them, pictures, and pages of pictures."""

from __future__ import annotations

import dataclasses
import inspect
import io
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from figure_objects import manuscript, skull
from PIL import Image, ImageDraw, ImageFont
from scipy.ndimage import gaussian_filter

import meshdepict as md
from meshdepict import color, samples
from meshdepict.congruence.judging import Judge
from meshdepict.scales.image_scales import image_space
from meshdepict.scene.names import as_lights
from meshdepict.scene.view import View
from meshdepict.shading import declaration
from meshdepict.shading.registry import find_method
from meshdepict.shapes.gbuffer import GBuffer

BACKGROUND = (198, 205, 214)
MARGIN = 8

# File, the view's name, and which axis is up.
SCANS = {
    "armadillo": ("armadillo_86k.ply", "front", "y"),
    "bunny": ("bunny_69k.ply", "front", "y"),
    "dragon": ("dragon_203k.ply", "front", "y"),
    "flake": ("flake1_152k.ply", "left", "y"),
    "lucy": ("lucy_100k.ply", "back", "z"),
    "nefertiti": ("nefertiti_100k.ply", "front", "z"),
}

Draw = Callable[["Stage"], Image.Image]
FIGURES: dict[str, tuple[str, Draw]] = {}
"""Title and function of every figure, by name."""


def figure(title: str) -> Callable[[Draw], Draw]:
    """Enter a function as the figure of its name."""

    def enter(draw: Draw) -> Draw:
        FIGURES[draw.__name__.upper()] = title, draw
        return draw

    return enter


@lru_cache(maxsize=4)
def mesh(name: str, folder: Path | None, vertices: int) -> md.Mesh:
    """Return an object: procedural, a scan of the data folder, or without one the golf ball."""
    if name in ("manuscript", "blank page"):
        return manuscript(vertices, written=name == "manuscript")
    if name == "skull":
        return skull(folder, vertices)
    if name == "sphere":
        return samples.sphere(vertices)
    if folder is None or name not in SCANS:
        return samples.golf_ball(vertices)
    return md.read_mesh(folder / "mesh" / SCANS[name][0])


@dataclasses.dataclass(frozen=True)
class Stage:
    """Where figures are made.

    Attributes
    ----------
    size : int
        Of a picture, in pixels.
    folder : Path or None
        Of scans, environments and lit spheres. Without one the golf ball stands in for scans, and
        what is procedural for the others.
    vertices : int
        Of procedural objects.
    """

    size: int = 320
    folder: Path | None = None
    vertices: int = 40_000

    @property
    def inches(self) -> float:
        """Of a picture, for drawings, which have no room for their letters below 200 pixels."""
        return max(self.size, 200) / 100

    def larger(self, times: int) -> Stage:
        """Return the stage of pictures so many times as large."""
        return dataclasses.replace(self, size=times * self.size)

    def look(
        self,
        name: str,
        *,
        view: str | None = None,
        zoom: float = 1.0,
        centre: tuple[float, float] = (0.0, 0.0),
        size: int | None = None,
    ) -> Shot:
        """Look at an object: at a part, whose centre is given in half heights of the picture."""
        shape = mesh(name, self.folder, self.vertices)
        _, usual, up = SCANS.get(name, ("", "front", "y"))
        if self.folder is None:
            up = "y"
        eye = View.fitted(view or usual, shape, up=up)
        shift = eye.parallel_scale * (np.asarray(centre) @ eye.frame[:2])
        eye = dataclasses.replace(
            eye, position=eye.position + shift, focus=eye.focus + shift,
            parallel_scale=eye.parallel_scale / zoom,
        )  # fmt: skip
        size = size or self.size
        return Shot(GBuffer.of(shape, eye, size=(size, size)), folder=self.folder, up=up)

    def sphere(self, name: str) -> str | Path:
        """Return a lit sphere."""
        return "clay" if self.folder is None else self.folder / "litsphere" / name


class Shot:
    """A view of an object, and pictures of it."""

    def __init__(self, buffer: GBuffer, *, folder: Path | None = None, up: str = "y") -> None:
        self.buffer, self.folder, self.up = buffer, folder, up

    def environment(self, name: str, *, turn: float = 0.0) -> md.Environment:
        """Return an environment, turned by degrees about its upright axis.

        It is so bright that matt white shows ½ on average.
        """
        if self.folder is not None:
            pixels = md.Environment.from_file(self.folder / "env" / f"{name}.hdr").pixels
        else:
            rows, columns = np.mgrid[0:32, 0:64]
            sky = np.exp(-((rows - 8) ** 2 + (columns - 44) ** 2) / 8.0)
            pixels = (0.2 + 9 * sky)[..., None] * [1, 0.9, 0.8]
        pixels = np.roll(pixels, round(pixels.shape[1] * turn / 360), axis=1)
        found = md.Environment(pixels, up=self.up)
        shown = found.irradiance(self.buffer.normals[:: 1 + len(self.buffer.normals) // 500])
        return md.Environment(pixels / (2 * shown.mean() / np.pi), up=self.up, name=name)

    def pixels(self, **smoothing: Any) -> md.ScaleSpace:
        """Return the scale space of the pixels, as LW, RS and LLA do it."""
        return image_space(self.buffer, **smoothing)

    def descriptor(self, iterations: int = 8, **smoothing: Any) -> md.ScaleSpace:
        """Return what LW's and RS's curvature is measured on: diffused slopes."""
        return self.pixels(filter="diffusion", iterations=iterations, **smoothing)

    def vertices(self, **smoothing: Any) -> md.ScaleSpace:
        """Return the scale space of the vertices, as ES does it."""
        return md.scale_space(self.buffer.mesh, **smoothing)

    def values(
        self, space: md.ScaleSpace, method: str, light: Any = "northwest", **options: Any
    ) -> Any:
        """Return what a method makes of the samples in the picture."""
        function = find_method(method)
        taken = inspect.signature(function).parameters
        if "view" in taken:
            options["view"] = self.buffer.view
        if "curvature" in taken:
            options.setdefault("curvature", "view")
        if not isinstance(light, md.Environment):
            lamps = as_lights(light, self.buffer.view)
            light = lamps if len(lamps) > 1 else lamps[0]
        found = function(space, light, **options)
        return found if space.shape is self.buffer else self.buffer.sample(found)

    def shaded(
        self, space: md.ScaleSpace, method: str, light: Any = "northwest", **options: Any
    ) -> Image.Image:
        """Return the picture of a method."""
        linear = declaration(find_method(method)).linear
        return self.picture(self.values(space, method, light, **options), linear=linear)

    def picture(
        self, values: Any, *, linear: bool = False, colormap: str | None = None
    ) -> Image.Image:
        """Return values of the samples, in [0, 1], as a picture."""
        shown = color.encode(np.asarray(values, np.float32), linear=linear, colormap=colormap)
        return Image.fromarray(self.buffer.image(shown, background=BACKGROUND))

    def detail(self, values: Any, *, linear: bool = False) -> Any:
        """Return by how much samples are brighter than what is around them, as `detail` does."""
        shown = color.encode(np.asarray(values, np.float32), linear=linear)
        return detail(self.buffer.image(shown), self.buffer.mask)

    @cached_property
    def judge(self) -> Judge:
        """Scores congruence in this view."""
        reference = self.values(self.pixels(filter="none"), "lambert", "front")
        depth, mask = self.buffer.depth, self.buffer.mask
        return Judge(depth, mask, reference=self.buffer.image(reference))

    def score(self, values: Any) -> float:
        """Return the congruence of linear values with the shape."""
        return self.judge.score(self.buffer.image(values))


def detail(pixels: Any, mask: Any) -> Any:
    """Return by how much display colours within a mask are brighter than what is around them.

    That is their mean under a Gaussian whose width is a fiftieth of the picture's.
    """
    tones = np.where(mask, pixels[..., :3] / 255 @ [0.2126, 0.7152, 0.0722], 0)
    width = mask.shape[1] / 50
    share = gaussian_filter(mask.astype(float), width)
    return tones[mask] - gaussian_filter(tones, width)[mask] / share[mask]


def page(rows: Sequence[Sequence[tuple[str, Image.Image]]]) -> Image.Image:
    """Return rows of pictures, a caption under each."""
    font = _font()
    widths = [max(r[i][1].width for r in rows if i < len(r)) for i in range(max(map(len, rows)))]
    lines = [max(caption.count("\n") + 1 for caption, _ in row) for row in rows]
    heights = [
        max(picture.height for _, picture in row) + 6 + 16 * n
        for row, n in zip(rows, lines, strict=True)
    ]
    sheet = Image.new(
        "RGB",
        (MARGIN + sum(w + MARGIN for w in widths), MARGIN + sum(h + MARGIN for h in heights)),
        "white",
    )
    draw = ImageDraw.Draw(sheet)
    y = MARGIN
    for row, height, count in zip(rows, heights, lines, strict=True):
        x = MARGIN
        for (caption, picture), width in zip(row, widths, strict=False):
            sheet.paste(picture, (x + (width - picture.width) // 2, y))
            place = (x + width / 2, y + height - 16 * count - 3)
            draw.multiline_text(place, caption, "black", font, anchor="ma", align="center")
            x += width + MARGIN
        y += height + MARGIN
    return sheet


def _font() -> ImageFont.FreeTypeFont:
    """Return a font that has Greek letters: matplotlib's, which PyVista brings."""
    import matplotlib as mpl

    return ImageFont.truetype(Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), 12)


def drawing(figure: Any) -> Image.Image:
    """Return a matplotlib figure as a picture."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return Image.open(data).convert("RGB")


def crop(picture: Image.Image, box: tuple[float, float, float, float]) -> Image.Image:
    """Return a part (left, top, right, bottom, in shares of the picture), as large as the whole."""
    w, h = picture.size
    part = picture.crop(tuple(round(s * n) for s, n in zip(box, (w, h, w, h), strict=True)))
    return part.resize((w, h), Image.Resampling.LANCZOS)
