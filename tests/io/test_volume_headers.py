"""What headers of volumes claim: units are believed, counts compared, data files kept near."""

import bz2
import gzip
import os
import struct
import zlib

import numpy as np
import pytest
from conftest import rotation
from marked_volumes import DIRECTIONS, assert_same, marked, nifti, placed
from volume_files import write_metaimage, write_nrrd

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files import limits
from meshdepict.io.volumes import WRITABLE_VOLUMES, read_volume, write_volume
from meshdepict.shapes.volume import Volume

STRAIGHT = placed(np.eye(3))
DATA = marked().tobytes()


# --- every way to write the same voxels -----------------------------------------------------


def text(values) -> bytes:
    return "\n".join(map(str, values.ravel().tolist())).encode()


NRRDS = {
    "raw": (DATA, {}),
    "big-endian": (marked(">i2").tobytes(), {"endian": "big"}),
    "gzip": (gzip.compress(DATA), {"encoding": "gzip"}),
    "bzip2": (bz2.compress(DATA), {"encoding": "bz2"}),
    "ascii": (text(marked()), {"encoding": "ascii"}),
    "hex": (DATA.hex().encode(), {"encoding": "hex"}),
    "skipped": (bytes(9) + DATA, {"byte_skip": "9"}),
    "at the end": (bytes(11) + DATA, {"byte_skip": "-1"}),
    "skipped in gzip": (gzip.compress(bytes(9) + DATA), {"encoding": "gzip", "byte_skip": "9"}),
    "an axis of one": (
        DATA,
        {"dimension": "4", "sizes": "5 6 7 1",
         "space_directions": "(0.5,0,0) (0,0.75,0) (0,0,2.5) none"},
    ),
}  # fmt: skip


@pytest.mark.parametrize(("data", "fields"), NRRDS.values(), ids=NRRDS)
def test_nrrd_in_every_encoding(tmp_path, data, fields):
    assert_same(read_volume(write_nrrd(tmp_path / "a.nrrd", data, **fields)), STRAIGHT, 1e-12)


@pytest.mark.parametrize("space", ["left-anterior-superior", "RAS", "LPS", "scanner-xyz"])
def test_spaces_of_nrrd(tmp_path, space):
    volume = read_volume(write_nrrd(tmp_path / "a.nrrd", DATA, space=space))
    turn = {"left-anterior-superior": (1, -1, 1), "RAS": (-1, -1, 1)}.get(space, (1, 1, 1))
    np.testing.assert_allclose(volume.origin, np.multiply(turn, (10, -20, 30)))
    np.testing.assert_allclose(volume.direction, np.diag(turn))


def test_spacings_without_directions_and_none_at_all(tmp_path):
    fields = {"space": None, "space_directions": None, "space_origin": None}
    path = write_nrrd(
        tmp_path / "a.nrrd", DATA, spacings="0.5 0.75 2.5", axis_mins="10 -20 30", **fields
    )
    assert_same(read_volume(path), STRAIGHT, 1e-12)
    path = write_nrrd(tmp_path / "b.nrrd", DATA, **fields)
    with pytest.warns(MeshdepictWarning, match="no spacing is given, taken as 1 along every axis"):
        read_volume(path)
    np.testing.assert_array_equal(read_volume(path, spacing=(1, 2, 3)).spacing, (1, 2, 3))


METAIMAGES = {
    "raw": (DATA, {}),
    "big-endian": (marked(">i2").tobytes(), {"BinaryDataByteOrderMSB": "True"}),
    "compressed": (zlib.compress(DATA), {"CompressedData": "True"}),
    "gzipped": (gzip.compress(DATA), {"CompressedData": "True"}),
    "text": (text(marked()), {"BinaryData": "False"}),
}


@pytest.mark.parametrize(("data", "lines"), METAIMAGES.values(), ids=METAIMAGES)
def test_metaimage_in_every_encoding(tmp_path, data, lines):
    assert_same(read_volume(write_metaimage(tmp_path / "a.mha", data, **lines)), STRAIGHT, 1e-12)


def test_metaimage_rescaling_is_applied(tmp_path):
    lines = {"ElementToIntensityFunctionSlope": "2", "ElementToIntensityFunctionOffset": "-5"}
    volume = read_volume(write_metaimage(tmp_path / "a.mha", DATA, **lines))
    np.testing.assert_array_equal(volume.values, 2 * marked().astype(int) - 5)


def slices(folder, pattern):
    for z, page in enumerate(marked(), 1):
        (folder / (pattern % z)).write_bytes(page.tobytes())


def test_data_files_may_be_lists_and_patterns(tmp_path):
    slices(tmp_path, "s%03d.raw")
    names = "\n".join(f"s{z:03}.raw" for z in range(1, 8)) + "\n"
    listed = write_nrrd(tmp_path / "a.nhdr", b"")
    head = listed.read_text().rstrip("\n")
    listed.write_text(f"{head}\ndata file: LIST\n{names}")
    numbered = write_nrrd(tmp_path / "b.nhdr", b"", data_file="s%03d.raw 1 7 1")
    meta = write_metaimage(tmp_path / "c.mhd", names.encode(), ElementDataFile="LIST")
    meta_numbered = write_metaimage(tmp_path / "d.mhd", b"", ElementDataFile="s%03d.raw 1 7 1")
    for path in (listed, numbered, meta, meta_numbered):
        assert_same(read_volume(path), STRAIGHT, 1e-12)
    for path, more in (
        (write_nrrd(tmp_path / "b.nhdr", b"", data_file="s%03d.raw 1 99 1"), "more data files"),
        (write_nrrd(tmp_path / "f.nhdr", b"", data_file="s%03d.raw 1 7 0"), "more data files"),
        (write_metaimage(tmp_path / "d.mhd", b"", ElementDataFile="s%03d.raw 1 6 1"), "6 data"),
        (write_metaimage(tmp_path / "h.mhd", b"", ElementDataFile="none.raw"), "is not there"),
        (write_nrrd(tmp_path / "g.nhdr", b"", data_file="none.raw", encoding="hex"), "not there"),
        (
            write_metaimage(tmp_path / "e.mhd", b"", ElementDataFile="no.txt", BinaryData="False"),
            "'no.txt', which is not there",
        ),
    ):
        with pytest.raises(MeshdepictError, match=more):
            read_volume(path)


def test_a_header_of_its_own_may_skip_lines_and_bytes(tmp_path):
    (tmp_path / "a.raw").write_bytes(b"one line\nand another\n" + bytes(3) + DATA)
    path = write_nrrd(
        tmp_path / "a.nhdr", b"", data_file="./a.raw", line_skip="2", byte_skip="3"
    )  # fmt: skip
    assert_same(read_volume(path), STRAIGHT, 1e-12)
    (tmp_path / "b.raw").write_bytes(bytes(7) + DATA)
    for skip in ("7", "-1"):
        path = write_metaimage(
            tmp_path / "b.mhd", b"", ElementDataFile="b.raw", HeaderSize=skip
        )  # fmt: skip
        assert_same(read_volume(path), STRAIGHT, 1e-12)


def nifti2(values, matrix, units=0) -> bytes:
    header = bytearray(544)
    struct.pack_into("<i8shh", header, 0, 540, b"n+2\0\r\n\x1a\n", 4, 16)
    struct.pack_into("<8q", header, 16, 3, *values.shape[::-1], 1, 1, 1, 1)
    struct.pack_into("<8d", header, 104, *[1] * 8)
    struct.pack_into("<q2d", header, 168, 544, 1, 0)
    struct.pack_into("<2i", header, 344, 0, 1)
    struct.pack_into("<12d", header, 400, *np.ravel(matrix))
    struct.pack_into("<i", header, 500, units)
    return bytes(header) + values.tobytes()


def test_nifti_2_says_the_same_in_double_precision(tmp_path):
    matrix = np.array([[0.5, 0, 0, -10.1], [0, 0.75, 0, 20], [0, 0, 2.5, 30]])
    (tmp_path / "a.nii").write_bytes(nifti(marked(), matrix))
    (tmp_path / "b.nii").write_bytes(nifti2(marked(), matrix, units=2))
    one, two = read_volume(tmp_path / "a.nii"), read_volume(tmp_path / "b.nii")
    assert_same(one, two, 1e-6)
    np.testing.assert_array_equal(two.origin, (10.1, -20, 30))
    assert (one.length_unit, two.length_unit) == ("", "mm")


@pytest.mark.parametrize("mirror", [1, -1])
def test_quaternions_of_nifti_are_itks(tmp_path, mirror):
    sitk = pytest.importorskip("SimpleITK")
    volume = placed(rotation(np.random.default_rng(8)) * (1, 1, mirror))
    write_volume(tmp_path / "a.nii", volume.values, volume)
    data = bytearray((tmp_path / "a.nii").read_bytes())
    assert struct.unpack_from("<2h", data, 252)[0] > 0
    struct.pack_into("<h", data, 254, 0)  # no sform
    (tmp_path / "q.nii").write_bytes(data)
    found, image = read_volume(tmp_path / "q.nii"), sitk.ReadImage(str(tmp_path / "q.nii"))
    np.testing.assert_allclose(found.direction.ravel(), image.GetDirection(), atol=1e-6)
    np.testing.assert_allclose(found.origin, image.GetOrigin(), atol=1e-5)
    assert_same(found, volume, 1e-4)


def test_nifti_without_any_place_says_so(tmp_path):
    data = bytearray(nifti(marked(), np.diag((2, 3, 4, 1))[:3]))
    struct.pack_into("<2h", data, 252, 0, 0)
    (tmp_path / "a.nii").write_bytes(data)
    with pytest.warns(MeshdepictWarning, match="doesn't say how it lies in the world"):
        np.testing.assert_array_equal(read_volume(tmp_path / "a.nii").spacing, (2, 3, 4))


# --- units ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("spelt", "name"),
    [('"mm" "mm" "mm"', "mm"), ('"um" "um" "um"', "µm"), ('"µm" "μm" "micron"', "µm"),
     ('"M" "m" "meter"', "m"), ('"pixel" "pixel" "pixel"', ""),
     ('"mm" "" ""', ""), ("um um um", "µm"), (None, "")],
)  # fmt: skip
def test_nrrd_says_its_unit_or_has_none(tmp_path, spelt, name):
    volume = read_volume(write_nrrd(tmp_path / "a.nrrd", DATA, space_units=spelt))
    assert volume.length_unit == name
    np.testing.assert_array_equal(volume.spacing, (0.5, 0.75, 2.5))


def test_axes_in_several_units_become_one(tmp_path):
    path = write_nrrd(tmp_path / "a.nrrd", DATA, space_units='"um" "um" "mm"')
    volume = read_volume(path)
    assert volume.length_unit == "µm"
    np.testing.assert_allclose(volume.spacing, (0.5, 0.75, 2500))
    np.testing.assert_allclose(volume.origin, (10, -20, 30_000))
    fields = {"space": None, "space_directions": None, "space_origin": None}
    path = write_nrrd(
        tmp_path / "b.nrrd", DATA, spacings="1 2 3", units='"mm" "cm" "m"', **fields
    )  # fmt: skip
    np.testing.assert_allclose(read_volume(path).spacing, (1, 20, 3000))


@pytest.mark.parametrize(("code", "name"), [(0, ""), (1, "m"), (2, "mm"), (3, "µm"), (11, "µm")])
def test_nifti_says_its_unit_and_keeps_its_numbers(tmp_path, code, name):
    data = bytearray(nifti(marked(), np.diag((2, 3, 4, 1))[:3]))
    data[123] = code
    (tmp_path / "a.nii").write_bytes(data)
    volume = read_volume(tmp_path / "a.nii")
    assert volume.length_unit == name
    np.testing.assert_array_equal(volume.spacing, (2, 3, 4))


def test_metaimage_has_no_unit_unless_it_says_one(tmp_path):
    assert read_volume(write_metaimage(tmp_path / "a.mha", DATA)).length_unit == ""
    path = write_metaimage(tmp_path / "a.mha", DATA, DistanceUnits="um")
    assert read_volume(path).length_unit == "µm"


def test_decimal_commas_are_decimal_points(tmp_path):
    path = write_metaimage(tmp_path / "a.mha", DATA, ElementSpacing="0,5 2,5e-1 1")
    np.testing.assert_array_equal(read_volume(path).spacing, (0.5, 0.25, 1))
    path = write_metaimage(tmp_path / "a.mha", DATA, ElementSpacing="0,5,1 1 1")
    with pytest.raises(MeshdepictError, match="'0,5,1 1 1' for numbers"):
        read_volume(path)


@pytest.mark.parametrize("unit", ["", "mm", "µm", "m", "cm"])
@pytest.mark.parametrize("suffix", WRITABLE_VOLUMES)
def test_units_survive_being_written(tmp_path, suffix, unit):
    volume = placed(DIRECTIONS["oblique"], length_unit=unit)
    write_volume(tmp_path / f"a{suffix}", volume.values, volume)
    read = read_volume(tmp_path / f"a{suffix}")
    if ".nii" in suffix and unit == "cm":  # which NIfTI doesn't know
        assert read.length_unit == "mm"
        np.testing.assert_allclose(read.spacing, volume.spacing * 10, rtol=1e-6)
        return
    assert read.length_unit == unit
    np.testing.assert_allclose(read.spacing, volume.spacing, rtol=1e-6)


def test_units_go_with_what_is_made_of_a_volume():
    volume = placed(np.eye(3), length_unit="µm")
    assert volume.rescaled(1, 0).length_unit == "µm"
    assert volume.cropped(x=(0.2, 1)).length_unit == "µm"
    assert Volume.from_pyvista(volume.to_pyvista()).length_unit == "µm"
    assert Volume.from_pyvista(placed(np.eye(3)).to_pyvista()).length_unit == ""


# --- counts ---------------------------------------------------------------------------------

LESS = {
    ".nrrd": lambda path, sizes: write_nrrd(path, DATA, sizes=sizes),
    ".mha": lambda path, sizes: write_metaimage(path, DATA, DimSize=sizes),
}


@pytest.mark.parametrize("write", LESS.values(), ids=LESS)
def test_more_and_fewer_voxels_than_claimed_are_refused(tmp_path, write):
    path = tmp_path / "a.nrrd" if write is LESS[".nrrd"] else tmp_path / "a.mha"
    with pytest.raises(MeshdepictError, match="holds more voxels than the 5 x 6 x 4 that its head"):
        read_volume(write(path, "5 6 4"))
    with pytest.raises(
        MeshdepictError, match=r"is cut off: it holds 87\.5 % of the 5 x 6 x 8 voxel"
    ):
        read_volume(write(path, "5 6 8"))
    for sizes in ("5000 6000 7000", "50 60 700", "999999999999999 2 2", "5 0 7", "5 -6 7"):
        with pytest.raises(MeshdepictError, match=r"damaged|claims more voxels") as told:
            read_volume(write(path, sizes))
        assert not any(len(word) > 7 and word.isdigit() for word in str(told.value).split())
    path = write(path, "5 6 7")
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.warns(MeshdepictWarning, match="1 bytes after the voxels are left aside"):
        read_volume(path)


def test_more_voxels_in_nifti_and_numpy_are_refused(tmp_path):
    np.save(tmp_path / "a.npy", marked())
    for name, data in (
        ("a.npy", (tmp_path / "a.npy").read_bytes()),
        ("a.nii", nifti(marked(), np.eye(3, 4))),
        ("a.nii.gz", gzip.compress(nifti(marked(), np.eye(3, 4)) + bytes(300))),
    ):
        (tmp_path / name).write_bytes(data if name.endswith("gz") else data + bytes(300))
        with pytest.raises(MeshdepictError, match=r"holds more voxels than the 5 x 6 x 7 that"):
            read_volume(tmp_path / name, spacing=(1, 1, 1) if name == "a.npy" else None)


def test_text_and_hexadecimal_voxels_that_are_none_are_refused(tmp_path):
    for data, encoding, sentence in (
        (b"1 2 x" + b" 3" * 207, "ascii", "not all of it is numbers of type int16"),
        (b"99999" + b" 3" * 209, "ascii", "not all of it is numbers of type int16"),
        (b"1 2 3", "ascii", "is damaged or cut off"),
        (b"zz" * 420, "hex", "are no hexadecimal numbers"),
        (b"00" * 50, "hex", "is cut off"),
        (DATA, "zrl", "is encoded as 'zrl': save it as raw or gzip"),
    ):
        with pytest.raises(MeshdepictError, match=sentence):
            read_volume(write_nrrd(tmp_path / "a.nrrd", data, encoding=encoding))


# --- memory ---------------------------------------------------------------------------------


@pytest.fixture
def little_memory():
    limits.set_max_memory(100_000)
    yield
    limits.set_max_memory(None)


def test_bombs_are_refused_before_they_unpack(tmp_path, little_memory):
    zeros = bytes(200_000)
    sizes = {"sizes": "10 100 100"}
    head = nifti(np.zeros((100, 100, 10), np.int16), np.eye(3, 4))
    (tmp_path / "a.nii.gz").write_bytes(gzip.compress(head))
    meta = {"DimSize": "10 100 100", "CompressedData": "True"}
    for path in (
        write_nrrd(tmp_path / "a.nrrd", gzip.compress(zeros), encoding="gzip", **sizes),
        write_nrrd(tmp_path / "b.nrrd", bz2.compress(zeros), encoding="bz2", **sizes),
        write_nrrd(tmp_path / "c.nrrd", b"0 " * 100_000, encoding="ascii", **sizes),
        write_metaimage(tmp_path / "a.mha", zlib.compress(zeros), **meta),
        tmp_path / "a.nii.gz",
    ):
        with pytest.raises(MeshdepictError, match=r"claims more voxels than .* --max-memory"):
            read_volume(path)


def test_streams_that_are_longer_than_claimed_are_not_unpacked_to_their_end(tmp_path):
    packed = gzip.compress(DATA + bytes(1 << 24))
    with pytest.raises(MeshdepictError, match="holds more voxels"):
        read_volume(write_nrrd(tmp_path / "a.nrrd", packed, encoding="gzip"))
    skip = {"encoding": "gzip", "byte_skip": str(1 << 35)}
    with pytest.raises(MeshdepictError, match="claims more bytes before its voxels"):
        read_volume(write_nrrd(tmp_path / "a.nrrd", packed, **skip))


# --- reach ----------------------------------------------------------------------------------

OUTSIDE = ["/etc/hosts", "../a.raw", "https://host/a.raw", "sub/../../a.raw", "C:\\a.raw"]


@pytest.mark.parametrize("name", OUTSIDE)
def test_data_files_lie_in_the_headers_folder(tmp_path, name):
    (tmp_path / "a.raw").write_bytes(DATA)
    folder = tmp_path / "in"
    (folder / "sub").mkdir(parents=True)
    for path in (
        write_nrrd(folder / "a.nhdr", b"", data_file=name),
        write_metaimage(folder / "a.mhd", b"", ElementDataFile=name),
        write_metaimage(folder / "b.mhd", f"{name}\n".encode(), ElementDataFile="LIST"),
    ):
        with pytest.raises(MeshdepictError, match=r"names the data file .* only files in its own"):
            read_volume(path)
    (folder / "sub" / "a.raw").write_bytes(DATA)
    assert_same(
        read_volume(write_nrrd(folder / "c.nhdr", b"", data_file="sub/a.raw")), STRAIGHT, 1e-12
    )


def test_links_out_of_the_folder_and_pipes_are_refused(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "a.raw").write_bytes(DATA)
    (folder / "a.raw").symlink_to(tmp_path / "a.raw")
    os.mkfifo(folder / "pipe.raw")
    for name, what in (("a.raw", "a link out of its folder"), ("pipe.raw", "a named pipe")):
        with pytest.raises(MeshdepictError, match=what):
            read_volume(write_metaimage(folder / "a.mhd", b"", ElementDataFile=name))
    os.mkfifo(tmp_path / "ct.nrrd")
    with pytest.raises(MeshdepictError, match=r"ct\.nrrd is a named pipe, not a file"):
        read_volume(tmp_path / "ct.nrrd")
    with pytest.raises(MeshdepictError, match="is a device, not a file"):
        read_volume("/dev/null")


# --- what they are, and what to do ------------------------------------------------------------


def test_sheared_matrices_of_nifti_are_resampled_or_refused(tmp_path):
    # Slices of a plane through x, each pushed by one voxel along x: straight again, it moves.
    z, y, x = np.mgrid[:6, :5, :8]
    values = (100 * x + 7 * y + 3 * z).astype(np.int16)
    matrix = np.array([[1.0, 0, 1, 0], [0, 1, 0, 0], [0, 0, 2, 0]])
    (tmp_path / "a.nii").write_bytes(nifti(values, matrix))
    with pytest.warns(MeshdepictWarning, match=r"lie obliquely on each other, by 26\.6°, and are"):
        volume = read_volume(tmp_path / "a.nii")
    np.testing.assert_allclose(volume.spacing, (1, 1, 2))
    for k in range(6):
        for j, i in ((0, 0), (3, 5), (4, 7)):
            right, front, top, _ = np.vstack((matrix, (0, 0, 0, 1))) @ (i, j, k, 1)
            at = np.linalg.solve(
                volume.direction * volume.spacing, np.array((-right, -front, top)) - volume.origin
            )
            a, b, c = np.rint(at).astype(int)
            np.testing.assert_allclose(at, (a, b, c), atol=1e-6)
            assert volume.values[c, b, a] == values[k, j, i]
    with pytest.raises(MeshdepictError, match=r"lie obliquely .* 26\.6°: resample it first, or"):
        read_volume(tmp_path / "a.nii", tilt="refuse")
    skewed = np.array([[1.0, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 2, 0]])
    (tmp_path / "b.nii").write_bytes(nifti(values, skewed))
    with pytest.raises(MeshdepictError, match="columns: resample a skewed grid first"):
        read_volume(tmp_path / "b.nii")
    data = bytearray((tmp_path / "b.nii").read_bytes())
    struct.pack_into("<h", data, 252, 1)  # a quaternion besides
    (tmp_path / "c.nii").write_bytes(data)
    with pytest.warns(MeshdepictWarning, match=r"\(sform\) is sheared, its quaternion"):
        read_volume(tmp_path / "c.nii")


def test_nifti_of_other_kinds_says_what_it_is(tmp_path):
    good = nifti(marked(), np.eye(3, 4))
    for at, letters, value, sentence in (
        (70, "<h", 128, "has 3 values in a voxel, not one: take one of the colours' parts"),
        (70, "<h", 1536, "holds 128-bit floats: save it as integers or 32-bit floats"),
        (70, "<h", 32, "holds complex numbers: save it"),
        (70, "<h", 77, "numbers of the unknown type 77"),
        (344, "<4s", b"ni1\0", "is the header of a pair of files: convert it to a single"),
        (344, "<4s", bytes(4), "is ANALYZE 7.5, which doesn't say how it lies in the world"),
        (40, "<h", 9, "says 9 dimensions, and NIfTI has 1 to 7"),
        (40, "<h", 2, r"has 2 dimensions \(5 x 6\), not three: a volume has x, y and z"),
        (42, "<h", -5, "says an impossible number of voxels"),
        (108, "<f", float("nan"), "says an impossible place of its voxels"),
        (108, "<f", 1e30, "says an impossible place of its voxels"),
        (108, "<f", 5000, "damaged or cut off"),
        (280, "<f", float("nan"), "says distances of its voxels that are not finite"),
        (280, "<f", 0.0, "is not positive along every axis"),
    ):
        data = bytearray(good)
        struct.pack_into(letters, data, at, value)
        (tmp_path / "a.nii").write_bytes(data)
        with pytest.raises(MeshdepictError, match=sentence):
            read_volume(tmp_path / "a.nii")
    (tmp_path / "a.nii").write_bytes(b"nothing")
    with pytest.raises(MeshdepictError, match="it doesn't begin as NIfTI does"):
        read_volume(tmp_path / "a.nii")
    (tmp_path / "a.nii").write_bytes(gzip.compress(good)[:60])
    with pytest.raises(MeshdepictError, match="is cut off or damaged"):
        read_volume(tmp_path / "a.nii")


def test_nan_in_nifti_is_counted_and_never_water(tmp_path):
    values = marked().astype("f4")
    values[:2] = np.nan
    data = bytearray(nifti(marked(), np.eye(3, 4))[:352])
    struct.pack_into("<hh", data, 70, 16, 32)
    (tmp_path / "a.nii").write_bytes(bytes(data) + values.tobytes())
    with pytest.raises(MeshdepictError, match="has 60 values that are NaN or infinite"):
        read_volume(tmp_path / "a.nii")


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"type": "block"}, "holds values of the type 'block'"),
        ({"type": None}, "its header lacks 'type'"),
        ({"sizes": "5 6 x"}, "has '5 6 x' for whole numbers"),
        ({"sizes": "5 6"}, "says other dimensions than sizes"),
        ({"dimension": "2", "sizes": "5 42"}, r"has 2 dimensions \(5 x 42\)"),
        ({"dimension": "4", "sizes": "2 3 5 7", "kinds": "vector domain domain domain"},
         "has 2 values in a voxel"),
        ({"dimension": "4", "sizes": "3 2 5 7",
          "space directions": "none (1,0,0) (0,1,0) (0,0,1)"}, "has 3 values in a voxel"),
        ({"dimension": "4", "sizes": "5 6 7 2"}, r"has 4 dimensions \(5 x 6 x 7 x 2\)"),
        ({"space_directions": "(1,0,0) (0,1,0)"}, "its space directions are not three"),
        ({"space_directions": "(1,0,0) (0,1,0) (0,0)"}, "is no place in space"),
        ({"space_directions": "(1,0,0) (0,1,0) (0,0,a)"}, "for numbers"),
        ({"space_directions": "(1e200,0,0) (0,1,0) (0,0,1)"}, "not finite|beyond"),
        ({"space_origin": "(nan,0,0)"}, "is not three finite numbers"),
        ({"byte_skip": "-2"}, "says an impossible place of its voxels"),
    ],
)  # fmt: skip
def test_nrrd_of_other_kinds_says_what_it_is(tmp_path, fields, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(write_nrrd(tmp_path / "a.nrrd", DATA, **fields))


def test_what_is_no_nrrd_or_has_no_end_is_refused(tmp_path):
    path = tmp_path / "a.nrrd"
    for data, sentence in (
        (b"NRRD0004\nnonsense\n", "its header has the line 'nonsense'"),
        (b"hello", "it doesn't begin as NRRD does"),
        (b"NRRD0004\n" + b"#" * (1 << 21), "its header has no end"),
    ):
        path.write_bytes(data)
        with pytest.raises(MeshdepictError, match=sentence):
            read_volume(path)


@pytest.mark.parametrize(
    ("lines", "sentence"),
    [
        ({"ElementType": "MET_ODD"}, "holds values of the type 'ODD'"),
        ({"ElementType": None}, "it has no header of MetaImage"),
        ({"ElementNumberOfChannels": "3"}, "has 3 values in a voxel"),
        ({"ElementType": "MET_UCHAR_ARRAY"}, "has 2 values in a voxel"),
        ({"NDims": "2"}, "says other dimensions than sizes"),
        ({"DimSize": "5 6 a"}, "for whole numbers"),
        ({"ElementSpacing": "1 1"}, "in too few numbers"),
        ({"ElementSpacing": "1 1 b"}, "has '1 1 b' for numbers"),
        ({"ElementSpacing": "1 1 nan"}, "not finite"),
        ({"ElementSpacing": "1 1 0"}, "is not positive along every axis"),
        ({"HeaderSize": "-9"}, "says an impossible place of its voxels"),
    ],
)
def test_metaimage_of_other_kinds_says_what_it_is(tmp_path, lines, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(write_metaimage(tmp_path / "a.mha", DATA, **lines))
