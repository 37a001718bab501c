"""What can go wrong with a volume's file is one sentence, and leaves earlier files whole."""

import gzip
import sys

import numpy as np
import pytest
from marked_volumes import assert_same, marked, nifti, placed

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.volumes import WRITABLE_VOLUMES, is_volume_path, read_volume, write_volume
from meshdepict.shapes.volume import Volume

sitk = pytest.importorskip("SimpleITK", reason="SimpleITK (the extra [ct]) is not installed")


def _size(path):
    return path.stat().st_size if path.is_file() else -1


@pytest.mark.parametrize("share", [0.1, 0.6, 0.97])
@pytest.mark.parametrize("suffix", [*WRITABLE_VOLUMES, ".npy", ".tif"])
def test_a_file_that_is_cut_off_is_refused(tmp_path, suffix, share, capfd):
    values = np.random.default_rng(3).integers(0, 2000, (10, 20, 30)).astype(np.int16)
    path = tmp_path / f"a{suffix}"
    if suffix == ".npy":
        np.save(path, values)
    elif suffix == ".tif":
        sitk.WriteImage(sitk.GetImageFromArray(values.astype(np.uint16)), str(path))
    else:
        write_volume(path, values, Volume(values))
    whole = path if path.is_file() else max(path.rglob("*"), key=_size)  # a folder's largest block
    data = whole.read_bytes()
    whole.write_bytes(data[: int(len(data) * share)])
    spacing = (1, 1, 1) if suffix in (".npy", ".tif") else None
    with pytest.raises(MeshdepictError, match=rf"a\{suffix[:4]}\S* is (cut off|damaged)"):
        read_volume(path, spacing=spacing)


def test_damaged_gzip_is_refused(tmp_path):
    data = bytearray(gzip.compress(nifti(marked(), np.eye(3, 4)), mtime=0))
    data[-6] ^= 0xFF  # its checksum
    (tmp_path / "a.nii.gz").write_bytes(data)
    with pytest.raises(MeshdepictError, match="is cut off"):
        read_volume(tmp_path / "a.nii.gz")


def test_four_dimensions_and_skewed_grids_are_refused(tmp_path):
    image = sitk.GetImageFromArray(np.zeros((2, 3, 4, 5), np.int16), isVector=False)
    sitk.WriteImage(image, str(tmp_path / "a.nii"))
    with pytest.raises(MeshdepictError, match=r"a\.nii has 4 dimensions \(5 x 4 x 3 x 2\)"):
        read_volume(tmp_path / "a.nii")
    head = (
        "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
        "space directions: (1,0,0) (0.5,2,0) (0,0,3)\nencoding: raw\nspace origin: (0,0,0)\n\n"
    )
    (tmp_path / "skew.nrrd").write_bytes(head.encode() + bytes(range(8)))
    with pytest.raises(MeshdepictError, match=r"skew\.nrrd: direction=.* resample a skewed grid"):
        read_volume(tmp_path / "skew.nrrd")


@pytest.mark.parametrize("name", ["a.xyz", "a"])
def test_unknown_formats_are_refused(tmp_path, name):
    (tmp_path / name).write_bytes(b"hello")
    with pytest.raises(
        MeshdepictError, match=r"its format is unknown; volumes are read from \.dcm"
    ):
        read_volume(tmp_path / name)


def test_missing_empty_and_forbidden_files_are_refused(tmp_path, monkeypatch):
    with pytest.raises(MeshdepictError, match="there is no such file or folder"):
        read_volume(tmp_path / "none.nrrd")
    (tmp_path / "a.nrrd").touch()
    with pytest.raises(MeshdepictError, match=r"a\.nrrd is empty"):
        read_volume(tmp_path / "a.nrrd")
    with pytest.raises(MeshdepictError, match="holds no DICOM images"):
        read_volume(tmp_path)

    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    def fail(*_, **__):
        raise OSError(5, "Input/output error")

    np.save(tmp_path / "a.npy", marked())
    monkeypatch.setattr(np, "load", refuse)
    with pytest.raises(MeshdepictError, match="may not be read: permission denied"):
        read_volume(tmp_path / "a.npy", spacing=(1, 1, 1))
    monkeypatch.setattr(np, "load", fail)
    with pytest.raises(MeshdepictError, match="could not be read: Input/output error"):
        read_volume(tmp_path / "a.npy", spacing=(1, 1, 1))


def test_options_that_do_not_go_with_the_format_are_refused(tmp_path):
    write_volume(tmp_path / "a.vti", marked(), Volume(marked(), hounsfield=True))
    with pytest.raises(MeshdepictError, match="is no DICOM, so that there is no series to choose"):
        read_volume(tmp_path / "a.vti", series=1)
    with pytest.raises(MeshdepictError, match=r"a\.vti says its spacing itself"):
        read_volume(tmp_path / "a.vti", spacing=(1, 1, 1))
    with pytest.raises(MeshdepictError, match="in Hounsfield units already"):
        read_volume(tmp_path / "a.vti", slope=1)


@pytest.mark.parametrize(
    ("given", "slope", "intercept"),
    [
        ({"slope": 2.0, "intercept": -1000}, 2, -1000),
        ({"slope": 2}, 2, 0),
        ({"intercept": -5}, 1, -5),
    ],
)
def test_slope_and_intercept_turn_raw_numbers_into_hounsfield_units(
    tmp_path, given, slope, intercept
):
    write_volume(tmp_path / "a.vti", marked(), Volume(marked()))
    volume = read_volume(tmp_path / "a.vti", **given)
    assert volume.unit == "HU"
    np.testing.assert_array_equal(volume.values, marked() * slope + intercept)


def test_writing_refuses_what_does_not_fit(tmp_path):
    volume = Volume(marked())
    with pytest.raises(MeshdepictError, match=r"not saved as \.dcm; use one of \.vti"):
        write_volume(tmp_path / "a.dcm", volume.values, volume)
    with pytest.raises(MeshdepictError, match="not saved as a file without suffix"):
        write_volume(tmp_path / "a", volume.values, volume)
    with pytest.raises(MeshdepictError, match=r"values must be numbers of shape \(7, 6, 5\)"):
        write_volume(tmp_path / "a.vti", volume.values[1:], volume)
    with pytest.raises(MeshdepictError, match="not float64 of shape"):
        write_volume(tmp_path / "a.vti", np.zeros((7, 6, 5, 4)), volume)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".vti", ".nrrd", ".nii.gz"])
def test_a_failure_to_write_leaves_the_earlier_file(tmp_path, monkeypatch, suffix):
    volume = placed(np.eye(3))
    path = tmp_path / f"a{suffix}"
    with pytest.raises(MeshdepictError, match="there is no such folder"):
        write_volume(tmp_path / "none" / path.name, volume.values, volume)
    path.write_bytes(b"earlier")

    def fail(*_, **__):
        raise RuntimeError("ITK ERROR: NrrdImageIO(0x55ef): no space")

    monkeypatch.setattr(sitk, "WriteImage", fail)
    if suffix == ".vti":
        import vtkmodules.vtkIOXML

        class Failing(vtkmodules.vtkIOXML.vtkXMLImageDataWriter):
            def Write(self):
                return 0

        monkeypatch.setattr(vtkmodules.vtkIOXML, "vtkXMLImageDataWriter", Failing)
    with pytest.raises(
        MeshdepictError, match=r"could not be written: (no space|VTK: writing failed)"
    ):
        write_volume(path, volume.values, volume)
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


def test_without_simpleitk_plain_files_are_read_and_the_rest_says_what_to_install(
    tmp_path, monkeypatch
):
    volume = placed(np.eye(3))
    for suffix in (".nrrd", ".mha", ".nii.gz"):
        write_volume(tmp_path / f"a{suffix}", volume.values, volume)
    page = sitk.GetImageFromArray(volume.values.astype(np.uint16))
    sitk.WriteImage(page, str(tmp_path / "a.tif"), useCompression=True)
    monkeypatch.setitem(sys.modules, "SimpleITK", None)
    write_volume(tmp_path / "a.vti", volume.values, volume)
    assert_same(read_volume(tmp_path / "a.vti"), volume, 1e-12)
    np.save(tmp_path / "a.npy", volume.values)
    read_volume(tmp_path / "a.npy", spacing=(1, 1, 1))
    for suffix in (".nrrd", ".mha", ".nii.gz"):
        assert_same(read_volume(tmp_path / f"a{suffix}"), volume, 1e-5)
    for action in (
        lambda: read_volume(tmp_path / "a.tif", spacing=(1, 1, 1)),
        lambda: write_volume(tmp_path / "b.nrrd", volume.values, volume),
    ):
        with pytest.raises(MeshdepictError, match=r"pip install 'meshdepict\[ct\]'"):
            action()


def test_what_itk_warns_of_is_a_warning_of_ours(capfd):
    from meshdepict.io.itk import simpleitk

    text = "WARNING: In itkX.hxx, line 502\nImageSeriesReader (0x55ef600d4670): missing slices\n\n"

    def complain():
        with simpleitk() as module:
            module.LoggerBase.GetGlobalITKLogger().DisplayWarningText(text)

    with pytest.warns(MeshdepictWarning, match=r"^missing slices$"):
        complain()
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("name", "wanted"),
    [("a.nii.gz", True), ("a.NRRD", True), ("a.dcm", True), ("a.npy", True), ("a.tif", False),
     ("a.ply.gz", False), ("a.ply", False), ("none", False)],
)  # fmt: skip
def test_volumes_are_known_by_their_suffix(tmp_path, name, wanted):
    assert is_volume_path(tmp_path / name) == wanted
    assert is_volume_path(tmp_path)


def test_a_grid_beyond_all_numbers_is_refused():
    with pytest.raises(MeshdepictError, match="reaches beyond 1e\\+150"):
        Volume(np.arange(8).reshape(2, 2, 2), spacing=(1e308, 1, 1), origin=(1e308, 0, 0))
