"""Methods from maps: identities on terrain of known shape, and what any method promises there."""

from __future__ import annotations

import math

import numpy as np
import pytest
from grounds import hill
from method_families import ON_RASTERS

import meshdepict as md
from meshdepict import shading
from meshdepict.errors import MeshdepictError
from meshdepict.heights.deviation import deviations
from meshdepict.heights.horn import mark_relief
from meshdepict.options import options_of
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.seen_side import SeenSide
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.names import as_view
from meshdepict.shapes.height_field import HeightField

MAPS = (
    "hillshade", "multidirectional_hillshade", "sky_view", "positive_openness",
    "negative_openness", "integral_invariant", *ON_RASTERS,
)  # fmt: skip
every_map = pytest.mark.parametrize("name", MAPS)
on_rasters = pytest.mark.parametrize("name", ON_RASTERS)
NORTHWEST = (-0.5, 0.5, math.sqrt(0.5))


def space_of(z: np.ndarray, **given: object) -> ScaleSpace:
    return md.scale_space(HeightField(z, **given), scales=0)  # type: ignore[arg-type]


def overhead(name: str) -> dict[str, str]:
    return {"sky": "overhead"} if name == "sky_view" else {}


@pytest.fixture
def rough(rng: np.random.Generator) -> np.ndarray:
    """A hill under noise."""
    y, x = np.mgrid[:60, :70] - 30.0
    return hill(x, y, width=12.0, height=20.0)[0] + rng.normal(0, 0.2, (60, 70))


@pytest.fixture
def gaps(rng: np.random.Generator) -> np.ndarray:
    valid = rng.random((60, 70)) > 0.1
    valid[20:30, 40:55] = False
    return valid


# --- as a family --------------------------------------------------------------------------------


@every_map
def test_values_are_proper_and_there_for_every_sample(
    name: str, rough: np.ndarray, gaps: np.ndarray
) -> None:
    space = space_of(rough, valid=gaps)
    values = shading.METHODS[name](space, NORTHWEST, **overhead(name))
    assert values.shape in ((gaps.sum(),), (gaps.sum(), 3))
    assert np.isfinite(values).all()
    assert values.min() >= 0
    assert values.max() <= 1
    assert np.ptp(values) > 0.1
    again = shading.METHODS[name](space, NORTHWEST, **overhead(name))
    np.testing.assert_array_equal(again, values)


@every_map
def test_exposure_multiplies_before_the_last_clip(name: str, rough: np.ndarray) -> None:
    space, more = space_of(rough), overhead(name)
    plain = shading.METHODS[name](space, NORTHWEST, **more)
    assert not shading.METHODS[name](space, NORTHWEST, exposure=0, **more).any()
    quarter = shading.METHODS[name](space, NORTHWEST, exposure=0.25, **more)
    np.testing.assert_allclose(np.minimum(4 * quarter, 1), plain, atol=1e-6)


@every_map
@pytest.mark.parametrize("shape", [(1, 12), (12, 1), (1, 1), (2, 2)])
def test_rows_and_single_cells_have_a_shade(name: str, shape: tuple[int, int]) -> None:
    z = np.arange(shape[0] * shape[1], dtype=float).reshape(shape)
    values = shading.METHODS[name](space_of(z), NORTHWEST, **overhead(name))
    assert np.isfinite(values).all()


@every_map
def test_what_the_cells_without_a_height_are_does_not_matter(
    name: str, rough: np.ndarray, gaps: np.ndarray
) -> None:
    found = [
        shading.METHODS[name](
            space_of(np.where(gaps, rough, other), valid=gaps), NORTHWEST, **overhead(name)
        )
        for other in (-9999.0, 1e6)
    ]
    np.testing.assert_array_equal(*found)


@every_map
def test_far_above_the_sea_is_as_at_the_shore(name: str, rough: np.ndarray) -> None:
    low, high = (
        shading.METHODS[name](space_of(rough + offset), NORTHWEST, **overhead(name))
        for offset in (0, 1e6)
    )
    np.testing.assert_allclose(high, low, atol=1e-4)


@every_map
def test_a_raster_from_the_south_has_the_same_picture(name: str, rough: np.ndarray) -> None:
    north = HeightField(rough, transform=(2, 0, 0, 0, -2, 0))
    south = HeightField(rough[::-1], transform=(2, 0, 0, 0, 2, -2 * len(rough)))
    up, down = (
        field.image(shading.METHODS[name](md.scale_space(field, scales=0), NORTHWEST,
                                          **overhead(name)))
        for field in (north, south)
    )  # fmt: skip
    # The toolbox rounds a ring's cells that lie half way between two, as it happens to.
    off = 0.1 if name == "local_dominance" else 1e-3
    np.testing.assert_allclose(down[::-1], up, atol=off)


@every_map
def test_chosen_samples_and_those_of_the_seen_side_have_the_shade_of_the_whole(
    name: str, rough: np.ndarray, rng: np.random.Generator
) -> None:
    if name in ("sky_view", "positive_openness", "negative_openness"):
        pytest.skip("rays go from some samples of a surface, horizons from all of them")
    space = space_of(rough)
    method = shading.METHODS[name]
    whole = method(space, NORTHWEST)
    some = rng.permutation(len(whole))[:500]
    np.testing.assert_allclose(
        method(ChosenSamples(space, some), NORTHWEST), whole[some], atol=1e-5
    )
    above = SeenSide(space, as_view("front", space.shape))
    np.testing.assert_allclose(method(above, NORTHWEST), whole, atol=1e-5)


@on_rasters
@pytest.mark.parametrize("kind", ["mesh", "image", "volume"])
def test_what_is_about_rasters_is_refused_elsewhere(name: str, kind: str) -> None:
    ball = md.samples.golf_ball(300, dimples=12)
    shapes = {
        "mesh": ball, "image": md.GBuffer.of(ball, "front", size=(12, 12)),
        "volume": md.samples.ct_phantom((8, 8, 8)),
    }  # fmt: skip
    one = {"mesh": "a mesh", "image": "an image", "volume": "a volume"}[kind]
    with pytest.raises(MeshdepictError, match=f"heights on a raster are needed, and {one} has"):
        shading.METHODS[name](md.scale_space(shapes[kind], scales=0), "north")


# --- each by itself -------------------------------------------------------------------------------


def test_hillshade_of_a_mesh_is_the_cosine_and_of_terrain_the_planes() -> None:
    ball = md.scale_space(md.samples.golf_ball(300, dimples=12), scales=0)
    cosine = ball.normals_at(0) @ np.array(NORTHWEST)
    np.testing.assert_allclose(shading.hillshade(ball, NORTHWEST), np.clip(cosine, 0, 1), atol=1e-6)
    z = np.add.outer(-0.7 * np.arange(20), 0.3 * np.arange(30))  # rises to the north, and east
    normal = np.array([-0.3, -0.7, 1]) / math.sqrt(1 + 0.3**2 + 0.7**2)
    np.testing.assert_allclose(
        shading.hillshade(space_of(z), NORTHWEST), normal @ NORTHWEST, atol=1e-6
    )


def test_both_ways_to_marks_shade_agree(rough: np.ndarray) -> None:
    space = space_of(rough)
    generic = super(type(space), space).grazing_relief(np.eye(3), 30.0)
    np.testing.assert_allclose(
        generic, mark_relief(rough, None, space.shape.steps).ravel(), atol=1e-6
    )
    np.testing.assert_allclose(shading.multidirectional_hillshade(space, None), generic, atol=1e-6)
    relief = super(type(space), space).relief(np.array(NORTHWEST))
    np.testing.assert_allclose(relief, space.relief(np.array(NORTHWEST)), atol=1e-6)


@pytest.mark.parametrize("frame", ["front", "right", "isometric"])
def test_lights_of_a_mesh_stand_about_the_view(frame: str) -> None:
    """A plate that faces the eye is lit by the sine of the lights' height, whatever the view."""
    eye = as_view(frame, md.samples.golf_ball(300, dimples=12))
    right, up, _ = eye.frame
    plate = md.Mesh([-right - up, right - up, right + up, up - right], [[0, 1, 2], [0, 2, 3]])
    shade = shading.multidirectional_hillshade(
        md.scale_space(plate, scales=0), None, view=eye, elevation=40.0
    )
    np.testing.assert_allclose(shade, math.sin(math.radians(40)), atol=1e-6)


@pytest.mark.parametrize("name", ["positive_openness", "negative_openness"])
def test_a_plane_is_ninety_degrees_open_with_horizons_and_with_rays(name: str) -> None:
    z = np.add.outer(0.2 * np.arange(40), 0.3 * np.arange(40))
    field = HeightField(z)
    inner = field.sample(np.pad(np.ones((16, 16), bool), 12))
    for shape, off in ((field, 1e-4), (field.mesh, 2.0)):
        space = md.scale_space(shape, scales=0)
        method = shading.METHODS[name]
        open_ = method(space, None, rays=1024, least=0.0, most=180.0) * 180
        # Rays end after ten cells, on a slope of 20° at one that's 0.2 cells away or more.
        np.testing.assert_allclose(open_[inner], 90, atol=off)


def test_rays_see_as_much_sky_as_horizons_leave() -> None:
    y, x = np.mgrid[:60, :60] - 29.5
    field = HeightField(-hill(x, y, width=8.0, height=15.0)[0])
    inner = field.sample(np.pad(np.ones((36, 36), bool), 12))
    found = [
        shading.sky_view(md.scale_space(shape, scales=0), None, rays=4096, sky="overhead")[inner]
        for shape in (field, field.mesh)
    ]
    np.testing.assert_allclose(*found, atol=0.03)
    assert np.ptp(found[0]) > 0.3
    opened = [
        shading.positive_openness(
            md.scale_space(shape, scales=0), None, rays=4096, least=0.0, most=180.0
        )[inner] * 180
        for shape in (field, field.mesh)
    ]  # fmt: skip
    np.testing.assert_allclose(*opened, atol=2)


def test_a_bake_of_terrain_takes_the_sky_overhead_and_one_of_a_mesh_the_light(
    rough: np.ndarray,
) -> None:
    field = HeightField(rough)
    plain, east = (md.bake(field, "sky_view", light=light) for light in ("northwest", "east"))
    np.testing.assert_array_equal(plain.intensity, east.intensity)
    assert "sky=overhead" in plain.provenance["options"]
    under = shading.sky_view(plain.space, (0, 0, 1), rays=64)
    lit = md.bake(field, "sky_view", light=(0, 0, 1), rays=64, sky="light")
    np.testing.assert_array_equal(lit.intensity, under)
    ball = md.samples.golf_ball(300, dimples=12)
    both = (md.bake(ball, "sky_view", light=light).intensity for light in ("northwest", "east"))
    assert np.ptp(np.subtract(*both)) > 0.1


def test_a_smaller_radius_sees_more_sky(rough: np.ndarray) -> None:
    space = md.scale_space(HeightField(rough).mesh, scales=0)
    near, far = (
        shading.sky_view(space, (0, 0, 1), rays=64, radius=radius) for radius in (2.0, None)
    )
    assert (near >= far).all()
    assert near.mean() > far.mean() + 0.005
    everything = shading.sky_view(space, (0, 0, 1), rays=64, radius=1e6)
    np.testing.assert_array_equal(everything, far)


@pytest.mark.parametrize("name", ["sky_view", "positive_openness"])
def test_cells_are_about_terrain(name: str) -> None:
    ball = md.scale_space(md.samples.golf_ball(300, dimples=12), scales=0)
    with pytest.raises(MeshdepictError, match="horizon='cells' is about cells of terrain, and a"):
        shading.METHODS[name](ball, "north", horizon="cells", **overhead(name))
    if name == "sky_view":
        with pytest.raises(MeshdepictError, match="is about the sky overhead: set sky=overhead"):
            shading.sky_view(ball, "north", horizon="cells")


@pytest.mark.parametrize("name", ["positive_openness", "negative_openness"])
def test_a_grey_scale_without_a_width_is_refused(name: str, rough: np.ndarray) -> None:
    with pytest.raises(MeshdepictError, match=f"{name}: least=95 is not below most=95"):
        shading.METHODS[name](space_of(rough), None, least=95.0, most=95.0)


def test_crests_are_open_and_channels_are_not() -> None:
    ridge = -np.abs(np.arange(-20, 21.0))[:, None] * np.ones(30)
    for name in ("positive_openness", "negative_openness", "texture_shading", "local_dominance"):
        method = shading.METHODS[name]
        up, down = (
            method(space_of(sign * ridge), None).reshape(ridge.shape)[20, 10:20] for sign in (1, -1)
        )
        assert (up > down + 0.2).all()


def test_texture_is_measured_by_its_own_spread_unless_told_otherwise(rough: np.ndarray) -> None:
    field = HeightField(rough)
    baked = md.bake(field, "texture_shading")
    tall = md.bake(HeightField(7 * rough), "texture_shading")
    np.testing.assert_allclose(tall.intensity, baked.intensity, atol=2e-3)
    reference = float(baked.look.options["reference"])
    fixed = md.bake(HeightField(7 * rough), "texture_shading", reference=7 * reference)
    np.testing.assert_allclose(fixed.intensity, baked.intensity, atol=1e-4)
    level = md.bake(HeightField(np.full((9, 9), 5.0)), "texture_shading")
    np.testing.assert_array_equal(level.intensity, 0.5)
    assert shading.texture_shading.declaration.fits(None, {}) == {"reference": 0.3}


def test_position_is_broad_red_meso_green_local_blue(rough: np.ndarray) -> None:
    colour = shading.topographic_position(space_of(rough), None, broad=20, meso=6, local=2)
    for channel, radius in enumerate((20, 6, 2)):
        expected = 1 - np.exp(-1.2 * np.abs(deviations(rough, None, radius)))
        np.testing.assert_allclose(colour[:, channel], expected.ravel(), atol=1e-6)
    np.testing.assert_array_equal(shading.topographic_position(space_of(0 * rough), None), 0)


def test_dominance_shows_level_land_where_one_lies_and_refuses_turned_rings() -> None:
    level = space_of(np.zeros((50, 50)))
    np.testing.assert_allclose(shading.local_dominance(level, None), 0.5 / 1.3, atol=1e-5)
    with pytest.raises(MeshdepictError, match="nearest=9 is beyond farthest=8"):
        shading.local_dominance(level, None, nearest=9, farthest=8)
    with pytest.raises(MeshdepictError, match="darkest=1 is not below brightest=1"):
        shading.local_dominance(level, None, darkest=1.0, brightest=1.0)


def test_steep_land_has_a_white_of_its_own_which_is_written_down(rough: np.ndarray) -> None:
    steep = md.bake(HeightField(30 * rough), "local_dominance")
    white = float(steep.look.options["brightest"])
    assert white > 1.8
    assert 0.02 < (steep.intensity == 1).mean() < 0.08
    gentle = md.bake(HeightField(0.01 * rough), "local_dominance")
    assert float(gentle.look.options["brightest"]) == 1.8
    assert shading.local_dominance.declaration.fits(None, {}) == {"brightest": 1.8}


@pytest.mark.parametrize("depth", [0.1, 1.0])
@pytest.mark.parametrize("half", [0, 1, 3])
def test_the_invariant_of_a_plane_is_grey_and_of_a_scratch_dark(half: int, depth: float) -> None:
    z = np.zeros((60, 60))
    plate = shading.integral_invariant(space_of(z), None)
    np.testing.assert_array_equal(plate, 0.5)
    z -= depth * np.maximum(1 - np.abs(np.arange(60) - 30) / (half + 1), 0)[:, None]
    for shape in (HeightField(z), HeightField(z).mesh):
        space = md.scale_space(shape, scales=0)
        tone = shading.integral_invariant(space, None, radius=6.0).reshape(z.shape)
        assert (tone[30, 10:50] < 0.3).all()
        assert (tone[28 - half, 10:50] > 0.5).all()
        np.testing.assert_allclose(tone[10:20, 10:50], 0.5, atol=1e-3)


def test_the_invariants_contrast_fits_the_shape_and_is_written_down(rough: np.ndarray) -> None:
    baked = md.bake(HeightField(rough), "integral_invariant")
    assert float(baked.look.options["contrast"]) > 0
    clipped = (baked.intensity == 0) | (baked.intensity == 1)
    assert 0.01 < clipped.mean() < 0.03
    assert shading.integral_invariant.declaration.fits(None, {}) == {"contrast": 5.0}
    low = shading.integral_invariant(baked.space, None, contrast=0.0)
    np.testing.assert_array_equal(low, 0.5)


def test_the_sphere_of_the_formula_has_its_shade() -> None:
    globe = md.samples.sphere(10_000)
    radius = 0.5 / globe.edge_length
    tone = shading.integral_invariant(
        md.scale_space(globe, scales=0), None, radius=radius, balls=1, contrast=1.0
    )
    np.testing.assert_allclose(1 - tone, 0.406, atol=1e-3)


def test_rays_have_one_meaning_and_one_default() -> None:
    names = [name for name in MAPS if "rays" in options_of(shading.METHODS[name])]
    assert set(names) == {"sky_view", "positive_openness", "negative_openness"}
    assert {options_of(shading.METHODS[name])["rays"].default for name in names} == {256}
