"""Light Warping's importance: where it comes from, and what it does to curvature."""

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import Look, MeshdepictError, View, samples, scale_space, shading
from meshdepict.options import Range, Samples, Values, check, options_of
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scene.names import as_view
from meshdepict.shading.features import features
from meshdepict.shading.importance import importance_at
from meshdepict.shapes.mesh import Mesh
from meshdepict.viewer.session import Session

FRONT = View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=1.5)


def ball_with(**attributes):
    mesh = samples.golf_ball(1_500, dimples=12, depth=0.05)
    values = {name: make(mesh.vertices) for name, make in attributes.items()}
    return Mesh(mesh.vertices, mesh.faces, attributes={"vertex": values})


@pytest.fixture(scope="module")
def ball():
    return ball_with(
        care=lambda v: (0.5 + 0.4 * v[:, 0]).astype(np.float32),
        painted=lambda v: np.where(v[:, 1] > 0, 255, 51).astype(np.uint8),
        height=lambda v: v[:, 2] * 10,
        normal=lambda v: v,
    )


@pytest.fixture(scope="module")
def space(ball):
    return scale_space(ball, scales=3)


def warped(space, **options):
    return shading.light_warping(space, ["northwest", "southeast"], **options)


# --- what it does ---------------------------------------------------------------------------


@pytest.mark.parametrize("curvature", ["object", "view"])
def test_one_everywhere_is_none_and_zero_the_coarsest_scale(space, curvature):
    ones, zeros = np.ones(len(space.points)), np.zeros(len(space.points))
    options = {"curvature": curvature, "view": FRONT}
    np.testing.assert_array_equal(
        warped(space, importance=ones, **options), warped(space, **options)
    )
    np.testing.assert_array_equal(
        warped(space, importance=zeros, **options), warped(space, scale=3, **options)
    )
    half = warped(space, importance=ones / 2, **options)
    np.testing.assert_array_equal(half, warped(space, scale=2, **options))


@pytest.mark.parametrize("curvature", ["object", "view"])
def test_between_two_scales_nothing_jumps(space, curvature):
    def at(share):
        found = features(
            space, FRONT, curvature=curvature, scale=1, gain=None,
            importance=np.full(len(space.points), share),
        )  # fmt: skip
        axes = np.stack([found.u, found.v, found.z], axis=1).astype(float)
        assert np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max() < 1e-5
        assert (np.linalg.det(axes) > 0).all()
        bends = found.ku[:, None, None] * found.u[:, :, None] * found.u[:, None]
        return bends + found.kv[:, None, None] * found.v[:, :, None] * found.v[:, None]

    whole, beside = at(0.5), [at(0.5 - 1e-4), at(0.5 + 1e-4)]
    size = np.abs(whole).max()
    for other in beside:
        assert np.abs(other - whole).max() < 1e-3 * size
    # Half-way between scales 1 and 2 the tensor is nearly the mean of both: they are of planes
    # that differ by the angle between their normals alone.
    mean = (at(1.0) + whole) / 2
    turn = np.arccos(np.clip((space.normals[1] * space.normals[2]).sum(axis=1), -1, 1)).max()
    assert np.abs(at(0.75) - mean).max() < 2 * np.sin(turn) * max(size, np.abs(at(1.0)).max())


def test_without_coarser_scales_there_is_nothing_to_choose(ball):
    for scales, scale in ((1, 1), (3, 3)):
        with pytest.raises(MeshdepictError, match=r"there are none: make more with scales=5"):
            warped(scale_space(ball, scales=scales), scale=scale, importance="care")


# --- where it comes from --------------------------------------------------------------------


def test_an_attribute_by_its_name(ball, space):
    care = ball.attributes["vertex"]["care"]
    np.testing.assert_allclose(importance_at(space, FRONT, "care"), care)
    np.testing.assert_array_equal(warped(space, importance="care"), warped(space, importance=care))
    bytes_ = importance_at(space, FRONT, "painted")
    np.testing.assert_allclose(np.unique(bytes_), [0.2, 1.0])


def test_an_attribute_between_vertices_and_in_pixels(ball, space):
    corners, weights = ball.faces[:40], np.full((40, 3), 1 / 3)
    between = InterpolatedSpace(space, corners, weights)
    care = ball.attributes["vertex"]["care"]
    expected = care[corners].mean(axis=1)
    np.testing.assert_allclose(importance_at(between, FRONT, "care"), expected, atol=1e-6)
    np.testing.assert_allclose(importance_at(between, FRONT, care), expected, atol=1e-6)
    buffer = md.GBuffer.of(ball, FRONT, size=(40, 40))
    pixels = scale_space(buffer, scales=2)
    found = importance_at(pixels, buffer.view, "care")
    np.testing.assert_allclose(found, buffer.sample(care))


@pytest.mark.parametrize(("text", "radius"), [("0.1,-0.2,0.9,0.3", 0.3), ("0.1, -0.2, 0.9", None)])
def test_a_point_and_how_far_around_it(ball, space, text, radius):
    away = np.linalg.norm(ball.vertices - [0.1, -0.2, 0.9], axis=1)
    expected = np.exp(-0.5 * (away / (radius or 0.1 * ball.diagonal)) ** 2)
    np.testing.assert_allclose(importance_at(space, FRONT, text), expected, atol=1e-6)
    numbers = [float(part) for part in text.split(",")]
    np.testing.assert_array_equal(warped(space, importance=numbers), warped(space, importance=text))


@pytest.fixture
def ramp(tmp_path):
    """A picture twice as wide as high that brightens from left to right, in 16 bits."""
    path = tmp_path / "ramp.png"
    Image.fromarray(np.tile(np.linspace(0, 65535, 200).astype(np.uint16), (100, 1))).save(path)
    return path


def test_an_image_lies_over_the_picture_of_the_view(ball, space, ramp):
    found = importance_at(space, FRONT, str(ramp))
    # 3 units high and 6 wide, pixel middles from 0 to 1.
    across = np.clip((ball.vertices[:, 0] / 6 + 0.5) * 200 - 0.5, 0, 199) / 199
    np.testing.assert_allclose(found, across, atol=1e-4)
    # Of a named view it is the picture of these proportions, which shows all of the ball.
    named = importance_at(space, as_view("left", ball), str(ramp))
    eye = View.fitted("left", ball, aspect=2.0)
    right = (ball.vertices - eye.focus) @ eye.frame[0]
    across = np.clip((right / (4 * eye.parallel_scale) + 0.5) * 200 - 0.5, 0, 199) / 199
    np.testing.assert_allclose(named, across, atol=1e-4)


def test_perspective_and_what_lies_outside_or_behind(ball, space, tmp_path):
    path = tmp_path / "white.png"
    Image.new("L", (64, 64), 255).save(path)
    eye = View((0, 0, 4), (0, 0, 0), (0, 1, 0), field_of_view=10)
    found = importance_at(space, eye, str(path))
    x, y, z = ball.vertices.T
    reach = (4 - z) * np.tan(np.radians(5))
    inside = np.maximum(np.abs(x), np.abs(y)) < reach
    np.testing.assert_allclose(found, inside, atol=1e-12)
    within = View((0, 0, 0.2), (0, 0, 0), (0, 1, 0), field_of_view=90)
    assert not importance_at(space, within, str(path))[z > 0.2].any()


def test_colours_are_as_bright_as_they_look_and_clear_parts_dark(space, tmp_path):
    for mode, color, expected in (
        ("RGB", (0, 255, 0), 0.7152), ("RGBA", (255, 255, 255, 51), 0.2), ("LA", (102, 255), 0.4),
        ("1", 1, 1.0),
    ):  # fmt: skip
        path = tmp_path / f"{mode}.png"
        Image.new(mode, (32, 32), color).save(path)
        found = importance_at(space, FRONT, str(path))
        np.testing.assert_allclose(found, expected, atol=1e-6)


def test_an_image_of_pixels_has_their_size(ball, tmp_path, ramp):
    buffer = md.GBuffer.of(ball, FRONT, size=(200, 100))
    pixels = scale_space(buffer, scales=2)
    found = importance_at(pixels, buffer.view, str(ramp))
    columns = np.nonzero(buffer.mask)[1]
    np.testing.assert_allclose(found, columns / 199, atol=1e-4)
    whole = np.tile(np.linspace(0, 1, 200), (100, 1))
    np.testing.assert_allclose(importance_at(pixels, buffer.view, whole), columns / 199)
    other = scale_space(md.GBuffer.of(ball, FRONT, size=(50, 50)), scales=2)
    with pytest.raises(MeshdepictError, match=r"has 200 x 100 pixels, and the picture .* 50 x 50"):
        importance_at(other, FRONT, str(ramp))


@pytest.mark.parametrize(
    ("importance", "sentence"),
    [
        ("kare", r"'kare' is no vertex attribute \(the vertices have care, painted, height\); did "
         "you mean 'care'"),
        ("height", r"the attribute 'height' goes from -1\d?.* to .*: scale it to 0"),
        ("normal", "the attribute 'normal' is not one number a vertex"),
        ("nowhere.png", "nowhere.png: no such file"),
        ("1,2,3,0", "no point x,y,z or x,y,z,radius"),
        ("1,2", "no point x,y,z or x,y,z,radius"),
        ("1,2,nan", "no point x,y,z or x,y,z,radius"),
        (np.ones(5), "importance must be .* numbers from 0 to 1"),
        (np.full(1442, 1.5), "importance must be .* numbers from 0 to 1"),
        (0.5, "importance=0.5 is neither a text"),
        (True, "importance=True is neither a text"),
        ("  ", "importance='  ' is neither a text"),
        (["a"], "is neither a text"),
        ([], "is neither a text"),
        (np.ones((2, 2, 2)), "is neither a text"),
    ],
    ids=str,
)  # fmt: skip
def test_what_is_no_importance_is_refused(space, importance, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        warped(space, importance=importance)


def test_volumes_and_images_of_files_have_points_alone(tmp_path):
    grid = md.bake_volume(samples.ct_phantom((20, 20, 20)), "light_warping", scales=2).space
    with pytest.raises(MeshdepictError, match="the vertices have none"):
        warped(grid, importance="care")
    middle = ",".join(map(str, grid.shape.centre))
    assert importance_at(grid, FRONT, middle).max() > 0.5


def test_a_strange_image_is_refused(space, tmp_path):
    path = tmp_path / "odd.npy"
    for array in (np.full((4, 4), 2.0), np.zeros((2, 2, 5)), np.full((3, 3), np.nan)):
        np.save(path, array)
        with pytest.raises(MeshdepictError, match="an image of importance is grey or coloured"):
            importance_at(space, FRONT, str(path))


# --- the doors ------------------------------------------------------------------------------


def test_an_option_of_values_takes_texts_and_arrays():
    option = options_of(shading.light_warping)["importance"]
    assert option.accepts == Values(help=option.help)
    assert str(option.accepts) == "a vertex attribute | an image | x,y,z[,radius]"
    given = {"importance": (1, 2.5, -3)}
    assert check(shading.light_warping, given, "here") == {"importance": "1.0,2.5,-3.0"}
    array = np.linspace(0, 1, 7)
    kept = check(shading.light_warping, {"importance": array}, "here")["importance"]
    assert isinstance(kept, Samples)
    array[:] = 9
    np.testing.assert_array_equal(np.asarray(kept), np.linspace(0, 1, 7))
    assert repr(kept) == "7 numbers"
    assert isinstance(options_of(shading.light_warping)["gain"].accepts, Range)


def test_bakes_and_their_provenance(ball):
    care = ball.attributes["vertex"]["care"]
    one = md.bake(ball, "light_warping", scales=3, importance="care")
    other = md.bake(ball, "light_warping", scales=3, importance=care)
    np.testing.assert_array_equal(one.intensity, other.intensity)
    assert "importance=care" in one.provenance["options"]
    assert "importance=1,442 numbers" in other.provenance["options"]
    session = Session(ball, "light_warping", scales=3, importance=care)
    np.testing.assert_array_equal(session.baked().intensity, other.intensity)


def test_a_bake_that_splits_triangles_takes_it_along(ball):
    baked = md.bake(ball, "light_warping", scales=3, importance="care", refine=60.0)
    assert len(baked.intensity) == len(baked.shape.vertices)


def test_the_command_takes_attributes_images_and_points(run, folder, ball):
    md.io.write_mesh("ball.ply", ball)
    Image.new("L", (8, 8), 0).save("black.png")
    words = ("bake", "ball.ply", "-m", "light_warping", "--scales", 3, "--quiet", "--force")
    for text in ("care", "black.png", "0,0,1", "0,0,1,0.5"):
        status, _, err = run(*words, "--set", f"importance={text}")
        assert (status, err) == (0, [])
    status, _, err = run(*words, "--set", "importance=kare")
    assert status != 0
    assert "did you mean 'care'" in err[0]
    status, _, err = run("bake", "ball.ply", "-m", "light_warping", "--set", "importance=care")
    assert status != 0
    assert "--scales 5" in err[0]


def test_recipes_hold_texts_and_name_files_beside_them(folder, ball):
    Image.new("L", (8, 8), 0).save("mask.png")
    Look("light_warping", importance="mask.png").save("look.toml")
    assert Look.load("look.toml").options["importance"] == "mask.png"
    Look("light_warping", importance=(0, 0, 1)).save("point.toml")
    assert Look.load("point.toml").options["importance"] == "0.0,0.0,1.0"
    with pytest.raises(MeshdepictError, match="names only files in its own folder"):
        Look("light_warping", importance="../mask.png").save("other.toml")
    with pytest.raises(MeshdepictError, match="a recipe can't hold importance=5 numbers"):
        Look("light_warping", importance=np.ones(5)).save("other.toml")
