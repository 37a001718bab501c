"""The house as docs/architecture.md draws it, and as it stands on disk."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def page() -> str:
    """The text of docs/architecture.md."""
    return (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


def tree_lines() -> list[str]:
    """The lines of the tree: names, two spaces or more, what they are."""
    (tree,) = re.findall(r"```\nmeshdepict/\n(.*?)```", page(), flags=re.S)
    return [line.strip() for line in tree.splitlines()]


def drawn() -> list[list[str]]:
    """The names of the tree, line by line, folders with a slash; equals share a line."""
    return [line.split("  ")[0].split() for line in tree_lines()]


def order() -> list[list[str]]:
    """The rooms from the first to the last: imports run from a later one to an earlier one."""
    return [[name.removesuffix("/") for name in names] for names in drawn()]


def libraries() -> dict[str, set[str]]:
    """Libraries that live in few rooms, and in which."""
    rows = re.findall(r"^\| `(\w+)` \| ([\w ]+) \|$", page(), flags=re.M)
    return {library: set(rooms.split()) for library, rooms in rows}


def modules(root: Path = ROOT) -> dict[str, Path]:
    """Every module's path by its name without the package's."""
    found = {}
    for path in sorted((root / "meshdepict").rglob("*.py")):
        parts = path.relative_to(root / "meshdepict").with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" and parts[1:] else parts)] = path
    return found


def imported(tree: ast.AST, known: dict[str, Path]) -> Iterator[tuple[str, bool]]:
    """Yield the modules that code imports anywhere, and whether not at once, if at all.

    That is: when a function runs, or for the type checker alone.
    """

    def walk(node: ast.AST, *, lazy: bool) -> Iterator[tuple[str, bool]]:
        for child in ast.iter_child_nodes(node):
            names = []
            if isinstance(child, ast.Import):
                names = [alias.name for alias in child.names]
            elif isinstance(child, ast.ImportFrom):
                assert not child.level, "relative"
                names = [
                    f"{child.module}.{alias.name}"
                    if f"{child.module}.{alias.name}".removeprefix("meshdepict.") in known
                    else child.module
                    for alias in child.names
                ]
            for name in names:
                yield name, lazy
            inner = lazy or isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef))
            if isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING":
                yield from walk(ast.Module(child.body, []), lazy=True)
                yield from walk(ast.Module(child.orelse, []), lazy=inner)
            else:
                yield from walk(child, lazy=inner)

    yield from walk(tree, lazy=False)


def room(name: str) -> str:
    """The room of a module, or the module itself where it is loose."""
    return name.split(".")[0]
