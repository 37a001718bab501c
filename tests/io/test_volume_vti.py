"""VTI in every way that VTK writes it; extents, counts and places that a file can't hold."""

import re

import numpy as np
import pytest
from marked_volumes import DIRECTIONS, assert_same, marked, placed

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.volumes import read_volume, write_volume
from meshdepict.shapes.volume import Volume

VOLUME = placed(DIRECTIONS["oblique"], hounsfield=True, length_unit="mm")

WAYS = {
    f"{name} {compressor} {header}": (mode, in_base64, compressor, header)
    for name, mode, in_base64 in (
        ("ascii", 0, 0), ("binary", 1, 0), ("appended", 2, 0), ("appended base64", 2, 1),
    )
    for compressor in ("None", "ZLib", "LZ4", "LZMA")
    for header in ("UInt32", "UInt64")
}  # fmt: skip


def written(path, volume, mode=0, in_base64=0, compressor="None", header="UInt64", block=64):
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    writer = vtkXMLImageDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(volume.to_pyvista() if isinstance(volume, Volume) else volume)
    writer.SetDataMode(mode)
    writer.SetEncodeAppendedData(in_base64)
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    writer.SetBlockSize(block)
    getattr(writer, f"SetHeaderTypeTo{header}")()
    writer.Write()
    return path


@pytest.mark.parametrize(("mode", "in_base64", "compressor", "header"), WAYS.values(), ids=WAYS)
def test_all_encodings_are_read(tmp_path, mode, in_base64, compressor, header):
    values = np.tile(marked(), (2, 1, 1))  # runs that overlap themselves when packed
    values[3:9, 2:] = 7
    volume = Volume(values, spacing=(0.5, 0.75, 2.5), hounsfield=True, length_unit="mm")
    path = written(tmp_path / "a.vti", volume, mode, in_base64, compressor, header)
    found = read_volume(path)
    np.testing.assert_array_equal(found.values, values)
    assert (found.unit, found.length_unit) == ("HU", "mm")
    np.testing.assert_array_equal(found.spacing, volume.spacing)


@pytest.mark.parametrize("at_cells", [False, True])
def test_extents_and_cells_are_placed_as_pyvista_places_them(tmp_path, at_cells):
    import pyvista as pv

    image = pv.ImageData(dimensions=(4, 5, 6), spacing=(1, 2, 3), origin=(10, 20, 30))
    image.extent = (2, 5, -1, 3, 7, 12)
    data = image.cell_data if at_cells else image.point_data
    data["found"] = np.arange(image.n_cells if at_cells else image.n_points) ** 2
    image.save(tmp_path / "a.vti")
    found, wanted = read_volume(tmp_path / "a.vti"), Volume.from_pyvista(image)
    np.testing.assert_array_equal(found.values, wanted.values)
    np.testing.assert_allclose(found.origin, wanted.origin)
    np.testing.assert_allclose(found.outline, wanted.outline)


def test_pieces_make_a_whole(tmp_path):
    head = '<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">'
    array = '<PointData Scalars="v"><DataArray type="Int16" Name="v" format="ascii">{}</DataArray>'
    pieces = [
        (f'<Piece Extent="{a} {b} 0 2 0 1">' + array + "</PointData></Piece>", a, b)
        for a, b in ((0, 1), (2, 3))
    ]
    values = np.arange(24).reshape(2, 3, 4)
    parts = [
        text.format(" ".join(map(str, values[:, :, a : b + 1].ravel()))) for text, a, b in pieces
    ]
    whole = '<ImageData WholeExtent="0 3 0 2 0 1" Origin="0 0 0" Spacing="1 1 1">{}</ImageData>'
    for used, sentence in ((parts, None), (parts[:1], "its pieces don't fill the whole")):
        (tmp_path / "a.vti").write_text(head + whole.format("".join(used)) + "</VTKFile>")
        if sentence is None:
            np.testing.assert_array_equal(read_volume(tmp_path / "a.vti").values, values)
        else:
            with pytest.raises(MeshdepictError, match=sentence):
                read_volume(tmp_path / "a.vti")
    outside = parts[0].replace("0 1 0 2", "0 9 0 2")
    (tmp_path / "a.vti").write_text(head + whole.format(outside) + "</VTKFile>")
    with pytest.raises(MeshdepictError, match="a piece lies outside of the whole"):
        read_volume(tmp_path / "a.vti")


def spoiled(path, pattern, replacement):
    text = path.read_text()
    path.write_text(re.sub(pattern, replacement, text, count=1))
    return path


ARRAY = r"<DataArray[^>]*Name=.values.[^>]*"


@pytest.mark.parametrize(
    ("pattern", "replacement", "sentence"),
    [
        (r'WholeExtent="[^"]*"', 'WholeExtent="0 99999 0 99999 0 99999"', "don't fill|claims more"),
        (r'Extent="0 4 [^"]*"', 'Extent="0 2147483647 0 5 0 6"', "outside of the whole|claims"),
        (r'Extent="[^"]*"', 'Extent="0 4 0 5"', "is not six whole numbers"),
        (r'Extent="[^"]*"', 'Extent="0 4 0 5 0 9999999999999"', "is not six whole numbers"),
        (r'Extent="[^"]*"', 'Extent="0 4 0 -5 0 6"', "is empty: it has no voxels"),
        (r'Spacing="[^"]*"', 'Spacing="1 1"', "its Spacing is not 3 numbers"),
        (r'Spacing="[^"]*"', 'Spacing="1 x 1"', "its Spacing is not 3 numbers"),
        (r'Spacing="[^"]*"', 'Spacing="1 inf 1"', "is not three finite numbers"),
        (r'Spacing="[^"]*"', 'Spacing="1 0 1"', "is not positive"),
        (r'Origin="[^"]*"', 'Origin="nan 0 0"', "is not three finite numbers"),
        (r'Direction="[^"]*"', 'Direction="1 0 0 1 0 0 0 0 1"', "resample a skewed grid first"),
        (r'type="Int16"', 'type="Int17"', "an array of the unknown type 'Int17'"),
        (r'type="Int16"', 'type="Int16" NumberOfComponents="3"', "has 3 values in a voxel"),
        (r'type="Int16"', 'type="Int16" NumberOfComponents="x"', "has 'x' components"),
        (r'(Int16.*?)format="ascii"', r'\1format="other"', "in the unknown format 'other'"),
        (r'(Int16.*?)format="ascii"', r'\1format="appended" offset="7"', "lies beyond its end"),
        (r'(Int16.*?)format="ascii"', r'\1format="binary"', "is cut off or wrong"),
        (r'(Int16[^>]*>\s*)\d+', r"\g<1>9999999", "is cut off or wrong"),
        (r'(Int16[^>]*>\s*)\d+', r"\1", "'values' claims more values than it holds"),
        (r'(Int16[^>]*>\s*)\d+', r"\g<1>1 2", "holds more values than its header claims"),
        (r'type="ImageData"', 'type="PolyData"', "holds PolyData, not image data of a regular"),
        (r"<Piece", "<Peace", "is cut off or wrong"),
        (r"<PointData", "<PointDatum", "is cut off or wrong"),
        (r"<VTKFile", "<VTKFyle", "not VTK's: it begins with <VTKFyle>"),
        (r"<VTKFile", "<!DOCTYPE a [<!ENTITY b 'c'>]><VTKFile", "a document type or entities"),
        (r"<ImageData", "<a>" * 60 + "<ImageData", "nested more than 20 levels deep"),
        (r"<ImageData", "<a/>" * 300_000 + "<ImageData", "its elements are too many"),
        (r"\A(<\?xml[^>]*>)?", '<?xml version="1.0" encoding="klingon"?>', "is cut off or wrong"),
    ],
)  # fmt: skip
def test_what_a_file_can_not_hold_is_refused(tmp_path, pattern, replacement, sentence):
    path = written(tmp_path / "a.vti", VOLUME)
    assert_same(read_volume(path), VOLUME, 1e-12)
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(spoiled(path, pattern, replacement))


def test_compressed_blocks_that_claim_too_much_are_refused(tmp_path):
    import base64
    import struct

    path = written(tmp_path / "a.vti", VOLUME, mode=1, compressor="ZLib", header="UInt32")
    text = path.read_text()
    found = re.search(r'(Name="values"[^>]*>\s*)([A-Za-z0-9+/=]+)', text)
    for words, sentence in (
        ((1 << 31, 1 << 20, 0), "claims more blocks than it holds"),
        ((1000, 1 << 30, 0), "claims more values"),
        ((2, 0, 0), "claims more blocks than it holds"),
        ((1, 64, 0, 1 << 30), "end too early"),
        ((0, 0, 0), "claims more values than it holds"),
        ((1, 64, 0, 10), "is damaged: unpacking its array 'values' failed"),
    ):
        head = base64.b64encode(struct.pack(f"<{len(words)}I", *words)).decode()
        stop = found.end()
        path.write_text(text[: found.start(2)] + head + "AAAA" * 1200 + text[stop:])
        with pytest.raises(MeshdepictError, match=sentence):
            read_volume(path)


@pytest.mark.parametrize("compressor", ["LZ4", "LZMA", "ZLib"])
def test_damaged_blocks_are_refused(tmp_path, compressor):
    path = written(tmp_path / "a.vti", VOLUME, mode=2, compressor=compressor)
    good = path.read_bytes()
    start, refused = good.index(b"_") + 1, 0
    for at in range(start + 60, len(good) - 60, 7):
        path.write_bytes(good[:at] + bytes(4) + good[at + 4 :])
        try:
            read_volume(path)
        except (MeshdepictError, MeshdepictWarning):
            refused += 1
    assert refused > 5


def test_an_unknown_compressor_is_named(tmp_path):
    path = written(tmp_path / "a.vti", VOLUME, mode=1, compressor="ZLib")
    spoiled(path, "vtkZLibDataCompressor", "vtkZstdDataCompressor")
    with pytest.raises(MeshdepictError, match="by 'vtkZstdDataCompressor', which is not"):
        read_volume(path)


def test_several_arrays_need_a_mark(tmp_path):
    path = written(tmp_path / "a.vti", VOLUME)
    text = path.read_text()
    array = re.search(r"<DataArray.*?</DataArray>", text[text.index("<PointData") :], re.DOTALL)[0]
    other = array.replace('"values"', '"other"')
    path.write_text(
        re.sub(r' Scalars="values"', "", text).replace(array, array + other)
    )  # fmt: skip
    with pytest.raises(
        MeshdepictError, match=r"several arrays \(values, other\) and none is marke"
    ):
        read_volume(path)
    path.write_text(text.replace(array, array + other))
    np.testing.assert_array_equal(read_volume(path).values, VOLUME.values)


def test_appended_data_without_an_end_are_refused(tmp_path):
    path = written(tmp_path / "a.vti", VOLUME, mode=2)
    path.write_bytes(path.read_bytes().replace(b"</AppendedData>", b"</Appended>"))
    with pytest.raises(MeshdepictError, match="its appended data don't end"):
        read_volume(path)


def test_what_this_program_writes_is_read_back_by_it_and_by_pyvista(tmp_path):
    import pyvista as pv

    write_volume(tmp_path / "a.vti", VOLUME.values, VOLUME)
    assert_same(read_volume(tmp_path / "a.vti"), VOLUME, 1e-12)
    image = pv.read(tmp_path / "a.vti")
    assert_same(Volume.from_pyvista(image), VOLUME, 1e-12)


def test_other_data_of_pyvistas_say_which_call_makes_a_volume_of_them():
    import pyvista as pv

    from meshdepict.baking.look import bake_volume

    image = VOLUME.to_pyvista()
    image.direction_matrix = np.eye(3)
    for data, sentence in (
        (image.cast_to_unstructured_grid(), r"UnstructuredGrid.*: resample it, pyvista\.ImageData"),
        (
            image.cast_to_rectilinear_grid(),
            r"RectilinearGrid, .*\.sample\(data\), or bake its surf",
        ),
        (image.cast_to_structured_grid(), r"StructuredGrid, .*resample it"),
        (pv.MultiBlock([image]), r"MultiBlock, .*Volume\.from_pyvista\(blocks\[0\]\)"),
        (pv.Sphere(), r"PolyData, .*it is a surface, for Mesh\.from_pyvista\(data\)"),
    ):
        with pytest.raises(MeshdepictError, match=f"holds {sentence}"):
            Volume.from_pyvista(data)
        with pytest.raises(MeshdepictError, match=f"holds {sentence}"):
            bake_volume(data, "lambert")
    with pytest.raises(MeshdepictError, match="holds int, not image data"):
        Volume.from_pyvista(3)


def test_the_call_that_the_sentence_names_makes_a_volume():
    import pyvista as pv

    image = VOLUME.to_pyvista()
    image.direction_matrix = np.eye(3)
    grid = image.cast_to_unstructured_grid()
    frame = pv.ImageData(
        dimensions=image.dimensions, spacing=image.spacing, origin=image.origin
    )  # fmt: skip
    sampled = frame.sample(grid)
    sampled.set_active_scalars("values")
    np.testing.assert_allclose(Volume.from_pyvista(sampled).values, VOLUME.values)


def test_images_of_vtks_own_are_taken():
    from vtkmodules.vtkCommonDataModel import vtkImageData

    image = vtkImageData()
    image.ShallowCopy(VOLUME.to_pyvista())
    assert_same(Volume.from_pyvista(image), VOLUME, 1e-12)
