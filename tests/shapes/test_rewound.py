"""Turning faces for good: the surface stays, its faces look outwards."""

import numpy as np
import pytest

from meshdepict import Mesh, MeshdepictWarning, samples
from meshdepict.shapes.document import Document
from meshdepict.surface.polygons import as_polygons


def lists(mesh):
    connectivity, offsets = mesh.polygons or as_polygons(mesh.faces)
    return [part.tolist() for part in np.split(connectivity, offsets[1:-1])]


@pytest.fixture
def prism():
    """A pentagonal prism: five quads, two pentagons, and a face without area in between."""
    angle = np.arange(5) * (2 * np.pi / 5)
    ring = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    vertices = np.concatenate((np.insert(ring, 2, 0, axis=1), np.insert(ring, 2, 1, axis=1)))
    sides = [[i, (i + 1) % 5, (i + 1) % 5 + 5, i + 5] for i in range(5)]
    return vertices, [[4, 3, 2, 1, 0], *sides[:3], [0, 0, 1], *sides[3:], [5, 6, 7, 8, 9]]


def test_what_points_outwards_is_left_alone(ball, prism):
    assert ball.rewound() is ball
    mesh = Mesh(*prism)
    assert mesh.rewound() is mesh


def test_triangles_are_turned_about_their_first_corner(ball, rng):
    wrong = rng.random(len(ball.faces)) < 0.3
    faces = np.where(wrong[:, None], ball.faces[:, [0, 2, 1]], ball.faces)
    mesh = Mesh(ball.vertices, faces)
    with pytest.warns(MeshdepictWarning, match="winding"):
        fixed = mesh.rewound()
    assert np.array_equal(fixed.faces, ball.faces)
    assert fixed.polygons is None
    assert np.allclose(fixed.normals, mesh.normals, atol=1e-12)  # sums in another order


def test_polygons_are_turned_whole(prism):
    vertices, polygons = prism
    turned = [[p[0], *p[:0:-1]] if i in (1, 5, 7) else p for i, p in enumerate(polygons)]
    mesh = Mesh(vertices, turned, attributes={"face": {"number": np.arange(len(turned))}})
    with pytest.warns(MeshdepictWarning, match="winding"):
        fixed = mesh.rewound()
    assert lists(fixed) == polygons
    assert np.array_equal(fixed.attributes["face"]["number"], np.arange(len(turned)))
    assert np.allclose(fixed.normals, mesh.normals, atol=1e-12)
    assert lists(mesh) == turned


def test_a_polygon_with_a_part_without_area_is_turned(prism):
    """A corner on an edge gives triangles that are never turned themselves."""
    vertices, polygons = prism
    vertices = np.concatenate((vertices, (vertices[0] + vertices[1])[None] / 2))
    del polygons[4]
    polygons[0] = [4, 3, 2, 1, 10, 0]
    polygons[1] = [0, 10, 1, 6, 5]
    mesh = Mesh(vertices, [[p[0], *p[:0:-1]] for p in polygons])
    with pytest.warns(MeshdepictWarning, match="inside out"):
        assert lists(mesh.rewound()) == polygons


class Textured(Document):
    texcoords = (np.zeros((1, 2)), np.zeros(3, int))


def test_what_else_the_file_held(sphere):
    """That its colours are a former bake's stays known; texture coordinates go with a warning."""
    document = Textured(provenance=("meshdepict method: lambert",))
    mesh = Mesh(sphere.vertices, sphere.faces[:, ::-1], document=document)
    with pytest.warns(MeshdepictWarning) as caught:
        fixed = mesh.rewound()
    assert any("texture coordinates are lost" in str(warning.message) for warning in caught)
    assert fixed.document == Document(provenance=document.provenance)


def test_the_other_way_round_twice_is_the_same(prism):
    polygons = as_polygons(prism[1])
    which = np.arange(len(prism[1])) % 2 == 0
    again = polygons.reversed(which).reversed(which)
    assert np.array_equal(again.connectivity, polygons.connectivity)
    assert not np.array_equal(polygons.reversed(which).connectivity, polygons.connectivity)


def test_real_polygons(data):
    from meshdepict.io import read_mesh

    mesh = read_mesh(data / "formats" / "ply_ascii_ngons_shark.ply")  # inside out
    with pytest.warns(MeshdepictWarning, match="inside out"):
        fixed = mesh.rewound()
    assert lists(fixed) == [[p[0], *p[:0:-1]] for p in lists(mesh)]
    assert Mesh(fixed.vertices, fixed.polygons).orientation.message is None


def test_samples_are_wound_outwards():
    for shape in (samples.sphere(100), samples.torus(200)):
        assert shape.rewound() is shape
