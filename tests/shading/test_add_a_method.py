"""CONTRIBUTING's worked example: one file and one line, and everything knows the method."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

# Tests that go through all methods: those of the new one, and those that have them in one go.
FAMILIES = {
    "tests/shading/test_shading_family.py": "steepness",
    "tests/shading/test_baselines.py": "steepness",
    "tests/scales/test_image_scales.py": "steepness",
    "tests/scales/test_grid_scales.py": "steepness",
    "tests/viewer/test_session.py": "steepness",
    "tests/commands/test_report.py": "steepness or lists_name",
    "tests/baking/test_volume_baking.py": "every_method_bakes",
    "tests/doors/test_accessor.py": "every_method_is_there",
}


def blocks():
    """Return the section's blocks of Python: a method's file, its line, and a person's own."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    section = re.split(r"^## ", text.partition("## Add a method")[2], flags=re.M)[0]
    file, line, own = re.findall(r"```python\n(.*?)```", section, flags=re.S)
    name = re.search(r"meshdepict/shading/(\w+)\.py`:", section).group(1)
    return name, file, line, own


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The package and its tests with the example's method."""
    copy = tmp_path_factory.mktemp("copy")
    for folder in ("meshdepict", "tests"):
        # What other processes may be writing just now stays out; compiled kernels come along.
        skip = shutil.ignore_patterns("*.pyc*", "*.tmp*")
        shutil.copytree(ROOT / folder, copy / folder, ignore=skip)
    shutil.copy(ROOT / "pyproject.toml", copy)
    name, file, line, _ = blocks()
    (copy / "meshdepict" / "shading" / f"{name}.py").write_text(file, encoding="utf-8")
    catalogue = copy / "meshdepict" / "shading" / "catalogue.py"
    assert len(line.splitlines()) == 1
    catalogue.write_text(catalogue.read_text(encoding="utf-8") + line, encoding="utf-8")
    return copy


def run(folder, *words):
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=folder, capture_output=True, text=True, timeout=900,
        env={**os.environ, "PYTHONPATH": str(folder)},
    )  # fmt: skip
    return done.returncode, done.stdout + done.stderr


def test_a_method_of_one_file_and_one_line_passes_the_tests_of_the_family(copy):
    chosen = " or ".join(dict.fromkeys(FAMILIES.values()))
    status, text = run(copy, "pytest", "-q", "-p", "no:cacheprovider", "-k", chosen, *FAMILIES)
    assert status == 0, text[-3000:]
    assert int(re.search(r"(\d+) passed", text).group(1)) > 30


def test_what_it_runs_is_the_copy(copy):
    status, text = run(copy, "meshdepict", "methods", "steepness")
    assert status == 0, text
    assert "Imhof" in text


def test_the_example_is_linted_as_the_package_is(copy):
    name, *_ = blocks()
    path = f"meshdepict/shading/{name}.py"
    for words in (("check", path, "meshdepict/shading/catalogue.py"), ("format", "--check", path)):
        status, text = run(copy, "ruff", *words)
        assert status == 0, text


def test_a_function_of_ones_own_is_baked_as_the_text_says(folder):
    *_, own = blocks()
    exec(compile(own, "CONTRIBUTING.md", "exec"), {"__name__": "mine"})
    assert (folder / "stripes.ply").exists()
