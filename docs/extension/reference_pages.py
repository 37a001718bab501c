"""The reference: a page for each public name, and what the command line says of itself."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

import meshdepict as md
from meshdepict import color, congruence, curvature, samples
from meshdepict.cli import _COMMANDS

_PARTS = {
    "samples": (samples, "Samples", "Procedural shapes, the same bits every time."),
    "curvature": (curvature, "Curvature", "Estimators of how a surface bends."),
    "congruence": (congruence, "Congruence", "How well a picture follows the shape."),
    "color": (color, "Colour", "From values to colours."),
}
_ELSEWHERE = {"shading", *_PARTS}


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write_pages(app: Sphinx) -> None:
    """Write reference/*.md."""
    home = Path(app.srcdir) / "reference"
    names = [name for name in md.__all__ if name not in _ELSEWHERE]
    things = {name: getattr(md, name) for name in names}
    classes = [name for name, thing in things.items() if inspect.isclass(thing)]
    functions = [name for name in names if name not in classes]
    for title, words, listed in (
        ("Classes", "Shapes, light, looks, and what a bake returns.", classes),
        ("Functions", "What `import meshdepict as md` has.", functions),
    ):
        _write(home / f"{title.lower()}.md", title, words, "meshdepict", listed, things)
    _write_commands(home / "commands.md")
    for key, (module, title, words) in _PARTS.items():
        listed = list(module.__all__)
        found = {name: getattr(module, name) for name in listed}
        _write(home / f"{key}.md", title, words, module.__name__, listed, found)


def _write_commands(path: Path) -> None:
    """Write what each command says of itself."""
    parts = ["# Commands", "What `meshdepict COMMAND --help` says."]
    for name in _COMMANDS:
        said = subprocess.run(
            [sys.executable, "-m", "meshdepict", name, "--help"],
            env={**os.environ, "COLUMNS": "96", "NO_COLOR": "1", "TERM": "dumb"},
            capture_output=True, text=True, check=True, encoding="utf-8",
        )  # fmt: skip
        parts.append(f"## meshdepict {name}\n\n```text\n{said.stdout.strip()}\n```")
    _keep(path, "\n\n".join(parts) + "\n")


def _keep(path: Path, text: str) -> None:
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def _write(
    path: Path, title: str, words: str, module: str, names: list[str], things: dict[str, Any]
) -> None:
    parts = [f"# {title}", words]
    for name in names:
        thing = things[name]
        if inspect.isclass(thing):
            made = f".. autoclass:: {module}.{name}\n   :members:"
        elif callable(thing):
            made = f".. autofunction:: {module}.{name}"
        else:
            continue
        parts.append(f"```{{eval-rst}}\n{made}\n```")
    _keep(path, "\n\n".join(parts) + "\n")
