"""Left stays left: a marked voxel is at the same place in the world in every format."""

import mmap
import struct
import warnings

import numpy as np
import pytest
from marked_volumes import DIRECTIONS, MARKS, assert_same, marked, nifti, placed, places

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.volumes import WRITABLE_VOLUMES, read_volume, write_volume
from meshdepict.shapes.volume import Volume

sitk = pytest.importorskip("SimpleITK", reason="SimpleITK (the extra [ct]) is not installed")


@pytest.mark.parametrize("direction", DIRECTIONS.values(), ids=DIRECTIONS)
@pytest.mark.parametrize("suffix", WRITABLE_VOLUMES)
def test_round_trips_keep_voxels_and_places(tmp_path, suffix, direction):
    volume = placed(direction)
    path = tmp_path / f"phantom{suffix}"
    write_volume(path, volume.values, volume)
    assert list(tmp_path.iterdir()) == [path]
    atol = 1e-5 if ".nii" in suffix else 1e-12  # NIfTI has single precision
    assert_same(read_volume(path), volume, atol)


@pytest.mark.parametrize("direction", DIRECTIONS.values(), ids=DIRECTIONS)
@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".nii", ".vti"])
def test_other_programs_see_the_same_places(tmp_path, suffix, direction):
    volume = placed(direction)
    path = tmp_path / f"phantom{suffix}"
    write_volume(path, volume.values, volume)
    if suffix == ".vti":
        import pyvista as pv

        image = pv.read(path)
        for value, place in places(volume).items():
            at = image.points[image.point_data["values"] == value][0]
            np.testing.assert_allclose(at, place, atol=1e-5)
        return
    image = sitk.ReadImage(str(path))
    for value, index in MARKS.items():
        assert image[index] == value
        place = image.TransformIndexToPhysicalPoint(index)
        np.testing.assert_allclose(place, volume.to_world(index), atol=1e-5)


@pytest.mark.parametrize("suffix", [".mhd", ".nhdr"])
def test_headers_with_data_beside_them_are_read(tmp_path, suffix):
    volume = placed(DIRECTIONS["oblique"])
    image = sitk.GetImageFromArray(volume.values)
    image.SetSpacing(volume.spacing.tolist())
    image.SetOrigin(volume.origin.tolist())
    image.SetDirection(volume.direction.ravel().tolist())
    sitk.WriteImage(image, str(tmp_path / f"a{suffix}"))
    assert_same(read_volume(tmp_path / f"a{suffix}"), volume, 1e-12)


@pytest.mark.parametrize("kind", ["u1", "i2", "u2", "i4", "f4", "f8"])
@pytest.mark.parametrize("suffix", [".vti", ".nrrd", ".mha", ".nii"])
def test_types_are_kept(tmp_path, suffix, kind):
    volume = Volume((marked() % 250).astype(kind))
    write_volume(tmp_path / f"a{suffix}", volume.values, volume)
    assert read_volume(tmp_path / f"a{suffix}").values.dtype == kind


@pytest.mark.parametrize(("kind", "written"), [("?", "u1"), ("f2", "f4"), ("i8", "i8")])
@pytest.mark.parametrize("suffix", [".vti", ".nrrd"])
def test_types_that_files_lack_are_written_in_the_next_wider(tmp_path, suffix, kind, written):
    values = (marked() % 2).astype(kind)
    write_volume(tmp_path / f"a{suffix}", values, Volume(values))
    read = read_volume(tmp_path / f"a{suffix}").values
    np.testing.assert_array_equal(read, values)
    assert read.dtype == written


@pytest.mark.parametrize("suffix", [".vti", ".nrrd", ".mha"])
def test_hounsfield_units_are_remembered(tmp_path, suffix):
    for hounsfield in (True, False):
        volume = placed(np.eye(3), hounsfield=hounsfield)
        write_volume(tmp_path / f"a{suffix}", volume.values, volume)
        assert read_volume(tmp_path / f"a{suffix}").hounsfield == hounsfield


def test_nifti_of_right_anterior_superior_becomes_left_posterior_superior(tmp_path):
    matrix = np.array([[0.5, 0, 0, -10], [0, 0.75, 0, 20], [0, 0, 2.5, 30]])
    (tmp_path / "a.nii").write_bytes(nifti(marked(), matrix))
    volume = read_volume(tmp_path / "a.nii")
    for value, (x, y, z) in MARKS.items():
        right, front, top = matrix @ (x, y, z, 1)
        np.testing.assert_allclose(places(volume)[value], (-right, -front, top), atol=1e-6)


def test_nifti_rescaling_is_applied(tmp_path):
    matrix = np.eye(3, 4)
    (tmp_path / "a.nii").write_bytes(nifti(marked(), matrix, slope=0.5, inter=-100))
    np.testing.assert_array_equal(read_volume(tmp_path / "a.nii").values, marked() * 0.5 - 100)


def test_nrrd_of_right_anterior_superior_becomes_left_posterior_superior(tmp_path):
    values = marked()
    head = (
        "NRRD0004\ntype: short\ndimension: 3\nspace: right-anterior-superior\nsizes: 5 6 7\n"
        "space directions: (0.5,0,0) (0,0.75,0) (0,0,2.5)\nkinds: domain domain domain\n"
        "endian: little\nencoding: raw\nspace origin: (-10,20,30)\n\n"
    )
    (tmp_path / "a.nrrd").write_bytes(head.encode() + values.tobytes())
    volume = read_volume(tmp_path / "a.nrrd")
    for value, (x, y, z) in MARKS.items():
        wanted = (10 - 0.5 * x, -20 - 0.75 * y, 30 + 2.5 * z)
        np.testing.assert_allclose(places(volume)[value], wanted)


@pytest.mark.parametrize("suffix", WRITABLE_VOLUMES)
def test_rgba_is_written_where_the_volume_is(tmp_path, suffix, rng):
    volume = placed(DIRECTIONS["oblique"])
    rgba = rng.integers(0, 256, (*volume.values.shape, 4)).astype(np.uint8)
    path = tmp_path / f"a{suffix}"
    write_volume(path, rgba, volume)
    if suffix == ".vti":
        import pyvista as pv

        image = pv.read(path)
        np.testing.assert_array_equal(image.point_data["RGBA"].reshape(rgba.shape), rgba)
        assert image.point_data.active_scalars_name == "RGBA"
        origin = image.origin
    elif suffix == ".ome.zarr":
        zarr = pytest.importorskip("zarr")
        group = zarr.open_group(str(path), mode="r")
        np.testing.assert_array_equal(np.moveaxis(group["0"][:], 0, -1), rgba)
        (image,) = group.attrs["multiscales"]
        steps = image["datasets"][0]["coordinateTransformations"]
        origin = next(step["translation"] for step in steps if "translation" in step)[:0:-1]
    else:
        image = sitk.ReadImage(str(path))
        np.testing.assert_array_equal(sitk.GetArrayViewFromImage(image), rgba)
        origin = image.GetOrigin()
    np.testing.assert_allclose(origin, volume.origin, atol=1e-5)
    with pytest.raises(MeshdepictError, match=f"a{suffix} has 4 values in a voxel, not one"):
        read_volume(path)


# --- files without a place ------------------------------------------------------------------


def test_numpy_arrays_are_mapped_and_ask_for_the_spacing(tmp_path):
    np.save(tmp_path / "a.npy", marked())
    volume = read_volume(tmp_path / "a.npy", spacing=(1, 2, 3))
    np.testing.assert_array_equal(volume.values, marked())
    np.testing.assert_array_equal(volume.to_world((1, 1, 1)), (1, 2, 3))
    memory = volume.values
    while not isinstance(memory, mmap.mmap):
        memory = memory.base
    with pytest.warns(MeshdepictWarning, match=r"a\.npy: no spacing is given, taken as 1"):
        read_volume(tmp_path / "a.npy")


@pytest.mark.parametrize("kind", ["u1", "u2", "f4"])
def test_tiff_stacks_of_pages_and_of_files_are_the_same(tmp_path, kind):
    values = (marked() % 251).astype(kind)
    sitk.WriteImage(sitk.GetImageFromArray(values), str(tmp_path / "pages.tif"))
    folder = tmp_path / "slices"
    folder.mkdir()
    for z, page in enumerate(values):
        # "slice 10" comes after "slice 9"
        sitk.WriteImage(sitk.GetImageFromArray(page), str(folder / f"slice {z + 5}.TIF"))
    for path in (tmp_path / "pages.tif", folder):
        volume = read_volume(path, spacing=(1, 2, 3))
        np.testing.assert_array_equal(volume.values, values)
        assert volume.values.dtype == kind
        np.testing.assert_array_equal(volume.to_world((1, 1, 1)), (1, 2, 3))
    with pytest.warns(MeshdepictWarning, match="no spacing is given"):
        read_volume(folder)


def test_tiff_slices_must_be_alike_and_whole(tmp_path):
    values = marked("u2")
    for z, page in enumerate(values):
        sitk.WriteImage(sitk.GetImageFromArray(page), str(tmp_path / f"{z}.tif"))
    sitk.WriteImage(sitk.GetImageFromArray(values[3, 1:]), str(tmp_path / "3.tif"))
    wanted = r"different size or type: 0\.tif \(5 x 6 uint16\) and 3\.tif \(5 x 5 uint16\)"
    with pytest.raises(MeshdepictError, match=wanted):
        read_volume(tmp_path, spacing=(1, 1, 1))
    (tmp_path / "3.tif").write_bytes(b"II*\0nothing")
    with pytest.raises(MeshdepictError, match=r"is cut off or damaged: 3\.tif"):
        read_volume(tmp_path, spacing=(1, 1, 1))
    empty_page = struct.pack("<2sHIHI", b"II", 42, 8, 0, 0)
    (tmp_path / "3.tif").write_bytes(empty_page)
    with pytest.raises(MeshdepictError, match=r"is damaged: 3\.tif"):
        read_volume(tmp_path, spacing=(1, 1, 1))


@pytest.mark.parametrize("share", [0.5, 0.97])
def test_tiffs_whose_pixels_are_cut_off_are_refused(tmp_path, share, capfd):
    from PIL import Image

    page = np.random.default_rng(4).integers(0, 60000, (40, 50)).astype(np.uint16)
    Image.fromarray(page).save(tmp_path / "a.tif")  # directory first, pixels last
    data = (tmp_path / "a.tif").read_bytes()
    (tmp_path / "a.tif").write_bytes(data[: int(len(data) * share)])
    with pytest.raises(MeshdepictError, match=r"is (cut off|damaged)"):
        read_volume(tmp_path / "a.tif", spacing=(1, 1, 1))


# --- real files -----------------------------------------------------------------------------


def test_the_head_is_the_same_from_nrrd_and_metaimage(data):
    nrrd = read_volume(data / "ct" / "ct_headsq_64x64x93.nrrd")
    assert_same_values = np.testing.assert_array_equal
    mha = read_volume(data / "ct" / "ct_headsq_64x64x93.mha")
    for name in ("values", "spacing", "origin", "direction"):
        assert_same_values(getattr(nrrd, name), getattr(mha, name))
    assert nrrd.values.shape == (93, 64, 64)
    assert nrrd.values.dtype == np.int16
    assert nrrd.range == (0, 3926)
    np.testing.assert_allclose(nrrd.spacing, (3.2, 3.2, 1.5))
    assert nrrd.unit == "raw"


def test_the_engine_of_nrrd_is_that_of_nifti_turned_and_moved(data):
    # The NIfTI file says right-anterior-superior, centred; the NRRD made of it says left-posterior-
    # superior from zero: the same object, turned by 180° about z, and no mirror image of it.
    nrrd = read_volume(data / "ct" / "ct_engine_256x256x128.nrrd")
    nifti = read_volume(data / "ct" / "ct_engine_256x256x128.nii.gz")
    np.testing.assert_array_equal(nrrd.values, nifti.values)
    turn = nifti.direction @ nrrd.direction.T
    np.testing.assert_array_equal(turn, np.diag((-1, -1, 1)))
    corners = (nrrd.outline - nrrd.origin) @ turn.T + nifti.origin
    np.testing.assert_allclose(corners, nifti.outline, atol=1e-12)
    np.testing.assert_array_equal(nifti.origin, (127, 127, -64))


def test_real_files_are_read_without_a_warning(data):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for path in sorted((data / "ct").iterdir()):
            read_volume(path)
