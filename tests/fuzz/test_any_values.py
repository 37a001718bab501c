"""Any array, option or view is taken or refused in a sentence: finite colours, nothing modified."""

from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from method_families import ON_RASTERS

import meshdepict as md
from meshdepict.baking.choice_list import choice_fields
from meshdepict.options import Choice, Values, options_of

# The same examples every time, and no test that fails for slowness.
always = settings(
    max_examples=60, deadline=None, derandomize=True, database=None,
    suppress_health_check=list(HealthCheck),
)  # fmt: skip
METHODS = [
    name
    for name, function in md.shading.METHODS.items()
    if "rays" not in md.shading.declaration(function).needs
]

numbers = st.one_of(
    st.floats(width=64), st.sampled_from([0.0, -0.0, 1e-310, 1e308, -1e308, 1e150, 5e-324]),
    st.floats(-2, 2), st.integers(-3, 3).map(float),
)  # fmt: skip
anything = st.one_of(
    numbers, st.integers(), st.booleans(), st.none(), st.text(max_size=8), st.binary(max_size=4),
    st.lists(numbers, max_size=4), st.tuples(numbers, numbers, numbers), st.complex_numbers(),
    st.dictionaries(st.text(max_size=2), numbers, max_size=2), st.just(object()),
    arrays.arrays(np.float64, arrays.array_shapes(max_dims=3, max_side=3)),
)  # fmt: skip


@pytest.fixture(scope="module")
def ball():
    return md.samples.golf_ball(120, dimples=12)


@pytest.fixture(scope="module")
def space(ball):
    return md.scale_space(ball, scales=2)


@contextmanager
def taken_or_refused(*names):
    """What is refused is so in one sentence, which names what it is about where that is known."""
    try:
        yield
    except md.MeshdepictError as error:
        said = str(error)
    else:
        return
    assert said.isprintable()
    assert not names or any(name in said for name in names)


def finite(values):
    assert np.isfinite(values).all()
    assert values.min() >= 0
    assert values.max() <= 1


@always
@given(
    vertices=arrays.arrays(np.float64, st.tuples(st.integers(0, 9), st.just(3)), elements=numbers),
    faces=arrays.arrays(
        np.int64, st.tuples(st.integers(0, 9), st.integers(1, 5)), elements=st.integers(-1, 9)
    ),
    winding=st.sampled_from(["auto", "keep"]),
)
@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_any_vertices_and_faces(vertices, faces, winding):
    before = vertices.copy(), faces.copy()
    with taken_or_refused():
        mesh = md.Mesh(vertices, faces, winding=winding)
        for method in ("exaggerated", "light_alignment", "radiance_scaling"):
            finite(md.bake(mesh, method, scales=2).intensity)
    np.testing.assert_array_equal(vertices, before[0])
    np.testing.assert_array_equal(faces, before[1])


@always
@given(vertices=anything, faces=anything)
def test_anything_as_a_mesh(vertices, faces):
    with pytest.raises(md.MeshdepictError):
        md.Mesh(vertices, faces)


@always
@given(values=anything, spacing=anything, direction=anything)
@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_anything_as_a_volume(values, spacing, direction):
    with taken_or_refused():
        volume = md.Volume(values, spacing=spacing, direction=direction)
        assert np.isfinite(volume.outline).all()


@pytest.fixture(scope="module")
def ground():
    y, x = np.mgrid[:9, :11]
    valid = (x + 2 * y) % 7 > 0
    return md.scale_space(md.HeightField(np.sin(x) + 3 * np.cos(y), valid=valid), scales=2)


@pytest.mark.parametrize("name", METHODS)
@settings(always, max_examples=25)
@given(choices=st.data())
@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_any_option_of_a_method(space, ground, name, choices):
    sampled = ground if name in ON_RASTERS else space
    known = options_of(md.shading.METHODS[name])
    option = known[choices.draw(st.sampled_from(sorted(known)))]
    ends = []
    if isinstance(option.accepts, Choice):
        values = st.one_of(st.sampled_from(option.accepts.names), anything)
    elif isinstance(option.accepts, Values):
        values = st.one_of(st.sampled_from(["0,0,1", "0,0,1,0.5", "quality", "no.png"]), anything)
    else:
        ends = [end for end in (option.accepts.low, option.accepts.high) if np.isfinite(end)]
        values = st.one_of(st.sampled_from([*ends, 0.0, 1.0]), anything)
    value = choices.draw(values)
    light = choices.draw(st.sampled_from(["northwest", (0, 90), (0.0, 0.0, -1.0), (123, -45)]))
    # What lies within its range is refused at most together with what it goes with.
    expected = (option.name, "light") if any(value is end for end in ends) else ()
    with taken_or_refused(*expected):
        finite(md.bake(sampled, name, light=light, **{option.name: value}).intensity)


@pytest.mark.parametrize("name", sorted(choice_fields()))
@always
@given(value=anything)
@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_anything_as_a_choice(ball, name, value):
    if name == "scales" and isinstance(value, int) and 20 < value <= 64:
        value = 20  # what takes long is no fault
    with taken_or_refused():
        finite(md.bake(ball, **{"method": "lambert", name: value}).intensity)


@always
@given(light=anything)
def test_anything_as_a_light(space, light):
    for method in ("lambert", "phong"):
        with taken_or_refused():
            finite(md.bake(space, method, light=light).intensity)


three = st.tuples(numbers, numbers, numbers)


@always
@given(
    position=three, focus=three, up=three, height=st.one_of(st.integers(-1, 3000), numbers),
    field=st.one_of(st.none(), numbers), scale=st.one_of(st.none(), numbers),
)  # fmt: skip
@pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
def test_any_view(space, position, focus, up, height, field, scale):
    with taken_or_refused():
        view = md.View(
            position, focus, up, height_px=height, field_of_view=field, parallel_scale=scale
        )
        for method in ("view_curvature", "radiance_scaling", "phong"):
            options = {} if method != "radiance_scaling" else {"curvature": "view"}
            finite(md.bake(space, method, view=view, **options).intensity)
