"""``meshdepict texture``: shade a mesh's texture, texel by texel."""

from __future__ import annotations

import dataclasses
import time
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from meshdepict.baking.texture_choices import SIZE, AtlasKind, ImageKind, MapKind
from meshdepict.commands import parameters
from meshdepict.commands.parameters import FILES, Everywhere, LookWords, takes_words
from meshdepict.console import notes, progress_bar, say
from meshdepict.errors import MeshdepictError

__all__ = ["texture"]


@takes_words(without=("transfer", "refine", "ground", "z_factor"))
def texture(
    mesh: Annotated[Path | None, Parameter(name="MESH")] = None,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    size: Annotated[int, Parameter(group=FILES, converter=parameters.whole)] = SIZE,
    atlas: Annotated[AtlasKind | None, Parameter(group=FILES)] = None,
    map_kind: Annotated[MapKind, Parameter(name="--map", group=FILES)] = "color",
    detail: Annotated[Path | None, Parameter(group=FILES)] = None,
    cage: Annotated[str | None, Parameter(group=FILES)] = None,
    image: Annotated[ImageKind, Parameter(group=FILES)] = "png",
    quality: Annotated[int | None, Parameter(group=FILES, converter=parameters.whole)] = None,
    winding: Annotated[Literal["auto", "keep"], Parameter(group=FILES)] = "auto",
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    save_recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    look: LookWords,
    everywhere: Everywhere,
) -> None:
    """Shade a mesh's texture, texel by texel: sharp however coarse its triangles are.

    Parameters
    ----------
    mesh
        PLY, OBJ, OFF, STL, GLB, glTF or VTP, gzipped or not.
    output
        The mesh with its texture (.glb, .gltf, .obj, .ply), the texture alone (.png, .jpg, .webp),
        or a page that turns, before and after (.html); <name>-<method>.glb in the current folder
        unless given.
    size
        Texels along the side of the texture, 16 to 16384.
    atlas
        Texture coordinates: the file's own; new ones, a place for every triangle; or charts by
        xatlas, which takes minutes. Unless given its own, and new ones where it has none.
    map_kind
        What to write: the method's colours; or, as a .png, normals in tangent space (green up, of
        the coarsest of --scales), mean curvature, ambient occlusion.
    detail
        A finer mesh of the same object, whose shading the texture gets.
    cage
        How far detail may be from the mesh, in its units or 2% of its diagonal. [default: 2%]
    image
        How the picture beside a mesh, or in its file or page, is packed: png exactly, jpeg and
        webp smaller.
    quality
        Of jpeg and webp, 1 to 100; 90 unless given.
    winding
        auto: turn faces that look inwards before shading; keep: believe the file.
    force
        Replace existing files that meshdepict didn't write, the input among them.
    recipe
        Take method, light, view, scales, … from a file; what else is said here comes first.
    save_recipe
        Write them to a file, as they were said: up and view that nobody names are each mesh's own.
    """
    from meshdepict.baking.baked_texture import check_packing, check_texture
    from meshdepict.baking.provenance import fitted_text, sampled_text
    from meshdepict.baking.recipe import save_recipe as write_recipe
    from meshdepict.baking.targets import check_target, identities
    from meshdepict.baking.textures import map_method, texture_of
    from meshdepict.io import read_mesh

    everywhere.obey()
    if mesh is None:
        raise MeshdepictError("which mesh? meshdepict texture MESH.obj")
    start, spent = time.perf_counter(), time.process_time()
    chosen: Any = look
    method = map_method(map_kind, chosen.method)
    if map_kind != "color":
        look = dataclasses.replace(chosen, method=method)
    wanted = parameters.said_look(look, recipe)
    name = mesh.name.removesuffix(".gz").rpartition(".")[0] or mesh.name
    if output is None:
        shown = wanted.title if map_kind == "color" else map_kind
        output = Path(f"{name}-{shown}{'.glb' if map_kind == 'color' else '.png'}")
    check_texture(output, map_kind)
    check_packing(output, image, quality)
    inputs = identities([mesh, detail])
    check_target(output, force=force, inputs=inputs)
    with (
        notes(mesh, quiet=everywhere.quiet),
        progress_bar(name, quiet=everywhere.quiet) as progress,
    ):
        fine = None if detail is None else read_mesh(detail, winding=winding)
        shape = read_mesh(mesh, winding=winding)
        baked = texture_of(
            shape, wanted, size=size, atlas=atlas, map_kind=map_kind, detail=fine, cage=cage,
            spent=spent + time.perf_counter() - start, progress=progress,
        )  # fmt: skip
        if save_recipe is not None:
            write_recipe(save_recipe, wanted, force=force)
        baked.save(output, image=image, quality=quality)
    scales = baked.provenance["scales"]
    facts = [
        "" if map_kind != "color" or not wanted.lit else f"light {baked.provenance['light']}",
        fitted_text(baked.look) if map_kind == "color" else "",
        sampled_text(baked.provenance),
        "" if scales == "0" else _scales(scales),
        f"{size:,} x {size:,} texels",
        baked.provenance.get("budget", ""),
        f"{time.perf_counter() - start:.1f} s",
    ]
    shown = baked.look.title if map_kind == "color" else f"map of {map_kind}"
    say(f"{output}: {shown}, {', '.join(filter(None, facts))}")


def _scales(said: str) -> str:
    """Return what provenance says of scales in fewer words."""
    count, _, rest = said.partition(", ratio")[0].partition(", ")
    return f"{count} scale{'s' * (count != '1')}, {rest}"
