"""Noise of light smoothed between neighbours: what is left, what stays, and what is told of it."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import shading
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.options import options_of
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.shading import METHODS
from meshdepict.shading.smoothed_light import WIDTHS, LightSmoothing, calmed

MATT = {"ambient": 0.0, "diffuse": 0.8, "specular": 0.0, "shadows": True}
HIDING = [name for name in METHODS if "bounces" in options_of(METHODS[name])]


def fading():
    """A sky that fades from 1 above to 0 below."""
    rows = np.linspace(1, 0, 64, dtype=np.float32)
    return Environment(np.broadcast_to(rows[:, None, None], (64, 128, 3)).copy())


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(3_000)


def levels(values):
    return 255 * linear_to_srgb(np.asarray(values, np.float64))


def rms(values):
    return np.sqrt(np.mean(values**2))


@pytest.mark.parametrize("width", WIDTHS)
def test_what_is_left_of_noise_is_as_much_as_it_says(torus, rng, width):
    smoothing = LightSmoothing(torus, torus.normals, width * torus.edge_length)
    noise = rng.normal(size=(len(torus.vertices), 20))
    assert rms(smoothing(noise)) == pytest.approx(np.sqrt(smoothing.left), rel=0.02)


def test_wider_means_leave_less_noise(torus):
    left = [LightSmoothing(torus, torus.normals, w * torus.edge_length).left for w in WIDTHS]
    assert (np.diff(left) < 0).all()
    assert 0 < left[-1] < 0.1 < 0.5 < left[0] < 1


def test_light_that_follows_normals_linearly_stays(torus, rng):
    # A rough surface: what a mean would wash out.
    normals = torus.normals + rng.normal(size=torus.normals.shape) / 3
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    width = 1.4 * torus.edge_length
    smoothing = LightSmoothing(torus, normals, width)
    np.testing.assert_allclose(smoothing(np.full(len(normals), 0.7)), 0.7, rtol=1e-4)
    light = normals @ rng.normal(size=3) + 2
    mean = md.scale_space(torus, scales=0).mean(light, width)
    assert rms(smoothing(light) - light) < 0.15 * rms(mean - light)
    nothing = LightSmoothing(torus, normals, 1e-9)
    np.testing.assert_allclose(nothing(light), light, rtol=1e-6)


def test_neighbours_count_by_their_area(rng):
    # The same sheet, its left half of many more triangles: an even noise-free light stays even,
    # and a step in the density is none in the light.
    x = np.concatenate([np.linspace(0, 1, 60), np.linspace(1.1, 3, 20)])
    y = np.linspace(0, 1, 30)
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    at = np.arange(len(grid)).reshape(len(x), len(y))
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    faces = np.vstack(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    sheet = md.Mesh(np.column_stack([grid, 0 * grid[:, 0]]), faces)
    inner = (grid[:, 1] > 0.3) & (grid[:, 1] < 0.7) & (grid[:, 0] > 0.3) & (grid[:, 0] < 2.7)
    smooth = LightSmoothing(sheet, sheet.normals, 0.1)(grid[:, 0])
    assert np.abs(smooth - grid[:, 0])[inner].max() < 0.02


def test_the_other_side_of_a_sheet_is_no_neighbour():
    # Both sides 1/50 of an edge apart, light on one of them alone.
    sheet = md.samples.wavy_sheet(400, amplitude=0)
    gap = 0.02 * sheet.edge_length * np.array([0, 0, 1.0])
    count = len(sheet.vertices)
    both = md.Mesh(
        np.vstack([sheet.vertices, sheet.vertices - gap]),
        np.vstack([sheet.faces, sheet.faces[:, ::-1] + count]),
        winding="keep",
    )
    light = (both.normals[:, 2] > 0).astype(np.float32)
    assert light.mean() == 0.5
    smooth = LightSmoothing(both, both.normals, both.edge_length)(light)
    np.testing.assert_allclose(smooth, light, atol=0.01)


def test_what_no_face_has_is_left_alone(torus, rng):
    mesh = md.Mesh(np.vstack([torus.vertices, [[0.0, 0, 0]]]), torus.faces)
    light = rng.random(len(mesh.vertices))
    smooth = LightSmoothing(mesh, mesh.normals, mesh.edge_length)(light)
    assert smooth[-1] == np.float32(light[-1])
    assert np.isfinite(smooth).all()
    point = md.Mesh(np.zeros((3, 3)), [[0, 1, 2]])
    same = LightSmoothing(point, point.normals, 1.0)
    np.testing.assert_array_equal(same(np.arange(3.0)), np.arange(3.0))
    assert same.left == 1


def test_the_least_smoothing_that_is_enough_is_taken(torus):
    light = np.ones(len(torus.vertices), np.float32)
    asked = []

    def told(_, left):
        asked.append(left)
        return np.sqrt(left)

    enough = calmed(torus, torus.normals, light, told, (0.5, 1.0))
    assert enough[1] == np.sqrt(asked[-1]) <= 0.5 < np.sqrt(asked[-2])
    best = calmed(torus, torus.normals, light, lambda _, left: 2 - left, (0.0, 0.9))
    assert best[0] is light  # what makes it worse is not taken
    assert best[1] == 0.9


# --- as methods take it -----------------------------------------------------------------------


@pytest.mark.parametrize("name", HIDING)
def test_every_method_takes_it_and_0_changes_nothing(torus, name):
    space, shade = md.scale_space(torus, scales=1), METHODS[name]
    light, options = Light((-1, 0.2, 0.3)), {"shadows": True, "bounces": 2, "rays": 16}
    plain = shade(space, light, **options)
    np.testing.assert_array_equal(shade(space, light, denoise=0, **options), plain)
    before = space.light_errors[16]
    calm = shade(space, light, denoise=0.1, **options)
    assert (calm != plain).any()
    assert space.light_errors[16] < before
    # Where it is good enough already, nothing is smoothed.
    np.testing.assert_array_equal(shade(space, light, denoise=255, **options), plain)


@pytest.mark.parametrize("bounces", [0, 2])
def test_the_error_is_smaller_and_is_what_is_told(torus, bounces):
    space, sky = md.scale_space(torus, scales=0), fading()
    exact = levels(shading.phong(space, sky, bounces=bounces, rays=4096, **MATT))
    plain = levels(shading.phong(space, sky, bounces=bounces, rays=64, **MATT))
    calm = levels(shading.phong(space, sky, bounces=bounces, rays=64, denoise=0.1, **MATT))
    true = rms(calm - exact)
    assert true < 0.75 * rms(plain - exact)
    assert 0.7 * true <= space.light_errors[64] <= 1.3 * true


def test_shadows_of_lamps_and_suns_stay_sharp(torus):
    pixels = np.full((64, 128, 3), 0.05, np.float32)
    pixels[20:22, 30:32] = 200
    space = md.scale_space(torus, scales=0)
    options = {**MATT, "exposure": 0.5, "rays": 16}
    plain = shading.phong(space, Environment(pixels), **options)
    calm = shading.phong(space, Environment(pixels), denoise=0.01, **options)
    # Only the even sky is smoothed, which has hardly any noise here.
    assert np.abs(levels(calm) - levels(plain)).max() < 20
    assert np.ptp(levels(plain)) > 100


def test_with_it_fewer_rays_are_enough(torus, monkeypatch):
    monkeypatch.setattr("meshdepict.shading.sampled.UNSEEN", 0.6)
    monkeypatch.setattr("meshdepict.shading.sampled.AUTO_SECONDS", 1e3)
    space = md.scale_space(torus, scales=0)
    shading.phong(space, fading(), rays="auto", **MATT)
    plain = space.light_errors.found.rays
    shading.phong(space, fading(), rays="auto", denoise=0.5, **MATT)
    assert space.light_errors.found.rays < plain
