"""The coordinate reference systems of the Geological Survey's models as well-known text."""

from __future__ import annotations

__all__ = ["usgs_crs"]

_DEGREE = 'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]'
_DATUMS = {
    1: (
        "NAD27", "North_American_Datum_1927", 'SPHEROID["Clarke 1866",6378206.4,294.978698213898]',
        4267,
    ),
    2: ("WGS 72", "World_Geodetic_System_1972", 'SPHEROID["WGS 72",6378135,298.26]', 4322),
    3: ("WGS 84", "WGS_1984", 'SPHEROID["WGS 84",6378137,298.257223563]', 4326),
    4: (
        "NAD83", "North_American_Datum_1983", 'SPHEROID["GRS 1980",6378137,298.257222101]', 4269,
    ),
}  # fmt: skip


def usgs_crs(system: int, zone: int, datum: int) -> str:
    """Return the system as well-known text; "" for one of which only the unit is known.

    Parameters
    ----------
    system : int
        0: longitude and latitude; 1: UTM.
    zone : int
        Of UTM, from 1 to 60; negative ones are south of the equator.
    datum : int
        1: NAD 27; 2: WGS 72; 3: WGS 84; 4: NAD 83.
    """
    if datum not in _DATUMS:
        return ""
    name, full, spheroid, code = _DATUMS[datum]
    sphere = f'GEOGCS["{name}",DATUM["{full}",{spheroid}],{_DEGREE},AUTHORITY["EPSG","{code}"]]'
    if system == 0:
        return sphere
    if system != 1 or not 1 <= abs(zone) <= 60:
        return ""
    side, north = ("N", 0) if zone > 0 else ("S", 10_000_000)
    meridian = 6 * abs(zone) - 183
    return (
        f'PROJCS["{name} / UTM zone {abs(zone)}{side}",{sphere},PROJECTION["Transverse_Mercator"],'
        f'PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",{meridian}],'
        'PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],'
        f'PARAMETER["false_northing",{north}],UNIT["metre",1],AXIS["Easting",EAST],'
        'AXIS["Northing",NORTH]]'
    )
