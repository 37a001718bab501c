"""Terrain as text: ESRI's ASCII grids and the Geological Survey's models; and NumPy's arrays."""

import gzip
import warnings

import numpy as np
import pytest
from height_files import asc, hills, usgs

import meshdepict as md
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.crs import units_of
from meshdepict.io.heightfields import read_heightfield
from meshdepict.io.usgs_crs import usgs_crs

FOOT, SURVEY_FOOT = 0.3048, 1200 / 3937
ARCINFO = "Projection    {}\nDatum         WGS84\nUnits         {}\nZunits        {}\nParameters\n"


@pytest.fixture
def read(tmp_path):
    """Read bytes as a file of a name; what is beside it is written before."""

    def read(data, name="a.asc", *, notes=(), **choices):
        (tmp_path / name).write_bytes(data)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            field = read_heightfield(tmp_path / name, **choices)
        assert [note.category for note in told] == [MeshdepictWarning] * bool(notes)
        assert all(word in str(told[0].message) for word in notes)
        return field

    return read


PLANE = "no coordinate reference system: its cells count as metres"


# --- ESRI -----------------------------------------------------------------------------------


def test_a_grid_lies_with_its_first_row_in_the_north(read):
    field = read(asc(hills()), notes=[PLANE])
    assert field.transform == (10, 0, 1000, 0, -10, 2120)
    np.testing.assert_array_equal(field.z, hills())
    assert field.valid.all()


@pytest.mark.parametrize(
    ("words", "wanted"),
    [({"xllcorner": None, "yllcorner": None, "xllcenter": 1005, "yllcenter": 2005},
      (10, 0, 1000, 0, -10, 2120)),
     ({"cellsize": None, "dx": 10, "dy": 5}, (10, 0, 1000, 0, -5, 2060)),
     ({"xllcorner": -0.5, "yllcorner": "1e3", "cellsize": "2.5"}, (2.5, 0, -0.5, 0, -2.5, 1030)),
     ({"cellsize": "2,5"}, (2.5, 0, 1000, 0, -2.5, 2030))],
    ids=["centres", "two sizes", "other numbers", "decimal comma"],
)  # fmt: skip
def test_a_grid_s_header_may_say_its_place_in_several_ways(read, words, wanted):
    assert read(asc(hills(), **words), notes=[PLANE]).transform == wanted


def test_a_grid_may_have_any_line_ends_letters_and_spaces(read, tmp_path):
    z, wanted = hills(), asc(hills())
    body = wanted.decode()
    header, _, heights = body.partition("NODATA_value -9999\n")
    variants = {
        "crlf": asc(z, end="\r\n"),
        "cr": asc(z, end="\r"),
        "capitals": (header.upper() + "NODATA_VALUE -9999\n" + heights).encode(),
        "marked": b"\xef\xbb\xbf" + wanted,
        "wrapped": (header + "NODATA_value -9999\n" + heights.replace(" ", "\n")).encode(),
        "tabs": body.replace(" ", "\t").encode(),
        "no nodata": asc(z, NODATA_value=None),
        "commas": (header + heights.replace("\n", ",0\n")).encode(),
    }
    for name, data in variants.items():
        np.testing.assert_array_equal(read(data, f"{name}.asc", notes=[PLANE]).z, z)
    packed = read(gzip.compress(wanted), "a.asc.gz", notes=[PLANE])
    np.testing.assert_array_equal(packed.z, z)


@pytest.mark.parametrize("nodata", ["-9999", "-9999.000", "1e20", "nan", "-3.402823466e+38"])
def test_a_grid_s_cells_of_no_data_have_no_height(read, nodata):
    z = hills()
    z[3:5, 2:6] = z[0, 0] = float(nodata)
    field = read(asc(z, NODATA_value=nodata), notes=[PLANE])
    hole = np.zeros(z.shape, bool)
    hole[3:5, 2:6] = hole[0, 0] = True
    np.testing.assert_array_equal(field.valid, ~hole)
    np.testing.assert_array_equal(field.z, np.where(hole, 0, hills()))


def test_words_for_no_number_are_no_heights(read):
    data = asc(hills()).replace(b" 300", b" 1.#QNAN", 1).replace(b" 400", b" *", 1)
    field = read(data, notes=[PLANE])
    assert np.argwhere(~field.valid).tolist() == [[0, 1], [0, 2]]


def test_a_first_row_of_words_is_no_header(read):
    z = np.array([[0, 5], [6, 7]], np.float32)
    field = read(asc(z).replace(b"0 5", b"nan 5"), notes=[PLANE])
    assert np.argwhere(~field.valid).tolist() == [[0, 0]]


def test_a_grid_s_decimals_keep_their_precision(read):
    z = np.array([[0.1, 123456.789012], [1e-3, 7]])
    data = asc(z).replace(b"123456.789", b"123456.789012")
    np.testing.assert_array_equal(read(data, notes=[PLANE]).z, z)
    assert read(asc(hills()), notes=[PLANE]).z.dtype == np.float32


def test_the_text_beside_a_grid_says_its_system(read, tmp_path):
    (tmp_path / "a.prj").write_text(usgs_crs(1, 33, 3))
    field = read(asc(hills()))
    assert field.crs == usgs_crs(1, 33, 3)
    assert not field.degrees
    (tmp_path / "a.prj").write_text(usgs_crs(0, 0, 3))
    cells = {"xllcorner": 7, "yllcorner": 46, "cellsize": 1 / 1200}
    field = read(asc(hills(), **cells), notes=["by latitude", "metres are taken"])
    assert field.degrees
    (tmp_path / "a.prj").write_text(ARCINFO.format("GEOGRAPHIC", "DD", "FEET"))
    field = read(asc(hills(), **cells), notes=["by latitude"])
    assert field.degrees
    np.testing.assert_allclose(field.z, hills() * FOOT, rtol=2e-7)
    (tmp_path / "a.prj").write_text(ARCINFO.format("STATEPLANE", "FEET", "NO"))
    field = read(asc(hills()), notes=["heights in none: metres are taken"])
    assert (field.unit, field.degrees) == (FOOT, False)


@pytest.mark.parametrize(
    "words",
    [{}, {"xllcorner": None, "yllcorner": None, "xllcenter": 7.5, "yllcenter": -3},
     {"cellsize": None, "dx": 2, "dy": 3.5}, {"NODATA_value": None}, {"NODATA_value": 300}],
)  # fmt: skip
def test_a_grid_is_what_gdal_reads(read, tmp_path, words):
    rasterio = pytest.importorskip("rasterio")

    field = read(asc(hills() + np.float32(0.25), **words), notes=[PLANE])
    with rasterio.open(tmp_path / "a.asc") as dataset:
        wanted = dataset.read(1, masked=True)
        assert field.transform == pytest.approx(tuple(dataset.transform)[:6], rel=1e-12)
    np.testing.assert_array_equal(field.valid, ~np.ma.getmaskarray(wanted))
    np.testing.assert_array_equal(field.z, wanted.filled(0))


@pytest.mark.parametrize(
    "words", [{}, {"up": 1}, {"step": (10, 10, 1)}, {"local": 30}, {"datum": 1}, {"zone": 10}]
)
def test_a_model_is_what_gdal_reads(read, tmp_path, words):
    rasterio = pytest.importorskip("rasterio")

    step = words.get("step", (30, 30, 1))
    starts = [3, 2, 1, 0, 0, 0, 1, 2, 3]
    corner = (step[0] * 16_667, step[1] * 166_667)  # GDAL rounds places to whole cells
    field = read(usgs(hills(), starts=starts, corner=corner, **words), "a.dem", unit="m")
    with rasterio.open(tmp_path / "a.dem") as dataset:
        theirs = dataset.read(1, masked=True)
        west, north = dataset.transform.c, dataset.transform.f
        system = dataset.crs
    down = round((north - field.transform[5]) / step[1])
    right = round((field.transform[2] - west) / step[0])
    wanted = theirs[down : down + 12, right : right + 9]
    np.testing.assert_array_equal(field.valid, ~np.ma.getmaskarray(wanted))
    np.testing.assert_array_equal(field.z, wanted.filled(0))
    ours = rasterio.CRS.from_wkt(field.crs)
    for name in ("central_meridian", "lon_0", "zone", "units"):
        assert ours.to_dict().get(name) == system.to_dict().get(name)


def test_a_grid_s_heights_take_the_chosen_unit(read):
    field = read(asc(hills()), notes=[PLANE], unit="ft")
    np.testing.assert_allclose(field.z, hills() * FOOT, rtol=2e-7)


@pytest.mark.parametrize(
    ("words", "what"),
    [({"ncols": None}, "lacks ncols"), ({"nrows": None}, "lacks nrows"),
     ({"cellsize": None}, "lacks cellsize"), ({"cellsize": None, "dx": 3}, "lacks cellsize"),
     ({"xllcorner": None}, "lacks xllcorner"), ({"yllcorner": None}, "lacks yllcorner"),
     ({"ncols": 0}, "0 for ncols, which is no count"), ({"nrows": 2.5}, "2.5 for nrows"),
     ({"ncols": -9}, "-9 for ncols"), ({"ncols": "nan"}, "nan for ncols"),
     ({"nrows": "many"}, "'many' for nrows, which is no number"),
     ({"cellsize": 0}, "a cell size of 0 x 0"), ({"cellsize": "-1"}, "a cell size of -1 x -1"),
     ({"cellsize": "inf"}, "a cell size of inf"), ({"xllcorner": "nan"}, "not six finite numbers"),
     ({"cellsize": "1e-200"}, "gives its cells no area"),
     ({"NCOLS": 9}, "says ncols twice"), ({"colour": 3}, "the unknown word 'colour'"),
     ({"nrows": 13}, r"is cut off: it holds 108 of the 117 heights"),
     ({"nrows": 11}, r"holds 108 heights, and its header claims 99"),
     ({"nrows": 2_000_000_000, "ncols": 2_000_000_000}, "claims more heights than the")],
)  # fmt: skip
def test_a_wrong_header_is_refused_in_a_sentence(tmp_path, words, what):
    path = tmp_path / "a.asc"
    path.write_bytes(asc(hills(), **words))
    with pytest.raises(MeshdepictError, match=what) as told:
        read_heightfield(path)
    assert str(told.value).startswith(str(path))
    assert "\n" not in str(told.value)


def test_heights_that_are_no_numbers_are_refused(tmp_path):
    (tmp_path / "a.asc").write_bytes(asc(hills()).replace(b" 300", b" high", 1))
    with pytest.raises(MeshdepictError, match="not all of its heights are numbers"):
        read_heightfield(tmp_path / "a.asc")


# --- the Geological Survey --------------------------------------------------------------------


def test_profiles_from_the_south_become_rows_from_the_north(read):
    field = read(usgs(hills()), "a.dem")
    np.testing.assert_array_equal(field.z, hills())
    assert field.transform == (30, 0, 500_000, 0, -30, 5_000_360)
    assert "NAD83 / UTM zone 33N" in field.crs
    assert field.attributes["name"] == "HILLS"


def test_profiles_may_be_longer_than_a_record(read):
    z = hills(700, 3)
    np.testing.assert_array_equal(read(usgs(z), "a.dem").z, z)


def test_wedges_and_voids_have_no_height(read):
    z = hills()
    z[6, 4], z[7, 4] = -32767, -32766
    starts = [3, 2, 1, 0, 0, 0, 1, 2, 3]
    field = read(usgs(z, starts=starts), "a.dem")
    there = np.ones(z.shape, bool)
    there[6:8, 4] = False
    for col, skip in enumerate(starts):
        there[:skip, col] = there[len(z) - skip :, col] = False
    np.testing.assert_array_equal(field.valid, there)
    np.testing.assert_array_equal(field.z, np.where(there, z, 0))
    assert field.transform[5] == 5_000_360


def test_numbers_of_six_letters_may_touch(read):
    z = np.array([[-10000, -20000], [-30000, 123456]], np.float32)
    np.testing.assert_array_equal(read(usgs(z), "a.dem").z, z)


def test_records_on_lines_of_their_own_are_read(read):
    z, data = hills(200, 4), usgs(hills(200, 4))
    records = [data[at : at + 1024] for at in range(0, len(data), 1024)]
    for name, text in (
        ("lines.dem", b"\n".join(records)),
        ("cut.dem", b"\r\n".join(record.rstrip() for record in records) + b"\r\n"),
        ("packed.dem.gz", gzip.compress(data)),
    ):
        np.testing.assert_array_equal(read(text, name).z, z)


def test_the_survey_s_units_are_believed(read):
    z = hills()
    feet = read(usgs(z, up=1), "a.dem")
    np.testing.assert_allclose(feet.z, z * FOOT, rtol=2e-7)
    tenths = read(usgs(z, step=(30, 30, 0.1), local=50), "a.dem")
    np.testing.assert_allclose(tenths.z, z * 0.1 + 50, rtol=2e-7)
    chosen = read(usgs(z, up=1), "a.dem", unit="m")
    np.testing.assert_array_equal(chosen.z, z)
    plane = read(usgs(z, system=2, ground=1), "a.dem", notes=["no coordinate reference"])
    assert (plane.unit, plane.crs) == (SURVEY_FOOT, "")
    arcs = usgs(z, system=0, ground=3, step=(3, 3, 1), corner=(7 * 3600, 46 * 3600), datum=3)
    field = read(arcs, "a.dem", notes=["by latitude"])
    assert field.degrees
    np.testing.assert_allclose(
        field.transform, (1 / 1200, 0, 7 - 1 / 2400, 0, -1 / 1200, 46 + 11.5 / 1200)
    )
    assert "WGS 84" in field.crs


@pytest.mark.parametrize(
    ("change", "what"),
    [((150, b"     2"), "no regular pattern"), ((534, b"     3"), "says units"),
     ((528, b"     9"), "says units"), ((816, b"0.000000E+00"), "says a resolution"),
     ((816, b"nonsense    "), "at byte 816 of a record there is no number"),
     ((786, b"   0.100000000000000D+00"), "turned against its axes"),
     ((156, b"     0"), "don't go together"), ((858, b"     0"), "says 0 profiles"),
     ((858, b"999999"), "claims more profiles|is cut off"), ((858, b"    10"), "is cut off"),
     ((858, b"     x"), "at byte 858 of a record there is no whole number"),
     ((1024 + 12, b"    -1"), "profile 1 has -1 heights"),
     ((1024 + 12, b"999999"), "ends within profile 1"),
     ((1024 + 24, b"nan".rjust(24)), "a profile has no place"),
     ((1024 + 24, b"500027.5".rjust(24)), "is irregular"),
     ((1024 + 24, b"9e9".rjust(24)), "is irregular|claims more"),
     ((1024 + 144, b"  high"), "not all heights of its profile 1 are numbers")],
)  # fmt: skip
def test_a_wrong_model_is_refused_in_a_sentence(tmp_path, change, what):
    at, text = change
    data = bytearray(usgs(hills()))
    data[at : at + len(text)] = text
    path = tmp_path / "a.dem"
    path.write_bytes(data)
    with pytest.raises(MeshdepictError, match=what) as told:
        read_heightfield(path)
    assert str(told.value).startswith(str(path))


def test_a_model_that_is_cut_off_says_where(tmp_path):
    data = usgs(hills())
    (tmp_path / "a.dem").write_bytes(data[: 5 * 1024 + 100])
    with pytest.raises(MeshdepictError, match="it holds 4 of the 9 profiles"):
        read_heightfield(tmp_path / "a.dem")


def test_a_model_of_empty_profiles_is_refused(tmp_path):
    (tmp_path / "a.dem").write_bytes(usgs(hills(), starts=[6] * 9))
    with pytest.raises(MeshdepictError, match="holds no heights"):
        read_heightfield(tmp_path / "a.dem")


# --- arrays -----------------------------------------------------------------------------------


def test_an_array_has_cells_of_a_metre_with_a_note(read, tmp_path):
    for kind in (np.float32, np.float64, np.int16, ">f4"):
        np.save(tmp_path / "b.npy", hills().astype(kind))
        field = read((tmp_path / "b.npy").read_bytes(), "a.npy", notes=["its cells count as 1 m"])
        np.testing.assert_array_equal(field.z, hills())
        assert field.transform == (1, 0, 0, 0, -1, 12)
        assert field.z.dtype.isnative


def test_cells_of_an_array_that_are_no_numbers_have_no_height(read, tmp_path):
    z = hills()
    z[1, 2], z[3, 4] = np.nan, np.inf
    np.save(tmp_path / "b.npy", z)
    field = read(
        (tmp_path / "b.npy").read_bytes(), "a.npy", notes=["1 m", "infinite cells"], unit="ft"
    )
    assert np.argwhere(~field.valid).tolist() == [[1, 2], [3, 4]]
    np.testing.assert_allclose(field.z[5:], z[5:] * FOOT, rtol=2e-7)


@pytest.mark.parametrize(
    ("values", "what"),
    [(np.zeros((2, 3, 4)), "no grid of heights .* 2 x 3 x 4"), (np.zeros(5), "no grid of heights"),
     (np.zeros((0, 3)), "no grid of heights"), (np.float64(3), "a single number"),
     (np.zeros((2, 3), complex), "of type complex128"), (np.zeros((2, 3), bool), "of type bool"),
     (np.zeros((2, 3), "U4"), "of type <U4")],
)  # fmt: skip
def test_an_array_that_is_no_grid_of_numbers_is_refused(tmp_path, values, what):
    np.save(tmp_path / "a.npy", values)
    with pytest.raises(MeshdepictError, match=what):
        read_heightfield(tmp_path / "a.npy")


def test_an_array_whose_header_is_damaged_is_refused(tmp_path):
    np.save(tmp_path / "a.npy", hills())
    data = (tmp_path / "a.npy").read_bytes()
    (tmp_path / "a.npy").write_bytes(data.replace(b"'shape'", b"'shade'"))
    for read in (md.read, read_heightfield):
        with pytest.raises(MeshdepictError, match="cut off, damaged or no array"):
            read(tmp_path / "a.npy")


# --- systems ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "degrees", "unit", "vertical"),
    [(4326, True, 1, None), (4979, True, 1, 1), (32633, False, 1, None),
     (2263, False, SURVEY_FOOT, None),
     (2222, False, FOOT, None), ("2263+6360", False, SURVEY_FOOT, SURVEY_FOOT),
     ("4326+5773", True, 1, 1), (5703, False, 1, 1), (3857, False, 1, None)],
)  # fmt: skip
def test_a_system_s_units_are_those_that_proj_says(code, degrees, unit, vertical):
    rasterio = pytest.importorskip("rasterio")

    system = rasterio.CRS.from_string(f"EPSG:{code}")
    for version in ("WKT1_GDAL", "WKT2_2019", "WKT1_ESRI"):
        try:
            text = system.to_wkt(version=version)
        except rasterio.errors.CRSError:
            continue
        found = units_of(text)
        assert found.degrees == degrees
        assert found.unit == pytest.approx(unit, rel=1e-9)
        if vertical is None or found.vertical is not None or version != "WKT1_ESRI":
            assert found.vertical == (vertical if vertical is None else pytest.approx(vertical))


@pytest.mark.parametrize("code", [4978, 4807])
def test_coordinates_that_are_no_map_s_are_refused(code):
    rasterio = pytest.importorskip("rasterio")

    with pytest.raises(MeshdepictError, match="reproject it"):
        units_of(rasterio.CRS.from_epsg(code).to_wkt(version="WKT2_2019"))


@pytest.mark.parametrize(
    "text", ["", "nonsense", "PROJCS[", "]", '"', "A[" * 100 + "]" * 100,
             'PROJCS["x",UNIT["m",-1]]',
             'PROJCS["x",UNIT["m"]]', 'GEOGCS["x",UNIT["degree",nan]]']
)  # fmt: skip
def test_a_text_that_says_no_unit_means_metres_or_degrees(text):
    found = units_of(text)
    assert found.unit == 1
    assert found.degrees == text.startswith("GEOGCS")


def test_lists_of_words_in_other_units_than_degrees_are_refused():
    with pytest.raises(MeshdepictError, match="another unit than degrees"):
        units_of(ARCINFO.format("GEOGRAPHIC", "DS", "NO"))


@pytest.mark.parametrize(
    ("given", "code"), [((1, 10, 1), 26710), ((1, 33, 3), 32633), ((1, -33, 3), 32733),
                        ((1, 15, 4), 26915), ((1, 10, 2), 32210), ((0, 0, 4), 4269)]
)  # fmt: skip
def test_the_survey_s_codes_name_the_system_that_they_mean(given, code):
    rasterio = pytest.importorskip("rasterio")

    assert rasterio.CRS.from_wkt(usgs_crs(*given)).to_epsg() == code


def test_codes_that_name_no_system_give_none():
    assert (
        usgs_crs(1, 61, 1) == usgs_crs(1, 0, 1) == usgs_crs(2, 3104, 1) == usgs_crs(0, 0, 9) == ""
    )
