"""Shading: one file per method, each a pure function of samples, a light and options."""

from __future__ import annotations

from typing import TYPE_CHECKING

from meshdepict.shading.catalogue import *  # noqa: F403 (every method, by its line there)
from meshdepict.shading.method import Declaration as Declaration
from meshdepict.shading.method import declaration as declaration
from meshdepict.shading.registry import METHODS as METHODS
from meshdepict.shading.registry import OWN
from meshdepict.shading.registry import find_method as find_method

if not TYPE_CHECKING:  # they read the catalogue
    __all__ = ["METHODS", "Declaration", "declaration", "find_method", *OWN]
