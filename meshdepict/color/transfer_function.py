"""TransferFunction: opacity and colour by CT number, in lines between points, and its file."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdepict.color.hounsfield import AIR, check_rescale
from meshdepict.errors import MeshdepictError
from meshdepict.files.atomic import atomic_write
from meshdepict.files.reach import regular
from meshdepict.options import nearest, real
from meshdepict.scene.vectors import frozen

__all__ = ["TransferFunction"]

Floats = NDArray[np.float32]

_KEYS = ("name", "unit", "material", "points", "gradient_opacity")
_SOFT_TISSUE = 40.0  # HU
_PART = 1 << 13  # values looked up in one go: what NumPy makes of them stays in the cache


class TransferFunction:
    """Opacity and base colour by value, in straight lines between points.

    Parameters
    ----------
    points : sequence of (value, opacity, (r, g, b))
        By rising value; opacity 0 … 1 per voxel; the colour as sRGB display values 0 … 1 or
        "#rrggbb". Before the first point and after the last both stay as they are there.
    gradient_opacity : sequence of (magnitude, factor), optional
        What the opacity is multiplied by, by the gradient's magnitude in units per mm, also where
        the volume's lengths are in µm or m (per its own unit where it has none): hides the even
        inside of tissues and keeps their borders.
    name : str
    unit : {"HU", "raw"}
        What the values are; a volume has to be in the same (see `for_volume`).
    material : float
        What fills most of the object, in HU: muscle and water by default.

    Raises
    ------
    MeshdepictError
        For fewer than two points, values that don't rise, opacities and colours out of [0, 1].
    """

    def __init__(
        self,
        points: Iterable[Any],
        *,
        gradient_opacity: Iterable[Any] | None = None,
        name: str = "custom",
        unit: str = "HU",
        material: float = _SOFT_TISSUE,
    ) -> None:
        where = f"the transfer function {name!r}"
        if not isinstance(unit, str) or unit not in ("HU", "raw"):
            raise MeshdepictError(f"{where}: unit={unit!r} is neither 'HU' nor 'raw'")
        number = real(material)
        if number is None or not number > AIR:
            raise MeshdepictError(f"{where}: material={material!r} is not a number above air's")
        rows = _rows(points, 5, f"{where}: points are (value, opacity, (r, g, b))")
        if rows[:, 1:].min() < 0 or rows[:, 1:].max() > 1:
            raise MeshdepictError(f"{where}: an opacity or colour is not in 0 … 1")
        self.values, self.opacities, self.colors = (
            frozen(part.copy()) for part in (rows[:, 0], rows[:, 1], rows[:, 2:])
        )
        self.gradient_opacity: NDArray[np.float64] | None = None
        if gradient_opacity is not None:
            rows = _rows(gradient_opacity, 2, f"{where}: gradient opacity is (magnitude, factor)")
            if rows.min() < 0 or rows[:, 1].max() > 1:
                raise MeshdepictError(
                    f"{where}: a gradient's magnitude is negative or its factor not in 0 … 1"
                )
            self.gradient_opacity = frozen(rows)
        self.name, self.unit, self.material = str(name), unit, number

    def __repr__(self) -> str:
        """Return name, number of points and range of values."""
        low, high = self.values[0], self.values[-1]
        count = len(self.values)
        return f"<TransferFunction {self.name!r}: {count} points, {low:g} … {high:g} {self.unit}>"

    # --- looking up -------------------------------------------------------------------------

    def opacity(self, values: ArrayLike, gradient: ArrayLike | None = None) -> Floats:
        """Return the opacity of values, in [0, 1].

        Parameters
        ----------
        values : (...) array_like
        gradient : (...) array_like, optional
            Magnitude of the gradient in units per mm; only used with a gradient opacity.

        Returns
        -------
        (...) ndarray of float32
        """
        found = self._looked_up(np.asarray(values), self.opacities[:, None])[..., 0]
        if gradient is not None and self.gradient_opacity is not None:
            magnitude, factor = self.gradient_opacity.T
            found = found * np.interp(np.asarray(gradient), magnitude, factor).astype(np.float32)
        return found

    def color(self, values: ArrayLike) -> Floats:
        """Return the base colour of values, (..., 3) sRGB display values in [0, 1]."""
        return self._looked_up(np.asarray(values), self.colors)

    def _looked_up(self, values: NDArray[Any], columns: NDArray[np.float64]) -> Floats:
        """Interpolate columns: from tables of all values where there are at most 65,536."""
        found = np.empty((values.size, columns.shape[1]), np.float32)
        flat = np.ascontiguousarray(values).reshape(-1)
        tabled = flat.dtype.kind in "iu" and flat.dtype.itemsize <= 2 and flat.size > 8 * _PART
        if tabled:
            ends = np.iinfo(flat.dtype)
            # In the order of the unsigned bit patterns: −1 is the last of them.
            every = np.arange(ends.max - ends.min + 1).astype(flat.dtype)
            flat = flat.view(f"u{flat.dtype.itemsize}")
        for at, column in enumerate(columns.T):
            table = np.interp(every, self.values, column).astype(np.float32) if tabled else None
            for start in range(0, flat.size, _PART):
                part = flat[start : start + _PART]
                read = np.interp(part, self.values, column) if table is None else table[part]
                found[start : start + _PART, at] = read
        return found.reshape(*values.shape, columns.shape[1])

    # --- other numbers ----------------------------------------------------------------------

    def in_raw_numbers(self, slope: float, intercept: float) -> TransferFunction:
        """Return the function of raw numbers, where HU = slope · raw + intercept.

        Raises
        ------
        MeshdepictError
            For a slope that is not positive, and a function of raw numbers.
        """
        check_rescale(slope, intercept)
        if self.unit == "raw":
            raise MeshdepictError(f"the transfer function {self.name!r} is one of raw numbers")
        gradient = self.gradient_opacity
        return TransferFunction(
            zip((self.values - intercept) / slope, self.opacities, self.colors, strict=True),
            gradient_opacity=None if gradient is None else gradient / (slope, 1),
            name=self.name,
            unit="raw",
            material=self.material,
        )

    # --- files ------------------------------------------------------------------------------

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str]) -> TransferFunction:
        """Read a transfer function from a small TOML file.

        The file holds::

            name = "enamel"            # else the file's
            unit = "HU"                # or "raw"
            points = [                 # by rising value
              { value = 1500, opacity = 0.0, color = "#c8b496" },
              { value = 2200, opacity = 1.0, color = [1.0, 1.0, 0.96] },
            ]
            gradient_opacity = [[0, 0.0], [200, 1.0]]    # optional

        Raises
        ------
        MeshdepictError
            Where the file can't be read, is no TOML or holds something else.
        """
        if not isinstance(path, (str, os.PathLike)):
            raise MeshdepictError(f"a transfer function's file is given by its path, not {path!r}")
        path = Path(path)
        regular(path)
        try:
            table = tomllib.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise MeshdepictError(f"{path} can't be read: {error.strerror}") from None
        except RecursionError:
            raise MeshdepictError(f"{path} is no transfer function: it nests too deep") from None
        except ValueError as error:  # TOML's, those of letters, and of numbers of 5,000 digits
            raise MeshdepictError(f"{path} is no transfer function in TOML: {error}") from None
        try:
            return cls.of_table(table, path.stem)
        except MeshdepictError as error:
            raise MeshdepictError(f"{path}: {error}") from None

    @classmethod
    def of_table(cls, table: Mapping[str, Any], name: str) -> TransferFunction:
        """Return the function that a table of `from_toml` says, by a name where it has none.

        Raises
        ------
        MeshdepictError
            For an unknown key, or points in another form.
        """
        if not isinstance(table, Mapping):
            raise MeshdepictError("a transfer function is a table of points")
        for key in table:
            if key not in _KEYS:
                raise MeshdepictError(
                    f"transfer functions have no {key!r}{nearest(key, _KEYS)} (they have "
                    f"{', '.join(_KEYS)})"
                )
        points = table.get("points")
        wanted = {"value", "opacity", "color"}
        if not isinstance(points, list) or not all(
            isinstance(point, dict) and point.keys() == wanted for point in points
        ):
            raise MeshdepictError("points must be a list of { value, opacity, color }")
        rest = {key: value for key, value in table.items() if key != "points"}
        rows = [(point["value"], point["opacity"], point["color"]) for point in points]
        return cls(rows, **{"name": name, **rest})

    def to_toml(self, path: str | os.PathLike[str]) -> None:
        """Write what `from_toml` reads.

        Raises
        ------
        MeshdepictError
            Where the file can't be written.
        """
        import json

        lines = [
            f"name = {json.dumps(self.name, ensure_ascii=False)}",
            f'unit = "{self.unit}"',
            f"material = {self.material!r}",
            "points = [",
        ]
        for value, opacity, color in zip(
            self.values.tolist(), self.opacities.tolist(), self.colors.tolist(), strict=True
        ):
            lines.append(f"  {{ value = {value!r}, opacity = {opacity!r}, color = {color!r} }},")
        lines.append("]")
        if self.gradient_opacity is not None:
            lines.append(f"gradient_opacity = {self.gradient_opacity.tolist()!r}")
        with atomic_write(path) as stream:
            stream.write("\n".join([*lines, ""]).encode())


def _rows(given: Iterable[Any], width: int, wanted: str) -> NDArray[np.float64]:
    """Return points as rows of numbers with rising first ones."""
    try:
        rows = np.array([_flat(row) for row in given], np.float64)
    except (TypeError, ValueError, OverflowError):
        rows = np.empty(0)
    if rows.ndim != 2 or rows.shape[1] != width or len(rows) < 2 or not np.isfinite(rows).all():
        raise MeshdepictError(f"{wanted}, finite numbers, at least two points")
    if (np.diff(rows[:, 0]) <= 0).any():
        raise MeshdepictError(f"{wanted}, by rising first number")
    return rows


def _flat(row: Any) -> list[float]:
    flat: list[float] = []
    for item in row:
        if isinstance(item, str):
            if not re.fullmatch(r"#[0-9a-fA-F]{6}", item):
                raise ValueError
            flat += [int(item[at : at + 2], 16) / 255 for at in (1, 3, 5)]
        else:
            flat += np.asarray(item, np.float64).ravel().tolist()
    return flat
