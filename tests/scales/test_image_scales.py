"""The scale space of a G-buffer: its filters, its agreement with the mesh's, every method on it."""

import numpy as np
import pytest
from conftest import angle_between, rotation
from method_families import ON_MESHES

from meshdepict import samples, scale_space
from meshdepict.errors import MeshdepictError
from meshdepict.options import options_of
from meshdepict.scales.diffusion import diffusion_width
from meshdepict.scales.image_scales import FILTERS, image_space
from meshdepict.scene.names import as_light
from meshdepict.scene.view import View
from meshdepict.shading import METHODS, declaration
from meshdepict.shapes.gbuffer import GBuffer

every_method = pytest.mark.parametrize("method", ON_MESHES)
SIZE = (64, 48)


@pytest.fixture(scope="module")
def golf_ball():
    return samples.golf_ball(6_000)


@pytest.fixture(scope="module")
def buffer(golf_ball):
    return GBuffer.of(golf_ball, "front", size=(160, 160))


def shade(method, space, light="northwest", **options):
    function = METHODS[method]
    if "view" in declaration(function).needs:
        options["view"] = space.shape.view
    if "rays" in options_of(function):
        options["rays"] = 16
    return function(space, as_light(light, space.shape.view), **options)


def assert_proper(values, count):
    assert values.shape in ((count,), (count, 3))
    assert np.isfinite(values).all()
    assert values.min() >= 0
    assert values.max() <= 1


# --- scales -----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["bilateral", "diffusion"])
def test_scales_are_what_was_asked_for(buffer, kind):
    done = []
    space = image_space(buffer, scales=3, filter=kind, progress=lambda *step: done.append(step))
    np.testing.assert_allclose(space.widths / buffer.edge_length, [0, 1, 1.7, 2.89])
    assert space.ratio == 1.7
    assert space.filter == kind
    assert done == [(1, 3), (2, 3), (3, 3)]
    assert space.normals.shape == (4, len(buffer.normals), 3)
    np.testing.assert_allclose(space.normals[0], buffer.normals, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(space.normals, axis=2), 1, atol=1e-6)
    assert image_space(buffer, width="1%").widths[1] == pytest.approx(buffer.diagonal / 100)


def test_without_a_filter_there_are_the_original_normals_alone(buffer):
    space = image_space(buffer, filter="none")
    assert len(space.widths) == 1
    assert space.normals.shape[0] == 1


@pytest.mark.parametrize("kind", FILTERS)
def test_constant_normals_stay_constant(kind):
    normals = np.broadcast_to([0.36, 0.48, 0.8], (20, 30, 3))
    depth = np.arange(600.0).reshape(20, 30) % 30
    space = image_space(GBuffer.from_images(normals, depth), filter=kind)
    np.testing.assert_allclose(space.normals - space.normals[:, :1], 0, atol=1e-6)
    np.testing.assert_allclose(space.normals[-1, 0], (0.36, 0.48, 0.8), atol=1e-6)


@pytest.mark.parametrize("kind", ["bilateral", "diffusion"])
def test_surfaces_that_hide_each_other_do_not_mix(kind):
    # Two tilted plates, one far behind the other.
    left = np.arange(40) < 20
    normals = np.where(left[:, None], [0.6, 0, 0.8], [-0.6, 0, 0.8])[None].repeat(30, axis=0)
    depth = np.where(left, 100.0, 1000.0)[None].repeat(30, axis=0)
    space = image_space(GBuffer.from_images(normals, depth), filter=kind)
    np.testing.assert_allclose(space.normals[-1], space.normals[0], atol=1e-6)
    # At one depth they do. Diffusion stops at their edge, of 74°, too.
    flat = image_space(GBuffer.from_images(normals, 0 * depth), filter=kind)
    mixed = np.abs(flat.normals[-1] - flat.normals[0]).max() > 0.3
    assert mixed == (kind == "bilateral")


def test_the_depths_range_can_be_widened():
    left = np.arange(40) < 20
    normals = np.where(left[:, None], [0.6, 0, 0.8], [-0.6, 0, 0.8])[None].repeat(30, axis=0)
    depth = np.where(left, 100.0, 1000.0)[None].repeat(30, axis=0)
    space = image_space(GBuffer.from_images(normals, depth), depth_range=np.inf)
    assert np.abs(space.normals[-1] - space.normals[0]).max() > 0.3


@pytest.mark.parametrize("kind", ["bilateral", "diffusion"])
@pytest.mark.parametrize("factor", [1e-140, 1e140])
def test_units_do_not_matter(golf_ball, kind, factor):
    plain = GBuffer.of(golf_ball, "front", size=SIZE)
    view = plain.view
    scaled = GBuffer(
        View(
            view.position * factor, view.focus * factor, view.up,
            parallel_scale=view.parallel_scale * factor,
        ),
        plain.mask, plain.normals, plain.depths * factor,
    )  # fmt: skip
    one, two = (image_space(b, filter=kind) for b in (plain, scaled))
    np.testing.assert_allclose(one.normals, two.normals, atol=1e-5)
    np.testing.assert_allclose(one.curvature(1).k1, two.curvature(1).k1 * factor, atol=1e-3)


@pytest.mark.parametrize("kind", ["bilateral", "diffusion"])
def test_where_the_eye_stands_on_its_axis_does_not_matter(golf_ball, kind):
    near = View.fitted("front", golf_ball, height_px=48)
    far = View(
        near.position + 1e4 * near.towards_eye, near.focus, near.up,
        height_px=48, parallel_scale=near.parallel_scale,
    )  # fmt: skip
    one, two = (image_space(GBuffer.of(golf_ball, v, size=SIZE), filter=kind) for v in (near, far))
    np.testing.assert_allclose(one.normals, two.normals, atol=1e-4)
    seen, same = one.view_curvature(near), two.view_curvature(far)
    np.testing.assert_allclose(seen.weight, same.weight, atol=1e-4)


def test_the_pyramid_agrees_with_the_meshs_scale_space(bunny):
    # What is 1D in depth there is a Gaussian in space too, but the mesh also has hidden parts
    # and weighs slopes by their area.
    buffer = GBuffer.of(bunny, "front", size=(400, 400))
    image = image_space(buffer, scales=3, width=2 * buffer.edge_length)
    mesh = scale_space(bunny, scales=3, width=float(image.widths[1]), ratio=1.7, tolerance=1e-3)
    facing = buffer.normals @ buffer.view.towards_eye > 0.5
    for scale, median in ((1, 0.5), (2, 0.7), (3, 1.5)):
        sampled = buffer.sample(mesh.normals[scale])
        sampled = sampled / np.linalg.norm(sampled, axis=1, keepdims=True)
        angle = np.degrees(angle_between(image.normals[scale], sampled))[facing]
        assert np.median(angle) < median
        assert np.quantile(angle, 0.9) < 4 * median


def test_iterations_are_a_width(buffer):
    space = image_space(buffer, filter="diffusion", iterations=10)
    assert space.widths[1] == pytest.approx(diffusion_width(10) * buffer.edge_length)
    same = image_space(buffer, filter="diffusion", scales=1, width=float(space.widths[1]))
    np.testing.assert_allclose(space.normals, same.normals, atol=1e-6)


def test_importance_keeps_detail(buffer, rng):
    plain, whole = (
        image_space(buffer, filter="diffusion", iterations=10, importance=importance)
        for importance in (None, np.zeros(buffer.mask.shape))
    )
    np.testing.assert_allclose(plain.normals, whole.normals, atol=1e-6)
    share = (rng.random(len(buffer.normals)) < 0.5).astype(float)
    mixed = image_space(buffer, filter="diffusion", iterations=10, importance=share)
    kept = share == 1
    facing = buffer.normals @ buffer.view.towards_eye > 0.02
    np.testing.assert_allclose(
        mixed.normals[1][kept & facing], mixed.normals[0][kept & facing], atol=1e-5
    )
    np.testing.assert_allclose(mixed.normals[1][~kept], plain.normals[1][~kept], atol=1e-6)


# --- what methods ask for ---------------------------------------------------------------------


def test_the_mean_is_a_gaussian_over_the_mask(buffer, rng):
    space = image_space(buffer, scales=0)
    values = rng.random(len(buffer.normals))
    width = 3 * buffer.edge_length
    rows, columns = np.nonzero(buffer.mask)
    place = np.stack([rows, columns], axis=1)
    found = space.mean(values, width)
    for i in rng.integers(0, len(values), 20):
        squared = ((place - place[i]) ** 2).sum(axis=1)
        weights = np.exp(-squared / 18)
        assert found[i] == pytest.approx((weights * values).sum() / weights.sum(), abs=1e-3)
    np.testing.assert_allclose(space.mean(np.ones(len(values)), 1e3), 1)


def test_rays_meet_the_mesh(buffer, golf_ball):
    space = image_space(buffer, scales=0)
    assert space.surface is golf_ball
    baked = buffer.sample(scale_space(golf_ball, scales=0).occlusion(256))
    assert np.abs(space.occlusion(256) - baked).mean() < 0.03


@every_method
@pytest.mark.parametrize("kind", ["bilateral", "diffusion"])
def test_every_method_runs_on_pixels(buffer, method, kind):
    space = image_space(buffer, scales=2, filter=kind)
    values = shade(method, space)
    assert_proper(values, len(buffer.normals))
    assert np.ptp(values) > 0.05
    assert buffer.image(values).shape[:2] == buffer.mask.shape


@every_method
@pytest.mark.parametrize("kind", ["bilateral", "diffusion"])
def test_turning_shape_light_and_view_together_changes_nothing(golf_ball, method, kind, rng):
    if "surface" in declaration(METHODS[method]).needs:
        pytest.skip("its random rays depend on positions; it is the mesh's own")
    plain, turn = GBuffer.of(golf_ball, "isometric", size=SIZE), rotation(rng)
    view, open_to_light = plain.view, np.linspace(0, 1, len(plain.normals))
    eye = View(
        turn @ view.position, turn @ view.focus, turn @ view.up,
        parallel_scale=view.parallel_scale,
    )  # fmt: skip
    buffers = (
        GBuffer(view, plain.mask, plain.normals, plain.depths, openness=open_to_light),
        GBuffer(eye, plain.mask, plain.normals @ turn.T, plain.depths, openness=open_to_light),
    )
    one, two = (shade(method, image_space(b, scales=2, filter=kind)) for b in buffers)
    np.testing.assert_allclose(two, one, atol=1 / 255)


@pytest.mark.parametrize("method", ["light_warping", "radiance_scaling", "mean_curvature"])
@pytest.mark.parametrize("view", [0, 1])
def test_curvature_seen_by_the_view_can_be_shaded(golf_ball, method, view):
    eye = View((1, 1.5, 3), (0, 0, 0), (0, 1, 0), field_of_view=40)
    buffer = GBuffer.of(golf_ball, ["isometric", eye][view], size=SIZE)
    values = shade(method, image_space(buffer, scales=2), curvature="view")
    assert_proper(values, len(buffer.normals))


ODD = {
    "one pixel": (np.array([[[0.0, 0, 1]]]), np.array([[1.0]])),
    "one row": (np.array([[[0.0, 0, 1], [0.6, 0, 0.8], [0, 0.6, 0.8]]]), np.ones((1, 3))),
    "facing away": (np.array([[[0.0, 0, -1], [1, 0, 0]], [[0, 0.6, -0.8], [0, 0, 1]]]), None),
    "steps": (np.array([[[0.0, 0, 1]] * 3] * 3), np.array([[1e9, 1, 5], [2, 1e5, 3], [1, 1, 1]])),
}  # fmt: skip


@every_method
@pytest.mark.parametrize("name", ODD)
@pytest.mark.parametrize("kind", ["bilateral", "diffusion"])
def test_odd_images_get_finite_colours(method, name, kind):
    normals, depth = ODD[name]
    occlusion = np.ones(normals.shape[:2])
    buffer = GBuffer.from_images(normals, depth, occlusion=occlusion)
    space = image_space(buffer, scales=2, filter=kind)
    if "surface" in declaration(METHODS[method]).needs:
        with pytest.raises(MeshdepictError, match="rays need a surface to meet, and images have"):
            shade(method, space)
        return
    assert_proper(shade(method, space), len(buffer.normals))
    if "curvature" in options_of(METHODS[method]):
        assert_proper(shade(method, space, curvature="view"), len(buffer.normals))


def test_extreme_depth_ranges_are_finite(buffer):
    for depth_range in (1e-300, 1e300):
        space = image_space(buffer, scales=2, depth_range=depth_range)
        assert np.isfinite(space.normals).all()
    # So narrow that every pixel is alone, but for those at the very same depth.
    alone = image_space(buffer, scales=1, depth_range=1e-300)
    angle = angle_between(alone.normals[1], alone.normals[0])
    assert np.quantile(angle, 0.5) < 1e-3


@pytest.mark.filterwarnings("ignore:width")
def test_wide_widths_take_no_more_than_the_picture(buffer):
    small = GBuffer.of(buffer.mesh, "front", size=(24, 24))
    space = image_space(small, scales=2, width=1e4)
    assert np.isfinite(space.normals).all()


# --- wrong input ------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:width")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"filter": "bilatral"}, r"filter='bilatral' is not one of .*; did you mean 'bilateral'"),
        ({"iterations": 3}, "iterations and importance belong to filter='diffusion'"),
        ({"importance": 1}, "iterations and importance belong to filter='diffusion'"),
        ({"depth_range": 0}, "depth_range=0 is not a positive number"),
        ({"depth_range": "x"}, "depth_range='x' is not a positive number"),
        ({"scales": -1}, "scales=-1 is not a whole number"),
        ({"width": 0}, "width=0 is not a positive length"),
        ({"filter": "diffusion", "iterations": 0}, "iterations=0 is not a whole number from 1"),
        ({"filter": "diffusion", "iterations": 2.5}, "iterations=2.5 is not a whole number"),
        ({"filter": "diffusion", "importance": [1, 0]}, "importance must be numbers from 0 to 1"),
        ({"filter": "diffusion", "width": 1e6}, "would take .* steps of diffusion"),
    ],
)
def test_wrong_options_are_refused(buffer, options, words):
    with pytest.raises(MeshdepictError, match=words):
        image_space(buffer, **options)


def test_importance_beyond_its_range_is_refused(buffer):
    with pytest.raises(MeshdepictError, match="importance must be numbers from 0 to 1"):
        image_space(
            buffer, filter="diffusion", iterations=1, importance=2 * np.ones(buffer.mask.shape)
        )


def test_only_g_buffers_are_smoothed_in_the_picture(golf_ball):
    with pytest.raises(MeshdepictError, match="image_space smooths a GBuffer, not a Mesh"):
        image_space(golf_ball)


def test_images_without_a_mesh_have_no_rays():
    buffer = GBuffer.from_images(np.array([[[0.0, 0, 1]]]))
    with pytest.raises(MeshdepictError, match="give from_images an occlusion image"):
        image_space(buffer, scales=0).occlusion()


def test_what_an_image_lacks_is_said_of_an_image():
    space = scale_space(GBuffer.of(samples.sphere(300), "front", size=(24, 24)), scales=1)
    with pytest.raises(MeshdepictError, match="and an image has none"):
        METHODS["local_dominance"](space, "north")
    with pytest.raises(MeshdepictError, match=r"^an image has no level ground"):
        METHODS["exaggerated"](space, "north", one_light=True)
