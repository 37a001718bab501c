"""Exaggerated Shading of terrain: every scale under the horizontal part of one light (ES §2–3)."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import HeightField, MeshdepictError


def terrain(rows=60, columns=70):
    rng = np.random.default_rng(0)
    y, x = np.mgrid[:rows, :columns]
    return HeightField(3 * np.sin(x / 9.0) * np.cos(y / 7.0) + 0.1 * rng.normal(size=x.shape))


def test_it_is_the_papers_sum_of_soft_toons():
    space = md.scale_space(terrain(), scales=3)
    light = np.array([-1, 1, 1]) / np.sqrt(3)
    found = md.shading.exaggerated(space, light, exaggeration=5, base=1, contrast=1, one_light=True)
    flat = np.array([-1, 1, 0]) / np.sqrt(2)
    weights = np.array([space.finest_width, *space.widths[1:]]) ** -0.5
    weights /= weights.sum()
    sums = sum(
        k * np.clip(5 * (n @ flat), -1, 1) for k, n in zip(weights, space.normals, strict=True)
    )
    np.testing.assert_allclose(found, 0.5 + 0.5 * sums, atol=1e-6)


def test_level_ground_is_mid_grey_under_any_light():
    field = HeightField(np.zeros((20, 20)))
    for light in ("north", (315, 45), (10, 80)):
        assert (md.bake(field, light=light, exaggeration=40).intensity == 0.5).all()


def test_the_height_of_the_light_changes_nothing_but_from_above():
    field = terrain()
    low, high = (md.bake(field, light=(315, h)).intensity for h in (5, 80))
    np.testing.assert_allclose(low, high, atol=1e-5)
    assert np.ptp(md.bake(field, light="front").intensity) == 0


def test_bakes_of_terrain_take_it_and_of_meshes_do_not():
    field = terrain()
    on_field, on_mesh = md.bake(field), md.bake(field.mesh)
    assert on_field.look.options["one_light"] is True
    assert "one_light" not in on_mesh.look.options
    general = md.bake(field, one_light=False)
    assert np.abs(general.intensity - on_field.intensity).mean() > 0.05


def test_a_mesh_of_the_ground_gives_the_same_relief():
    field = HeightField(0.03 * terrain().z)  # slopes below 5 degrees
    words = {"one_light": True, "exaggeration": 5.0, "base": 1.0, "contrast": 1.0, "scales": 5}
    flat = md.bake(field, facing=0, width=1.0, **words).intensity
    mesh = md.bake(field.mesh, facing=0, width=1.0, light=md.bake(field).look.light, **words)
    inner = field.sample(np.pad(np.ones((20, 30), bool), 20))
    assert 255 * np.abs(flat - mesh.intensity)[inner].max() < 2


def test_a_closed_mesh_has_no_level_ground():
    space = md.scale_space(md.samples.sphere(500), scales=2)
    with pytest.raises(MeshdepictError, match="no level ground"):
        md.shading.exaggerated(space, "north", one_light=True)


def test_what_each_scales_light_would_need_is_refused():
    space = md.scale_space(terrain(), scales=2)
    with pytest.raises(MeshdepictError, match="focus and principal_strength"):
        md.shading.exaggerated(space, "north", one_light=True, principal_strength=1)


@pytest.mark.parametrize("word", [True, "true"])
def test_it_is_set_by_a_word_or_a_truth(word):
    field = terrain()
    again = md.bake(field, one_light=word)
    assert np.array_equal(again.colors, md.bake(field).colors)
    with pytest.raises(MeshdepictError, match="one_light='maybe'"):
        md.bake(field, one_light="maybe")


def test_as_many_exaggerations_as_scales_with_the_coarsest():
    space = md.scale_space(terrain(), scales=2)
    assert len(md.shading.exaggerated(space, "north", one_light=True, exaggeration=(1, 2, 3)))
    with pytest.raises(MeshdepictError, match="3 scales"):
        md.shading.exaggerated(space, "north", one_light=True, exaggeration=(1, 2))


def test_the_fit_saturates_the_same_share_on_flat_and_steep_ground():
    for height in (0.005, 0.5):
        field = HeightField(height * terrain().z)
        baked = md.bake(field)
        steep = baked.look.options["exaggeration"][0]
        level = baked.space.normals[0][:, :2]
        turns = np.linspace(0, 2 * np.pi, 64, endpoint=False)
        share = np.mean(steep * np.abs(level @ np.stack([np.cos(turns), np.sin(turns)])) >= 1)
        assert share == pytest.approx(0.08, abs=0.02)
