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
from meshdepict.io import read_mesh
from meshdepict.io.volumes import read_volume
from meshdepict.io.vtk_polydata import polydata
from meshdepict.io.vtk_xml import VtkXml, parse_vtk

MODES = ["ascii", "binary", "appended", "raw"]
COMPRESSORS = [None, "ZLib", "LZ4", "LZMA"]


def written(
    mode: str, compressor: str | None, *, header: int = 32, size: int = 300, poly: Any = None
) -> bytes:
    """A sphere, or polygon data given, as VTK itself writes it."""
    import pyvista as pv
    from vtkmodules import vtkIOCore
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    ball = pv.Sphere(theta_resolution=12, phi_resolution=size // 12 + 2)
    ball.field_data["words"] = ["one", "two"]
    ball.cell_data["number"] = np.arange(ball.n_cells, dtype=np.uint8)
    writer: Any = vtkXMLPolyDataWriter()
    writer.SetInputData(ball if poly is None else poly)
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


def read(data: bytes) -> VtkXml:
    """Decode all arrays of polygon data."""
    file = parse_vtk(data)
    polydata(file)
    return file


@pytest.mark.parametrize("header", [32, 64])
@pytest.mark.parametrize("compressor", COMPRESSORS)
@pytest.mark.parametrize("mode", MODES)
def test_honest_files_pass_and_are_read(tmp_path: Path, mode, compressor, header):
    data = written(mode, compressor, header=header)
    file = read(data)
    pieces = file.root.first("PolyData").all("Piece")
    assert (file.kind, len(pieces)) == ("PolyData", 1)
    path = tmp_path / "ball.vtp"
    path.write_bytes(data)
    assert len(read_mesh(path).vertices) == int(pieces[0].attributes["NumberOfPoints"])
    assert_as_vtk_reads(data)


def assert_as_vtk_reads(data: bytes) -> None:
    """VTK's own reader finds the same points, cells and arrays, in the same types."""
    import pyvista as pv
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader: Any = vtkXMLPolyDataReader()
    reader.SetReadFromInputString(True)
    reader.SetInputString(data)
    reader.Update()
    wanted, found = (
        pv.wrap(poly) for poly in (reader.GetOutput(), polydata(parse_vtk(data)))
    )  # fmt: skip
    for name in ("points", "verts", "lines", "faces", "strips"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name))
    assert found.points.dtype == wanted.points.dtype
    for name in ("GetPointData", "GetCellData", "GetFieldData"):
        ours, theirs = getattr(found, name)(), getattr(wanted, name)()
        assert ours.GetNumberOfArrays() == theirs.GetNumberOfArrays()
        for at in range(theirs.GetNumberOfArrays()):
            one, other = ours.GetAbstractArray(at), theirs.GetAbstractArray(at)
            same = {16: 8, 17: 9}  # "long long" and "long" both have 64 bits
            assert len({same.get(a.GetDataType(), a.GetDataType()) for a in (one, other)}) == 1
            assert one.GetName() == other.GetName()
            assert one.GetNumberOfComponents() == other.GetNumberOfComponents()
            for part in range(other.GetNumberOfComponents()):
                assert one.GetComponentName(part) == other.GetComponentName(part)
            assert one.GetNumberOfValues() == other.GetNumberOfValues()
            values = [[a.GetVariantValue(i).ToString() for i in range(a.GetNumberOfValues())]
                      for a in (one, other)]  # fmt: skip
            assert values[0] == values[1]
    for name in ("GetPointData", "GetCellData"):
        for kind in ("Scalars", "Vectors", "Normals", "TCoords"):
            ours, theirs = (
                getattr(getattr(poly, name)(), f"Get{kind}")() for poly in (found, wanted)
            )
            assert (ours and ours.GetName()) == (theirs and theirs.GetName())


@pytest.mark.parametrize("mode", MODES)
def test_everything_that_vtk_can_write_comes_back(mode):
    import pyvista as pv
    from vtkmodules.vtkCommonCore import vtkBitArray, vtkIdTypeArray

    poly = pv.PolyData()
    poly.points = np.random.default_rng(0).normal(size=(12, 3))
    poly.verts, poly.lines = [1, 11], [3, 0, 1, 2, 2, 3, 4]
    poly.faces = [3, 0, 1, 2, 4, 2, 1, 3, 4]
    poly.strips = [4, 4, 5, 6, 7, 5, 7, 8, 9, 10, 11]
    for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"):
        poly.point_data[kind] = np.arange(12).astype(kind)
        poly.cell_data[kind] = np.arange(14).reshape(7, 2).astype(kind)
    poly.point_data["note"] = [f"a point, {number}" for number in range(12)]
    poly.point_data["flow"] = np.arange(36.0).reshape(12, 3)
    poly.point_data.active_vectors_name = "flow"
    poly.point_data.active_normals = np.tile((0.0, 0.0, 1.0), (12, 1))
    poly.field_data["made by"] = ["someone", "", "else"]
    poly.point_data.GetArray("flow").SetComponentName(1, "up")
    for array in (vtkBitArray(), vtkIdTypeArray()):
        array.SetName(array.GetClassName())
        for number in range(12):
            array.InsertNextValue(number % 3 == 0)
        poly.GetPointData().AddArray(array)
    for compressor in COMPRESSORS:
        assert_as_vtk_reads(written(mode, compressor, poly=poly))


def test_pieces_are_joined_as_vtk_joins_them():
    one = (
        f'<Piece NumberOfPoints="3" NumberOfPolys="1">{GOOD}<CellData><DataArray type="Int8" '
        'Name="n" format="ascii">{}</DataArray></CellData></Piece>'
    )
    data = piece(COUNTS, "").replace(
        f"<Piece {COUNTS}></Piece>".encode(), (one.format(1) + one.format(2)).encode()
    )
    assert_as_vtk_reads(data)
    poly = polydata(parse_vtk(data))
    assert (poly.GetNumberOfPoints(), poly.GetNumberOfPolys()) == (6, 2)
    assert polydata(parse_vtk(data.replace(b"Piece", b"Peace"))).GetNumberOfPoints() == 0


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
def test_what_a_file_does_not_hold_never_reaches_vtk(name):
    data, sentence = HOSTILE[name]
    if sentence is None:
        read(data)
        return
    with pytest.raises(MeshdepictError, match=sentence) as caught:
        read(data)
    assert not re.search(r"\d{9}", str(caught.value))  # an absurd number isn't repeated


def test_field_data_of_the_whole_are_counted_too():
    data = piece(COUNTS, GOOD)
    for kind in ("Int8", "Float64", "String", "Bit"):
        field = FIELD.format(kind, 10**15).encode()
        with pytest.raises(MeshdepictError, match="array 'a' claims more values"):
            read(data.replace(b"<PolyData>", b"<PolyData>" + field))


def image(whole: str, extent: str, values: str) -> bytes:
    return (
        f'<VTKFile type="ImageData"><ImageData WholeExtent="{whole}"><Piece Extent="{extent}">'
        f'<PointData><DataArray type="Int16" Name="v" format="ascii">{values}</DataArray>'
        "</PointData></Piece></ImageData></VTKFile>"
    ).encode()


def test_extents_of_images_are_claims_too(data, tmp_path):
    path = tmp_path / "a.vti"
    path.write_bytes(image("0 1 0 1 0 1", "0 1 0 1 0 1", "1 2 3 4 5 6 7 8"))
    assert read_volume(path).range == (1, 8)
    for whole, extent, sentence in (
        ("0 9999 0 9999 0 9999", "0 9999 0 9999 0 9999", "'v' claims more values than it holds"),
        ("0 9999 0 9999 0 9999", "0 1 0 1 0 1", "claims more|pieces don't fill the whole"),
        ("0 1 0 1", "0 1 0 1 0 1", "WholeExtent is not six whole numbers"),
        ("0 1 0 1 0 1", "0 1 0 1 0 x", "Extent is not six whole numbers"),
    ):
        path.write_bytes(image(whole, extent, "1 2 3 4 5 6 7 8"))
        with pytest.raises(MeshdepictError, match=sentence):
            read_volume(path)
    with pytest.raises(MeshdepictError, match="'values' claims more values than it holds"):
        read_volume(data / "cases" / "hostile" / "huge-extent.vti")


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
                read(content)
            except MeshdepictError:
                continue
    assert time.process_time() - start < 20


def test_a_parsed_file_tells_where_its_data_are():
    raw = written("raw", None)
    coding = parse_vtk(raw).coding
    assert coding.raw
    start = raw.index(b"_", raw.index(b"<AppendedData")) + 1
    assert bytes(coding.appended) == raw[start : raw.rindex(b"</AppendedData>")]
