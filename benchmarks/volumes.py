"""CT: the scale space of voxels, a new light, and scipy's plain Gaussian gradient beside it."""

from __future__ import annotations

import numpy as np

import meshdepict as md
from meshdepict.voxels.grid_sums import GRADIENT

SIZES = (96, 160)  # voxels along an axis


class Baking:
    """The procedural head under the preset "bone"; scale space of nine scales and shading."""

    params = (SIZES,)
    param_names = ("size",)
    number, repeat = 1, (1, 3, 60.0)

    def setup(self, size: int) -> None:
        self.volume = md.samples.ct_phantom((size,) * 3)
        md.bake_volume(md.samples.ct_phantom((24, 24, 24)))  # compiles, or loads what was

    def time_baking(self, size: int) -> None:
        self.baked = md.bake_volume(self.volume)

    def peakmem_baking(self, size: int) -> None:
        self.time_baking(size)


class NewLight:
    """From a finished scale space: values alone, or the colours of all voxels."""

    params = (SIZES,)
    param_names = ("size",)

    def setup(self, size: int) -> None:
        self.space = md.bake_volume(md.samples.ct_phantom((size,) * 3)).space
        self.time_shading(size)

    def time_shading(self, size: int) -> None:
        md.bake_volume(self.space, light=(1, 0, 1))

    def time_colours(self, size: int) -> None:
        assert md.bake_volume(self.space, light=(1, 0, 1)).rgba.any()


class Scipy:
    """The peer: derivatives of the whole volume in float64, on one core, cut off at 4 widths."""

    params = ((96,),)
    param_names = ("size",)
    number, repeat = 1, (1, 3, 60.0)

    def setup(self, size: int) -> None:
        self.volume = md.samples.ct_phantom((size,) * 3)
        self.widths = md.bake_volume(md.samples.ct_phantom((24, 24, 24))).space.widths[1:]

    def time_gradients(self, size: int) -> None:
        for width in self.widths:
            scipy_gradients(self.volume, width, truncate=4)


def scipy_gradients(volume: md.Volume, width: float, truncate: float) -> list[np.ndarray]:
    """Return the three derivatives of the Gaussian-smoothed values along the axes."""
    from scipy.ndimage import gaussian_filter

    values = volume.values.astype(np.float64)
    widths = width / volume.spacing[::-1]
    return [gaussian_filter(values, widths, order=o, truncate=truncate) for o in GRADIENT]
