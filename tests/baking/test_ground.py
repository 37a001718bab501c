"""A ground under a bake: it catches shadows, sends light up, and is in the picture alone."""

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict.baking.recipe import load_recipe
from meshdepict.drawing.picture import drawn
from meshdepict.errors import MeshdepictError
from meshdepict.samples.phantom import ct_phantom
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light

MATT = {"ambient": 0.0, "diffuse": 1.0, "specular": 0.0}


@pytest.fixture(scope="module")
def sphere():
    return md.samples.sphere(900)


def test_it_is_all_that_baking_together_with_one_is(sphere):
    options = {"light": (0.3, 1, 0.2), "shadows": True, "bounces": 2, "rays": 16}
    grounded = md.bake(sphere, "lambert", ground="matt", **options)
    ground = md.ground_under(sphere)
    first, second = md.bake_together([sphere, ground], "lambert", **options)
    np.testing.assert_array_equal(grounded.intensity, first.intensity)
    shown = grounded.scene.intensity
    np.testing.assert_array_equal(shown, np.concatenate([first.intensity, second.intensity]))
    assert grounded.provenance["ground"] == "matt"
    assert len(grounded.colors) == len(sphere.vertices)


def test_the_shadow_of_a_sphere_is_where_it_falls(sphere):
    light = np.array((0.5, 1.0, 0.0)) / np.hypot(0.5, 1.0)
    baked = md.bake(sphere, "lambert", light=light, shadows=True, ground="matt")
    ground = baked.scene.shape.meshes[1]
    shown = baked.scene.intensity[len(sphere.vertices) :]
    # A ray towards the light passes the sphere's middle at this distance.
    across = np.linalg.norm(np.cross(ground.vertices, light), axis=1)
    np.testing.assert_array_equal(shown[across < 0.97], 0)
    np.testing.assert_allclose(shown[across > 1.01], light[1], rtol=1e-5)
    assert (across < 0.97).sum() > 500


def test_it_sends_light_up_as_an_endless_plane_would(sphere):
    # Under a light from straight above the ground sends 1, and the shadow of the sphere 0.
    options = {"light": (0, 1, 0), "shadows": True, "rays": 256}
    high = md.Mesh(sphere.vertices + np.array((0, 4.0, 0)), sphere.faces)
    ground = md.ground_under([high, md.Mesh(sphere.vertices, sphere.faces)], size=12)
    none, once = (
        md.bake_together([high, ground], "lambert", bounces=k, **options)[0].intensity
        for k in (0, 1)
    )
    got = once.astype(float) - none
    lowest = np.argsort(high.vertices[:, 1])[:12]
    # A unit disc at height h below is seen by 1/(1 + h²) of a surface that faces it.
    height = high.vertices[lowest, 1].mean() + 1
    assert got[lowest].mean() == pytest.approx(1 - 1 / (1 + height**2), abs=0.015)
    top = high.vertices[:, 1].argmax()
    assert got[top] < 0.003


def test_in_even_light_from_all_around_a_white_scene_is_white(sphere):
    white = Environment(np.full((16, 32, 3), 0.5, np.float32))
    baked = md.bake(
        sphere, "phong", light=white, shadows=True, bounces=60, rays=64, ground="matt", **MATT
    )
    shown = baked.scene.intensity
    assert shown.max() < 0.5 + 1e-4
    # Between the sphere's lowest part and the ground light goes on for more bounces than these.
    bottom = np.linalg.norm(baked.scene.mesh.vertices - (0, -1, 0), axis=1) < 0.4
    np.testing.assert_allclose(shown[~bottom], 0.5, atol=5e-3)


def test_without_rays_it_changes_nothing_of_the_object(sphere):
    for method in ("exaggerated", "lambert", "radiance_scaling"):
        plain, grounded = (md.bake(sphere, method, ground=ground) for ground in (None, "matt"))
        np.testing.assert_array_equal(grounded.colors, plain.colors)
        assert grounded.look.fitted == plain.look.fitted
        below = grounded.scene.intensity[len(sphere.vertices) :]
        assert np.ptp(below) < 0.02  # of one tone, as planes are


def test_it_is_white_where_the_object_has_colours(sphere):
    red = {name: np.full(len(sphere.vertices), value, np.uint8)
           for name, value in (("red", 255), ("green", 0), ("blue", 0))}  # fmt: skip
    mesh = md.Mesh(sphere.vertices, sphere.faces, attributes={"vertex": red})
    options = {"light": Light((1, 0.5, 0)), "shadows": True, "bounces": 1, "exposure": 0.5}
    baked = md.bake(mesh, "lambert", albedo="keep", ground="matt", **options)
    below = baked.scene.colors[len(sphere.vertices) :].astype(int)
    assert (below[:, 0] >= below[:, 1]).all()
    assert (below[:, 0] > below[:, 1] + 5).any()  # it bleeds
    assert below[:, 1].max() > 100


@pytest.mark.parametrize("more", [{"blend": "slope:multiply:0.5,lambert"}, {"two_sided": True},
                                  {"colormap2d": "dusk"}, {"creases": 40}])  # fmt: skip
def test_it_goes_with_other_choices(sphere, more):
    baked = md.bake(sphere, "lambert", ground="matt", view="isometric", **more)
    assert len(baked.scene.colors) > len(baked.colors)


# --- pictures ---------------------------------------------------------------------------------


def test_the_picture_shows_it_and_the_file_does_not(sphere, tmp_path):
    baked = md.bake(
        sphere, "lambert", light=(0.4, 1, 0.1), shadows=True, ground="matt", view="isometric"
    )
    pixels = np.asarray(Image.open(baked.picture(tmp_path / "a.png", size=(200, 200))))
    assert (pixels[0] == 255).all()  # the soft edge ends before the picture does
    dark = (pixels[..., 0] == 0).sum()
    assert dark > 200  # its shadow, and the sphere's own
    saved = md.read_mesh(baked.save(tmp_path / "a.ply"))
    assert len(saved.vertices) == len(sphere.vertices)


def test_its_edge_fades_over_any_ground_of_the_picture(sphere):
    baked = md.bake(sphere, "lambert", light=(0, 1, 0), ground="matt", view="top")
    whole = baked.scene
    image = drawn(whole, whole.view, (160, 160)).astype(float)
    coverage = image[80, :, 3]
    assert coverage[80] == 255
    assert coverage[0] < 128
    inside = coverage[80:]
    assert (np.diff(inside) <= 1).all()
    assert np.abs(np.diff(inside)).max() < 60
    # White ground times coverage, and coverage: laid on white nothing is darker than white.
    np.testing.assert_allclose(image[80, 140:, 0], image[80, 140:, 3], atol=3)


# --- the command ------------------------------------------------------------------------------


def test_the_word_alone_means_matt(run, ball_ply):
    for words in (("--ground",), ("--ground", "matt"), ("--ground=matt",)):
        status, out, err = run("bake", *words, "ball.ply", "-m", "lambert", "--force")
        assert status == 0
        assert not [line for line in err if "note" not in line]
        assert out[0].startswith("ball-lambert.ply: lambert")
        assert any("ground: matt" in line for line in md.io.read_provenance("ball-lambert.ply"))


def test_it_is_seen_from_above_unless_a_view_is_named(run, ball_ply):
    status, _, _ = run("bake", "ball.ply", "-m", "lambert", "--ground", "--picture", "a.png")
    assert status == 0
    held = md.io.read_provenance("ball-lambert.ply")
    assert any("view: isometric" in line for line in held)
    run("bake", "ball.ply", "-m", "lambert", "--ground", "--view", "left", "--force")
    held = md.io.read_provenance("ball-lambert.ply")
    assert any("view: left" in line for line in held)


def test_a_recipe_keeps_it(run, ball_ply):
    assert run("bake", "ball.ply", "-m", "lambert", "--ground", "--save-recipe", "a.toml")[0] == 0
    assert load_recipe("a.toml")["ground"] == "matt"
    assert run("bake", "ball.ply", "--recipe", "a.toml", "-o", "again.ply")[0] == 0
    assert any("ground: matt" in line for line in md.io.read_provenance("again.ply"))


def test_the_built_in_golf_ball_stands_on_it_too(run, folder):
    status, _, _ = run("bake", "-m", "lambert", "--ground", "--quiet")
    assert status == 0
    assert (folder / "golf-ball-lambert.png").exists()


def test_what_has_no_ground_says_so(run, ball_ply):
    with pytest.raises(MeshdepictError, match="ground='wet' is neither 'matt' nor 'mirror'"):
        md.bake(ball_ply, ground="wet")
    with pytest.raises(MeshdepictError, match="ground is about a mesh, and this is a volume"):
        md.bake_volume(ct_phantom(size=(8, 8, 8)), ground="matt")
    with pytest.raises(MeshdepictError, match="ground is about a mesh, and this is an image"):
        md.bake(md.GBuffer.of(ball_ply, "front", size=(20, 20)), ground="matt")
    with pytest.raises(MeshdepictError, match="ground is about a mesh, and this is a height field"):
        md.bake(md.HeightField(np.eye(4)), ground="matt")
    with pytest.raises(MeshdepictError, match="leave ground out"):
        md.bake_texture(ball_ply, "lambert", ground="matt", size=64)
    status, _, err = run("movie", "ball.ply", "--ground", "-o", "a.gif")
    assert status == 2
    assert "--ground" in err[0]
