"""Promises of the project as a whole: what the README says is what is run; arrows point one way."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")

# A module's top-level imports come only from rooms to its left.
ORDER = [
    "errors options threads fingerprint picture_input upright ladder",
    "surface voxels icosahedron",
    "mesh volume implicit",
    "phantom",
    "images",
    "gbuffer",
    "samples defects io exchange",
    "transfer_function",
    "transfer",
    "sums",
    "gaussian",
    "smoothing",
    "curvature",
    "scales",
    "mesh_scales image_scales grid_scales interpolated_scales",
    "lights",
    "scene equirectangular environment material",
    "occlusion",
    "shading",
    "color color2d provenance",
    "refinement",
    "baked",
    "baking",
    "volume_place volume_recipe volume_baking out_of_core",
    "isosurface sheet accessor",
    "recipe",
    "viewer console",
    "structure_tensor contours",
    "congruence",
    "targets",
    "comparison comparison_report",
    "report batch",
    "commands",
    "cli",
    "__main__",
]
ROOM = {name: i for i, names in enumerate(ORDER) for name in names.split()}


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
    assert (tmp_path / "ball.ply").exists()


def test_the_readme_lists_every_method():
    from meshdepict.shading import METHODS

    assert set(re.findall(r"^\| `(\w+)` \|", README, flags=re.M)) == set(METHODS)


def modules():
    return sorted((ROOT / "meshdepict").rglob("*.py"))


def top_level_imports(path):
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (
                f"{node.module}.{alias.name}" if node.module == "meshdepict" else node.module
                for alias in node.names
            )


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_point_one_way(path):
    room = path.relative_to(ROOT / "meshdepict").parts[0].removesuffix(".py")
    if room == "__init__":
        pytest.skip("the package itself imports lazily")
    for name in top_level_imports(path):
        assert name.split(".")[0] not in {"pyvista", "vtk", "vtkmodules"}, "import it in a function"
        if name.startswith("meshdepict."):
            target = name.split(".")[1]
            if target in {"MeshdepictError", "__version__"}:
                continue
            assert ROOM[target] <= ROOM[room], f"{room} may not import {target}"


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
