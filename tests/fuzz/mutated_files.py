"""Good files of every format, and ways to spoil them: the same every time."""

from __future__ import annotations

import gzip
import json
import re
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
from gltf_builder import Builder
from height_seeds import height_seeds
from volume_seeds import volume_seeds

import meshdepict as md
from meshdepict.images.encoded import encode
from meshdepict.io import write_mesh
from meshdepict.io.heightfields import read_heightfield
from meshdepict.io.volumes import read_volume

Bytes = Callable[[bytes, np.random.Generator], bytes]


def seeds(folder: Path) -> dict[str, bytes]:
    """Return small good files by name; the suffix says who reads them."""
    ball = md.samples.golf_ball(60, dimples=12)
    grays = np.linspace(0, 255, len(ball.vertices)).astype(np.uint8)
    colors = np.repeat(grays[:, None], 3, axis=1)
    quads = md.Mesh(ball.vertices[:8], [[0, 1, 2, 3], [4, 5, 6, 7], [0, 4, 5], [1, 2, 6, 7, 3]])
    found: dict[str, bytes] = {}
    for suffix in (".ply", ".obj", ".off", ".glb", ".vtp"):
        for name, mesh in (("ball", ball), ("quads", quads)):
            path = folder / f"{name}{suffix}"
            write_mesh(path, mesh, colors=colors[: len(mesh.vertices)])
            found[path.name] = path.read_bytes()
    found["ascii.ply"] = _ascii_ply(ball)
    found["big.ply"] = _big_endian_ply(ball)
    found["strips.ply"] = _strips_ply(ball)
    found["packed.ply.gz"] = gzip.compress(found["ball.ply"], mtime=0)
    found["ascii.stl"], found["binary.stl"] = _ascii_stl(ball), _binary_stl(ball)
    found["textured.obj"] = _textured_obj(ball)
    found["textured.ply"], found["textured.glb"] = _textured_ply(ball), _textured_glb(ball)
    found["embedded.gltf"] = _gltf(found["ball.glb"])
    found |= _vtp(folder, found["quads.vtp"]) | volume_seeds(folder) | height_seeds(folder)
    md.save_recipe(folder / "look.toml", {"method": "exaggerated", "light": (30, 40)})
    found["look.recipe.toml"] = (folder / "look.toml").read_bytes()
    function = md.TransferFunction([(0, 0, "#102030"), (500, 0.5, (1, 0.5, 0))], name="mine")
    function.to_toml(folder / "mine.toml")
    found["mine.transfer.toml"] = (folder / "mine.toml").read_bytes()
    found["sky.hdr"] = _radiance()
    return found


def open_file(path: Path) -> str:
    """Read a file as its name says, and look at what came in; return what it was."""
    if path.name.endswith(".recipe.toml"):
        md.Look.load(path)
        return "recipe"
    if path.name.endswith(".transfer.toml"):
        md.TransferFunction.from_toml(path)
        return "transfer"
    if path.suffix == ".hdr":
        assert np.isfinite(md.Environment.from_file(path).pixels).all()
        return "environment"
    if path.suffix == ".tif":
        shape = read_heightfield(path) if path.name.startswith("map") else read_volume(path)
    else:
        shape = md.read(path)
    if shape.kind == "height field":
        assert np.isfinite(shape.z).all()
        return "terrain"
    if shape.kind == "volume":
        assert np.isfinite(shape.range).all()
        return "volume"
    if shape.textures is not None:
        assert np.isfinite(shape.texcoords).all()
        for texture in (*shape.textures.base_colors, *shape.textures.normal_maps):
            assert texture is None or np.isfinite(texture.lookup([[0.3, 7.4]])).all()
    values = md.bake(shape, "exaggerated", scales=1).intensity
    assert np.isfinite(values).all()
    return "mesh"


# --- seeds ------------------------------------------------------------------------------------


def _ascii_ply(mesh: md.Mesh) -> bytes:
    head = (
        "ply\nformat ascii 1.0\ncomment made by hand\n"
        f"element vertex {len(mesh.vertices)}\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = ["{:.6g} {:.6g} {:.6g} 10 20 30".format(*v) for v in mesh.vertices]
    rows += ["3 {} {} {}".format(*f) for f in mesh.faces]
    return (head + "\n".join(rows) + "\n").encode()


def _big_endian_ply(mesh: md.Mesh) -> bytes:
    head = (
        "ply\nformat binary_big_endian 1.0\n"
        f"element vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\n"
        "property double z\nproperty float quality\n"
        f"element face {len(mesh.faces)}\nproperty list uchar uint vertex_indices\n"
        "property list uchar float texcoord\nend_header\n"
    )
    rows = b"".join(struct.pack(">3df", *v, 0.5) for v in mesh.vertices)
    faces = b"".join(struct.pack(">B3IB6f", 3, *f, 6, *([0.25] * 6)) for f in mesh.faces)
    return head.encode() + rows + faces


def _strips_ply(mesh: md.Mesh) -> bytes:
    strips = np.concatenate([[*face, -1] for face in mesh.faces]).astype("<i4")
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(mesh.vertices)}\nproperty float x\nproperty float y\n"
        "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    )
    body = mesh.vertices.astype("<f4").tobytes()
    return head.encode() + body + struct.pack("<i", len(strips)) + strips.tobytes()


def _corners(mesh: md.Mesh) -> np.ndarray:
    return mesh.vertices[mesh.faces].astype("<f4")


def _ascii_stl(mesh: md.Mesh) -> bytes:
    lines = ["solid ball"]
    for triangle in _corners(mesh):
        lines += ["facet normal 0 0 1", "outer loop"]
        lines += ["vertex {:.6g} {:.6g} {:.6g}".format(*corner) for corner in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid ball", ""]).encode()


def _binary_stl(mesh: md.Mesh) -> bytes:
    rows = b"".join(bytes(12) + t.tobytes() + bytes(2) for t in _corners(mesh))
    return b"made by hand".ljust(80) + struct.pack("<I", len(mesh.faces)) + rows


def _textured_obj(mesh: md.Mesh) -> bytes:
    lines = ["mtllib ball.mtl", "usemtl stone", "s off"]
    lines += ["v {:.6g} {:.6g} {:.6g} 0.5 0.4 0.3".format(*v) for v in mesh.vertices]
    lines += ["vt 0.25 0.5", "vn 0 0 1"]
    lines += ["f {}/1/1 {}/1/1 \\\n {}/1/1".format(*(f + 1)) for f in mesh.faces]
    return "\n".join([*lines, ""]).encode()


def _textured_ply(mesh: md.Mesh) -> bytes:
    """Coordinates in elements of their own; the picture isn't there."""
    rows = [
        "ply", "format ascii 1.0", "comment TextureFile ball.png",
        f"element vertex {len(mesh.vertices)}", *(f"property float {name}" for name in "xyz"),
        f"element face {len(mesh.faces)}", "property list uchar int vertex_indices",
        "element multi_texture_vertex 2", "property float u", "property float v",
        f"element multi_texture_face {len(mesh.faces)}", "property uchar tx", "property uint tn",
        "property list uchar int texture_vertex_indices", "end_header",
    ]  # fmt: skip
    rows += ["{:.6g} {:.6g} {:.6g}".format(*v) for v in mesh.vertices]
    rows += ["3 {} {} {}".format(*f) for f in mesh.faces]
    rows += ["0.25 0.5", "0.75 -0.5"]
    rows += [f"0 {number} 3 0 1 0" for number in range(len(mesh.faces))]
    return "\n".join([*rows, ""]).encode()


def _textured_glb(mesh: md.Mesh) -> bytes:
    """A picture, turned and scaled, with a depiction beside."""
    build = Builder()
    pixels = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
    points = np.asarray(mesh.vertices)
    build.mesh({
        "attributes": {
            "POSITION": build.accessor(points, "f4"),
            "TEXCOORD_1": build.accessor(points[:, :2], "f4"),
        },
        "indices": build.accessor(mesh.faces.ravel(), "u2"),
        "material": 0,
    })  # fmt: skip
    moved = {"rotation": 0.3, "scale": [0.5, 2], "texCoord": 1}
    laid = {"index": 0, "extensions": {"KHR_texture_transform": moved}}
    build.header |= {
        "nodes": [{"mesh": 0}],
        "images": [{"bufferView": build.view(encode(pixels)), "mimeType": "image/png"}],
        "samplers": [{"wrapS": 33648}],
        "textures": [{"source": 0, "sampler": 0}],
        "materials": [{
            "pbrMetallicRoughness": {"baseColorTexture": laid, "baseColorFactor": [1, 0.5, 0, 1]},
            "normalTexture": {"index": 0, "texCoord": 1, "scale": 0.5},
        }],
    }  # fmt: skip
    return build.glb()


def _gltf(glb: bytes) -> bytes:
    import base64

    length = struct.unpack_from("<I", glb, 12)[0]
    scene = json.loads(glb[20 : 20 + length])
    body = glb[28 + length :]
    uri = "data:application/octet-stream;base64," + base64.b64encode(body).decode()
    scene["buffers"] = [{"byteLength": len(body), "uri": uri}]
    return json.dumps(scene, indent=1).encode()


def _vtp(folder: Path, written: bytes) -> dict[str, bytes]:
    """Return the same polygons with their arrays behind the tree, packed in several ways."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

    reader = vtkXMLPolyDataReader()
    reader.SetReadFromInputString(True)
    reader.SetInputString(written)
    found = {}
    for compressor in ("None", "ZLib", "LZ4"):
        writer = vtkXMLPolyDataWriter()
        writer.SetInputConnection(reader.GetOutputPort())
        writer.SetFileName(str(folder / "a.vtp"))
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
        writer.SetEncodeAppendedData(compressor == "ZLib")
        writer.Write()
        found[f"{compressor.lower()}.vtp"] = (folder / "a.vtp").read_bytes()
    return found


def _radiance() -> bytes:
    pixels = np.tile(np.array([10, 20, 30, 128], np.uint8), (8, 16, 1))
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + pixels.tobytes()


# --- ways to spoil ----------------------------------------------------------------------------

_NUMBERS = (
    b"0", b"-1", b"1", b"255", b"65536", b"2147483647", b"4294967295", b"99999999999999999999",
    b"1e308", b"1e999", b"-1e-310", b"nan", b"inf", b"-inf", b"0x10", b"1_000", b"1,5", b"", b"x",
)  # fmt: skip
_WORDS = (
    b"\0", b"\n", b"\r", b"\r\n", b" ", b"\t", b'"', b"<", b"{", b"[[", b"\xff\xfe",
    b"\xef\xbb\xbf", b"\x1b[31m", b"../", b"/etc/hosts", b"http://localhost/", b"&x;",
    b"\xed\xa0\x80", b"null",
)  # fmt: skip
_INTEGERS = (0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)


def _cut(data: bytes, rng: np.random.Generator) -> bytes:
    return data[: rng.integers(0, len(data))]


def _flipped(data: bytes, rng: np.random.Generator) -> bytes:
    spoiled = bytearray(data)
    for _ in range(rng.integers(1, 9)):
        spoiled[rng.integers(0, len(spoiled))] ^= 1 << rng.integers(0, 8)
    return bytes(spoiled)


def _head_flipped(data: bytes, rng: np.random.Generator) -> bytes:
    spoiled = bytearray(data)
    for _ in range(rng.integers(1, 5)):
        spoiled[rng.integers(0, min(len(spoiled), 400))] = rng.integers(0, 256)
    return bytes(spoiled)


def _number(data: bytes, rng: np.random.Generator) -> bytes:
    places = [m.span() for m in re.finditer(rb"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?", data[:20_000])]
    if not places:
        return _flipped(data, rng)
    a, b = places[rng.integers(0, len(places))]
    return data[:a] + _NUMBERS[rng.integers(0, len(_NUMBERS))] + data[b:]


def _integer(data: bytes, rng: np.random.Generator) -> bytes:
    at = int(rng.integers(0, max(len(data) - 4, 1)))
    value = struct.pack("<>"[rng.integers(0, 2)] + "I", _INTEGERS[rng.integers(0, 9)])
    return data[:at] + value + data[at + 4 :]


def _word(data: bytes, rng: np.random.Generator) -> bytes:
    at = rng.integers(0, min(len(data), 2_000))
    return data[:at] + _WORDS[rng.integers(0, len(_WORDS))] + data[at:]


def _lines(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.split(b"\n")
    at, other = rng.integers(0, len(lines), 2)
    kind = rng.integers(0, 3)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines[at], lines[other] = lines[other], lines[at]
    else:
        lines[at:at] = [lines[other]] * int(rng.integers(1, 50))
    return b"\n".join(lines)


def _piece(data: bytes, rng: np.random.Generator) -> bytes:
    a, b = sorted(int(x) for x in rng.integers(0, len(data) + 1, 2))
    kind = rng.integers(0, 3)
    if kind == 0:
        return data[:a] + data[b:]
    if kind == 1:
        return data[:b] + data[a:]
    return data[:a] + bytes(b - a) + data[b:]


WAYS: tuple[Bytes, ...] = (
    _cut, _flipped, _head_flipped, _number, _number, _integer, _word, _lines, _piece,
)  # fmt: skip


def mutated(data: bytes, number: int) -> bytes:
    """Return a file spoiled in the number's way; of a packed file, half the time what is inside."""
    rng = np.random.default_rng([number, len(data)])
    if data[:2] == b"\x1f\x8b" and rng.integers(0, 2):
        return gzip.compress(mutated(gzip.decompress(data), number), mtime=0)
    for _ in range(1 + int(rng.integers(0, 3) == 0)):
        data = WAYS[rng.integers(0, len(WAYS))](data, rng) or b"\0"
    return data
