"""The licences of what the package needs, read from what is installed."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

_TOOLS = {"test", "docs", "bench", "dev"}


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", write_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write_page(app: Sphinx) -> None:
    """Write licences.md."""
    home = Path(app.srcdir)
    project = tomllib.loads((home.parent / "pyproject.toml").read_text("utf-8"))["project"]
    rows = [(name, "") for name in project["dependencies"]]
    for extra, names in project["optional-dependencies"].items():
        rows += [(name, f"`[{extra}]`") for name in names if extra not in _TOOLS]
    text = (
        "# Licences\n\nmeshdepict is under the MIT licence. What it needs, and what its extras "
        "add, has licences of its own:\n\n| package | licence | extra |\n| --- | --- | --- |\n"
    )
    for wanted, extra in rows:
        name = re.split(r"[\[<>=~! ;]", wanted)[0]
        text += f"| {name} | {_licence(name)} | {extra} |\n"
    page = home / "licences.md"
    if not page.exists() or page.read_text("utf-8") != text:
        page.write_text(text, "utf-8")


def _licence(name: str) -> str:
    try:
        said = metadata(name)
    except PackageNotFoundError:
        return "(not installed where this page was made)"
    named = [
        line.rpartition(" :: ")[2]
        for line in said.get_all("Classifier", [])
        if line.startswith("License ::")
    ]
    first = str(said.get("License-Expression") or "") or ", ".join(named)
    lines = str(said.get("License") or "").splitlines()
    return first or (lines[0] if len(lines) == 1 else "see the package")
