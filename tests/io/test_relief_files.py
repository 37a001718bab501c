"""Relief on a terrain's grid: place, system and facts survive; wholly written or not at all."""

import os
import subprocess
import sys
import textwrap
import warnings

import numpy as np
import pytest
from height_files import DEGREES, SLOVENIA, geotiff, hills
from PIL import Image

import meshdepict as md
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files import limits
from meshdepict.io import read_provenance
from meshdepict.io.heightfields import read_heightfield
from meshdepict.io.relief_files import check_relief, relief_writer
from meshdepict.io.terrain import Terrain
from meshdepict.io.usgs_crs import usgs_crs

rasterio = pytest.importorskip("rasterio")

PLACES = {
    "north up": (SLOVENIA, (10, 0, 1000, 0, -10, 2120)),
    "south up": (SLOVENIA, (10, 0, 1000, 0, 10, 2120)),
    "turned": (SLOVENIA, (6, 8, 500, 8, -6, 900)),
    "feet": ("EPSG:2263", (3, 0, 1000, 0, -3, 2120)),
    "degrees": (DEGREES, (1 / 1200, 0, 7, 0, -1 / 1200, 46)),
    "heights": ("EPSG:2263+6360", (3, 0, 1000, 0, -3, 2120)),
}


@pytest.fixture
def terrain(tmp_path):
    """Open a terrain of a place; its files lie in a folder of their own."""
    opened = []

    def terrain(place="north up", shape=(12, 9), **choices):
        (tmp_path / "in").mkdir(exist_ok=True)
        crs, transform = PLACES[place]
        path = geotiff(
            tmp_path / "in" / "dem.tif", hills(*shape), crs=crs, transform=transform, **choices
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MeshdepictWarning)
            opened.append(Terrain(path))
        return opened[-1]

    yield terrain
    for each in opened:
        each.close()


def shades(rng, shape, bands=1):
    size = shape if bands == 1 else (*shape, bands)
    return rng.integers(0, 256, size, dtype=np.uint8), rng.random(shape) < 0.8


def written(path, like, values, valid, *, step=7, **choices):
    """Write in windows of a few rows and columns."""
    with relief_writer(path, like=like, **choices) as out:
        for top in range(0, len(values), step):
            for left in range(0, values.shape[1], step):
                rows, cols = slice(top, top + step), slice(left, left + step)
                out.write(rows, cols, values[rows, cols], valid[rows, cols])
    return path


@pytest.mark.parametrize("place", PLACES)
def test_place_system_and_facts_survive(tmp_path, terrain, rng, place):
    like = terrain(place)
    gray, valid = shades(rng, like.shape)
    path = written(tmp_path / "a.tif", like, gray, valid, provenance={"method": "horn, ümlaut"})
    with rasterio.open(path) as dataset, rasterio.open(tmp_path / "in" / "dem.tif") as source:
        assert dataset.crs == source.crs
        assert tuple(dataset.transform) == pytest.approx(tuple(source.transform), rel=1e-12)
        np.testing.assert_array_equal(dataset.read(1), np.where(valid, gray, 0))
        np.testing.assert_array_equal(dataset.read(2), np.where(valid, 255, 0))
        np.testing.assert_array_equal(dataset.dataset_mask() > 0, valid)
        assert [found.name for found in dataset.colorinterp] == ["gray", "alpha"]
        assert dataset.tags()["meshdepict method"] == "horn, ümlaut"
        assert dataset.tags()["TIFFTAG_SOFTWARE"] == f"meshdepict {md.__version__}"
    lines = read_provenance(path)
    assert "meshdepict method: horn, ümlaut" in lines
    assert f"meshdepict version: {md.__version__}" in lines
    assert sorted(os.listdir(tmp_path)) == ["a.tif", "in"]


def test_what_the_file_says_of_its_data_survives(tmp_path, terrain, rng):
    said = {"TIFFTAG_COPYRIGHT": "the survey, 2019", "campaign": "spring", "TIFFTAG_SOFTWARE": "x",
            "STATISTICS_MEAN": "7", "TIFFTAG_IMAGEDESCRIPTION": "heights"}  # fmt: skip
    like = terrain(after=lambda d: d.update_tags(**said))
    gray, valid = shades(rng, like.shape)
    with rasterio.open(written(tmp_path / "a.tif", like, gray, valid)) as dataset:
        found = dataset.tags()
    assert (found["TIFFTAG_COPYRIGHT"], found["campaign"]) == ("the survey, 2019", "spring")
    assert found["TIFFTAG_SOFTWARE"].startswith("meshdepict ")
    assert found["TIFFTAG_IMAGEDESCRIPTION"].startswith("meshdepict ")
    assert "STATISTICS_MEAN" not in found


def test_what_a_cell_stands_for_survives(tmp_path, terrain, rng):
    like = terrain(after=lambda d: d.update_tags(AREA_OR_POINT="Point"))
    gray, valid = shades(rng, like.shape)
    with rasterio.open(written(tmp_path / "a.tif", like, gray, valid)) as dataset:
        assert dataset.tags()["AREA_OR_POINT"] == "Point"
        assert tuple(dataset.transform)[:6] == like.transform


def test_the_helens_relief_lies_on_the_helens(data, tmp_path, rng):
    for suffix in ("tif", "dem"):
        like = read_heightfield(data / "dem" / f"dem_st_helens_30m.{suffix}")
        gray = rng.integers(0, 256, like.z.shape, dtype=np.uint8)
        path = written(tmp_path / f"{suffix}.tif", like, gray, like.valid, step=200)
        with rasterio.open(path) as dataset:
            assert tuple(dataset.transform)[:6] == like.transform
            np.testing.assert_array_equal(dataset.dataset_mask() > 0, like.valid)
            assert dataset.crs.is_projected or suffix == "tif"
        if suffix == "dem":
            with rasterio.open(path) as dataset:
                assert dataset.crs.to_epsg() == 26710


def test_colours_survive_bit_for_bit(tmp_path, terrain, rng):
    like = terrain()
    colours, valid = shades(rng, like.shape, 3)
    path = written(tmp_path / "a.tif", like, colours, valid, kind="color")
    with rasterio.open(path) as dataset:
        assert [found.name for found in dataset.colorinterp] == ["red", "green", "blue", "alpha"]
        found = dataset.read().transpose(1, 2, 0)
    np.testing.assert_array_equal(found[valid, :3], colours[valid])
    np.testing.assert_array_equal(found[..., 3] > 0, valid)
    with pytest.raises(MeshdepictError, match="is a picture, not an elevation model"):
        read_heightfield(path)


def test_values_survive_with_what_is_missing_as_nan(tmp_path, terrain, rng):
    like = terrain()
    values, valid = rng.normal(size=like.shape).astype(np.float32), rng.random(like.shape) < 0.8
    path = written(tmp_path / "a.tif", like, values, valid, kind="values")
    with rasterio.open(path) as dataset:
        assert dataset.dtypes == ("float32",)
        assert np.isnan(dataset.nodata)
        found = dataset.read(1)
    np.testing.assert_array_equal(np.isnan(found), ~valid)
    np.testing.assert_array_equal(found[valid], values[valid])
    assert md.read(path).kind == "height field"  # values are numbers on a map, like heights


@pytest.mark.parametrize("kind", ["gray", "color", "values"])
def test_windows_in_any_order_give_the_same_bytes_as_one(tmp_path, terrain, rng, kind):
    like = terrain(shape=(700, 1100))
    values, valid = shades(rng, like.shape, 3 if kind == "color" else 1)
    whole = tmp_path / "whole.tif"
    with relief_writer(whole, like=like, kind=kind) as out:
        out.write(slice(None), slice(None), values, valid)
    windows = [(slice(t, t + 300), slice(s, s + 400)) for t in (0, 300, 600) for s in (0, 400, 800)]
    parts = tmp_path / "parts.tif"
    with relief_writer(parts, like=like, kind=kind) as out:
        for i in rng.permutation(len(windows)):
            out.write(*windows[i], values[windows[i]], valid[windows[i]])
    with rasterio.open(whole) as one, rasterio.open(parts) as other:
        np.testing.assert_array_equal(one.read(), other.read())
        assert one.block_shapes[0] == (512, 512)
        assert one.overviews(1) == [2, 4]
        assert one.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert one.tags(ns="IMAGE_STRUCTURE")["COMPRESSION"] == "DEFLATE"
        assert one.profile["interleave"] in ("pixel", "band")


def test_overviews_average_what_is_there(tmp_path, terrain):
    like = terrain(shape=(1024, 1024))
    gray, valid = np.full(like.shape, 100, np.uint8), np.ones(like.shape, bool)
    gray[:, 1::2] = 200
    valid[:512, 1::2] = False
    path = written(tmp_path / "a.tif", like, gray, valid, step=512)
    with rasterio.open(path, overview_level=0) as dataset:
        found, _ = dataset.read()
    np.testing.assert_array_equal(found[256:], 150)
    np.testing.assert_array_equal(found[:256], 100)  # what isn't there darkens nothing


def test_what_was_never_written_is_nothing(tmp_path, terrain):
    like = terrain()
    for kind in ("gray", "values"):
        path = tmp_path / f"{kind}.tif"
        with relief_writer(path, like=like, kind=kind) as out:
            out.write(slice(0, 4), slice(None), np.full((4, 9), 7, np.uint8))
        with rasterio.open(path) as dataset:
            there = dataset.dataset_mask() > 0
            assert there[:4].all()
            assert not there[4:].any()


# --- pictures -----------------------------------------------------------------------------------


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("suffix", "stem"), [("png", "pgw"), ("jpg", "jgw"), ("jpeg", "jgw")])
def test_a_picture_lies_where_its_terrain_lies(tmp_path, terrain, rng, place, suffix, stem):
    like = terrain(place)
    gray, valid = shades(rng, like.shape)
    path = written(tmp_path / f"a.{suffix}", like, gray, valid, provenance={"method": "horn"})
    assert sorted(os.listdir(tmp_path)) == sorted(
        [f"a.{suffix}", f"a.{stem}", f"a.{suffix}.aux.xml", "a.prj", "in"]
    )
    with rasterio.open(path) as dataset, rasterio.open(tmp_path / "in" / "dem.tif") as source:
        assert dataset.crs == source.crs
        assert tuple(dataset.transform)[:6] == pytest.approx(like.transform, rel=1e-12)
        assert rasterio.CRS.from_wkt((tmp_path / "a.prj").read_text()).is_projected != like.degrees
    os.remove(tmp_path / f"a.{suffix}.aux.xml")  # the world file alone says it as well
    with rasterio.open(path) as dataset:
        assert tuple(dataset.transform)[:6] == pytest.approx(like.transform, rel=1e-9)


def test_a_png_is_transparent_where_there_is_nothing(tmp_path, terrain, rng):
    like = terrain()
    for kind, bands, mode in (("gray", 1, "LA"), ("color", 3, "RGBA")):
        values, valid = shades(rng, like.shape, bands)
        path = written(tmp_path / f"{kind}.png", like, values, valid, kind=kind,
                       provenance={"method": "horn"})  # fmt: skip
        with Image.open(path) as image:
            assert image.mode == mode
            found = np.array(image)
            assert image.text["meshdepict method"] == "horn"
        np.testing.assert_array_equal(found[..., -1], np.where(valid, 255, 0))
        np.testing.assert_array_equal(
            found[..., :bands][valid], values.reshape(*like.shape, bands)[valid]
        )


def test_a_jpeg_is_white_where_there_is_nothing(tmp_path, terrain):
    like = terrain()
    valid = np.zeros(like.shape, bool)
    valid[:8, :8] = True
    for kind in ("gray", "color"):
        values = np.zeros(like.shape if kind == "gray" else (*like.shape, 3), np.uint8)
        path = written(tmp_path / f"{kind}.jpg", like, values, valid, kind=kind, step=99,
                       provenance={"method": "horn"})  # fmt: skip
        with Image.open(path) as image:
            assert b"meshdepict method: horn" in image.info["comment"]
            found = np.array(image)
        assert found[8:, :].min() > 200
        assert found[:7, :7].max() < 40


def test_another_file_s_system_stays_beside_a_picture(tmp_path, terrain, rng):
    like = terrain()
    (tmp_path / "a.prj").write_text("of a shapefile")
    written(tmp_path / "a.png", like, *shades(rng, like.shape))
    assert (tmp_path / "a.prj").read_text() == "of a shapefile"


def test_pictures_need_no_rasterio_and_a_geotiff_says_that_it_does(tmp_path, rng, monkeypatch):
    import meshdepict.io.gdal as module

    def missing():
        raise ImportError("No module named 'rasterio'")

    crs = usgs_crs(1, 33, 3)
    like = md.HeightField(hills(), transform=(10, 0, 1000, 0, -10, 2120), crs=crs)
    gray, valid = shades(rng, like.z.shape)
    monkeypatch.setattr(module, "_module", missing)
    with pytest.raises(MeshdepictError, match=r"a\.tif: writing GeoTIFF needs rasterio.*\[dem\]"):
        check_relief(tmp_path / "a.tif", shape=like.z.shape, kind="gray")
    path = written(tmp_path / "a.png", like, gray, valid)
    monkeypatch.undo()
    assert (tmp_path / "a.prj").read_text() == crs
    with rasterio.open(path) as dataset:
        assert dataset.crs.to_epsg() == 32633
        assert tuple(dataset.transform)[:6] == like.transform


# --- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "choices", "what"),
    [("a.bmp", {}, "end the name with .tif, .png or .jpg"), ("a", {}, "end the name with .tif"),
     ("a.png", {"kind": "values"}, "a picture holds no values; write a .tif"),
     ("a.tif", {"kind": "grey"}, "kind='grey' is not one of gray, color, values"),
     ("a.jpg", {"shape": (10, 70_000)}, "at most 65,500 pixels a side, not 70,000 x 10"),
     ("a.png", {"shape": (10**6, 10**6)}, "takes .* of memory, more than .* write a .tif")],
)  # fmt: skip
def test_what_a_file_can_not_hold_is_refused_before_any_work(tmp_path, name, choices, what):
    with pytest.raises(MeshdepictError, match=what):
        check_relief(tmp_path / name, **({"shape": (10, 10), "kind": "gray"} | choices))


def test_a_picture_larger_than_the_memory_allowed_is_refused(tmp_path):
    limits.set_max_memory("1MB")
    try:
        with pytest.raises(MeshdepictError, match="more than the 1 MB that are allowed"):
            check_relief(tmp_path / "a.png", shape=(1000, 1000), kind="gray")
        check_relief(tmp_path / "a.tif", shape=(1000, 1000), kind="gray")
    finally:
        limits.set_max_memory(None)


@pytest.mark.parametrize(
    ("window", "values", "valid"),
    [((slice(0, 4), slice(0, 9)), np.zeros((4, 8), np.uint8), None),
     ((slice(0, 4), slice(0, 9)), np.zeros((4, 9)), None),
     ((slice(0, 4), slice(0, 9)), np.zeros((4, 9, 3), np.uint8), None),
     ((slice(3, 3), slice(0, 9)), np.zeros((0, 9), np.uint8), None),
     ((slice(0, 8, 2), slice(0, 9)), np.zeros((8, 9), np.uint8), None),
     ((slice(10, 14), slice(0, 9)), np.zeros((4, 9), np.uint8), None),
     ((slice(0, 4), slice(0, 9)), np.zeros((4, 9), np.uint8), np.ones((4, 8), bool))],
)  # fmt: skip
@pytest.mark.parametrize("suffix", ["tif", "png"])
def test_a_window_that_does_not_fit_is_refused_and_leaves_nothing(
    tmp_path, terrain, suffix, window, values, valid
):
    like = terrain()
    with (
        pytest.raises(MeshdepictError, match=r"a window of rows|valid must have"),
        relief_writer(tmp_path / f"a.{suffix}", like=like) as out,
    ):
        out.write(*window, values, valid)
    assert os.listdir(tmp_path) == ["in"]


@pytest.mark.parametrize("suffix", ["tif", "png", "jpg"])
@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_what_is_broken_off_leaves_the_earlier_file(tmp_path, terrain, rng, suffix, error):
    like = terrain()
    path = written(tmp_path / f"a.{suffix}", like, *shades(rng, like.shape))
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir() if p.is_file()}

    def broken_off():
        with relief_writer(path, like=like) as out:
            out.write(slice(0, 4), slice(0, 9), np.zeros((4, 9), np.uint8))
            raise error

    with pytest.raises(error):
        broken_off()
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir() if p.is_file()} == before


@pytest.mark.parametrize("suffix", ["tif", "png"])
def test_a_replaced_file_s_permissions_and_link_are_kept(tmp_path, terrain, rng, suffix):
    like = terrain()
    path, link = tmp_path / f"a.{suffix}", tmp_path / f"link.{suffix}"
    path.touch()
    path.chmod(0o640)
    link.symlink_to(path)
    written(link, like, *shades(rng, like.shape))
    assert link.is_symlink()
    assert path.stat().st_size > 0
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("name", ["none/a.tif", "none/a.png", "in", "in/dem.tif/a.tif"])
def test_where_nothing_can_be_written_is_said(tmp_path, terrain, name):
    like = terrain()
    path = tmp_path / name
    if name == "in":
        path = tmp_path / "folder.tif"
        path.mkdir()
    with (
        pytest.raises(MeshdepictError, match=r"can't be written|is a folder"),
        relief_writer(path, like=like),
    ):
        pytest.fail("nothing can be written here")


def test_a_device_takes_no_geotiff(tmp_path, terrain):
    os.mkfifo(tmp_path / "a.tif")
    with (
        pytest.raises(MeshdepictError, match="is a device or a pipe: a GeoTIFF needs a file"),
        relief_writer(tmp_path / "a.tif", like=terrain()),
    ):
        pytest.fail("this would wait for ever")


def test_a_system_that_nobody_understands_is_left_out_with_a_note(tmp_path, rng):
    like = md.HeightField(hills(), transform=(10, 0, 1000, 0, -10, 2120), crs="the moon's")
    with pytest.warns(MeshdepictWarning, match="is not understood, and is left out"):
        path = written(tmp_path / "a.tif", like, *shades(rng, like.z.shape))
    with rasterio.open(path) as dataset:
        assert dataset.crs is None
        assert tuple(dataset.transform)[:6] == like.transform
    written(tmp_path / "a.png", like, *shades(rng, like.z.shape))
    assert "a.prj" not in os.listdir(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["tif", "png"])
@pytest.mark.parametrize("room", [20_000, 300_000, 900_000, 1_300_000])
def test_a_disk_that_is_full_leaves_nothing_and_says_so(tmp_path, suffix, room):
    """A limit on the size of files stands for the disk; GDAL meets it where Python doesn't."""
    pytest.importorskip("resource")
    (tmp_path / "out").mkdir()
    code = f"""
        import resource, signal, sys
        import numpy as np
        import meshdepict as md
        from meshdepict.io.relief_files import relief_writer
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        rng = np.random.default_rng(1)
        field = md.HeightField(np.ones((1100, 1300), np.float32))
        gray = rng.integers(0, 256, (1100, 1300), dtype=np.uint8)
        with relief_writer({str(tmp_path / "warm.tif")!r}, like=field) as out:
            out.write(slice(None), slice(None), gray)
        resource.setrlimit(resource.RLIMIT_FSIZE, ({room}, resource.RLIM_INFINITY))
        try:
            with relief_writer({str(tmp_path / "out" / f"a.{suffix}")!r}, like=field) as out:
                for top in range(0, 1100, 100):
                    rows = slice(top, top + 100)
                    out.write(rows, slice(None), gray[rows])
        except md.MeshdepictError as error:
            print(error)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=True
    )
    assert done.stderr == ""
    (line,) = done.stdout.splitlines()
    assert f"a.{suffix} could not be written: " in line
    assert os.listdir(tmp_path / "out") == []


def test_relief_may_replace_relief_and_nothing_else(tmp_path, terrain, rng):
    from meshdepict.baking.targets import check_target

    like = terrain()
    for name in ("a.tif", "a.png", "a.jpg"):
        check_target(written(tmp_path / name, like, *shades(rng, like.shape)), force=False)
    with pytest.raises(MeshdepictError, match=r"dem\.tif exists and was not written by meshdepict"):
        check_target(tmp_path / "in" / "dem.tif", force=False)
