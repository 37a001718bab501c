"""What every shading method promises, whatever it shows."""

import inspect

import numpy as np
import pytest
from conftest import DATA, rotation, tetrahedron
from method_families import ON_MESHES, ON_RASTERS

from meshdepict import samples, scale_space, shading
from meshdepict.errors import MeshdepictError
from meshdepict.options import check, options_of
from meshdepict.scales.mesh_scales import MeshSpace
from meshdepict.scene.light import Light
from meshdepict.scene.view import View
from meshdepict.shading import METHODS, declaration
from meshdepict.shading.method import NEEDS
from meshdepict.shapes.mesh import Mesh

every_method = pytest.mark.parametrize("method", METHODS)
on_meshes = pytest.mark.parametrize("method", ON_MESHES)

GREY_LEVEL = 1 / 255
FRONT = np.eye(3)


def shade(method, space, light="northwest", *, frame=FRONT, unit=1.0, **options):
    """Call a method as `bake` does, with an eye where it asks for one."""
    function = METHODS[method]
    if "view" in declaration(function).needs:
        options["view"] = View(5 * unit * frame[2], (0, 0, 0), frame[1], parallel_scale=1.3 * unit)
    return function(space, light, **options)


def is_sampled(method):
    return "rays" in options_of(METHODS[method])


def few_rays(method, count=64):
    return {"rays": count} if is_sampled(method) else {}


def small():
    return samples.golf_ball(600, dimples=12, depth=0.05)


@pytest.fixture(scope="module")
def space():
    return scale_space(small(), scales=3)


# --- the registry -----------------------------------------------------------------------------


@every_method
def test_a_method_is_known_by_the_name_of_its_function(method):
    assert METHODS[method].__name__ == method
    assert getattr(shading, method) is METHODS[method]
    assert method in shading.__all__


@every_method
def test_a_method_declares_what_bake_has_to_know(method):
    declared = declaration(METHODS[method])
    assert 0 <= declared.scales <= 64
    assert 1 < declared.ratio <= 10
    assert isinstance(declared.linear, bool)
    assert declared.source


@every_method
def test_every_option_says_what_it_accepts_and_its_default_is_accepted(method):
    function = METHODS[method]
    options = options_of(function)
    parameters = inspect.signature(function).parameters.values()
    keywords = {p.name for p in parameters if p.kind == p.KEYWORD_ONLY}
    assert set(options) <= keywords
    assert keywords - set(options) <= {"view", "material", "importance"}  # objects and arrays
    assert "exposure" in options
    defaults = {name: option.default for name, option in options.items()}
    assert check(function, defaults, method) == defaults
    assert all(option.help for option in options.values())


@every_method
def test_the_docstring_names_every_option(method):
    function = METHODS[method]
    text = inspect.getdoc(function)
    assert all(name in text for name in options_of(function))


@every_method
def test_every_parameter_and_the_result_are_documented_once(method):
    function = METHODS[method]
    intro, *sections = inspect.getdoc(function).split("\n\n")
    titles = [section.partition("\n")[0] for section in sections]
    assert titles.count("Parameters") == titles.count("Returns") == 1
    assert "-----" not in intro
    body = sections[titles.index("Parameters")].splitlines()[2:]
    heads = [line.partition(":")[0] for line in body if not line.startswith(" ")]
    names = [name.strip() for head in heads for name in head.split(",")]
    assert sorted(names) == sorted(inspect.signature(function).parameters)


# --- what is declared is so ---------------------------------------------------------------------


@on_meshes
def test_what_a_method_does_not_declare_it_does_not_ask_for(method, monkeypatch):
    asked = set()

    def watch(name, need):
        known = getattr(MeshSpace, name)

        def spy(self, *given, **options):
            asked.add(need)
            return (known.fget if isinstance(known, property) else known)(self, *given, **options)

        monkeypatch.setattr(MeshSpace, name, property(spy) if isinstance(known, property) else spy)

    watch("curvature", "curvature")
    watch("view_curvature", "curvature")
    watch("occlusion", "rays")
    watch("surface", "rays")
    watch("unit_areas", "areas")
    shade(method, scale_space(small(), scales=3), **few_rays(method, 2))
    needs = declaration(METHODS[method]).needs
    assert needs <= set(NEEDS)
    assert asked == needs & {"curvature", "rays", "areas"}
    assert ("view" in needs) == ("view" in inspect.signature(METHODS[method]).parameters)


@on_meshes
def test_a_method_takes_as_many_lights_as_it_declares(method, space):
    lights = declaration(METHODS[method]).lights
    two = [Light((1, 0, 1)), Light((-1, 1, 1))]
    if lights == "one":
        with pytest.raises(MeshdepictError, match="light"):
            shade(method, space, two)
        return
    found = shade(method, space, two)
    assert_proper(found, len(space.points))
    if lights == "none":
        np.testing.assert_array_equal(found, shade(method, space, "southeast"))
    else:
        assert np.ptp(found - shade(method, space, two[0])) > GREY_LEVEL


@every_method
def test_what_compare_shows_it_with_are_options_that_it_takes(method):
    compared = declaration(METHODS[method]).compared
    assert compared is None or check(METHODS[method], compared, method) == compared


# --- results ----------------------------------------------------------------------------------


def assert_proper(values, count):
    assert values.shape in ((count,), (count, 3))
    assert values.dtype in (np.float32, np.float64)
    assert np.isfinite(values).all()
    assert values.min() >= 0
    assert values.max() <= 1


@on_meshes
@pytest.mark.parametrize(
    "light", ["front", "southeast", (1, 0, 0), (0, -1, 0), (0, 0, -1), (30, 0)]
)
def test_values_are_finite_and_between_0_and_1(method, light, space):
    assert_proper(shade(method, space, light), len(space.points))


@on_meshes
def test_exposure_multiplies_before_the_last_clip(method, space):
    plain = shade(method, space, exposure=1)
    assert not shade(method, space, exposure=0).any()
    quarter = shade(method, space, exposure=0.25)
    np.testing.assert_allclose(np.minimum(4 * quarter, 1), plain, atol=1e-6)
    np.testing.assert_allclose(
        np.minimum(4 * plain, 1), shade(method, space, exposure=4), atol=4e-6
    )


@on_meshes
def test_nothing_that_comes_in_is_changed(method):
    vertices, faces = tetrahedron()
    light, attribute = np.array([-1.0, 2.0, 3.0]), np.arange(4.0)
    given = (vertices, faces, light, attribute)
    before = [array.copy() for array in given]
    space = scale_space(Mesh(vertices, faces, attributes={"vertex": {"a": attribute}}), scales=1)
    normals = space.normals.copy()
    shade(method, space, light)
    for array, old in zip((*given, space.normals), (*before, normals), strict=True):
        np.testing.assert_array_equal(array, old)


@on_meshes
def test_the_same_call_gives_the_same_bits(method, space):
    np.testing.assert_array_equal(shade(method, space), shade(method, space))


# --- what must not matter ---------------------------------------------------------------------

# Normals are asked for to 1e-7, and rounded by as much. In exaggerated shading 3e-7 becomes at most
# ½ · 15 · 3e-7/1e-3 = 0.6 grey levels (METHODS §2, ε = 1e-3); nothing else magnifies more.
EXACT = {"scales": 3, "tolerance": 1e-7}


def tolerance(method):
    """A grey level; where rays are random, five standard deviations of a share of 64."""
    return 5 * 0.5 / 64**0.5 if is_sampled(method) else GREY_LEVEL


@on_meshes
def test_turning_mesh_light_and_view_together_changes_nothing(method, rng):
    ball, turn = small(), rotation(rng)
    light = np.array([-1.0, 1.0, 1.0])
    plain = shade(method, scale_space(ball, **EXACT), light, **few_rays(method))
    turned = scale_space(Mesh(ball.vertices @ turn.T, ball.faces), **EXACT)
    found = shade(method, turned, turn @ light, frame=FRONT @ turn.T, **few_rays(method))
    np.testing.assert_allclose(found, plain, atol=tolerance(method))


@on_meshes
def test_permuting_vertices_permutes_colours(method, rng):
    ball = small()
    order = rng.permutation(len(ball.vertices))
    permuted = Mesh(ball.vertices[order], np.argsort(order)[ball.faces])
    plain = shade(method, scale_space(ball, **EXACT), **few_rays(method))
    found = shade(method, scale_space(permuted, **EXACT), **few_rays(method))
    np.testing.assert_allclose(found, plain[order], atol=tolerance(method))


@on_meshes
@pytest.mark.parametrize("factor", [1e-140, 1e140])
def test_units_do_not_matter(method, factor):
    ball = small()
    plain = shade(method, scale_space(ball, **EXACT), **few_rays(method))
    scaled = scale_space(Mesh(ball.vertices * factor, ball.faces), **EXACT)
    found = shade(method, scaled, unit=factor, **few_rays(method))
    np.testing.assert_allclose(found, plain, atol=tolerance(method))


@on_meshes
def test_a_light_may_be_given_in_any_form(method, space):
    direction = (-1, 1, 1)
    plain = shade(method, space, "northwest")
    for light in (direction, Light(direction), (-45, np.degrees(np.arcsin(3**-0.5)))):
        # Their directions differ by a rounding, which may turn the frame of random rays.
        off = tolerance(method) if is_sampled(method) else 1e-5
        np.testing.assert_allclose(shade(method, space, light), plain, atol=off)


# --- odd shapes -------------------------------------------------------------------------------

ODD = {
    "one triangle": (np.eye(3), [[0, 1, 2]]),
    "a needle": ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]),
    "twice the same corner": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [0, 1, 2]]),
    "one point": (np.full((3, 3), 2.5), [[0, 1, 2]]),
    "two sides of one triangle": (np.tile(np.eye(3), (2, 1)), [[0, 1, 2], [5, 4, 3]]),
    "vertices without faces": (np.vstack([np.eye(3), 2 * np.eye(3)]), [[0, 1, 2]]),
    "a far vertex": (np.vstack([np.eye(3), [[1e9, 0, 0]]]), [[0, 1, 2]]),
    "three faces at an edge": (
        [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0]],
        [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    ),
    "tiny": (np.eye(3) * 1e-140, [[0, 1, 2]]),
    "huge": (np.eye(3) * 1e140, [[0, 1, 2]]),
}


@on_meshes
@pytest.mark.parametrize("name", ODD)
def test_odd_shapes_get_finite_colours(method, name):
    mesh = Mesh(*ODD[name], winding="keep")
    values = shade(method, scale_space(mesh, scales=2), **few_rays(method))
    assert_proper(values, len(mesh.vertices))


@pytest.fixture(scope="module")
def scans():
    """Scale spaces of the scans by name, made once each."""
    return {}


every_scan = pytest.mark.parametrize(
    "name",
    ["armadillo_86k", "beetle_2k", "bunny_69k", "dragon_203k", "fandisk_13k", "flake1_152k",
     "gears_19k", "lucy_100k", "nefertiti_100k"],
)  # fmt: skip


@pytest.fixture
def scan(data, scans, name):
    from meshdepict.io import read_mesh

    if name not in scans:
        scans[name] = scale_space(
            read_mesh(data / "mesh" / f"{name}.ply"), scales=1, width="0.3%", tolerance=1e-2
        )
    return scans[name]


@on_meshes
@every_scan
@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_scans_get_finite_colours(scan, method):
    assert_proper(shade(method, scan, **few_rays(method, 2)), len(scan.points))


@every_scan
@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("light_warping", {"magnitude": 1e30, "material": "phong"}),
        ("light_warping", {"magnitude": -1e30, "curvature": "view", "gain": 1e30}),
        ("radiance_scaling", {"magnitude": 1e30, "gain": 1e30}),
        ("radiance_scaling", {"magnitude": 1e30, "curvature": "view", "material": "phong"}),
        ("light_alignment", {"sharpness": 20.0, "strength": 1.0, "material": "phong"}),
        ("light_alignment", {"sharpness": 0.0, "strength": 0.0, "transmitted": 1.0}),
    ],
    ids=lambda given: given if isinstance(given, str) else " ".join(given),
)
@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_scans_survive_extreme_options(scan, method, options):
    for light in ("northwest", (0, 0, -1), scan.normals[0, 0]):
        assert_proper(shade(method, scan, light, **options), len(scan.points))


@pytest.mark.skipif(not DATA, reason="real data not at hand: MESHDEPICT_DATA is not set")
def test_no_scan_is_left_out(data):
    names = {path.stem for path in (data / "mesh").glob("*.ply")}
    assert names == set(every_scan.args[1])


# --- wrong input ------------------------------------------------------------------------------


@every_method
def test_wrong_options_are_refused_by_the_function_itself(method, space):
    with pytest.raises(
        MeshdepictError, match=rf"{method}: exposure=-1 is not a number in its range"
    ):
        METHODS[method](space, "front", exposure=-1)
    with pytest.raises(MeshdepictError, match=rf"{method} has no option 'exposur'; did you mean"):
        METHODS[method](space, "front", exposur=1)


@every_method
def test_only_a_scale_space_can_be_shaded(method):
    with pytest.raises(
        MeshdepictError, match=f"{method} shades a ScaleSpace, not a Mesh: make one"
    ):
        METHODS[method](samples.sphere(12), "front")


@pytest.mark.parametrize("method", ON_RASTERS)
def test_what_is_about_rasters_of_heights_refuses_a_mesh(method, space):
    with pytest.raises(MeshdepictError, match="heights on a raster are needed, and a mesh has"):
        shade(method, space)
