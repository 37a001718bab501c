"""Objects baked together: what each is alone, what all are as one mesh, and what they send on."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files import limits
from meshdepict.options import options_of
from meshdepict.samples.phantom import ct_phantom
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.shading import METHODS
from meshdepict.shading.method import declaration
from meshdepict.transport import transfer

SIDE = (-1.0, 0.4, 0.3)
LIT = {"light": Light(SIDE, spread=10), "shadows": True, "bounces": 3, "rays": 16}
MATT = {"ambient": 0.0, "specular": 0.0}

MESHES = [name for name in METHODS if "heights" not in declaration(METHODS[name]).needs]
HIDING = [name for name in METHODS if "bounces" in options_of(METHODS[name])]


def moved(mesh, by):
    return md.Mesh(mesh.vertices + by, mesh.faces)


def one_mesh(*meshes):
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return md.Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + at for mesh, at in zip(meshes, starts, strict=False)]),
    )


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(700)


@pytest.fixture(scope="module")
def globe():
    """A ball beside the torus, on the side from which light comes."""
    ball = md.samples.golf_ball(700, dimples=12)
    return moved(ball, (-2.6, 0.3, 0.2))


# --- one object -------------------------------------------------------------------------------


@pytest.mark.parametrize("method", MESHES)
def test_one_object_together_is_its_bake(torus, method):
    plain = md.bake(torus, method)
    [alone] = md.bake_together([torus], method)
    np.testing.assert_array_equal(alone.intensity, plain.intensity)
    np.testing.assert_array_equal(alone.colors, plain.colors)
    assert alone.provenance == plain.provenance


@pytest.mark.parametrize("method", HIDING)
def test_one_object_together_has_the_light_of_its_bake(torus, method):
    plain = md.bake(torus, method, **LIT)
    [alone] = md.bake_together([torus], method, **LIT)
    np.testing.assert_array_equal(alone.intensity, plain.intensity)
    assert alone.provenance == plain.provenance


@pytest.mark.parametrize(
    "choices",
    [
        {"two_sided": True, **LIT},
        {"colormap2d": "dusk", "shadows": True, "bounces": 1, "rays": 16},
        {"creases": 40, **LIT},
        {"up": "z", "view": "isometric", **LIT},
    ],
)
def test_one_object_together_has_every_choice(torus, choices):
    plain = md.bake(torus, "lambert", **choices)
    [alone] = md.bake_together([torus], "lambert", **choices)
    np.testing.assert_array_equal(alone.colors, plain.colors)
    assert alone.provenance == plain.provenance


def test_one_object_together_may_be_a_blend(torus):
    layers = "slope:multiply:0.5,lambert"
    plain = md.bake(torus, blend=layers)
    [alone] = md.bake_together([torus], blend=layers)
    np.testing.assert_array_equal(alone.colors, plain.colors)


# --- several ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("lambert", LIT),
        ("phong", LIT),
        ("sky_view", {"light": SIDE, "rays": 32}),
        ("ambient_occlusion", {"rays": 32, "darkest": 0}),
    ],
)
def test_where_nothing_is_smoothed_objects_together_are_one_mesh_of_them(
    torus, globe, method, options
):
    together = md.bake_together([torus, globe], method, **options)
    whole = md.bake(one_mesh(torus, globe), method, **options).intensity
    found = np.concatenate([baked.intensity for baked in together])
    np.testing.assert_allclose(found, whole, atol=2e-6)
    alone = md.bake(torus, method, **options).intensity
    assert np.abs(together[0].intensity - alone).max() > 0.05  # they do see each other


def test_a_sky_reaches_objects_together_as_one_mesh_of_them(torus, globe):
    pixels = np.linspace(0.1, 0.5, 16)[:, None, None] * np.ones((16, 32, 3), np.float32)
    pixels[3, 5] = 90
    options = {"light": Environment(pixels), "shadows": True, "bounces": 2, "rays": 16, **MATT}
    together = md.bake_together([torus, globe], "phong", **options)
    whole = md.bake(one_mesh(torus, globe), "phong", **options).intensity
    found = np.concatenate([baked.intensity for baked in together])
    # A ray in a thousand may pass the other side of an edge in single precision.
    close = np.abs(found - whole) < 2e-6
    assert close.mean() > 0.99
    np.testing.assert_allclose(found, whole, atol=0.02)


def test_each_object_is_smoothed_by_itself(torus, globe):
    together = md.bake_together([torus, globe], "exaggerated", light=SIDE)
    for baked, mesh in zip(together, (torus, globe), strict=True):
        alone = md.bake(mesh, "exaggerated", light=SIDE)
        np.testing.assert_array_equal(baked.intensity, alone.intensity)
        np.testing.assert_array_equal(baked.space.widths, alone.space.widths)
        assert baked.look.fitted == alone.look.fitted


@pytest.mark.parametrize("method", ["lambert", "radiance_scaling"])
def test_far_away_an_object_is_what_it_is_alone(torus, globe, method):
    options = {**LIT, "rays": 1024}
    alone = md.bake(torus, method, **options).intensity.astype(float)
    beside = []
    for distance in (1, 4, 30):
        away = moved(globe, np.array((-3.0, 0.6, 0)) * (distance - 1))
        found = md.bake_together([torus, away], method, **options)[0].intensity
        beside.append(np.sqrt(np.mean((found - alone) ** 2)))
    assert beside[0] > 3 * beside[1]
    assert beside[2] < 0.006  # of other rays: each is turned by where it begins in the whole


def test_names_of_lights_and_views_are_of_the_whole_scene(torus, globe):
    together = md.bake_together([torus, globe], "lambert", light="east", view="left")
    lights = {str(baked.look.light) for baked in together}
    assert len(lights) == 1
    assert {str(baked.view) for baked in together} == {str(together.scene.view)}
    seen = one_mesh(torus, globe)
    exact = md.bake(seen, "lambert", light="east", view="left")
    np.testing.assert_allclose(together.scene.view.focus, exact.view.focus)


def test_provenance_says_what_stood_beside(torus, globe):
    together = md.bake_together([torus, globe], "lambert")
    assert together[0].provenance["together"] == f"with {globe.identity}"
    assert together[1].provenance["together"] == f"with {torus.identity}"


def test_a_sheet_between_closed_objects_has_two_sides_and_they_have_one(globe):
    sheet = md.samples.wavy_sheet(100, amplitude=0)
    joined = md.bake_together([globe, sheet], "lambert").scene.shape
    assert joined.open_faces.sum() == len(sheet.faces)
    assert not joined.open_faces[: len(globe.faces)].any()


def test_objects_that_touch_are_not_welded(globe):
    twin = md.Mesh(globe.vertices, globe.faces)
    together = md.bake_together([globe, twin], "lambert", light=SIDE)
    alone = md.bake(globe, "lambert", light=SIDE)
    for baked in together:
        np.testing.assert_array_equal(baked.intensity, alone.intensity)


def test_what_is_baked_together_is_a_sequence(torus, globe):
    together = md.bake_together([torus, globe], "lambert")
    assert len(together) == 2
    assert [*together] == [together[0], together[1]] == [*together[:2]]
    assert repr(together).count("Baked: lambert") == 2
    assert together.ground is None
    assert len(together.scene.colors) == len(torus.vertices) + len(globe.vertices)


def test_colours_between_vertices_are_judged_in_the_scene(torus, globe):
    together = md.bake_together([torus, globe], "lambert", **LIT)
    alone = md.bake(torus, "lambert", **LIT)
    assert together[0].edge_error.rms == pytest.approx(alone.edge_error.rms, rel=0.5)
    assert len(together[0].space.own_surface.vertices) == len(torus.vertices)


def test_objects_are_refined_where_they_get_light(torus, globe):
    plain = md.bake_together([torus, globe], "lambert", **LIT)
    finer = md.bake_together([torus, (globe, {"refine": None})], "lambert", refine=20, **LIT)
    count = len(torus.vertices)
    assert len(finer[0].colors) > count
    assert len(finer[1].colors) == len(globe.vertices)
    np.testing.assert_array_equal(finer[0].intensity[:count], plain[0].intensity)
    assert len(finer.scene.colors) == len(finer[0].colors) + len(finer[1].colors)


# --- each with a look of its own --------------------------------------------------------------


def bounced_to(first, second, own, **options):
    """What the first object gets more by one bounce, of a second with a look of its own."""
    chosen = {"light": SIDE, "rays": 64, **options}
    none, once = (
        md.bake_together([first, (second, own)], "lambert", bounces=k, **chosen)[0].intensity
        for k in (0, 1)
    )
    assert once.max() < 1
    return once.astype(float) - none


def test_an_object_sends_on_what_its_own_material_does():
    ball = md.samples.sphere(600)  # which gets nothing from itself
    other = moved(md.samples.sphere(600), (2.2, 0, 0))
    lit = {"light": (-1, 0, 0.3), "exposure": 0.5}
    dark, bright = (
        bounced_to(ball, other, {"method": "phong", "diffuse": d, **MATT, "bounces": 0}, **lit)
        for d in (0.2, 0.8)
    )
    assert bright.max() > 0.02
    np.testing.assert_allclose(4 * dark, bright, atol=3e-6)


@pytest.mark.parametrize("own", [{"method": "exaggerated"}, {"method": "phong", "diffuse": 0.0}])
def test_what_has_no_matt_material_sends_nothing_on(own):
    ball = md.samples.sphere(600)
    other = moved(md.samples.sphere(600), (2.2, 0, 0))
    assert bounced_to(ball, other, own, light=(-1, 0, 0.3), exposure=0.5).max() < 0.003


def test_an_object_that_enhances_all_light_sends_on_what_it_enhances(globe):
    ball = moved(md.samples.sphere(600), (-5.0, 0.3, 0.2))
    options = {"light": (-1, 0, 0.3), "exposure": 0.3}
    own = {"method": "radiance_scaling", "curvature": "object", "bounces": 1, "scales": 2}
    plain, first, everywhere = (
        bounced_to(ball, globe, {**own, **more}, **options)
        for more in ({"magnitude": 0.0}, {"enhance": "first"}, {"enhance": "all"})
    )
    np.testing.assert_array_equal(first, plain)
    assert np.abs(everywhere - plain).max() > 0.02 * plain.max()


def test_colours_bleed_from_object_to_object():
    ball, other = md.samples.sphere(600), md.samples.sphere(600)
    red = {"red": np.full(len(other.vertices), 255, np.uint8)}
    red["green"] = red["blue"] = np.zeros(len(other.vertices), np.uint8)
    tinted = md.Mesh(
        other.vertices + np.array((2.2, 0, 0)), other.faces, attributes={"vertex": red}
    )
    options = {"light": (-1, 0, 0.3), "bounces": 2, "rays": 64}
    white, colored = md.bake_together(
        [ball, (tinted, {"albedo": "keep"})], "lambert", exposure=0.5, **options
    )
    near = ball.vertices[:, 0] > 0.95
    red_there, green_there, _ = white.intensity[near].T
    assert red_there.min() > green_there.max() + 0.02
    assert colored.colors[:, 1:].max() == 0


def test_objects_that_ask_for_the_same_light_share_it(torus, globe, monkeypatch):
    calls = []
    real = transfer.traced_transfer

    def counted(*given, **words):
        calls.append(words["part"])
        return real(*given, **words)

    monkeypatch.setattr(transfer, "traced_transfer", counted)
    together = md.bake_together([torus, globe], "lambert", light=SIDE, bounces=3, rays=16)
    assert len(calls) == 2  # one set of rays of each
    space = together[0].space
    md.shading.lambert(space, (0, 0, 1), bounces=2, rays=16)
    assert len(calls) == 2


# --- refusals ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["light", "view", "up", "ground", "sampling"])
def test_what_is_the_scenes_is_no_objects(torus, globe, name):
    with pytest.raises(MeshdepictError, match=f"{name} of object 2 is all objects': give it to"):
        md.bake_together([torus, (globe, {name: "front"})], "lambert")


def test_what_does_not_stand_together_is_refused(torus):
    field = md.HeightField(np.eye(4))
    with pytest.raises(MeshdepictError, match="object 2: only meshes stand together, and this is"):
        md.bake_together([torus, field], "lambert")
    image = md.GBuffer.of(torus, "front", size=(20, 20))
    with pytest.raises(MeshdepictError, match="only meshes stand together, and this is an image"):
        md.bake_together([image], "lambert")
    with pytest.raises(MeshdepictError, match="object 2: a Volume is not a shape"):
        md.bake_together([torus, ct_phantom(size=(8, 8, 8))], "lambert")
    with pytest.raises(MeshdepictError, match="this ScaleSpace is of what stands alone: give its"):
        md.bake_together([md.scale_space(torus, scales=0)], "lambert")
    with pytest.raises(MeshdepictError, match="is no sequence of meshes: give at least one in"):
        md.bake_together(torus, "lambert")
    with pytest.raises(MeshdepictError, match="3 of object 1 is no name of a choice"):
        md.bake_together([(torus, {3: 4})], "lambert")
    with pytest.raises(MeshdepictError, match="nothing stands together: give at least one object"):
        md.bake_together([], "lambert")
    with pytest.raises(MeshdepictError, match="object 2: albedo='keep' needs the object's own"):
        md.bake_together([torus, (torus, {"albedo": "keep"})], "lambert")


def test_rays_that_memory_does_not_hold_are_traced_again(torus, globe):
    options = {"light": SIDE, "bounces": 2, "rays": 256, "shadows": True}
    kept = md.bake_together([torus, globe], "lambert", **options)
    try:
        limits.set_max_memory("2MB")
        again = md.bake_together([torus, globe], "lambert", **options)
    finally:
        limits.set_max_memory(None)
    assert type(again[0].space.transport(256)) is not type(kept[0].space.transport(256))
    for one, other in zip(kept, again, strict=True):
        np.testing.assert_array_equal(one.intensity, other.intensity)


def test_an_object_much_smaller_than_its_scene_is_said(torus, globe):
    with pytest.warns(MeshdepictWarning, match="object 2 is 0.003 of the scene: light between"):
        md.bake_together([torus, moved(globe, (1100, 0, 0))], "lambert")


# --- mirrors among them -----------------------------------------------------------------------


@pytest.fixture
def evenly():
    return Environment(np.full((16, 32, 3), 0.4, np.float32))


def mirrored_into(ball, centre):
    """Which vertices of a mirror ball turn the front's rays to a unit ball, and which past it."""
    normals = ball.vertices
    away = 2 * normals[:, 2:] * normals - np.array((0.0, 0, 1))
    along = np.einsum("ij,ij->i", np.array(centre) - ball.vertices, away)
    past = np.linalg.norm(np.array(centre) - ball.vertices - along[:, None] * away, axis=1)
    seen = normals[:, 2] > 0.1
    return seen & (past < 0.9) & (along > 0), seen & ((past > 1.1) | (along < 0))


MIRROR = {"method": "radiance_scaling", "material": "mirror", "magnitude": 0.0}


def test_a_mirror_alone_is_its_bake(torus, evenly):
    own = {"material": "mirror", "shadows": True, "bounces": 2, "light": evenly, "scales": 2}
    own["exposure"] = 0.5
    plain = md.bake(torus, "radiance_scaling", **own)
    [alone] = md.bake_together([torus], "radiance_scaling", **own)
    np.testing.assert_array_equal(alone.colors, plain.colors)


def test_a_mirror_shows_what_stands_beside_it_in_its_colours(evenly):
    red = md.samples.sphere(600)
    tint = {"red": np.full(len(red.vertices), 255, np.uint8)}
    tint["green"] = tint["blue"] = np.zeros(len(red.vertices), np.uint8)
    red = md.Mesh(red.vertices + np.array((2.5, 0, 0)), red.faces, attributes={"vertex": tint})
    ball = md.samples.sphere(600)
    options = {"light": evenly, "bounces": 2, "rays": 64, "view": "front"}
    mirror, matt = md.bake_together(
        [(ball, MIRROR), (red, {"albedo": "keep", **MATT, "diffuse": 1.0})], "phong", **options
    )
    shown = mirror.intensity.astype(float)
    reddish = shown[:, 0] - shown[:, 1] > 0.2
    met, missed = mirrored_into(ball, (2.5, 0, 0))
    assert reddish[met].all()
    assert not reddish[missed].any()
    np.testing.assert_allclose(shown[missed], 0.4, rtol=0.01)
    # What it shows there is what the other one sends: its light of the sky, in its colour.
    assert shown[reddish, 0].max() <= matt.intensity[:, 0].max() + 1e-3
    assert shown[reddish, 1].max() < 0.02


def test_what_is_matt_is_dark_in_a_mirror_before_any_light_bounced(evenly):
    ball, other = md.samples.sphere(600), moved(md.samples.sphere(600), (2.5, 0, 0))
    options = {"light": evenly, "shadows": True, "rays": 64}
    mirror, _ = md.bake_together([(ball, MIRROR), other], "phong", **options)
    met, missed = mirrored_into(ball, (2.5, 0, 0))
    assert not mirror.intensity[met].any()
    np.testing.assert_allclose(mirror.intensity[missed], 0.4, rtol=0.01)


def test_two_mirrors_show_each_other(evenly):
    ball, other = md.samples.sphere(600), moved(md.samples.sphere(600), (2.5, 0, 0))
    both = md.bake_together([ball, other], **MIRROR, light=evenly, bounces=4)
    for mirror in both:
        np.testing.assert_allclose(mirror.intensity, 0.4, rtol=0.02)


def test_the_scaling_of_mirrors_is_of_their_own_curvature(globe, evenly):
    ball = moved(md.samples.sphere(600), (-5.0, 0.3, 0.2))
    own = {**MIRROR, "magnitude": 4.0, "curvature": "object", "enhance": "all", "scales": 2}
    mirror, _ = md.bake_together([(ball, own), (globe, own)], "phong", light=evenly, bounces=2)
    assert np.isfinite(mirror.intensity).all()


def test_what_can_have_no_bounces_is_silent(globe):
    ball = moved(md.samples.sphere(600), (-5.0, 0.3, 0.2))
    own = {"method": "radiance_scaling", "material": "lit_sphere", "bounces": 0}
    got = bounced_to(ball, globe, own, light=(-1, 0, 0.3), exposure=0.5)
    assert got.max() < 0.003
