"""Packages of npm that some tests ask: what they say of our files, and what they show of them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def node_package(name: str) -> Path:
    """The folder of a package, or a skip that says what is missing.

    It is looked for in the folder MESHDEPICT_NODE_MODULES, as ``npm install`` makes one anywhere,
    then in those of NODE_PATH.
    """
    named = [os.environ.get("MESHDEPICT_NODE_MODULES", "")]
    named += os.environ.get("NODE_PATH", "").split(os.pathsep)
    for folder in filter(None, named):
        if (Path(folder) / name / "package.json").is_file():
            return Path(folder).resolve() / name
    pytest.skip(f"{name} is not at hand: npm install it, and set MESHDEPICT_NODE_MODULES")
