"""Local Light Alignment with shadows and bounces: aligned rays by hand, and its limits."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import shading, threads
from meshdepict.errors import MeshdepictError
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.material import AshikhminShirley, CookTorrance, Lambert, Phong
from meshdepict.scene.names import as_view
from meshdepict.scene.view import View
from meshdepict.shading.aligned_gathering import Alignment, weighed
from meshdepict.shading.light_alignment import align, light_alignment
from meshdepict.transport import transfer
from meshdepict.transport.rays import half_even
from meshdepict.transport.sky_cells import cell_directions
from meshdepict.transport.transfer import Leaving, traced_transfer

SIDE = (-1.0, 0.2, 0.3)
RAYS = {"shadows": True, "rays": 16}
STRENGTHS = np.array([0.6, 0.3])
EYE = View((0, -4, 3), (0, 0, 0), (0, 1, 0), parallel_scale=1.3)


def white(brightness=1.0):
    return Environment(np.full((16, 32, 3), brightness, np.float32))


def soft_sky(sharpness=2):
    """A window in the northwest; a soft one has no lamps in it."""
    d = Environment(np.ones((64, 128, 3)))._directions
    window = np.exp(sharpness * (d @ (np.array([-1, 0.5, 1]) / 1.5) - 1))[..., None]
    return Environment(0.2 + window * [1.0, 0.8, 0.6])


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def chain(light, planes, strengths, sharpness=3.0):
    """Lights (k, 3) turned over the planes (S, 3) of one sample."""
    for i in range(len(planes) - 2, -1, -1):
        light = align(light, planes[i], planes[i + 1], strength=strengths[i], sharpness=sharpness)
    return light


def aligned(space):
    scales = (0, 1, 2)
    return Alignment(space.planes_of(scales), scales, STRENGTHS, 3.0, vertices=space)


@pytest.fixture(scope="module")
def ball():
    return md.samples.golf_ball(900, dimples=12, depth=0.1)


@pytest.fixture
def space(ball):
    return md.scale_space(ball, scales=2, ratio=1.7)


@pytest.fixture(scope="module")
def torus_space():
    return md.scale_space(md.samples.torus(700), scales=2, ratio=1.7)


# --- what is gathered -------------------------------------------------------------------------


def test_half_of_the_heights_are_even_and_half_cosine_weighted():
    share = (np.arange(100_000) + 0.5) / 100_000
    height = half_even(share)
    np.testing.assert_allclose(height**2 + height, 2 * (1 - share), atol=1e-12)
    # Means over an even and a cosine-weighted half: ½ (1/2 + 2/3), and of squares ½ (1/3 + 1/2).
    assert height.mean() == pytest.approx(7 / 12, abs=1e-6)
    assert (height**2).mean() == pytest.approx(5 / 12, abs=1e-6)


@pytest.mark.parametrize("sharpness", [0.0, 3.0, 7.0])
@pytest.mark.parametrize("strengths", [(0.0, 0.0), (0.6, 0.3), (1.0, 1.0)])
def test_an_even_sky_brings_the_integral_of_the_aligned_cosine(rng, sharpness, strengths):
    # A flat sheet sees half of the sky; its smoothed normals are made up, some of them far off.
    sheet = md.samples.wavy_sheet(60, amplitude=0)
    own = np.tile([0.0, 0, 1], (len(sheet.vertices), 1))
    planes = np.stack([own, unit(own + 0.4 * rng.normal(size=own.shape)),
                       unit(own + 0.8 * rng.normal(size=own.shape))])  # fmt: skip
    rays = traced_transfer(sheet, normals=own, rays=2048, how=Leaving(half_even))
    found = weighed(
        rays, np.moveaxis(planes, 1, 2).astype(np.float32), np.array(strengths), sharpness
    ).from_sky(white())
    # (1/π) ∫ ⟨n·d'⟩ dd by evenly spread directions.
    height = (np.arange(300) + 0.5) / 300
    height, angle = np.meshgrid(height, 2 * np.pi * (np.arange(300) + 0.5) / 300)
    level = np.sqrt(1 - height**2)
    d = np.stack([level * np.cos(angle), level * np.sin(angle), height], axis=-1).reshape(-1, 3)
    for i in range(0, len(own), 5):
        turned = chain(d, planes[:, i], strengths, sharpness)
        expected = 2 * np.maximum(turned[:, 2], 0).mean()
        np.testing.assert_allclose(found[i], expected, atol=0.008)
        if not any(strengths):
            assert expected == pytest.approx(1, abs=1e-5)


def test_every_ray_weighs_what_its_direction_is_aligned_to(torus_space):
    mesh = torus_space.surface
    planes = torus_space.planes_of((0, 1, 2))
    rays = traced_transfer(mesh, normals=torus_space.normals_at(0), rays=16, how=Leaving(half_even))
    values = np.cos(np.arange(len(mesh.vertices))).astype(np.float32)
    sky = soft_sky()
    found = weighed(rays, planes, STRENGTHS, 3.0)
    from meshdepict.transport.sky_cells import sky_colors

    met, seen, colors = found.from_surface(values), found.from_sky(sky), sky_colors(sky, 16)
    assert (np.diff(rays.hits) > 4).sum() > 20
    for i in range(0, len(rays), 13):
        own = planes[:, :, i].astype(float)

        def weights(d, own=own):
            turned = chain(d, own, STRENGTHS)
            return np.maximum(turned @ own[0], 0) / (0.5 * np.maximum(d @ own[0], 0) + 0.25)

        here = slice(rays.hits[i], rays.hits[i + 1])
        corners, shares = mesh.faces[rays.triangle[here]], rays.weights[here] / 65_535
        shares = np.column_stack([1 - shares.sum(axis=1), shares])
        ends = np.einsum("kc,kcj->kj", shares, mesh.unit_points[corners])
        d = unit(ends - mesh.unit_points[i])
        expected = (weights(d) * (shares * values[corners]).sum(axis=1)).sum() / 16
        assert met[i] == pytest.approx(expected, abs=2e-4)
        cells = rays.sky[rays.misses[i] : rays.misses[i + 1]]
        expected = weights(cell_directions()[cells]) @ colors[cells] / 16
        np.testing.assert_allclose(seen[i], expected, atol=5e-4)


def test_rays_bring_what_as_many_lights_do(space):
    # Of a sky that nothing but the surface's own horizon hides.
    sheet = md.scale_space(md.samples.wavy_sheet(400, amplitude=0.02), scales=2, ratio=1.7)
    gathering = aligned(sheet)
    sky = soft_sky(6)
    rays = gathering.along(gathering.traced(sheet, 1024)).from_sky(sky)
    lights, normals = sky.lights(2_000), sheet.normals_at(0)
    summed = np.zeros((len(normals), 3))
    for one in lights:
        above = normals @ one.direction > 0
        summed += (gathering.falls(normals, one) * above)[:, None] * one.color
    open_ = sheet.transport(1024).sky_share > 0.995
    assert open_.mean() > 0.2
    np.testing.assert_allclose(rays[open_], summed[open_], atol=0.02)
    plain = sheet.transport(1024).from_sky(sky)
    assert np.abs(summed - plain)[open_].max() > 0.05


@pytest.mark.parametrize("bounces", [1, 3])
def test_only_the_last_way_to_the_eye_is_aligned(torus_space, bounces):
    space, light = torus_space, Light(SIDE)
    gathering = aligned(space)
    plain, seen = space.transport(16), space.seen_share(light)
    falls = np.maximum(space.normals_at(0) @ light.direction, 0) * seen
    sent = 0.5 * falls  # B_k = ρ E_k, E_k = E_0 + T B_{k−1}
    for _ in range(bounces - 1):
        sent = 0.5 * (falls + plain.from_surface(sent))
    around = gathering.along(gathering.traced(space, 16)).from_surface(sent)
    expected = 0.5 * (gathering.falls(space.normals_at(0), light) * seen + around)
    found = light_alignment(
        space, light, material=Lambert(0.5), strength=tuple(STRENGTHS), bounces=bounces, **RAYS
    )
    np.testing.assert_allclose(found, np.clip(expected, 0, 1), atol=1e-5)
    assert around.max() > 0.01


@pytest.mark.parametrize("sharpness", [3.0, 7.0])
def test_a_light_is_hidden_by_what_lies_where_it_is_and_its_highlight_too(torus_space, sharpness):
    light = Light(SIDE, spread=15)
    options = {"material": Phong(0.2, 0.3, 0.4, 10), "sharpness": sharpness, "exposure": 0.5}
    seen = torus_space.seen_share(light)
    plain = light_alignment(torus_space, light, **options)
    hidden = light_alignment(torus_space, light, shadows=True, **options)
    np.testing.assert_allclose(hidden, 0.1 + (plain - 0.1) * seen, atol=1e-6)
    assert ((seen > 0.1) & (seen < 0.9)).any()


def test_transmitted_light_and_the_background_are_not_hidden(torus_space):
    behind = Light((0, 0, -1))
    options = {"diffuse": 0.0, "transmitted": 0.7, "background": 0.1}
    plain = light_alignment(torus_space, behind, **options)
    hidden = light_alignment(torus_space, behind, shadows=True, **options)
    np.testing.assert_allclose(hidden, plain, atol=1e-6)
    assert np.ptp(plain) > 0.05


GLOSSY = [Phong(0, 0, 0.5, 30), CookTorrance(0, 0.5, 0.3), AshikhminShirley(0, 0.4, 80)]


@pytest.mark.parametrize("material", GLOSSY, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("strength", [0.3, 1.0])
def test_highlights_of_a_sky_are_hidden_where_it_is(torus_space, material, strength):
    options = {"material": material, "specular_strength": strength, "view": EYE}
    plain = light_alignment(torus_space, soft_sky(), **options)
    hidden = light_alignment(torus_space, soft_sky(), shadows=True, **options)
    assert (hidden <= plain + 0.02).all()
    closed = torus_space.occlusion(64) < 0.7
    assert hidden[closed].mean() < 0.95 * plain[closed].mean()
    # Without strength they are what others have; as many samples are others, and more.
    off = light_alignment(
        torus_space, soft_sky(), shadows=True, **options | {"specular_strength": 0}
    )
    scaled = shading.radiance_scaling(
        torus_space, soft_sky(), shadows=True, material=material, view=EYE, magnitude=0
    )
    np.testing.assert_allclose(off, scaled, atol=0.03)


def test_in_a_closed_hollow_highlights_are_of_what_the_walls_send(sphere):
    inside = md.Mesh(sphere.vertices, sphere.faces[:, ::-1], winding="keep")
    space = md.scale_space(inside, scales=2, ratio=1.7)
    options = {"material": Phong(0, 0.5, 0.4, 30), "shadows": True, "view": EYE, "rays": 32}
    assert not light_alignment(space, white(), **options).any()
    lit = Light(SIDE)  # without shadows it comes through the wall, and bounces from there
    del options["shadows"]
    found = light_alignment(space, lit, bounces=3, **options)
    matt = light_alignment(space, lit, bounces=3, specular=0, **options)
    assert (found >= matt).all()
    gloss, again = found - matt, light_alignment(space, lit, **options)
    alone = again - light_alignment(space, lit, specular=0, **options)
    assert (gloss - alone)[found < 1].mean() > 0.003


# --- limits -----------------------------------------------------------------------------------


@pytest.mark.parametrize("light", ["lamp", "disc", "sky"])
def test_without_strength_it_is_plain_light_bit_for_bit(space, light):
    lit = {"lamp": Light(SIDE), "disc": Light(SIDE, spread=20), "sky": soft_sky()}[light]
    options = {"bounces": 2, **RAYS}
    off = {"strength": 0, "specular_strength": 0}
    if light != "sky":
        found = light_alignment(space, lit, **off, **options)
        np.testing.assert_array_equal(found, shading.lambert(space, lit, **options))
    for material in ("phong", "cook_torrance"):
        found = light_alignment(space, lit, material=material, **off, **options)
        np.testing.assert_array_equal(found, getattr(shading, material)(space, lit, **options))
    other = light_alignment(space, lit, material=AshikhminShirley(0.5, 0.2, 20), **off, **options)
    same = shading.radiance_scaling(
        space, lit, material=AshikhminShirley(0.5, 0.2, 20), magnitude=0, **options
    )
    np.testing.assert_array_equal(other, same)
    assert "even rays" not in space._kept


def test_matt_light_alone_may_be_plain(space):
    # Highlights are aligned, rays are those of everybody.
    options = {"bounces": 2, "material": Phong(0, 0.7, 0.3), "lights": 16, **RAYS}
    found = light_alignment(space, SIDE, strength=0, specular_strength=0.5, **options)
    matt = light_alignment(space, SIDE, strength=0, specular_strength=0.5, specular=0, **options)
    plain = shading.phong(
        space, SIDE, ambient=0, diffuse=0.7, specular=0, bounces=2, **RAYS
    )  # fmt: skip
    np.testing.assert_allclose(matt, plain, atol=1e-6)
    assert (found >= matt).all()
    assert "even rays" not in space._kept


def test_on_a_convex_object_shadows_end_where_its_own_horizon_is(sphere):
    space = md.scale_space(sphere, scales=2, ratio=1.7)
    light = Light(SIDE)
    plain = light_alignment(space, light)
    hidden = light_alignment(space, light, shadows=True, bounces=3)
    facing = space.normals_at(0) @ light.direction > 0
    assert np.abs(hidden - plain)[facing].max() < 0.01
    assert hidden[~facing].max() < 0.01


def test_lights_add_up_each_with_its_colour(torus_space):
    red, blue = Light(SIDE, color=(0.3, 0, 0), spread=10), Light((1, 0, 0.2), color=(0, 0, 0.2))
    sky = soft_sky()
    options = {"bounces": 2, "exposure": 0.2, **RAYS}
    together = light_alignment(torus_space, [red, blue, sky], **options)
    alone = [light_alignment(torus_space, one, **options) for one in (red, blue, sky)]
    np.testing.assert_allclose(together, sum(alone), atol=1e-6)


@pytest.mark.parametrize("sharpness", [3.0, 20.0])
def test_a_closed_furnace_stays_finite(sharpness):
    outside = md.samples.golf_ball(300, dimples=12, depth=0.1)
    inside = md.Mesh(outside.vertices, outside.faces[:, ::-1], winding="keep")
    found = light_alignment(
        md.scale_space(inside, scales=3, ratio=1.7), [Light(SIDE), white()], strength=1.0,
        sharpness=sharpness, bounces=300, rays=16,
    )  # fmt: skip
    assert np.isfinite(found).all()
    assert ((found >= 0) & (found <= 1)).all()


@pytest.mark.parametrize("sharpness", [3.0, 7.0])
def test_any_number_of_threads_gives_the_same_bits(ball, sharpness):
    shown = []
    for count in (1, 3):
        threads.limit(count)
        fresh = md.scale_space(ball, scales=2, ratio=1.7)
        shown.append(light_alignment(fresh, soft_sky(), sharpness=sharpness, bounces=2, **RAYS))
    threads.limit(None)
    np.testing.assert_array_equal(*shown)


# --- what is traced ---------------------------------------------------------------------------


def test_rays_are_traced_once_and_weighed_anew_for_other_strengths(space, monkeypatch):
    from meshdepict.shading import aligned_gathering

    calls = []

    def counted(module, name):
        real = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *a, **k: calls.append(name) or real(*a, **k))

    counted(transfer, "traced_transfer")
    counted(aligned_gathering, "weighed")

    def done(light=SIDE, **options):
        calls.clear()
        light_alignment(space, light, bounces=1, rays=8, **options)
        return calls.count("traced_transfer"), calls.count("weighed")

    assert done() == (1, 2)  # they are weighed, and their probes
    assert done((1, 0, 1)) == (0, 1)  # the probes
    assert done(soft_sky(), material="phong", specular_strength=0.7) == (1, 1)  # everybody's
    assert done(view="left") == (0, 1)
    assert done(strength=0.7) == (0, 2)
    assert done(strength=(0.7, 0.7)) == (0, 1)
    assert done(strength=0.7, sharpness=2) == (0, 2)


# --- other samples ----------------------------------------------------------------------------


def test_samples_of_every_kind_have_the_light_of_the_whole(space):
    options = {"bounces": 2, "material": "phong", **RAYS}
    whole = light_alignment(space, SIDE, **options)
    some = np.arange(0, len(whole), 7)
    few = light_alignment(ChosenSamples(space, some), SIDE, **options)
    np.testing.assert_allclose(few, whole[some], atol=1e-6)
    corners = np.repeat(some[:, None], 3, axis=1)
    at_corners = InterpolatedSpace(space, corners, np.eye(3)[np.zeros(len(some), int)])
    close = np.abs(light_alignment(at_corners, SIDE, **options) - whole[some])
    assert np.median(close) < 1e-4


def test_the_side_that_is_seen_is_aligned_by_its_own_normals():
    sheet = md.samples.wavy_sheet(300, amplitude=0.2)
    other = md.Mesh(sheet.vertices, sheet.faces[:, ::-1], winding="keep")
    eye = View((0, 0, -5), (0, 0, 0), (0, 1, 0), parallel_scale=1)
    options = {"view": eye, "bounces": 2, **RAYS}
    below = light_alignment(
        md.scale_space(sheet, scales=2), (0.5, 0.2, -1), two_sided=True, **options
    )
    turned = light_alignment(md.scale_space(other, scales=2), (0.5, 0.2, -1), **options)
    np.testing.assert_allclose(below, turned, atol=1e-4)
    assert np.ptp(below) > 0.1


def test_pixels_have_shadows_but_no_aligned_rays(ball):
    buffer = md.GBuffer.of(ball, as_view("front", ball), size=(60, 60))
    pixels = md.scale_space(buffer, scales=2, ratio=1.7)
    assert light_alignment(pixels, Light(SIDE, spread=10), shadows=True).max() > 0
    for light, options in ((SIDE, {"bounces": 1}), (white(), {"shadows": True})):
        with pytest.raises(MeshdepictError, match="enhanced is known at the vertices of a mesh"):
            light_alignment(pixels, light, **options)
