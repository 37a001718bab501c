"""Methods by what they can shade."""

from __future__ import annotations

from meshdepict.shading.method import declaration
from meshdepict.shading.registry import METHODS

__all__ = ["ON_MESHES", "ON_RASTERS", "needing"]


def needing(*needs: str) -> list[str]:
    """Names of the methods that declare one of these needs."""
    return [name for name in METHODS if declaration(METHODS[name]).needs & {*needs}]


ON_RASTERS = needing("heights")
ON_MESHES = [name for name in METHODS if name not in ON_RASTERS]
