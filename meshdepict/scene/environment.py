"""Light from everywhere: an equirectangular picture of radiance, as lights, irradiance and lookups.

The picture's first row is up, its middle lies ahead of a viewer who looks from the front (along −z,
y up), its right quarter to the viewer's right (+x), its two ends behind (+z).
"""

from __future__ import annotations

import math
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.any_numbers import real_array
from meshdepict.options import real
from meshdepict.scene.blurs import (
    WIDEST,
    Blurs,
    blurred,
    levels,
    rows_of,
    source_rows,
    width_of,
)
from meshdepict.scene.equirectangular import (
    bilinear,
    grid,
    read_radiance,
    to_picture,
    to_world,
)
from meshdepict.scene.light import BRIGHTEST, Light
from meshdepict.scene.parts import compact_parts, median_parts, summed
from meshdepict.scene.upright import upright

__all__ = ["LUMINANCE", "SAMPLINGS", "Environment"]

Floats = NDArray[Any]

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear sRGB primaries

SAMPLINGS = ("lobes", "lights")
"""How an environment may be sampled."""

# Ramamoorthi and Hanrahan 2001: what a cosine keeps of each order of spherical harmonics.
_COSINE = (math.pi, 2 * math.pi / 3, math.pi / 4)
_MOST = BRIGHTEST / 1e3  # of a pixel: one light may stand for all of the sphere
_CUT_SOURCE = 512  # rows of the picture that lights are cut from: a third of a degree


class Environment:
    """Radiance from every direction.

    Parameters
    ----------
    pixels : (h, w, 3) array_like
        Linear RGB radiance, 0 … 1e12, equirectangular, as this module's docstring lays it out.
    up : {"y", "z", "-y", "-z", "x", "-x"}
        Which axis of the world points up.
    name : str
        What a caption calls it.
    sampling : {"lobes", "lights"}
        "lobes": lights stand for it where surfaces are matt, and narrow highlights are sampled
        where they are. "lights": version 0.1's lights, by median cut, stand for all of it.
    """

    def __init__(
        self, pixels: ArrayLike, *, up: str = "y", name: str = "", sampling: str = "lobes"
    ) -> None:
        array = real_array(pixels, np.float32)
        if array is None or array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
            raise MeshdepictError("an environment's pixels must have shape (rows, columns, 3)")
        if not ((array >= 0) & (array <= _MOST)).all():
            raise MeshdepictError(
                f"an environment's pixels must be finite and not negative, and {_MOST:g} at most"
            )
        upright(up)  # refuses what can't be up
        if not isinstance(sampling, str) or sampling not in SAMPLINGS:
            raise MeshdepictError(f"sampling={sampling!r} is neither 'lobes' nor 'lights'")
        array.setflags(write=False)
        self.pixels = array
        self.up = up
        self.name = name
        self.sampling = sampling

    @classmethod
    def from_file(cls, path: str | Path, *, up: str = "y", sampling: str = "lobes") -> Environment:
        """Read a Radiance picture (.hdr), latitude by longitude.

        Raises
        ------
        MeshdepictError
            Where there is no such file, or it is something else or damaged.
        """
        if not isinstance(path, (str, Path)):
            raise MeshdepictError(f"an environment's file is given by its path, not as {path!r}")
        pixels = read_radiance(Path(path))
        return cls(pixels, up=up, name=Path(path).stem, sampling=sampling)

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

    @cached_property
    def gray(self) -> bool:
        """Whether it has no colour anywhere."""
        return bool((self.pixels == self.pixels[..., :1]).all())

    def lights(self, count: int = 54) -> list[Light]:
        """Return directional lights that stand for the environment.

        The picture is cut into parts whose light comes from nearly one direction each
        (`meshdepict.scene.parts.compact_parts`), and each becomes a light at its centroid. Where
        `sampling` is "lights", parts have equal power, as version 0.1 cut them.

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
        if self.sampling == "lights":
            return self._median_lights(int(count))
        table = self._table
        lights = []
        for number, part in enumerate(compact_parts(table[..., :4], int(count))):
            r0, r1, c0, c1 = part
            total = table[r1, c1] - table[r0, c1] - table[r1, c0] + table[r0, c0]
            centroid = total[1:4]
            if np.linalg.norm(centroid) <= 1e-9 * abs(total[0]):  # all round, or black
                centroid = self._cells[1][(r0 + r1) // 2, (c0 + c1) // 2]
            name = f"{self.name or 'environment'} {number + 1}"
            color = np.maximum(total[4:], 0) / math.pi
            lights.append(Light(to_world(centroid, self.up), name, color))
        return lights

    def _median_lights(self, count: int) -> list[Light]:
        """Return the lights of version 0.1."""
        flux = self.pixels * self._solid_angles[..., None]
        power = flux @ LUMINANCE
        lights = []
        for number, part in enumerate(median_parts(power, self._solid_angles, count)):
            rows, columns = slice(*part[:2]), slice(*part[2:])
            weight = power[rows, columns]
            towards = self._directions[rows, columns]
            centroid = np.einsum("hw,hwa->a", weight, towards)
            if np.linalg.norm(centroid) <= 1e-9 * weight.sum():  # black, or all round
                centroid = towards[weight.shape[0] // 2, weight.shape[1] // 2]
            color = flux[rows, columns].sum(axis=(0, 1), dtype=np.float64) / math.pi
            lights.append(Light(centroid, f"{self.name or 'environment'} {number + 1}", color))
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

    def lookup(
        self, directions: ArrayLike, *, blur: float | NDArray[Any] = 0.0
    ) -> NDArray[np.float32]:
        """Return the radiance from some directions, between pixels bilinearly.

        Parameters
        ----------
        directions : (n, 3) array_like
            Unit vectors.
        blur : float or (n,) array
            Width in radians of the Gaussian-like (von Mises–Fisher) lobe that the radiance is
            averaged over: what a rough mirror sees. Interpolated between blurred copies.

        Returns
        -------
        (n, 3) array of float32
        """
        if isinstance(blur, np.ndarray) and blur.ndim:
            return self._each_blurred(_vectors(directions, "directions"), blur)
        width = real(blur)
        if width is None or width < 0:
            raise MeshdepictError(f"blur={blur!r} is not a width in radians")
        local = to_picture(_vectors(directions, "directions"), self.up)
        finest = self._levels - 1
        if width <= width_of(finest):  # between the picture and its least blurred copy
            share = np.float32(width / width_of(finest))
            return _mixed(self.pixels, self._copy(finest), share, local)
        level = 2 * math.log2(WIDEST / min(width, WIDEST))
        coarse = min(int(level), finest - 1)
        share = np.float32(level - coarse)
        return _mixed(self._copy(coarse), self._copy(coarse + 1), share, local)

    def _each_blurred(self, directions: Floats, blurs: Floats) -> NDArray[np.float32]:
        """Look up directions (n, 3), each with a blur of its own."""
        if blurs.shape != directions.shape[:-1] or not (blurs >= 0).all():
            raise MeshdepictError(f"blur={blurs!r} is not a width in radians for every direction")
        found = np.empty((len(directions), 3), np.float32)
        finest = self._levels - 1
        least = width_of(finest)
        # The picture itself is the level after the finest.
        level = np.minimum(
            2 * np.log2(WIDEST / np.clip(blurs, least, WIDEST)), finest
        ) + np.maximum(1 - blurs / least, 0)
        coarse = np.minimum(level.astype(np.intp), finest)
        order = np.argsort(coarse, kind="stable")
        cuts = np.searchsorted(coarse[order], np.arange(finest + 2))
        for at, (begin, end) in enumerate(pairwise(cuts)):
            if begin < end:
                some = order[begin:end]
                share = (level[some] - at).astype(np.float32)[:, None]
                finer = self.pixels if at == finest else self._copy(at + 1)
                local = to_picture(directions[some], self.up)
                found[some] = (1 - share) * bilinear(self._copy(at), local)
                found[some] += share * bilinear(finer, local)
        return found

    @property
    def _levels(self) -> int:
        """How many blurred copies there are, down to a pixel."""
        return max(2, levels(math.pi / self.pixels.shape[0]))

    @cached_property
    def _copies(self) -> dict[int, NDArray[np.float32]]:
        return {}

    def _copy(self, level: int) -> NDArray[np.float32]:
        """Return a blurred copy, made when first asked for."""
        if level not in self._copies:
            width = width_of(level)
            flux = self._flux(source_rows(width))
            self._copies[level] = blurred(flux, width, rows_of(width))
        return self._copies[level]

    def blurs(self, finest: float) -> Blurs:
        """Return blurred copies down to a width in radians, or to a pixel; they are kept."""
        count = min(levels(max(finest, 1e-9)), self._levels)
        if count not in self._blurs:
            copies = [self._copy(level) for level in range(count)]
            sizes = np.array([copy.shape[:2] for copy in copies])
            starts = np.append(0, np.cumsum(sizes.prod(axis=1))[:-1]).astype(np.int32)
            rows, columns = sizes.astype(np.int32).T.copy()
            texels = np.concatenate([copy.reshape(-1, 3) for copy in copies])
            self._blurs[count] = Blurs(texels, starts, rows, columns)
        return self._blurs[count]

    @cached_property
    def _blurs(self) -> dict[int, Blurs]:
        return {}

    def reduced(self, rows: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return a coarser picture of whole blocks of pixels, about `rows` high or finer.

        Returns
        -------
        flux : (h, w, 4) array
            Radiance times solid angle, and the solid angle.
        directions : (h, w, 3) array
            To the blocks' middles in the picture's own frame, y up.
        """
        flux = self._flux(rows)
        step = self.pixels.shape[0] // flux.shape[0]
        middles = grid(*self.pixels.shape[:2])
        if step > 1:
            middles = _blocks(middles * self._solid_angles[..., None], step)
            middles /= np.linalg.norm(middles, axis=2, keepdims=True)
        return flux, middles.astype(np.float32)

    def _flux(self, rows: int) -> NDArray[np.float32]:
        """Return the first of `reduced`, kept for another time."""
        height, width = self.pixels.shape[:2]
        common = math.gcd(height, width)
        step = max(
            d for d in range(1, common + 1) if common % d == 0 and d <= max(1, height // rows)
        )
        if step not in self._reductions:
            angles = np.broadcast_to(self._solid_angles, (height, width))[..., None]
            flux = np.concatenate([self.pixels * angles, angles], axis=2, dtype=np.float32)
            self._reductions[1] = self._reductions.get(1, flux)
            self._reductions[step] = _blocks(self._reductions[1], step)
        return self._reductions[step]

    @cached_property
    def _reductions(self) -> dict[int, NDArray[np.float32]]:
        return {}

    @cached_property
    def largest_irradiance(self) -> float:
        """Largest luminance of `irradiance` over all normals."""
        every = to_world(grid(32, 64).reshape(-1, 3), self.up)
        return float((self.irradiance(every) @ LUMINANCE).max())


def _blocks(values: NDArray[Any], step: int) -> NDArray[Any]:
    """Return sums over blocks of pixels of (h, w, k)."""
    if step == 1:
        return values
    height, width, channels = values.shape
    return values.reshape(height // step, step, width // step, step, channels).sum(axis=(1, 3))


def _mixed(
    one: NDArray[np.float32], other: NDArray[np.float32], share: np.float32, directions: Floats
) -> NDArray[np.float32]:
    """Return what lies between two copies in some directions: (1 − share) one + share other."""
    found = bilinear(one, directions) if share < 1 else np.float32(0)
    if share > 0:
        found = (1 - share) * found + share * bilinear(other, directions)
    return np.asarray(found, np.float32)


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
    array = real_array(given)
    if array is None or array.ndim == 0 or array.shape[-1] != 3:
        raise MeshdepictError(f"{what} must be an (n, 3) array of numbers")
    return array
