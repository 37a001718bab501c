"""Local Light Alignment against its paper's statements, and the kernel against its plain twin."""

import numpy as np
import pytest
from conftest import rotation

import meshdepict as md
import meshdepict.scene.material
from meshdepict.errors import MeshdepictError
from meshdepict.shading import light_alignment
from meshdepict.shading.alignment_kernel import align_chain, arc_tangent, cosine, sine
from meshdepict.shading.light_alignment import align, confidence, transition

GREY = 1 / 255


def units(rng, *shape):
    v = rng.normal(size=(*shape, 3))
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def near(rng, normals, angle):
    """Unit vectors about this far from the given ones."""
    v = normals + angle * rng.normal(size=normals.shape)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def chain(light, normals, strengths, sharpness=3.0):
    """The plain twin of the kernel: coarse to fine."""
    lights = np.broadcast_to(light, normals[0].shape)
    for i in range(len(normals) - 2, -1, -1):
        lights = align(
            lights, normals[i], normals[i + 1], strength=strengths[i], sharpness=sharpness
        )
    return lights


@pytest.fixture(scope="module")
def space(ball):
    return md.scale_space(ball, scales=5, ratio=1.7)


# --- the equations --------------------------------------------------------------------------


def test_the_transition_has_its_stated_properties():
    share = np.linspace(0, 1, 101)
    np.testing.assert_allclose(transition(share, 0), share, atol=1e-15)
    for sharpness in (0, 1, 3, 40, 1e4):
        w = transition(share, sharpness)
        assert w[0] == 0
        assert w[-1] == 1
        assert (np.diff(w) >= -1e-15).all()  # but for rounding
    # Larger γ narrows the transition.
    assert (np.diff([transition(share, g)[1:-1] for g in (0, 1, 3, 8)], axis=0) > 0).all()


def test_the_bright_side_faces_the_light_and_the_dark_side_turns_it_away():
    # A ridge along y, lit from the right: its sides lean by 50° to either side.
    lean = np.radians(50)
    right, left = [np.sin(lean), 0, np.cos(lean)], [-np.sin(lean), 0, np.cos(lean)]
    light = np.array([0.6, 0, 0.8])
    turned = align(light, [right, left], [0, 0, 1], strength=1, sharpness=1e4)
    np.testing.assert_allclose(turned[0], right, atol=1e-12)
    assert turned[1] @ left == pytest.approx(0, abs=1e-12)
    # The dark guide lies in the plane of base and normal, on the base's upper side.
    np.testing.assert_allclose(turned[1], [np.cos(lean), 0, np.sin(lean)], atol=1e-12)


def test_the_angle_follows_equation_1():
    n, z, light = np.array([0.6, 0, 0.8]), np.array([0, 0, 1.0]), np.array([0.48, 0.6, 0.64])
    share = (2 / np.pi) * np.arctan2(0.48, 0.6) * 0.6
    level = np.hypot(0.48, 0.6)
    share *= level / np.sqrt(level**2 + 1e-6)
    assert confidence(light, n, z) == pytest.approx(share)
    turned = align(light, n, z, strength=0.7, sharpness=2)
    whole = np.arccos(light @ n)
    weight = share / (np.exp(-2) * (1 - share) + share)
    assert np.arccos(turned @ light) == pytest.approx(0.7 * weight * whole)
    assert np.arccos(turned @ n) == pytest.approx((1 - 0.7 * weight) * whole)


def test_nothing_turns_where_there_is_nothing_to_align(rng):
    light, n = units(rng, 200), units(rng, 200)
    z = near(rng, n, 0.3)
    np.testing.assert_array_equal(align(light, n, z, strength=0), light)  # no strength
    np.testing.assert_allclose(align(light, n, n, strength=1), light, atol=1e-6)  # no feature
    np.testing.assert_allclose(align(n, n, z, strength=1), n, atol=1e-12)  # already aligned
    across = np.cross(z, n)  # the light in the plane where the guide switches
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    np.testing.assert_allclose(align(across, n, z, strength=1), across, atol=1e-6)
    np.testing.assert_allclose(align(z, n, z, strength=1), z, atol=1e-6)  # the light along z


def test_turning_everything_turns_the_result(rng):
    light, n = units(rng, 300), units(rng, 300)
    z, turn = near(rng, n, 0.5), rotation(rng)
    whole = align(light, n, z, strength=0.8) @ turn.T
    np.testing.assert_allclose(
        align(light @ turn.T, n @ turn.T, z @ turn.T, strength=0.8), whole, atol=1e-9
    )


@pytest.mark.parametrize("sharpness", [0.0, 3.0, 1e4])
@pytest.mark.parametrize("strength", [0.0, 0.5, 1.0])
def test_every_result_is_a_unit_vector(rng, strength, sharpness):
    axes = np.vstack([np.eye(3), -np.eye(3), units(rng, 40)])
    light, n, z = (v.reshape(-1, 3) for v in np.broadcast_arrays(
        axes[:, None, None], axes[None, :, None], axes[None, None, :]
    ))  # fmt: skip
    turned = align(light, n, z, strength=strength, sharpness=sharpness)
    np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 1, atol=1e-12)


def test_broadcasting():
    assert align([0, 0, 1], np.ones((4, 1, 3)) / np.sqrt(3), [[1, 0, 0]], strength=1).shape == (
        4, 1, 3,
    )  # fmt: skip


# --- the kernel -----------------------------------------------------------------------------


def test_the_polynomials_keep_their_stated_errors(rng):
    y, x = (rng.uniform(0, 1, 20_000).astype(np.float32) for _ in range(2))
    y[:4], x[:4] = (0, 0, 1, 1e-30), (0, 1, 0, 1)
    rounding = 3e-7  # of a value up to π/2 in float32, a few times
    got = np.array([arc_tangent(a, b) for a, b in zip(y, x, strict=True)])
    np.testing.assert_allclose(got, np.arctan2(y.astype(float), x), atol=3e-7 + rounding)
    angle = rng.uniform(-np.pi / 2, np.pi / 2, 20_000).astype(np.float32)
    for function, exact in ((sine, np.sin), (cosine, np.cos)):
        got = np.array([function(a) for a in angle])
        np.testing.assert_allclose(got, exact(angle.astype(float)), atol=1e-7 + rounding)


@pytest.mark.parametrize("strength", [0.0, 0.4, 0.9, 1.0])
@pytest.mark.parametrize("sharpness", [0.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 20.0])
def test_single_precision_stays_within_a_grey_level(space, strength, sharpness):
    normals = space.normals.astype(float)
    for direction in ((-1, 1, 1), (1, 0, 0), (0, 0, -1), (0.2, -0.9, 0.1)):
        light = md.Light(direction)
        lights = chain(light.direction, normals, [strength] * 5, sharpness)
        expected = np.clip((lights * normals[0]).sum(axis=1), 0, 1)
        got = light_alignment(space, light, strength=strength, sharpness=sharpness)
        assert got.dtype == np.float32
        np.testing.assert_allclose(got, expected, atol=GREY)


def test_strengths_per_scale_are_finest_first(space):
    strengths = (0.9, 0.6, 0.0, 0.2, 0.3)
    normals = space.normals.astype(float)
    light = md.Light((-1, 1, 1))
    lights = chain(light.direction, normals, strengths)
    got = light_alignment(space, light, strength=strengths)
    np.testing.assert_allclose(got, np.clip((lights * normals[0]).sum(1), 0, 1), atol=GREY)
    assert np.abs(light_alignment(space, light, strength=strengths[::-1]) - got).max() > 0.1


def test_missing_guides_leave_the_light(rng):
    planes = units(rng, 3, 50).transpose(0, 2, 1).astype(np.float32)
    planes[0, :, :10] = 0  # no guide …
    planes[1, :, 10:20] = 0  # … and neither guide nor base
    light = md.Light((1, 2, 3)).direction
    lights = align_chain(planes, light, np.array([1.0, 0.0]), 3.0)
    np.testing.assert_allclose(lights[:, :20], np.tile(light[:, None], 20), atol=1e-6)
    assert np.abs(lights[:, 20:] - light[:, None]).max() > 0.01


def test_turning_the_light_a_little_moves_no_colour_far(space):
    # A step dλ of the confidence moves the weight by at most e^γ dλ and the light by π times that;
    # λ1 moves by 2/π per radian off the singular axis. Over S − 1 scales the factors multiply, but
    # with strength 0.2 and γ = 1 each is at most 1 + 0.2 (1 + e π · 2/π) < 2.3.
    step = np.radians(0.1)
    for azimuth in range(0, 360, 24):
        c = [
            light_alignment(space, (a, 30), strength=0.2, sharpness=1.0)
            for a in (azimuth, azimuth + 0.1)
        ]
        assert np.abs(c[1] - c[0]).max() <= step * 2.3**5


def test_lights_along_normals_and_silhouettes_are_finite(space):
    directions = [*space.normals[0][:5], *-space.normals[0][:5], (0, 0, 1), (0, 0, -1)]
    for direction in directions:
        for sharpness in (0.0, 20.0):
            c = light_alignment(
                space, direction, material="phong", strength=1.0, sharpness=sharpness,
                transmitted=1.0,
            )  # fmt: skip
            assert ((c >= 0) & (c <= 1)).all()


# --- the method -----------------------------------------------------------------------------


def test_strength_zero_is_lambert(space):
    np.testing.assert_allclose(
        light_alignment(space, "northwest", strength=0.0),
        md.shading.lambert(space, "northwest"), atol=2e-6,
    )  # fmt: skip


def test_there_is_detail_on_the_dark_side(space):
    light = md.Light((-1, 1, 1)).direction
    dark = space.normals[-1] @ light < -0.3  # by the shape without its dimples
    assert dark.any()
    assert md.shading.lambert(space, light)[dark].max() == 0
    # A ball's smooth base is a feature of the coarsest pair alone; the dimples show on it.
    assert light_alignment(space, light, strength=1.0)[dark].std() > 0.05


GLOSS = md.scene.material.Phong(ambient=0.0, diffuse=0.0, specular=1.0, shininess=20.0)


def test_highlights_and_transmission_have_their_own_lights(space):
    looks = {
        "specular_strength": {"light": (-1, 1, 1), "material": GLOSS},
        "transmitted_strength": {"light": (0.3, 0.2, -1), "diffuse": 0.0, "transmitted": 1.0},
    }
    for strength, look in looks.items():
        plain = light_alignment(space, **look, **{strength: 0.0})
        turned = light_alignment(space, **look, **{strength: 0.8})
        assert plain.max() > 0.1
        assert np.abs(plain - turned).max() > 0.1


@pytest.mark.parametrize("name", ["lambert", "phong", "cook_torrance", "ashikhmin_shirley"])
def test_unaligned_materials_are_themselves(space, name):
    material = md.scene.material.as_material(name)
    light = md.Light((-1, 1, 1)).direction
    n, eye = space.normals[0].astype(float), np.array([0, 0, 1.0])
    expected = md.scene.material.ambient_term(material) + sum(
        term(material, n, light, eye)
        for term in (md.scene.material.diffuse_term, md.scene.material.specular_term)
    )
    got = light_alignment(space, light, material=name, strength=0.0, specular_strength=0.0)
    front = n @ eye > 0.01  # where the eye is not mirrored
    np.testing.assert_allclose(got[front], np.clip(expected, 0, 1)[front], atol=GREY)


def test_terms_and_lights_add_up(space):
    lights = [md.Light((-1, 1, 1), color=(0.5, 0, 0)), md.Light((1, 1, 1), color=(0, 0, 0.5))]
    both = light_alignment(space, lights)
    assert both.shape == (len(space.points), 3)
    for channel, lamp in ((0, lights[0]), (2, lights[1])):
        alone = light_alignment(space, lamp.direction, exposure=0.5)
        np.testing.assert_allclose(both[:, channel], alone, atol=1e-6)
    assert not both[:, 1].any()
    dim = md.Light((-1, 1, 1), color=(0.5, 0.5, 0.5))
    np.testing.assert_allclose(
        light_alignment(space, dim), light_alignment(space, "northwest") / 2, atol=1e-6
    )


def test_perspective_highlights_come_from_where_the_eye_is(space):
    far = md.View((0, 0, 1e7), (0, 0, 0), (0, 1, 0))
    near = md.View((0, 0, 3), (0, 0, 0), (0, 1, 0))
    parallel = light_alignment(space, (-1, 1, 1), material=GLOSS)
    seen = light_alignment(space, (-1, 1, 1), view=far, material=GLOSS)
    np.testing.assert_allclose(seen, parallel, atol=GREY)
    seen = light_alignment(space, (-1, 1, 1), view=near, material=GLOSS)
    assert np.abs(seen - parallel).max() > 0.1


def test_bake_hands_the_view_on(ball):
    look = {"material": GLOSS, "specular_strength": 0.0, "light": (0, 0, 1)}
    front = md.bake(ball, "light_alignment", view="front", **look)
    right = md.bake(ball, "light_alignment", view="right", **look)
    assert np.abs(front.intensity - right.intensity).max() > 0.5


def test_wrong_input_is_refused(space, ball):
    with pytest.raises(MeshdepictError, match="needs at least one scale"):
        light_alignment(md.scale_space(ball, scales=0), "north")
    with pytest.raises(MeshdepictError, match="strength has 2 values for 5 scales"):
        light_alignment(space, "north", strength=(0.1, 0.2))
    with pytest.raises(MeshdepictError, match="specular_strength has 3 values for 5 scales"):
        light_alignment(space, "north", material="phong", specular_strength=(0.1, 0.2, 0.3))
    with pytest.raises(MeshdepictError, match="Lambert has no shininess"):
        light_alignment(space, "north", shininess=3.0)
    with pytest.raises(MeshdepictError, match="material='toon' is not one of"):
        light_alignment(space, "north", material="toon")


def test_a_comma_list_on_the_command_line(run, ball_ply):
    status, out, err = run(
        "bake", "ball.ply", "-m", "light_alignment", "--set", "strength=0.9,0.6,0.4",
        "--scales", 3, "--quiet",
    )  # fmt: skip
    assert (status, err) == (0, [])
    assert any(
        "strength=0.9,0.6,0.4" in line for line in md.io.read_provenance(out[0].split(":")[0])
    )
    status, _, err = run("bake", "ball.ply", "-m", "light_alignment", "--set", "strength=0.9,0.6")
    assert status == 2
    assert "2 values for 5 scales" in err[0]
