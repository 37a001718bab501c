"""Coordinate reference systems as files spell them: degrees or lengths, and which lengths.

A system is a tree of words (well-known text, both versions); ArcInfo's old lists of words, beside
ASCII grids, are understood, too. Only units are read here: the text itself goes from file to file.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any

from meshdepict.errors import MeshdepictError
from meshdepict.io.height_units import METRES, height_unit

__all__ = ["Units", "units_of"]

_GEOGRAPHIC = ("GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS")
_PLANE = (
    "PROJCS", "PROJCRS", "PROJECTEDCRS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS",
    "DERIVEDPROJCRS",
)  # fmt: skip
_HEIGHTS = ("VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS")
_PARTS = ("COMPD_CS", "COMPOUNDCRS", "BOUNDCRS", "SOURCECRS")
_DEGREE = math.pi / 180
_EARTH, _ROUND = 6_378_137.0, 0.01  # metres, and what its ellipsoids differ in and more
_MOST = 1 << 20  # letters of a system's text
_DEEPEST = 64  # of what stands inside of what


@dataclass(frozen=True)
class Units:
    """What a system's coordinates are in.

    Attributes
    ----------
    degrees : bool
        Longitude and latitude.
    unit : float
        Metres of a unit of its lengths.
    vertical : float or None
        Metres of a unit of its heights, where it has any.
    """

    degrees: bool = False
    unit: float = 1.0
    vertical: float | None = None


@dataclass
class _Node:
    name: str
    values: list[str] = field(default_factory=list)
    nodes: list[_Node] = field(default_factory=list)

    def find(self, *names: str) -> _Node | None:
        return next((node for node in self.nodes if node.name in names), None)


def units_of(text: str) -> Units:
    """Return what a system's coordinates are in; metres where it doesn't say.

    Raises
    ------
    MeshdepictError
        For coordinates that are neither degrees nor lengths on a plane: a clause whose subject is
        the file.
    """
    tree = _tree(text[:_MOST])
    if tree is None:
        return _arcinfo(text[:_MOST])
    across = _first(tree, (*_GEOGRAPHIC, *_PLANE, "GEOCCS"))
    up = _first(tree, _HEIGHTS)
    vertical = _length(up) if up else None
    if across is None:
        return Units(vertical=vertical)
    if across.name in _PLANE:
        return Units(unit=_length(across) or 1.0, vertical=vertical)
    kind = across.find("CS")
    if across.name == "GEOCCS" or (kind and kind.values[:1] == ["Cartesian"]):
        raise MeshdepictError(
            "has coordinates from the centre of the earth, not on a map: reproject it (gdalwarp)"
        )
    angle = _own_or_axes(across, "UNIT", "ANGLEUNIT")
    if angle is not None and abs(angle / _DEGREE - 1) > 1e-6:
        raise MeshdepictError(
            "has longitudes and latitudes in another unit than degrees: reproject it (gdalwarp)"
        )
    radius = _radius(across)
    if radius is not None and abs(radius / _EARTH - 1) > _ROUND:
        raise MeshdepictError(
            f"has degrees on a body of {radius / 1000:,.0f} km, and those of the earth are known: "
            "reproject it to metres (gdalwarp)"
        )
    if vertical is None:  # the third axis of longitude, latitude and height
        vertical = next((found for axis in across.nodes if (found := _height_of(axis))), None)
    return Units(degrees=True, vertical=vertical)


def _radius(node: _Node) -> float | None:
    """Return the metres of the equator's radius."""
    for name in ("SPHEROID", "ELLIPSOID"):
        datum = next((part for part in node.nodes if part.find(name)), None)
        found = datum.find(name) if datum else None
        if found and len(found.values) > 1:
            try:
                return float(found.values[1]) * (_number(found, "LENGTHUNIT") or 1.0)
            except ValueError:
                return None
    return None


def _height_of(axis: _Node) -> float | None:
    return _length(axis) if axis.name == "AXIS" and "up" in axis.values else None


def _length(node: _Node) -> float | None:
    """Return the metres of a node's unit."""
    return _own_or_axes(node, "UNIT", "LENGTHUNIT")


def _own_or_axes(node: _Node, *names: str) -> float | None:
    found = _number(node, *names)
    axis = node.find("AXIS")
    return _number(axis, *names) if found is None and axis else found


def _number(node: _Node, *names: str) -> float | None:
    unit = node.find(*names)
    try:
        number = float(unit.values[1]) if unit else math.nan
    except (IndexError, ValueError):
        return None
    return number if 0 < number < math.inf else None


def _first(node: _Node, names: tuple[str, ...]) -> _Node | None:
    """Return the first node of these names, looking into systems of several parts only."""
    if node.name in names:
        return node
    if node.name not in _PARTS:
        return None
    return next((found for part in node.nodes if (found := _first(part, names))), None)


def _tree(text: str) -> _Node | None:
    """Return the tree of well-known text, None where it is none."""
    root = _Node("")
    open_ = [root]
    for word in re.finditer(
        r'"((?:[^"]|"")*)"|([A-Za-z_]\w*)\s*[\[(]|([\])])|([^\s,\[\]()"]+)', text
    ):
        quoted, opened, closed, plain = word.groups()
        if opened is not None:
            node = _Node(opened.upper())
            open_[-1].nodes.append(node)
            open_.append(node)
            if len(open_) > _DEEPEST:
                return None
        elif closed is not None:
            if len(open_) == 1:
                return None
            open_.pop()
        else:
            open_[-1].values.append(plain if quoted is None else quoted)
    return root.nodes[0] if len(open_) == 1 and root.nodes else None


def _arcinfo(text: str) -> Units:
    """Return what lines such as ``Projection GEOGRAPHIC`` and ``Units FEET`` say."""
    words: dict[str, Any] = {
        key.lower(): value.strip().lower()
        for key, value in re.findall(r"(?m)^[ \t]*(\w+)[ \t]+(.*)$", text)
    }
    unit = words.get("units", "")
    vertical = height_unit(words.get("zunits", ""))
    degrees = words.get("projection", "").startswith("geographic")
    if degrees and unit not in ("", "dd", "degrees", "decimal degrees"):
        raise MeshdepictError(
            "has longitudes and latitudes in another unit than degrees: reproject it (gdalwarp)"
        )
    return Units(
        degrees=degrees,
        unit=1.0 if degrees else METRES.get(height_unit(unit), 1.0),
        vertical=METRES.get(vertical),
    )
