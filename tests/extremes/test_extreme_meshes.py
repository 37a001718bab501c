"""Every method on every odd mesh: a proper picture. Nothing that comes in is changed."""

from __future__ import annotations

import numpy as np
import pytest
from extreme_calls import always, proper, taken_or_refused, usual, variants
from hypothesis import example, given
from hypothesis import strategies as st
from method_families import ON_MESHES
from odd_meshes import SMALL

import meshdepict as md
from meshdepict.curvature import ESTIMATORS, principal_curvatures
from meshdepict.shading import METHODS

pytestmark = pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")
every_mesh = pytest.mark.parametrize("name", SMALL)


def mesh_of(name, winding="auto"):
    return md.Mesh(*SMALL[name](), winding=winding)


@every_mesh
@pytest.mark.parametrize("winding", ["auto", "keep"])
def test_every_method_shades_it_in_all_its_ways(name, winding):
    mesh = mesh_of(name, winding)
    space = md.scale_space(mesh, scales=2)
    for method in ON_MESHES:
        for options in variants(method):
            proper(md.bake(space, method, **options).intensity, len(mesh.vertices))


@every_mesh
@pytest.mark.parametrize("width", [5e-324, 1e-300, 1e300, "1e-300%", "1e300%"])
def test_any_width_is_a_limit(name, width):
    mesh = mesh_of(name)
    with taken_or_refused():
        space = md.scale_space(mesh, scales=1, width=width)
        np.testing.assert_allclose(np.linalg.norm(space.normals, axis=2), 1, atol=1e-6)
        proper(md.bake(space, "exaggerated").intensity, len(mesh.vertices))


@every_mesh
@pytest.mark.parametrize("scales", [0, 1, 40])
def test_few_scales_and_many(name, scales):
    mesh = mesh_of(name)
    space = md.scale_space(mesh, scales=scales)
    assert np.isfinite(space.normals).all()
    proper(md.bake(space, "lambert").intensity, len(mesh.vertices))
    if scales:
        proper(md.bake(space, "exaggerated").intensity, len(mesh.vertices))


@every_mesh
@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_every_estimator_of_curvature_is_finite(name, estimator):
    for part in principal_curvatures(mesh_of(name), method=estimator):
        assert np.isfinite(part).all()


@every_mesh
def test_its_pixels_and_texels_are_shaded(name):
    mesh = mesh_of(name)
    with taken_or_refused():  # what is seen edge on fills no pixel
        buffer = md.GBuffer.of(mesh, "front", size=(24, 24))
        space = md.scale_space(buffer, scales=2)
        for method in ("exaggerated", "light_warping", "light_alignment", "mean_curvature"):
            proper(md.bake(space, method, **usual(method)).intensity, space.count)
    md.bake_texture(mesh, "exaggerated", size=256, scales=1)


@st.composite
def meshes(draw):
    """Triangles among a few points, some of which coincide, of any size and anywhere."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(3, 12))
    sizes = 10.0 ** rng.uniform(-draw(st.integers(0, 12)), 0, (count, 1))
    points = rng.normal(size=(count, 3)) * sizes
    points[rng.random(count) < draw(st.floats(0, 0.8))] = points[0]
    points[:, rng.random(3) < 0.2] = 0
    faces = rng.integers(0, count, (draw(st.integers(1, 30)), 3))
    size = 2.0 ** draw(st.integers(-440, 440))
    return (points + rng.normal(size=3) * draw(st.sampled_from([0, 1, 1e4, 1e8]))) * size, faces


@always(150)
@given(mesh=meshes(), method=st.sampled_from(ON_MESHES), choices=st.data())
def test_any_triangles(mesh, method, choices):
    vertices, faces = mesh
    before = vertices.copy(), faces.copy()
    options = choices.draw(st.sampled_from(variants(method)))
    space = md.scale_space(md.Mesh(vertices, faces), scales=choices.draw(st.integers(1, 3)))
    proper(METHODS[method](space, "northwest", **options), len(vertices))
    np.testing.assert_array_equal(vertices, before[0])
    np.testing.assert_array_equal(faces, before[1])


@always(100)
@given(exponent=st.integers(-1070, 1023))
@example(exponent=1000)
@example(exponent=-1000)
@example(exponent=498)
@example(exponent=-498)
def test_a_mesh_of_any_size_is_taken_or_refused(exponent):
    vertices, faces = SMALL["one triangle"]()
    with taken_or_refused():
        mesh = md.Mesh(np.ldexp(vertices, exponent), faces)
        assert -499 <= exponent <= 498  # 1e150, and its inverse
        proper(md.bake(mesh, "exaggerated", scales=2).intensity, 3)
        return
    assert not -497 <= exponent <= 497
