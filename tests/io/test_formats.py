"""What holds for every format that can be written."""

from __future__ import annotations

import errno
import importlib
import os
import pickle
from pathlib import Path

import numpy as np
import pytest

from meshdepict import read as lazy_read
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io import read, read_mesh, read_provenance, write_mesh
from meshdepict.io.source import FORMATS, WRITABLE
from meshdepict.shapes.document import as_bytes
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.polygons import as_polygons

TRIANGLES_ONLY = (".glb", ".gltf")
ONE_COLOR = (".obj", ".off", ".glb", ".gltf")
OURS = ["meshdepict 0.1 exaggerated", 'meshdepict {"light": "northwest", "file": "σ.ply"}']


def small_mesh(seed: int = 0) -> Mesh:
    """Triangles, quads and a pentagon on points that need doubles, far from the origin."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(9, 3)) + np.array([500_000, 100, -7])
    return Mesh(points, [[0, 1, 2], [2, 1, 3, 4], [4, 3, 5, 6, 7], [0, 2, 8]], winding="keep")


def random_colors(mesh: Mesh, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (len(mesh.vertices), 3)).astype(np.uint8)


def colors_of(mesh: Mesh, prefix: str = "") -> np.ndarray:
    vertex = mesh.attributes["vertex"]
    found = np.stack([vertex[prefix + name] for name in ("red", "green", "blue")], axis=1)
    assert found.dtype == np.uint8
    return found


def assert_same_shape(found: Mesh, mesh: Mesh, suffix: str) -> None:
    if suffix in TRIANGLES_ONLY:
        np.testing.assert_array_equal(found.faces, mesh.faces)
        rounding = 2.0**-23 * np.ptp(mesh.vertices, axis=0).max()  # of floats round their centre
        np.testing.assert_allclose(found.vertices, mesh.vertices, rtol=0, atol=rounding)
    else:
        np.testing.assert_array_equal(found.vertices, mesh.vertices)
        for ours, theirs in zip(found.polygons, mesh.polygons, strict=True):
            np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("packed", ["", ".gz"])
@pytest.mark.parametrize("suffix", WRITABLE)
def test_round_trip(tmp_path, suffix, packed):
    mesh, path = small_mesh(), tmp_path / f"mesh{suffix}{packed}"
    write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
    assert (path.read_bytes()[:2] == b"\x1f\x8b") == bool(packed)
    found = read_mesh(path, winding="keep")
    assert_same_shape(found, mesh, suffix)
    np.testing.assert_array_equal(colors_of(found), random_colors(mesh))
    assert read_provenance(path) == OURS


@pytest.mark.parametrize("suffix", WRITABLE)
def test_every_level_survives(tmp_path, suffix):
    """glTF's linear colours, too: 16 bit resolve the darkest step of sRGB twenty times."""
    points = np.random.default_rng(0).normal(size=(256, 3))
    mesh = Mesh(points, np.arange(255).reshape(-1, 3), winding="keep")
    colors = np.stack([np.roll(np.arange(256), shift) for shift in (0, 85, 170)], axis=1)
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh, colors=colors.astype(np.uint8))
    np.testing.assert_array_equal(colors_of(read_mesh(path, winding="keep")), colors)


@pytest.mark.parametrize("suffix", WRITABLE)
def test_without_colours_or_comments(tmp_path, suffix):
    mesh, path = small_mesh(), tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh)
    found = read_mesh(path, winding="keep")
    assert found.attributes["vertex"] == {}
    assert_same_shape(found, mesh, suffix)
    assert read_provenance(path) is None


@pytest.mark.parametrize("suffix", WRITABLE)
def test_own_colours_stay_where_no_new_ones_come(tmp_path, suffix):
    plain, path = small_mesh(), tmp_path / f"mesh{suffix}"
    own = dict(zip(("red", "green", "blue"), random_colors(plain).T, strict=True))
    mesh = Mesh(plain.vertices, plain.polygons, attributes={"vertex": own}, winding="keep")
    write_mesh(path, mesh)
    for _ in range(2):
        mesh = read_mesh(path, winding="keep")
        np.testing.assert_array_equal(colors_of(mesh), random_colors(plain))
        write_mesh(path, mesh)


@pytest.mark.parametrize("suffix", WRITABLE)
def test_a_second_bake_replaces_the_first(tmp_path, suffix):
    mesh, path = small_mesh(), tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
    write_mesh(path, read_mesh(path), colors=random_colors(mesh, 2), comments=OURS[:1])
    found = read_mesh(path, winding="keep")
    np.testing.assert_array_equal(colors_of(found), random_colors(mesh, 2))
    assert set(found.attributes["vertex"]) == {"red", "green", "blue"}
    assert read_provenance(path) == OURS[:1]


@pytest.mark.parametrize("target", WRITABLE)
@pytest.mark.parametrize("source", WRITABLE)
def test_from_every_format_to_every_other(tmp_path, source, target):
    mesh = small_mesh()
    first, second = tmp_path / f"first{source}", tmp_path / f"second{target}"
    write_mesh(first, mesh, colors=random_colors(mesh))  # without provenance: its own colours
    loaded = read_mesh(first, winding="keep")
    scenes = {source, target} <= {".glb", ".gltf"}  # the own colours stay in their scene
    if target in ONE_COLOR and not scenes:
        with pytest.warns(MeshdepictWarning, match="holds one colour per vertex"):
            write_mesh(second, loaded, colors=random_colors(mesh, 2), comments=OURS)
    else:
        write_mesh(second, loaded, colors=random_colors(mesh, 2), comments=OURS)
    found = read_mesh(second, winding="keep")
    np.testing.assert_array_equal(found.faces, mesh.faces)
    np.testing.assert_array_equal(colors_of(found), random_colors(mesh, 2))
    if target not in ONE_COLOR or scenes:
        np.testing.assert_array_equal(colors_of(found, "original_"), random_colors(mesh))

    # A former bake's colours are no original ones, whatever format they come from.
    write_mesh(first, mesh, colors=random_colors(mesh), comments=OURS)
    write_mesh(second, read_mesh(first), colors=random_colors(mesh, 2), comments=OURS)
    assert set(read_mesh(second).attributes["vertex"]) == {"red", "green", "blue"}


def test_the_original_colours_outlive_several_bakes(tmp_path):
    plain, path = small_mesh(), tmp_path / "mesh.ply"
    own = dict(zip(("red", "green", "blue"), random_colors(plain).T, strict=True))
    mesh = Mesh(plain.vertices, plain.polygons, attributes={"vertex": own}, winding="keep")
    for name in ("mesh.ply", "mesh.vtp", "again.ply", "again.vtp"):
        write_mesh(tmp_path / name, mesh, colors=random_colors(plain, 2), comments=OURS)
        mesh = read_mesh(tmp_path / name, winding="keep")
        np.testing.assert_array_equal(colors_of(mesh, "original_"), random_colors(plain))
    write_mesh(path, mesh, colors=random_colors(plain, 3), comments=OURS, keep_colors=False)
    assert set(read_mesh(path).attributes["vertex"]) == {"red", "green", "blue"}


@pytest.mark.parametrize("suffix", WRITABLE)
def test_names_of_files_that_are_no_text(tmp_path, suffix):
    """A path may hold any byte, and characters that don't print."""
    mesh, path = small_mesh(), tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh, comments=["meshdepict file=a\u00a0\udcff.ply"])
    assert read_provenance(path) == ["meshdepict file=a\u00a0\\udcff.ply"]


@pytest.mark.parametrize("suffix", ONE_COLOR)
def test_original_colours_that_are_lost_are_warned_of(tmp_path, suffix):
    plain = small_mesh()
    own = dict(zip(("red", "green", "blue"), random_colors(plain).T, strict=True))
    mesh = Mesh(plain.vertices, plain.polygons, attributes={"vertex": own}, winding="keep")
    write_mesh(tmp_path / "mesh.ply", mesh, colors=random_colors(mesh, 2), comments=OURS)
    baked = read_mesh(tmp_path / "mesh.ply")
    with pytest.warns(MeshdepictWarning, match="the mesh's own colours are lost"):
        write_mesh(tmp_path / f"mesh{suffix}", baked, colors=random_colors(mesh, 3))


def test_colours_of_all_types_as_bytes():
    for values, expected in (
        (np.array([0, 0.5, 1, np.nan]), [0, 128, 255, 0]),
        (np.array([0, 0.5, 1], np.float16), [0, 128, 255]),
        (np.array([0.0, 127.6, 255, np.inf, -np.inf]), [0, 128, 255, 255, 0]),
        (np.array([np.nan, np.nan]), [0, 0]),
        (np.array([0, 128, 255]), [0, 128, 255]),
        (np.array([0, 128 * 257, 65535], np.uint16), [0, 128, 255]),
        (np.array([-5, 7]), [0, 7]),
        (np.array([]), []),
    ):
        found = as_bytes(values)
        assert found.tolist() == expected
        assert found.dtype == np.uint8


@pytest.mark.parametrize("suffix", WRITABLE)
def test_the_same_mesh_gives_the_same_bytes(tmp_path, suffix):
    mesh = small_mesh()
    contents = []
    for name in ("one", "two"):
        path = tmp_path / f"{name}{suffix}.gz"
        write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
        contents.append(path.read_bytes())
    assert contents[0] == contents[1]


@pytest.mark.parametrize("suffix", WRITABLE)
def test_nothing_that_comes_in_is_changed(tmp_path, suffix):
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, small_mesh(), colors=random_colors(small_mesh()))
    mesh = read_mesh(path)
    before = pickle.dumps((mesh.vertices, mesh.polygons, mesh.attributes, mesh.document))
    colors = random_colors(mesh)
    given = colors.copy()
    write_mesh(path, mesh, colors=colors, comments=OURS, keep_colors=False)
    np.testing.assert_array_equal(colors, given)
    assert colors.flags.writeable
    after = pickle.dumps((mesh.vertices, mesh.polygons, mesh.attributes, mesh.document))
    assert after == before


class Interrupted:
    """A file that fails after some bytes."""

    def __init__(self, file, fault: BaseException) -> None:
        self._file, self._fault, self._left = file, fault, 100

    def write(self, content) -> int:
        self._left -= len(memoryview(content).cast("B"))
        if self._left < 0:
            raise self._fault
        return self._file.write(content)

    def writelines(self, lines) -> None:
        for line in lines:
            self.write(line)


@pytest.mark.parametrize(
    ("fault", "raised", "message"),
    [
        (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), MeshdepictError, "no space is left"),
        (KeyboardInterrupt(), KeyboardInterrupt, None),
    ],
    ids=["full disk", "Ctrl-C"],
)
@pytest.mark.parametrize("suffix", WRITABLE)
def test_an_interrupted_write_leaves_the_old_file_whole(
    tmp_path, monkeypatch, suffix, fault, raised, message
):
    mesh, path = small_mesh(), tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh, colors=random_colors(mesh), comments=OURS)
    whole = path.read_bytes()
    module = importlib.import_module(f"meshdepict.io.{FORMATS[suffix]}")
    encode = module.encode
    monkeypatch.setattr(
        module, "encode", lambda file, *given: encode(Interrupted(file, fault), *given)
    )
    with pytest.raises(raised, match=message):
        write_mesh(path, mesh, colors=random_colors(mesh, 2))
    assert path.read_bytes() == whole
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs Linux's /dev/full")
@pytest.mark.parametrize("suffix", [*WRITABLE, ".ply.gz"])
def test_a_full_disk(tmp_path, suffix):
    mesh = small_mesh()
    (tmp_path / f"full{suffix}").symlink_to("/dev/full")
    with pytest.raises(MeshdepictError, match="no space is left on the disk"):
        write_mesh(tmp_path / f"full{suffix}", mesh, colors=random_colors(mesh))


def test_suffixes_in_capitals(tmp_path):
    mesh = small_mesh()
    for suffix in WRITABLE:
        path = tmp_path / f"mesh{suffix.upper()}"
        write_mesh(path, mesh)
        assert_same_shape(read_mesh(str(path), winding="keep"), mesh, suffix)


def test_read_is_read_mesh(tmp_path):
    path = tmp_path / "mesh.ply"
    write_mesh(path, small_mesh())
    assert lazy_read is read
    for winding in ("auto", "keep"):
        assert read(path, winding=winding).winding == winding
    with pytest.raises(MeshdepictError, match=r"mesh\.ply: winding='odd' is neither"):
        read(path, winding="odd")


@pytest.mark.parametrize("suffix", WRITABLE)
def test_faces_of_many_corners(tmp_path, suffix):
    angle = np.arange(400) * 2 * np.pi / 400
    points = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
    mesh = Mesh(points, [list(range(400)), [0, 1, 2]], winding="keep")
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh)
    assert_same_shape(read_mesh(path, winding="keep"), mesh, suffix)
    assert as_polygons(mesh.faces).offsets[-1] == 3 * 399
