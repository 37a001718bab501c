"""Shape depiction in object space: shade a surface so that people see its form.

Everything public is imported on first use, so that ``import meshdepict`` costs next to nothing::

    import meshdepict as md

    md.bake("scan.ply", "exaggerated", light="northwest").save("scan-exaggerated.ply")
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from meshdepict.errors import MeshdepictError, MeshdepictWarning

if TYPE_CHECKING:
    from meshdepict import curvature, samples, shading
    from meshdepict.baking import Baked, bake
    from meshdepict.environment import Environment
    from meshdepict.io import read, read_mesh
    from meshdepict.mesh import Mesh
    from meshdepict.recipe import load_recipe, save_recipe
    from meshdepict.scales import ScaleSpace, scale_space, smooth_normals
    from meshdepict.scene import Light, View

__all__ = [
    "Baked",
    "Environment",
    "Light",
    "Mesh",
    "MeshdepictError",
    "MeshdepictWarning",
    "ScaleSpace",
    "View",
    "bake",
    "curvature",
    "load_recipe",
    "read",
    "read_mesh",
    "samples",
    "save_recipe",
    "scale_space",
    "shading",
    "smooth_normals",
]

_HOME = {
    "Baked": "baking",
    "Environment": "environment",
    "Light": "scene",
    "Mesh": "mesh",
    "ScaleSpace": "scales",
    "View": "scene",
    "bake": "baking",
    "load_recipe": "recipe",
    "read": "io",
    "read_mesh": "io",
    "save_recipe": "recipe",
    "scale_space": "scales",
    "smooth_normals": "scales",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("meshdepict")
    if name in _HOME:
        return getattr(importlib.import_module(f"meshdepict.{_HOME[name]}"), name)
    if name in __all__:
        return importlib.import_module(f"meshdepict.{name}")
    raise AttributeError(f"module 'meshdepict' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
