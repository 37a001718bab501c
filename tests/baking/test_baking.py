import os
import re

import numpy as np
import pytest
import pyvista as pv
import trimesh

from meshdepict import bake, color, read_mesh, samples, scale_space, shading
from meshdepict.baking.baked import Baked
from meshdepict.baking.surfaces import as_mesh
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_provenance, write_mesh
from meshdepict.shapes.mesh import Mesh
from meshdepict.sums.gaussian import GaussianSums

QUICK = {"scales": 2, "tolerance": 1e-3}


@pytest.fixture(scope="module")
def small():
    return samples.golf_ball(600, dimples=12, depth=0.05)


def colored(mesh, colors):
    channels = dict(zip(("red", "green", "blue"), np.asarray(colors, np.uint8).T, strict=True))
    return Mesh(mesh.vertices, mesh.faces, attributes={"vertex": channels})


# --- what can be baked ------------------------------------------------------------------------


def as_path(mesh, folder):
    write_mesh(folder / "ball.ply", mesh)
    return folder / "ball.ply"


class PathOfItsOwn(os.PathLike):
    def __init__(self, path):
        self.path = path

    def __fspath__(self):
        return str(self.path)


FORMS = {
    "path": as_path,
    "text": lambda mesh, folder: str(as_path(mesh, folder)),
    "path-like": lambda mesh, folder: PathOfItsOwn(as_path(mesh, folder)),
    "scale space": lambda mesh, _: scale_space(mesh, **QUICK),
    "pyvista": lambda mesh, _: pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces),
    "trimesh": lambda mesh, _: trimesh.Trimesh(mesh.vertices, mesh.faces, process=False),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_shape_in_any_form_gets_the_same_colours(small, tmp_path, form):
    shape = FORMS[form](small, tmp_path)
    found = bake(shape, **({} if form == "scale space" else QUICK))
    plain = bake(small, **QUICK)
    np.testing.assert_array_equal(found.colors, plain.colors)
    np.testing.assert_array_equal(found.intensity, plain.intensity)
    assert found.provenance["mesh"] == plain.provenance["mesh"]
    assert isinstance(found, Baked)


def test_one_line_does_what_the_steps_do(small):
    baked = bake(small, "exaggerated", light="east", exaggeration=20, **QUICK)
    space = scale_space(small, **QUICK)
    expected = shading.exaggerated(space, "east", exaggeration=20)
    np.testing.assert_array_equal(baked.intensity, expected)
    np.testing.assert_array_equal(baked.colors, color.encode(expected, linear=False))
    assert baked.colors.dtype == np.uint8
    assert repr(baked) == "<Baked: exaggerated on 642 samples>"


def test_linear_values_are_encoded_and_display_values_are_not(small):
    for method, linear in (("lambert", True), ("half_lambert", False)):
        baked = bake(small, method)
        np.testing.assert_array_equal(baked.colors, color.encode(baked.intensity, linear=linear))


def test_a_colour_map_colours_the_display_values(small):
    baked = bake(small, "lambert", colormap="gooch")
    expected = color.encode(baked.intensity, linear=True, colormap="gooch")
    np.testing.assert_array_equal(baked.colors, expected)
    assert (baked.colors.std(axis=1) > 0).any()


def test_names_of_lights_follow_the_view(small):
    top = bake(small, "lambert", light="front", view="top")
    np.testing.assert_array_equal(top.colors, bake(small, "lambert", light=(0, 1, 0)).colors)
    upright = bake(small, "lambert", light="front", up="z")
    np.testing.assert_array_equal(upright.colors, bake(small, "lambert", light=(0, -1, 0)).colors)
    assert (top.view.name, top.provenance["view"]) == ("top", "top, up y")


# --- only what is needed ----------------------------------------------------------------------


@pytest.fixture
def sums(monkeypatch):
    """The widths at which Gaussian sums are computed, as they are."""
    calls = []
    compute = GaussianSums.at

    def counted(self, width, **options):
        calls.append(width)
        return compute(self, width, **options)

    monkeypatch.setattr(GaussianSums, "at", counted)
    return calls


@pytest.mark.parametrize("method", ["lambert", "half_lambert"])
def test_where_only_the_normals_are_used_nothing_is_smoothed(small, sums, method):
    baked = bake(small, method, scales=9)
    assert sums == []
    assert baked.provenance["scales"] == "0"


def test_every_scale_is_summed_once_and_a_shared_space_never_again(small, sums):
    space = scale_space(small, scales=3)
    assert len(set(sums)) == 3
    del sums[:]
    for light in ("north", "east"):
        bake(space, light=light)
    assert sums == []


def test_progress_is_reported_to_its_end(small):
    calls = []
    bake(small, progress=lambda done, total: calls.append((done, total)), **QUICK)
    assert calls[-1] == (2, 2)


def test_the_method_s_own_scales_unless_given(small):
    declared = shading.declaration(shading.exaggerated)
    text = bake(small, tolerance=1e-2).provenance["scales"]
    assert text.startswith(f"{declared.scales}, ")
    assert f"ratio {declared.ratio:.6g}" in text
    given = bake(small, scales=2, width=0.5, ratio=3, tolerance=1e-2).provenance["scales"]
    assert given.startswith("2, widths 0.5 to 1.5, ratio 3")


# --- a scale space as it is -------------------------------------------------------------------


@pytest.mark.parametrize(
    "asked",
    [
        {"scales": 3},
        {"width": 0.1},
        {"width": "1%"},
        {"ratio": 1.3},
        {"facing": 0},
        {"tolerance": 1e-2},
    ],
)
def test_a_finished_scale_space_can_t_be_asked_for_other_scales(small, asked):
    space = scale_space(small, scales=2)
    ((name, value),) = asked.items()
    sentence = f"{name}={value!r} comes too late: this ScaleSpace has been made; leave it out"
    with pytest.raises(MeshdepictError, match=re.escape(sentence)):
        bake(space, **asked)


def test_what_a_scale_space_was_made_with_may_be_repeated(small):
    space = scale_space(small, scales=2, ratio=1.7)
    bake(space, ratio=1.7)


# --- albedo -----------------------------------------------------------------------------------


def test_white_is_shaded_as_if_there_were_no_colours(small):
    white = colored(small, np.full((642, 3), 255))
    for method in ("lambert", "half_lambert"):
        kept = bake(white, method, albedo="keep")
        np.testing.assert_array_equal(kept.colors, bake(small, method).colors)
        assert kept.provenance["albedo"] == "keep"


def test_colours_are_multiplied_in_linear_light(small, rng):
    own = rng.integers(0, 256, (642, 3))
    baked = bake(colored(small, own), "lambert", albedo="keep")
    light = color.srgb_to_linear(own / 255) * baked.intensity[:, None]
    # The shading is rounded to a level before it is multiplied: one level at most.
    off = baked.colors.astype(float) - 255 * color.linear_to_srgb(light)
    assert np.abs(off).max() <= 1
    ignored = bake(colored(small, own), "lambert")
    np.testing.assert_array_equal(ignored.colors, bake(small, "lambert").colors)


@pytest.mark.parametrize(
    "names", [("original_red", "original_green", "original_blue"), ("red", "green", "blue")]
)
@pytest.mark.parametrize("kind", ["bytes", "fractions"])
def test_colours_by_either_name_and_type_are_the_object_s_own(small, names, kind):
    own = np.tile([10, 200, 100], (642, 1)).astype(np.uint8)
    values = own if kind == "bytes" else own / 255
    attributes = {"vertex": dict(zip(names, values.T, strict=True))}
    baked = bake(Mesh(small.vertices, small.faces, attributes=attributes), "lambert", albedo="keep")
    expected = bake(colored(small, own), "lambert", albedo="keep")
    np.testing.assert_array_equal(baked.colors, expected.colors)


def test_without_colours_there_is_no_albedo_to_keep(small):
    with pytest.raises(MeshdepictError, match=r"needs the object's own .* the mesh has none"):
        bake(small, "lambert", albedo="keep")


@pytest.mark.parametrize("through", ["file", "pyvista"])
def test_a_former_bake_is_no_albedo(small, tmp_path, through):
    first = bake(small, "lambert")
    again = first.to_pyvista() if through == "pyvista" else first.save(tmp_path / "first.ply")
    with pytest.raises(MeshdepictError, match="only those of a former bake"):
        bake(again, "lambert", albedo="keep")


@pytest.mark.parametrize("through", ["file", "pyvista"])
def test_a_second_bake_takes_the_object_s_colours_not_the_first_one_s(
    small, tmp_path, rng, through
):
    mesh = colored(small, rng.integers(0, 256, (642, 3)))
    first = bake(mesh, "half_lambert", light="east")
    again = first.to_pyvista() if through == "pyvista" else first.save(tmp_path / "first.ply")
    second = bake(again, "lambert", albedo="keep")
    np.testing.assert_array_equal(second.colors, bake(mesh, "lambert", albedo="keep").colors)


# --- what becomes of it -----------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".ply", ".vtp"])
def test_saved_and_read_again_it_is_the_same(small, tmp_path, suffix):
    baked = bake(small, "lambert")
    path = baked.save(str(tmp_path / f"baked{suffix}"))
    again = read_mesh(path)
    found = np.stack(
        [again.attributes["vertex"][part] for part in ("red", "green", "blue")], axis=1
    )
    np.testing.assert_array_equal(found, baked.colors)
    np.testing.assert_array_equal(again.vertices, small.vertices)
    np.testing.assert_array_equal(again.faces, small.faces)
    assert read_provenance(path) == baked.comments


# --- wrong input ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "options", "sentence"),
    [
        ("exagerated", {}, "no method is called 'exagerated'; did you mean 'exaggerated'?"),
        ("zzz", {}, "no method is called 'zzz' (there are exaggerated, "),
        (["lambert"], {}, "no method is called ['lambert']"),
        ("exaggerated", {"exageration": 3}, "'exageration'; did you mean 'exaggeration'?"),
        ("exaggerated", {"exaggeration": -3}, "exaggeration=-3 is not a number in its range (0 …"),
        (
            "lambert",
            {"exaggeration": 3},
            "no option 'exaggeration' (its options: shadows, bounces, rays, denoise, exposure)",
        ),
        ("lambert", {"colormap": "seppia"}, "no colour map 'seppia'; did you mean 'sepia'?"),
        ("lambert", {"albedo": "mine"}, "albedo='mine' is neither 'keep' nor 'none'"),
        ("lambert", {"light": "norht"}, "no light is called 'norht'; did you mean 'north'?"),
        ("lambert", {"view": "fornt"}, "no view is called 'fornt'; did you mean 'front'?"),
        ("lambert", {"up": "w"}, "up='w' is not one of y, z, -y, -z, x, -x"),
        ("exaggerated", {"scales": -1}, "scales=-1 is not a whole number"),
        ("exaggerated", {"scales": 0}, "needs at least one scale"),
        ("exaggerated", {"width": "wide"}, "width='wide' is not a positive length"),
    ],
)  # fmt: skip
def test_wrong_input_is_one_sentence(small, method, options, sentence):
    with pytest.raises(MeshdepictError) as caught:
        bake(small, method, **options)
    assert sentence in str(caught.value)


def test_what_can_be_refused_is_refused_before_the_work(small, sums):
    for options in ({"colormap": "x"}, {"albedo": "keep"}, {"light": "x"}, {"exposure": -1}):
        with pytest.raises(MeshdepictError):
            bake(small, **options)
    assert sums == []


@pytest.mark.parametrize("shape", [3, None, np.eye(3), [1, 2]])
def test_what_is_no_shape(shape):
    with pytest.raises(MeshdepictError, match=r"is not a shape: give a path, a Mesh, a pyvista"):
        as_mesh(shape)


@pytest.mark.parametrize(
    ("shape", "sentence"),
    [(pv.ImageData(), r"ImageData, which is a volume: .* bake_volume"),
     (trimesh.Scene(), "Scene, which holds no mesh")],
)  # fmt: skip
def test_what_others_hold_that_is_no_mesh(shape, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        as_mesh(shape)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(MeshdepictError, match=r"nothing.ply: there is no such file"):
        bake(tmp_path / "nothing.ply")


@pytest.mark.parametrize(
    "method", ["lambert", "phong", "radiance_scaling", "light_warping", "light_alignment"]
)
def test_how_sure_light_that_bounces_is_stands_in_what_is_baked_and_nowhere_else(method):
    bounced = bake(samples.torus(600), method, light="northwest", bounces=1)
    assert bounced.provenance["light error"].endswith(" grey levels")
    assert "light error" not in bake(bounced.space, method, light="northwest").provenance
