"""``meshdepict relief``: shaded relief of elevation models, on their own grid."""

from __future__ import annotations

import importlib.util
import time
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from meshdepict.commands import parameters
from meshdepict.commands.parameters import EVERYWHERE, FILES, Everywhere, LookWords, takes_words
from meshdepict.console import notes, progress_bar, say
from meshdepict.errors import MeshdepictError

__all__ = ["relief"]


@takes_words(
    without=(
        "transfer", "facing", "refine", "creases", "normals", "albedo", "ground",
        "two_sided", "view", "up",
    )
)  # fmt: skip
def relief(
    *inputs: Annotated[Path, Parameter(name="DEM")],
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], group=FILES)] = None,
    values: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    band: Annotated[int, Parameter(group=FILES, converter=parameters.whole)] = 1,
    height_unit: Annotated[str | None, Parameter(group=FILES)] = None,
    force: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    scheduler: Annotated[str | None, Parameter(group=EVERYWHERE)] = None,
    workers: Annotated[int | None, Parameter(group=EVERYWHERE, converter=parameters.whole)] = None,
    save_recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    look: LookWords,
    everywhere: Everywhere,
) -> None:
    """Shade elevation models and write the relief on their own grid.

    Models larger than memory are shaded in windows, without seams.

    Parameters
    ----------
    inputs
        A GeoTIFF or another raster that rasterio opens, USGS .dem, ESRI .asc, .npy; several are
        tiles of one model.
    output
        GeoTIFF with the grid, reference system and gaps of the model (.tif), or a picture with a
        world file (.png, .jpg); <name>-<method>.tif in the current folder unless given.
    values
        Write the method's values as float32, and no colours; .tif only.
    band
        Which of a raster's bands holds heights.
    height_unit
        What heights are in, m, ft or us-ft, whatever the file says.
    force
        Replace existing files that meshdepict didn't write.
    recipe
        Take method, light, scales, … from a file; what else is said here comes first.
    scheduler
        Let the workers of a Dask cluster shade the windows: its address, tcp://host:8786 for
        instance; they see the same folders. local: one of this machine's processes.
    workers
        Let so many processes of this machine shade the windows.
    save_recipe
        Write them to a file, as they were said: what follows the terrain is each model's own.
    """
    from meshdepict.baking.provenance import fitted_text
    from meshdepict.baking.recipe import save_recipe as write_recipe
    from meshdepict.baking.relief import Relief
    from meshdepict.baking.targets import check_target, identities
    from meshdepict.distributed.terrain import save_by_workers
    from meshdepict.distributed.workers import Workers
    from meshdepict.io.relief_files import check_relief
    from meshdepict.io.terrain import Terrain

    everywhere.obey()
    if not inputs:
        raise MeshdepictError("which elevation model? meshdepict relief DEM.tif")
    start, spent = time.perf_counter(), time.process_time()
    wanted = parameters.said_look(look, recipe)
    name = inputs[0].name.removesuffix(inputs[0].suffix)
    if output is None:
        suffix = ".tif" if values or importlib.util.find_spec("rasterio") else ".png"
        output = Path(f"{name}-{wanted.title}{suffix}")
    check_target(output, force=force, inputs=identities(inputs))
    paths = inputs[0] if len(inputs) == 1 else inputs
    with (
        notes(inputs[0], quiet=everywhere.quiet),
        Terrain(paths, band=band, unit=height_unit) as terrain,
    ):
        kind = "values" if values else "gray"
        check_relief(output, shape=terrain.shape, kind=kind)
        with progress_bar(name, quiet=everywhere.quiet) as progress:
            shaded = Relief(terrain, wanted, spent=spent + time.perf_counter() - start)
            if save_recipe is not None:
                write_recipe(save_recipe, wanted, force=force)
            if scheduler is None and workers is None:
                shaded.save(output, values=values, progress=progress)
            else:
                team = Workers(scheduler, workers, everywhere.max_memory)
                save_by_workers(shaded, output, team, values=values, progress=progress)
    widths = shaded.widths[1:]
    facts = [
        "" if not wanted.lit else f"light {shaded.provenance['light']}",
        fitted_text(shaded.look),
        f"{len(widths)} scales, widths {widths[0]:g} to {widths[-1]:g} m" if len(widths) else "",
        f"{terrain.cols:,} x {terrain.rows:,} cells",
        shaded.provenance.get("budget", ""),
        f"{time.perf_counter() - start:.1f} s",
    ]
    say(f"{output}: {shaded.look.title}, {', '.join(filter(None, facts))}")
