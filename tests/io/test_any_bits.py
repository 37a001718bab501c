"""Numbers in files may be any bits: signalling NaN, infinities, fractions for indices."""

import struct

import numpy as np
import pytest
from dicom_files import write_dicom
from gltf_builder import FACES, POINTS, Builder
from volume_files import tiff, write_metaimage, write_nrrd

import meshdepict as md
from meshdepict.io import read_mesh
from meshdepict.io.volumes import read_volume

# NumPy warns wherever such a NaN is converted or computed with; warnings are errors here.
SIGNALLING = {"f4": np.array([0x7F800001], np.uint32).view("f4"),
              "f8": np.array([0x7FF0000000000001], np.uint64).view("f8")}  # fmt: skip


def signalling(values, at, kind):
    """Values of which one is a signalling NaN: its bits are put there, as converting quiets it."""
    found = np.array(values, kind)
    bits = {"f4": np.uint32, "f8": np.uint64}[kind]
    found.view(bits)[at] = SIGNALLING[kind].view(bits)[0]
    return found


def ply(points, faces, *, extra=b"", kind="float"):
    """A binary PLY of these vertices' bytes, triangles, and properties behind each vertex."""
    rows = [point.tobytes() + extra for point in points]
    more = "property float quality\nproperty float red\nproperty float green\nproperty float blue\n"
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
        + "".join(f"property {kind} {axis}\n" for axis in "xyz")
        + more * bool(extra)
        + f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    lists = [struct.pack("<B3i", 3, *face) for face in faces]
    return head.encode() + b"".join(rows) + b"".join(lists)


def checked(path):
    """A file's mesh, whose colours are finite, and which every format can be written from."""
    mesh = read_mesh(path)
    own = "keep" if "red" in mesh.attributes["vertex"] else "none"
    baked = md.bake(mesh, "exaggerated", scales=1, albedo=own)
    assert np.isfinite(baked.intensity).all()
    for suffix in (".ply", ".vtp", ".glb", ".off"):
        baked.save(path.with_name(f"baked{suffix}"))
    return mesh


@pytest.mark.parametrize("kind", ["f4", "f8"])
@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_a_signalling_nan_in_a_vertex_is_said_or_left_out(tmp_path, kind):
    path = tmp_path / "a.ply"
    name = {"f4": "float", "f8": "double"}[kind]
    path.write_bytes(ply(signalling(POINTS, (1, 2), kind), FACES, kind=name))
    with pytest.raises(md.MeshdepictError, match="NaN or infinite"):
        read_mesh(path)
    unused = np.concatenate((POINTS, [[0, 0, 0]]))
    path.write_bytes(ply(signalling(unused, (4, 0), kind), FACES, kind=name))
    assert len(checked(path).vertices) == 5


@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_signalling_nan_in_other_properties_darken_nothing(tmp_path):
    path = tmp_path / "a.ply"
    bits = SIGNALLING["f4"].tobytes()
    path.write_bytes(ply(POINTS.astype("f4"), FACES, extra=bits + bits + struct.pack("<2f", 1, 1)))
    mesh = checked(path)
    assert np.isnan(mesh.attributes["vertex"]["quality"]).all()


def test_signalling_nan_in_other_formats_are_said(tmp_path):
    points = signalling(POINTS, (2, 1), "f4")
    corners = points.view(np.uint32)[FACES].view("f4")  # as integers: copying floats may quiet
    rows = b"".join(bytes(12) + triangle.tobytes() + bytes(2) for triangle in corners)
    (tmp_path / "a.stl").write_bytes(bytes(80) + struct.pack("<I", len(FACES)) + rows)
    body = struct.pack("<3i", len(points), len(FACES), 0) + points.tobytes()
    body += b"".join(struct.pack("<4i", 3, *face) for face in FACES)
    (tmp_path / "a.off").write_bytes(b"OFF BINARY\n" + body)
    build = Builder()
    build.header["nodes"] = [{"mesh": build.mesh(build.tetrahedron())}]
    chunk = bytearray(build.chunk)
    at = chunk.find(POINTS.astype("<f4").tobytes())
    chunk[at : at + points.nbytes] = points.tobytes()
    build.chunk = bytes(chunk)
    (tmp_path / "a.glb").write_bytes(build.glb())
    for name in ("a.stl", "a.off", "a.glb"):
        with pytest.raises(md.MeshdepictError, match="NaN or infinite"):
            read_mesh(tmp_path / name)


@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_a_signalling_nan_among_voxels_is_said_with_its_place(tmp_path, kind):
    values = signalling(np.arange(210.0).reshape(7, 6, 5), (3, 2, 1), kind)
    data, word = values.tobytes(), {"f4": "float", "f8": "double"}[kind]
    write_nrrd(tmp_path / "a.nrrd", data, type=word)
    write_metaimage(tmp_path / "a.mha", data, ElementType=f"MET_{word.upper()}")
    np.save(tmp_path / "a.npy", values)
    names = ["a.nrrd", "a.mha", "a.npy"]
    if kind == "f4":
        (tmp_path / "a.tif").write_bytes(tiff(values))
        names.append("a.tif")
    for name in names:
        with pytest.raises(md.MeshdepictError, match="NaN"):
            read_volume(tmp_path / name, spacing=(1, 1, 1) if name in ("a.npy", "a.tif") else None)


@pytest.mark.parametrize("row", ["tristrips 1", "face 1", "range_grid 4"])
@pytest.mark.parametrize("value", [1.5, np.nan, np.inf, 1e30])
def test_fractions_are_no_indices_in_ply(tmp_path, row, value):
    name, count = row.split()
    indices = [(4, 0, 1, 2, value)] if count == "1" else [(1, value)] * 4
    head = (
        "ply\nformat binary_little_endian 1.0\nobj_info num_cols 2\nobj_info num_rows 2\n"
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        f"element {row}\nproperty list uchar float vertex_indices\nend_header\n"
    )
    lists = b"".join(struct.pack(f"<B{size}f", size, *rest) for size, *rest in indices)
    path = tmp_path / f"{name}.ply"
    path.write_bytes(head.encode() + POINTS.astype("<f4").tobytes() + lists)
    with pytest.raises(md.MeshdepictError, match="whole numbers"):
        read_mesh(path)


@pytest.mark.parametrize("value", ["1e30", "inf", "nan", "0.5"])
def test_fractions_are_no_indices_in_off(tmp_path, value):
    path = tmp_path / "a.off"
    rows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    path.write_text(f"OFF\n4 2 0\n{rows}3 0 1 2\n3 0 1 {value}\n", encoding="ascii")
    with pytest.raises(md.MeshdepictError, match="doesn't fit OFF"):
        read_mesh(path)


@pytest.mark.parametrize("what", ["indices", "JOINTS_0"])
def test_floats_are_no_indices_in_gltf(tmp_path, what):
    build = Builder()
    primitive = build.tetrahedron()
    node = {"mesh": build.mesh(primitive)}
    build.header["nodes"] = [node]
    if what == "indices":
        primitive["indices"] = build.accessor(FACES.reshape(-1), "f4")
    else:
        used = primitive["attributes"]
        used["JOINTS_0"] = build.accessor(np.zeros((4, 4)), "f4")
        used["WEIGHTS_0"] = build.accessor(np.full((4, 4), 0.25), "f4")
        node["skin"] = 0
        build.header["skins"] = [{"joints": [0]}]
    (tmp_path / "a.glb").write_bytes(build.glb())
    with pytest.raises(md.MeshdepictError, match="floats as indices"):
        read_mesh(tmp_path / "a.glb")


def test_a_size_that_is_no_whole_number_is_none_in_tiff(tmp_path):
    data = bytearray(tiff(np.zeros((2, 4, 5), np.uint8)))
    at = data.find(struct.pack("<HH", 256, 4))  # the width, of 32 bits
    assert at > 0
    for number in (np.nan, np.inf, 5.0):
        data[at : at + 12] = struct.pack("<HHIf", 256, 11, 1, number)
        (tmp_path / "a.tif").write_bytes(data)
        with pytest.raises(md.MeshdepictError, match="no page with pixels"):
            read_volume(tmp_path / "a.tif")


@pytest.mark.parametrize(
    ("tag", "kind", "sentence"),
    [(256, 4, "no page with pixels"), (257, 4, "no page with pixels"), (273, 4, "where its pixels"),
     (258, 3, "has 1 bits in a pixel"), (259, 3, ""), (262, 3, ""), (277, 3, ""), (279, 4, "")],
)  # fmt: skip
def test_an_entry_of_nothing_is_none_in_tiff(tmp_path, tag, kind, sentence):
    pages = np.arange(120, dtype=np.uint8).reshape(1, 24, 5)
    data = bytearray(tiff(pages, first={270: (2, b"ImageJ=1.5\nimages=6\nslices=6\n")}))
    rows = data.find(struct.pack("<HHI", 257, 4, 1))
    data[rows + 8 : rows + 12] = struct.pack("<I", 4)  # six slices behind each other
    path = tmp_path / "a.tif"
    path.write_bytes(data)
    wanted = read_volume(path, spacing=(1, 1, 1)).values
    np.testing.assert_array_equal(wanted, pages.reshape(6, 4, 5))
    entry = data.find(struct.pack("<HHI", tag, kind, 1))
    assert entry > 0
    data[entry + 4 : entry + 8] = bytes(4)
    path.write_bytes(data)
    if sentence:
        with pytest.raises(md.MeshdepictError, match=sentence):
            read_volume(path, spacing=(1, 1, 1))
    else:
        np.testing.assert_array_equal(read_volume(path, spacing=(1, 1, 1)).values, wanted)


def test_impossible_bits_are_said_of_compressed_pixels_too(tmp_path):
    pixels = np.zeros((2, 4, 5), np.uint16)
    for used in (0, 17, 65535):
        tags = {"syntax": "1.2.840.10008.1.2.5", "pixels": b"\xfe\xff\xdd\xe0\0\0\0\0"}
        path = write_dicom(tmp_path / "a.dcm", pixels, bits_stored=None, **tags)
        data = path.read_bytes()
        said = struct.pack("<HH2sHH", 0x28, 0x101, b"US", 2, 16)
        assert said in data
        path.write_bytes(data.replace(said, said[:-2] + struct.pack("<H", used)))
        with pytest.raises(md.MeshdepictError, match="that can't be"):
            read_volume(path)


@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_signalling_nan_in_pictures_are_nothing_there(tmp_path, kind):
    normals = np.zeros((4, 5, 3))
    normals[..., 2] = 1
    np.save(tmp_path / "normals.npy", signalling(normals, (1, 2, 0), kind))
    found = md.GBuffer.from_images(tmp_path / "normals.npy")
    assert np.isfinite(md.bake(found, "lambert").intensity).all()


def test_quiet_numbers_are_the_same_numbers():
    from meshdepict.files.any_numbers import quiet

    usual = np.array([1.5, -0.0, np.inf])
    assert quiet(usual) is usual
    found = quiet(signalling([0.1, -0.0, 3e-310, np.inf], 3, "f8"))
    np.testing.assert_array_equal(found, [0.1, -0.0, 3e-310, np.nan])
    assert np.signbit(found[1])
    assert np.isnan(found * 2).any()  # without a warning
