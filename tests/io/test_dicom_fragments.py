"""Compressed pixels of DICOM: run lengths unpacked here, and nothing wrong handed to GDCM."""

import struct

import numpy as np
import pytest
from dicom_files import RLE, run_lengths, write_dicom

from meshdepict.errors import MeshdepictError
from meshdepict.io.dicom_fragments import check_jpeg, fragments_of, unpacked_runs
from meshdepict.io.volumes import read_volume

sitk = pytest.importorskip("SimpleITK", reason="SimpleITK (the extra [ct]) is not installed")

FRAMES = np.random.default_rng(0).integers(0, 4, (3, 6, 5)).astype(np.uint16) * 1000


def packed_bits(data: bytes) -> bytes:
    """Bytes in literal runs of one to 128, and runs of equal ones: by turns, and a pause."""
    parts, at = [b"\x80"], 0  # 128: nothing
    for length in (1, 128, 7, 2) * len(data):
        piece = data[at : at + length]
        equal = len(set(piece)) == 1 and len(piece) > 1
        parts += [bytes([257 - len(piece), piece[0]]) if equal else bytes([len(piece) - 1]) + piece]
        at += length
        if at >= len(data):
            break
    return b"".join(parts)


def fragment(frame: np.ndarray) -> bytes:
    """A frame's segments, of the highest byte first."""
    size = frame.dtype.itemsize
    planes = frame.astype(frame.dtype.newbyteorder(">")).view(np.uint8).reshape(-1, size).T
    segments = [packed_bits(plane.tobytes()) for plane in planes]
    starts = [64 + sum(map(len, segments[:k])) for k in range(size)]
    return struct.pack("<16I", size, *starts, *[0] * (15 - size)) + b"".join(segments)


@pytest.mark.parametrize("kind", ["u1", "u2", "u4"])
@pytest.mark.parametrize("rows", [4, 40])
def test_runs_and_literals_of_all_lengths_are_unpacked(kind, rows):
    rng = np.random.default_rng(1)
    frames = rng.integers(0, np.iinfo(kind).max, (2, rows, 9), endpoint=True).astype(kind)
    frames[1, : rows // 2] = 3
    found = unpacked_runs([fragment(frame) for frame in frames], frames.shape, int(kind[1]), "a")
    np.testing.assert_array_equal(found, frames)
    assert found.dtype == kind


def test_run_lengths_need_no_library(tmp_path, monkeypatch):
    path = write_dicom(
        tmp_path / "a.dcm", FRAMES, syntax=RLE, pixels=run_lengths(FRAMES), between=2
    )
    monkeypatch.setattr(sitk, "ReadImage", None)
    np.testing.assert_array_equal(read_volume(path).values, FRAMES.astype(int) - 1024)


GOOD = fragment(FRAMES[0])
HEAD = struct.unpack("<16I", GOOD[:64])
SPOILED = {
    "no head": GOOD[:40],
    "cut off": GOOD[:-3],
    "one segment": struct.pack("<16I", 1, *HEAD[1:]) + GOOD[64:],
    "many segments": struct.pack("<16I", 4_000_000_000, *HEAD[1:]) + GOOD[64:],
    "far away": struct.pack("<16I", 2, 64, 4_000_000_000, *HEAD[3:]) + GOOD[64:],
    "in the head": struct.pack("<16I", 2, 0, *HEAD[2:]) + GOOD[64:],
    "backwards": struct.pack("<16I", 2, HEAD[2], 64, *HEAD[3:]) + GOOD[64:],
    "too long": GOOD[:64] + b"\x81\0" * 50,
    "too long a literal": GOOD[:64] + b"\x7f" + bytes(300),
    "nothing": GOOD[:64],
}


@pytest.mark.parametrize("name", SPOILED)
def test_damaged_runs_are_refused(name):
    with pytest.raises(MeshdepictError, match=r"a\.dcm: its run lengths don't unpack to the size"):
        unpacked_runs([SPOILED[name]], (1, 6, 5), 2, "a.dcm")


def test_frames_that_are_missing_are_refused():
    for count in (0, 1, 3):
        with pytest.raises(MeshdepictError, match="its run lengths don't unpack to the size"):
            unpacked_runs([GOOD] * count, (2, 6, 5), 2, "a.dcm")


def test_fragments_without_an_end_are_refused():
    pixels = run_lengths(FRAMES)
    parts, end = fragments_of(pixels, 0, "a.dcm")
    assert (len(parts), end) == (4, len(pixels))
    for cut in range(0, len(pixels) - 8, 5):
        with pytest.raises(MeshdepictError, match=r"a\.dcm: its compressed pixels don't end"):
            fragments_of(pixels[:cut], 0, "a.dcm")


@pytest.mark.parametrize(
    ("at", "number", "sentence"),
    [(5, b"\xff\xff", "another size"), (7, b"\0\1", "another size"), (9, b"\3", "another size"),
     (4, b"\x40", "more bits")],
)  # fmt: skip
def test_what_jpeg_claims_never_reaches_gdcm(tmp_path, monkeypatch, at, number, sentence):
    values = np.random.default_rng(2).integers(0, 4000, (3, 64, 48)).astype(np.uint16)
    path = tmp_path / "j.dcm"
    writer = sitk.ImageFileWriter()
    writer.UseCompressionOn()
    writer.SetCompressor("JPEG")
    writer.SetFileName(str(path))
    writer.Execute(sitk.GetImageFromArray(values))
    np.testing.assert_array_equal(read_volume(path).values, values)
    data = bytearray(path.read_bytes())
    marker = data.find(b"\xff\xc3", data.find(b"\xff\xd8"))
    assert marker > 0
    data[marker + at : marker + at + len(number)] = number
    path.write_bytes(data)
    monkeypatch.setattr(sitk, "ReadImage", None)
    with pytest.raises(MeshdepictError, match=f"its JPEG part says {sentence}"):
        read_volume(path)


@pytest.mark.parametrize("marker", [0xC0, 0xC1, 0xC3, 0xCF, 0xF7])
def test_jpeg_of_all_kinds_says_its_size_behind_other_parts(marker):
    def jpeg(rows, columns, parts, bits):
        frame = struct.pack(">BBHBHHB", 0xFF, marker, 11, bits, rows, columns, parts) + bytes(3)
        return b"\xff\xd8\xff\xe0\x00\x04ab\xff\xc4\x00\x03a" + frame

    check_jpeg([jpeg(64, 48, 1, 12), b"", b"no picture", b"\xff\xd8"], 64, 48, 16, "a.dcm")
    for wrong in ((65, 48, 1, 12), (64, 49, 1, 12), (64, 48, 3, 8), (64, 48, 1, 17)):
        with pytest.raises(MeshdepictError, match=r"a\.dcm: its JPEG part says"):
            check_jpeg([jpeg(64, 48, 1, 12), jpeg(*wrong)], 64, 48, 16, "a.dcm")


def test_jpeg_2000_says_its_size_too():
    def codestream(*numbers, depth=11, steps=(1, 1)):
        siz = struct.pack(">HH8IH", 41, 0, *numbers)
        return b"\xff\x4f\xff\x51" + siz + bytes([depth, *steps]) + bytes(9)

    check_jpeg([codestream(48, 64, 0, 0, 48, 64, 0, 0, 1)], 64, 48, 16, "a.dcm")
    check_jpeg([codestream(48, 64, 0, 0, 32, 32, 0, 0, 1)], 64, 48, 16, "a.dcm")
    for wrong in (
        codestream(49, 64, 0, 0, 48, 64, 0, 0, 1),
        codestream(48, 65, 0, 0, 48, 64, 0, 0, 1),
        codestream(48, 64, 1, 0, 48, 64, 0, 0, 1),
        codestream(48, 64, 0, 0, 0, 64, 0, 0, 1),
        codestream(48, 64, 0, 0, 48, 64, 7, 0, 1),
        codestream(48, 64, 0, 0, 48, 64, 0, 0, 3),
        codestream(48, 64, 0, 0, 48, 64, 0, 0, 1, depth=16),
        codestream(48, 64, 0, 0, 48, 64, 0, 0, 1, steps=(2, 1)),
    ):
        with pytest.raises(MeshdepictError, match=r"a\.dcm: its JPEG part says"):
            check_jpeg([wrong], 64, 48, 16, "a.dcm")
