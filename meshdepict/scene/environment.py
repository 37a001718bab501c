"""Light from everywhere: an equirectangular picture of radiance, as lights, irradiance and lookups.

The picture's first row is up, its middle lies ahead of a viewer who looks from the front (along −z,
y up), its right quarter to the viewer's right (+x), its two ends behind (+z).
"""

from __future__ import annotations

import math
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.options import real
from meshdepict.scene.equirectangular import (
    bilinear,
    grid,
    read_radiance,
    to_picture,
    to_world,
)
from meshdepict.scene.light import Light
from meshdepict.scene.parts import compact_parts, summed
from meshdepict.scene.upright import upright

__all__ = ["LUMINANCE", "Environment"]

Floats = NDArray[Any]

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear sRGB primaries

# Ramamoorthi and Hanrahan 2001: what a cosine keeps of each order of spherical harmonics.
_COSINE = (math.pi, 2 * math.pi / 3, math.pi / 4)
# Widths in radians of the blurred copies, and the rows that show them without loss.
_BLURS = ((0.1, 64), (0.2, 32), (0.4, 20), (0.8, 12), (1.6, 8))
_CUT_SOURCE = 512  # rows of the picture that lights are cut from: a third of a degree
_BLUR_SOURCE = 64  # rows of the picture that is blurred: half a width of the sharpest copy


class Environment:
    """Radiance from every direction.

    Parameters
    ----------
    pixels : (h, w, 3) array_like
        Linear RGB radiance, equirectangular, as this module's docstring lays it out.
    up : {"y", "z", "-y", "-z", "x", "-x"}
        Which axis of the world points up.
    name : str
        What a caption calls it.
    """

    def __init__(self, pixels: ArrayLike, *, up: str = "y", name: str = "") -> None:
        try:
            array = np.array(pixels, np.float32)
        except (TypeError, ValueError, OverflowError):
            array = np.empty(0, np.float32)
        if array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
            raise MeshdepictError("an environment's pixels must have shape (rows, columns, 3)")
        if not np.isfinite(array).all() or (array < 0).any():
            raise MeshdepictError("an environment's pixels must be finite and not negative")
        upright(up)  # refuses what can't be up
        array.setflags(write=False)
        self.pixels = array
        self.up = up
        self.name = name

    @classmethod
    def from_file(cls, path: str | Path, *, up: str = "y") -> Environment:
        """Read a Radiance picture (.hdr), latitude by longitude.

        Raises
        ------
        MeshdepictError
            Where there is no such file, or it is something else or damaged.
        """
        if not isinstance(path, (str, Path)):
            raise MeshdepictError(f"an environment's file is given by its path, not as {path!r}")
        return cls(read_radiance(Path(path)), up=up, name=Path(path).stem)

    def __str__(self) -> str:
        """Return name and size."""
        height, width = self.pixels.shape[:2]
        return f"{self.name or 'environment'} ({width} x {height}, up {self.up})"

    @cached_property
    def _solid_angles(self) -> NDArray[np.float64]:
        """(h, 1) exact solid angles of the pixels of each row."""
        height, width = self.pixels.shape[:2]
        edges = np.cos(np.linspace(0, math.pi, height + 1))
        return (2 * math.pi / width * (edges[:-1] - edges[1:]))[:, None]

    @cached_property
    def _directions(self) -> NDArray[np.float64]:
        """(h, w, 3) directions to the middles of the pixels, in the world."""
        return to_world(grid(*self.pixels.shape[:2]), self.up)

    @property
    def flux(self) -> NDArray[np.float64]:
        """(3,) radiance integrated over the sphere."""
        return (self.pixels * self._solid_angles[..., None]).sum(axis=(0, 1))

    @cached_property
    def brightest(self) -> float:
        """Largest luminance."""
        return float((self.pixels @ LUMINANCE).max())

    def lights(self, count: int = 54) -> list[Light]:
        """Return directional lights that stand for the environment.

        The picture is cut into parts whose light comes from nearly one direction each
        (`meshdepict.scene.parts.compact_parts`), and each becomes a light at its centroid.

        Parameters
        ----------
        count : int
            How many; fewer only of a picture that has fewer pixels.

        Returns
        -------
        list of Light
            The same every time. π times the sum of their colours is `flux`.
        """
        number = real(count)
        if number is None or not 1 <= number <= 1_000_000 or not number.is_integer():
            raise MeshdepictError(f"count={count!r} is not a number of lights")
        table = self._table
        lights = []
        for number, part in enumerate(compact_parts(table[..., :4], int(count))):
            r0, r1, c0, c1 = part
            total = table[r1, c1] - table[r0, c1] - table[r1, c0] + table[r0, c0]
            centroid = total[1:4]
            if np.linalg.norm(centroid) <= 1e-9 * total[0]:  # all round
                centroid = self._cells[1][(r0 + r1) // 2, (c0 + c1) // 2]
            name = f"{self.name or 'environment'} {number + 1}"
            color = np.maximum(total[4:], 0) / math.pi
            lights.append(Light(to_world(centroid, self.up), name, color))
        return lights

    @cached_property
    def _cells(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """What lights are cut from: flux and solid angle (h, w, 4), and directions, y up."""
        return self.reduced(_CUT_SOURCE)

    @cached_property
    def _table(self) -> NDArray[np.float64]:
        """Summed power, power times direction, and flux: (h + 1, w + 1, 7)."""
        flux, towards = self._cells
        power = flux[..., :3].astype(np.float64) @ LUMINANCE
        # What has no light at all is cut too, if it comes to that: by solid angle.
        power += 1e-12 * (float(power.sum()) or 1.0) / (4 * math.pi) * flux[..., 3]
        moments = power[..., None] * towards
        return summed(np.concatenate([power[..., None], moments, flux[..., :3]], axis=2))

    def irradiance(self, normals: ArrayLike) -> NDArray[np.float64]:
        """Return ∫ ⟨n·l⟩ L(l) dl by spherical harmonics up to order 2.

        Within 9 % of the largest value for any picture, within 1 % on average for natural ones
        (Ramamoorthi and Hanrahan 2001); sums below zero are cut.

        Parameters
        ----------
        normals : (n, 3) array_like

        Returns
        -------
        (n, 3) array
        """
        return np.maximum(_harmonics(_vectors(normals, "normals")) @ self._coefficients, 0)

    @cached_property
    def _coefficients(self) -> NDArray[np.float64]:
        """(9, 3) harmonics of the radiance, each kept as far as a cosine keeps it."""
        flux = (self.pixels * self._solid_angles[..., None]).reshape(-1, 3)
        kept = np.repeat(_COSINE, (1, 3, 5))
        return kept[:, None] * (_harmonics(self._directions.reshape(-1, 3)).T @ flux)

    def lookup(self, directions: ArrayLike, *, blur: float = 0.0) -> NDArray[np.float32]:
        """Return the radiance from some directions, between pixels bilinearly.

        Parameters
        ----------
        directions : (n, 3) array_like
            Unit vectors.
        blur : float
            Width in radians of the Gaussian-like (von Mises–Fisher) lobe that the radiance is
            averaged over: what a rough mirror sees. Interpolated between blurred copies.

        Returns
        -------
        (n, 3) array of float32
        """
        width = real(blur)
        if width is None or width < 0:
            raise MeshdepictError(f"blur={blur!r} is not a width in radians")
        widths = np.array([0.0, *(width for width, _ in _BLURS)])
        level = float(np.interp(width, widths, np.arange(len(widths))))
        lower = min(int(level), len(widths) - 2)
        share = np.float32(level - lower)
        local = to_picture(_vectors(directions, "directions"), self.up)
        found = bilinear(self._copy(lower), local) if share < 1 else np.float32(0)
        if share > 0:
            found = (1 - share) * found + share * bilinear(self._copy(lower + 1), local)
        return np.asarray(found, np.float32)

    @cached_property
    def _copies(self) -> dict[int, NDArray[np.float32]]:
        return {}

    def _copy(self, level: int) -> NDArray[np.float32]:
        """Return the picture itself (0) or one of its blurred copies, made when first asked for."""
        if level == 0:
            return self.pixels
        if level not in self._copies:
            self._copies[level] = self._blurred(*_BLURS[level - 1])
        return self._copies[level]

    def _blurred(self, width: float, rows: int) -> NDArray[np.float32]:
        flux, towards = (part.reshape(-1, part.shape[-1]) for part in self.reduced(_BLUR_SOURCE))
        target = grid(rows, 2 * rows).reshape(-1, 3).astype(np.float32)
        blurred = np.empty((len(target), 3), np.float32)
        for begin in range(0, len(target), 1024):
            lobe = np.exp((target[begin : begin + 1024] @ towards.T - 1) / np.float32(width**2))
            sums = lobe @ flux
            blurred[begin : begin + 1024] = sums[:, :3] / sums[:, 3:]
        return blurred.reshape(rows, 2 * rows, 3)

    def reduced(self, rows: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return a coarser picture of whole blocks of pixels, about `rows` high or finer.

        Returns
        -------
        flux : (h, w, 4) array
            Radiance times solid angle, and the solid angle.
        directions : (h, w, 3) array
            To the blocks' middles in the picture's own frame, y up.
        """
        height, width = self.pixels.shape[:2]
        common = math.gcd(height, width)
        step = max(
            d for d in range(1, common + 1) if common % d == 0 and d <= max(1, height // rows)
        )
        angles = np.broadcast_to(self._solid_angles, (height, width))[..., None]
        if step == 1:
            flux = np.concatenate([self.pixels * angles, angles], axis=2, dtype=np.float32)
            return flux, grid(height, width).astype(np.float32)
        blocks = height // step, step, width // step, step
        parts = np.concatenate([self.pixels * angles, angles, grid(height, width) * angles], axis=2)
        sums = parts.reshape(*blocks, 7).sum(axis=(1, 3))
        towards = sums[..., 4:] / np.linalg.norm(sums[..., 4:], axis=2, keepdims=True)
        return sums[..., :4].astype(np.float32), towards.astype(np.float32)

    @cached_property
    def largest_irradiance(self) -> float:
        """Largest luminance of `irradiance` over all normals."""
        every = to_world(grid(32, 64).reshape(-1, 3), self.up)
        return float((self.irradiance(every) @ LUMINANCE).max())


def _harmonics(directions: Floats) -> Floats:
    """Return the nine real spherical harmonics up to order 2, (…, 9)."""
    x, y, z = np.moveaxis(directions, -1, 0)
    return np.stack(
        [
            np.full_like(x, 0.5 / math.sqrt(math.pi)),
            *(math.sqrt(0.75 / math.pi) * a for a in (x, y, z)),
            *(math.sqrt(3.75 / math.pi) * a for a in (x * y, y * z, x * z)),
            math.sqrt(0.3125 / math.pi) * (3 * z * z - 1),
            math.sqrt(0.9375 / math.pi) * (x * x - y * y),
        ],
        axis=-1,
    )


def _vectors(given: ArrayLike, what: str) -> NDArray[np.float64]:
    """Return (…, 3) numbers."""
    try:
        array = np.asarray(given, np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.empty(0)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise MeshdepictError(f"{what} must be an (n, 3) array of numbers")
    return array
