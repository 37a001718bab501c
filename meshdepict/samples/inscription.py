"""A weathered inscription: letters that light from one side hardly shows any more."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range
from meshdepict.samples.arguments import MOST, checked
from meshdepict.samples.capitals import distance_to_strokes, strokes
from meshdepict.samples.roughness import roughness
from meshdepict.samples.sheets import grid_faces
from meshdepict.shapes.mesh import Mesh

__all__ = ["inscription"]

Floats = NDArray[np.float64]

# In millimetres, as on a gravestone.
_LETTER = 40.0  # height
_LINE = 64.0  # from a line's foot to the next one's
_MARGIN = 34.0
_GROOVE = 5.0  # half width at the surface
_SWELL = 7.0, 150.0  # of the stone's face, height and wavelength
_GRAIN = 0.07, 8.0
_LOST = 60.0  # wavelength of what is worn more and what less
_SPALL = 2.0, 26.0  # where flakes came off: depth, wavelength


def inscription(
    vertices: Annotated[int, Range(4, MOST)] = 160_000,
    *,
    text: str = "FORMA/MANET·LVCE/VARIA",
    depth: Annotated[float, Range(0, 20, unit="mm")] = 2.4,
    wear: Annotated[float, Range(0, 1)] = 0.75,
) -> Mesh:
    """Return the face of a stone with lines of capitals cut into it, and worn, in millimetres.

    Letters are 40 mm high, in V-shaped grooves. The stone's face swells and is rough, as found
    ones are: what is left of the letters is shallower than its swellings. x runs along the lines,
    y up, z out of the stone; the sheet is open behind.

    Parameters
    ----------
    vertices : int
        About how many: a grid of nearly square cells.
    text : str
        Capitals, spaces and points between words; a slash begins a new line.
    depth : float
        Of a groove when it was cut.
    wear : float
        What is lost of a letter, 0 for nothing. At 1 letters are gone in places.

    Raises
    ------
    MeshdepictError
        For an argument out of its range, or a letter that isn't one of A–Z.
    """
    vertices, depth, wear = checked(inscription, vertices=vertices, depth=depth, wear=wear)
    if not isinstance(text, str):
        raise MeshdepictError(f"inscription: text={text!r} is not a text")
    lines = [strokes(line, "inscription") for line in text.split("/")]
    width = 2 * _MARGIN + _LETTER * max(right for _, right in lines)
    height = 2 * _MARGIN + _LETTER + _LINE * (len(lines) - 1)
    columns = max(2, round((vertices * width / height) ** 0.5))
    rows = max(2, round(vertices / columns))
    x = np.repeat(np.linspace(0, width, columns), rows)
    y = np.tile(np.linspace(0, height, rows), columns)
    level = np.stack((x, y, np.zeros_like(x)), axis=1)
    away = np.full(len(x), _GROOVE)
    for number, (pieces, right) in enumerate(lines):
        start = (width - _LETTER * right) / 2, height - _MARGIN - _LETTER - _LINE * number
        away = np.minimum(
            away, distance_to_strokes(x, y, _LETTER * pieces + np.array(start), _GROOVE)
        )
    lost = wear * np.clip(0.72 + 0.3 * roughness(level, _LOST, octaves=2, seed=1), 0, 1)
    cut = depth * _groove(away / _GROOVE, wear) * (1 - lost)
    swell, length = _SWELL
    grain, grit = _GRAIN
    z = swell * roughness(level, length, octaves=2, seed=2)
    z += (0.3 + 0.7 * wear) * grain * roughness(level, grit, octaves=4, falloff=0.6, seed=3)
    off, flake = _SPALL
    z -= wear * off * _spalls(roughness(level, flake, octaves=3, falloff=0.35, seed=4))
    faces = grid_faces(np.arange(columns * rows).reshape(columns, rows))
    return Mesh(np.stack((x, y, z - cut), axis=1), faces)


def _groove(share: Floats, wear: float) -> Floats:
    """Return the depth of a V at a share of its half width, its edges rounder with wear."""
    sharp = 1 - share
    smooth = sharp * sharp * (3 - 2 * sharp)
    return (1 - wear) * sharp + wear * smooth


def _spalls(noise: Floats) -> Floats:
    """Return 1 where a flake came off and 0 elsewhere, with steep borders."""
    t = np.clip((noise - 1.9) / 0.25, 0, 1)
    return t * t * (3 - 2 * t)
