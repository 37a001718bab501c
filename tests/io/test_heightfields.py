"""Terrain from rasters: place, units, no data, bands; and what is no terrain, in one sentence."""

import os
import shutil
import warnings

import numpy as np
import pytest
from height_files import DEGREES, asc, geotiff, hills
from volume_files import tiff

import meshdepict as md
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.heightfields import read_heightfield
from meshdepict.io.terrain import Terrain
from meshdepict.io.volumes import read_volume

rasterio = pytest.importorskip("rasterio")

FOOT, SURVEY_FOOT = 0.3048, 1200 / 3937
STATE_PLANE = "EPSG:2263"  # New York, in US survey feet


def read(path, **choices):
    """Read without a word."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return read_heightfield(path, **choices)


# --- place ----------------------------------------------------------------------------------


def test_the_survey_s_text_and_the_raster_made_of_it_are_the_same_terrain(data):
    text, raster = (read(data / "dem" / f"dem_st_helens_30m.{s}") for s in ("dem", "tif"))
    assert text.transform == raster.transform == (30, 0, 557_805, 0, -30, 5_121_975)
    np.testing.assert_array_equal(text.valid, raster.valid)
    np.testing.assert_array_equal(text.z, raster.z)
    assert np.count_nonzero(~text.valid) == 3497
    assert (text.z[text.valid].min(), text.z.max()) == (682, 2543)
    assert "UTM zone 10N" in text.crs


def test_the_survey_s_text_holds_what_gdal_finds_in_it(data):
    path = data / "dem" / "dem_st_helens_30m.dem"
    ours = read(path)
    with rasterio.open(path) as dataset:
        theirs = dataset.read(1, masked=True)
        west, north = dataset.transform.c, dataset.transform.f
    skip = round((north - ours.transform[5]) / 30)  # rows of nothing that GDAL puts round it
    assert west == ours.transform[2]
    assert theirs[:skip].mask.all()
    theirs = theirs[skip : skip + len(ours.z)]
    np.testing.assert_array_equal(~theirs.mask, ours.valid)
    np.testing.assert_array_equal(theirs.filled(0), ours.z)


def test_a_lidar_tile_is_read_as_rasterio_reads_it(data):
    for name in ("dem_slovenia_lidar_1m.tif", "dem_slovenia_lidar_1m_nodata.tif"):
        field = read(data / "dem" / name)
        with rasterio.open(data / "dem" / name) as dataset:
            raw = dataset.read(1)
            assert field.transform == tuple(dataset.transform)[:6]
            assert field.crs == dataset.crs.to_wkt()
        np.testing.assert_array_equal(field.valid, np.isfinite(raw))
        np.testing.assert_array_equal(field.z[field.valid], raw[np.isfinite(raw)])
        assert not field.z[~field.valid].any()
        assert field.attributes["vertical_unit"] == "m"


@pytest.mark.parametrize(
    "transform",
    [(10, 0, 500, 0, -10, 900), (10, 0, 500, 0, 10, 900), (6, 8, 500, 8, -6, 900),
     (-10, 0, 500, 0, -10, 900)],
    ids=["north up", "south up", "turned", "east to west"],
)  # fmt: skip
def test_cells_lie_where_the_transform_says(tmp_path, transform):
    z = hills()
    field = read(geotiff(tmp_path / "a.tif", z, transform=transform))
    assert field.transform == transform
    np.testing.assert_array_equal(field.z, z)
    assert field.unit == 1
    assert not field.degrees


def test_cells_named_by_their_centres_lie_at_the_same_place(tmp_path):
    z = hills()
    area = geotiff(tmp_path / "a.tif", z)
    point = geotiff(
        tmp_path / "p.tif", z, after=lambda d: d.update_tags(AREA_OR_POINT="Point")
    )  # fmt: skip
    assert area.read_bytes() != point.read_bytes()
    assert read(point).transform == read(area).transform


def test_degrees_are_said_to_be_scaled_by_latitude(tmp_path):
    path = geotiff(
        tmp_path / "a.tif", hills(), crs=DEGREES, transform=(1 / 1200, 0, 7, 0, -1 / 1200, 46)
    )  # fmt: skip
    with pytest.warns(MeshdepictWarning, match="scaled by latitude") as told:
        field = read_heightfield(path)
    assert len(told) == 1
    assert "in which unit its heights are: metres" in str(told[0].message)
    assert field.degrees
    assert field.transform == (1 / 1200, 0, 7, 0, -1 / 1200, 46)


@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
@pytest.mark.parametrize("north", [91, 4_650_000, -89.995])
def test_degrees_without_a_latitude_are_refused(tmp_path, north):
    path = geotiff(
        tmp_path / "a.tif", hills(), crs=DEGREES, transform=(1 / 100, 0, 7, 0, -1 / 100, north)
    )  # fmt: skip
    with pytest.raises(MeshdepictError, match=r"a\.tif has latitudes from .* state the system"):
        read_heightfield(path)


def test_a_grid_round_the_whole_earth_ends_at_the_poles(tmp_path):
    z = np.ones((18, 36), np.float32)
    path = geotiff(tmp_path / "a.tif", z, crs=DEGREES, transform=(10, 0, -180, 0, -10, 90))
    with pytest.warns(MeshdepictWarning, match="by latitude"):
        assert read_heightfield(path).degrees


def test_sheared_cells_are_refused(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills(), transform=(10, 5, 0, 0, -10, 0))
    with pytest.raises(MeshdepictError, match=r"a\.tif: the raster is sheared"):
        read_heightfield(path)


def test_degrees_of_another_body_are_refused(tmp_path):
    moon = "+proj=longlat +R=1737400 +no_defs"
    path = geotiff(tmp_path / "a.tif", hills(), crs=moon, transform=(0.01, 0, 7, 0, -0.01, 46))
    with pytest.raises(MeshdepictError, match="degrees on a body of 1,737 km"):
        read_heightfield(path)
    path = geotiff(tmp_path / "b.tif", hills(), crs="+proj=stere +lat_0=90 +R=1737400 +no_defs")
    assert read(path).unit == 1


def test_metres_that_are_longer_than_those_on_the_ground_are_noted(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills(), crs="EPSG:3857")
    with pytest.warns(MeshdepictWarning, match="Web Mercator's, longer than those on the ground"):
        assert read_heightfield(path).unit == 1


def test_a_terrain_without_a_system_is_in_metres_with_a_note(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills(), crs=None)
    with pytest.warns(MeshdepictWarning, match="no coordinate reference system") as told:
        field = read_heightfield(path)
    assert len(told) == 1
    assert (field.crs, field.unit, field.degrees) == ("", 1, False)
    assert field.transform == (10, 0, 1000, 0, -10, 2120)


def test_a_terrain_without_a_place_has_cells_of_a_metre(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills(), crs=None, transform="none")
    with pytest.warns(MeshdepictWarning, match="where it lies: its cells count as 1 m") as told:
        field = read_heightfield(path)
    assert len(told) == 1
    assert field.transform == (1, 0, 0, 0, -1, 12)


def test_degrees_that_nobody_called_so_are_refused(tmp_path):
    path = geotiff(
        tmp_path / "a.tif", hills(), crs=None, transform=(1 / 1200, 0, 7, 0, -1 / 1200, 46)
    )  # fmt: skip
    with pytest.raises(MeshdepictError, match="look like degrees: state the system first"):
        read_heightfield(path)


def test_a_tablet_in_tenths_of_a_millimetre_is_none_of_degrees(tmp_path):
    path = geotiff(
        tmp_path / "a.tif", hills() * np.float32(1e-6), crs=None,
        transform=(1e-4, 0, 0, 0, -1e-4, 0),
    )  # fmt: skip
    with pytest.warns(MeshdepictWarning, match="no coordinate reference system"):
        assert not read_heightfield(path).degrees


def test_points_alone_make_no_grid(tmp_path):
    from rasterio.control import GroundControlPoint

    points = [GroundControlPoint(r, c, 500 + c, 900 - r) for r, c in ((0, 0), (0, 9), (12, 3))]
    path = geotiff(
        tmp_path / "a.tif", hills(), crs=None, transform="none",
        after=lambda d: setattr(d, "gcps", (points, rasterio.CRS.from_epsg(3794))),
    )  # fmt: skip
    with pytest.raises(MeshdepictError, match="placed by single points only"):
        read_heightfield(path)


# --- units ----------------------------------------------------------------------------------


def test_feet_across_are_kept_and_said_in_metres(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills(), crs=STATE_PLANE)
    with pytest.warns(MeshdepictWarning, match="heights in none: metres are taken"):
        field = read_heightfield(path)
    assert field.unit == pytest.approx(SURVEY_FOOT, rel=1e-12)
    assert field.transform[0] == 10  # feet
    np.testing.assert_array_equal(field.z, hills())


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("ft", FOOT), ("feet", FOOT), ("US survey foot", SURVEY_FOOT), ("us-ft", SURVEY_FOOT),
     ("metre", 1), ("Meters", 1), ("cm", 0.01), ("km", 1000)],
)  # fmt: skip
def test_heights_become_metres(tmp_path, unit, metres):
    z = hills()

    def in_unit(dataset):
        dataset.units = [unit]

    found = [
        read(geotiff(tmp_path / "said.tif", z, after=in_unit)),
        read(geotiff(tmp_path / "plain.tif", z), unit=unit),
        read(geotiff(tmp_path / "other.tif", z, after=in_unit), unit="m"),
    ]
    for field, by in zip(found, (metres, metres, 1), strict=True):
        np.testing.assert_allclose(field.z, z * by, rtol=2e-7)
        assert field.z.dtype == np.float32


def test_heights_are_in_the_unit_of_the_system_s_heights(tmp_path):
    feet = "EPSG:2263+6360"  # heights in US survey feet
    field = read(geotiff(tmp_path / "a.tif", hills(), crs=feet))
    np.testing.assert_allclose(field.z, hills() * SURVEY_FOOT, rtol=2e-7)
    assert field.attributes["vertical_unit"] == "us-ft"
    metres = geotiff(tmp_path / "b.tif", hills(), crs="EPSG:2263+5703")
    np.testing.assert_array_equal(read(metres).z, hills())


def test_an_unknown_unit_is_said_and_metres_are_taken(tmp_path):
    def in_kelvin(dataset):
        dataset.units = ["kelvin"]

    path = geotiff(tmp_path / "a.tif", hills(), after=in_kelvin)
    with pytest.warns(MeshdepictWarning, match="'kelvin', is unknown: metres are taken"):
        np.testing.assert_array_equal(read_heightfield(path).z, hills())


@pytest.mark.parametrize("unit", ["parsec", "", 3, "nm"])
def test_what_is_no_unit_is_refused(tmp_path, unit):
    path = geotiff(tmp_path / "a.tif", hills())
    with pytest.raises(MeshdepictError, match="no unit of heights: use one of"):
        read_heightfield(path, unit=unit)


def test_scale_and_offset_are_applied_before_the_unit(tmp_path):
    raw = (hills() - 500).astype(np.int16)

    def scaled(dataset):
        dataset.scales, dataset.offsets, dataset.units = [0.1], [50.0], ["ft"]

    field = read(geotiff(tmp_path / "a.tif", raw, after=scaled))
    np.testing.assert_allclose(field.z, (raw * 0.1 + 50) * FOOT, rtol=1e-6)
    assert (field.attributes["scale"], field.attributes["offset"]) == (0.1, 50)


@pytest.mark.parametrize("scale", [0.0, np.nan, np.inf])
def test_a_scale_that_is_none_is_refused(tmp_path, scale):
    path = geotiff(tmp_path / "a.tif", hills(), after=lambda d: setattr(d, "scales", [scale]))
    with pytest.raises(MeshdepictError, match="says a scale of"):
        read_heightfield(path)


@pytest.mark.parametrize(
    ("kind", "wanted"),
    [("u1", "f4"), ("i2", "f4"), ("u2", "f4"), ("f4", "f4"), ("i4", "f8"), ("u4", "f8"),
     ("f8", "f8")],
)  # fmt: skip
def test_every_number_of_the_file_is_kept(tmp_path, kind, wanted):
    top = 255 if kind == "u1" else 2**15 - 1 if kind[1] == "2" else 2**24 + 1
    z = np.array([[1, 2, 3], [4, 5, top]]).astype(kind)
    field = read(geotiff(tmp_path / "a.tif", z))
    assert field.z.dtype == wanted
    np.testing.assert_array_equal(field.z, z)


# --- no data --------------------------------------------------------------------------------


@pytest.mark.parametrize("nodata", [-9999, np.nan, -3.4028234663852886e38, 0])
def test_cells_of_no_data_have_no_height(tmp_path, nodata):
    z = hills()
    hole = np.zeros(z.shape, bool)
    hole[2:5, 3:6] = hole[0] = True
    z[hole] = nodata
    field = read(geotiff(tmp_path / "a.tif", z, nodata=nodata))
    np.testing.assert_array_equal(field.valid, ~hole)
    np.testing.assert_array_equal(field.z, np.where(hole, 0, z))


def test_a_mask_beside_the_heights_is_believed(tmp_path):
    z, there = hills(), np.ones((12, 9), bool)
    there[3:6, 2:4] = False
    path = geotiff(tmp_path / "a.tif", z, after=lambda d: d.write_mask(there))
    np.testing.assert_array_equal(read(path).valid, there)


@pytest.mark.parametrize("odd", [np.nan, -3.4e38])
def test_cells_that_are_no_numbers_have_no_height(tmp_path, odd):
    z = hills()
    z[4, 4] = odd
    field = read(geotiff(tmp_path / "a.tif", z))
    assert np.argwhere(~field.valid).tolist() == [[4, 4]]
    assert field.z[4, 4] == 0


@pytest.mark.parametrize("odd", [np.inf, -np.inf])
@pytest.mark.parametrize("place", [(0, 0), (200, 100)], ids=["in a corner", "anywhere"])
def test_infinite_cells_have_no_height_with_one_note(tmp_path, odd, place):
    z = hills(900, 300)
    z[place] = odd
    for path in (
        geotiff(tmp_path / "a.tif", z),
        geotiff(tmp_path / "b.tif", z, nodata=-9999),
        [geotiff(tmp_path / "c.tif", z)],
    ):
        with pytest.warns(MeshdepictWarning, match="infinite cells count as cells without") as told:
            field = read_heightfield(path)
        assert len(told) == 1
        assert np.argwhere(~field.valid).tolist() == [list(place)]
        assert field.z[place] == 0
    read(geotiff(tmp_path / "d.tif", z, nodata=odd))  # they are declared to be none


@pytest.mark.parametrize("nothing", [-9999, -32768])
def test_a_number_that_may_mean_no_height_is_said_where_no_one_declares_it(tmp_path, nothing):
    z = hills(300, 300).astype(np.int16)
    z[:, -3:] = nothing
    path = geotiff(tmp_path / "a.tif", z)
    with pytest.warns(
        MeshdepictWarning, match=f"{nothing} counts as a height: .* -a_nodata"
    ) as told:
        assert read_heightfield(path).valid.all()
    assert len(told) == 1
    assert not read(geotiff(tmp_path / "b.tif", z, nodata=nothing)).valid[:, -3:].any()


@pytest.mark.parametrize("kind", ["u1", "i2", "u2", "i4", "f4", "f8"])
@pytest.mark.parametrize("nodata", [0, 77, 255])
def test_what_has_no_height_is_what_gdal_masks(tmp_path, rng, kind, nodata):
    z = rng.integers(0, 256, (40, 30)).astype(kind)
    path = geotiff(tmp_path / "a.tif", z, nodata=nodata)
    with rasterio.open(path) as dataset:
        np.testing.assert_array_equal(read(path).valid, dataset.read_masks(1) > 0)


def test_a_terrain_of_no_data_alone_is_refused(tmp_path):
    path = geotiff(tmp_path / "a.tif", np.full((3, 4), -9999, np.float32), nodata=-9999)
    with pytest.raises(MeshdepictError, match=r"a\.tif holds no heights: all of its cells"):
        read_heightfield(path)


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (1, 1)])
def test_a_single_row_or_column_is_a_terrain(tmp_path, shape):
    z = hills()[: shape[0], : shape[1]]
    np.testing.assert_array_equal(read(geotiff(tmp_path / "a.tif", z)).z, z)


# --- bands and pictures -----------------------------------------------------------------------


def test_a_band_is_chosen_by_its_number(tmp_path):
    bands = np.stack([hills(), hills() + 1000])
    path = geotiff(tmp_path / "a.tif", bands)
    np.testing.assert_array_equal(read(path).z, bands[0])
    np.testing.assert_array_equal(read(path, band=2).z, bands[1])
    for band, what in ((3, "has 2 bands, so that there is no band 3"), (0, "no band 0")):
        with pytest.raises(MeshdepictError, match=what):
            read_heightfield(path, band=band)
    for band in (True, 1.0, "1", None):
        with pytest.raises(MeshdepictError, match="is no number of a band"):
            read_heightfield(path, band=band)


@pytest.mark.parametrize("name", ["a.asc", "a.npy"])
def test_what_has_one_band_has_no_second(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(asc(hills()))
    if name == "a.npy":
        np.save(path, hills())
    with pytest.raises(MeshdepictError, match="has one band, so that there is no band 2"):
        read_heightfield(path, band=2)


@pytest.mark.parametrize("photometric", ["RGB", "YCbCr", "CMYK"])
def test_colours_are_no_heights(tmp_path, photometric):
    bands = np.stack([hills().astype(np.uint8)] * (4 if photometric == "CMYK" else 3))
    packing = {"compress": "JPEG", "interleave": "pixel"} if photometric == "YCbCr" else {}
    path = geotiff(tmp_path / "a.tif", bands, photometric=photometric, **packing)
    for band in (1, 3):
        with pytest.raises(MeshdepictError, match="is a picture, not an elevation model"):
            read_heightfield(path, band=band)


def test_palettes_and_shades_are_no_heights(tmp_path):
    gray = hills().astype(np.uint8)
    colours = {i: (i, i, 0, 255) for i in range(256)}
    palette = geotiff(
        tmp_path / "p.tif", gray, photometric="palette",
        after=lambda d: d.write_colormap(1, colours),
    )  # fmt: skip
    shades = geotiff(
        tmp_path / "s.tif", np.stack([gray, gray]), alpha="yes", photometric="minisblack"
    )
    png = geotiff(tmp_path / "a.png", gray, driver="PNG", transform="none", crs=None)
    for path in (palette, shades, png):
        with pytest.raises(MeshdepictError, match="is a picture, not an elevation model"):
            read_heightfield(path)


def test_complex_numbers_are_no_heights(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills().astype(np.complex64))
    with pytest.raises(MeshdepictError, match="numbers of type complex64, which are no heights"):
        read_heightfield(path)


# --- what a file is -----------------------------------------------------------------------------


def test_a_tiff_on_a_map_is_a_terrain_and_a_stack_is_a_volume(tmp_path):
    stack = tmp_path / "stack.tif"
    stack.write_bytes(tiff(np.arange(60, dtype=np.int16).reshape(3, 4, 5)))
    with pytest.warns(MeshdepictWarning, match="no spacing is given"):
        assert md.read(stack).kind == "volume"
    with pytest.raises(MeshdepictError, match=r"stack\.tif is a stack of 3 pages"):
        read_heightfield(stack)
    path = geotiff(tmp_path / "dem.tif", hills())
    assert md.read(path).kind == "height field"
    with pytest.raises(MeshdepictError, match=r"dem\.tif is an elevation model .* height field"):
        read_volume(path)


def test_a_single_page_of_numbers_is_a_terrain_and_of_shades_a_picture(tmp_path):
    numbers, shades = tmp_path / "numbers.tif", tmp_path / "shades.tif"
    numbers.write_bytes(tiff(hills()[None]))
    shades.write_bytes(tiff(hills()[None].astype(np.uint8)))
    with pytest.warns(MeshdepictWarning, match="cells count as 1 m"):
        assert md.read(numbers).kind == "height field"
    with pytest.raises(MeshdepictError, match=r"shades\.tif is a single picture, neither"):
        md.read(shades)


def test_a_world_file_puts_a_tiff_on_the_map(tmp_path):
    path = tmp_path / "a.tif"
    path.write_bytes(tiff(hills()[None].astype(np.uint8)))
    (tmp_path / "a.tfw").write_text("10\n0\n0\n-10\n1005\n2115\n")
    with pytest.warns(MeshdepictWarning, match="no coordinate reference system"):
        assert md.read(path).transform == (10, 0, 1000, 0, -10, 2120)


def test_the_content_decides_what_a_file_is(tmp_path, sphere):
    z = hills()
    shutil.copy(geotiff(tmp_path / "a.tif", z), tmp_path / "tiff.dem")
    (tmp_path / "grid.dem").write_bytes(asc(z))
    (tmp_path / "grid.txt").write_bytes(asc(z))
    assert md.read(tmp_path / "tiff.dem").transform == (10, 0, 1000, 0, -10, 2120)
    for name in ("grid.dem", "grid.txt"):
        with pytest.warns(MeshdepictWarning, match="no coordinate reference system"):
            assert md.read(tmp_path / name).kind == "height field"
    from meshdepict.io import write_mesh

    write_mesh(tmp_path / "ball.ply", sphere)
    (tmp_path / "ball.ply").rename(tmp_path / "ball.dem")
    assert md.read(tmp_path / "ball.dem").kind == "mesh"
    np.save(tmp_path / "flat.npy", z)
    np.save(tmp_path / "deep.npy", np.arange(60.0).reshape(3, 4, 5))
    with pytest.warns(MeshdepictWarning, match="no spacing is given"):
        assert md.read(tmp_path / "deep.npy").kind == "volume"
    with pytest.warns(MeshdepictWarning, match="an array says no place"):
        assert md.read(tmp_path / "flat.npy").kind == "height field"


@pytest.mark.parametrize(
    ("driver", "name", "kind"),
    [("HFA", "a.img", "f4"), ("EHdr", "a.bil", "f4"), ("ENVI", "a.dat", "f4"),
     ("SAGA", "a.sdat", "f4"), ("RST", "a.rst", "f4"), ("PNG", "a.png", "u2"),
     ("JP2OpenJPEG", "a.jp2", "u2"),
     ("GSBG", "a.grd", "f4")],
)  # fmt: skip
def test_other_rasters_are_read_by_rasterio(tmp_path, driver, name, kind):
    z = hills().astype(kind)
    choices = {"QUALITY": "100", "REVERSIBLE": "YES"} if driver == "JP2OpenJPEG" else {}
    if driver in ("GSBG", "PNG"):
        choices["crs"] = None
    path = geotiff(tmp_path / name, z, driver=driver, **choices)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshdepictWarning)
        field = read_heightfield(path)
    np.testing.assert_array_equal(field.z, z)
    np.testing.assert_allclose(field.transform, (10, 0, 1000, 0, -10, 2120), atol=1e-9)


# --- wrong files --------------------------------------------------------------------------------


def test_a_raster_that_is_cut_off_is_refused_in_a_sentence(tmp_path, capfd):
    path = geotiff(tmp_path / "a.tif", np.tile(hills(), (40, 40)))
    whole = path.read_bytes()
    for length in (3, 8, 100, 1000, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        with pytest.raises(MeshdepictError, match=r"a\.tif is cut off") as told:
            read_heightfield(path)
        assert "\n" not in str(told.value)
    assert capfd.readouterr() == ("", "")


def test_a_header_that_claims_more_than_a_file_holds_is_refused(tmp_path):
    path = geotiff(
        tmp_path / "a.tif", hills(), compress="deflate", tiled=True, blockxsize=16, blockysize=16,
        sparse_ok=True,
    )  # fmt: skip
    data = bytearray(path.read_bytes())
    for tag in (256, 257):
        at = data.find(tag.to_bytes(2, "little") + b"\3\0")
        assert at > 0
        data[at + 8 : at + 10] = (60_000).to_bytes(2, "little")
    path.write_bytes(data)
    with pytest.raises(MeshdepictError, match=r"is cut off|claims more"):
        read_heightfield(path)


def test_an_honest_but_empty_raster_asks_for_more_memory(tmp_path):
    path = tmp_path / "a.tif"
    with rasterio.open(
        path, "w", driver="GTiff", height=30_000, width=30_000, count=1, dtype="float32",
        tiled=True, sparse_ok=True, crs="EPSG:3794", transform=rasterio.Affine(1, 0, 7, 0, -1, 0),
    ) as dataset:  # fmt: skip
        dataset.write(hills(256, 256)[None], window=((512, 768), (256, 512)))
    with pytest.raises(MeshdepictError, match=r"claims more cells .* allow more with --max-memory"):
        read_heightfield(path)
    with Terrain(path) as terrain:  # windows of it are another thing
        z, valid = terrain.read(slice(512, 768), slice(256, 512))
        np.testing.assert_array_equal(z, hills(256, 256))
        assert valid.all()


@pytest.mark.parametrize("name", ["none.tif", "none.asc", "none.npy", "none.dem"])
def test_a_file_that_is_missing_or_empty_is_said_so(tmp_path, name):
    with pytest.raises(MeshdepictError, match=f"{name}: there is no such file"):
        read_heightfield(tmp_path / name)
    (tmp_path / name).touch()
    with pytest.raises(MeshdepictError, match=f"{name} is empty"):
        read_heightfield(tmp_path / name)


def test_what_is_no_file_or_may_not_be_read_is_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe.tif")
    with pytest.raises(MeshdepictError, match="is a named pipe, not a file"):
        read_heightfield(tmp_path / "pipe.tif")
    with pytest.raises(MeshdepictError, match="is a name that no file can have"):
        read_heightfield("a\0.tif")
    with pytest.raises(MeshdepictError, match="is a folder, not a file"):
        read_heightfield(tmp_path)


@pytest.mark.parametrize(
    ("error", "what"),
    [(PermissionError(13, "Permission denied"), "may not be read: permission denied"),
     (OSError(5, "Input/output error"), "could not be read: Input/output error"),
     (MemoryError(), "takes more memory than there is")],
)  # fmt: skip
def test_what_the_system_refuses_is_said_in_a_sentence(tmp_path, monkeypatch, error, what):
    def refused(*_):
        raise error

    path = geotiff(tmp_path / "a.tif", hills())
    terrain = Terrain(path)
    monkeypatch.setattr("meshdepict.io.rasters.heights_of", refused)
    with pytest.raises(MeshdepictError, match=rf"a\.tif {what}"):
        terrain.read()
    terrain.close()


def test_memory_that_gdal_lacks_is_said(tmp_path, monkeypatch):
    path = geotiff(tmp_path / "a.tif", hills())
    terrain = Terrain(path)

    def lacking(*_, **__):
        raise MemoryError

    monkeypatch.setattr(rasterio.io.DatasetReader, "read", lacking, raising=False)
    with pytest.raises(MeshdepictError, match=r"a\.tif takes more memory than there is"):
        terrain.read()
    monkeypatch.undo()
    terrain.close()


def test_files_beside_a_raster_lie_in_its_folder(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "here").mkdir()
    path = geotiff(tmp_path / "here" / "a.tif", hills(600, 600))
    overview = geotiff(tmp_path / "elsewhere" / "a.ovr", hills(300, 300))
    beside = tmp_path / "here" / "a.tif.ovr"
    shutil.copy(overview, beside)
    np.testing.assert_array_equal(read(path).z, hills(600, 600))
    beside.unlink()
    beside.symlink_to(overview)
    with pytest.raises(MeshdepictError, match=r"a\.tif names the file .*only files in its own"):
        read_heightfield(path)


def test_a_file_of_several_rasters_asks_for_one(tmp_path):
    from scipy.io import netcdf_file

    for names in (("z",), ("z", "error")):
        with netcdf_file(tmp_path / "a.nc", "w") as file:
            for name, values in (("y", 2115 - 10 * np.arange(12)), ("x", 1005 + 10 * np.arange(9))):
                file.createDimension(name, len(values))
                axis = file.createVariable(name, "f8", (name,))
                axis[:], axis.units = values, b"m"
                axis.standard_name = f"projection_{name}_coordinate".encode()
            for name in names:
                variable = file.createVariable(name, "f4", ("y", "x"))
                variable[:] = hills()
                variable.units = b"m"
        if len(names) == 2:
            with pytest.raises(MeshdepictError, match=r"a\.nc holds 2 rasters: extract one"):
                read_heightfield(tmp_path / "a.nc")
            return
        with pytest.warns(MeshdepictWarning, match="no coordinate reference system"):
            field = md.read(tmp_path / "a.nc")
        np.testing.assert_array_equal(field.z, hills())
        assert field.transform == (10, 0, 1000, 0, -10, 2120)


def test_without_rasterio_a_sentence_names_the_extra(tmp_path, monkeypatch):
    import meshdepict.io.gdal as module

    path = geotiff(tmp_path / "a.tif", hills())
    (tmp_path / "a.asc").write_bytes(asc(hills()))

    def missing():
        raise ImportError("No module named 'rasterio'")

    monkeypatch.setattr(module, "_module", missing)
    with pytest.raises(MeshdepictError, match=r"a\.tif: reading GeoTIFF.*'meshdepict\[dem\]'"):
        read_heightfield(path)
    with pytest.warns(MeshdepictWarning, match="no coordinate reference system"):
        np.testing.assert_array_equal(read_heightfield(tmp_path / "a.asc").z, hills())


@pytest.mark.parametrize("name", ["a.tif", "a.asc", "a.dem", "a.img", "a.hgt"])
def test_what_is_in_no_format_of_heights_is_said_so_in_few_words(tmp_path, name):
    (tmp_path / name).write_text("It was a dark and stormy night.")
    with pytest.raises(MeshdepictError) as told:
        read_heightfield(tmp_path / name)
    with pytest.raises(MeshdepictError, match="is cut off, damaged or"):
        md.read(tmp_path / name)
    wanted = f"{tmp_path / name} is cut off, damaged or in no format of heights that is known"
    assert str(told.value) == wanted


def test_reading_changes_and_leaves_nothing(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills(), nodata=-1)
    before = path.read_bytes(), sorted(os.listdir(tmp_path))
    read(path)
    assert (path.read_bytes(), sorted(os.listdir(tmp_path))) == before
