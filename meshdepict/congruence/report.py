"""A comparison on paper: contact sheet, plot, table, and all of it on one page."""

from __future__ import annotations

import base64
import csv
import html
import io
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.congruence.comparison import Comparison, options_text
from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.mark import SOFTWARE, VERSION

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["contact_sheet", "save_page", "save_sheet", "save_table", "score_plot"]

_MARGIN = 8
_READABLE = 1600  # pixels: a screen's width
# Distinct for colour-blind eyes too (Okabe and Ito 2008).
_COLORS = ("#000000", "#E69F00", "#56B4E9", "#009E73", "#D55E00", "#CC79A7", "#0072B2", "#999999")


def contact_sheet(found: Comparison, *, cell: int = 200) -> Image:
    """Return a picture with a row per method and a column per light, scores under each.

    Where the lights don't fit side by side, further blocks of rows follow.

    Parameters
    ----------
    found : Comparison
    cell : int
        Width of a picture on the sheet, in pixels.
    """
    from PIL import Image, ImageDraw, ImageFont

    methods, lights, height, width = found.pictures.shape[:4]
    cell = max(16, min(cell, width))
    high = max(1, round(cell * height / width))
    small, large = (ImageFont.load_default(size=max(9, cell // n)) for n in (13, 10))
    text = max(14, cell // 8)
    left = max(int(large.getlength(name)) for name in found.methods) + 2 * _MARGIN
    most = max(1, (_READABLE - left) // (cell + _MARGIN))
    columns = -(-lights // -(-lights // most))  # as many in each block, but for the last
    head, row = 2 * text, high + text + _MARGIN
    block = head + methods * row + _MARGIN
    size = left + columns * (cell + _MARGIN), -(-lights // columns) * block
    page = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(page)
    for top in range(0, size[1], block):
        for i, name in enumerate(found.methods):
            y = top + head + i * row + high / 2
            draw.text((_MARGIN, y), name, "black", large, anchor="lm")
            mean = f"mean {found.means[i]:.3f}"
            draw.text((_MARGIN, y + text), mean, "black", small, anchor="lm")
    for light, (name, (azimuth, elevation)) in enumerate(
        zip(found.light_names, found.angles, strict=True)
    ):
        top, x = light // columns * block, left + light % columns * (cell + _MARGIN)
        draw.text((x + cell / 2, top + text / 2), name, "black", small, anchor="mm")
        angles = f"azimuth {azimuth:.0f}°, elevation {elevation:.0f}°"
        draw.text((x + cell / 2, top + 3 * text / 2), angles, "#555555", small, anchor="mm")
        for i in range(methods):
            y = top + head + i * row
            image = Image.fromarray(found.pictures[i, light])
            page.paste(image.resize((cell, high), Image.Resampling.LANCZOS), (x, y))
            score = f"{found.scores[i, light]:.3f}"
            draw.text((x + cell / 2, y + high + text / 2), score, "black", small, anchor="mm")
    return page


def save_sheet(found: Comparison, path: str | Path, *, cell: int = 200) -> Path:
    """Write the contact sheet as a PNG; see `contact_sheet`.

    Raises
    ------
    MeshdepictError
        For a name that doesn't end in .png, and where it can't be written.
    """
    from PIL.PngImagePlugin import PngInfo

    texts = PngInfo()
    for key, text in _facts(found).items():
        texts.add_text(f"meshdepict {key}", text)
    sheet = contact_sheet(found, cell=cell)
    with atomic_write(_named(path, ".png")) as stream:
        sheet.save(stream, format="PNG", pnginfo=texts)
    return Path(path)


def save_table(found: Comparison, path: str | Path) -> Path:
    """Write the scores as comma-separated values, a row per method.

    Raises
    ------
    MeshdepictError
        For a name that doesn't end in .csv, and where it can't be written.
    """
    lines = io.StringIO(newline="")
    csv.writer(lines, lineterminator="\n").writerows(found.table())
    with atomic_write(_named(path, ".csv")) as stream:
        stream.write(lines.getvalue().encode())
    return Path(path)


def score_plot(found: Comparison) -> bytes:
    """Return scores over lights, a curve per method (LLA fig. 13), as SVG."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4.2), layout="constrained")
    axes: Any = figure.add_subplot()
    places = np.arange(1, len(found.lights) + 1)
    for i, (name, scores, mean) in enumerate(
        zip(found.methods, found.scores, found.means, strict=True)
    ):
        style = "--" if i >= len(_COLORS) else "-"
        color = _COLORS[i % len(_COLORS)]
        label = f"{name}, mean {mean:.3f}"
        axes.plot(places, scores, style, marker="o", markersize=3, color=color, label=label)
    names = found.light_names
    turn = 0 if max(map(len, names)) <= 3 else 45
    axes.set_xticks(places, names, fontsize=8, rotation=turn)
    axes.set(ylim=(0, 1), xlabel="light", ylabel="congruence")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, loc="lower left")
    stream = io.BytesIO()
    # Without a date the same comparison gives the same bytes.
    figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": SOFTWARE})
    return stream.getvalue()


def save_page(found: Comparison, path: str | Path, *, title: str = "") -> Path:
    """Write a self-contained page with plot, table, pictures and what it takes to repeat it.

    Raises
    ------
    MeshdepictError
        For a name that doesn't end in .html, and where it can't be written.
    """
    sheet = io.BytesIO()
    contact_sheet(found).save(sheet, format="PNG")
    worst = found.light_names[found.worst]
    maps = "".join(
        f"<figure>{_image(_png(picture), name)}<figcaption>{name}</figcaption></figure>"
        for name, picture in zip(found.methods, found.score_pictures, strict=True)
    )
    cells = _cells(("light", "azimuth", "elevation", *found.methods), "th")
    rows = _cells(("mean", "", "", *(f"{mean:.3f}" for mean in found.means)))
    for light, (azimuth, elevation), scores in zip(
        found.light_names, found.angles, found.scores.T, strict=True
    ):
        angles = f"{azimuth:.0f}°", f"{elevation:.0f}°"
        rows += _cells((light, *angles, *(f"{score:.3f}" for score in scores)))
    facts = "".join(
        f"<dt>{html.escape(key)}</dt><dd>{html.escape(text)}</dd>"
        for key, text in _facts(found).items()
    )
    name = html.escape(title or "Comparison of shading methods")
    page = _PAGE.format(
        title=name, software=SOFTWARE, head=cells, rows=rows,
        plot=_image(score_plot(found), "scores over lights", "svg+xml"),
        sheet=_image(sheet.getvalue(), "contact sheet"), maps=maps,
        worst=html.escape(worst), facts=facts,
    )  # fmt: skip
    with atomic_write(_named(path, ".html")) as stream:
        stream.write(page.encode())
    return Path(path)


def _cells(texts: Iterable[str], kind: str = "td") -> str:
    """Return a row of a table."""
    cells = "".join(f"<{kind}>{html.escape(text)}</{kind}>" for text in texts)
    return f"<tr>{cells}</tr>"


def _facts(found: Comparison) -> dict[str, str]:
    """Return what it takes to make the comparison again."""
    settings = {name: value for name, value in found.settings.items() if value is not None}
    scoring: dict[str, Any] = {name: settings.pop(name) for name in ("scored", "flow")}
    height, width = found.pictures.shape[2:4]
    return {
        "version": VERSION,
        "comparison": ", ".join(found.methods),
        **{
            f"options of {name}": options_text(options)
            for name, options in zip(found.methods, found.options, strict=True)
            if options
        },
        "scale space": options_text(settings),
        "scores": options_text(scoring),
        "lights": "; ".join(map(str, found.lights)),
        "view": str(found.view),
        "picture": f"{width} x {height} pixels",
        found.shape.kind: found.shape.identity,
        "seconds": f"{found.seconds:.1f}",
    }


def _named(path: str | Path, suffix: str) -> Path:
    if Path(path).suffix.lower() != suffix:
        raise MeshdepictError(f"{path}: end the name with {suffix}")
    return Path(path)


def _png(array: NDArray[np.uint8]) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(array).save(stream, format="PNG")
    return stream.getvalue()


def _image(data: bytes, words: str, kind: str = "png") -> str:
    text = base64.b64encode(data).decode()
    return f'<img alt="{html.escape(words)}" src="data:image/{kind};base64,{text}">'


_PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="{software}">
<title>{title}</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; color: #222; }}
body {{ margin: 2rem auto; padding: 0 1rem; max-width: 75rem; }}
img {{ max-width: 100%; }}
h1 {{ overflow-wrap: anywhere; }}
.wide {{ overflow-x: auto; }} .wide img {{ min-width: 50rem; width: 100%; }}
table {{ border-collapse: collapse; font-size: 12px; font-variant-numeric: tabular-nums; }}
td, th {{ padding: .2rem .4rem; text-align: right; border-bottom: 1px solid #ddd; }}
td:first-child, th:first-child {{ text-align: left; }}
.maps {{ display: flex; flex-wrap: wrap; gap: 1rem; }} figure {{ margin: 0; width: 11rem; }}
dt {{ font-weight: 600; }} dd {{ margin: 0 0 .4rem; overflow-wrap: anywhere; }}
</style>
<h1>{title}</h1>
<p>Congruence says how well the bands of a shading follow the shape: 1 everywhere, 0 nowhere
(Local Light Alignment, §7).</p>
{plot}
<div class="wide"><table>{head}{rows}</table></div>
<h2>Every method under every light</h2>
<div class="wide">{sheet}</div>
<h2>Where it fails the shape (red), under light {worst}</h2>
<div class="maps">{maps}</div>
<h2>To make it again</h2>
<dl>{facts}</dl>
</html>
"""
