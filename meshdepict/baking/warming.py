"""What the usual commands do, on small samples: every kernel that they need is compiled for it."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files import cache
from meshdepict.kernels.kernel import FOLDER
from meshdepict.kernels.notice import told
from meshdepict.scales.ladder import Progress

__all__ = ["Warmth", "warm"]

_VERTICES = 12_000
_LIT = ("lambert", "light_warping", "radiance_scaling", "light_alignment")


class Warmth(NamedTuple):
    """What is kept after warming.

    Attributes
    ----------
    compiled : int
        Kernels that were not there before, each counted once for every combination of types.
    kept, size : int
        Files, and their bytes.
    """

    compiled: int
    kept: int
    size: int


def warm(*, progress: Progress | None = None) -> Warmth:
    """Compile what baking by each method needs: of meshes, terrain, volumes and textures.

    Parameters
    ----------
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    MeshdepictError
        Where nothing can be kept.
    """
    folder = cache.cache_folder()
    if folder is None or not cache.keep(f"{FOLDER}/.try", b""):
        raise MeshdepictError(
            f"{folder or 'the cache'} can't be written: set NUMBA_CACHE_DIR to a folder that can"
        )
    (folder / FOLDER / ".try").unlink(missing_ok=True)
    cache.throw_away_unused(FOLDER)
    compiled: list[str] = []
    works = list(_works())
    with told(compiled.append), warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshdepictWarning)  # about samples
        for number, work in enumerate(works):
            if progress:
                progress(number, len(works))
            work()
    sizes = [path.stat().st_size for path in cache.kept_files(FOLDER)]
    return Warmth(len(compiled), len(sizes), sum(sizes))


def _works() -> Iterator[Callable[[], Any]]:
    from meshdepict import samples
    from meshdepict.baking.look import bake, bake_volume
    from meshdepict.baking.textures import bake_texture
    from meshdepict.scene.environment import Environment
    from meshdepict.shading.method import declaration
    from meshdepict.shading.registry import METHODS, OWN

    small = samples.sphere(1_000)
    ball = samples.golf_ball(_VERTICES)
    ground = samples.terrain((96, 96))
    scan = samples.ct_phantom((32, 32, 32))
    for name in OWN:
        needs = declaration(METHODS[name]).needs
        if "heights" not in needs:
            yield functools.partial(_one_bake, bake, ball, name)
        yield functools.partial(_one_bake, bake, ground, name)
        if not needs & {"heights", "rays", "surface", "areas"}:
            yield functools.partial(_one_bake, bake_volume, scan, name)
    sky = Environment(np.ones((8, 16, 3), np.float32) * np.linspace(1, 0.1, 8)[:, None, None])
    for name in _LIT:
        lit = functools.partial(_one_bake, bake, ball, name)
        yield functools.partial(lit, shadows=True, rays=16, bounces=1)
        if declaration(METHODS[name]).lights != "several":
            continue
        yield functools.partial(lit, light="studio")
        yield functools.partial(lit, light=sky)
        yield functools.partial(lit, light=sky, shadows=True, rays=16)
    yield functools.partial(_one_bake, bake, ball, "exaggerated", tolerance=1e-6)
    yield functools.partial(_one_bake, bake, ball, "exaggerated", facing=0)
    for name in ("exaggerated", *_LIT):
        yield functools.partial(_one_bake, bake_texture, small, name, size=256)


def _one_bake(bake: Callable[..., Any], shape: object, method: str, **chosen: Any) -> None:
    bake(shape, method, **chosen)
