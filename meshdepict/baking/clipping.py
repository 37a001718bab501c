"""What is too bright to be shown: nobody knows beforehand how much light a panorama has."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.choices import Choices
from meshdepict.errors import MeshdepictWarning
from meshdepict.options import options_of
from meshdepict.scene.environment import Environment
from meshdepict.scene.names import Lighting

__all__ = ["MOST_CLIPPED", "warn_of_clipping"]

MOST_CLIPPED = 0.05
"""Share of the samples that may have a channel of 1 before a note says so."""

_DIM = 1e-3  # of the exposure: a thousand times what is shown is seen unclipped


def warn_of_clipping(
    look: Choices, light: Lighting, values: NDArray[Any], shade: Callable[[Choices], NDArray[Any]]
) -> None:
    """Warn where a panorama clips more than a few samples, with the exposure that does not.

    Parameters
    ----------
    look : Choices
    light : Light, Lights or Environment
    values : (n,) or (n, 3) array
        What the method returned, in [0, 1].
    shade : callable
        What it returns for another look; asked only where values are clipped.
    """
    if not isinstance(light, Environment) or "exposure" not in options_of(look.function):
        return
    clipped = float(np.mean(_brightest(values) >= 1))
    if clipped <= MOST_CLIPPED:
        return
    exposure = look.options.get("exposure", options_of(look.function)["exposure"].default)
    dim = _brightest(shade(look.replace(exposure=exposure * _DIM)))
    fitting = exposure * _DIM / max(float(np.quantile(dim, 1 - MOST_CLIPPED)), 1e-30)
    digits = 10.0 ** np.floor(np.log10(fitting)) / 10  # two digits, rounded down
    fitting = float(np.floor(fitting / digits) * digits)
    warnings.warn(
        f"{clipped:.0%} of the samples are too bright to be shown: exposure={fitting:.2g} "
        f"(--set exposure={fitting:.2g}) leaves {MOST_CLIPPED:.0%}",
        MeshdepictWarning,
        stacklevel=4,
    )


def _brightest(values: NDArray[Any]) -> NDArray[Any]:
    return values if values.ndim == 1 else values.max(axis=1)
