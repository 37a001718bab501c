"""A ground that is a mirror: what it shows, by rays and as what is turned over, and sends on."""

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict.baking.baked import Baked
from meshdepict.baking.mirror_image import MirrorImage
from meshdepict.drawing.picture import drawn
from meshdepict.scene.environment import Environment
from meshdepict.scene.view import View

LIT = {"light": (-0.4, 1, 0.3), "ground": "mirror"}


@pytest.fixture(scope="module")
def ball():
    return md.samples.golf_ball(3_000, dimples=32)


@pytest.fixture(params=["parallel", "perspective"])
def eye(request):
    kind = {"parallel_scale": 5} if request.param == "parallel" else {"field_of_view": 35}
    return View((6, 7, 12), (0, -0.6, 0), (0, 1, 0), **kind)


def test_objects_are_turned_over_at_the_plane(ball, eye):
    ground = md.ground_under(ball, mirror=True)
    image = MirrorImage(ground, [ball], eye)
    below = image.vertices[: len(ball.vertices)]
    middle = (below + ball.vertices) / 2
    np.testing.assert_allclose((middle - ground.middle) @ ground.up, 0, atol=1e-12)
    np.testing.assert_allclose((below - ball.vertices)[:, [0, 2]], 0, atol=1e-12)
    # Turned over, its faces look outwards still.
    a, b, c = (below[corner] for corner in image.faces[: len(ball.faces)].T)
    volume = np.einsum("ij,ij->i", np.cross(a, b), c).sum()
    assert volume > 0


def test_the_sky_lies_behind_all_of_them_where_the_ground_is_seen(ball, eye):
    ground = md.ground_under(ball, mirror=True)
    image = MirrorImage(ground, [ball], eye)
    turned, sky = np.split(image.vertices, [len(ball.vertices)])
    depth = (image.vertices - eye.position) @ -eye.towards_eye
    shown = image.coverage[len(turned) :] > 0
    assert depth[len(turned) :][shown].min() > depth[: len(turned)].max()
    away, place = ((points - eye.position)[shown] for points in (sky, ground.vertices))
    if eye.parallel_scale is None:
        away, place = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (away, place))
    across = eye.frame[:2]
    np.testing.assert_allclose(away @ across.T, place @ across.T, atol=1e-9)


def test_rays_and_the_picture_agree(ball, eye):
    baked = md.bake(ball, "half_lambert", view=eye, **LIT)
    scene = baked.scene
    image = scene.shape.meshes[1]
    assert isinstance(image, MirrorImage)
    # What rays from the ground's vertices meet, against the picture of what is turned over, alone.
    ground = md.ground_under(ball, mirror=True)
    first, below = md.bake_together([ball, ground], "half_lambert", view=eye, light=LIT["light"])
    np.testing.assert_array_equal(first.colors, baked.colors)
    alone = Baked(
        image,
        np.zeros(len(image.vertices)),
        scene.colors[len(ball.vertices) :],
        baked.provenance,
        eye,
    )
    size = 600
    picture = drawn(alone, eye, (size, size)).astype(float)
    local = (ground.vertices - eye.position) @ eye.frame.T
    if eye.parallel_scale is None:
        local[:, :2] /= -local[:, 2:] * np.tan(np.radians(eye.field_of_view / 2))
    else:
        local[:, :2] /= eye.parallel_scale
    column, row = ((1 + local[:, :2] * (1, -1)) * size / 2).astype(int).T
    seen = (below.colors[:, 0] > 0) & (ground.coverage == 1)
    assert seen.sum() > 500
    shown = picture[row[seen], column[seen]]
    assert np.median(shown[:, 3]) == 255
    error = np.abs(shown[:, 0] - below.colors[seen, 0])
    assert np.median(error) < 3
    assert (error < 12).mean() > 0.85  # all but contours, and edges of shading between vertices


def test_a_sky_is_mirrored_where_nothing_stands_in_its_way(ball):
    sky = Environment(np.full((16, 32, 3), 0.25, np.float32))
    options = {"light": sky, "view": "isometric", "exposure": 2.0}
    ground = md.ground_under(ball, mirror=True)
    _, below = md.bake_together([ball, ground], "phong", **options)
    shown = below.intensity[:, 0]
    far = np.linalg.norm(ground.vertices - ground.middle, axis=1) > 3 * ball.diagonal / 2
    np.testing.assert_allclose(shown[far], 0.5, rtol=1e-3)
    assert (np.abs(shown - 0.5) > 0.05).any()  # and the ball where it does
    scene = md.bake(ball, "phong", ground="mirror", **options).scene
    assert (scene.shape.coverage[-len(ground.vertices) :] == ground.coverage).all()
    plain = md.bake(ball, "phong", ground="mirror", view="isometric").scene
    assert not plain.shape.coverage[-len(ground.vertices) :].any()


def test_from_below_nothing_is_mirrored(ball):
    under = View((3, -9, 5), (0, 0, 0), (0, 1, 0), parallel_scale=4)
    baked = md.bake(ball, "lambert", view=under, **LIT)
    assert not baked.scene.shape.coverage[len(ball.vertices) :].any()
    ground = md.ground_under(ball, mirror=True)
    _, below = md.bake_together([ball, ground], "lambert", view=under, light=LIT["light"])
    assert not below.colors.any()


def test_it_is_in_the_way_of_light_and_sends_none_to_every_side(ball):
    options = {"light": (0, 1, 0.2), "shadows": True, "bounces": 2, "rays": 64}
    alone = md.bake(ball, "lambert", **options).intensity
    matt, mirror = (
        md.bake(ball, "lambert", ground=kind, **options).intensity for kind in ("matt", "mirror")
    )
    assert (matt - mirror).max() > 0.2
    assert np.abs(mirror - alone).max() < 0.05


def test_the_command_takes_it(run, ball_ply):
    status, _, _ = run(
        "bake", "ball.ply", "-m", "lambert", "--ground", "mirror", "--picture", "a.png", "--view",
        "isometric",
    )  # fmt: skip
    assert status == 0
    assert any("ground: mirror" in line for line in md.io.read_provenance("ball-lambert.ply"))
    pixels = np.asarray(Image.open("a.png").convert("L")).astype(int)
    inked = np.flatnonzero((pixels < 250).any(axis=1))
    across = np.flatnonzero((pixels < 250).any(axis=0))
    assert np.ptp(inked) > 1.3 * np.ptp(across)  # the ball, and what is turned over below it


def test_a_mirror_above_it_shows_what_it_turns_back():
    """Light from above alone: below the horizon there is the sky once more, from the ground.

    Not all of it: some rays that the ground turns back meet the ball again.
    """
    half = np.zeros((32, 64, 3), np.float32)
    half[:16] = (0.2, 0.3, 0.5)
    mirror = {"material": "mirror", "magnitude": 0.0, "bounces": 2}
    ball, sky = md.samples.sphere(2000), md.Environment(half)
    alone, above = (
        md.bake(ball, "radiance_scaling", light=sky, ground=ground, **mirror).intensity
        for ground in (None, "mirror")
    )
    lower = (ball.vertices[:, 1] < -0.3) & (ball.vertices[:, 2] > 0.6)
    assert not alone[lower].any()
    whole = np.abs(above[lower] - [0.2, 0.3, 0.5]).max(axis=1) < 0.02
    assert whole.mean() > 0.75
