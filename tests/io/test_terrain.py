"""Windows of terrain on the disk, and several files as one."""

import os
import warnings

import numpy as np
import pytest
from height_files import DEGREES, asc, geotiff, hills, usgs

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files import limits
from meshdepict.io.heightfields import read_heightfield
from meshdepict.io.terrain import Terrain

rasterio = pytest.importorskip("rasterio")

TURNED = (6, 8, 500, 8, -6, 900)


@pytest.fixture
def big(rng):
    """Heights with holes, larger than a block of a file."""
    z = rng.normal(300, 90, (150, 131)).astype(np.float32)
    z[40:60, 30:90] = z[:, -3:] = -9999
    return z


def sources(folder, z):
    """Write the same heights in every format that is read in windows; yield the paths."""
    yield geotiff(folder / "strips.tif", z, nodata=-9999)
    yield geotiff(
        folder / "tiles.tif", z, nodata=-9999, tiled=True, blockxsize=32, blockysize=48,
        compress="deflate", transform=TURNED,
    )  # fmt: skip
    (folder / "grid.asc").write_bytes(asc(z))
    yield folder / "grid.asc"
    (folder / "survey.dem").write_bytes(usgs(np.where(z == -9999, -32767, np.round(z))))
    yield folder / "survey.dem"
    np.save(folder / "array.npy", np.where(z == -9999, np.nan, z))
    yield folder / "array.npy"


@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_a_window_is_a_part_of_the_whole_bit_for_bit(tmp_path, big):
    for path in sources(tmp_path, big):
        whole = read_heightfield(path)
        with Terrain(path) as terrain:
            assert terrain.shape == whole.z.shape
            for rows, cols in (
                (slice(0, 7), slice(None)), (slice(33, 131), slice(17, 99)),
                (slice(149, 150), slice(0, 1)), (slice(-20, None), slice(-5, None)),
            ):  # fmt: skip
                z, valid = terrain.read(rows, cols)
                np.testing.assert_array_equal(z, whole.z[rows, cols])
                np.testing.assert_array_equal(valid, whole.valid[rows, cols])
                assert z.dtype == whole.z.dtype
                if valid.any():
                    part, wanted = terrain.window(rows, cols), whole.window(rows, cols)
                    np.testing.assert_array_equal(part.z, wanted.z)
                    assert part.transform == wanted.transform
                    assert part.crs == wanted.crs


def test_a_window_of_feet_in_degrees_is_a_part_of_the_whole(tmp_path, big):
    path = geotiff(
        tmp_path / "a.tif", big, nodata=-9999, crs=DEGREES,
        transform=(1 / 1200, 0, 7, 0, -1 / 1200, 46),
    )  # fmt: skip
    with pytest.warns(MeshdepictWarning, match="by latitude") as told:
        whole = read_heightfield(path, unit="ft")
    assert len(told) == 1
    with pytest.warns(MeshdepictWarning, match="by latitude"):
        terrain = Terrain(path, unit="ft")
    with terrain:
        part = terrain.window(slice(60, 90), slice(5, 50))
    np.testing.assert_array_equal(part.z, whole.z[60:90, 5:50])
    np.testing.assert_array_equal(part.steps, whole.steps[60:90])


def test_a_closed_terrain_is_opened_again_by_reading(tmp_path):
    path = geotiff(tmp_path / "a.tif", hills())
    with Terrain(path) as terrain:
        first, _ = terrain.read()
    again, _ = terrain.read()
    terrain.close()
    np.testing.assert_array_equal(first, again)
    assert repr(terrain) == f"<Terrain: 12 x 9 cells of {path}>"


@pytest.mark.parametrize("rows", [slice(3, 3), slice(5, 2), slice(0, 9, 2), slice(99, 100)])
def test_what_is_no_window_is_refused(tmp_path, rows):
    with Terrain(geotiff(tmp_path / "a.tif", hills())) as terrain:
        with pytest.raises(MeshdepictError, match=r"rows=slice.* is no window of 12 rows"):
            terrain.read(rows)
        with pytest.raises(MeshdepictError, match=r"cols=slice.* is no window of 9 cols"):
            terrain.window(cols=rows)


def test_a_window_of_no_data_is_read_and_is_no_height_field(tmp_path, big):
    with Terrain(geotiff(tmp_path / "a.tif", big, nodata=-9999)) as terrain:
        z, valid = terrain.read(slice(45, 50), slice(40, 50))
        assert not valid.any()
        assert not z.any()
        with pytest.raises(MeshdepictError, match="holds no heights: all of its cells"):
            terrain.window(slice(45, 50), slice(40, 50))


def test_windows_that_memory_does_not_hold_are_refused(tmp_path, big):
    with Terrain(geotiff(tmp_path / "a.tif", big, nodata=-9999)) as terrain:
        limits.set_max_memory(50_000)
        try:
            with pytest.raises(MeshdepictError, match=r"19,650 cells, .* more than the 48.8 kB"):
                terrain.read()
            assert terrain.read(slice(0, 50))[0].shape == (50, 131)
        finally:
            limits.set_max_memory(None)


def test_a_file_that_is_cut_off_later_is_said_with_its_rows(tmp_path, capfd):
    path = geotiff(tmp_path / "a.tif", hills(400, 300))
    terrain = Terrain(path)
    os.truncate(path, path.stat().st_size // 2)
    terrain.close()
    z, _ = terrain.read(slice(0, 10))
    np.testing.assert_array_equal(z, hills(400, 300)[:10])
    with pytest.raises(
        MeshdepictError, match=r"a\.tif is cut off or damaged: cells of its rows 391"
    ):
        terrain.read(slice(390, 400))
    terrain.close()
    assert capfd.readouterr() == ("", "")


# --- tiles ----------------------------------------------------------------------------------


def tiled(folder, z, cuts=(70, 60), *, transform=(10, 0, 1000, 0, -10, 3500), **choices):
    """Write four tiles of a raster; return their paths."""
    a, b, c, d, e, f = transform
    found = []
    for i, rows in enumerate((slice(0, cuts[0]), slice(cuts[0], None))):
        for j, cols in enumerate((slice(0, cuts[1]), slice(cuts[1], None))):
            top, left = (i and cuts[0]), (j and cuts[1])
            place = (a, b, c + a * left + b * top, d, e, f + d * left + e * top)
            found.append(
                geotiff(
                    folder / f"{i}{j}.tif", z[rows, cols], transform=place, nodata=-9999, **choices
                )
            )
    return found


@pytest.mark.parametrize(
    "transform", [(10, 0, 1000, 0, -10, 3500), (10, 0, 1000, 0, 10, 3500), TURNED],
    ids=["north up", "south up", "turned"],
)  # fmt: skip
def test_tiles_are_one_raster_in_any_order(tmp_path, big, transform):
    paths = tiled(tmp_path, big, transform=transform)
    whole = read_heightfield(geotiff(tmp_path / "a.tif", big, transform=transform, nodata=-9999))
    for order in (paths, paths[::-1], [paths[i] for i in (2, 0, 3, 1)]):
        field = read_heightfield(order)
        np.testing.assert_array_equal(field.z, whole.z)
        np.testing.assert_array_equal(field.valid, whole.valid)
        np.testing.assert_allclose(field.transform, transform, rtol=1e-12, atol=1e-9)
        assert field.crs == whole.crs
    with Terrain(paths) as terrain:
        z, _ = terrain.read(slice(60, 80), slice(50, 70))
        np.testing.assert_array_equal(z, whole.z[60:80, 50:70])


def test_where_no_tile_is_there_is_no_height(tmp_path, big):
    paths = tiled(tmp_path, np.abs(big))
    field = read_heightfield([paths[0], paths[3]])
    assert field.z.shape == big.shape
    assert field.valid[:70, :60].all()
    assert not field.valid[70:, :60].any()
    assert not field.z[:70, 60:].any()


def test_where_tiles_overlap_the_first_that_holds_a_height_wins(tmp_path):
    z = hills(20, 20)
    first = z[:12].copy()
    first[10:, 3:6] = -9999
    second = z[8:] + 1000
    one = geotiff(tmp_path / "1.tif", first, nodata=-9999)
    two = geotiff(tmp_path / "2.tif", second, nodata=-9999, transform=(10, 0, 1000, 0, -10, 2040))
    field = read_heightfield([one, two])
    wanted = z.copy()
    wanted[12:] += 1000
    wanted[10:12, 3:6] += 1000
    np.testing.assert_array_equal(field.z, wanted)
    assert field.valid.all()


def test_many_tiles_keep_few_files_open(tmp_path):
    z = hills(10, 200)
    paths = [
        geotiff(tmp_path / f"{i}.tif", z[:, 2 * i : 2 * i + 2], transform=(1, 0, 2 * i, 0, -1, 0))
        for i in range(100)
    ]
    before = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0
    with Terrain(paths) as terrain:
        found, _ = terrain.read()
        if before:
            assert len(os.listdir("/proc/self/fd")) <= before + 66
    np.testing.assert_array_equal(found, z)


def test_tiles_of_texts_and_rasters_go_together(tmp_path):
    z = hills(24, 9)
    (tmp_path / "south.asc").write_bytes(asc(z[12:]))
    (tmp_path / "north.asc").write_bytes(asc(z[:12], yllcorner=2120))
    with pytest.warns(MeshdepictWarning, match="no coordinate reference system") as told:
        field = read_heightfield([tmp_path / "south.asc", tmp_path / "north.asc"])
    assert len(told) == 1
    np.testing.assert_array_equal(field.z, z)


@pytest.mark.parametrize(
    ("choices", "what"),
    [({"crs": "EPSG:3912"}, "2.tif is in another coordinate reference system than"),
     ({"transform": (11, 0, 1000, 0, -11, 2000)}, "2.tif has cells of 11 x 11, and .* of 10 x 10"),
     ({"transform": (10, 0, 1000, 0, 10, 2000)}, "2.tif has cells of"),
     ({"transform": (10, 0, 1003, 0, -10, 2000)}, "2.tif lies 0.3 of a cell between the cells of"),
     ({"transform": (10, 0, 9e9, 0, -10, 2000)}, "lies too far from the other tiles")],
)  # fmt: skip
def test_a_tile_of_another_grid_is_named(tmp_path, choices, what):
    one, two = geotiff(tmp_path / "1.tif", hills()), geotiff(tmp_path / "2.tif", hills(), **choices)
    with pytest.raises(MeshdepictError, match=what) as told:
        read_heightfield([one, two])
    assert str(told.value).startswith(str(tmp_path))


def test_no_tiles_and_the_same_tile_twice_are_refused(tmp_path):
    with pytest.raises(MeshdepictError, match="there are no tiles"):
        read_heightfield([])
    path = geotiff(tmp_path / "1.tif", hills())
    with pytest.raises(MeshdepictError, match=r"1\.tif is named twice among the tiles"):
        read_heightfield([path, path])
    with pytest.raises(MeshdepictError, match=r"none\.tif: there is no such file"):
        read_heightfield([path, tmp_path / "none.tif"])


# --- virtual rasters --------------------------------------------------------------------------


def vrt(
    path, tiles, shape, *, source="SimpleSource", inner="", band="", root="", sizes=None, rel=1
):
    """Write a virtual raster of tiles (name, column, row, columns, rows)."""
    found = ""
    for name, col, row, cols, rows in tiles:
        wide, high = sizes or (cols, rows)
        found += (
            f'<{source}><SourceFilename relativeToVRT="{rel}">{name}</SourceFilename>'
            f'<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="{cols}" ySize="{rows}"/>'
            f'<DstRect xOff="{col}" yOff="{row}" xSize="{wide}" ySize="{high}"/>{inner}</{source}>'
        )
    path.write_text(
        f'<VRTDataset rasterXSize="{shape[1]}" rasterYSize="{shape[0]}" {root}><SRS>EPSG:3794</SRS>'
        "<GeoTransform>1000, 10, 0, 3500, 0, -10</GeoTransform>"
        f'<VRTRasterBand dataType="Float32" band="1" {band}><NoDataValue>-9999</NoDataValue>{found}'
        "</VRTRasterBand></VRTDataset>"
    )
    return path


PLACES = [("00.tif", 0, 0, 60, 70), ("01.tif", 60, 0, 71, 70), ("10.tif", 0, 70, 60, 80),
          ("11.tif", 60, 70, 71, 80)]  # fmt: skip


@pytest.mark.parametrize("source", ["SimpleSource", "ComplexSource"])
def test_a_virtual_raster_is_its_tiles(tmp_path, big, source):
    paths = tiled(tmp_path, big)
    inner = "<NODATA>-9999</NODATA>" if source == "ComplexSource" else ""
    path = vrt(tmp_path / "all.vrt", PLACES, big.shape, source=source, inner=inner)
    field, other = read_heightfield(path), read_heightfield(paths)
    np.testing.assert_array_equal(field.z, other.z)
    np.testing.assert_array_equal(field.valid, other.valid)
    assert field.transform == other.transform
    with Terrain(path) as terrain:
        z, _ = terrain.read(slice(60, 80), slice(50, 70))
        np.testing.assert_array_equal(z, field.z[60:80, 50:70])
    outer = vrt(tmp_path / "outer.vrt", [("all.vrt", 0, 0, 131, 150)], big.shape)
    np.testing.assert_array_equal(read_heightfield(outer).z, field.z)


@pytest.mark.parametrize(
    ("words", "what"),
    [({"tiles": [("../00.tif", 0, 0, 60, 70)]}, "leads out of its folder"),
     ({"tiles": [("/etc/passwd", 0, 0, 60, 70)], "rel": 0}, "an absolute path"),
     ({"tiles": [("/vsicurl/http://localhost/a.tif", 0, 0, 60, 70)]}, "an absolute path"),
     ({"tiles": [("http://localhost/a.tif", 0, 0, 60, 70)]}, "a URL"),
     ({"tiles": [("none.tif", 0, 0, 60, 70)]}, "'none.tif', which is not there"),
     ({"tiles": [("words.xml", 0, 0, 60, 70)]}, "which is text, not a raster"),
     ({"tiles": [("loop.vrt", 0, 0, 60, 70)]}, "too deep"),
     ({"sizes": (30, 35)}, "resamples the tile '00.tif'"),
     ({"sizes": ("wide", 35)}, "by what is no number"),
     ({"sizes": ("nan", "nan")}, "resamples the tile|no number"),
     ({"source": "KernelFilteredSource"}, "a source of the kind 'KernelFilteredSource'"),
     ({"source": "ArraySource"}, "a source of the kind 'ArraySource'"),
     ({"band": 'subClass="VRTDerivedRasterBand"'}, "a band of the kind 'VRTDerivedRasterBand'"),
     ({"band": 'subClass="VRTRawRasterBand"'}, "a band of the kind 'VRTRawRasterBand'"),
     ({"root": 'subClass="VRTWarpedDataset"'}, "of the kind 'VRTWarpedDataset'")],
)  # fmt: skip
def test_a_virtual_raster_that_is_more_than_tiles_is_refused(tmp_path, big, words, what):
    tiled(tmp_path, big)
    (tmp_path / "words.xml").write_text("<GDAL_WMS><Service/></GDAL_WMS>")
    vrt(tmp_path / "loop.vrt", [("loop.vrt", 0, 0, 60, 70)], big.shape)
    given = {"tiles": PLACES[:1]} | words
    path = vrt(tmp_path / "all.vrt", shape=big.shape, **given)
    with pytest.raises(MeshdepictError, match=what) as told:
        read_heightfield(path)
    assert str(told.value).startswith(str(path))


@pytest.mark.parametrize(
    ("text", "what"),
    [("<VRTDataset", "it is no XML"), ("", "is empty"),
     ('<!DOCTYPE a [<!ENTITY b "c">]><VRTDataset/>', "declares XML entities"),
     ("<GDAL_WMS></GDAL_WMS>", "of the kind 'GDAL_WMS'"),
     ("<VRTDataset><VRTRasterBand><SimpleSource/></VRTRasterBand></VRTDataset>", "without a file"),
     ("<VRTDataset><SourceDataset>/etc/x</SourceDataset></VRTDataset>", "has a SourceDataset"),
     ('<VRTDataset rasterXSize="9" rasterYSize="9"></VRTDataset>', "is cut off, damaged")],
)  # fmt: skip
def test_a_wrong_virtual_raster_is_refused(tmp_path, text, what):
    (tmp_path / "a.vrt").write_text(text)
    with pytest.raises(MeshdepictError, match=what):
        read_heightfield(tmp_path / "a.vrt")


def test_a_virtual_raster_has_an_end(tmp_path, big, monkeypatch):
    tiled(tmp_path, big)
    path = vrt(tmp_path / "all.vrt", PLACES, big.shape)
    monkeypatch.setattr("meshdepict.io.vrt._LARGEST", 100)
    with pytest.raises(MeshdepictError, match="is too long for a virtual raster"):
        read_heightfield(path)


def test_half_a_place_is_none(tmp_path, big):
    tiled(tmp_path, big)
    path = vrt(tmp_path / "all.vrt", PLACES[:1], big.shape)
    path.write_text(path.read_text().replace("DstRect", "Nothing"))
    with pytest.raises(MeshdepictError, match=r"says only half of where the tile '00\.tif' lies"):
        read_heightfield(path)


def test_tiles_take_no_word_more_than_one_raster(tmp_path, big):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_heightfield(tiled(tmp_path, big))
