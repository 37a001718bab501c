"""Promises of the project as a whole: what the README says is what is run; arrows point one way."""

import ast
import graphlib
import re
import shutil
import subprocess
import sys

import pytest
from house import ROOT, imported, modules, order, room

README = (ROOT / "README.md").read_text(encoding="utf-8")

# Imports run from a later room to an earlier one, wherever they are written.
RANK = {name: i for i, names in enumerate(order()) for name in names}


def set_up_commands():
    return re.findall(r"^python3 -m venv .*$", README, flags=re.M)


def test_the_readme_has_two_set_up_commands_and_ci_runs_them_as_they_are():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    commands = set_up_commands()
    assert len(commands) == 2
    for command in commands:
        assert command in script


def test_the_readme_code_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", README, flags=re.S)
    assert blocks
    for block in blocks:
        exec(compile(block, "README.md", "exec"), {})
    assert (tmp_path / "tablet.ply").exists()


def test_the_readme_fits_on_a_screen_and_leads_to_pages_that_are_there():
    assert len(README.splitlines()) < 80
    assert len(re.findall(r"^!\[", README, flags=re.M)) == 1
    links = re.findall(r"\]\(([^)#]+)", README)
    assert len(links) > 5
    for link in links:
        assert (ROOT / link).exists(), link


# The doors that open backwards, each with its reason: this list may only shrink.
DOORS = {
    ("baking.baked", "viewer.windows.showing"): "Baked.show opens the window on a bake",
    ("baking.baked", "viewer.page"): "Baked.save writes a page that turns",
}


def imports(path, known):
    """Yield the modules that a file imports anywhere, and whether only when a function runs."""
    return imported(ast.parse(path.read_text(encoding="utf-8")), known)


def arrows(root=ROOT):
    """Return the arrows between this package's modules, as pairs of names."""
    known, found = modules(root), set()
    for name, path in known.items():
        for target, _ in imports(path, known):
            if target == "meshdepict" or target.startswith("meshdepict."):
                there = target.removeprefix("meshdepict").removeprefix(".") or "__init__"
                if there != name:
                    found.add((name, there))
    return found


def upward(root=ROOT):
    """Return the arrows that run against the order of the rooms."""

    def rank(name):
        return RANK[name.split(".")[0]]

    return {(here, there) for here, there in arrows(root) if rank(there) > rank(here)}


def test_every_room_has_a_place_in_the_order():
    assert {name.split(".")[0] for name in modules()} == set(RANK)


def test_imports_run_from_later_rooms_to_earlier_ones():
    assert upward() == set(DOORS)
    assert len(DOORS) <= 3


@pytest.mark.parametrize(
    "line", ["def late():\n    import meshdepict.baking.surfaces\n",
             "def late():\n    def later():\n        from meshdepict.viewer import session\n",
             "if TYPE_CHECKING:\n    from meshdepict.baking.baked import Baked\n"]
)  # fmt: skip
def test_an_import_that_hides_in_a_function_is_seen(tmp_path, line):
    shutil.copytree(ROOT / "meshdepict", tmp_path / "meshdepict")
    spoiled = tmp_path / "meshdepict" / "sums" / "gaussian.py"
    with spoiled.open("a", encoding="utf-8") as file:
        file.write(f"\n\n{line}")
    (more,) = upward(tmp_path) - set(DOORS)
    assert more[0] == "sums.gaussian"


def test_no_files_import_each_other_in_a_circle():
    ahead = {name: set() for name in modules()}
    for here, there in arrows() - set(DOORS):
        ahead[here].add(there)
    sorter = graphlib.TopologicalSorter(ahead)
    sorter.prepare()  # raises a CycleError that names the circle


def private(name):
    return name.startswith("_") and not name.endswith("__")


def made(tree):
    """Yield the names with an underscore that code defines: functions, classes, attributes."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            yield node.name
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (target.id for target in targets if isinstance(target, ast.Name))


def test_what_another_room_uses_has_no_underscore():
    trees = {name: ast.parse(path.read_text("utf-8")) for name, path in modules().items()}
    ours = {}
    for name, tree in trees.items():
        ours.setdefault(room(name), set()).update(filter(private, made(tree)))
    everyones, found = set().union(*ours.values()), set()
    for name, tree in trees.items():
        for node in ast.walk(tree):
            used = []
            if isinstance(node, ast.Attribute) and private(node.attr):
                used = [node.attr]
            elif isinstance(node, ast.ImportFrom) and node.module.startswith("meshdepict."):
                used = [alias.name for alias in node.names if private(alias.name)]
            found |= {(name, one) for one in used if one in everyones - ours[room(name)]}
    assert not found


def test_only_doors_and_leaves_are_loose():
    assert len(list((ROOT / "meshdepict").glob("*.py"))) <= 8


@pytest.mark.parametrize("name", modules())
def test_vtk_is_imported_where_it_is_used(name):
    known = modules()
    for target, lazy in imports(known[name], known):
        if target.split(".")[0] in {"pyvista", "vtk", "vtkmodules"}:
            assert lazy, "import it in a function, or for the type checker alone"


@pytest.mark.parametrize(
    ("code", "waits"),
    [("import pyvista", False), ("class A:\n    import pyvista", False),
     ("if True:\n    import pyvista", False), ("def f():\n    import pyvista", True),
     ("if TYPE_CHECKING:\n    import pyvista", True),
     ("if TYPE_CHECKING:\n    pass\nelse:\n    import pyvista", False)]
)  # fmt: skip
def test_what_waits_is_told_from_what_is_imported_at_once(code, waits):
    assert list(imported(ast.parse(code), modules())) == [("pyvista", waits)]


def test_importing_the_package_loads_nothing_heavy():
    code = (
        "import sys, meshdepict; "
        "heavy = 'pyvista vtk vtkmodules scipy numba numpy'.split(); "
        "print([m for m in heavy if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_public_name_resolves():
    import meshdepict

    for name in meshdepict.__all__:
        assert getattr(meshdepict, name) is not None
    assert set(meshdepict.__all__) <= set(dir(meshdepict))
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        meshdepict.nonsense  # noqa: B018


def test_no_file_has_the_name_of_a_public_function():
    import meshdepict

    stems = {path.stem for path in (ROOT / "meshdepict").glob("*.py")}
    assert not stems & (set(meshdepict.__all__) - {"congruence", "curvature", "samples", "shading"})


def test_the_version_is_said_once():
    import meshdepict

    pyproject = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert f'version = "{meshdepict.__version__}"' in pyproject
