"""How far colours under an environment are from what more lights and samples would give."""

from __future__ import annotations

from typing import Any

import numpy as np

from meshdepict.baking.choices import Choices
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.options import options_of
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import has_environment
from meshdepict.scene.view import View

__all__ = ["light_error"]

_PROBES = 1024  # vertices, at least: the mean square of their errors is known to a few per cent
_MORE = 4
_MOST_LIGHTS = 65_536  # shading.features.LightCount


def light_error(space: ScaleSpace, look: Choices, view: View) -> float | None:
    """Return the root mean square error in grey levels that sampling an environment leaves.

    A thousand vertices are shaded again with four times as many lights, and as many more samples in
    each lobe. Where errors fall slowly, at the rim under narrow lobes, that is half of the error;
    elsewhere nearly all of it.

    Parameters
    ----------
    space : ScaleSpace
        Of a mesh.
    look : Choices
        With the light that a bake made of it.
    view : View

    Returns
    -------
    float or None
        None where no environment is sampled, or each sample needs all the others.
    """
    known = options_of(look.function)
    if not (has_environment(look.light) and "lights" in known and look.declared.local):
        return None
    chosen = np.arange(0, space.count, max(1, space.count // _PROBES))
    corners = np.repeat(chosen[:, None], 3, axis=1)
    probes = InterpolatedSpace(space, corners, np.eye(3)[np.zeros(len(chosen), int)])
    count = int(look.options.get("lights", known["lights"].default))
    light, more = look.lit_by, look.replace(lights=min(_MORE * count, _MOST_LIGHTS))

    def levels(one: Choices) -> Any:
        values = np.asarray(one.shade(probes, light, view), np.float64)
        return 255 * (linear_to_srgb(values) if look.declared.linear else values)

    return float(np.sqrt(np.mean((levels(look) - levels(more)) ** 2)))
