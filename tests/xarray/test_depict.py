"""``da.depict``: DataArrays in, DataArrays at the same coordinates out."""

import subprocess
import sys

import numpy as np
import pytest

import meshdepict as md
from meshdepict.errors import MeshdepictError

xr = pytest.importorskip("xarray")
door = pytest.importorskip("meshdepict.xarray")

UTM = (
    'PROJCS["WGS 84 / UTM zone 33N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,'
    '298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],'
    'PROJECTION["Transverse_Mercator"],UNIT["metre",1]]'
)
FEET = UTM.replace('UNIT["metre",1]', 'UNIT["US survey foot",0.304800609601219]')
DEGREES = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
    'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]'
)


def heights(rows=6, columns=8):
    y, x = np.mgrid[:rows, :columns]
    return np.sin(x) + 0.3 * y


def array(z=None, *, x=None, y=None, crs="", **given):
    z = heights() if z is None else z
    rows, columns = z.shape
    coords = {
        "y": 2000.0 - 10 * np.arange(rows) if y is None else y,
        "x": 500.0 + 10 * np.arange(columns) if x is None else x,
    }
    if crs:
        coords["spatial_ref"] = ((), 0, {"crs_wkt": crs, "spatial_ref": crs})
    return xr.DataArray(z, dims=("y", "x"), coords=coords, **given)


def test_a_method_returns_what_a_bake_shows_at_the_same_coordinates():
    da = array(crs=UTM, name="height", attrs={"units": "m"})
    before = da.copy(deep=True)
    shaded = da.depict.exaggerated(light="north", z_factor=2)
    baked = md.bake(door.height_field(da), light="north", z_factor=2)
    np.testing.assert_allclose(shaded.values.ravel() * 255, baked.colors[:, 0], atol=1e-4)
    assert shaded.dims == da.dims
    for name in da.coords:
        xr.testing.assert_identical(shaded.coords[name], da.coords[name])
    assert shaded.attrs["meshdepict"].splitlines() == baked.comments
    xr.testing.assert_identical(da, before)
    np.testing.assert_array_equal(md.bake(da, light="north", z_factor=2).colors, baked.colors)


def test_colors_have_a_dimension_of_their_own():
    da = array()
    shaded = da.depict("lambert", colormap="sepia")
    assert shaded.dims == ("y", "x", "band")
    assert shaded.band.values.tolist() == [1, 2, 3]
    baked = md.bake(door.height_field(da), "lambert", colormap="sepia")
    np.testing.assert_allclose(shaded.values.reshape(-1, 3) * 255, baked.colors, atol=1e-4)


@pytest.mark.parametrize("up", [False, True])
@pytest.mark.parametrize("across", [False, True])
def test_rows_and_columns_may_run_any_way(up, across):
    da = array()
    turned = da.isel(y=slice(None, None, -1) if up else slice(None))
    turned = turned.transpose("x", "y") if across else turned
    shaded = turned.depict.lambert()
    assert shaded.dims == ("y", "x")
    xr.testing.assert_allclose(shaded.sortby("y"), da.depict.lambert().sortby("y"), atol=1 / 255)


def test_where_no_height_is_known_nothing_is_shown():
    z = heights()
    z[1, 2] = np.nan
    z[4, 4] = np.inf
    shaded = array(z).depict.lambert()
    np.testing.assert_array_equal(np.isnan(shaded), ~np.isfinite(z))
    whole = np.round(heights() * 100).astype(np.int16)
    whole[3, 3] = -9999
    marked = array(whole, attrs={"_FillValue": -9999}).depict.lambert()
    np.testing.assert_array_equal(np.isnan(marked), whole == -9999)
    listed = array(whole, attrs={"nodatavals": (-9999.0,)}).depict.lambert()
    np.testing.assert_array_equal(np.isnan(listed), whole == -9999)


def test_the_place_is_that_of_the_coordinates():
    field = door.height_field(array(crs=UTM))
    assert field.transform == (10, 0, 495, 0, -10, 2005)
    assert (field.crs, field.degrees, field.unit) == (UTM, False, 1)
    feet = door.height_field(array(crs=FEET))
    assert feet.unit == pytest.approx(0.3048006)
    assert feet.spacing[0] == pytest.approx(3.048006)


def test_degrees_are_never_metres():
    lat, lon = 46.0 + 0.1 * np.arange(6), 10 + 0.1 * np.arange(8)
    by_system = door.height_field(array(x=lon, y=lat, crs=DEGREES))
    by_name = xr.DataArray(heights(), dims=("lat", "lon"), coords={"lat": lat, "lon": lon})
    by_unit = array(x=lon, y=lat)
    by_unit.y.attrs["units"], by_unit.x.attrs["units"] = "degrees_north", "degrees_east"
    for field in (by_system, door.height_field(by_name), door.height_field(by_unit)):
        assert field.degrees
        assert field.spacing[1] == pytest.approx(11132)
        assert field.spacing[0] == pytest.approx(11132 * np.cos(np.radians(46.25)), rel=2e-3)
    assert by_name.depict.lambert().dims == ("lat", "lon")


def test_scale_offset_and_unit_of_heights_are_applied():
    z = heights()
    plain = door.height_field(array(z)).z
    scaled = array(z, attrs={"scale_factor": 0.1, "add_offset": 100.0})
    np.testing.assert_allclose(door.height_field(scaled).z, 0.1 * plain + 100)
    feet = array(z, attrs={"units": "ft"})
    np.testing.assert_allclose(door.height_field(feet).z, 0.3048 * plain)


def test_dimensions_of_length_one_are_left_out():
    da = array().expand_dims(band=[1], time=[3])
    shaded = da.depict.lambert()
    assert shaded.dims == ("y", "x")
    assert "band" not in shaded.coords
    colored = da.depict.lambert(colormap="sepia")
    assert colored.dims == ("y", "x", "band")


def test_names_that_say_nothing_are_rows_and_columns_of_a_metre():
    field = door.height_field(xr.DataArray(heights()))
    assert field.spacing == (1, 1)
    assert field.size == (8, 6)
    line = door.height_field(array(heights(1, 8)))
    assert line.spacing == (10, 10)


@pytest.mark.parametrize(
    ("da", "words"),
    [
        (lambda: xr.DataArray(np.zeros((3, 4, 5)), dims=("band", "y", "x")), "3 of band: take one"),
        (lambda: array(x=np.arange(8.0) ** 2), "x of the DataArray is not evenly spaced"),
        (lambda: array(x=np.zeros(8)), "x of the DataArray is not evenly spaced"),
        (lambda: array(y=list("abcdef")), "y of the DataArray holds no coordinates in numbers"),
        (lambda: xr.DataArray(np.zeros(4), dims="x"), "the dimensions x, and terrain has rows"),
        (lambda: xr.DataArray(np.zeros((0, 4)), dims=("y", "x")), "is empty: y has no values"),
        (lambda: xr.DataArray(np.array([["a", "b"]] * 2)), "holds <U1, no heights"),
        (lambda: array(np.full((3, 4), np.nan)), "none of 12 cells holds a height"),
        (lambda: array(crs='GEOCCS["x",UNIT["metre",1]]'), "the DataArray has coordinates from"),
        (lambda: array(y=100.0 + np.arange(6), crs=DEGREES), "degrees beyond the poles"),
    ],
)
def test_what_is_no_terrain_says_so(da, words):
    with pytest.raises(MeshdepictError, match=words):
        da().depict.lambert()


def test_other_things_are_no_data_arrays():
    with pytest.raises(MeshdepictError, match=r"a ndarray is no xarray\.DataArray"):
        door.height_field(np.zeros((3, 4)))


def test_unknown_methods_name_the_nearest():
    with pytest.raises(AttributeError, match="no method 'lampert'; did you mean 'lambert'"):
        array().depict.lampert  # noqa: B018
    assert {"lambert", "exaggerated"} <= set(dir(array().depict))
    assert "lambert" in repr(array().depict)
    assert "max(0, n·l)" in array().depict.lambert.__doc__


def test_registering_again_does_no_harm():
    door.register()
    assert xr.DataArray.depict is door.Depict


def test_without_xarray_there_is_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(MeshdepictError, match=r"pip install 'meshdepict\[xarray\]'"):
        door.register()


def test_the_package_doesn_t_import_xarray():
    code = (
        "import sys, numpy, meshdepict as md; md.bake(md.HeightField(numpy.zeros((4, 4))));"
        "sys.exit('xarray' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_rioxarray_s_coordinates_are_those_of_the_file(data, tmp_path):
    rioxarray = pytest.importorskip("rioxarray")
    import warnings

    path = data / "dem" / "dem_st_helens_30m.tif"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # rioxarray's own
        da = rioxarray.open_rasterio(path)
        field, read = door.height_field(da), md.read(path)
        np.testing.assert_array_equal(field.z, read.z)
        np.testing.assert_array_equal(field.valid, read.valid)
        assert field.transform == read.transform
        assert field.crs == read.crs
        shaded = da.depict.lambert()
        assert shaded.rio.transform() == da.rio.transform()
        assert shaded.rio.crs == da.rio.crs
        shaded.rio.to_raster(tmp_path / "shaded.tif")
        again = rioxarray.open_rasterio(tmp_path / "shaded.tif")
        np.testing.assert_array_equal(again.values[0], shaded.values)
