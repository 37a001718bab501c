"""Options at the ends of their ranges, beyond them and close by; alone and all at once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from extreme_calls import always, proper, refused, taken_or_refused, usual
from hypothesis import given
from hypothesis import strategies as st
from method_families import ON_RASTERS
from odd_meshes import golf_ball

import meshdepict as md
from meshdepict.options import Choice, Range, Values, options_of
from meshdepict.shading import METHODS

pytestmark = pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")

# What work grows with; the ends of these are for the soak of whole processes.
HEAVY = {"rays": (2, 64), "lights": (1, 300), "bounces": (0, 20)}
# Vertices at one median edge from another are within its ball, or not.
STEPS = {("integral_invariant", "radius")}
LIGHTS = [
    sign * axis for sign in (1.0, -1.0) for axis in np.eye(3)
] + [(1.0, 1.0, 0.0), (-45.0, 90.0), "northwest"]  # fmt: skip


@pytest.fixture(scope="module")
def spaces():
    ball = md.Mesh(*golf_ball())
    y, x = np.mgrid[:7, :8]
    ground = md.HeightField(np.sin(x) + 3 * np.cos(y), valid=(x + 2 * y) % 7 > 0)
    image = md.GBuffer.of(ball, "front", size=(16, 16))
    return {kind: md.scale_space(shape, scales=2)
            for kind, shape in (("mesh", ball), ("ground", ground), ("image", image))}  # fmt: skip


def space_of(spaces, method):
    return spaces["ground" if method in ON_RASTERS else "mesh"]


def ends(option):
    """Return both ends of an option's range, or all of its words."""
    accepts = option.accepts
    if isinstance(accepts, Choice):
        return list(accepts.names)
    if isinstance(accepts, Values):
        return ["0,0,1", "1e300,0,0,1e-300", "-1e300,1e300,0,1e300"]
    low, high = (end if math.isfinite(end) else math.copysign(1e300, end)
                 for end in (accepts.low, accepts.high))  # fmt: skip
    low, high = HEAVY.get(option.name, (low, high))
    found = [low, high] if option.count < 2 else [(low,) * option.count, (high,) * option.count]
    tiny = [5e-324] if option.kind is float and option.count < 2 and low <= 0 <= high else []
    return [*found, *tiny, *accepts.words]


CASES = [(method, name) for method in METHODS for name in options_of(METHODS[method])]
RANGES = [
    (method, name) for method, name in CASES
    if isinstance(options_of(METHODS[method])[name].accepts, Range)
]  # fmt: skip


@pytest.mark.parametrize(("method", "name"), CASES)
def test_both_ends_give_a_picture_under_lights_along_every_axis(method, name, spaces):
    space = space_of(spaces, method)
    for value in ends(options_of(METHODS[method])[name]):
        for light in LIGHTS:
            with taken_or_refused():  # together with what it belongs to
                options = usual(method) | {name: value}
                proper(METHODS[method](space, light, **options), space.count)


@pytest.mark.parametrize(("method", "name"), RANGES)
def test_beyond_an_end_there_is_a_sentence_that_gives_the_range(method, name, spaces):
    option = options_of(METHODS[method])[name]
    many = option.count if option.count > 1 else 0

    def said_of(value):
        given = {name: (value,) * many if many else value}
        return refused(lambda: METHODS[method](space_of(spaces, method), "front", **given))

    for end, beyond in ((option.accepts.low, -math.inf), (option.accepts.high, math.inf)):
        if not math.isfinite(end):
            continue
        step = math.copysign(1, beyond)
        said = said_of(math.nextafter(end, beyond) if option.kind is float else end + step)
        assert f"{name}=" in said
        assert str(option.accepts) in said
    for odd in (math.nan, math.inf, -math.inf):
        assert str(option.accepts) in said_of(odd)


@pytest.mark.parametrize(("method", "name"), RANGES)
def test_an_end_is_the_limit_of_what_is_near_it(method, name, spaces):
    option, space = options_of(METHODS[method])[name], space_of(spaces, method)
    if option.kind is int or option.count != 1 or (method, name) in STEPS:
        return  # steps have no limit
    for end, towards in ((option.accepts.low, 1), (option.accepts.high, -1)):
        if not math.isfinite(end):
            continue
        near = end + towards * 1e-9 * (abs(end) or 1.0)
        shown = []
        with taken_or_refused():
            for value in (end, near):
                options = usual(method) | {name: value}
                shown.append(METHODS[method](space, (0.2, 0.3, 0.9), **options))
        if len(shown) == 2:
            np.testing.assert_allclose(shown[0], shown[1], atol=1 / 255)


@pytest.mark.parametrize("method", METHODS)
def test_a_light_along_any_normal_gives_a_picture(method, spaces):
    space = space_of(spaces, method)
    for sign in (1, -1):
        for normal in space.normals_at(0)[::11]:
            proper(
                METHODS[method](space, sign * normal.astype(float), **usual(method)), space.count
            )


@always(400)
@given(method=st.sampled_from(list(METHODS)), choices=st.data())
def test_ends_of_all_options_together(spaces, method, choices):
    known = options_of(METHODS[method])
    some = choices.draw(st.lists(st.sampled_from(sorted(known)), max_size=5, unique=True))
    options = usual(method) | {
        name: choices.draw(st.sampled_from([*ends(known[name]), known[name].default]))
        for name in some
    }
    kinds = ["ground"] if method in ON_RASTERS else sorted(spaces)
    space = spaces[choices.draw(st.sampled_from(kinds))]
    with taken_or_refused():
        light = choices.draw(st.sampled_from(LIGHTS))
        proper(METHODS[method](space, light, **options), space.count)
