"""Highlights under an environment against sums over every pixel, and in their limits."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import Environment, samples, scale_space, shading, threads
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.scene.light import Light
from meshdepict.scene.material import AshikhminShirley, CookTorrance, Phong, reflected
from meshdepict.shading.direct import kernel_parameters
from meshdepict.shading.light_alignment import align
from meshdepict.shading.lobe_alignment_kernel import undo
from meshdepict.shading.lobes import needs_samples

GLOSSY = [
    Phong(0, 0, 0.3, 60), CookTorrance(0, 0.2, 0.3), AshikhminShirley(0, 0.2, 20),
]  # fmt: skip


def room(seed=5):
    """A dim room with windows, smooth enough that its pixels' middles stand for it: 32 by 64."""
    rng = np.random.default_rng(seed)
    sharp = Environment(rng.uniform(0, 1, (64, 128, 3)) ** 20)
    d = Environment(np.ones((32, 64, 3)))._directions.reshape(-1, 3)
    pixels = sharp.lookup(d, blur=0.2).reshape(32, 64, 3)
    return Environment(0.5 * pixels / pixels.mean())


@pytest.fixture(scope="module")
def light():
    return room()


@pytest.fixture(scope="module")
def space():
    return scale_space(samples.golf_ball(1_200, dimples=42, depth=0.05), scales=3, ratio=1.7)


def every_pixel(environment):
    """A light for every quarter of a pixel: at grazing angles lobes are narrower than a pixel."""
    fine = Environment(np.kron(environment.pixels, np.ones((2, 2, 1))))
    colors = (fine.pixels * fine._solid_angles[..., None]).reshape(-1, 3) / np.pi
    directions = fine._directions.reshape(-1, 3)
    return [Light(d, "", c) for d, c in zip(directions, colors, strict=True)]


def levels(a, b):
    """Root mean square difference in grey levels, as shown."""
    shown = (255 * linear_to_srgb(np.asarray(x, float)) for x in (a, b))
    return np.sqrt(np.mean(np.subtract(*shown) ** 2))


METHODS = {
    "plain": (shading.radiance_scaling, {"magnitude": 0}),
    "scaled": (shading.radiance_scaling, {"magnitude": 4.0}),
    "slanted": (shading.radiance_scaling, {"magnitude": 4.0, "anisotropy": 0.5}),
    "both": (shading.radiance_scaling, {"magnitude": 4.0, "warping": 4.0}),
    "warped": (shading.light_warping, {"magnitude": 6.0}),
    "seen": (shading.light_warping, {"magnitude": 6.0, "curvature": "view"}),
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("material", GLOSSY, ids=repr)
def test_lobes_are_the_sum_over_every_pixel(space, light, method, material):
    function, options = METHODS[method]
    found = function(space, light, material=material, **options)
    dense = function(space, every_pixel(light), material=material, **options)
    few = function(space, light.lights(54), material=material, **options)
    head_on = np.abs(space.normals[0][:, 2]) > 0.3
    # Measured: 0.1 … 0.6, with the rim up to 3.1; 54 lights in place of lobes 9 … 42.
    assert levels(found[head_on], dense[head_on]) < 0.8
    assert levels(found, dense) < 3.5
    assert levels(found, dense) < levels(few, dense) / 5


@pytest.mark.parametrize("sharpness", [3.0, 8.0])
def test_aligned_lobes_are_the_sum_over_many_lights(space, light, sharpness):
    settings = {"material": Phong(0, 0.3, 0.5, 40), "sharpness": sharpness}
    found = shading.light_alignment(space, light, **settings)
    dense = shading.light_alignment(space, light.lights(700), **settings)
    few = shading.light_alignment(space, light.lights(54), **settings)
    assert levels(found, dense) < 2
    assert levels(found, dense) < levels(few, dense)


@pytest.mark.parametrize("material", GLOSSY, ids=repr)
def test_lobes_aligned_by_nothing_are_plain_ones(space, light, material):
    aligned = shading.light_alignment(
        space, light, material=material, strength=0, specular_strength=0
    )
    plain = shading.radiance_scaling(space, light, material=material, magnitude=0, lights=500)
    head_on = np.abs(space.normals[0][:, 2]) > 0.3
    assert levels(aligned[head_on], plain[head_on]) < 1


@pytest.mark.parametrize("material", GLOSSY, ids=repr)
def test_more_samples_come_closer(space, light, material):
    """Down to what the least blurred copy, a pixel wide, leaves of pixels."""
    dense = shading.radiance_scaling(space, every_pixel(light), material=material)
    few, more = (
        levels(shading.radiance_scaling(space, light, material=material, lights=n), dense)
        for n in (8, 128)
    )
    assert more < max(0.75 * few, 0.5)


@pytest.mark.parametrize("material", GLOSSY, ids=repr)
def test_a_uniform_environment_shows_the_albedo(space, material):
    """The furnace: what a lobe reflects of light 1 from everywhere, summed in double precision."""
    white = Environment(np.ones((64, 128, 3)))
    found = shading.radiance_scaling(space, white, material=material, magnitude=0, lights=200)
    assert found.ndim == 1  # gray light, gray surface
    n = space.normals[0][::40].astype(float)
    d = white._directions.reshape(1, -1, 3)
    term = md.scene.material.specular_term(material, n[:, None], d, np.array([0, 0, 1.0]))
    albedo = term @ np.broadcast_to(white._solid_angles, (64, 128)).ravel() / np.pi
    head_on = np.abs(n[:, 2]) > 0.3  # lobes at grazing angles are narrower than a pixel
    np.testing.assert_allclose(found[::40][head_on], albedo[head_on], rtol=0.02, atol=1e-4)


def test_it_is_linear_in_the_environment(space, light):
    other = Environment(room(seed=6).pixels)
    both = Environment(light.pixels + 2 * other.pixels)
    one, two, three = (
        shading.radiance_scaling(space, e, material=CookTorrance(0, 0.2, 0.3), exposure=0.1)
        for e in (light, other, both)
    )
    np.testing.assert_allclose(three, one + 2 * two, rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("material", [Phong(0, 0, 1, 10), CookTorrance(0, 0.9, 0.6)], ids=repr)
def test_a_single_texel_is_a_directional_light(space, material):
    pixels = np.zeros((32, 64, 3))
    pixels[9, 40] = 100
    spot = Environment(pixels)
    direction = spot._directions[9, 40]
    lamp = Light(direction, color=spot.flux / np.pi)
    found = shading.radiance_scaling(space, spot, material=material, magnitude=0, lights=1000)
    expected = shading.radiance_scaling(space, lamp, material=material, magnitude=0)
    facing = (space.normals[0] @ direction > 0.2) & (np.abs(space.normals[0][:, 2]) > 0.3)
    # The texel is 6° wide, and its least blurred copy twice as wide.
    np.testing.assert_allclose(found[facing], expected[facing], atol=0.1 * expected.max())


def test_the_smoothest_facets_are_a_mirror(space, light):
    n, e = space.normals[0].astype(float), np.array([0, 0, 1.0])
    front = n @ e > 0.5  # where grooves don't shadow each other
    polished = CookTorrance(0, 1.0, 0.02)
    found = shading.radiance_scaling(space, light, material=polished, magnitude=0, exposure=0.1)
    expected = 0.1 * light.lookup(reflected(n, e), blur=np.pi / light.pixels.shape[0])
    np.testing.assert_allclose(found[front], expected[front], rtol=0.06, atol=0.002)


@pytest.mark.parametrize("shininess", [0.0, 1.0, 1e6])
def test_the_ends_of_the_exponent(space, light, shininess):
    material = Phong(0, 0, 1, shininess)
    found = shading.radiance_scaling(space, light, material=material, magnitude=0)
    assert np.isfinite(found).all()
    if shininess <= 1:
        dense = shading.radiance_scaling(space, every_pixel(light), material=material, magnitude=0)
        np.testing.assert_allclose(found, dense, atol=0.02)


@pytest.mark.parametrize("up", ["y", "z", "-y"])
def test_turning_everything_turns_the_highlights(light, up):
    ball = samples.golf_ball(1_200, dimples=42, depth=0.05)
    turn = md.scene.upright.upright(up)
    turned = md.Mesh(ball.vertices @ turn.T, ball.faces)
    found = shading.phong(
        scale_space(turned, scales=0), Environment(light.pixels, up=up),
        view=md.View(turn @ [0, 0, 5.0], (0, 0, 0), turn @ [0, 1.0, 0], parallel_scale=1.0),
    )  # fmt: skip
    plain = shading.phong(scale_space(ball, scales=0), light)
    np.testing.assert_allclose(found, plain, atol=2e-3)


def test_neither_threads_nor_neighbours_change_a_value(space, light):
    found = shading.light_alignment(space, light, material="cook_torrance")
    try:
        threads.limit(1)
        same = shading.light_alignment(space, light, material="cook_torrance")
    finally:
        threads.limit(None)
    np.testing.assert_array_equal(found, same)


def test_lamps_and_environments_add_up(space, light):
    material = CookTorrance(0.5, 0.2, 0.3)
    settings = {"material": material, "exposure": 0.1}
    lamp = Light((1, 1, 1), color=(0.5, 0.4, 0.3))
    for function in (shading.radiance_scaling, shading.light_warping, shading.light_alignment):
        both = function(space, [lamp, light], **settings)
        apart = function(space, lamp, **settings) + function(space, light, **settings)
        np.testing.assert_allclose(both, apart, atol=1e-5)


@pytest.mark.parametrize("material", ["phong", "cook_torrance", "ashikhmin_shirley"])
@pytest.mark.parametrize(
    "extreme",
    [
        {"magnitude": 1e30, "gain": 1e30, "anisotropy": 1},
        {"invariant": 0.0, "magnitude": 20.0},
        {"warping": 1e30, "lights": 1},
        {"warping": -1e30, "gain": 1e30, "anisotropy": -1},
    ],
    ids=repr,
)
def test_the_ends_of_the_ranges_are_finite(space, light, material, extreme):
    found = shading.radiance_scaling(space, light, material=material, **extreme)
    assert found.dtype == np.float32
    assert np.isfinite(found).all()


def test_a_black_environment_and_a_lamp_of_one_pixel_are_finite(space):
    black = Environment(np.zeros((16, 32, 3)))
    found = shading.radiance_scaling(space, black, material=CookTorrance())
    np.testing.assert_array_equal(found, 0)
    pixels = np.zeros((16, 32, 3), np.float32)
    pixels[4, 4] = 1e12  # the most that an environment takes
    for function in (shading.radiance_scaling, shading.light_alignment):
        assert np.isfinite(function(space, Environment(pixels), material="cook_torrance")).all()


@pytest.mark.parametrize("method", ["cook_torrance", "light_warping"])
def test_a_bake_tells_how_far_its_lights_and_samples_are_off(light, method):
    ball = samples.golf_ball(1_200, dimples=42, depth=0.05)
    options = {} if method == "cook_torrance" else {"material": "cook_torrance"}
    baked = md.bake(ball, method, light=light, lights=16, **options)
    dense = md.bake(ball, method, light=every_pixel(light), **options)
    true = levels(baked.intensity, dense.intensity)
    assert 0.4 * true < baked.light_error < 1.5 * true
    assert md.bake(ball, method).light_error is None
    assert md.bake(ball, "exaggerated").light_error is None


@pytest.mark.parametrize(("strength", "sharpness"), [(0.3, 3.0), (0.3, 0.0), (0.6, 3.0)])
@pytest.mark.parametrize("angle", [5.0, 40.0, 130.0])
def test_a_step_undone_and_done_again_changes_nothing(rng, angle, strength, sharpness):
    m = rng.normal(size=(20_000, 3))
    m /= np.linalg.norm(m, axis=1)[:, None]
    n = np.array([np.sin(np.radians(angle)), 0, np.cos(np.radians(angle))])
    z = np.array([0, 0, 1.0])
    back = m.T.astype(np.float32).copy()
    solid = np.full(len(m), 4 * np.pi / len(m), np.float32)
    larger = np.ones(len(m), np.float32)
    undo(
        n.astype(np.float32), z.astype(np.float32), np.float32(strength),
        np.float32(np.exp(-sharpness)), *back, solid, larger,
    )  # fmt: skip
    again = align(back.T, n, z, strength=strength, sharpness=sharpness)
    off = np.degrees(np.arccos(np.clip(np.sum(again * m, axis=1), -1, 1)))
    # By what each stands for. Measured: up to 0.1°; Newton's two steps are short at the other side.
    assert np.average(off, weights=larger) < 0.3
    # A step maps the sphere to itself. Measured: 0.987 … 1.000.
    assert solid.sum() == pytest.approx(4 * np.pi, rel=0.02)
    np.testing.assert_allclose(solid, larger * (4 * np.pi / len(m)), rtol=1e-5)


def test_aligned_facets_are_the_sum_over_every_pixel(space, light):
    settings = {"material": CookTorrance(0.3, 0.2, 0.3)}
    dense = shading.light_alignment(space, every_pixel(light), **settings)
    head_on = np.abs(space.normals[0][:, 2]) > 0.3
    found, few = (
        levels(shading.light_alignment(space, lit, **settings)[head_on], dense[head_on])
        for lit in (light, light.lights(54))
    )
    assert found < 2
    assert found < few / 5


@pytest.mark.parametrize("shininess", [1.0, 5.0, 20.0])
def test_lights_serve_wide_lobes(space, light, shininess):
    """To a grey level, and the same bits as lights alone."""
    material = Phong(shininess=shininess)
    found = shading.radiance_scaling(space, light, material=material)
    alone = shading.radiance_scaling(space, light.lights(54), material=material)
    np.testing.assert_array_equal(found, alone)
    dense = shading.radiance_scaling(space, every_pixel(light), material=material)
    assert levels(found, dense) < 1


@pytest.mark.parametrize(
    ("material", "sampled"),
    [
        (Phong(shininess=20), False),
        (Phong(shininess=21), True),
        (Phong(specular=0, shininess=80), False),
        (Phong(shininess=0), True),
        (Phong(diffuse=0.2, specular=0.3), True),
        (CookTorrance(roughness=1.0), True),
        (CookTorrance(reflectance=0), False),
        (AshikhminShirley(shininess=2), True),
        (md.scene.material.Lambert(), False),
    ],
    ids=repr,
)
def test_which_highlights_are_sampled_is_decided_by_width(light, material, sampled):
    assert needs_samples(light, *kernel_parameters(material)) is sampled
    older = Environment(light.pixels, sampling="lights")
    assert not needs_samples(older, *kernel_parameters(material))


@pytest.mark.parametrize(
    "method", ["cook_torrance", "radiance_scaling", "light_warping", "light_alignment"]
)
def test_an_environment_sampled_as_before_is_its_lights(space, light, method):
    older = Environment(light.pixels, sampling="lights")
    options = {} if method == "cook_torrance" else {"material": "cook_torrance"}
    function = shading.METHODS[method]
    found = function(space, older, **options)
    np.testing.assert_array_equal(found, function(space, older.lights(54), **options))
    assert levels(found, function(space, light, **options)) > 1
