"""Baked volumes: colours, opacity, the next light, slabs, files."""

from __future__ import annotations

import numpy as np
import pytest

from meshdepict import color
from meshdepict.baking.look import bake_volume
from meshdepict.baking.volumes import BakedVolume
from meshdepict.color.transfer import TransferFunction
from meshdepict.errors import MeshdepictError
from meshdepict.samples.phantom import ct_phantom
from meshdepict.scales.grid_making import grid_space, sample_bytes
from meshdepict.shading import METHODS, declaration
from meshdepict.shapes.volume import Volume

BONE = TransferFunction([(200, 0, (1, 0.9, 0.8)), (400, 0.5, (0.5, 0.8, 1))], name="bone-like")


@pytest.fixture(scope="module")
def head() -> Volume:
    return ct_phantom((40, 36, 32), noise=5)


@pytest.fixture(scope="module")
def baked(head: Volume) -> BakedVolume:
    return bake_volume(head, transfer=BONE, scales=3, width=8)


def test_colours_are_the_transfer_functions_in_linear_light(
    head: Volume, baked: BakedVolume
) -> None:
    space = baked.space
    rgba = baked.rgba.reshape(-1, 4)
    values = head.values.ravel()
    opacity = BONE.opacity(values)
    np.testing.assert_array_equal(rgba[:, 3] > 0, opacity > 0)
    np.testing.assert_array_equal(rgba[space.voxels, 3], color.quantise(opacity[space.voxels]))
    expected = color.multiply_albedo(
        baked.intensity, BONE.color(values[space.voxels]), linear=False
    )
    difference = expected.astype(int) - rgba[space.voxels, :3]
    assert np.abs(difference).max() <= 1  # one rounds the shading to float32 before, one after
    hidden = np.ones(len(rgba), bool)
    hidden[space.voxels] = hidden[space.flat.flat(head.values.shape)] = False
    assert (rgba[hidden] == 0).all()
    assert baked.shaded_share == len(space.points) / head.n_samples


def test_a_space_serves_the_next_light_and_method(baked: BakedVolume, head: Volume) -> None:
    for name in ("exaggerated", "lambert", "radiance_scaling"):
        again = bake_volume(baked.space, name, light="east")
        anew = bake_volume(head, name, transfer=BONE, light="east", scales=3, width=8)
        assert again.space is baked.space
        if name != "lambert":  # which asks for no scales
            np.testing.assert_array_equal(again.rgba, anew.rgba)
    assert again.provenance["light"].startswith("east")


@pytest.mark.parametrize("name", ["exaggerated", "radiance_scaling", "view_curvature", "phong"])
def test_slab_by_slab_gives_the_same(name: str, head: Volume) -> None:
    edges = TransferFunction(
        zip(BONE.values, BONE.opacities, BONE.colors, strict=True),
        gradient_opacity=[(20, 0), (60, 1)],
    )
    for transfer in (BONE, edges):
        whole = bake_volume(head, name, transfer=transfer, scales=3, width=8)
        told: list[tuple[float, float]] = []

        def tell(*done: float, told: list[tuple[float, float]] = told) -> None:
            told.append(done)

        slabs = bake_volume(
            head, name, transfer=transfer, scales=3, width=8,
            memory=2000 * sample_bytes(4), progress=tell,
        )  # fmt: skip
        assert slabs.space is None
        assert slabs.intensity is None
        np.testing.assert_array_equal(slabs.rgba, whole.rgba)
        assert slabs.shaded_share == whole.shaded_share
        assert slabs.provenance == whole.provenance
        assert len(told) > 2
        assert told[-1] == (32, 32)


def test_what_is_even_is_drawn_in_the_middle_of_all_methods() -> None:
    values = np.zeros((30, 8, 8), np.int16)
    values[0] = 1
    even = TransferFunction([(-1, 1, (0.5, 0.5, 0.5)), (2, 1, (0.5, 0.5, 0.5))], unit="raw")
    rgba = bake_volume(Volume(values), "lambert", transfer=even, light=(0, 0, -1)).rgba
    grey = color.multiply_albedo(np.array([0.5]), np.array([[0.5] * 3]), linear=False)[0]
    assert (rgba[5:] == (*grey, 255)).all()


def test_every_method_bakes(baked: BakedVolume) -> None:
    for name in METHODS:
        if declaration(METHODS[name]).needs & {"rays", "areas", "heights"}:
            with pytest.raises(MeshdepictError, match=r"(rays need|areas of|heights on) a "):
                bake_volume(baked.space, name)
            continue
        rgba = bake_volume(baked.space, name).rgba
        assert np.ptp(rgba[rgba[..., 3] > 0][:, :3]) > 20, name


def test_provenance_has_all_it_takes(baked: BakedVolume, head: Volume) -> None:
    found = baked.provenance
    assert found["method"] == "exaggerated"
    assert found["scales"].startswith("3, widths 8 to 16")
    assert found["albedo"] == "transfer function bone-like"
    assert found["volume"] == head.identity
    assert found["shaded"] == f"{baked.shaded_share:.3%} of the voxels"
    assert repr(baked).startswith("<BakedVolume: exaggerated on ")


def test_the_default_width_is_the_largest_spacing(head: Volume) -> None:
    space = bake_volume(head, transfer=BONE, scales=1).space
    assert space.widths[1] == pytest.approx(240 / 32)


def test_files_and_pyvista_keep_the_grid(baked: BakedVolume, tmp_path, head: Volume) -> None:
    import pyvista as pv

    path = baked.save(tmp_path / "head.vti")
    for image in (pv.read(path), baked.to_pyvista()):
        np.testing.assert_array_equal(image.point_data["RGBA"], baked.rgba.reshape(-1, 4))
        np.testing.assert_allclose(image.spacing, head.spacing)
    with pytest.raises(MeshdepictError, match="not saved as"):
        baked.save(tmp_path / "head.ply")
    by_image = bake_volume(head.to_pyvista(), "lambert", transfer=BONE)
    by_path = tmp_path / "ct.vti"
    head.to_pyvista().save(by_path)
    np.testing.assert_array_equal(
        bake_volume(by_path, "lambert", transfer=BONE).rgba, by_image.rgba
    )


def test_a_real_scan_bakes(data) -> None:
    from meshdepict.io.volumes import read_volume

    pytest.importorskip("SimpleITK")
    scan = read_volume(data / "ct" / "ct_headsq_64x64x93.nrrd")
    bone = TransferFunction([(1100, 0, (1, 1, 1)), (1200, 1, (1, 1, 1))], unit="raw")
    found = bake_volume(scan, transfer=bone)
    np.testing.assert_array_equal(found.rgba[..., 3] > 0, scan.values > 1100)
    assert found.space.widths[1] == pytest.approx(3.2)
    shown = found.rgba[..., 3] > 0
    assert np.ptp(found.rgba[shown][:, 0]) > 150


def test_wrong_input_says_so(baked: BakedVolume, head: Volume) -> None:
    with pytest.raises(MeshdepictError, match="a list is not a volume"):
        bake_volume([1, 2])
    with pytest.raises(MeshdepictError, match="transfer function comes too late"):
        bake_volume(baked.space, transfer=BONE.in_raw_numbers(1, 0))
    with pytest.raises(MeshdepictError, match="scales=5 comes too late"):
        bake_volume(baked.space, scales=5)
    with pytest.raises(MeshdepictError, match="unsharp_masking needs all voxels at once"):
        bake_volume(head, "unsharp_masking", transfer=BONE, memory=1e5)
    with pytest.raises(MeshdepictError, match="no option 'exageration'"):
        bake_volume(head, transfer=BONE, exageration=3)
    white = bake_volume(grid_space(head, np.zeros(1), 2.0, where=head.values > 200), "lambert")
    assert (white.rgba[..., 3][head.values > 200] == 255).all()
