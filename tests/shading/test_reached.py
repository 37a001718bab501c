"""Shadows and bounces, as methods take them: limits, what is traced, and how sure it is."""

import pickle
from itertools import pairwise

import numpy as np
import pytest

import meshdepict as md
from meshdepict import shading
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.options import options_of
from meshdepict.samples.phantom import ct_phantom
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.material import AshikhminShirley, CookTorrance, Lambert, Phong, diffuse_term
from meshdepict.scene.view import View
from meshdepict.shading import METHODS
from meshdepict.shading.hidden_light import albedo, matt
from meshdepict.transport import rays as transport_rays
from meshdepict.transport import shadows, transfer

HIDING = [name for name in METHODS if "bounces" in options_of(METHODS[name])]
hiding = pytest.mark.parametrize("method", HIDING)
OWN_RAYS = {"light_warping", "light_alignment"}  # at the first bounce, beside those of the others

SIDE = (-1.0, 0.2, 0.3)
MATT = {"ambient": 0.0, "diffuse": 1.0, "specular": 0.0}  # Phong's, as Lambert


def white(brightness=1.0):
    return Environment(np.full((16, 32, 3), brightness, np.float32))


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(900)


@pytest.fixture
def space(torus):
    return md.scale_space(torus, scales=1)


@pytest.fixture
def traced(monkeypatch):
    """Every mesh that rays were to meet."""
    meshes = []
    real = transport_rays.ray_scene

    def counted(mesh):
        meshes.append(mesh)
        return real(mesh)

    for module in ("rays", "occlusion", "shadows", "transfer"):
        monkeypatch.setattr(f"meshdepict.transport.{module}.ray_scene", counted)
    return meshes


# --- what is traced ---------------------------------------------------------------------------


def test_methods_with_a_matt_material_take_them():
    known = {"lambert", "half_lambert", "phong", "cook_torrance", "radiance_scaling", *OWN_RAYS}
    assert known <= {*HIDING}


@hiding
def test_without_shadows_and_bounces_nothing_is_traced(space, traced, method):
    plain = METHODS[method](space, SIDE)
    METHODS[method](space, Light(SIDE, spread=20), rays=256)
    assert not traced
    off = METHODS[method](space, SIDE, shadows=False, bounces=0, rays=9)
    np.testing.assert_array_equal(plain, off)
    METHODS[method](space, SIDE, shadows=True)
    assert traced


@hiding
def test_a_new_light_costs_its_shadows_alone(space, monkeypatch, method):
    calls = []
    real = transfer.traced_transfer
    monkeypatch.setattr(
        transfer, "traced_transfer", lambda *a, **k: calls.append(k["rays"]) or real(*a, **k)
    )
    shade = METHODS[method]
    shade(space, SIDE, shadows=True, rays=8)
    assert not calls
    for light in (SIDE, "north", Light(SIDE, spread=10)):
        for bounces in (1, 3):
            shade(space, light, shadows=True, bounces=bounces, rays=8)
    sets = 1 + (method in OWN_RAYS)
    assert calls == [8] * sets
    shade(space, SIDE, bounces=1, rays=16)  # what light itself sends needs no other set
    assert calls == [8] * sets + [16]
    shade(space, SIDE, bounces=2, rays=16)
    assert calls == [8] * sets + [16] * sets


@pytest.mark.parametrize("method", sorted(OWN_RAYS))
def test_a_sky_that_does_not_bounce_costs_the_rays_of_its_method_alone(space, monkeypatch, method):
    calls = []
    real = transfer.traced_transfer
    monkeypatch.setattr(
        transfer, "traced_transfer", lambda *a, **k: calls.append(k["rays"]) or real(*a, **k)
    )
    METHODS[method](space, white(0.5), shadows=True, rays=8)
    assert calls == [8]
    METHODS[method](space, white(0.5), bounces=1, rays=8)
    assert calls == [8, 8]


def test_what_was_traced_goes_along_to_another_process(space):
    shading.lambert(space, SIDE, bounces=1, rays=8)
    again = pickle.loads(pickle.dumps(space))
    np.testing.assert_array_equal(again.transport(8).triangle, space.transport(8).triangle)
    assert again.light_errors == space.light_errors


# --- shadows ----------------------------------------------------------------------------------


def test_shadows_are_the_share_of_the_light_that_is_seen(space):
    for light in (Light(SIDE), Light(SIDE, spread=15)):
        seen = space.seen_share(light)
        assert 0.2 < seen.mean() < 0.8
        cosine = space.normals_at(0) @ light.direction.astype(np.float32)
        hidden = shading.lambert(space, light, shadows=True)
        np.testing.assert_allclose(hidden, np.maximum(cosine, 0) * seen, atol=1e-6)
        wrapped = shading.half_lambert(space, light, shadows=True)
        np.testing.assert_allclose(wrapped, 0.5 + 0.5 * (np.minimum(cosine, 0) + hidden), atol=1e-6)
        assert wrapped[cosine > 0].min() >= 0.5  # no part is lost in black


def test_phong_without_highlights_is_lambert_in_a_shadow_too(space):
    options = {"shadows": True, "bounces": 2, "rays": 16}
    matt = shading.phong(space, SIDE, **MATT, **options)
    np.testing.assert_allclose(matt, shading.lambert(space, SIDE, **options), atol=1e-6)


def test_a_shadow_hides_highlights_and_not_the_ambient_term(space):
    eye = View((0, 0, 5), (0, 0, 0), (0, 1, 0), parallel_scale=1.3)
    light = Light(SIDE)
    plain = shading.phong(space, light, view=eye, ambient=0.2, diffuse=0.3, specular=0.4)
    hidden = shading.phong(
        space, light, view=eye, ambient=0.2, diffuse=0.3, specular=0.4, shadows=True
    )
    seen = space.seen_share(light) > 0
    np.testing.assert_array_equal(hidden[seen], plain[seen])
    np.testing.assert_allclose(hidden[~seen], 0.2, rtol=1e-6)


def test_lights_add_up_each_with_its_shadow_and_its_colour(space):
    red, blue = Light(SIDE, color=(0.5, 0, 0)), Light((1, 0, 0.2), color=(0, 0, 0.4))
    options = {"shadows": True, "bounces": 2, "rays": 16, **MATT}
    both = shading.phong(space, [red, blue], **options)
    alone = shading.phong(space, red, **options) + shading.phong(space, blue, **options)
    np.testing.assert_allclose(both, alone, atol=1e-6)
    assert both.shape == (len(space.points), 3)


@hiding
def test_on_a_convex_object_light_is_what_it_was(sphere, method):
    space = md.scale_space(sphere, scales=1)
    plain = METHODS[method](space, SIDE)
    # Rays along the horizon graze the facets next to their vertex.
    hidden = METHODS[method](space, SIDE, shadows=True, bounces=3, rays=64)
    assert np.abs(hidden - plain).max() < 0.01


# --- bounces ----------------------------------------------------------------------------------


@hiding
def test_bounces_bring_more_light_and_never_less(space, method):
    shown = [METHODS[method](space, SIDE, bounces=k, rays=16) for k in (0, 1, 2, 5)]
    for fewer, more in pairwise(shown):
        assert (more >= fewer).all()
    assert (shown[1] > shown[0]).any()


def test_light_from_all_around_is_even_once_it_bounced_often(space):
    options = {"shadows": True, "rays": 64, **MATT}
    openness = shading.phong(space, white(0.5), bounces=0, **options)
    np.testing.assert_allclose(openness, 0.5 * space.occlusion(64), atol=1e-5)
    furnace = shading.phong(space, white(0.5), bounces=60, **options)
    np.testing.assert_allclose(furnace, 0.5, atol=2e-3)
    dark = shading.phong(space, white(0.5), bounces=60, **{**options, "diffuse": 0.5})
    assert dark.max() <= 0.25 + 1e-4  # a body that swallows half of it sends at most half of it


@pytest.mark.parametrize(
    "material",
    [CookTorrance(0.6, 0.3, 0.3), AshikhminShirley(0.7, 0.2, 20), Lambert(0.4), Phong(0, 0.7, 0)],
)
def test_even_light_that_came_around_is_shown_as_that_of_many_lights(sphere, material):
    space = md.scale_space(sphere, scales=0)
    eyes = np.array([[0.0], [0.0], [1.0]], np.float32)
    every = Light((0, 0, 1), color=np.full(3, 4.0), spread=180).disc(2_000)  # radiance 1
    exact = sum(
        diffuse_term(material, space.normals_at(0), one.direction, eyes[:, 0]) * one.color[0]
        for one in every
    )
    shown = matt(material, space.normals_at(0), eyes)
    np.testing.assert_allclose(np.broadcast_to(shown, exact.shape), exact, atol=0.01)
    assert albedo(material) <= 1


def test_a_lamp_in_the_sky_casts_a_shadow_without_speckle(space):
    pixels = np.full((64, 128, 3), 0.05, np.float32)
    pixels[20:22, 30:32] = 200
    sky = Environment(pixels)
    options = {"shadows": True, **MATT, "exposure": 0.5}
    exact = shading.phong(space, sky, rays=4096, **options)
    found = shading.phong(space, sky, rays=64, **options)
    assert 255 * np.sqrt(np.mean((found - exact) ** 2)) < 1
    assert np.ptp(exact) > 0.2


def test_highlights_of_a_sky_are_hidden_where_its_matt_light_is(space):
    gloss = {"ambient": 0.0, "diffuse": 0.0, "specular": 0.5, "shininess": 30.0}
    plain = shading.phong(space, white(0.3), **gloss)
    hidden = shading.phong(space, white(0.3), shadows=True, **gloss)
    assert (hidden <= plain + 1e-3).all()
    closed = space.occlusion(64) < 0.7
    assert hidden[closed].mean() < 0.9 * plain[closed].mean()


# --- other samples of the same surface --------------------------------------------------------


def test_samples_of_every_kind_see_what_their_vertices_see(space, torus):
    options = {"shadows": True, "bounces": 2, "rays": 16}
    light = Light(SIDE, spread=10)
    whole = shading.lambert(space, light, **options)
    some = np.arange(0, len(whole), 7)
    np.testing.assert_array_equal(
        shading.lambert(ChosenSamples(space, some), light, **options), whole[some]
    )
    corners = np.repeat(some[:, None], 3, axis=1)
    at_corners = InterpolatedSpace(space, corners, np.eye(3)[np.zeros(len(some), int)])
    # Positions differ by rounding, and so may how single rays are turned.
    close = np.abs(shading.lambert(at_corners, light, **options) - whole[some])
    assert np.median(close) < 1e-5
    assert close.mean() < 0.01


def test_an_image_of_a_mesh_has_the_shadows_of_the_mesh(torus):
    eye = View.fitted("front", torus)
    buffer = md.GBuffer.of(torus, eye, size=(120, 120))
    pixels = shading.lambert(
        md.scale_space(buffer, scales=0), SIDE, shadows=True, bounces=2, rays=64
    )
    vertices = shading.lambert(
        md.scale_space(torus, scales=0), SIDE, shadows=True, bounces=2, rays=64
    )
    difference = pixels - buffer.sample(vertices)
    # Edges of shadows lie between the vertices.
    assert np.median(np.abs(difference)) < 0.01
    assert np.sqrt(np.mean(difference**2)) < 0.15


def test_the_side_that_is_seen_has_its_own_light():
    # Two sheets: the light between them falls on their inner sides alone.
    sheet = md.samples.wavy_sheet(100, amplitude=0)
    turned = {"two_sided": True, "view": View((0, 0, -5), (0, 0, 0), (0, 1, 0), parallel_scale=1)}
    space = md.scale_space(sheet, scales=0)
    assert sheet.normals[0, 2] == pytest.approx(1)
    behind = shading.lambert(space, (0, 0, -1), shadows=True, **turned)
    np.testing.assert_array_equal(behind, 1)
    assert not shading.lambert(space, (0, 0, 1), shadows=True, **turned).any()


def test_terrain_throws_the_shadows_of_its_mesh():
    y, x = np.mgrid[:40, :40]
    field = md.HeightField(8 * np.exp(-((x - 20.0) ** 2 + (y - 20.0) ** 2) / 20))
    ground = md.scale_space(field, scales=0)
    hidden = shading.lambert(ground, (-1, 0, 0.3), shadows=True)
    plain = shading.lambert(ground, (-1, 0, 0.3))
    seen = ground.seen_share(Light((-1, 0, 0.3)))
    np.testing.assert_allclose(hidden, plain * seen, atol=1e-6)
    # Its shadow lies to the east, on the plain.
    image = field.image(hidden)
    assert image[20, 28] == 0 < image[20, 8]


@hiding
def test_a_volume_has_no_surface_for_rays_to_meet(method):
    space = md.scale_space(ct_phantom(size=(12, 12, 12)), scales=1)
    with pytest.raises(MeshdepictError, match="rays need a surface to meet, and a volume is none"):
        METHODS[method](space, SIDE, bounces=1)


# --- how sure it is ---------------------------------------------------------------------------


def levels(values, linear=True):
    return 255 * (linear_to_srgb(values) if linear else values)


@pytest.mark.parametrize(
    ("method", "light", "bounces"),
    [
        ("lambert", Light(SIDE, spread=20), 0),
        ("lambert", Light(SIDE), 1),
        ("half_lambert", Light(SIDE, spread=20), 2),
        ("phong", Light(SIDE), 3),
        ("light_warping", Light(SIDE, spread=20), 0),
        ("light_warping", Light(SIDE), 3),
        ("light_warping", white(0.6), 1),
        ("light_alignment", Light(SIDE, spread=20), 0),
        ("light_alignment", Light(SIDE), 3),
        ("light_alignment", white(0.6), 1),
    ],
)
def test_the_estimate_in_grey_levels_is_what_they_err(torus, method, light, bounces):
    mesh = md.samples.torus(1_500)
    options = {"shadows": True, "bounces": bounces}
    shade, linear = METHODS[method], method != "half_lambert"
    scales = int(method in OWN_RAYS)
    exact = levels(shade(md.scale_space(mesh, scales=scales), light, rays=4096, **options), linear)
    space = md.scale_space(mesh, scales=scales)
    found = levels(shade(space, light, rays=64, **options), linear)
    true = np.sqrt(np.mean((found - exact) ** 2))
    assert 0.8 * true <= space.light_errors[64] <= 1.25 * true


def test_hard_shadows_are_sampled_by_nothing(space):
    shading.lambert(space, SIDE, shadows=True)
    assert not space.light_errors


def test_the_closing_line_says_how_sure_light_is(run, ball_ply):
    options = "--set", "shadows=true", "--set", "bounces=1"
    status, out, _ = run("bake", "ball.ply", "-m", "lambert", "--light", "315/35:20", *options)
    assert status == 0
    assert "light azimuth 315 elevation 35 spread 20" in out[0]
    assert " grey levels (rms), " in out[0]
    held = md.io.read_provenance("ball-lambert.ply")
    assert any("light error: " in line for line in held)
    status, out, _ = run("bake", "ball.ply", "-m", "lambert", "--force")
    assert status == 0
    assert "grey levels" not in out[0]


def test_the_side_that_is_seen_is_traced_once_for_all_lights(monkeypatch):
    calls = []
    real = transfer.traced_transfer
    monkeypatch.setattr(
        transfer, "traced_transfer", lambda *a, **k: calls.append(k["rays"]) or real(*a, **k)
    )
    sheet = md.samples.wavy_sheet(400, amplitude=0.3)
    front, behind, aslant = (
        View(np.array(position) * 5.0, (0, 0, 0), (0, 1, 0), parallel_scale=1)
        for position in ((0, 0, 1), (0, 0, -1), (1, 0, 0.1))
    )
    space = md.scale_space(sheet, scales=0)
    options = {"bounces": 1, "rays": 16, "shadows": True}
    plain = shading.lambert(space, SIDE, **options)
    # Where all of it is seen from the front, that is what there is already.
    np.testing.assert_array_equal(
        shading.lambert(space, SIDE, two_sided=True, view=front, **options), plain
    )
    assert len(calls) == 1
    for light in (SIDE, (0, 0, -1), "north"):
        shading.lambert(space, light, two_sided=True, view=behind, **options)
    assert len(calls) == 2
    turned = shading.lambert(space, SIDE, two_sided=True, view=aslant, **options)
    assert len(calls) == 3
    again = md.scale_space(sheet, scales=0)
    alone = shading.lambert(again, SIDE, two_sided=True, view=aslant, **options)
    np.testing.assert_array_equal(turned, alone)


def test_lights_that_stay_are_traced_once(space, monkeypatch):
    asked = []
    real = shadows.seen_directions
    monkeypatch.setattr(
        shadows, "seen_directions", lambda *a, **k: asked.append(len(a[1])) or real(*a, **k)
    )
    first = shading.lambert(space, SIDE, shadows=True)
    brighter = shading.lambert(space, SIDE, shadows=True, exposure=2)
    np.testing.assert_array_equal(brighter, np.minimum(2 * first, 1))
    assert asked == [1]
    pixels = np.full((32, 64, 3), 0.05, np.float32)
    pixels[10:12, 15:19] = 200
    sky = Environment(pixels)
    shown = shading.phong(space, sky, shadows=True, rays=16, **MATT)
    lamps = asked[1:]
    assert len(lamps) == 1 < lamps[0]  # all lamps of a sky at once
    dim = Environment(pixels / 2)
    half = shading.phong(space, dim, shadows=True, rays=16, **MATT)
    np.testing.assert_allclose(half[shown < 1], shown[shown < 1] / 2, atol=1e-6)
    assert len(asked) == 2
    # The last 128 directions are kept.
    for azimuth in range(130):
        shading.lambert(space, (azimuth, 30.0), shadows=True)
    shading.lambert(space, SIDE, shadows=True)
    assert len(asked) == 2 + 130 + 1


def test_a_disc_without_shadows_gets_a_note(ball):
    disc = Light(SIDE, spread=20)
    for method in ("lambert", "exaggerated"):
        with pytest.warns(MeshdepictWarning, match="a disc of light, here of 20 degrees") as notes:
            md.bake(ball, method, light=disc)
        assert len(notes) == 1
        assert "--set shadows=true" in str(notes[0].message)
    md.bake(ball, "lambert", light=disc, shadows=True)
    md.bake(md.scale_space(ball, scales=0), "lambert", light=disc)  # a viewer's next light
