"""Tints by height: what is high, of every kind of shape, and what the colours do to the shading."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.tinting import heights_of
from meshdepict.color import multiply_albedo
from meshdepict.color.tints import parsed_tint, tint_colors, tint_table
from meshdepict.errors import MeshdepictError
from meshdepict.scales.making import scale_space
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.height_field import HeightField

COLUMNS, ROWS = np.meshgrid(np.arange(40.0), np.arange(30.0))


@pytest.fixture(scope="module")
def hills():
    z = 100 + 4 * np.sin(COLUMNS / 4) * np.cos(ROWS / 5) + COLUMNS / 9
    z[3:7, 5:9] = np.nan
    return HeightField(z)


@pytest.mark.parametrize("method", ["lambert", "exaggerated", "gooch"])
def test_a_tint_multiplies_shading_in_linear_light(hills, method):
    plain = md.bake(hills, method)
    found = md.bake(hills, method, tint="earth")
    colours = tint_colors(hills.points[:, 2], "earth")
    np.testing.assert_array_equal(
        found.colors, multiply_albedo(plain.colors / np.float32(255), colours, linear=False)
    )
    np.testing.assert_array_equal(found.intensity, plain.intensity)


def test_where_all_light_arrives_the_tint_is_seen(hills):
    level = HeightField(np.where(hills.valid, 5.0, np.nan))
    found = md.bake(level, "slope", tint="swiss")  # white
    np.testing.assert_array_equal(np.unique(found.colors, axis=0), tint_table("swiss")[128:129])
    assert found.look.tint == "swiss"  # one height is no span
    steps = HeightField(np.repeat([[0.0], [10.0]], 4, axis=0).repeat(3, axis=1))
    colors = md.bake(steps, "ambient_occlusion", rays=2, tint="earth:0..10", exposure=1e6).colors
    np.testing.assert_array_equal(colors[[0, -1]], tint_table("earth")[[0, 255]])


def test_the_span_is_that_of_all_heights_unless_chosen(hills):
    baked = md.bake(hills, "lambert", tint="earth")
    heights = hills.points[:, 2]
    name, span = parsed_tint(baked.look.tint)
    assert (name, span) == ("earth", (heights.min(), heights.max()))
    assert baked.provenance["tint"] == baked.look.tint
    # A part in the look of the whole has the colours of the whole.
    part = hills.window(slice(10, 25), slice(4, 30))
    alone = baked.look.replace(method="slope").bake(part)
    whole = baked.look.replace(method="slope").bake(hills)
    inner = np.s_[1:-1, 1:-1]
    np.testing.assert_array_equal(
        part.image(alone.colors)[inner], hills.image(whole.colors)[10:25, 4:30][inner]
    )
    chosen = md.bake(hills, "lambert", tint=("earth", 100, 102.5))
    assert chosen.provenance["tint"] == "earth:100..102.5"


def test_raised_ground_keeps_its_own_heights(hills):
    one, other = (md.bake(hills, "lambert", tint="earth", z_factor=f) for f in (1, 3))
    assert parsed_tint(other.look.tint)[1] == pytest.approx(parsed_tint(one.look.tint)[1])
    white = {"exposure": 1e6, "tint": "earth"}
    flat, raised = (md.bake(hills, "half_lambert", z_factor=f, **white) for f in (1, 3))
    np.testing.assert_allclose(flat.colors.astype(int), raised.colors, atol=1)
    space = scale_space(hills.raised(3), scales=0)
    made = md.bake(space, "lambert", tint="earth").look.tint
    assert parsed_tint(made)[1] == pytest.approx(parsed_tint(one.look.tint)[1])


def test_the_ground_as_a_mesh_has_the_same_heights(hills):
    mesh = hills.mesh
    for shape in (mesh, md.Mesh(mesh.vertices[:, [1, 2, 0]], mesh.faces)):
        space = scale_space(shape, scales=0)
        np.testing.assert_allclose(heights_of(space, "y"), hills.points[:, 2])


def test_an_object_is_as_high_as_its_axis_says():
    ball = md.samples.sphere(500)
    space = scale_space(ball, scales=0)
    for up, expected in (("y", 1), ("z", 2), ("x", 0)):
        np.testing.assert_allclose(heights_of(space, up), ball.vertices[:, expected])
        np.testing.assert_allclose(heights_of(space, f"-{up}"), -ball.vertices[:, expected])
    points = np.array([[1.0, 2, 3]])
    np.testing.assert_allclose(heights_of(space, "z", points), [3])
    baked = md.bake(ball, "lambert", tint="earth", up="z")
    again = baked.look.bake(ball)
    np.testing.assert_array_equal(again.colors, baked.colors)


def test_new_vertices_are_tinted_too():
    ball = md.samples.golf_ball(400, dimples=12)
    baked = md.bake(ball, "lambert", tint="earth:-1..1", refine=8, exposure=1e6, light="front")
    lit = baked.intensity == 1
    colours = tint_colors(baked.mesh.vertices[:, 1], "earth", (-1, 1))
    assert len(baked.mesh.vertices) > len(ball.vertices)
    np.testing.assert_array_equal(baked.colors[lit], colours[lit])


def test_own_colours_are_tinted():
    ball = md.samples.sphere(200)
    paint = np.full((len(ball.vertices), 3), 128, np.uint8)
    names = ("red", "green", "blue")
    attributes = {"vertex": dict(zip(names, paint.T, strict=True))}
    painted = md.Mesh(ball.vertices, ball.faces, attributes=attributes)
    tinted = md.bake(painted, "lambert", tint="earth", albedo="keep", light="front")
    plain = md.bake(painted, "lambert", tint="earth", light="front")
    expected = multiply_albedo(plain.colors / np.float32(255), paint, linear=False)
    np.testing.assert_array_equal(tinted.colors, expected)


def test_an_image_has_no_height():
    image = GBuffer.from_images(np.tile((0.0, 0.0, 1.0), (4, 6, 1)))
    with pytest.raises(MeshdepictError, match="tint colours by height, and an image has none"):
        md.bake(image, "lambert", tint="earth")
