"""OME-Zarr: what is written is NGFF 0.4, and comes back as it was."""

import json

import numpy as np
import pytest

from meshdepict.baking.look import bake_volume
from meshdepict.baking.out_of_core import bake_lazily, bake_out_of_core
from meshdepict.errors import MeshdepictError
from meshdepict.files import limits
from meshdepict.io.volumes import read_volume, write_volume
from meshdepict.samples.phantom import ct_phantom
from meshdepict.shapes.volume import Volume

zarr = pytest.importorskip("zarr")
da = pytest.importorskip("dask.array")

TURNED = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])


@pytest.fixture(scope="module")
def head() -> Volume:
    made = ct_phantom((20, 22, 24), noise=5)
    return Volume(
        made.values, spacing=(0.5, 0.75, 2), origin=(3, -4, 5), hounsfield=True, length_unit="mm"
    )


@pytest.mark.parametrize("direction", [None, TURNED])
def test_a_volume_comes_back_with_its_place(head, folder, direction):
    given = Volume(
        head.values, spacing=head.spacing, origin=head.origin, direction=direction,
        hounsfield=True, length_unit="mm",
    )  # fmt: skip
    write_volume("a.ome.zarr", given.values, given)
    back = read_volume("a.ome.zarr")
    np.testing.assert_array_equal(back.values, given.values)
    for name in ("spacing", "origin", "direction"):
        np.testing.assert_array_equal(getattr(back, name), getattr(given, name))
    assert (back.hounsfield, back.length_unit) == (True, "mm")


def test_what_is_written_is_ngff_0_4(head, folder):
    write_volume("a.ome.zarr", head.values, head)
    read = json.loads((folder / "a.ome.zarr" / ".zattrs").read_text())
    (scales,) = read["multiscales"]
    assert scales["version"] == "0.4"
    assert [axis["name"] for axis in scales["axes"]] == ["z", "y", "x"]
    assert {axis["unit"] for axis in scales["axes"]} == {"millimeter"}
    scale, moved = scales["datasets"][0]["coordinateTransformations"]
    assert scale == {"type": "scale", "scale": [2, 0.75, 0.5]}
    assert moved == {"type": "translation", "translation": [5, -4, 3]}
    array = json.loads((folder / "a.ome.zarr" / "0" / ".zarray").read_text())
    assert (array["zarr_format"], array["dimension_separator"]) == (2, "/")
    assert json.loads((folder / "a.ome.zarr" / ".zgroup").read_text()) == {"zarr_format": 2}


def test_colours_are_four_channels_in_memory_and_block_by_block(head, folder):
    how = {"transfer": "bone", "scales": 2, "width": 2.0}
    baked = bake_volume(head, **how)
    baked.save("whole.ome.zarr")
    write_volume("a.ome.zarr", head.values, head)
    provenance = bake_out_of_core("a.ome.zarr", "blocks.ome.zarr", chunks=(9, 24, 24), **how)
    for name in ("whole", "blocks"):
        group = zarr.open_group(f"{name}.ome.zarr", mode="r")
        np.testing.assert_array_equal(np.moveaxis(group["0"][...], 0, -1), baked.rgba)
        axes = [axis["name"] for axis in group.attrs["multiscales"][0]["axes"]]
        assert axes == ["c", "z", "y", "x"]
        assert group.attrs["meshdepict"]["provenance"]["method"] == provenance["method"]
    lazy = bake_lazily("a.ome.zarr", chunks=(9, 24, 24), **how)
    np.testing.assert_array_equal(lazy.compute(scheduler="synchronous"), baked.rgba)
    with pytest.raises(MeshdepictError, match="4 values in a voxel"):
        read_volume("whole.ome.zarr")


def test_a_dask_array_goes_in_and_comes_out(head):
    how = {"transfer": "bone", "scales": 2, "width": 2.0}
    place = {
        "spacing": head.spacing, "origin": head.origin, "hounsfield": True,
    }  # fmt: skip
    source = da.from_array(head.values, chunks=(7, 8, 9))
    lazy = bake_lazily(source, **place, **how)
    assert isinstance(lazy, da.Array)
    np.testing.assert_array_equal(
        lazy.compute(scheduler="synchronous"), bake_volume(head, **how).rgba
    )
    np.testing.assert_array_equal(Volume(source).values, head.values)
    with pytest.raises(MeshdepictError, match="bake_lazily"):
        bake_volume(source)


def test_ngff_0_5_and_scales_one_after_the_other_are_read(folder):
    group = zarr.open_group("b.ome.zarr", mode="w", zarr_format=3)
    group.create_array("s0", shape=(1, 1, 2, 3, 4), dtype="u2")[...] = 7
    axes = [{"name": name} for name in "tczyx"]
    group.attrs["ome"] = {
        "version": "0.5",
        "multiscales": [{
            "axes": axes,
            "datasets": [{
                "path": "s0",
                "coordinateTransformations": [
                    {"type": "scale", "scale": [1, 1, 2, 3, 4]},
                    {"type": "translation", "translation": [0, 0, 10, 20, 30]},
                ],
            }],
            "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 10, 10, 10]}],
        }],
    }  # fmt: skip
    group["s0"][0, 0, 0, 0, 0] = 3
    back = read_volume("b.ome.zarr")
    assert back.values.shape == (2, 3, 4)
    np.testing.assert_allclose(back.spacing, (40, 30, 20))
    np.testing.assert_allclose(back.origin, (300, 200, 100))


def broken(name, **changes):
    group = zarr.open_group(name, mode="w", zarr_format=2)
    group.create_array("0", shape=changes.pop("shape", (2, 3, 4)), dtype="u1")
    told = {"axes": [{"name": n} for n in "zyx"], "datasets": [{"path": "0"}]} | changes
    group.attrs["multiscales"] = [told]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"datasets": []}, "without the multiscales"),
        ({"datasets": [{"path": "nowhere"}]}, "without the multiscales"),
        ({"axes": [{"name": n} for n in "xyz"]}, "a volume ends with z, y, x"),
        ({"axes": [{"name": n} for n in "czyx"]}, "a volume ends with z, y, x"),
        ({"coordinateTransformations": [{"type": "turn"}]}, "without the multiscales"),
        ({"coordinateTransformations": [{"type": "scale", "scale": [1, 2]}]}, "without the multi"),
        (
            {"axes": [{"name": n} for n in "czyx"], "shape": (3, 2, 3, 4)},
            "3 values in a voxel",
        ),
    ],
)  # fmt: skip
def test_what_is_no_volume_is_said_in_a_sentence(folder, changes, said):
    broken("c.ome.zarr", **changes)
    with pytest.raises(MeshdepictError, match=said):
        read_volume("c.ome.zarr")


def test_other_refusals(head, folder):
    zarr.create_array("d.zarr", shape=(2, 3, 4), dtype="u1")
    with pytest.raises(MeshdepictError, match="no OME-Zarr"):
        read_volume("d.zarr")
    write_volume("a.ome.zarr", head.values, head)
    with pytest.raises(MeshdepictError, match="exists already"):
        write_volume("a.ome.zarr", head.values, head)
    limits.set_max_memory(100)
    with pytest.raises(MeshdepictError, match="block by block"):
        read_volume("a.ome.zarr")
    limits.set_max_memory(None)
    (folder / "e.ome.zarr").mkdir()
    (folder / "e.ome.zarr" / ".zgroup").write_text("{")
    with pytest.raises(MeshdepictError, match="can't be read as zarr"):
        read_volume("e.ome.zarr")
    (folder / "a.ome.zarr" / "0" / "0" / "0" / "0").write_bytes(b"spoiled")
    with pytest.raises(MeshdepictError, match="is damaged"):
        read_volume("a.ome.zarr")
    with pytest.raises(MeshdepictError, match="there is no folder nowhere"):
        write_volume("nowhere/a.ome.zarr", head.values, head)


def test_a_folder_that_may_not_be_written_is_said(head, folder, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(zarr, "open_group", full)
    with pytest.raises(MeshdepictError, match="could not be written: No space left"):
        write_volume("a.ome.zarr", head.values, head)
    assert not [*folder.iterdir()]


def test_without_zarr_one_sentence_says_what_to_install(head, folder, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "zarr", None)
    with pytest.raises(MeshdepictError, match=r"meshdepict\[cluster\]"):
        write_volume("a.ome.zarr", head.values, head)
