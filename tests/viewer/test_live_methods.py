"""Every live method against its bake, picture by picture: the GLSL is the NumPy function."""

import inspect

import numpy as np
import pytest
from live_pictures import compare, difference, drawn, portrait

import meshdepict as md
from meshdepict import samples
from meshdepict.options import options_of
from meshdepict.viewer.live import LiveShading, live_methods
from meshdepict.viewer.live.look import _METHODS

ALIGNED = (0.9, 0.6, 0.4, 0.2, 0.3)

# For every option another value than its default; those of `only` have none that is live.
OPTIONS = {
    "lambert": [{"exposure": 0.6}],
    "half_lambert": [{"exposure": 1.4}],
    "phong": [
        {"ambient": 0.3, "diffuse": 0.4, "exposure": 0.8},
        {"specular": 0.6, "shininess": 4.0},
        {"shininess": 300.0},
    ],
    "exaggerated": [
        {"exaggeration": 40.0, "emphasis": 0.0},
        {"exaggeration": (5.0, 10.0, 20.0, 40.0, 30.0), "base": 6.0},
        {},
        {"contrast": 1.6, "exposure": 0.7},
        {"focus": (0.3, 0.2, 0.9), "radius": 0.4},
        {"focus": (0.0, 0.0, 1.0)},
        {"one_light": False},  # True is terrain's, in test_terrain_session
    ],
    "light_alignment": [
        {"strength": 0.9},
        {"strength": ALIGNED, "diffuse": 0.7, "exposure": 1.3},
        {"material": "phong", "strength": 0.0, "specular_strength": 0.5, "shininess": 8.0},
        {"material": "phong", "sharpness": 0.0, "specular": 0.6},
        {"material": md.scene.material.Phong(0.2, 0.5, 0.4, 10.0), "sharpness": 6.0},
    ],
    "radiance_scaling": [
        {"material": "lambert", "gain": 2.0, "invariant": 0.1, "exposure": 0.8},
        {"anisotropy": 0.6, "scale": 2, "magnitude": 8.0},
        {"ambient_magnitude": 0.0, "diffuse_magnitude": 9.0, "specular_magnitude": 2.0},
        {"curvature": "view", "warping": 4.0, "shininess": 40.0},
        {"curvature": "view", "anisotropy": -1.0, "gain": 1.0},
        {"curvature": "view", "foreshortening": 0.4},
        {"magnitude": 20.0, "gain": 10.0, "ambient_magnitude": 0.0, "shininess": 60.0},
        {"magnitude": 20.0, "gain": 10.0, "ambient_magnitude": 0.0, "exposure": 0.05},
    ],
    "light_warping": [
        {"material": "phong", "contrast": -0.5, "shininess": 5.0},
        {"curvature": "view", "magnitude": -4.0},
        {"curvature": "view", "foreshortening": 0.0, "material": "phong"},
        {"scale": 0, "gain": 0.3, "exposure": 0.5},
        {"magnitude": 0.0},
    ],
}
# Those without a say unless an environment, an occlusion or a transmission does: not refused, no
# effect.
IDLE = {
    "lights": 7, "rays": 9, "transmitted_strength": 0.9, "refraction": 2.0, "frosting": 0.9,
    "enhance": "all", "denoise": 2.0, "interfaces": 2,
}  # fmt: skip
# Of materials that are not live: refused as they are by a bake with Lambert or Phong.
FOREIGN = {"roughness": 0.5, "bins": 4}

CASES = [(name, {}) for name in OPTIONS] + [
    (name, options) for name, several in OPTIONS.items() for options in several
]


@pytest.fixture(scope="module")
def space(ball):
    return md.scale_space(ball, scales=5, ratio=1.7)


@pytest.mark.parametrize(("method", "options"), CASES, ids=str)
def test_the_picture_is_that_of_the_bake(space, method, options):
    found = compare(space, method, options=options, light=(300.0, 40.0))
    # One by the bake's rounding to levels at the vertices, one by the picture's.
    assert found.max() <= 2


def test_every_option_is_compared_refused_or_idle():
    assert set(OPTIONS) == set(live_methods())
    for name, several in OPTIONS.items():
        live = _METHODS[name]
        compared = {option for options in several for option in options}
        others = set(live.only) | set(IDLE) | set(FOREIGN)
        assert set(options_of(live.function)) <= compared | others, name
        assert compared <= set(options_of(live.function))


@pytest.mark.parametrize("method", live_methods())
def test_idle_options_change_nothing(space, method):
    idle = {
        name: value for name, value in IDLE.items() if name in options_of(_METHODS[method].function)
    }
    one = LiveShading(space, method, view="front")
    other = LiveShading(space, method, options=idle, view="front")
    assert (drawn(one) == drawn(other)).all()


@pytest.mark.parametrize("method", live_methods())
@pytest.mark.parametrize("colormap", ["gooch", "stone_r"])
def test_colour_maps(space, method, colormap):
    """A level of grey may be another entry of the table: two of its steps."""
    from meshdepict.color.colormaps import colormap as table

    step = np.abs(np.diff(table(colormap).astype(int), axis=0)).max()
    found = compare(space, method, colormap=colormap)
    assert np.percentile(found, 99.9) <= 2
    assert found.max() <= 2 * step


LAMPS = [
    md.Light((1, 0, 1), color=(0.6, 0.1, 0)),
    md.Light((0, 1, 1), color=(0, 0.3, 0.4)),
    "front",
    "south",
    (30, 40),
    (1, 2, 3),
    md.Light((0, 0, -1)),
    md.Light((-1, 0, 0), color=(0.1, 0.1, 0.9)),
]
PERSPECTIVE = md.View((1.0, 1.0, 3.0), (0, 0, 0), (0, 1, 0), field_of_view=40.0)


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("phong", {"exposure": 0.3}),
        ("light_alignment", {"exposure": 0.3}),
        ("light_alignment", {"exposure": 0.3, "material": "phong"}),
        ("radiance_scaling", {"exposure": 0.3}),
        ("radiance_scaling", {"exposure": 0.3, "curvature": "view"}),
        ("light_warping", {"exposure": 0.3}),
        ("light_warping", {"exposure": 0.3, "curvature": "view", "material": "phong"}),
    ],
)
def test_eight_coloured_lights_in_perspective(space, method, options):
    found = compare(space, method, options=options, light=LAMPS, view=PERSPECTIVE)
    assert np.percentile(found, 99.9) <= 2
    # Eight lights set along eight edges, and there a vertex may be lit in the one and not in the
    # other: a few pixels of a triangle.
    assert (found > 2).mean() < 1e-3


@pytest.mark.parametrize("method", live_methods())
@pytest.mark.parametrize("light", [(0, 0, 1), (0, 0, -1), "northeast", (200.0, 5.0)])
def test_a_new_light_is_that_of_a_new_bake(space, method, light):
    live = LiveShading(space, method, light="southwest", view="front")
    before = drawn(live)
    live.set_light(light)
    assert difference(drawn(live), before).max() > 20
    assert difference(drawn(live), portrait(md.bake(space, method, light=light))).max() <= 2


def test_new_options_views_and_colour_maps_are_those_of_a_new_bake(space):
    live = LiveShading(space, "radiance_scaling", view="front")
    live.set_options(magnitude=9.0)
    live.set_options(curvature="view", specular_magnitude=1.0)
    live.set_view(PERSPECTIVE)
    live.set_colormap("sepia")
    baked = md.bake(
        space, "radiance_scaling", view=PERSPECTIVE, colormap="sepia",
        magnitude=9.0, curvature="view", specular_magnitude=1.0,
    )  # fmt: skip
    assert difference(drawn(live, PERSPECTIVE), portrait(baked)).max() <= 3
    live.set_options(curvature="object", specular_magnitude=None)
    live.set_view("right")
    live.set_colormap(None)
    baked = md.bake(space, "radiance_scaling", view="right", magnitude=9.0)
    assert difference(drawn(live, baked.view), portrait(baked)).max() <= 2


@pytest.mark.parametrize(
    ("method", "nothing", "something"),
    [
        ("exaggerated", {"contrast": 0.0}, {"contrast": 1.0, "exaggeration": 20.0}),
        ("light_alignment", {"strength": 0.0}, {"strength": 0.7}),
        ("light_alignment", {"strength": 0.0}, {"strength": (0.0, 0.5, 0.0, 0.0, 0.8)}),
        ("light_warping", {"magnitude": 0.0}, {"magnitude": 5.0}),
        ("light_warping", {"gain": 0.0}, {"gain": 1.0}),
        ("radiance_scaling", {"magnitude": 0.0}, {"magnitude": 5.0}),
    ],
)
def test_what_has_no_weight_is_not_read_until_it_has_one(ball, method, nothing, something):
    space = md.scale_space(ball, scales=5, ratio=1.7, at_once=())
    live = LiveShading(space, method, options=nothing, light="northwest", view="front")
    assert space.smoothed == {0}
    for options in (nothing, something, nothing):
        live.set_options(**options)
        expected = portrait(md.bake(space, method, light="northwest", **options))
        assert difference(drawn(live), expected).max() <= 2


@pytest.mark.parametrize("method", live_methods())
def test_degenerate_and_duplicate_geometry_far_from_the_origin(method):
    ball = samples.golf_ball(1_000, dimples=32)
    n = len(ball.vertices)
    extra = [*ball.vertices[:50], (2, 2, 2), *[(0, 0, 1.5)] * 3]
    vertices = np.concatenate((ball.vertices, extra)) * 1e-3 + 1e4
    bad = [(0, 0, 1), (2, 2, 2), (n + 51, n + 52, n + 53), (0, n, 1)]
    odd = md.Mesh(vertices, np.concatenate((ball.faces, ball.faces[:30], bad)))
    found = compare(md.scale_space(odd, scales=3), method)
    assert np.percentile(found, 99.9) <= 2


@pytest.mark.parametrize("method", live_methods())
def test_polygons_and_points(method):
    corners = [(0, 0, 0), (1, 0, 0.3), (1, 1, 0), (0, 1, 0.3)]
    quad = md.scale_space(md.Mesh(corners, [[0, 1, 2, 3]]), scales=2)
    assert compare(quad, method).max() <= 2
    point = md.scale_space(md.Mesh(np.ones((3, 3)), [[0, 1, 2]]), scales=2)
    LiveShading(point, method, view="front").check()


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("exaggerated", {"exaggeration": 1e30}),
        ("exaggerated", {"contrast": 1e6, "exposure": 1e6}),
        ("exaggerated", {"focus": (0, 0, 1), "radius": 1e-300}),
        ("exaggerated", {"focus": (1e300, 0, 0), "radius": 1e300}),
        ("light_alignment", {"sharpness": 6.0, "strength": 1.0}),
        ("light_warping", {"magnitude": 1e30, "gain": 1e30}),
        ("light_warping", {"magnitude": -1e30, "contrast": 1.0}),
        ("radiance_scaling", {"magnitude": 1e30, "gain": 1e30, "exposure": 0.1}),
        ("radiance_scaling", {"invariant": 0.0}),
        ("radiance_scaling", {"invariant": 1.0, "anisotropy": -1.0, "warping": 1e30}),
        ("phong", {"shininess": 1e6}),
        ("phong", {"shininess": 0.0}),
    ],
    ids=str,
)
def test_the_ends_of_the_ranges_are_finite(space, method, options):
    """At them methods are steps, on which vertices fall either way: the mean must agree.

    A colour that isn't finite would be black, or white, or anything: far from the bake's mean.
    """
    live = LiveShading(space, method, options=options, view="front")
    live.check()
    baked = portrait(md.bake(space, method, **options)).astype(float)
    assert abs(drawn(live).mean() - baked.mean()) < 3


def test_the_signature_is_the_documented_one():
    parameters = inspect.signature(LiveShading).parameters
    assert list(parameters) == ["space", "method", "options", "light", "view", "colormap"]
    assert set(live_methods()) <= set(md.shading.METHODS)


def test_what_the_card_cannot_do_is_refused(space):
    with pytest.raises(md.MeshdepictError, match=r"sharpness=8, only up to 6"):
        LiveShading(space, "light_alignment", view="front", options={"sharpness": 8.0})
    panorama = md.Environment(np.ones((4, 8, 3)))
    with pytest.raises(md.MeshdepictError, match="no highlights of an environment"):
        LiveShading(space, "radiance_scaling", view="front", light=panorama, options={"lights": 4})
    LiveShading(
        space, "radiance_scaling", view="front", light=panorama,
        options={"lights": 4, "material": "lambert"},
    ).check()  # fmt: skip
