import re

import numpy as np
import pytest

from meshdepict import __version__, bake, samples, scale_space, shading
from meshdepict.options import check, options_of
from meshdepict.scene.light import Light
from meshdepict.scene.view import View
from meshdepict.shapes.fingerprint import fingerprint
from meshdepict.shapes.mesh import Mesh


def digest(mesh):
    return fingerprint(mesh.vertices, mesh.faces)


@pytest.fixture(scope="module")
def small():
    return samples.golf_ball(600, dimples=12, depth=0.05)


def test_the_provenance_says_all_that_it_takes_to_bake_again(small):
    baked = bake(
        small, "exaggerated", light=(-45, 30), view="top", up="z", scales=3, width=0.1, ratio=1.5,
        tolerance=1e-3, colormap="sepia", exaggeration=12.5,
    )  # fmt: skip
    found = baked.provenance
    assert list(found) == [
        "version", "method", "options", "scales", "light", "view", "colormap", "albedo", "mesh"
    ]  # fmt: skip
    assert found["version"] == __version__
    assert found["method"] == "exaggerated"
    given = dict(part.split("=") for part in found["options"].split())
    options = check(shading.exaggerated, given, "as --set would")
    assert [options[name] for name in ("exaggeration", "base", "contrast")] == [12.5, 1, 1]
    for name, option in options_of(shading.exaggerated).items():  # those not given, too
        assert name in ("exaggeration", "base", "contrast") or options.get(name) == option.default
    assert found["scales"].startswith("3, widths 0.1 to 0.225, ratio 1.5")
    assert found["light"].startswith("azimuth -45 elevation 30 (")
    assert (found["view"], found["colormap"], found["albedo"]) == ("top, up z", "sepia", "none")
    assert found["mesh"] == f"642 vertices 1280 triangles sha256 {digest(small)}"
    assert all(text.isprintable() for text in baked.comments)
    assert all(line.startswith("meshdepict ") for line in baked.comments)


def test_scales_as_told_are_the_space_s_not_the_call_s(small):
    space = scale_space(small, scales=2, width=0.3, ratio=2)
    assert bake(space).provenance["scales"].startswith("2, widths 0.3 to 0.6, ratio 2")


def test_facing_and_tolerance_are_the_space_s_not_the_call_s(small):
    space = scale_space(small, scales=2, facing=0, tolerance=1e-3)
    text = "facing 0, tolerance 0.001"
    assert bake(space).provenance["scales"].endswith(text)
    bake(space, facing=0, tolerance=1e-3)  # repeated
    made = bake(small, scales=2, facing=0, tolerance=1e-3)
    assert made.provenance["scales"] == bake(space).provenance["scales"]


def test_a_view_and_a_light_of_one_s_own_are_written_out(small):
    view = View((0, 0, 9), (0, 0, 1), (0, 1, 0), name="detail")
    found = bake(small, "lambert", view=view, light=Light((3, 0, 0), "lamp")).provenance
    assert found["view"] == "detail from (0 0 9) to (0 0 1), up (0 1 0)"
    assert found["light"] == "lamp (1 0 0)"


def test_the_digest_depends_on_every_coordinate_and_corner(small):
    again = Mesh(small.vertices, small.faces)
    assert digest(again) == digest(small)
    assert re.fullmatch("[0-9a-f]{16}", digest(small))
    moved = small.vertices.copy()
    moved[5, 1] = np.nextafter(moved[5, 1], 9)
    assert digest(Mesh(moved, small.faces)) != digest(small)
    turned = small.faces.copy()
    turned[7] = np.roll(turned[7], 1)
    assert digest(Mesh(small.vertices, turned)) != digest(small)


def test_occlusion_states_its_error(small):
    baked = bake(small, "ambient_occlusion", rays=16)
    assert baked.provenance["occlusion"].startswith("16 rays, rms error ")
    assert "occlusion" not in bake(small, "lambert").provenance
