"""DICOM series: slices in their places, numbers in Hounsfield units, and sentences for the rest."""

import shutil

import numpy as np
import pytest
from conftest import rotation
from dicom_files import write_dicom, write_series

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.volumes import read_volume
from meshdepict.shapes.volume import Volume

sitk = pytest.importorskip("SimpleITK", reason="SimpleITK (the extra [ct]) is not installed")

TURNS = {
    "head first": np.eye(3),
    "feet first, on the belly": np.diag((-1.0, 1.0, -1.0)),
    "half a turn": np.diag((-1.0, -1.0, 1.0)),
    "sagittal": np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]),
    "oblique": rotation(np.random.default_rng(5)),
}


def phantom(direction=None, spacing=(0.5, 0.75, 2.0)) -> Volume:
    values = np.random.default_rng(0).integers(-1000, 1000, (7, 6, 5)).astype(np.int16)
    values[3, 2, 1] = 3000
    return Volume(
        values, spacing=spacing, origin=(10, -20, 30), direction=direction, hounsfield=True
    )


def stored(volume: Volume, kind="u2") -> np.ndarray:
    return (volume.values.astype(int) + 1024).astype(kind)


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_left_stays_left(tmp_path, turn):
    wanted = phantom(turn)
    volume = read_volume(write_series(tmp_path / "ct", stored(wanted), wanted))
    np.testing.assert_array_equal(volume.values, wanted.values)
    for name in ("spacing", "origin", "direction"):
        np.testing.assert_allclose(getattr(volume, name), getattr(wanted, name), atol=1e-8)
    np.testing.assert_allclose(volume.to_world((1, 2, 3)), wanted.to_world((1, 2, 3)), atol=1e-7)
    assert volume.unit == "HU"
    assert dict(volume.attributes) == {
        "series": "1.2.3.4",
        "description": "asymmetric",
        "modality": "CT",
    }


def test_itk_reads_the_same(tmp_path):
    wanted = phantom(TURNS["oblique"])
    folder = write_series(tmp_path, stored(wanted), wanted)
    volume = read_volume(folder)
    image = sitk.ReadImage(sitk.ImageSeriesReader.GetGDCMSeriesFileNames(str(folder)))
    np.testing.assert_array_equal(volume.values, sitk.GetArrayViewFromImage(image))
    np.testing.assert_allclose(volume.origin, image.GetOrigin(), atol=1e-9)
    np.testing.assert_allclose(volume.direction.ravel(), image.GetDirection(), atol=1e-8)
    np.testing.assert_allclose(volume.spacing, image.GetSpacing(), rtol=1e-8)


def test_slices_written_from_foot_to_head_or_back_are_the_same(tmp_path):
    wanted = phantom()
    upward = write_series(tmp_path / "up", stored(wanted), wanted)
    downward = tmp_path / "down"
    downward.mkdir()
    for number, path in enumerate(sorted(upward.iterdir(), reverse=True)):
        shutil.copy(path, downward / f"IM{number}")  # without a suffix
    np.testing.assert_array_equal(read_volume(downward).values, read_volume(upward).values)


@pytest.mark.parametrize("kind", ["u2", "i2"])
def test_numbers_are_rescaled_and_stay_narrow(tmp_path, kind):
    wanted = phantom()
    volume = read_volume(write_series(tmp_path, stored(wanted, kind), wanted))
    np.testing.assert_array_equal(volume.values, wanted.values)
    assert volume.values.dtype == np.int16


def test_bytes_without_rescaling_stay_bytes_and_raw(tmp_path):
    raw = (stored(phantom()) % 251).astype(np.uint8)
    folder = write_series(tmp_path, raw, phantom(), slope=None, intercept=None)
    volume = read_volume(folder)
    np.testing.assert_array_equal(volume.values, raw)
    assert volume.values.dtype == np.uint8
    assert volume.unit == "raw"
    assert read_volume(folder, slope=4, intercept=-1000).values.max() == 4 * int(raw.max()) - 1000


@pytest.mark.parametrize(
    ("tags", "unit"),
    [
        ({"rescale_type": "HU"}, "HU"),
        ({"rescale_type": "Z_EFF"}, "raw"),
        ({"modality": "MR"}, "raw"),
    ],
)
def test_hounsfield_units_are_those_of_rescaled_ct_only(tmp_path, tags, unit):
    assert read_volume(write_series(tmp_path, stored(phantom()), phantom(), **tags)).unit == unit


def test_every_slice_is_rescaled_by_its_own_slope(tmp_path):
    wanted = phantom()
    raw = stored(wanted)
    slopes = [1.0, 0.25, 2.5, 1.0, 0.125, 3.0, 1.5]  # the first whole: ITK would cut the others
    for z, slope in enumerate(slopes):
        position = wanted.to_world((0, 0, z))
        tags = {"modality": "PT", "slope": slope, "intercept": 0, "position": position}
        write_dicom(tmp_path / f"{z}.dcm", raw[z], spacing=(0.75, 0.5), **tags)
    volume = read_volume(tmp_path)
    np.testing.assert_allclose(volume.values, raw * np.reshape(slopes, (-1, 1, 1)), rtol=1e-6)
    assert volume.values.dtype == np.float32


@pytest.mark.parametrize(
    ("kind", "value", "padding"),
    [("i2", -2000, -2000), ("u2", 63536, 63536), ("u2", 0, 0)],
)
def test_padding_becomes_air(tmp_path, kind, value, padding):
    wanted = phantom()
    raw = stored(wanted, kind)
    raw[:, 0] = value
    raw[0] = np.where(raw[0] == value, 24, raw[0])  # a slice without, of air in its place
    volume = read_volume(write_series(tmp_path, raw, wanted, padding=padding))
    assert (volume.values[:, 0] == -1000).all()
    np.testing.assert_array_equal(volume.values[:, 1:], wanted.values[:, 1:])
    assert volume.values.dtype == np.int16


def test_padding_becomes_air_in_unsigned_numbers_and_whole_slices_too(tmp_path):
    wanted = phantom()
    raw = stored(wanted)
    raw[1] = 65535
    raw[2, 1:] = 65535
    volume = read_volume(write_series(tmp_path, raw, wanted, padding=65535, intercept=0))
    assert (volume.values[1] == -1000).all()
    assert (volume.values[2, 1:] == -1000).all()
    np.testing.assert_array_equal(volume.values[3:], raw[3:])
    assert volume.values.dtype == np.int32  # holds air's −1000 and all that 16 bits could


def test_padding_is_known_in_either_sign_and_may_be_a_range(tmp_path):
    from meshdepict.io.dicom import Slice

    def padding(**tags):
        names = {"first": "0028|0120", "last": "0028|0121", "signed": "0028|0103"}
        found = {names[name]: value for name, value in tags.items()}
        return Slice(tmp_path, (1, 1, 1), *np.zeros((3, 3)), {"0028|0100": "16"} | found).padding

    assert padding(first="63536 ", signed="1") == (-2000, -2000)
    assert padding(first="-2000", signed="0") == (63536, 63536)
    assert padding(first="-2000", last="-1990", signed="1") == (-2000, -1990)
    assert padding(first="7", last="3", signed="0") == (3, 7)
    assert padding(signed="0") is None


def test_padding_without_hounsfield_units_becomes_the_least_number(tmp_path):
    wanted = phantom()
    raw = stored(wanted)
    raw[:, 0] = 65535
    tags = {"padding": 65535, "slope": None, "intercept": None}
    volume = read_volume(write_series(tmp_path, raw, wanted, **tags))
    for found, given in zip(volume.values, raw, strict=True):
        assert (found[0] == given[1:].min()).all()


def test_a_file_of_many_frames_is_a_volume(tmp_path):
    wanted = phantom()
    path = write_dicom(tmp_path / "all.dcm", stored(wanted), spacing=(0.75, 0.5))
    for given in (path, tmp_path):
        with pytest.warns(MeshdepictWarning, match="doesn't say how far its frames are apart"):
            volume = read_volume(given)
        np.testing.assert_array_equal(volume.values, wanted.values)
        np.testing.assert_array_equal(volume.spacing, (0.5, 0.75, 1))
    write_dicom(tmp_path / "more.dcm", stored(wanted), spacing=(0.75, 0.5))
    with pytest.raises(MeshdepictError, match="several files of many slices each"):
        read_volume(tmp_path)


# --- several series -------------------------------------------------------------------------


@pytest.fixture
def two_series(tmp_path):
    wanted = phantom()
    write_series(tmp_path / "a", stored(wanted), wanted, series="1.1", description="thorax")
    other = {"series": "1.2", "description": "scout", "series_number": 7, "prefix": "s"}
    write_series(tmp_path / "b" / "deep", stored(wanted)[:3] + 5, wanted, **other)
    (tmp_path / "readme.txt").write_text("no DICOM")
    return tmp_path


def test_several_series_are_listed_and_one_is_asked_for(two_series):
    listed = (
        r"holds 2 series; choose one by its number or id \(series=1\): "
        r"1: thorax, CT, 7 slices, 1\.1; 2: scout, CT, 3 slices, 1\.2"
    )
    with pytest.raises(MeshdepictError, match=listed):
        read_volume(two_series)
    for wrong in (0, 3, "9.9", "one"):
        with pytest.raises(MeshdepictError, match=rf"holds 2 series, none of them '?{wrong}'?; "):
            read_volume(two_series, series=wrong)


@pytest.mark.parametrize(("series", "count"), [(1, 7), (2, 3), ("2", 3), ("1.1", 7), ("1.2", 3)])
def test_a_series_is_chosen_by_number_or_id(two_series, series, count):
    assert len(read_volume(two_series, series=series).values) == count


def test_texts_in_other_character_sets_can_be_printed(tmp_path):
    description = "Schädel".encode("latin-1")
    volume = read_volume(
        write_series(tmp_path, stored(phantom()), phantom(), description=description)
    )
    assert volume.attributes["description"] == "Sch\N{REPLACEMENT CHARACTER}del"


def test_one_file_stands_for_its_series(two_series):
    assert len(read_volume(two_series / "a" / "007.dcm").values) == 7
    mixed = two_series / "mixed"
    mixed.mkdir()
    for path in [*(two_series / "a").iterdir(), *(two_series / "b" / "deep").iterdir()]:
        shutil.copy(path, mixed)
    assert len(read_volume(mixed / "s000.dcm").values) == 3


# --- slices that make no grid ---------------------------------------------------------------


def change(folder, z, **tags):
    """Write slice z again with other tags."""
    wanted = phantom()
    usual = {"position": wanted.to_world((0, 0, z)), "spacing": (0.75, 0.5)}
    write_dicom(folder / f"{7 * z:03}.dcm", tags.pop("plane", stored(wanted)[z]), **(usual | tags))


@pytest.fixture
def series(tmp_path):
    return write_series(tmp_path, stored(phantom()), phantom())


def test_a_missing_slice_is_named_by_its_neighbours(series):
    (series / "021.dcm").unlink()
    sentence = (
        r"lacks slices: a slice is missing between 014\.dcm and 028\.dcm, 34 and 38 mm along their "
        r"normal \(elsewhere every 2 mm\)"
    )
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(series)
    (series / "014.dcm").unlink()
    with pytest.raises(MeshdepictError, match=r"2 slices are missing between 007\.dcm and 028"):
        read_volume(series)


def test_uneven_doubled_and_shifted_slices_are_refused(series):
    change(series, 3, position=(10, -20, 36.5))
    with pytest.raises(MeshdepictError, match=r"unevenly spaced slices: 2\.5 mm between 014\.dcm"):
        read_volume(series)
    change(series, 3, position=(10, -20, 34))
    with pytest.raises(MeshdepictError, match=r"two slices at one place, .* several passes"):
        read_volume(series)
    change(series, 3, position=(10.3, -20, 36))
    with pytest.raises(MeshdepictError, match=r"shifted against each other, 021\.dcm by 0\.3 mm"):
        read_volume(series)


def test_rounded_positions_are_even_enough(series):
    change(series, 3, position=(10.001, -20.002, 36.01))
    volume = read_volume(series)
    assert volume.spacing[2] == pytest.approx(2, abs=1e-12)


def test_a_tilted_gantry_is_refused_where_that_is_asked_for(tmp_path):
    tilted = np.radians(12)
    for z, plane in enumerate(stored(phantom())):
        position = (0, 2 * z * np.tan(tilted), 2 * z)
        write_dicom(tmp_path / f"{z}.dcm", plane, position=position)
    with pytest.raises(MeshdepictError, match="the gantry was tilted by 12°; resample it first"):
        read_volume(tmp_path, tilt="refuse")
    with pytest.raises(MeshdepictError, match="tilt='keep' is neither 'resample' nor 'refuse'"):
        read_volume(tmp_path, tilt="keep")


@pytest.mark.parametrize(
    ("tags", "what"),
    [
        ({"plane": np.zeros((5, 5), np.uint16)}, "more than one size in pixels"),
        ({"spacing": (0.8, 0.5)}, "more than one pixel spacing"),
        ({"orientation": (0, 1, 0, 1, 0, 0)}, "more than one orientation"),
        ({"position": None}, r"without position and orientation, 014\.dcm"),
    ],
)
def test_slices_that_are_not_alike_are_refused(series, tags, what):
    change(series, 2, **tags)
    with pytest.raises(MeshdepictError, match=what):
        read_volume(series)


def test_files_that_are_cut_off_are_left_out_with_a_warning(series):
    data = (series / "042.dcm").read_bytes()
    (series / "042.dcm").write_bytes(data[:-20])
    with pytest.warns(MeshdepictWarning, match=r"are left out: 1, the first 042\.dcm"):
        assert len(read_volume(series).values) == 6
    with pytest.raises(MeshdepictError, match=r"042\.dcm is cut off, damaged or no DICOM"):
        read_volume(series / "042.dcm")


def test_damaged_pixels_are_refused(series, monkeypatch):
    monkeypatch.setattr("meshdepict.io.dicom_pixels._PLAIN", ())  # as if compressed

    def fail(*_, **__):
        raise RuntimeError("ITK ERROR: GDCMImageIO(0x55ef): bad JPEG stream")

    monkeypatch.setattr(sitk, "ReadImage", fail)
    with pytest.raises(MeshdepictError, match=r"damaged file, 000\.dcm: bad JPEG stream"):
        read_volume(series)


def test_a_single_slice_is_refused(series):
    for path in sorted(series.iterdir())[1:]:
        path.unlink()
    with pytest.raises(MeshdepictError, match="holds a single slice"):
        read_volume(series)
