"""Bigger than memory: blocks, zarr and mapped files give what memory gives."""

from __future__ import annotations

import pickle
import sys
from pathlib import Path

import numpy as np
import pytest

from meshdepict.baking.choices import Choices
from meshdepict.baking.look import bake_volume
from meshdepict.baking.out_of_core import bake_out_of_core, lazy_rgba
from meshdepict.baking.voxel_shading import voxel_shading
from meshdepict.color.transfer import TransferFunction
from meshdepict.errors import MeshdepictError
from meshdepict.samples.phantom import ct_phantom
from meshdepict.shapes.place import Place
from meshdepict.shapes.volume import Volume

da = pytest.importorskip("dask.array")
zarr = pytest.importorskip("zarr")

BONE = TransferFunction(
    [(200, 0, (1, 0.9, 0.8)), (400, 0.5, (0.5, 0.8, 1))], gradient_opacity=[(10, 0), (60, 1)]
)
HOW = {"transfer": BONE, "scales": 2, "width": 7.0, "light": "east"}


@pytest.fixture(scope="module")
def head() -> Volume:
    return ct_phantom((48, 44, 52), noise=5)


def place(volume: Volume) -> dict:
    return {
        "spacing": volume.spacing, "origin": volume.origin, "direction": volume.direction,
        "hounsfield": volume.hounsfield,
    }  # fmt: skip


def shading_of(shape, method, **how):
    look = Choices(method, **how).of_kind("volume")
    return voxel_shading(shape, look, transfer=look.transfer)


@pytest.fixture(scope="module")
def expected(head: Volume) -> np.ndarray:
    return bake_volume(head, **HOW).rgba


@pytest.mark.parametrize("method", ["exaggerated", "light_warping", "view_curvature"])
def test_small_blocks_give_the_numbers_of_the_whole(method: str, head: Volume) -> None:
    how = {**HOW, "width": 3.0}
    recipe = shading_of(head, method, **how)
    blocks = lazy_rgba(da.from_array(head.values, chunks=(5, 6, 7)), recipe, chunks=(13, 14, 3))
    assert blocks.numblocks[:3] == (4, 3, 6)
    whole = bake_volume(head, method, **how).rgba
    np.testing.assert_array_equal(blocks.compute(scheduler="synchronous"), whole)
    if method == "exaggerated":
        threaded = blocks.compute(scheduler="threads", num_workers=2)
        np.testing.assert_array_equal(threaded, whole)


def test_wide_gaussians_take_the_grid_of_the_whole() -> None:
    long = ct_phantom((20, 20, 160), noise=5)  # 1.5 mm along z
    how = {**HOW, "width": 4.0, "scales": 1}  # 2.7 voxels: summed on a coarser grid
    recipe = shading_of(long, "exaggerated", **how)
    blocks = lazy_rgba(da.from_array(long.values), recipe, chunks=(16, 16, 16))
    assert blocks.numblocks[0] == 6
    whole = bake_volume(long, **how).rgba
    np.testing.assert_array_equal(blocks.compute(scheduler="synchronous"), whole)


def test_from_zarr_to_zarr(head: Volume, expected: np.ndarray, tmp_path: Path) -> None:
    source = zarr.create_array(
        tmp_path / "ct.zarr", shape=head.values.shape, chunks=(16, 16, 16), dtype="i2"
    )
    source[:] = head.values
    given = bake_out_of_core(tmp_path / "ct.zarr", tmp_path / "out.zarr", **place(head), **HOW)
    found = zarr.open(tmp_path / "out.zarr", mode="r")
    np.testing.assert_array_equal(found[:], expected)
    assert found.attrs["meshdepict"] == given
    assert given["volume"] == "48 x 44 x 52 voxels, {:g} to {:g}".format(*head.range)
    assert given["light"].startswith("east")
    again = tmp_path / "again.npy"
    bake_out_of_core(source, again, value_range=head.range, **place(head), **HOW)
    np.testing.assert_array_equal(np.load(again), expected)


def test_from_a_mapped_file_to_another(head: Volume, expected: np.ndarray, tmp_path: Path) -> None:
    np.save(tmp_path / "ct.npy", head.values)
    out = tmp_path / "out.npy"
    out.write_bytes(b"what was here before")
    bake_out_of_core(tmp_path / "ct.npy", out, chunks=(20, 20, 20), **place(head), **HOW)
    np.testing.assert_array_equal(np.load(out, mmap_mode="r"), expected)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["ct.npy", "out.npy"]


def test_a_place_is_the_volumes(head: Volume) -> None:
    empty = Place(head.values.shape, head.range, **place(head))
    assert empty.diagonal == head.diagonal
    np.testing.assert_array_equal(empty.outline, head.outline)
    np.testing.assert_array_equal(empty.centre, head.centre)
    assert empty.edge_length == head.edge_length
    assert (empty.range, empty.kind, empty.unit) == (head.range, "volume", "HU")


def test_raw_numbers_that_are_not_at_hand_say_no_unit(head: Volume) -> None:
    empty = Place(head.values.shape, head.range, **(place(head) | {"hounsfield": False}))
    empty.range = (0.0, 4000.0)
    with pytest.raises(MeshdepictError, match="its numbers aren't at hand"):
        shading_of(empty, "lambert")


def test_a_recipe_travels_to_workers_without_the_values(head: Volume) -> None:
    empty = Place((4000, 4000, 4000), head.range, **place(head))
    recipe = shading_of(empty, "exaggerated", **HOW)
    sent = pickle.dumps(recipe)
    assert len(sent) < 10_000
    back = pickle.loads(sent)
    np.testing.assert_array_equal(back.shape.outline, empty.outline)
    assert back.provenance(None, 0.1) == recipe.provenance(None, 0.1)


def test_a_failure_leaves_what_was_there(head: Volume, tmp_path: Path) -> None:
    def broken(block: np.ndarray) -> np.ndarray:
        raise OSError("the disk is gone")

    values = da.from_array(head.values, chunks=16).map_blocks(broken, dtype=np.int16)
    out = tmp_path / "out.npy"
    out.write_bytes(b"before")
    with pytest.raises(OSError, match="the disk is gone"):
        bake_out_of_core(values, out, value_range=(-1000, 3000), **place(head), **HOW)
    assert out.read_bytes() == b"before"
    assert [p.name for p in tmp_path.iterdir()] == ["out.npy"]


def test_wrong_input_says_so(head: Volume, tmp_path: Path) -> None:
    where = place(head)

    def bake(source: object, out: str = "out.npy", **more: object) -> None:
        bake_out_of_core(source, tmp_path / out, **{**where, **HOW, **more})

    zarr.open_group(tmp_path / "group.zarr", mode="w")
    (tmp_path / "there.zarr").mkdir()
    (tmp_path / "bad.npy").write_bytes(b"no array")
    for source, sentence in (
        (tmp_path / "ct.nii", "bigger than memory are read from"),
        (tmp_path / "no.npy", "no.npy can't be read"),
        (tmp_path / "bad.npy", "bad.npy can't be read"),
        (tmp_path / "no.zarr", "no.zarr can't be read"),
        (tmp_path / "group.zarr", "is a zarr group"),
        ([1, 2], "a list is not an array"),
        (np.zeros((3, 4)), r"not float64 of shape \(3, 4\)"),
        (np.zeros((3, 4, 5)), "the volume is constant: every voxel is 0"),
        (np.full((3, 4, 5), np.nan), "NaN or infinite"),
    ):
        with pytest.raises(MeshdepictError, match=sentence):
            bake(source)
    with pytest.raises(
        MeshdepictError, match=r"goes to an \.ome\.zarr, \.zarr or \.npy, not to '\.png'"
    ):
        bake(head.values, "out.png")
    with pytest.raises(MeshdepictError, match="exists already"):
        bake(head.values, "there.zarr")
    with pytest.raises(MeshdepictError, match="can't be written"):
        bake(head.values, "no/folder/out.npy")
    with pytest.raises(MeshdepictError, match="needs all voxels at once"):
        bake(head.values, method="accessibility")


@pytest.mark.parametrize(
    ("package", "sentence"), [("dask.array", "need dask"), ("zarr", "needs zarr")]
)
def test_a_missing_package_is_one_sentence(
    package: str, sentence: str, head: Volume, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    if package == "dask.array":
        monkeypatch.setitem(sys.modules, "dask", None)
    with pytest.raises(MeshdepictError, match=sentence):
        bake_out_of_core(head.values, tmp_path / "out.zarr", **place(head), **HOW)
