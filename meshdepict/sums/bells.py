"""Bells that spread points on a grid and gather from it, and the blur that makes Gaussians of them.

A bell has few nodes; between two of them lies a blur of the grid. The transform of the blur is the
Gaussian's over those of both bells, so that bell, blur and bell are the Gaussian, but for what a
bell lets through of frequencies that a grid can't tell apart. The bell is FINUFFT's (Barnett,
Magland and af Klinteberg 2019), exp(β(√(1 − z²) − 1)). B-splines, which let less through on grids
that are 1.7 times finer, were no quicker.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["RULES", "Rule", "bell", "blur_taps", "weight_table"]

Floats = NDArray[np.float64]

STEPS = 1024
"""Of a table of weights, from node to node; a linear interpolation is off by 4·10⁻⁷."""

_FREQUENCIES = 512
_QUADRATURE = 48  # of a bell's transform, exact to 14 digits
_LEAST_TAP = 0.3  # of the error: smaller taps are left out


class Rule(NamedTuple):
    """A bell that keeps an error.

    Attributes
    ----------
    error : float
        Largest of a pair on the line, and of sums over a surface whose points are closer than a
        width, relative to the largest mass, at `density` and on any finer grid. Where all that
        counts lies between the same nodes, the errors of three axes add up.
    nodes : int
        Along each axis, to which a point is spread.
    density : float
        Least number of nodes in a width of the Gaussian.
    steepness : float
        β of the bell, a node.
    """

    error: float
    nodes: int
    density: float
    steepness: float


# Errors of a single pair on the line, the largest over all places between nodes, are up to a fifth
# less.
RULES = (Rule(6e-4, 4, 1.75, 2.5), Rule(5.5e-5, 5, 2.0, 2.4), Rule(6e-6, 6, 2.1, 2.5))
"""Coarsest first."""


def bell(x: Floats, rule: Rule) -> Floats:
    """Return a bell at distances in nodes."""
    inside = np.maximum(1 - (2 * x / rule.nodes) ** 2, 0)
    beta = rule.steepness * rule.nodes
    return np.where(inside > 0, np.exp(beta * (np.sqrt(inside) - 1)), 0)


@functools.cache
def weight_table(rule: Rule, room: int) -> NDArray[np.float32]:
    """Return the weights (STEPS + 1, 2, room) of a point's nodes, and their steps to the next row.

    Row by row for points that are farther beyond their first node: by ``nodes / 2 − 1`` in the
    first row, and by one more in the last. Where a bell has fewer nodes than there is room for,
    zeros follow.
    """
    share = np.arange(STEPS + 1) / STEPS
    ahead = rule.nodes / 2 - 1
    table = np.zeros((STEPS + 1, 2, room), np.float32)
    table[:, 0, : rule.nodes] = bell(np.arange(rule.nodes) - ahead - share[:, None], rule)
    table[:-1, 1] = np.diff(table[:, 0], axis=0)
    return table


@functools.lru_cache(maxsize=64)
def blur_taps(rule: Rule, width: float) -> NDArray[np.float32]:
    """Return the odd number of taps of the blur for a Gaussian of a width in nodes."""
    theta = (np.arange(_FREQUENCIES) + 0.5) * (np.pi / _FREQUENCIES)
    gaussian = width * np.sqrt(2 * np.pi) * np.exp(-0.5 * (theta * width) ** 2)
    wanted = gaussian / _response(rule) ** 2
    numbers = np.arange(int(7 * width) + 2)
    taps = np.cos(np.outer(numbers, theta)) @ wanted / _FREQUENCIES
    reach = int(np.flatnonzero(np.abs(taps) > _LEAST_TAP * rule.error * taps[0]).max())
    return np.concatenate([taps[reach:0:-1], taps[: reach + 1]]).astype(np.float32)


@functools.cache
def _response(rule: Rule) -> Floats:
    """Return the transform of a bell at the middles of `_FREQUENCIES` intervals up to π.

    With z = sin φ the integrand is smooth to the bell's ends, and few nodes of Gauss do.
    """
    theta = (np.arange(_FREQUENCIES) + 0.5) * (np.pi / _FREQUENCIES)
    x, w = np.polynomial.legendre.leggauss(_QUADRATURE)
    phi, w = x * np.pi / 2, w * np.pi / 2
    at, along = np.sin(phi) * rule.nodes / 2, np.cos(phi) * rule.nodes / 2
    response: Floats = np.cos(np.outer(theta, at)) @ (bell(at, rule) * along * w)
    return response
