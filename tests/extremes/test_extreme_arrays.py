"""NaN, infinity, denormals and what are no numbers, in every array of every shape."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from extreme_calls import proper, taken_or_refused, usual
from odd_meshes import golf_ball
from PIL import Image

import meshdepict as md
from meshdepict.curvature import principal_curvatures
from meshdepict.files.any_numbers import real_array
from meshdepict.shading import METHODS
from meshdepict.shapes.textures import Texture, Textures

pytestmark = [
    pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning"),
    pytest.mark.unwatched,  # NaN goes in, and is refused later, or is none of ours
]

ODD = [np.nan, np.inf, -np.inf, 1e300, -1e300, 1e39, 5e-324, 1e-300]
NONE = [
    np.longdouble("1e4000"), 1j, None, 10**400, "x", b"x", np.datetime64("2000-01-01"), True,
]  # fmt: skip


def spoiled(array):
    """Yield an array with one odd number, with nothing else, and what holds no numbers."""
    for value in ODD:
        one = np.array(array, float)
        one.reshape(-1)[one.size // 2] = value
        yield one
        yield np.full(np.shape(array), value)
    for value in NONE:
        yield np.full(np.shape(array), value)
    yield np.ma.masked_all(np.shape(array))
    hidden = np.arange(np.size(array)).reshape(np.shape(array)) == 1
    yield np.ma.masked_array(np.array(array, float), hidden)
    yield np.empty((0, *np.shape(array)[1:]))
    yield np.asarray(array, np.float16)


BALL = md.Mesh(*golf_ball())
COUNT = len(BALL.vertices)
SPACE = md.scale_space(BALL, scales=2)
ENVIRONMENT = np.random.default_rng(1).random((2, 4, 3))
CUBE = np.arange(64.0).reshape(4, 4, 4)
FLAT = np.tile([0.0, 0.0, 1.0], (42, 1))
EYE = md.View((0, 0, 5), (0, 0, 0), (0, 1, 0), height_px=6, field_of_view=30)


def shaded(space, *methods, light="northwest", **options):
    for method in methods:
        proper(METHODS[method](space, light, **usual(method), **options), space.count)


def colored(values, **more):
    mesh = md.Mesh(
        BALL.vertices, BALL.faces,
        attributes={"vertex": dict.fromkeys(("red", "green", "blue", "quality"), values)},
    )  # fmt: skip
    assert np.isfinite(md.bake(mesh, "lambert", albedo="keep").colors).all()
    md.bake(mesh, "lambert", **more)


def lit(pixels):
    light = md.Environment(pixels)
    shaded(SPACE, "phong", "cook_torrance", "light_alignment", "light_warping", light=light)
    shaded(SPACE, "radiance_scaling", light=light, illumination="irradiance")
    shaded(SPACE, "radiance_scaling", light=light, material="mirror")
    shaded(SPACE, "light_warping", light=light, material="refractive")
    shaded(SPACE, "light_warping", light=light, quadrature="directions")
    shaded(SPACE, "cook_torrance", light=light, shadows=True)


def tinted(color):
    light = md.Light((0, 0, 1), color=color)
    shaded(SPACE, "lambert", "toon", "gooch", "aspect", "phong", light=light)
    several = [light, md.Light((1, 0, 1), color=color)]
    shaded(SPACE, "cook_torrance", "light_warping", "radiance_scaling", light=several)
    shaded(SPACE, "light_alignment", light=several)


def pictured(**parts):
    usual_parts = {"mask": np.ones((6, 7), bool), "normals": FLAT, "depths": np.ones(42)}
    space = md.scale_space(md.GBuffer(EYE, **(usual_parts | parts)), scales=2)
    shaded(space, "exaggerated", "light_warping", "light_alignment", "mean_curvature")


def decoded(normals=None, **parts):
    normals = FLAT.reshape(6, 7, 3) if normals is None else normals
    space = md.scale_space(md.GBuffer.from_images(normals, **parts), scales=2)
    shaded(space, "exaggerated", "light_warping", "light_alignment", "mean_curvature")


def texel():
    bytes_ = io.BytesIO()
    Image.fromarray(np.array([[[255, 100, 7]]], np.uint8)).save(bytes_, "png")
    return Texture("one", bytes_.getvalue(), "png")


LAID = Textures(
    np.random.default_rng(2).random((len(BALL.faces), 3, 2)), np.zeros(len(BALL.faces), int),
    (texel(),), np.ones((1, 4)), (texel(),), np.ones(1),
)  # fmt: skip


def laid(**parts):
    mesh = BALL.with_textures(replace(LAID, **parts))
    assert np.isfinite(md.bake(mesh, "lambert", albedo="keep").colors).all()
    md.bake_texture(mesh, "lambert", size=128, albedo="keep", atlas="new")


ARRAYS = {
    "vertices": (BALL.vertices, lambda a: md.bake(md.Mesh(a, BALL.faces), "lambert")),
    "faces": (BALL.faces, lambda a: md.bake(md.Mesh(BALL.vertices, a), "lambert")),
    "colours": (np.ones(COUNT), colored),
    "importance by name": (
        np.ones(COUNT), lambda a: shaded(md.scale_space(md.Mesh(
            BALL.vertices, BALL.faces, attributes={"vertex": {"quality": a}}), scales=2),
            "light_warping", importance="quality")),
    "importance": (np.ones(COUNT), lambda a: shaded(SPACE, "light_warping", importance=a)),
    "normals": (BALL.normals, lambda a: principal_curvatures(BALL, normals=a)),
    "an environment": (ENVIRONMENT, lit),
    "a light": ((0.0, 0.5, 1.0), lambda a: shaded(SPACE, "lambert", "phong", light=a)),
    "a light's colour": ((1.0, 0.5, 0.2), tinted),
    "an eye": ((0.0, 0.0, 5.0), lambda a: md.View(a, (0, 0, 0), (0, 1, 0), parallel_scale=1)),
    "a focus": ((0.0, 0.0, 5.0), lambda a: md.View((1, 1, 1), a, (0, 1, 0), parallel_scale=1)),
    "heights": (np.ones((5, 6)), lambda a: md.bake(md.HeightField(a), "exaggerated", scales=1)),
    "a transform": (
        (1, 0, 0, 0, -1, 0), lambda a: md.bake(md.HeightField(np.eye(4), transform=a), "lambert")),
    "a volume": (CUBE, lambda a: md.bake_volume(md.Volume(a), scales=1)),
    "spacing": ((1.0, 1.0, 2.0), lambda a: md.bake_volume(md.Volume(CUBE, spacing=a), scales=1)),
    "an origin": ((1.0, 1.0, 2.0), lambda a: md.bake_volume(md.Volume(CUBE, origin=a), scales=1)),
    "a direction": (np.eye(3), lambda a: md.Volume(CUBE, direction=a)),
    "depths": (np.ones(42), lambda a: pictured(depths=a)),
    "normals of pixels": (FLAT, lambda a: pictured(normals=a)),
    "openness": (np.ones(42), lambda a: pictured(openness=a, silhouettes="occlusion")),
    "colours of pixels": (np.ones((42, 3)), lambda a: pictured(colors=a)),
    "a mask": (np.ones((6, 7)), lambda a: pictured(mask=a)),
    "a normal map": (FLAT.reshape(6, 7, 3), decoded),
    "a depth map": (np.ones((6, 7)), lambda a: decoded(depth=a)),
    "a depth map to be fitted": (np.ones((6, 7)), lambda a: decoded(depth=a, depth_scale="fit")),
    "an occlusion map": (np.ones((6, 7)), lambda a: decoded(occlusion=a)),
    "a colour map": (np.ones((6, 7, 3)), lambda a: decoded(colors=a)),
    "texture coordinates": (LAID.texcoords, lambda a: laid(texcoords=a)),
    "factors": (LAID.factors, lambda a: laid(factors=a)),
    "scales of normal maps": (LAID.normal_scales, lambda a: laid(normal_scales=a)),
    "materials of triangles": (LAID.material, lambda a: laid(material=a)),
    "coordinates of normal maps": (LAID.texcoords, lambda a: laid(normal_texcoords=a)),
}  # fmt: skip


@pytest.mark.parametrize("name", ARRAYS)
def test_any_number_in_any_array_is_taken_or_refused(name):
    array, use = ARRAYS[name]
    refusals = 0
    for given in spoiled(array):
        before = given.copy()
        taken = False
        with taken_or_refused():
            use(given)
            taken = True
        refusals += not taken
        assert repr(given) == repr(before)
    assert refusals


@pytest.mark.parametrize("value", ["1", b"1", 1j, np.datetime64("2000-01-01"), 10**400])
def test_what_is_no_real_number_makes_no_array(value):
    assert real_array([value, value]) is None


def test_arrays_of_real_numbers_are_new_doubles_and_masked_ones_nan():
    given = np.ma.masked_array([[1, 2], [3, 4]], [[False, True], [False, False]])
    found = real_array(given.T)
    assert found.flags.c_contiguous
    np.testing.assert_array_equal(found, [[1, 3], [np.nan, 4]])
    assert real_array([np.longdouble("1e4000"), 2]).tolist() == [np.inf, 2]
    assert real_array([1e300], np.float32).tolist() == [np.inf]
    own = np.ones(3)
    assert not np.shares_memory(real_array(own), own)


@pytest.mark.parametrize(
    ("make", "said"),
    [(lambda: md.Light((0, 0, 1), color=(1e16, 0, 0)), "from 0 to 1e\\+15"),
     (lambda: md.Environment(np.full((2, 4, 3), 1e13)), "1e\\+12 at most"),
     (lambda: laid(factors=np.full((1, 4), np.inf)), "factors of base colours are NaN"),
     (lambda: laid(material=np.zeros(len(BALL.faces))), "are whole numbers, one for each"),
     (lambda: colored(np.full(COUNT, "x")), "colours must be real numbers")],
)  # fmt: skip
def test_a_limit_is_said(make, said):
    with pytest.raises(md.MeshdepictError, match=said):
        make()


def test_the_brightest_environment_and_light_give_a_picture():
    lit(np.full((2, 4, 3), 1e12))
    tinted((1e15, 0, 1e15))
