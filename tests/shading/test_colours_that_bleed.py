"""Light that bounces from coloured surfaces: against radiosity solved densely, and what stays."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import color
from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.seen_side import SeenSide
from meshdepict.scene.light import Light
from meshdepict.scene.view import View

ACROSS = 8  # cells along a side of a wall
RED, GREEN, WHITE = (230, 40, 30), (40, 200, 60), (255, 255, 255)
OPEN_TO = np.array((0.35, 0.55, 1.0))  # where the light comes from: through the open front

# Of each wall a corner, its two sides and a colour; its normal is their cross product.
WALLS = [
    ((0, 0, 0), (0, 1, 0), (0, 0, 1), RED),  # left
    ((1, 0, 0), (0, 0, 1), (0, 1, 0), GREEN),  # right
    ((0, 0, 0), (0, 0, 1), (1, 0, 0), WHITE),  # floor
    ((0, 1, 0), (1, 0, 0), (0, 0, 1), WHITE),  # ceiling
    ((0, 0, 0), (1, 0, 0), (0, 1, 0), WHITE),  # back
]


def colored(mesh, colors, groups=None):
    named = dict(zip(("red", "green", "blue"), np.asarray(colors, np.uint8).T, strict=True))
    return md.Mesh(
        mesh.vertices, mesh.faces, attributes={"vertex": named}, winding="keep",
        groups=mesh.groups if groups is None else groups,
    )  # fmt: skip


@pytest.fixture(scope="module")
def box():
    """A box with coloured walls, seen from within, its front open; a wall has its own vertices."""
    along = np.linspace(0, 1, ACROSS + 1)
    u, v = (part.ravel()[:, None] for part in np.meshgrid(along, along, indexing="ij"))
    points = [np.array(at) + u * np.array(a) + v * np.array(b) for at, a, b, _ in WALLS]
    i, j = (part.ravel() for part in np.meshgrid(range(ACROSS), range(ACROSS), indexing="ij"))
    first = i * (ACROSS + 1) + j
    corner = first, first + ACROSS + 1, first + ACROSS + 2, first + 1
    cells = np.concatenate(
        [np.stack([corner[k] for k in three], 1) for three in ((0, 1, 2), (0, 2, 3))]
    )
    count = len(u)
    faces = np.concatenate([cells + count * wall for wall in range(len(WALLS))])
    colors = np.repeat([wall[3] for wall in WALLS], count, axis=0)
    plain = md.Mesh(np.concatenate(points), faces, winding="keep")
    return colored(plain, colors, groups=np.arange(len(colors)))


def form_factors(box, fine=72):
    """What each vertex gets of what each other sends, from a lattice of directions: (v, v).

    Rays meet the walls' planes by arithmetic, and nothing else is in the way.
    """
    share = (np.arange(fine) + 0.5) / fine
    up, turn = (part.ravel() for part in np.meshgrid(share, share, indexing="ij"))
    level, turn = np.sqrt(up), 2 * np.pi * turn
    local = np.stack([level * np.cos(turn), level * np.sin(turn), np.sqrt(1 - up)], axis=1)
    per_wall, step = (ACROSS + 1) ** 2, 1 / ACROSS
    factors = np.zeros((len(box.vertices), len(box.vertices)))
    # Not on two walls at once.
    for vertex, point in enumerate(0.5 + (box.vertices - 0.5) * (1 - 1e-6)):
        _, a, b, _ = WALLS[vertex // per_wall]
        directions = local @ np.array([a, b, np.cross(a, b)], float)
        nearest, met = np.full(len(directions), np.inf), np.full(len(directions), -1)
        for number, (at, a, b, _) in enumerate(WALLS):
            normal = np.cross(a, b)
            facing = directions @ normal
            with np.errstate(divide="ignore"):
                away = ((np.array(at) - point) @ normal) / facing
            closer = (facing < -1e-12) & (away > 1e-9) & (away < nearest)
            nearest[closer], met[closer] = away[closer], number
        for number, (at, a, b, _) in enumerate(WALLS):
            hit = met == number
            place = point + nearest[hit, None] * directions[hit] - at
            s, t = (np.clip((place @ np.array(side)) / step, 0, ACROSS - 1e-9) for side in (a, b))
            i, j = s.astype(int), t.astype(int)
            s, t = s - i, t - j
            within = (place @ np.array(a) <= 1) & (place @ np.array(b) <= 1)
            first = per_wall * number + i * (ACROSS + 1) + j
            lower = s >= t
            weights = (
                (first, 1 - np.maximum(s, t)),
                (first + ACROSS + 2, np.minimum(s, t)),
                (np.where(lower, first + ACROSS + 1, first + 1), np.abs(s - t)),
            )
            for other, weight in weights:
                factors[vertex] += np.bincount(
                    other[within], weight[within], minlength=len(box.vertices)
                )
    return factors / len(local)


def test_a_box_with_coloured_walls_is_radiosity_solved_densely(box):
    options = {"light": Light(OPEN_TO), "shadows": True, "albedo": "keep", "exposure": 0.3}
    direct = md.bake(box, "lambert", bounces=0, **options).intensity
    baked = md.bake(box, "lambert", bounces=60, rays=1024, **options)
    assert baked.intensity.shape == (len(box.vertices), 3)
    tints = srgb_to_linear(
        np.stack([box.attributes["vertex"][c] for c in ("red", "green", "blue")], 1) / 255
    )
    factors = form_factors(box)
    assert 0.6 < factors.sum(axis=1).mean() < 0.95  # the rest goes out in front
    exact = np.stack(
        [np.linalg.solve(np.eye(len(factors)) - factors * tint, direct) for tint in tints.T], axis=1
    )
    assert exact.max() < 0.95
    assert exact.mean() > 2 * direct.mean()
    difference = baked.intensity - exact
    assert np.sqrt(np.mean(difference**2)) < 0.004
    assert np.abs(difference.mean(axis=0)).max() < 0.002
    # Colours are those of the walls once more, which is the only other time.
    shown = color.multiply_albedo(linear_to_srgb(baked.intensity), tints, linear=False)
    assert shown.shape == baked.colors.shape


def test_red_walls_bleed_red_on_white_and_green_ones_green(box):
    baked = md.bake(
        box, "phong", light=Light((0, 0.4, 1)), albedo="keep", bounces=4, rays=256, ambient=0.0,
        specular=0.0, exposure=0.3,
    )  # fmt: skip
    x = box.vertices[:, 0]
    floor = np.arange(len(x)) // (ACROSS + 1) ** 2 == 2
    red, green, _ = baked.intensity[floor].T.astype(float)
    left, right = x[floor] < 0.2, x[floor] > 0.8
    assert (red > green)[left].all()
    assert (green > red)[right].all()


@pytest.mark.parametrize("method", ["lambert", "half_lambert", "phong", "radiance_scaling"])
def test_without_bounces_colours_of_the_surface_change_no_light(box, method):
    for shadows in (False, True):
        light = Light(OPEN_TO, spread=10 if shadows else 0)
        options = {"light": light, "shadows": shadows, "rays": 16}
        plain = md.bake(box, method, **options)
        kept = md.bake(box, method, albedo="keep", **options)
        np.testing.assert_array_equal(kept.intensity, plain.intensity)
        assert kept.provenance.get("light error") == plain.provenance.get("light error")


@pytest.mark.parametrize("method", ["lambert", "half_lambert", "phong", "cook_torrance"])
def test_gray_walls_send_on_so_much_of_the_light(box, method):
    options = {"light": Light(OPEN_TO), "bounces": 1, "rays": 16}
    level = np.full((len(box.vertices), 3), 128)
    half = float(srgb_to_linear(128 / 255))
    once = md.bake(box, method, **{**options, "bounces": 0}).intensity
    white = md.bake(box, method, **options).intensity
    gray = md.bake(colored(box, level), method, albedo="keep", **options).intensity
    within = (white < 1) & (once < 1)
    expected = once + half * (white - once)
    np.testing.assert_allclose(gray[within], np.repeat(expected[within, None], 3, 1), atol=2e-6)


def test_samples_of_every_kind_know_the_colours_of_their_surface(box):
    baked = md.bake(box, "lambert", light=Light(OPEN_TO), albedo="keep", bounces=2, rays=16)
    space = baked.space
    assert space.tints.shape == (len(box.vertices), 3)
    chosen = np.arange(0, len(box.vertices), 5)
    corners = np.repeat(chosen[:, None], 3, axis=1)
    eye = View((0.5, 0.5, 5), (0.5, 0.5, 0), (0, 1, 0), parallel_scale=1)
    options = {"bounces": 2, "rays": 16}
    some = md.shading.lambert(ChosenSamples(space, chosen), OPEN_TO, **options)
    np.testing.assert_array_equal(some, baked.intensity[chosen])
    between = InterpolatedSpace(space, corners, np.eye(3)[np.zeros(len(chosen), int)])
    np.testing.assert_allclose(
        md.shading.lambert(between, OPEN_TO, **options), baked.intensity[chosen], atol=1e-5
    )
    turned = md.shading.lambert(SeenSide(space, eye), OPEN_TO, **options)
    assert turned.shape == baked.intensity.shape


def test_a_scale_space_that_was_given_stays_without_colours(box):
    space = md.scale_space(box, scales=0)
    options = {"light": Light(OPEN_TO), "bounces": 2, "rays": 16}
    before = md.bake(space, "lambert", **options).intensity
    kept = md.bake(space, "lambert", albedo="keep", **options)
    assert kept.intensity.ndim == 2
    assert space.tints is None
    np.testing.assert_array_equal(md.bake(space, "lambert", **options).intensity, before)


def test_a_refined_bake_has_the_colours_between_vertices_too(box):
    options = {"light": Light(OPEN_TO), "bounces": 2, "rays": 64, "exposure": 0.3, "albedo": "keep"}
    plain = md.bake(box, "lambert", **options)
    finer = md.bake(box, "lambert", refine=4, **options)
    assert finer.intensity.shape[0] >= len(box.vertices)
    same = finer.intensity[: len(box.vertices)]
    assert np.sqrt(np.mean((same - plain.intensity) ** 2)) < 0.01


def test_an_image_of_a_coloured_mesh_has_its_bounced_colours(box):
    eye = View((0.5, 0.5, 5), (0.5, 0.5, 0), (0, 1, 0), parallel_scale=0.6)
    buffer = md.GBuffer.of(box, eye, size=(60, 60))
    options = {
        "light": Light(OPEN_TO),
        "bounces": 2,
        "rays": 256,
        "exposure": 0.3,
        "albedo": "keep",
    }
    pixels = md.bake(buffer, "lambert", **options).intensity
    vertices = md.bake(box, "lambert", **options).intensity
    assert pixels.ndim == 2
    assert np.median(np.abs(pixels - buffer.sample(vertices))) < 0.01


def test_the_estimate_is_of_the_colours_that_are_shown():
    mesh = md.samples.torus(1_500)
    colors = np.where(mesh.vertices[:, :1] < 0, (200, 60, 40), (90, 140, 220))
    mesh = colored(mesh, colors)
    options = {"light": Light((-1.0, 0.2, 0.3)), "albedo": "keep", "shadows": True, "bounces": 3}
    exact = md.bake(mesh, "lambert", rays=4096, **options)
    found = md.bake(mesh, "lambert", rays=64, **options)
    tints = found.space.tints

    def levels(baked):
        return 255 * linear_to_srgb(baked.intensity * tints)

    true = np.sqrt(np.mean((levels(found) - levels(exact)) ** 2))
    assert 0.8 * true <= found.space.light_errors[64] <= 1.25 * true
