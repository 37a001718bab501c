"""Detail of a finer mesh in the texture of a coarser one."""

import numpy as np
import pytest
from textured_shapes import globe, laid, picture, sheet

from meshdepict import color, samples
from meshdepict.baking.finer_surface import FinerSurface
from meshdepict.baking.textures import bake_texture
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.scales.making import scale_space
from meshdepict.shapes.mesh import Mesh


def waves(x, y):
    return 0.01 * np.sin(12 * x) * np.cos(9 * y)


def test_a_flat_square_shows_the_waves_of_a_finer_one_where_they_are():
    fine, coarse = sheet(60, height=waves), sheet(1)
    light = np.array([0.6, 0.0, 0.8])
    baked = bake_texture(coarse, "lambert", size=240, detail=fine, light=light)
    v, u = (np.mgrid[:240, :240] + 0.5) / 240
    x, y = u, 1 - v
    slope = np.stack(
        [
            -0.12 * np.cos(12 * x) * np.cos(9 * y),
            0.09 * np.sin(12 * x) * np.sin(9 * y),
            np.ones_like(x),
        ],
        -1,
    )
    slope /= np.linalg.norm(slope, axis=-1, keepdims=True)
    wanted = color.encode(np.clip(slope @ light, 0, 1).ravel(), linear=True).reshape(240, 240, 3)
    error = np.abs(baked.image.astype(int) - wanted)[8:-8, 8:-8]  # borders have one-sided normals
    assert np.sqrt(np.mean(error.astype(float) ** 2)) < 1.5
    assert "0 of 57600 texels missed" in baked.provenance["texture"]


def test_the_mesh_itself_as_detail_changes_nothing():
    ball = globe(10)
    alone = bake_texture(ball, size=256).image.astype(int)
    both = bake_texture(ball, size=256, detail=ball).image
    assert np.mean(np.abs(both - alone) <= 1) > 0.999


def test_detail_has_scales_of_its_own():
    fine, coarse = samples.golf_ball(3000), samples.sphere(300)
    baked = bake_texture(coarse, size=512, detail=fine, cage="10%")
    space = scale_space(fine, scales=9)
    assert f"widths {space.widths[1]:.6g}" in baked.provenance["scales"]


def test_texels_whose_rays_meet_nothing_take_the_closest_point_and_are_counted():
    fine, coarse = sheet(12), sheet(1)
    half = fine.faces[fine.vertices[fine.faces][..., 0].max(axis=1) <= 0.5 + 1e-9]
    finer = Mesh(fine.vertices, half)
    with pytest.warns(MeshdepictWarning, match="2,048 of 4,096 texels met nothing"):
        baked = bake_texture(coarse, "lambert", size=64, detail=finer, light=(0, 0, 1))
    assert (baked.image == 255).all()
    with pytest.warns(MeshdepictWarning, match="2,048 of 4,096"):  # counted anew
        baked.with_look(light=(0, 0, 1))


def test_the_cage_says_how_far_away_detail_may_be():
    coarse = sheet(1)
    above = Mesh(np.add(coarse.vertices, (0, 0, 0.1)), coarse.faces)
    with pytest.warns(MeshdepictWarning, match="1,024 of 1,024 texels met nothing"):
        bake_texture(coarse, "lambert", size=32, detail=above, cage=0.05)
    baked = bake_texture(coarse, "lambert", size=32, detail=above, cage=0.2)
    assert "0 of 1024 texels missed" in baked.provenance["texture"]


def test_detail_brings_the_colours_of_its_texture():
    fine, coarse = sheet(8), sheet(1)
    checks = np.zeros((64, 64, 3))
    checks[(np.indices((64, 64)) // 16).sum(axis=0) % 2 == 0] = (10, 200, 100)
    painted = laid(fine, fine.texcoords, base=picture(checks))
    baked = bake_texture(coarse, "lambert", size=64, detail=painted, albedo="keep", light=(0, 0, 1))
    assert np.mean(np.abs(baked.image.astype(int) - checks) <= 2) > 0.99


def test_a_normal_map_of_detail_leads_back_to_its_shading():
    fine, coarse = sheet(60, height=waves), sheet(2)
    found = bake_texture(coarse, size=256, detail=fine, map="normal")
    mapped = laid(coarse, coarse.texcoords, normal=picture(found.image))
    light = (0.6, 0, 0.8)
    shown = bake_texture(mapped, "lambert", size=256, light=light).image.astype(float)
    wanted = bake_texture(coarse, "lambert", size=256, detail=fine, light=light).image
    assert np.sqrt(np.mean((shown - wanted) ** 2)) < 1.5


@pytest.mark.parametrize("cage", [0, -1, "much", "3px", float("nan")])
def test_a_cage_that_is_no_length_is_refused(cage):
    with pytest.raises(MeshdepictError, match=r"cage=.* is not a positive length"):
        FinerSurface(sheet(1), sheet(2), cage)


def test_a_mesh_that_lies_elsewhere_is_refused():
    there = Mesh(np.add(sheet(2).vertices, (0, 30, 0)), sheet(2).faces)
    with pytest.raises(MeshdepictError, match="lies elsewhere"):
        bake_texture(sheet(1), size=64, detail=there)
