"""Shape depiction in object space: shade a surface so that people see its form.

Everything public is imported on first use, so that ``import meshdepict`` costs next to nothing, and
the command answers Ctrl-C soon::

    import meshdepict as md

    md.bake("scan.ply", "exaggerated", light="northwest").save("scan-exaggerated.ply")
"""

from __future__ import annotations

TYPE_CHECKING = False  # typing's takes milliseconds; type checkers know the name
if TYPE_CHECKING:
    from typing import Any

    from meshdepict import congruence, curvature, samples, shading
    from meshdepict.baking.baked import Baked
    from meshdepict.baking.baked_texture import BakedTexture
    from meshdepict.baking.look import bake, bake_together, bake_volume
    from meshdepict.baking.method_list import methods
    from meshdepict.baking.out_of_core import bake_lazily, bake_out_of_core
    from meshdepict.baking.plates import plate
    from meshdepict.baking.recipe import load_recipe, save_recipe
    from meshdepict.baking.textures import bake_texture
    from meshdepict.color.transfer_function import TransferFunction
    from meshdepict.congruence.comparison import compare
    from meshdepict.errors import MeshdepictError, MeshdepictWarning
    from meshdepict.io import read, read_mesh
    from meshdepict.io.heightfields import read_heightfield
    from meshdepict.io.volumes import read_volume
    from meshdepict.scales.making import scale_space, smooth_normals
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.scene.environment import Environment
    from meshdepict.scene.light import Light
    from meshdepict.scene.view import View
    from meshdepict.shading.method import method
    from meshdepict.shapes.gbuffer import GBuffer
    from meshdepict.shapes.ground_plane import ground_under
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.volume import Volume

__all__ = [
    "Baked",
    "BakedTexture",
    "Environment",
    "GBuffer",
    "HeightField",
    "Light",
    "Look",
    "Mesh",
    "MeshdepictError",
    "MeshdepictWarning",
    "ScaleSpace",
    "TransferFunction",
    "View",
    "Volume",
    "bake",
    "bake_lazily",
    "bake_out_of_core",
    "bake_texture",
    "bake_together",
    "bake_volume",
    "compare",
    "congruence",
    "curvature",
    "ground_under",
    "load_recipe",
    "method",
    "methods",
    "plate",
    "read",
    "read_heightfield",
    "read_mesh",
    "read_volume",
    "samples",
    "save_recipe",
    "scale_space",
    "shading",
    "smooth_normals",
]

_HOME = {
    "Baked": "baking.baked",
    "BakedTexture": "baking.baked_texture",
    "Environment": "scene.environment",
    "GBuffer": "shapes.gbuffer",
    "HeightField": "shapes.height_field",
    "Look": "baking.look",
    "Light": "scene.light",
    "Mesh": "shapes.mesh",
    "MeshdepictError": "errors",
    "MeshdepictWarning": "errors",
    "ScaleSpace": "scales.space",
    "TransferFunction": "color.transfer_function",
    "View": "scene.view",
    "Volume": "shapes.volume",
    "bake": "baking.look",
    "bake_lazily": "baking.out_of_core",
    "bake_out_of_core": "baking.out_of_core",
    "bake_texture": "baking.textures",
    "bake_together": "baking.look",
    "bake_volume": "baking.look",
    "compare": "congruence.comparison",
    "ground_under": "shapes.ground_plane",
    "load_recipe": "baking.recipe",
    "method": "shading.method",
    "methods": "baking.method_list",
    "plate": "baking.plates",
    "read": "io",
    "read_heightfield": "io.heightfields",
    "read_mesh": "io",
    "read_volume": "io.volumes",
    "save_recipe": "baking.recipe",
    "scale_space": "scales.making",
    "smooth_normals": "scales.making",
}


def __getattr__(name: str) -> Any:
    import importlib

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
