"""Defects are counted as anyone would count them by hand."""

import numpy as np
import pytest

from meshdepict import Mesh, samples
from meshdepict.shapes.defects import Defects, find_defects

CLEAN = {
    "parts": 1,
    "unreferenced_vertices": 0,
    "coincident_vertices": 0,
    "degenerate_faces": 0,
    "duplicate_faces": 0,
    "border_edges": 0,
    "nonmanifold_edges": 0,
}


def odd(mesh):
    """What differs from a clean closed mesh of one part."""
    found = vars(find_defects(mesh))
    return {name: count for name, count in found.items() if count != CLEAN[name]}


def test_closed_shapes_have_none(ball):
    assert find_defects(ball) == Defects(**CLEAN)


def test_the_border_of_a_sheet():
    sheet = samples.wavy_sheet(100)
    side = round(len(sheet.vertices) ** 0.5)
    assert side**2 == len(sheet.vertices)
    assert odd(sheet) == {"border_edges": 4 * (side - 1)}


def test_two_balls_are_two_parts(sphere):
    both = np.concatenate((sphere.vertices, sphere.vertices + 10))
    faces = np.concatenate((sphere.faces, sphere.faces + len(sphere.vertices)))
    assert odd(Mesh(both, faces)) == {"parts": 2}


def test_a_soup_of_triangles_hangs_together_by_positions(sphere):
    corners = sphere.vertices[sphere.faces].reshape(-1, 3)
    soup = Mesh(corners, np.arange(len(corners)).reshape(-1, 3))
    assert odd(soup) == {"coincident_vertices": len(corners) - len(sphere.vertices)}


def test_unused_vertices(sphere):
    more = np.concatenate((sphere.vertices, [(7, 7, 7), (8, 8, 8)]))
    assert odd(Mesh(more, sphere.faces)) == {"unreferenced_vertices": 2}


def test_duplicates_count_whatever_their_first_corner_or_direction(sphere):
    copies = sphere.faces[[0, 0, 9]][:, [1, 2, 0]]
    copies[1] = copies[1, ::-1]
    found = odd(Mesh(sphere.vertices, np.concatenate((sphere.faces, copies)), winding="keep"))
    assert found == {"duplicate_faces": 3, "nonmanifold_edges": 6}


def test_a_fin_makes_an_edge_non_manifold(sphere):
    a, b, _ = sphere.faces[0]
    vertices = np.concatenate((sphere.vertices, [(3, 3, 3)]))
    faces = np.concatenate((sphere.faces, [(a, b, len(sphere.vertices))]))
    assert odd(Mesh(vertices, faces)) == {"nonmanifold_edges": 1, "border_edges": 2}


@pytest.mark.parametrize("corners", [(0, 0, 1), (0, 0, 0), (0, 1, 2)])
def test_faces_without_area(corners):
    line = Mesh([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0)], [corners, (0, 1, 3)])
    found = find_defects(line)
    assert found.degenerate_faces == 1
    assert found.parts == 1


def test_a_mesh_of_nothing_but_degenerate_faces():
    found = find_defects(Mesh([(0, 0, 0), (1, 0, 0)], [(0, 1, 1), (0, 0, 0)]))
    assert found.degenerate_faces == 2
    assert (found.border_edges, found.duplicate_faces) == (0, 0)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("beetle_2k", {"parts": 2, "border_edges": 296, "nonmanifold_edges": 47}),
        ("gears_19k", {"parts": 7}),
        ("bunny_69k", {"border_edges": 223, "unreferenced_vertices": 1113}),
        (
            "dragon_203k",
            {
                "parts": 7,
                "unreferenced_vertices": 43,
                "duplicate_faces": 1489,
                "nonmanifold_edges": 2534,
            },
        ),
    ],
)
def test_real_scans_have_what_their_manifest_says(data, name, expected):
    from meshdepict.io import read_mesh

    assert odd(read_mesh(data / "mesh" / f"{name}.ply", winding="keep")) == expected
