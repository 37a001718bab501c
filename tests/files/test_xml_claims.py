"""VTK's XML: every claim is compared with what the file holds, before VTK believes it and dies."""

from __future__ import annotations

import base64
import re
import struct
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.files.vtk_xml import parsed
from meshdepict.files.xml_claims import check_xml
from meshdepict.io import read_mesh

MODES = ["ascii", "binary", "appended", "raw"]
COMPRESSORS = [None, "ZLib", "LZ4", "LZMA"]


def written(mode: str, compressor: str | None, *, header: int = 32, size: int = 300) -> bytes:
    """A sphere as VTK itself writes it."""
    import pyvista as pv
    from vtkmodules import vtkIOCore
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    ball = pv.Sphere(theta_resolution=12, phi_resolution=size // 12 + 2)
    ball.field_data["words"] = ["one", "two"]
    ball.cell_data["number"] = np.arange(ball.n_cells, dtype=np.uint8)
    writer: Any = vtkXMLPolyDataWriter()
    writer.SetInputData(ball)
    writer.SetWriteToOutputString(True)
    how = {"ascii": "Ascii", "binary": "Binary"}.get(mode, "Appended")
    getattr(writer, f"SetDataModeTo{how}")()
    writer.SetEncodeAppendedData(mode != "raw")
    writer.SetHeaderType(header)
    writer.SetBlockSize(1 << 12)  # several blocks
    writer.SetCompressor(
        getattr(vtkIOCore, f"vtk{compressor}DataCompressor")() if compressor else None
    )
    writer.Write()
    content = writer.GetOutputString()
    return content if isinstance(content, bytes) else content.encode()


@pytest.mark.parametrize("header", [32, 64])
@pytest.mark.parametrize("compressor", COMPRESSORS)
@pytest.mark.parametrize("mode", ["ascii", "binary", "appended"])
def test_honest_files_pass_and_are_read(tmp_path: Path, mode, compressor, header):
    data = written(mode, compressor, header=header)
    file = check_xml(data)
    assert (file.kind, len(file.pieces)) == ("PolyData", 1)
    path = tmp_path / "ball.vtp"
    path.write_bytes(data)
    assert len(read_mesh(path).vertices) == int(file.pieces[0]["NumberOfPoints"])


def piece(attributes: str, arrays: str, *, root: str = "", appended: bytes = b"") -> bytes:
    return (
        f'<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" {root}>'
        f"<PolyData><Piece {attributes}>{arrays}</Piece></PolyData>"
    ).encode() + appended + b"</VTKFile>"  # fmt: skip


POINTS = (
    '<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">'
    "0 0 0 1 0 0 0 1 0</DataArray></Points>"
)
POLYS = (
    '<Polys><DataArray type="Int64" Name="connectivity" format="ascii">{}</DataArray>'
    '<DataArray type="Int64" Name="offsets" format="ascii">{}</DataArray></Polys>'
)
GOOD = POINTS + POLYS.format("0 1 2", "3")
COUNTS = 'NumberOfPoints="3" NumberOfPolys="1"'


def coded(*numbers: int, data: bytes = b"") -> str:
    """Base64 as VTK has it: the lengths by themselves."""
    front = struct.pack(f"<{len(numbers)}I", *numbers)
    return base64.b64encode(front).decode() + base64.b64encode(data).decode()


def binary(letters: str) -> str:
    return (
        '<Points><DataArray type="Float32" NumberOfComponents="3" format="binary">'
        f"{letters}</DataArray></Points>"
    )


ZLIB = 'compressor="vtkZLibDataCompressor"'
FIELD = '<FieldData><DataArray type="{}" Name="a" NumberOfTuples="{}" format="ascii"/></FieldData>'
HOSTILE = {
    "points": (piece('NumberOfPoints="1000000000000"', GOOD), "claims more values than it holds"),
    "polys": (
        piece('NumberOfPoints="3" NumberOfPolys="1000000000000"', GOOD),
        "'offsets' claims more values",
    ),
    "offsets": (
        piece(COUNTS, POINTS + POLYS.format("0 1 2", "100000000000000")),
        "offsets of its Polys don't fit",
    ),
    "falling offsets": (
        piece('NumberOfPoints="3" NumberOfPolys="2"', POINTS + POLYS.format("0 1 2", "3 -3")),
        "offsets of its Polys don't fit",
    ),
    "words for offsets": (
        piece(COUNTS, POINTS + POLYS.format("0 1 2", "three")), "something else than numbers"
    ),
    "beyond": (
        piece(
            COUNTS,
            '<Points><DataArray type="Float32" NumberOfComponents="3" format="appended" '
            'offset="123456789012"/></Points>',
            appended=b'<AppendedData encoding="raw">_1234</AppendedData>',
        ),
        "lies beyond its end",
    ),
    "no appended data": (
        piece(COUNTS, '<Points><DataArray type="Float32" offset="0"/></Points>'), "beyond its end"
    ),
    "length": (
        piece(COUNTS, binary(coded(4_000_000_000, data=b"\0" * 36))), "end too early"
    ),
    "short": (piece(COUNTS, binary("AAA")), "end too early"),
    "blocks": (piece(COUNTS, binary(coded(4_000_000_000)), root=ZLIB), "claims more blocks"),
    "packed": (
        piece(COUNTS, binary(coded(1, 36, 0, 4_000_000_000)), root=ZLIB), "end too early"
    ),
    "bomb": (
        piece(COUNTS, binary(coded(1, 4_000_000_000, 36, 8, data=b"12345678")), root=ZLIB),
        "claims more values than the",
    ),
    "damaged": (
        piece(
            COUNTS,
            POINTS + POLYS.format("0 1 2", coded(1, 8, 0, 8, data=b"12345678")).replace(
                'Name="offsets" format="ascii"', 'Name="offsets" format="binary"'
            ),
            root=ZLIB,
        ),
        "unpacking its array 'offsets' failed",
    ),
    "components": (
        piece(COUNTS, GOOD.replace('Components="3"', 'Components="999999999999"')),
        "impossible components",
    ),
    "tuples": (piece(COUNTS, GOOD + FIELD.format("Int8", 10**15)), None),  # of a piece: ignored
    "words": (piece('NumberOfPoints="1e12"', GOOD), "NumberOfPoints='1e12' is not a whole number"),
    "negative": (piece('NumberOfPoints="-1"', GOOD), "NumberOfPoints=-1"),
    "type": (piece(COUNTS, GOOD.replace("Float32", "Float31")), "unknown type 'Float31'"),
    "compressor": (piece(COUNTS, GOOD, root='compressor="mine"'), "compressed by 'mine'"),
    "entities": (
        b'<!DOCTYPE VTKFile [<!ENTITY a "aaaa">]>' + piece(COUNTS, GOOD), "document type or entit"
    ),
    "deep": (piece(COUNTS, "<a>" * 100_000 + "</a>" * 100_000), "nested more than 20 levels"),
    "html": (b"<html></html>", "XML, but not VTK's: it begins with <html>"),
    "no xml": (piece(COUNTS, "<a></b>"), "Error parsing its XML in line 1"),
    "hidden": (
        piece(COUNTS, "<!-- <AppendedData> -->" + GOOD), "<AppendedData where no element can be"
    ),
    "open tag": (piece(COUNTS, GOOD)[:-10] + b"<AppendedData", "<AppendedData is not complete"),
    "no mark": (
        piece(COUNTS, GOOD, appended=b"<AppendedData>1234</AppendedData>"), "don't begin with '_'"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_what_a_file_does_not_hold_never_reaches_vtk(tmp_path, monkeypatch, name):
    data, sentence = HOSTILE[name]
    if sentence is None:
        check_xml(data)
        return
    with pytest.raises(MeshdepictError, match=sentence) as caught:
        check_xml(data)
    assert not re.search(r"\d{9}", str(caught.value))  # an absurd number isn't repeated


def test_field_data_of_the_whole_are_counted_too():
    data = piece(COUNTS, GOOD)
    for kind in ("Int8", "Float64", "String", "Bit"):
        field = FIELD.format(kind, 10**15).encode()
        with pytest.raises(MeshdepictError, match="array 'a' claims more values"):
            check_xml(data.replace(b"<PolyData>", b"<PolyData>" + field))


def image(whole: str, extent: str, values: str) -> bytes:
    return (
        f'<VTKFile type="ImageData"><ImageData WholeExtent="{whole}"><Piece Extent="{extent}">'
        f'<PointData><DataArray type="Int16" Name="v" format="ascii">{values}</DataArray>'
        "</PointData></Piece></ImageData></VTKFile>"
    ).encode()


def test_extents_of_images_are_claims_too(data):
    assert check_xml(image("0 1 0 1 0 1", "0 1 0 1 0 1", "1 2 3 4 5 6 7 8")).kind == "ImageData"
    for whole, extent, sentence in (
        ("0 9999 0 9999 0 9999", "0 9999 0 9999 0 9999", "'v' claims more values than it holds"),
        ("0 9999 0 9999 0 9999", "0 1 0 1 0 1", "a larger extent than its pieces have"),
        ("0 1 0 1", "0 1 0 1 0 1", "WholeExtent='0 1 0 1' is not 6 whole numbers"),
        ("0 1 0 1 0 1", "0 1 0 1 0 x", "Extent=.* is not 6 whole numbers"),
    ):
        with pytest.raises(MeshdepictError, match=sentence):
            check_xml(image(whole, extent, "1 2 3 4 5 6 7 8"))
    with pytest.raises(MeshdepictError, match="'values' claims more values than it holds"):
        check_xml((data / "cases" / "hostile" / "huge-extent.vti").read_bytes())


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("compressor", [None, "ZLib"])
def test_no_cut_and_no_changed_byte_ends_otherwise_than_in_a_sentence(mode, compressor):
    data = written(mode, compressor, size=40)
    rng = np.random.default_rng(0)
    start = time.process_time()
    for _ in range(150):
        spoiled = bytearray(data)
        for at in rng.integers(0, len(data), 3):
            spoiled[at] = rng.integers(0, 256)
        for content in (bytes(spoiled), data[: rng.integers(0, len(data))]):
            try:
                check_xml(content)
            except MeshdepictError:
                continue
    assert time.process_time() - start < 20


def test_a_parsed_file_tells_where_its_data_are():
    raw = written("raw", None)
    file = parsed(raw)
    assert file.raw
    assert raw[file.start - 1 : file.start] == b"_"
    assert {array.role for array in file.arrays} >= {"Points", "Polys", "PointData", "FieldData"}
