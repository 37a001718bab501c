"""What CONTRIBUTING.md promises to those who carry on."""

import inspect
import os
import re
import sys
import tomllib
from pathlib import Path

import pytest
from house import ROOT

CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
# Files that hand a light on as it is: nobody needs to open them.
PASSED_THROUGH = {
    "meshdepict/cli.py", "meshdepict/baking/choices.py", "meshdepict/shading/method.py",
}  # fmt: skip


def tour():
    """The files that a newcomer opens, in order."""
    (section,) = re.findall(r"^## A tour\n(.*?)^## ", CONTRIBUTING, flags=re.S | re.M)
    return re.findall(r"^\d\. `(meshdepict/\S+\.py)`", section, flags=re.M)


def test_hooks_run_what_ci_runs():
    """ruff, its formatter and mypy, word for word, and nothing else."""
    hooks = (ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8")
    entries = re.findall(r"^ +entry: (.*)$", hooks, flags=re.M)
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    checks = re.findall(r"^\.venv/bin/((?:ruff|mypy).*)$", script, flags=re.M)
    assert len(checks) == 3
    assert entries == checks


@pytest.mark.usefixtures("ball_ply")
def test_a_light_goes_by_the_tour_and_no_other_way(run):
    """Its files are entered in its order, and nobody but those three calls one from another."""
    package, entered, callers = f"{ROOT / 'meshdepict'}{os.sep}", [], []

    def named(frame):
        return f"meshdepict/{Path(frame.f_code.co_filename).relative_to(package).as_posix()}"

    def watch(frame, event, _):
        code = frame.f_code
        ours = code.co_filename.startswith(package) and code.co_name[0] != "<"
        runs = code.co_flags & inspect.CO_OPTIMIZED  # a function, no body of a class
        if event != "call" or not ours or not runs or named(frame) in entered:
            return
        if named(frame) == tour()[0]:
            entered.clear()  # before it, the command was being made
        entered.append(named(frame))
        if code.co_name == "combine_bands":
            while frame is not None:
                callers.extend(named(frame) for _ in [0] if package in frame.f_code.co_filename)
                frame = frame.f_back

    before = sys.getprofile()
    sys.setprofile(watch)
    try:
        assert run("bake", "ball.ply", "--light", "300,20")[0] == 0
    finally:
        sys.setprofile(before)
    assert len(tour()) <= 7
    assert [file for file in entered if file in tour()] == tour()
    assert callers
    assert set(callers) <= {*tour(), *PASSED_THROUGH}


def test_every_extra_that_contributing_names_exists():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "optional-dependencies"
    ]
    named = re.findall(r"'?\.\[(\w+)\]'?", CONTRIBUTING)
    assert named
    assert set(named) <= set(extras)


def test_every_file_that_contributing_names_exists():
    for name in re.findall(r"`((?:\.ci|scripts|tests|benchmarks|docs|meshdepict)/[^`\s]*)`",
                           CONTRIBUTING):  # fmt: skip
        worked_example = "steepness" in name
        assert worked_example or (ROOT / name).exists(), name
