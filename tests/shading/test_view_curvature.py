"""The picture of Light Warping's descriptor: warm, cold and black in the right places."""

import numpy as np
import pytest

from meshdepict import Look, bake, samples, scale_space, shading
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View
from meshdepict.shapes.mesh import Mesh

LIGHT = "northwest"  # it isn't looked at
FLAT = np.array([0.93, 0.92, 0.89])


def front(height=1.3):
    return View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=height)


def space_of(mesh):
    return scale_space(mesh, scales=1, width=mesh.edge_length / 10)


def test_bumps_are_cold_and_hollows_warm():
    ball = samples.sphere(2_500)
    facing = ball.vertices[:, 2] > 0.5
    bump = shading.view_curvature(space_of(ball), LIGHT, view=front(), gain=200)[facing]
    assert (bump[:, 2] > bump[:, 0] + 0.2).all()
    # The same ball seen from inside.
    bowl = Mesh(ball.vertices, ball.faces[:, ::-1], winding="keep")
    hollow = shading.view_curvature(space_of(bowl), LIGHT, view=front(), gain=200)[
        ball.vertices[:, 2] < -0.5
    ]
    assert (hollow[:, 0] > hollow[:, 2] + 0.2).all()


def test_a_plane_facing_the_eye_is_neutral_and_so_is_everything_without_gain():
    sheet = samples.wavy_sheet(400, amplitude=0)
    found = shading.view_curvature(space_of(sheet), LIGHT, view=front())
    np.testing.assert_allclose(found, np.broadcast_to(FLAT, found.shape), atol=1e-6)
    ball = samples.sphere(2_500)
    found = shading.view_curvature(space_of(ball), LIGHT, view=front(), gain=0)
    facing = ball.vertices[:, 2] > 0.5
    np.testing.assert_allclose(found[facing], np.broadcast_to(FLAT, found[facing].shape), atol=1e-6)


def test_silhouettes_and_what_faces_away_are_black():
    ball = samples.sphere(2_500)
    found = shading.view_curvature(space_of(ball), LIGHT, view=front())
    assert found[ball.vertices[:, 2] < -0.05].max() == 0
    assert found[np.abs(ball.vertices[:, 2]) < 0.02].max() < 0.1
    assert found[ball.vertices[:, 2] > 0.25].min() > 0.05


def test_a_smaller_picture_has_more_curvature_per_pixel():
    ball = space_of(samples.sphere(2_500))
    large, small = (
        shading.view_curvature(ball, LIGHT, view=front(height)) for height in (1.3, 13.0)
    )
    top = int(np.argmax(ball.points[:, 2]))
    cold = np.array([0.10, 0.35, 0.75])
    assert np.abs(small[top] - cold).sum() < np.abs(large[top] - cold).sum()


def test_the_light_does_not_matter(ball):
    space = scale_space(ball, scales=1)
    one, other = (shading.view_curvature(space, light, view=front()) for light in ("front", None))
    np.testing.assert_array_equal(one, other)


def test_bake_passes_its_view(ball):
    one, other = (bake(ball, "view_curvature", view=view) for view in ("front", "left"))
    assert one.colors.shape == (len(ball.vertices), 3)
    assert (one.colors != other.colors).any()
    again = shading.view_curvature(
        scale_space(ball, scales=1), LIGHT, view=View.fitted("left", ball)
    )
    np.testing.assert_allclose(other.intensity, again, atol=1e-4)


def test_a_wider_scale_keeps_only_wide_features(ball):
    space = scale_space(ball, scales=7)
    spread = [
        np.ptp(
            shading.view_curvature(space, LIGHT, view=front(), scale=scale)[
                ball.vertices[:, 2] > 0.7
            ]
        )
        for scale in (0, 7)
    ]
    assert spread[1] < 0.5 * spread[0]


def test_foreshortening_zero_sees_the_curvature_of_a_sphere_everywhere():
    ball = samples.sphere(2_500)
    found = shading.view_curvature(space_of(ball), LIGHT, view=front(), gain=100, foreshortening=0)
    facing = ball.vertices[:, 2] > 0.3
    assert np.ptp(found[facing], axis=0).max() < 0.15
    steep = shading.view_curvature(space_of(ball), LIGHT, view=front(), gain=100)
    assert np.ptp(steep[facing], axis=0).max() > 0.3


def test_importance_chooses_between_scales(ball):
    space = scale_space(ball, scales=4)
    count = len(space.points)

    def shown(**options):
        return shading.view_curvature(space, LIGHT, view=front(), **options)

    for share, scale in ((1.0, 1), (0.0, 4), (2 / 3, 2)):
        found = shown(importance=np.full(count, share))
        np.testing.assert_allclose(found, shown(scale=scale), atol=1e-5)
    middle = shown(importance="0,0,1,0.4")
    near = np.linalg.norm(ball.vertices - [0, 0, 1], axis=1) < 0.02
    far = (np.linalg.norm(ball.vertices - [0, 0, 1], axis=1) > 1.2) & (ball.vertices[:, 2] > 0)
    assert near.any()
    np.testing.assert_allclose(middle[near], shown()[near], atol=0.02)
    np.testing.assert_allclose(middle[far], shown(scale=4)[far], atol=0.05)
    assert Look("view_curvature", importance="0,0,1").reads(4).seen == {1, 2, 3, 4}
    assert Look("view_curvature").reads(4).seen == {1}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scale": 2}, "scale=2 is not one of the scale space's, 0 to 1"),
        ({"gain": -1}, "view_curvature: gain=-1 is not a number in its range"),
        ({"foreshortening": 11}, "foreshortening=11 is not a number in its range"),
        ({"view": "frnt"}, "no view is called 'frnt'"),
    ],
)
def test_errors(ball, options, message):
    with pytest.raises(MeshdepictError, match=message):
        shading.view_curvature(scale_space(ball, scales=1), LIGHT, **options)
