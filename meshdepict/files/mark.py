"""How files of this program say that they are: in words that other programs pass over."""

from __future__ import annotations

from importlib.metadata import version

__all__ = ["MARK", "SOFTWARE", "VERSION"]

MARK = "meshdepict "
"""How every line of provenance begins."""

VERSION = version("meshdepict")
SOFTWARE = f"meshdepict {VERSION}"
