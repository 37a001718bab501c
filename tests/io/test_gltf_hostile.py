"""glTF that reaches beyond itself: into a disk, into memory, into depth. One sentence each."""

from __future__ import annotations

import json
import os
import struct
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_builder import KINDS, POINTS, Builder

from meshdepict.errors import MeshdepictError
from meshdepict.files import limits
from meshdepict.io import read_mesh, read_provenance

INSTANCING = "EXT_mesh_gpu_instancing"


@pytest.fixture
def build() -> Builder:
    """A scene with one tetrahedron."""
    built = Builder()
    built.mesh(built.tetrahedron())
    built.header["nodes"] = [{"mesh": 0}]
    return built


def refused(build: Builder, folder: Path, sentence: str) -> None:
    """Check that a file is refused, soon, in one line and without warnings."""
    start = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(MeshdepictError, match=sentence) as caught:
            build.read(folder)
    assert len(str(caught.value).splitlines()) == 1
    assert len(str(caught.value)) < 500
    assert time.perf_counter() - start < 10


# --- the disk -----------------------------------------------------------------------------------


def as_gltf(build: Builder, folder: Path, uri: str) -> Path:
    folder.mkdir(exist_ok=True)
    build.header["buffers"] = [{"uri": uri, "byteLength": len(build.chunk)}]
    (folder / "scene.gltf").write_text(json.dumps(build.header))
    return folder / "scene.gltf"


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("/etc/passwd", "an absolute path"), ("%2Fetc%2Fpasswd", "an absolute path"),
        ("../secret.bin", "leads out of its folder"), ("%2e%2e/secret.bin", "leads out"),
        ("file:///etc/passwd", "a URL"), ("https://example.org/a.bin", "a URL"),
        ("C:%5Csecret.bin", "an absolute path"), ("a%00.bin", "no file can be called"),
        ("", "no name"),
    ],
)  # fmt: skip
def test_a_buffer_elsewhere_is_not_read(tmp_path, build, uri, words):
    (tmp_path / "secret.bin").write_bytes(build.chunk)
    path = as_gltf(build, tmp_path / "home", uri)
    with pytest.raises(MeshdepictError, match=rf"scene\.gltf names the buffer .*{words}"):
        read_mesh(path)


@pytest.mark.skipif(os.name != "posix", reason="needs links and pipes")
def test_a_buffer_that_is_a_link_out_or_a_pipe_is_not_read(tmp_path, build):
    (tmp_path / "secret.bin").write_bytes(build.chunk)
    path = as_gltf(build, tmp_path / "home", "link.bin")
    (tmp_path / "home" / "link.bin").symlink_to("../secret.bin")
    with pytest.raises(MeshdepictError, match="a link out of its folder"):
        read_mesh(path)
    os.mkfifo(tmp_path / "home" / "pipe")
    path = as_gltf(build, tmp_path / "home", "pipe")
    with pytest.raises(MeshdepictError, match="names the buffer 'pipe', a named pipe"):
        read_mesh(path)


def test_a_buffer_in_a_folder_below_is_read(tmp_path, build):
    path = as_gltf(build, tmp_path / "home", "parts/my%20buffer.bin")
    (tmp_path / "home" / "parts").mkdir()
    (tmp_path / "home" / "parts" / "my buffer.bin").write_bytes(build.chunk)
    np.testing.assert_array_equal(read_mesh(path, winding="keep").vertices, POINTS)


# --- memory -------------------------------------------------------------------------------------


def test_more_instances_than_a_file_can_ask_for(tmp_path, build):
    zeros = {"componentType": KINDS["f4"], "type": "VEC3", "count": 10**9}
    build.header["accessors"].append(zeros)
    extension = {"attributes": {"TRANSLATION": len(build.header["accessors"]) - 1}}
    build.header["nodes"][0]["extensions"] = {INSTANCING: extension}
    refused(build, tmp_path, "claims more instances than the .* of memory .* --max-memory")
    zeros["count"] = 400_000  # allowed by itself, but not times a mesh
    refused(build, tmp_path, "claims more (instances|triangles at its nodes) than")


def test_many_nodes_of_one_mesh_are_bounded(tmp_path, build):
    """3,000 times a million triangles."""
    many = 1_000_000
    indices = build.accessor(np.zeros(3 * many, np.uint8), "u1")
    build.header["meshes"][0]["primitives"][0]["indices"] = indices
    build.header["nodes"] = [{"mesh": 0}] * 3000
    refused(build, tmp_path, "claims more triangles at its nodes than")


@pytest.mark.parametrize("count", [10**8, 10**18, 10**40])
def test_accessors_without_data_are_bounded(tmp_path, build, count):
    sparse = {
        "count": 1,
        "indices": {"bufferView": build.view(b"\1"), "componentType": KINDS["u1"]},
        "values": {"bufferView": build.view(np.ones((1, 3), "<f4").tobytes())},
    }
    position = build.header["accessors"][1]
    del position["bufferView"]
    position |= {"count": count, "sparse": sparse}
    refused(build, tmp_path, "claims more numbers in an accessor without data than")


def test_a_person_may_allow_more(tmp_path, build):
    del build.header["accessors"][1]["bufferView"]
    build.header["accessors"][1]["count"] = 10**6
    try:
        limits.set_max_memory("1MB")
        refused(build, tmp_path, "claims more .* than the 1 MB of memory")
        limits.set_max_memory("200MB")
        refused(build, tmp_path, "has no size")
    finally:
        limits.set_max_memory(None)


@pytest.mark.parametrize(
    ("name", "number", "change", "sentence"),
    [
        ("accessors", 1, {"count": 10**30}, "reaches beyond bufferView 1"),
        ("accessors", 1, {"count": -1}, "count -1 is no count"),
        ("accessors", 1, {"count": 4.5}, "count 4.5 is no count"),
        ("accessors", 1, {"count": "4"}, "count '4' is no count"),
        ("accessors", 1, {"byteOffset": 10**12}, "reaches beyond bufferView 1"),
        ("accessors", 1, {"byteOffset": -4}, "byteOffset -4 is no count"),
        ("accessors", 1, {"bufferView": 99}, "refers to number 99 of its 2 bufferViews"),
        ("accessors", 1, {"bufferView": -1}, "refers to number -1 of its 2 bufferViews"),
        ("accessors", 1, {"bufferView": [1]}, "of its 2 bufferViews"),
        ("accessors", 1, {"componentType": 1}, r"is wrong as glTF \(KeyError: 1"),
        ("accessors", 1, {"type": "VEC9"}, "is wrong as glTF .*VEC9"),
        ("bufferViews", 1, {"byteLength": 10**12}, "its buffers are shorter than its glTF header"),
        ("bufferViews", 1, {"byteLength": 8}, "reaches beyond bufferView 1"),
        ("bufferViews", 1, {"byteOffset": 10**12}, "its buffers are shorter than its glTF header"),
        ("bufferViews", 1, {"byteOffset": -12}, "byteOffset -12 is no count"),
        ("bufferViews", 1, {"byteStride": 0}, "puts values of 12 bytes only 0 bytes apart"),
        ("bufferViews", 1, {"byteStride": 10**12}, "reaches beyond bufferView 1"),
        ("bufferViews", 1, {"buffer": 3}, "refers to number 3 of its 1 buffers"),
        ("nodes", 0, {"mesh": 5}, "refers to number 5 of its 1 meshes"),
        ("nodes", 0, {"mesh": True}, "refers to number True of its 1 meshes"),
        ("nodes", 0, {"children": [7]}, "refers to number 7 of its 1 nodes"),
        ("nodes", 0, {"children": 7}, "holds a value of the wrong kind"),
        ("nodes", 0, {"translation": [1, 2]}, "is wrong as glTF .ValueError"),
        ("nodes", 0, {"extensions": {INSTANCING: {"attributes": {}}}}, "have different lengths"),
        ("meshes", 0, {"primitives": None}, "holds a value of the wrong kind"),
        ("meshes", 0, {"primitives": [{}]}, "is wrong as glTF .KeyError: 'attributes'"),
    ],
)
def test_what_the_file_does_not_hold_is_refused(tmp_path, build, name, number, change, sentence):
    build.header[name][number] |= change
    refused(build, tmp_path, sentence)


def test_a_buffer_shorter_than_it_says_is_cut_off(tmp_path, build):
    path = as_gltf(build, tmp_path, "a.bin")
    (tmp_path / "a.bin").write_bytes(build.chunk[:-10])
    with pytest.raises(MeshdepictError, match="is cut off: its buffers are shorter than its glTF"):
        read_mesh(path)


def test_a_buffer_without_data(tmp_path, build):
    build.header["buffers"] = [{"byteLength": 100}]
    path = tmp_path / "scene.gltf"
    path.write_text(json.dumps(build.header))
    with pytest.raises(MeshdepictError, match="there are no data for its buffer 0"):
        read_mesh(path)


def test_indices_of_a_signed_type_stay_in_their_part(tmp_path, build):
    build.header["meshes"][0]["primitives"][0]["indices"] = build.accessor([0, 1, -1], "i1")
    refused(build, tmp_path, "has a glTF index of -1 with only 4 points")


# --- numbers ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "node",
    [
        {"matrix": [float("inf")] + [0] * 14 + [1]}, {"matrix": [float("nan")] * 16},
        {"translation": [float("-inf"), 0, 0]}, {"scale": [1e400, 1, 1]},
        {"rotation": [1e300, 0, 0, 1]},
    ],
)  # fmt: skip
def test_a_transform_that_is_not_finite_is_refused(tmp_path, build, node):
    build.header["nodes"] = [{"mesh": 0} | node]
    refused(build, tmp_path, "the transform of node 0 is not finite")


def test_transforms_that_overflow_together_are_refused(tmp_path, build):
    build.header["nodes"] = [
        {"scale": [1e200] * 3, "children": [1]}, {"scale": [1e200] * 3, "mesh": 0},
    ]  # fmt: skip
    refused(build, tmp_path, "the transform of node 1 is not finite")
    build.header["nodes"] = [{"scale": [1e308] * 3, "translation": [1e308] * 3, "mesh": 0}]
    refused(build, tmp_path, "NaN or infinite|leave no room for computing")


def test_a_tiny_mirror_is_a_mirror(tmp_path, build):
    """Whose determinant underflows."""
    build.header["nodes"] = [{"mesh": 0, "scale": [-1e-120, 1e-120, 1e-120]}]
    plain = build.header | {"nodes": [{"mesh": 0, "scale": [1e-120] * 3}]}
    mirrored = build.read(tmp_path).faces
    build.header = plain
    np.testing.assert_array_equal(mirrored, build.read(tmp_path).faces[:, ::-1])


def test_points_that_are_not_finite_are_counted(tmp_path, build):
    build.header["accessors"][1]["bufferView"] = build.view(np.full(12, np.inf, "<f4").tobytes())
    refused(build, tmp_path, "4 of 4 vertices are NaN or infinite")


# --- depth --------------------------------------------------------------------------------------


def test_nodes_may_nest_as_deep_as_they_like(tmp_path, build):
    deep = 20_000
    build.header["nodes"] = [{"children": [i + 1]} for i in range(deep)] + [{"mesh": 0}]
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)


def test_json_that_nests_too_deep_is_one_sentence(data, tmp_path):
    deep = data / "cases" / "hostile" / "deep.gltf"
    with pytest.raises(MeshdepictError, match="its JSON part is nested too deep"):
        read_mesh(deep)
    assert read_provenance(deep) is None
    text = b'{"asset":{"version":"2.0"},"x":' + b'{"a":' * 100_000
    (tmp_path / "deep.gltf").write_bytes(text)
    with pytest.raises(MeshdepictError, match="its JSON part is nested too deep"):
        read_mesh(tmp_path / "deep.gltf")


# --- GLB ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "sentence"),
    [
        (struct.pack("<4sII", b"glTF", 2, 2**32 - 1), "claims far more than the .* bytes there"),
        (struct.pack("<4sII", b"glTF", 2, 12), "its header claims that nothing comes after it"),
    ],
)
def test_lengths_that_can_not_be(tmp_path, build, header, sentence):
    path = tmp_path / "built.glb"
    path.write_bytes(header + build.glb()[12:])
    with pytest.raises(MeshdepictError, match=sentence):
        read_mesh(path)


def test_a_part_that_claims_to_reach_beyond_the_end(tmp_path, build):
    path, data = tmp_path / "built.glb", bytearray(build.glb())
    at = 20 + int.from_bytes(data[12:16], "little")
    data[at : at + 4] = (2**31).to_bytes(4, "little")
    path.write_bytes(data)
    with pytest.raises(MeshdepictError, match="a part of it claims to reach beyond its end"):
        read_mesh(path)


@pytest.mark.parametrize("lines", [5, {"a": 1}, "word", [1, None]])
def test_odd_extras_are_no_provenance_and_no_traceback(tmp_path, build, lines):
    build.header["asset"]["extras"] = {"meshdepict": lines}
    np.testing.assert_array_equal(build.read(tmp_path).vertices, POINTS)
    found = read_provenance(tmp_path / "built.glb")
    assert found is None or found == [str(line) for line in lines]


def replaced(value: Any, where: int, junk: Any) -> Any:
    """Return a JSON value with its part number `where`, counted in depth, replaced."""
    at = iter(range(10**9))

    def copy(part: Any) -> Any:
        if next(at) == where:
            return junk
        if isinstance(part, dict):
            return {key: copy(item) for key, item in part.items()}
        return [copy(item) for item in part] if isinstance(part, list) else part

    return copy(value)


@pytest.mark.parametrize("junk", [None, -1, 1e308, "x", [], {}, [[]], True, 10**30])
def test_whatever_is_wrong_in_the_header_is_one_sentence_or_a_mesh(tmp_path, build, junk):
    """Each value of a header with everything in it becomes junk, one after the other."""
    primitive = build.header["meshes"][0]["primitives"][0]
    primitive["attributes"]["COLOR_0"] = build.accessor(np.ones((4, 4)), "f4")
    primitive |= {"targets": [{"POSITION": primitive["attributes"]["POSITION"]}], "material": 0}
    instanced = {INSTANCING: {"attributes": {"TRANSLATION": build.accessor([[1, 2, 3]], "f4")}}}
    build.header |= {
        "nodes": [
            {"children": [1, 2], "matrix": np.eye(4).reshape(-1).tolist()},
            {"mesh": 0, "weights": [0.5], "extensions": instanced},
            {"translation": [0, 1, 0]},
        ],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]}}],
        "extensionsRequired": [INSTANCING],
    }  # fmt: skip
    whole, sentences, meshes = build.header, [], 0
    for where in range(1, 400):
        build.header = replaced(whole, where, junk)
        if build.header == whole:
            continue
        if not build.header.get("buffers") or not isinstance(build.header["buffers"], list):
            continue
        if not isinstance(build.header["buffers"][0], dict):
            continue
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                build.read(tmp_path)
            meshes += 1
        except MeshdepictError as error:
            sentences.append(str(error))
    assert len(sentences) + meshes > 50
    for sentence in sentences:
        assert len(sentence.splitlines()) == 1
        assert "TypeError" not in sentence
