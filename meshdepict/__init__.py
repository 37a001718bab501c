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
    from meshdepict import congruence, curvature, samples, shading
    from meshdepict.baked import Baked
    from meshdepict.baking import bake
    from meshdepict.comparison import compare
    from meshdepict.environment import Environment
    from meshdepict.gbuffer import GBuffer
    from meshdepict.io import read, read_mesh
    from meshdepict.io.volumes import read_volume
    from meshdepict.mesh import Mesh
    from meshdepict.recipe import load_recipe, save_recipe
    from meshdepict.scales import ScaleSpace, scale_space, smooth_normals
    from meshdepict.scene import Light, View
    from meshdepict.transfer_function import TransferFunction
    from meshdepict.volume import Volume
    from meshdepict.volume_baking import bake_volume

__all__ = [
    "Baked",
    "Environment",
    "GBuffer",
    "Light",
    "Mesh",
    "MeshdepictError",
    "MeshdepictWarning",
    "ScaleSpace",
    "TransferFunction",
    "View",
    "Volume",
    "bake",
    "bake_volume",
    "compare",
    "congruence",
    "curvature",
    "load_recipe",
    "read",
    "read_mesh",
    "read_volume",
    "samples",
    "save_recipe",
    "scale_space",
    "shading",
    "smooth_normals",
]

_HOME = {
    "Baked": "baked",
    "Environment": "environment",
    "GBuffer": "gbuffer",
    "Light": "scene",
    "Mesh": "mesh",
    "ScaleSpace": "scales",
    "TransferFunction": "transfer_function",
    "View": "scene",
    "Volume": "volume",
    "bake": "baking",
    "bake_volume": "volume_baking",
    "compare": "comparison",
    "load_recipe": "recipe",
    "read": "io",
    "read_mesh": "io",
    "read_volume": "io.volumes",
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
