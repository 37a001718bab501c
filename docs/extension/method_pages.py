"""A page for each method, from its docstring, its annotations and methods/pages.toml."""

from __future__ import annotations

import inspect
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import strips
from sphinx.application import Sphinx
from sphinx.util.display import status_iterator

import meshdepict as md
from meshdepict.shading import METHODS

Page = dict[str, Any]
_STRIP = 320


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write_pages(app: Sphinx) -> None:
    """Write methods/NAME.md and their pictures, where they aren't there yet."""
    home = Path(app.srcdir) / "methods"
    said = tomllib.loads((home / "pages.toml").read_text(encoding="utf-8"))
    if set(said) != set(METHODS):
        raise ValueError(f"pages.toml and the catalogue differ: {set(said) ^ set(METHODS)}")
    for name in status_iterator(list(METHODS), "drawing methods… ", length=len(METHODS)):
        text = "\n\n".join(_page(name, said[name], home / "pictures")) + "\n"
        page = home / f"{name}.md"
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")
    _index(home, said)


def _index(home: Path, said: dict[str, Page]) -> None:
    cards = [
        f":::{{grid-item-card}} {name}\n:img-top: pictures/{name}.webp\n"
        f":img-alt: {said[name]['sample'].replace('_', ' ')} in {name}\n:link: {name}\n"
        f":link-type: doc\n\n{md.methods(name).summary}\n:::"
        for name in METHODS
    ]
    listed = "\n".join(METHODS)
    text = (home / "index.in.md").read_text(encoding="utf-8")
    text += "\n::::{grid} 2 3 4 4\n:gutter: 2\n\n" + "\n\n".join(cards) + "\n\n::::\n\n"
    text += f"```{{toctree}}\n:hidden:\n\n{listed}\n```\n"
    (home / "index.md").write_text(text, encoding="utf-8")


def _page(name: str, said: Page, pictures: Path) -> Iterator[str]:
    described, function = md.methods(name), METHODS[name]
    sample, look = said["sample"], said.get("look", {})
    yield f"# {name}"
    yield described.summary
    before, after = strips.plain(sample), name
    _drawn(pictures, f"{sample}-{before}", sample, before, {})
    _drawn(pictures, name, sample, name, look)
    noun = sample.replace("_", " ")
    if before != after:
        yield (
            f"```{{before-after}} pictures/{sample}-{before}.webp pictures/{name}.webp\n"
            f":alt: A {noun}\n:captions: {before} | {name}\n```"
        )
    else:
        yield f"![A {noun} in {name}](pictures/{name}.webp)"
    for line in said["equation"]:
        yield f"$$\n{line}\n$$"
    facts = [*described.facts, ("limits", said["limits"])]
    yield "| | |\n| --- | --- |\n" + "\n".join(f"| {key} | {_cell(text)} |" for key, text in facts)
    strips_of = said.get("strips", {})
    if strips_of:
        yield "## What the options do"
    for option, values in strips_of.items():
        help_ = next(row[3] for row in described.options if row[0] == option)
        yield f"**{option}**" + (f": {help_}" if help_ else "")
        yield _strip(name, sample, option, values, look, pictures)
    if described.options:
        yield "## Options"
        rows = ["| `--set` | default | range | |", "| --- | --- | --- | --- |"]
        rows += ["| " + " | ".join(_cell(x) for x in row) + " |" for row in described.options]
        yield "\n".join(rows)
    yield "## In Python"
    yield f"```{{eval-rst}}\n.. autofunction:: meshdepict.shading.{name}\n```"
    yield f"Code: `{inspect.getmodule(function).__name__}`"  # type: ignore[union-attr]


def _strip(
    name: str, sample: str, option: str, values: list[Any], look: Page, pictures: Path
) -> str:
    cells = []
    for value in values:
        word = f"{value:g}" if isinstance(value, int | float) else value
        file = f"{name}-{option}-{word}"
        _drawn(pictures, file, sample, name, {**look, option: value}, _STRIP)
        alt = f"{sample.replace('_', ' ')}, {option} {word}"
        cells.append(f":::{{grid-item}}\n![{alt}](pictures/{file}.webp)\n\n{word}\n:::")
    columns = len(values)
    return (
        f"::::{{grid}} 2 {columns} {columns} {columns}\n:gutter: 1\n:class-container: strip\n\n"
        + "\n\n".join(cells)
        + "\n::::"
    )


def _drawn(
    pictures: Path, file: str, sample: str, method: str, chosen: Page, size: int = strips.SIZE
) -> None:
    path = pictures / f"{file}.webp"
    if not path.exists():
        strips.save(strips.picture(sample, method, **chosen), path, size)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
