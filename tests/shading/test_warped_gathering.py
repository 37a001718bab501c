"""Light Warping with shadows and bounces: eq. 1 along rays, eq. 2 for lights, and its limits."""

import pickle

import numpy as np
import pytest
from conftest import rotation

import meshdepict as md
from meshdepict import shading, threads
from meshdepict.errors import MeshdepictError
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.material import CookTorrance, Lambert, Phong, Refractive
from meshdepict.scene.names import as_view
from meshdepict.scene.view import View
from meshdepict.shading.features import Frames, features
from meshdepict.shading.light_warping import light_warping, warp, warp_scale
from meshdepict.shading.warped_gathering import Warping
from meshdepict.transport import transfer
from meshdepict.transport.rays import AGAIN, FIRST, RaySet, cosine_weighted
from meshdepict.transport.transfer import Leaving, traced_transfer

SIDE = (-1.0, 0.2, 0.3)
RAYS = {"shadows": True, "rays": 16}
MATT = {"ambient": 0.0, "diffuse": 1.0, "specular": 0.0}


def white(brightness=1.0):
    return Environment(np.full((16, 32, 3), brightness, np.float32))


def soft_sky(sharpness=2):
    """A window in the northwest; a soft one has no lamps in it."""
    d = Environment(np.ones((64, 128, 3)))._directions
    window = np.exp(sharpness * (d @ (np.array([-1, 0.5, 1]) / 1.5) - 1))[..., None] * [
        1.0,
        0.8,
        0.6,
    ]
    return Environment(0.2 + window)


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(700)


@pytest.fixture
def space(torus):
    return md.scale_space(torus, scales=2)


@pytest.fixture(scope="module")
def sheet():
    """A flat sheet, of which every vertex sees half of the sky."""
    return md.scale_space(md.samples.wavy_sheet(60, amplitude=0), scales=1)


def bent(space, ku, kv, turn):
    """Frames of the same curvature everywhere, in the axes of a turn."""
    count = len(space.points)
    u, v, z = (np.tile(axis, (count, 1)).astype(np.float32) for axis in turn)
    return Frames(np.full(count, ku, np.float32), np.full(count, kv, np.float32), u, v, z)


def gathered(space, frames, magnitude=4.0):
    key = tuple(float(part.ravel()[0]) for part in (frames.ku, frames.kv, frames.z))
    return Warping(frames, magnitude, key)


def leaning(degrees):
    """The axes u, v and z as rows, z so far from the sheet's normal."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    spin = np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1.0]])
    return spin @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


TILTS = {"along": leaning(0), "tilted": leaning(40)}
BENDS = [(0.4, 0.4), (-0.6, 0.2), (-2.0, -0.1)]


# --- what is gathered -------------------------------------------------------------------------


@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize(("ku", "kv"), BENDS)
def test_an_even_sky_brings_the_share_of_directions_whose_partner_is_above(sheet, tilt, ku, kv):
    turn, normal = TILTS[tilt], sheet.normals_at(0)[0].astype(float)
    # (1/π) ∫ ⟨n·d⟩ [n·W(d) > 0] dd over the hemisphere, by the midpoints of a fine grid.
    height, angle = np.meshgrid(
        np.sqrt((np.arange(600) + 0.5) / 600), 2 * np.pi * (np.arange(600) + 0.5) / 600
    )
    level = np.sqrt(1 - height**2)
    directions = np.stack([level * np.cos(angle), level * np.sin(angle), height], axis=-1)
    np.testing.assert_allclose(normal, [0, 0, 1], atol=1e-6)
    partner = warp(directions @ turn.T, *(warp_scale(k, 4.0) for k in (ku, kv))) @ turn
    expected = (partner @ normal > 0).mean()
    found = gathered(sheet, bent(sheet, ku, kv, turn)).traced(sheet, 512).from_sky(white())
    np.testing.assert_allclose(found, expected, atol=0.008)  # where they set
    assert np.abs(found.mean() - expected) < 0.001
    if tilt == "along" and ku < 0 and kv < 0:
        assert expected == 1  # towards the normal nothing sets
    elif ku > 0:
        assert expected < 0.995


@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize(("ku", "kv"), BENDS)
def test_rays_by_eq_1_bring_what_lights_do_by_eq_2(sheet, tilt, ku, kv):
    sky = soft_sky(10)
    gathering = gathered(sheet, bent(sheet, ku, kv, TILTS[tilt]))
    rays = gathering.traced(sheet, 1024).from_sky(sky)
    lights = sky.lights(4_000)
    normals = sheet.normals_at(0)
    summed = sum(gathering.falls(normals, one)[:, None] * one.color for one in lights)
    np.testing.assert_allclose(rays, summed, atol=0.006)
    plain = sheet.transport(1024).from_sky(sky)
    assert np.abs(summed - plain).max() > 0.004


@pytest.mark.parametrize("steps", [FIRST, AGAIN])
def test_every_ray_goes_where_its_direction_is_warped_to(rng, steps):
    outside = md.samples.sphere(300)
    inside = md.Mesh(outside.vertices, outside.faces[:, ::-1], winding="keep")
    space = md.scale_space(inside, scales=1)
    frames = bent(space, -0.5, 0.9, rotation(rng))
    normals, points = space.normals_at(0).astype(float), inside.unit_points
    which = np.arange(len(points))
    own = gathered(space, frames).traced(space, 64)
    if steps is AGAIN:
        which, own = own.probes.chosen, own.probes.transfer
    _, directions = RaySet(64, cosine_weighted).leaving(
        points[which], normals[which], normals[which], steps
    )
    axes = np.stack([frames.u, frames.v, frames.z], axis=1)[which].astype(float)
    stretch = (warp_scale(k[which].astype(float), 4.0)[:, None] for k in (frames.ku, frames.kv))
    local = np.einsum("nij,nkj->nki", axes, directions.astype(float))
    partner = np.einsum("nij,nki->nkj", axes, warp(local, *stretch))
    above = np.einsum("nj,nkj->nk", normals[which], partner)
    sure = np.abs(above).min(axis=1) > 1e-4
    # Within a closed surface every ray meets something, those that count for nothing apart.
    met = own.from_surface(np.ones(len(points), np.float32))
    expected = (above > 0).mean(axis=1)
    np.testing.assert_allclose(met[sure], expected[sure], atol=1e-5)
    assert 0.5 < expected.mean() < 0.98
    assert not own.sky_share.any()
    # And it meets what lies there: a chord of a sphere of radius r is 2 r (n·d) long.
    radius = np.linalg.norm(points, axis=1).mean()
    ends = points[which, None] + 2 * radius * above[..., None] * partner
    exact = (ends * (above > 0)[..., None]).mean(axis=1)
    found = own.from_surface(points.astype(np.float32))
    np.testing.assert_allclose(found[sure], exact[sure], atol=0.02 * radius)


def dense(transfer, mesh):
    """An operator as a matrix, ray by ray."""
    matrix = np.zeros((len(transfer), len(mesh.vertices)))
    for i in range(len(transfer)):
        for k in range(transfer.hits[i], transfer.hits[i + 1]):
            second, third = transfer.weights[k] / 65_535
            weights = np.array([1 - second - third, second, third])
            matrix[i, mesh.faces[transfer.triangle[k]]] += weights / transfer.rays
    return matrix


@pytest.mark.parametrize("bounces", [1, 3])
@pytest.mark.parametrize("contrast", [0.0, -0.4])
def test_only_the_last_way_to_the_eye_is_warped(space, torus, bounces, contrast):
    light, magnitude = Light(SIDE), 6.0
    eye = as_view("front", torus)
    frames = features(space, eye, curvature="object", scale=1, gain=None)
    gathering = Warping(frames, magnitude, ())
    plain, seen = space.transport(16), space.seen_share(light)
    falls = np.maximum(space.normals_at(0) @ light.direction, 0) * seen
    sent = 0.5 * falls  # B_k = ρ E_k, E_k = E_0 + T B_{k−1}
    for _ in range(bounces - 1):
        sent = 0.5 * (falls + dense(plain, torus) @ sent)
    direct = gathering.falls(space.normals_at(0), light) * seen
    expected = 0.5 * (direct + dense(gathering.traced(space, 16), torus) @ sent)
    area = warp_scale(frames.ku, magnitude) * warp_scale(frames.kv, magnitude)
    found = light_warping(
        space, light, material=Lambert(0.5), magnitude=magnitude, bounces=bounces,
        contrast=contrast, **RAYS,
    )  # fmt: skip
    np.testing.assert_allclose(found, np.clip(expected * area**contrast, 0, 1), atol=2e-4)


def test_a_light_is_hidden_by_what_lies_where_it_is_and_its_highlight_too(space):
    light, options = Light(SIDE), {"magnitude": 5.0, "material": Phong(0.2, 0.3, 0.4, 10)}
    seen = space.seen_share(light)
    plain = light_warping(space, light, **options)
    hidden = light_warping(space, light, shadows=True, **options)
    np.testing.assert_allclose(hidden, np.where(seen > 0, plain, 0.2), atol=1e-6)
    assert (np.abs(hidden - plain) > 0.01).any()


# --- limits -----------------------------------------------------------------------------------


@pytest.mark.parametrize("flat", [{"magnitude": 0}, {"gain": 0}])
@pytest.mark.parametrize("light", ["lamp", "disc", "sky"])
def test_without_magnitude_or_gain_it_is_plain_light_bit_for_bit(space, flat, light):
    lit = {"lamp": Light(SIDE), "disc": Light(SIDE, spread=20), "sky": soft_sky()}[light]
    options = {"bounces": 2, **RAYS}
    found = light_warping(space, lit, **flat, **options)
    np.testing.assert_array_equal(found, shading.phong(space, lit, **MATT, **options))
    glossy = light_warping(space, lit, material="phong", **flat, **options)
    np.testing.assert_array_equal(glossy, shading.phong(space, lit, **options))
    assert "warped rays" not in space._kept
    if light != "sky":
        np.testing.assert_array_equal(found, shading.lambert(space, lit, **options))


def test_on_a_convex_object_shadows_and_bounces_change_nothing(sphere):
    space = md.scale_space(sphere, scales=1)
    for light in (Light(SIDE), Light(SIDE, color=(0.2, 0.5, 1))):
        plain = light_warping(space, light)
        hidden = light_warping(space, light, shadows=True, bounces=3)
        assert np.abs(hidden - plain).max() < 0.01


def test_lights_add_up_each_with_its_colour(space):
    red, blue = Light(SIDE, color=(0.3, 0, 0), spread=10), Light((1, 0, 0.2), color=(0, 0, 0.2))
    sky = soft_sky()
    options = {"bounces": 2, "exposure": 0.2, **RAYS}
    together = light_warping(space, [red, blue, sky], **options)
    alone = [light_warping(space, one, **options) for one in (red, blue, sky)]
    np.testing.assert_allclose(together, sum(alone), atol=1e-6)


@pytest.mark.parametrize("magnitude", [1e30, -1e30])
def test_a_closed_furnace_stays_finite(magnitude):
    outside = md.samples.sphere(300)
    inside = md.Mesh(outside.vertices, outside.faces[:, ::-1], winding="keep")
    found = light_warping(
        md.scale_space(inside, scales=1), white(), magnitude=magnitude, bounces=300, **RAYS
    )
    assert np.isfinite(found).all()
    assert ((found >= 0) & (found <= 1)).all()


def test_any_number_of_threads_gives_the_same_bits(torus):
    shown = []
    for count in (1, 3):
        threads.limit(count)
        fresh = md.scale_space(torus, scales=1)
        shown.append(light_warping(fresh, soft_sky(), bounces=2, **RAYS))
    threads.limit(None)
    np.testing.assert_array_equal(*shown)


# --- what is traced ---------------------------------------------------------------------------


def test_rays_are_traced_anew_for_another_warp_and_never_for_another_light(space, monkeypatch):
    calls = []
    real = transfer.traced_transfer
    monkeypatch.setattr(
        transfer,
        "traced_transfer",
        lambda *a, **k: calls.append(k["how"].bend is not None) or real(*a, **k),
    )

    def traced(light=SIDE, **options):
        calls.clear()
        light_warping(space, light, bounces=1, rays=8, **options)
        return sum(calls)

    assert traced() == 1
    assert traced((1, 0, 1)) == 0
    assert traced(soft_sky(), material="phong", contrast=0.5, exposure=0.5) == 0
    assert traced(view="left") == 0  # of the object's own curvature
    assert traced(magnitude=5.0) == 1
    assert traced(scale=2, magnitude=5.0) == 1  # another width
    seen = {"curvature": "view", "magnitude": 5.0}
    assert traced(**seen) == 1
    assert traced((1, 0, 1), **seen) == 0
    assert traced(view="left", **seen) == 1
    assert traced(view="left", foreshortening=0.4, **seen) == 1
    here = np.linspace(0, 1, len(space.points))
    assert traced(importance=here) == 1
    assert traced((1, 0, 1), importance=here.copy()) == 0
    assert traced(importance=here[::-1]) == 1
    assert traced() == 1  # the last alone is kept


# --- other samples ----------------------------------------------------------------------------


@pytest.mark.parametrize("curvature", ["object", "view"])
def test_samples_of_every_kind_have_the_light_of_the_whole(space, torus, curvature):
    options = {"bounces": 2, "curvature": curvature, "view": as_view("front", torus), **RAYS}
    whole = light_warping(space, SIDE, **options)
    some = np.arange(0, len(whole), 7)
    few = light_warping(ChosenSamples(space, some), SIDE, **options)
    np.testing.assert_allclose(few, whole[some], atol=1e-6)
    corners = np.repeat(some[:, None], 3, axis=1)
    at_corners = InterpolatedSpace(space, corners, np.eye(3)[np.zeros(len(some), int)])
    close = np.abs(light_warping(at_corners, SIDE, **options) - whole[some])
    assert np.median(close) < 1e-4


def test_the_side_that_is_seen_is_warped_by_its_own_curvature():
    sheet = md.samples.wavy_sheet(300, amplitude=0.2)
    other = md.Mesh(sheet.vertices, sheet.faces[:, ::-1], winding="keep")
    eye = View((0, 0, -5), (0, 0, 0), (0, 1, 0), parallel_scale=1)
    options = {"view": eye, "bounces": 2, **RAYS}
    below = light_warping(
        md.scale_space(sheet, scales=1), (0.5, 0.2, -1), two_sided=True, **options
    )
    turned = light_warping(md.scale_space(other, scales=1), (0.5, 0.2, -1), **options)
    np.testing.assert_allclose(below, turned, atol=1e-4)
    assert np.ptp(below) > 0.1


def test_pixels_have_shadows_but_no_warped_rays(torus):
    buffer = md.GBuffer.of(torus, View.fitted("front", torus), size=(60, 60))
    pixels = md.scale_space(buffer, scales=1)
    assert light_warping(pixels, Light(SIDE, spread=10), shadows=True).max() > 0
    for light, options in ((SIDE, {"bounces": 1}), (white(), {"shadows": True})):
        with pytest.raises(MeshdepictError, match="enhanced is known at the vertices of a mesh"):
            light_warping(pixels, light, **options)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"illumination": "occlusion"}, "illumination='occlusion' has light from all around"),
        ({"quadrature": "directions"}, "quadrature='directions' looks up an environment that"),
    ],
)
def test_what_has_no_shadows_and_no_bounces(space, options, sentence):
    for asked in ({"shadows": True}, {"bounces": 1}):
        with pytest.raises(MeshdepictError, match=sentence):
            light_warping(space, white(), **options, **asked)


def test_a_refractive_body_shows_the_sky_along_warped_rays(space):
    options = {"material": Refractive(), "exposure": 0.5, "bounces": 3}
    shown = light_warping(space, soft_sky(), magnitude=0, **options)
    same = shading.radiance_scaling(space, soft_sky(), magnitude=0, **options)
    np.testing.assert_array_equal(shown, same)
    warped = light_warping(space, soft_sky(), **options)
    assert np.abs(warped - shown).max() > 0.02
    even = light_warping(space, white(0.5), material=Refractive(), bounces=3)
    np.testing.assert_allclose(even, 0.5, atol=1e-4)
    with pytest.raises(MeshdepictError, match="Refractive lets light through and casts no shadow"):
        light_warping(space, white(), **{**options, "shadows": True})


def test_a_mirror_shows_the_surface_along_warped_rays(space, sphere):
    options = {"material": "mirror", "exposure": 0.5}
    bouncing = {"shadows": True, "bounces": 2}
    ball = md.scale_space(sphere, scales=1)
    plain = light_warping(ball, soft_sky(), **options)
    np.testing.assert_allclose(
        light_warping(ball, soft_sky(), **options, **bouncing), plain, atol=1e-5
    )
    shown = light_warping(space, soft_sky(), magnitude=0, **options, **bouncing)
    same = shading.radiance_scaling(space, soft_sky(), magnitude=0, **options, **bouncing)
    np.testing.assert_array_equal(shown, same)
    warped = light_warping(space, soft_sky(), **options, **bouncing)
    assert np.abs(warped - light_warping(space, soft_sky(), **options)).max() > 0.02
    assert np.abs(warped - shown).max() > 0.02


def test_highlights_of_a_sky_are_hidden_where_it_is(space):
    eye = View((0, -4, 3), (0, 0, 0), (0, 1, 0), parallel_scale=1.3)
    gloss = {"material": CookTorrance(0, 0.5, 0.3), "view": eye}
    plain = light_warping(space, soft_sky(), **gloss)
    hidden = light_warping(space, soft_sky(), shadows=True, **gloss)
    assert (hidden <= plain + 0.02).all()
    closed = space.occlusion(64) < 0.7
    assert hidden[closed].mean() < 0.9 * plain[closed].mean()


def test_a_number_of_rays_that_none_has_is_refused(space):
    with pytest.raises(MeshdepictError, match="rays=1 is not a whole number from 2"):
        light_warping(space, SIDE, bounces=1, rays=1)
    with pytest.raises(MeshdepictError, match="rays=1 is not a whole number from 2"):
        light_warping(space, SIDE, illumination="occlusion", rays=1)
    usual = light_warping(space, SIDE, bounces=1)
    np.testing.assert_array_equal(usual, light_warping(space, SIDE, bounces=1, rays=64))


def test_warped_rays_below_the_horizon_are_no_rays_of_others(torus):
    plain = traced_transfer(torus, rays=16)
    same = traced_transfer(torus, rays=16, how=Leaving(bend=lambda directions, which: None))
    np.testing.assert_array_equal(plain.triangle, same.triangle)
    np.testing.assert_array_equal(plain.sky, same.sky)


def test_what_was_traced_goes_along_to_another_process(space):
    whole = light_warping(space, SIDE, bounces=1, rays=8)
    again = pickle.loads(pickle.dumps(space))
    assert len(again._kept["warped rays"][1]) == len(whole)
    np.testing.assert_array_equal(light_warping(again, SIDE, bounces=1, rays=8), whole)
