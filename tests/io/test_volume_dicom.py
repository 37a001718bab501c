"""DICOM series: slices in their places, numbers in Hounsfield units, and sentences for the rest."""

import shutil

import numpy as np
import pytest
from conftest import rotation
from dicom_files import (
    RLE,
    run_lengths,
    write_dicom,
    write_dicomdir,
    write_enhanced,
    write_series,
)

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


def test_damaged_pixels_are_refused(tmp_path, monkeypatch):
    raw = stored(phantom())
    tags = {"syntax": "1.2.840.10008.1.2.4.70", "pixels": run_lengths(raw[:1])}
    series = write_series(tmp_path, raw, phantom(), **tags)

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


# --- one file of many frames ----------------------------------------------------------------


def heights(count=7, step=2.0):
    return [(10, -20, 30 + step * z) for z in range(count)]


@pytest.mark.parametrize("open_end", [False, True])
def test_enhanced_frames_are_in_the_order_of_their_places(tmp_path, open_end):
    wanted = phantom()
    order = [3, 0, 6, 1, 5, 2, 4]
    path = write_enhanced(
        tmp_path / "e.dcm", stored(wanted)[order], [heights()[z] for z in order],
        spacing=(0.75, 0.5), open_end=open_end,
    )  # fmt: skip
    volume = read_volume(path)
    np.testing.assert_array_equal(volume.values, wanted.values)
    np.testing.assert_allclose(volume.spacing, wanted.spacing)
    np.testing.assert_allclose(volume.to_world((1, 2, 3)), wanted.to_world((1, 2, 3)))
    assert (volume.unit, volume.length_unit) == ("HU", "mm")


def test_every_frame_is_rescaled_by_its_own_slope_and_intercept(tmp_path):
    raw = stored(phantom())
    slopes, intercepts = np.linspace(0.5, 2, 7), -1000 - np.arange(7.0)
    path = write_enhanced(
        tmp_path / "e.dcm", raw, heights(), slopes=slopes, intercepts=intercepts
    )  # fmt: skip
    wanted = raw * slopes[:, None, None] + intercepts[:, None, None]
    np.testing.assert_allclose(read_volume(path).values, wanted, rtol=1e-6)


def test_enhanced_frames_that_make_no_grid_are_refused(tmp_path):
    raw = stored(phantom())
    lacking = [z for z in heights(8) if z[2] != 36]
    sentence = r"lacks slices: a slice is missing between frame 3 and frame 4, 34 and 38 mm"
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(write_enhanced(tmp_path / "e.dcm", raw, lacking))
    twice = [*heights(6), heights(6)[5]]
    with pytest.raises(MeshdepictError, match="two slices at one place, frame 6 and frame 7"):
        read_volume(write_enhanced(tmp_path / "e.dcm", raw, twice))
    with pytest.raises(MeshdepictError, match=r"says where 5 frames are, but holds 7"):
        read_volume(write_enhanced(tmp_path / "e.dcm", raw, heights(), told=5))


def test_old_files_of_many_frames_say_their_distance_or_a_note_does(tmp_path):
    raw = stored(phantom())
    for tags, step in (
        ({"between": 2.5, "thickness": 3}, 2.5),
        ({"thickness": 3}, 3),
        ({"offsets": 4.0 * np.arange(7)}, 4),
    ):
        volume = read_volume(write_dicom(tmp_path / "old.dcm", raw, **tags))
        np.testing.assert_array_equal(volume.spacing, (1, 1, step))
        np.testing.assert_array_equal(volume.values, phantom().values)


def test_counts_of_frames_are_compared_with_the_pixels(tmp_path):
    path = write_dicom(tmp_path / "a.dcm", stored(phantom()), between=2)
    whole = path.read_bytes()
    claim = whole.index(b"IS\2\0007 ") + 4
    path.write_bytes(whole[:claim] + b"5 " + whole[claim + 2 :])
    with pytest.raises(MeshdepictError, match=r"holds 7 frames in a\.dcm, but the header claims 5"):
        read_volume(path)
    path.write_bytes(whole[:claim] + b"9 " + whole[claim + 2 :])
    with pytest.raises(MeshdepictError, match=r"holds fewer pixels than the 9 frames of 5 x 6"):
        read_volume(path)
    path.write_bytes(whole[:claim] + b"-3" + whole[claim + 2 :])
    with pytest.raises(MeshdepictError, match=r"a\.dcm says an impossible size of its image"):
        read_volume(path)


# --- what libraries rewrite -----------------------------------------------------------------


def test_inverted_display_does_not_invert_the_numbers(tmp_path):
    wanted = phantom()
    folder = write_series(tmp_path / "ct", stored(wanted), wanted, photometric="MONOCHROME1")
    np.testing.assert_array_equal(read_volume(folder).values, wanted.values)
    tags = {"photometric": "MONOCHROME1", "slope": None, "intercept": None}
    folder = write_series(tmp_path / "raw", stored(wanted), wanted, **tags)
    with pytest.warns(MeshdepictWarning, match="MONOCHROME1.* taken as they are"):
        np.testing.assert_array_equal(read_volume(folder).values, stored(wanted))


def test_decimal_commas_are_read_as_points_and_said(tmp_path):
    wanted = phantom()
    for z, plane in enumerate(stored(wanted)):
        commas = {
            "spacing": "0,75\\0,5", "position": f"10,0\\-20,0\\{30 + 2 * z},0",
            "intercept": "-1024,0", "slope": "1,0",
        }  # fmt: skip
        write_dicom(tmp_path / f"{z}.dcm", plane, **commas)
    with pytest.warns(MeshdepictWarning, match="decimal commas, read as points"):
        volume = read_volume(tmp_path)
    np.testing.assert_array_equal(volume.values, wanted.values)
    np.testing.assert_allclose(volume.spacing, wanted.spacing)
    np.testing.assert_allclose(volume.origin, wanted.origin)


@pytest.mark.parametrize(
    ("tags", "sentence"),
    [
        ({"spacing": "0,75,0,5"}, "pixel spacing '0,75,0,5' in a.dcm, which is no list of numbers"),
        ({"spacing": "nan\\1"}, "pixel spacing"),
        ({"position": "1\\2"}, r"position '1\\2' in a\.dcm"),
        ({"slope": "one"}, "rescale slope 'one' in a.dcm, which is no number"),
        ({"slope": 0}, "rescale slope of 0 in frame 1"),
        ({"orientation": (1, 0, 0, 1, 0, 0)}, "axes are not orthonormal"),
        ({"bits_stored": 40}, "40 of 16 bits are used"),
    ],
)
def test_numbers_that_are_none_are_refused(tmp_path, tags, sentence):
    path = write_dicom(tmp_path / "a.dcm", stored(phantom()), **({"between": 2} | tags))
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(path)


def test_impossible_hounsfield_units_are_said(tmp_path):
    raw = stored(phantom())
    write_series(tmp_path / "ct", raw, phantom(), intercept=-4096)
    with pytest.warns(MeshdepictWarning, match=r"-4067 … .* can't be the Hounsfield units"):
        read_volume(tmp_path / "ct")


def test_bits_beyond_those_stored_are_no_part_of_the_number(tmp_path):
    values = np.random.default_rng(1).integers(-2048, 2047, (4, 5, 6)).astype(np.int16)
    for z, plane in enumerate(values):
        overlaid = (plane.view(np.uint16) & 0x0FFF) | 0xA000
        tags = {"bits_stored": 12, "intercept": 0, "position": (0, 0, z)}
        write_dicom(tmp_path / f"{z}.dcm", overlaid.view(np.int16), **tags)
    np.testing.assert_array_equal(read_volume(tmp_path).values, values)


def test_padding_beyond_the_bits_stored_becomes_air(tmp_path):
    raw = stored(phantom()) & 0x0FFF
    raw[:, 0] = 63536
    volume = read_volume(
        write_series(tmp_path, raw, phantom(), padding=63536, bits_stored=12, intercept=0)
    )
    assert (volume.values[:, 0] == -1000).all()
    np.testing.assert_array_equal(volume.values[:, 1:], raw[:, 1:])


def test_compressed_pixels_are_those_that_were_stored(tmp_path):
    wanted = phantom()
    for kind in ("u2", "i2"):
        raw = stored(wanted, kind)
        plain = write_dicom(tmp_path / "plain.dcm", raw, between=2)
        tags = {"syntax": RLE, "pixels": run_lengths(raw.view(np.uint16)), "between": 2}
        packed = write_dicom(tmp_path / "packed.dcm", raw, **tags)
        for path in (plain, packed):
            np.testing.assert_array_equal(read_volume(path).values, wanted.values)
    path = write_enhanced(
        tmp_path / "e.dcm", raw, heights(), slopes=0.5, syntax=RLE, pixels=run_lengths(raw)
    )
    np.testing.assert_array_equal(read_volume(path).values, raw * 0.5 - 1024)


@pytest.mark.parametrize("compressor", ["JPEG", "JPEGLS", "JPEG2000", "RLE"])
def test_what_another_program_compressed_is_unpacked(tmp_path, compressor):
    values = np.random.default_rng(2).integers(0, 4000, (3, 64, 48)).astype(np.uint16)
    writer = sitk.ImageFileWriter()
    writer.UseCompressionOn()
    writer.SetCompressor(compressor)
    writer.SetFileName(str(tmp_path / "j.dcm"))
    writer.Execute(sitk.GetImageFromArray(values))
    np.testing.assert_array_equal(read_volume(tmp_path / "j.dcm").values, values)


def test_damaged_fragments_are_refused(tmp_path, capfd):
    raw = stored(phantom())
    pixels = run_lengths(raw)
    path = write_dicom(tmp_path / "a.dcm", raw, syntax=RLE, pixels=pixels[: len(pixels) // 2])
    with pytest.raises(MeshdepictError, match=r"a\.dcm holds a damaged file, a\.dcm: "):
        read_volume(path)
    path = write_dicom(tmp_path / "a.dcm", raw, syntax="1.2.3.4", pixels=pixels, between=2)
    with pytest.raises(MeshdepictError, match=r"holds a damaged file, a\.dcm"):
        read_volume(path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("syntax", ["1.2.840.10008.1.2.1.99"])
def test_deflated_files_are_read(tmp_path, syntax):
    path = write_dicom(tmp_path / "d.dcm", stored(phantom()), syntax=syntax, between=2)
    np.testing.assert_array_equal(read_volume(path).values, phantom().values)


# --- files without a preamble, and directories ------------------------------------------------


@pytest.mark.parametrize("implicit", [False, True])
def test_files_without_preamble_and_suffix_are_read(tmp_path, implicit):
    wanted = phantom()
    folder = write_series(tmp_path / "ct", stored(wanted), wanted, preamble=False)
    for path in list(folder.iterdir()):
        data = without_types(path.read_bytes()) if implicit else path.read_bytes()
        path.with_name(f"1.2.840.{path.stem}").write_bytes(data)
        path.unlink()
    for given in (folder, next(folder.iterdir())):
        volume = read_volume(given)
        np.testing.assert_array_equal(volume.values, wanted.values)
        np.testing.assert_allclose(volume.spacing, wanted.spacing)


def without_types(data: bytes) -> bytes:
    """Elements of explicit types as those of implicit ones."""
    found, at = b"", 0
    while at < len(data):
        long = data[at + 4 : at + 6] in (b"OB", b"OW", b"SQ")
        start = at + (12 if long else 8)
        length = int.from_bytes(data[at + 8 : at + 12] if long else data[at + 6 : at + 8], "little")
        found += data[at : at + 4] + length.to_bytes(4, "little") + data[start : start + length]
        at = start + length
    return found


def test_a_dicomdir_stands_for_the_series_that_it_lists(tmp_path):
    wanted = phantom()
    folder = write_series(tmp_path / "pt0", stored(wanted), wanted)
    write_series(tmp_path / "unlisted", stored(wanted) + 1, wanted, series="9.9")
    names = [f"PT0\\{path.name.upper()}" for path in sorted(folder.iterdir())]
    volume = read_volume(write_dicomdir(tmp_path / "DICOMDIR", names))
    np.testing.assert_array_equal(volume.values, wanted.values)


@pytest.mark.parametrize(
    ("names", "sentence"),
    [
        ([], "is a DICOMDIR that lists no files: give the folder"),
        (
            ["PT9\\IM1", "PT9\\IM2"],
            "is a DICOMDIR: it lists 2 files, and none is beside it; give the folder",
        ),
        (["..\\secret"], r"names the file '\.\./secret', which leads out of its folder"),
        (["\\etc\\passwd"], "names the file '/etc/passwd', an absolute path"),
    ],
)
def test_directories_of_nothing_and_of_other_places_are_refused(tmp_path, names, sentence):
    path = write_dicomdir(tmp_path / "DICOMDIR", names)
    with pytest.raises(MeshdepictError, match=f"DICOMDIR {sentence}"):
        read_volume(path)


def test_dicom_without_an_image_says_so(tmp_path):
    path = write_dicom(tmp_path / "report.dcm", stored(phantom()))
    data = path.read_bytes()
    path.write_bytes(data[: data.index(b"\xe0\x7f\x10\0")])
    with pytest.raises(MeshdepictError, match="is DICOM, but holds no image: give the folder"):
        read_volume(path)


@pytest.mark.parametrize("tags", [{"samples": 3}, {"photometric": "PALETTE COLOR"}])
def test_colours_are_no_ct(tmp_path, tags):
    path = write_dicom(tmp_path / "a.dcm", stored(phantom()), between=2, **tags)
    with pytest.raises(MeshdepictError, match=r"a\.dcm holds colours \(.*\), not CT"):
        read_volume(path)


def test_pixels_of_odd_sizes_are_refused(tmp_path):
    path = write_dicom(tmp_path / "a.dcm", stored(phantom()).astype("u8"), between=2)
    with pytest.raises(MeshdepictError, match="has 64 bits in a pixel, not 8, 16 or 32"):
        read_volume(path)


# --- what is left out -------------------------------------------------------------------------

COPIES = {
    "as file managers do": ("copy", {}),
    "by an archive, with another id": ("IM9.dcm", {"uid": "7.7"}),
}


@pytest.mark.parametrize(("name", "tags"), COPIES.values(), ids=COPIES)
def test_slices_copied_twice_are_left_out(series, name, tags):
    change(series, 3, **tags)
    (series / f"{name}.dcm").write_bytes((series / "021.dcm").read_bytes())
    change(series, 3)
    with pytest.warns(MeshdepictWarning, match=r"twice are left out: 1, the first .*021\.dcm"):
        volume = read_volume(series)
    np.testing.assert_array_equal(volume.values, phantom().values)


def test_another_picture_at_the_same_place_is_no_copy(series):
    (series / "other.dcm").write_bytes((series / "021.dcm").read_bytes())
    change(series, 3, plane=stored(phantom())[3] + 1)
    with pytest.raises(MeshdepictError, match=r"two slices at one place, .* several passes"):
        read_volume(series)


@pytest.mark.parametrize(
    "tags",
    [
        {"image_type": "ORIGINAL\\PRIMARY\\LOCALIZER"},
        {"orientation": (1, 0, 0, 0, 0, -1)},  # coronal, and doesn't say what it is
        {"kind": "1.2.840.10008.5.1.4.1.1.7", "position": None, "orientation": None},
        {"kind": "1.2.840.10008.5.1.4.1.1.7", "position": None, "samples": 3},
    ],
)
def test_localisers_and_pictures_of_screens_are_left_out(series, tags):
    write_dicom(series / "scout.dcm", np.zeros((9, 8), np.uint16), **tags)
    with pytest.warns(MeshdepictWarning, match=r"localisers .* left out: 1, the first scout\.dcm"):
        volume = read_volume(series)
    np.testing.assert_array_equal(volume.values, phantom().values)


def test_localisers_alone_are_slices(tmp_path):
    wanted = phantom()
    folder = write_series(tmp_path, stored(wanted), wanted, image_type="DERIVED\\LOCALIZER")
    np.testing.assert_array_equal(read_volume(folder).values, wanted.values)


# --- a tilted gantry --------------------------------------------------------------------------


@pytest.mark.parametrize("tilt", [12.0, -20.0])
def test_a_tilted_gantry_becomes_a_straight_grid(tmp_path, tilt):
    # A linear field of the world, which linear interpolation keeps exactly.
    spacing = np.array((0.5, 0.75, 2.0))
    lean = np.tan(np.radians(tilt))

    def field(x, y, z):
        return 300 + 8 * x + 6 * y - 10 * z

    for k in range(8):
        y0 = 5 + lean * 2 * k
        y, x = np.mgrid[:24, :20]
        plane = field(3 + 0.5 * x, y0 + 0.75 * y, 2.0 * k)
        write_dicom(
            tmp_path / f"{k}.dcm", np.rint(plane * 10).astype(np.int16), slope=0.1, intercept=0,
            position=(3, y0, 2 * k), spacing=(0.75, 0.5),
        )  # fmt: skip
    with pytest.warns(MeshdepictWarning, match=rf"tilted by {abs(tilt):g}°, its slices are resamp"):
        volume = read_volume(tmp_path)
    np.testing.assert_allclose(volume.spacing, spacing, rtol=1e-6)
    np.testing.assert_allclose(volume.direction, np.eye(3), atol=1e-6)
    nz, ny, nx = volume.values.shape
    z, y, x = np.mgrid[:nz, :ny, :nx]
    places = volume.to_world(np.stack((x, y, z), axis=-1))
    inside = volume.values > -999.5
    assert inside.mean() > 0.5
    expected = field(*np.moveaxis(places, -1, 0))
    # Rounded to a tenth where it was stored, and half a step of that in between.
    within = inside & np.roll(inside, 1, 1) & np.roll(inside, -1, 1)
    np.testing.assert_allclose(volume.values[within], expected[within], atol=0.11)
    # Nothing that was measured is lost: the grid reaches as far as the slices do.
    low, high = volume.outline.min(axis=0), volume.outline.max(axis=0)
    ends = [5, 5 + lean * 14, 5 + 0.75 * 23, 5 + 0.75 * 23 + lean * 14]
    assert low[1] <= min(ends) + 1e-6
    assert high[1] >= max(ends) - 1e-6


def test_a_tilt_that_takes_too_much_memory_is_refused(tmp_path, monkeypatch):
    for z, plane in enumerate(stored(phantom())):
        write_dicom(tmp_path / f"{z}.dcm", plane, position=(0, 2 * z, 2 * z))
    monkeypatch.setattr("meshdepict.io.tilt.max_memory", lambda: 500)
    with pytest.raises(MeshdepictError, match="straight it takes more than 500 bytes of memory"):
        read_volume(tmp_path)


# --- one image in several files of many frames ------------------------------------------------


def parts(folder, wanted, cuts, **tags):
    """An enhanced image, cut into files whose frames are in no order of places."""
    folder.mkdir(exist_ok=True)
    order = np.random.default_rng(3).permutation(len(wanted.values))
    raw = stored(wanted)
    paths = []
    for number, frames in enumerate(np.split(order, cuts), 1):
        places = [wanted.to_world((0, 0, z)) for z in frames]
        said = {"concatenation": "1.2.3.99", "part": number, "parts": len(cuts) + 1} | tags
        paths.append(
            write_enhanced(
                folder / f"part{number}.dcm", raw[frames], places, spacing=(0.75, 0.5), **said
            )
        )
    return paths


@pytest.mark.parametrize("cuts", [[3], [1, 2], [1, 2, 3, 4, 5, 6]], ids=str)
def test_an_image_cut_into_files_is_one_volume_again(tmp_path, cuts):
    wanted = phantom()
    paths = parts(tmp_path / "ct", wanted, cuts)
    for path in (tmp_path / "ct", paths[0], paths[-1]):
        volume = read_volume(path)
        np.testing.assert_array_equal(volume.values, wanted.values)
        np.testing.assert_allclose(volume.spacing, wanted.spacing)
        np.testing.assert_allclose(volume.origin, wanted.origin)


def test_files_of_one_series_are_one_volume_without_the_word_concatenation(tmp_path):
    wanted = phantom()
    paths = parts(tmp_path / "ct", wanted, [2, 5], concatenation=None, part=None, parts=None)
    np.testing.assert_array_equal(read_volume(tmp_path / "ct").values, wanted.values)
    assert len(read_volume(paths[2]).values) == 2  # a file of many frames stands for itself


def test_parts_that_are_missing_are_said(tmp_path):
    wanted = phantom()
    raw, places = stored(wanted), [wanted.to_world((0, 0, z)) for z in range(7)]
    said = {"concatenation": "1.2.3.99", "parts": 2, "spacing": (0.75, 0.5)}
    path = write_enhanced(tmp_path / "part1.dcm", raw[:4], places[:4], **said)
    with pytest.warns(MeshdepictWarning, match="spread over 2 files, of which 1 are there"):
        volume = read_volume(path)
    np.testing.assert_array_equal(volume.values, wanted.values[:4])
    write_enhanced(tmp_path / "part2.dcm", raw[5:], places[5:], **said)
    with pytest.raises(
        MeshdepictError, match=r"lacks slices: a slice is missing between part1\.dcm"
    ):
        read_volume(tmp_path)


def test_passes_in_a_file_each_are_several_volumes(tmp_path):
    wanted = phantom()
    raw, places = stored(wanted), [wanted.to_world((0, 0, z)) for z in range(7)]
    for number in (1, 2):
        write_enhanced(tmp_path / f"{number}.dcm", raw + number, places, spacing=(0.75, 0.5))
    sentence = "two slices at one place, 1.dcm, frame 1 and 2.dcm, frame 1.*path of one of its"
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(tmp_path)
    np.testing.assert_array_equal(read_volume(tmp_path / "2.dcm").values, wanted.values + 2)


def test_a_file_that_is_there_twice_is_read_once(tmp_path):
    wanted = phantom()
    (path,) = parts(tmp_path / "ct", wanted, [], parts=1)
    shutil.copy(path, tmp_path / "ct" / "copy of part1.dcm")
    with pytest.warns(MeshdepictWarning, match="slices that are there twice are left out: 7"):
        volume = read_volume(tmp_path / "ct")
    np.testing.assert_array_equal(volume.values, wanted.values)


def test_parts_may_be_compressed_and_rescaled_each_by_itself(tmp_path):
    wanted = phantom()
    raw, places = stored(wanted), [wanted.to_world((0, 0, z)) for z in range(7)]
    for number, (frames, slope) in enumerate(((slice(0, 3), 1.0), (slice(3, 7), 0.5))):
        own = raw[frames]
        write_enhanced(
            tmp_path / f"{number}.dcm", own, places[frames], slopes=slope, spacing=(0.75, 0.5),
            syntax=RLE, pixels=run_lengths(own), concatenation="1.2.3.99",
        )  # fmt: skip
    found = read_volume(tmp_path).values
    np.testing.assert_array_equal(found[:3], wanted.values[:3])
    np.testing.assert_allclose(found[3:], raw[3:] * 0.5 - 1024.0)


# --- what else a folder may hold --------------------------------------------------------------


def test_a_damaged_slice_is_named_where_it_is_missed(series):
    path = sorted(series.iterdir())[1]
    path.write_bytes(path.read_bytes()[:-20])
    sentence = rf"a slice is missing between .* damaged, are left out: 1, the first {path.name}"
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(series)


def test_a_folder_without_dicom_says_what_it_holds_instead(tmp_path):
    with pytest.raises(MeshdepictError, match="holds no DICOM images: it has no files"):
        read_volume(tmp_path)
    for number in range(3):
        (tmp_path / f"{number}.webp").write_bytes(b"RIFF")
    (tmp_path / "notes.txt").write_text("none", encoding="utf-8")
    with pytest.raises(MeshdepictError, match=r"most of its 4 files are \.webp"):
        read_volume(tmp_path)
    (tmp_path / "a.dcm").write_bytes(bytes(128) + b"DICM" + bytes(3))
    with pytest.raises(MeshdepictError, match=r"can be read: a\.dcm is damaged, or holds none"):
        read_volume(tmp_path)
