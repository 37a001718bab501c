"""Files beside a picture that say where on a map it lies: world files and GDAL's AUX.XML."""

from __future__ import annotations

from xml.sax.saxutils import escape

from meshdepict.heights.cells import Transform

__all__ = ["auxiliary", "world"]


def world(transform: Transform) -> bytes:
    """Return a world file: steps along a row and down a column, and the first pixel's centre."""
    a, b, c, d, e, f = transform
    numbers = (a, d, b, e, c + (a + b) / 2, f + (d + e) / 2)
    return "".join(f"{number!r}\n" for number in map(float, numbers)).encode()


def auxiliary(transform: Transform, crs: str) -> bytes:
    """Return GDAL's words: the transform, and the coordinate reference system as WKT."""
    a, b, c, d, e, f = map(float, transform)
    system = f'  <SRS dataAxisToSRSAxisMapping="{_axes(crs)}">{escape(crs)}</SRS>\n' if crs else ""
    numbers = ", ".join(map(repr, (c, a, b, f, d, e)))
    return (
        f"<PAMDataset>\n{system}  <GeoTransform>{numbers}</GeoTransform>\n</PAMDataset>\n"
    ).encode()


def _axes(crs: str) -> str:
    """Return which of the system's axes x and y are: WKT of a sphere begins with latitude."""
    return "2,1" if crs.lstrip().upper().startswith(("GEOGCS", "GEOGCRS", "GEODCRS")) else "1,2"
