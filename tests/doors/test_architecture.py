"""docs/architecture.md is the house: its tree, its order and its libraries are those on disk."""

import ast

import pytest
from house import ROOT, drawn, imported, libraries, modules, order, room, tree_lines

NAMES = modules()
TREES = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in NAMES.items()}


def test_the_tree_has_every_folder_once_and_every_file_that_is_loose():
    names = [name for line in drawn() for name in line]
    package = ROOT / "meshdepict"
    folders = {f"{path.parent.name}/" for path in package.glob("*/__init__.py")}
    loose = {path.stem for path in package.glob("*.py")}
    assert sorted(names) == sorted(folders | loose)


def test_every_room_says_what_it_is():
    for line in tree_lines():
        assert len(line.split("  ", 1)) == 2, f"nothing is said of {line}"


def test_tests_stand_in_the_rooms_of_what_they_test():
    rooms = {name for names in order() for name in names}
    folders = {path.parent.name for path in (ROOT / "tests").glob("*/test_*.py")}
    assert folders - {"doors", "scripts", "benchmarks", "fuzz", "extremes"} <= rooms


@pytest.mark.parametrize("library", libraries())
def test_a_library_lives_in_its_rooms(library):
    users = {
        room(name)
        for name, tree in TREES.items()
        for target, _ in imported(tree, NAMES)
        if target.split(".")[0] == library
    }
    assert users == libraries()[library]


@pytest.mark.parametrize("library", sorted(set(libraries()) - {"cyclopts"}))
def test_a_library_of_few_rooms_waits_for_the_function_that_needs_it(library):
    for name, tree in TREES.items():
        for target, lazy in imported(tree, NAMES):
            if target.split(".")[0] == library:
                assert lazy, f"{name} imports {library} at its top"
