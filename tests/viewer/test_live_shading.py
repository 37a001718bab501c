"""What live shading refuses, what it leaves alone, and what it says where a shader fails."""

import dataclasses

import numpy as np
import pytest
from live_pictures import difference, drawn

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.drawing.shader import caught_errors
from meshdepict.viewer.live import LiveShading, live_methods, look


@pytest.fixture(scope="module")
def space():
    return md.scale_space(samples.golf_ball(1_000, dimples=32), scales=3)


def times(live):
    """When points, faces and attributes last changed."""
    data = live._poly.GetPointData()
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    return [x.GetMTime() for x in (live._poly, live._poly.GetPoints(), data, *arrays)]


CHANGES = {
    "exaggerated": {"exaggeration": 30.0, "emphasis": -1.0, "focus": (0, 0, 1)},
    "light_alignment": {"material": "phong", "strength": (0.1, 0.2, 0.3)},
    "radiance_scaling": {"gain": 2.0, "warping": 3.0, "material": "lambert"},
    "light_warping": {"magnitude": -3.0, "contrast": 1.0, "gain": 0.1},
    "phong": {"shininess": 2.0},
}


@pytest.mark.parametrize("method", live_methods())
def test_lights_options_and_colours_pass_over_no_vertex(space, method, monkeypatch):
    live = LiveShading(space, method, view="front")
    live.check()
    before = times(live)
    monkeypatch.delattr("meshdepict.viewer.live.live_method.pack_normals")
    monkeypatch.delattr("meshdepict.viewer.live.direct.features")
    live.set_light((10.0, 20.0))
    live.set_options(exposure=0.8, **CHANGES.get(method, {}))
    live.set_colormap("gooch")
    live.set_view("left")
    live.check()
    assert times(live) == before


def test_curvature_of_the_view_is_computed_when_the_view_is_set(space):
    live = LiveShading(space, "light_warping", options={"curvature": "view"}, view="front")
    before = live._poly.point_data["curvature"].copy()
    live.set_light("east")
    assert (live._poly.point_data["curvature"] == before).all()
    live.set_view("left")
    assert (live._poly.point_data["curvature"] != before).any()


def test_positions_are_recentred_and_nothing_of_the_space_changes(space):
    shape = space.shape
    before = shape.vertices.copy(), space.normals.copy(), shape.faces.copy()
    live = LiveShading(space, "exaggerated", view="front")
    expected = (shape.vertices - shape.centre) / shape.diagonal
    assert np.allclose(live._poly.points, expected, atol=1e-7)
    assert live.actor.GetMapper().GetInput() is live._poly
    for one, other in zip((shape.vertices, space.normals, shape.faces), before, strict=True):
        assert (one == other).all()


def test_method_and_options_can_be_asked_for(space):
    live = LiveShading(space, "exaggerated", options={"emphasis": -1.0}, view="front")
    live.set_options(contrast="0.5")
    assert live.method == "exaggerated"
    assert live.options["emphasis"] == -1
    assert live.options["contrast"] == 0.5
    assert live.options["exaggeration"] is None
    live.options["contrast"] = 9  # a copy
    assert live.options["contrast"] == 0.5


REFUSED = [
    ("gooch", {}, {}, "'gooch' can't be shown live .* bake it instead"),
    ("lamber", {}, {}, "did you mean 'lambert'"),
    (None, {}, {}, "None can't be shown live"),
    ("exaggerated", {"principal_strength": 2.0}, {}, "principal_strength=2.0, only with 0.0; bake"),
    ("exaggerated", {"steepness": 2.0}, {}, "has no option 'steepness'"),
    ("exaggerated", {"contrast": -2.0}, {}, "contrast=-2.0 is not a number in its range"),
    ("exaggerated", {}, {"light": ["east", "west"]}, "neither a name"),
    ("exaggerated", {}, {"light": "noth"}, "did you mean 'north'"),
    ("exaggerated", {}, {"colormap": "gary"}, "no colour map 'gary'"),
    ("exaggerated", {}, {"view": "frnt"}, "did you mean 'front'"),
    ("phong", {}, {"light": ["east"] * 65}, "at most 64 lights, not 65; bake it instead"),
    ("phong", {}, {"light": md.Light((1, 0, 0), color=(1, 0, 0)), "colormap": "gray"}, "in colour"),
    ("light_alignment", {"transmitted": 0.5}, {}, "transmitted=0.5, only with 0.0; bake it"),
    ("light_alignment", {"material": "cook_torrance"}, {}, "lambert and phong, not CookTorrance"),
    ("light_alignment", {"strength": (0.1, 0.2)}, {}, "strength has 2 values for 3 scales"),
    ("light_alignment", {"roughness": 0.5}, {}, "Lambert has no roughness"),
    ("radiance_scaling", {"material": "toon"}, {}, "lambert and phong, not Toon; bake it"),
    ("radiance_scaling", {"illumination": "occlusion"}, {}, "only with 'lights'; bake it"),
    ("radiance_scaling", {"scale": 7}, {}, "scale=7 is not one of the scale space's, 0 to 3"),
    ("light_warping", {"quadrature": "directions"}, {}, "only with 'lights'; bake it instead"),
    ("light_warping", {"illumination": "occlusion"}, {}, "only with 'lights'; bake it instead"),
    ("light_warping", {"material": "lit_sphere"}, {}, "lambert and phong, not LitSphere; bake"),
    ("light_warping", {"importance": "0,0,1"}, {}, "importance='0,0,1', only with None; bake it"),
    ("light_warping", {"importance": np.ones(9)}, {}, "importance=9 numbers, only with None"),
]  # fmt: skip


@pytest.mark.parametrize(("method", "options", "others", "sentence"), REFUSED, ids=str)
def test_what_can_t_be_live_is_refused(space, method, options, others, sentence):
    with pytest.raises(MeshdepictError, match=sentence) as caught:
        LiveShading(space, method, options=options, **({"view": "front"} | others))
    assert "\n" not in str(caught.value)


def test_a_refused_change_changes_nothing(space):
    live = LiveShading(space, "light_alignment", view="front", options={"sharpness": 1.0})
    before, options = drawn(live), live.options
    for change in (
        lambda: live.set_options(sharpness=5.0, transmitted=1.0),
        lambda: live.set_options(strength=0.9, material="ashikhmin_shirley"),
        lambda: live.set_options(sharpness=-1.0),
        lambda: live.set_light(["east"] * 65),
        lambda: live.set_light("nowhere"),
        lambda: live.set_view("nowhere"),
        lambda: live.set_colormap("nothing"),
    ):
        with pytest.raises(MeshdepictError):
            change()
    assert live.options == options
    assert (drawn(live) == before).all()


def test_environments_are_taken_as_some_lights_or_refused(space):
    sky = md.Environment(np.ones((8, 16, 3)))
    with pytest.raises(MeshdepictError, match="at most 64 lights, not 100"):
        LiveShading(space, "light_warping", light=sky, options={"lights": 100}, view="front")
    for lights in (8, 54):
        options = {"lights": lights}
        live = LiveShading(space, "light_warping", light=sky, options=options, view="front")
        live.check()


def test_only_a_mesh_s_own_vertices_are_live(space):
    class Grid:
        shape, widths = object(), [0]

    with pytest.raises(MeshdepictError, match="needs the scale space of a mesh's vertices"):
        LiveShading(Grid(), "lambert", view="front")

    class Between:
        shape, widths, points = space.shape, space.widths, space.points[:5]

    with pytest.raises(MeshdepictError, match="needs the scale space of a mesh's vertices"):
        LiveShading(Between(), "lambert", view="front")


@pytest.mark.parametrize(("method", "most"), [("exaggerated", 44), ("light_alignment", 29)])
def test_as_many_scales_as_attributes_hold(method, most):
    ball = samples.sphere(42)
    LiveShading(md.scale_space(ball, scales=most, ratio=1.01), method, view="front").check()
    more = md.scale_space(ball, scales=most + 1, ratio=1.01)
    with pytest.raises(MeshdepictError, match=f"at most {most} scales, not {most + 1}; bake it"):
        LiveShading(more, method, view="front")


@pytest.mark.parametrize("method", ["exaggerated", "light_alignment"])
def test_thirteen_scales_compile_and_none_is_refused(method):
    ball = samples.golf_ball(400, dimples=12)
    LiveShading(md.scale_space(ball, scales=13), method, view="front").check()
    with pytest.raises(MeshdepictError, match="needs at least one scale"):
        LiveShading(md.scale_space(ball, scales=0), method, view="front")


# --- faults ---------------------------------------------------------------------------------


def test_a_shader_that_does_not_compile_is_one_sentence_and_nothing_else(space, monkeypatch, capfd):
    broken = dataclasses.replace(
        look._METHODS["lambert"], glsl="vec3 shade() { return vec3(nonsense); }"
    )
    monkeypatch.setitem(look._METHODS, "lambert", broken)
    live = LiveShading(space, "lambert", view="front")
    words = (
        r"lambert shading can't be shown live here: the shader did not compile \(.*nonsense.*\); "
    )
    with pytest.raises(MeshdepictError, match=words + "bake it instead") as caught:
        live.check()
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_what_follows_a_fault_works(space, monkeypatch):
    good = LiveShading(space, "half_lambert", view="front")
    before = drawn(good)
    broken = dataclasses.replace(look._METHODS["lambert"], glsl="nonsense")
    monkeypatch.setitem(look._METHODS, "lambert", broken)
    with pytest.raises(MeshdepictError):
        LiveShading(space, "lambert", view="front").check()
    assert (drawn(good) == before).all()


def test_a_check_off_screen_leaves_the_actor_for_other_windows(space):
    live = LiveShading(space, "exaggerated", view="front")
    live.check()
    first = drawn(live)
    live.check()
    assert (drawn(live) == first).all()
    assert first.std() > 5
    assert difference(first, np.full_like(first, 255)).max() > 20


def report(text):
    """Do as VTK does with an error."""
    from vtkmodules.vtkCommonCore import vtkOutputWindow

    vtkOutputWindow.GetInstance().DisplayErrorText(text)


SOURCE = "vtkShaderProgram (0x55): 75: uniform float error;\n76: vec3 shade() {}\n\n"
DRIVERS = {
    "0:76(47): error: `v3' undeclared": "`v3' undeclared",
    '0(76) : error C1008: undefined variable "v3"': 'C1008: undefined variable "v3"',
    "ERROR: 0:76: Use of undeclared identifier 'v3'": "undeclared identifier 'v3'",
}


@pytest.mark.parametrize("complaint", DRIVERS)
def test_drivers_are_quoted(complaint):
    """The words of Mesa, NVIDIA and Apple; the listing before them is left out."""
    with pytest.raises(MeshdepictError) as caught, caught_errors("it"):
        report(
            f"ERROR: In vtkShaderProgram.cxx, line 1282\n{SOURCE}"
            f"ERROR: In vtkShaderProgram.cxx, line 1283\nvtkShaderProgram (0x55): {complaint}\n\n"
        )
    assert str(caught.value).startswith("it can't be shown live here: the shader did not compile")
    assert DRIVERS[complaint] in str(caught.value)
    assert "uniform" not in str(caught.value)
    assert "vtkShaderProgram" not in str(caught.value)


def test_other_errors_are_quoted_and_warnings_are_not():
    from vtkmodules.vtkCommonCore import vtkOutputWindow

    former = vtkOutputWindow.GetInstance()
    with pytest.raises(MeshdepictError, match="VTK says: no window; bake it"), caught_errors("it"):
        report("ERROR: In vtkWindow.cxx, line 12\nvtkWindow (0x55): no window.\n\n")
    with caught_errors("it"):
        vtkOutputWindow.GetInstance().DisplayWarningText("Warning: In x.cxx, line 1\nodd\n\n")
    assert vtkOutputWindow.GetInstance() is former
