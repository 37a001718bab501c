"""Files that went wrong elsewhere give what their README calls right."""

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.volumes import read_volume

SERIES = [
    ("dicom-comma-decimals/d_commads", (0.5, 0.5, 2), "decimal commas, read as points"),
    ("dicom-copied-files/d_dup", (1, 1, 2), r"twice are left out: 2, the first IM0003 \(1\)\.dcm"),
    ("dicom-localiser-inside/d_localiser", (1, 1, 2), r"localisers .* are left out: 1"),
    ("dicom-no-preamble/d_nopreamble", (1, 1, 2), None),
    ("dicom-no-preamble/d_nopreamble/IM0004", (1, 1, 2), None),
    ("enhanced-ct-frame-slopes/e_slopes.dcm", (1, 1, 2), None),
]


@pytest.mark.parametrize(("name", "spacing", "note"), SERIES, ids=[name for name, *_ in SERIES])
def test_series_are_the_right_volume(data, name, spacing, note):
    path = data / "cases" / name
    if note is None:
        volume = read_volume(path)
    else:
        with pytest.warns(MeshdepictWarning, match=note):
            volume = read_volume(path)
    np.testing.assert_array_equal(
        volume.values, np.load(data / "cases" / name.split("/")[0] / "ref.npy")
    )
    np.testing.assert_allclose(volume.spacing, spacing)
    assert (volume.unit, volume.length_unit) == ("HU", "mm")


def test_a_dicomdir_is_the_series_that_it_lists(data):
    folder = data / "cases" / "dicomdir-path" / "d_dicomdir"
    volume, beside = read_volume(folder / "DICOMDIR"), read_volume(folder)
    np.testing.assert_array_equal(volume.values, beside.values)
    assert len(volume.values) == 24


def test_nan_of_nifti_is_counted_as_that_of_nrrd(data):
    with pytest.raises(MeshdepictError, match="6,816 values that are NaN"):
        read_volume(data / "cases" / "nifti-float-nan" / "n_float_nan.nii.gz")


def test_micrometres_stay_micrometres(data):
    volume = read_volume(data / "cases" / "nrrd-space-units-um" / "r_um.nrrd")
    assert volume.length_unit == "µm"
    np.testing.assert_array_equal(volume.spacing, (10, 10, 20))


@pytest.mark.parametrize("kind", ["bmp", "png", "jpg"])
def test_slices_of_any_image_are_a_stack(data, kind):
    folder = data / "cases" / "stack-of-bmp"
    volume = read_volume(folder / f"s_{kind}", spacing=(0.1, 0.1, 0.2))
    assert volume.values.shape == (24, 32, 32)
    exact = read_volume(folder / "s_png", spacing=(1, 1, 1)).values.astype(int)
    off = np.abs(volume.values - exact)
    assert off.max() <= (40 if kind == "jpg" else 0)  # JPEG is lossy
    with pytest.warns(MeshdepictWarning, match="no spacing is given"):
        assert read_volume(folder / f"s_{kind}").length_unit == ""


def test_a_huge_extent_is_refused_and_not_believed(data):
    sentence = r"huge-extent\.vti is cut off or wrong: its array 'values' claims more values"
    with pytest.raises(MeshdepictError, match=sentence) as told:
        read_volume(data / "cases" / "hostile" / "huge-extent.vti")
    assert len(str(told.value).replace(str(data), "")) < 250
