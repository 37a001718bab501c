import numpy as np
import pytest
from conftest import angle_between, rotation, tetrahedron

from meshdepict import samples
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.polygons import Polygons

# A box of four walls, open at its ends, as quadrilaterals …
BOX = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 2], [1, 0, 2], [1, 1, 2], [0, 1, 2]], float
)
WALLS = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
CORNER = np.eye(3), [[0, 1, 2]]


def area_of(mesh):
    a, b, c = (mesh.vertices[corner] for corner in mesh.faces.T)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


# --- what comes in ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "faces",
    [
        WALLS,
        tuple(tuple(wall) for wall in WALLS),
        np.array(WALLS, np.uint8),
        np.array(WALLS, object),
        Polygons(np.ravel(WALLS), np.arange(0, 20, 4)),
    ],
    ids=["lists", "tuples", "array", "objects", "polygons"],
)
def test_quadrilaterals_in_every_form_are_one_mesh(faces):
    mesh = Mesh(BOX, faces)
    assert mesh.polygons is not None
    np.testing.assert_array_equal(mesh.polygons.connectivity, np.ravel(WALLS))
    np.testing.assert_array_equal(mesh.polygons.offsets, np.arange(0, 20, 4))
    assert mesh.faces.dtype == np.int64
    assert mesh.faces.shape == (8, 3)
    assert area_of(mesh).sum() == pytest.approx(8)


@pytest.mark.parametrize("form", ["array", "lists", "polygons"])
def test_triangles_need_no_polygons(form):
    vertices, faces = tetrahedron()
    given = {
        "array": faces,
        "lists": faces.tolist(),
        "polygons": Polygons(faces.ravel(), np.arange(0, 13, 3)),
    }
    mesh = Mesh(vertices, given[form])
    assert mesh.polygons is None
    np.testing.assert_array_equal(mesh.faces, faces)


def test_polygons_of_all_sizes_stay_as_they_are():
    faces = [[0, 3, 2, 1], [4, 5], [4, 5, 6], [0, 1, 2, 3, 7]]
    mesh = Mesh(BOX, faces)
    np.testing.assert_array_equal(mesh.polygons.connectivity, np.concatenate(faces))
    np.testing.assert_array_equal(mesh.polygons.offsets, [0, 4, 6, 9, 14])
    assert len(mesh.faces) == 2 + 0 + 1 + 3


def test_three_corners_on_average_are_not_triangles():
    # Corners, polygons and triangles count as if all were triangles: a quadrilateral, a line.
    mesh = Mesh(BOX, [[0, 1, 2, 3], [4, 5]], attributes={"face": {"id": [7, 8]}})
    np.testing.assert_array_equal(mesh.polygons.offsets, [0, 4, 6])
    assert list(mesh.attributes["face"]["id"]) == [7, 8]


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.float16, np.int32, object])
def test_vertices_are_kept_to_the_last_bit(kind, rng):
    vertices = (1000 * rng.normal(size=(5, 3))).astype(kind)
    mesh = Mesh(vertices, [[0, 1, 2], [2, 3, 4]])
    assert mesh.vertices.dtype == np.float64
    np.testing.assert_array_equal(mesh.vertices, vertices.astype(float))


def test_nothing_given_is_modified_or_frozen_and_nothing_kept_can_be_changed():
    vertices, faces = tetrahedron()
    height, mark = vertices[:, 2].copy(), np.arange(4)
    given = [vertices, faces, height, mark]
    before = [array.copy() for array in given]
    mesh = Mesh(vertices, faces, attributes={"vertex": {"height": height}, "face": {"mark": mark}})
    kept = [mesh.vertices, mesh.faces, *mesh.attributes["vertex"].values()]
    kept += [*mesh.attributes["face"].values(), mesh.normals, mesh.areas]
    for array in kept:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    for array, old in zip(given, before, strict=True):
        np.testing.assert_array_equal(array, old)
        array[:] = 0  # still the caller's, and of no consequence to the mesh
    np.testing.assert_array_equal(mesh.vertices, before[0])
    np.testing.assert_array_equal(mesh.attributes["face"]["mark"], [0, 1, 2, 3])


def test_polygons_are_read_only_too():
    mesh = Mesh(BOX, WALLS)
    for array in mesh.polygons:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.parametrize(
    ("vertices", "faces", "sentence"),
    [
        (np.eye(4), [[0, 1, 2]], r"vertices must have shape \(n, 3\), not \(4, 4\)"),
        (np.zeros(3), [[0, 0, 0]], r"not \(3,\)"),
        ([["a", "b", "c"]], [[0, 0, 0]], "vertices must be an .* array of numbers"),
        ([["1", "2", "3"]], [[0, 0, 0]], "array of numbers"),
        ([[1, 2, 3], [4, 5]], [[0, 0, 0]], "array of numbers"),
        ([[1j, 0, 0]], [[0, 0, 0]], "array of numbers"),
        ([[10**400, 0, 0]], [[0, 0, 0]], "array of numbers"),
        (None, [[0, 0, 0]], r"not \(\)"),
        (np.empty((0, 3)), [[0, 0, 0]], "the mesh is empty: it has no vertices"),
        (
            [[0, 0, 0], [0, np.nan, 0], [np.inf, 0, 0]],
            [[0, 1, 2]],
            "2 of 3 vertices are NaN or inf",
        ),
        ([[0, 0, 0], [1, np.inf, 2], [0, 0, 1]], [[0, 1, 2]], "the first is vertex 1: 1, inf, 2"),
        (np.eye(3) * 1e200, [[0, 1, 2]], "vertices beyond 1e.150"),
        (np.eye(3) * 1e308, [[0, 1, 2]], "vertices beyond 1e.150"),
        (np.eye(3) * 1e-310, [[0, 1, 2]], "vertices lie within 1e-150 of each other"),
        (np.eye(3), [], r"no faces \(3 vertices\)"),
        (np.eye(3), np.empty((0, 3), int), "no faces"),
        (np.eye(3), [[0, 1], [2]], "no faces with three corners"),
        (np.eye(3), [[0, 1]], r"not shape \(1, 2\)"),
        (np.eye(3), [0, 1, 2], r"not shape \(3,\)"),
        (np.eye(3), None, "index arrays or a list"),
        (np.eye(3), [[0.0, 1.0, 2.0]], "whole numbers, not float64"),
        (np.eye(3), [["0", "1", "2"]], "whole numbers"),
        (np.eye(3), [[0, 1, 2], [0, 1, 3, 7]], r"face 1 refers to vertex 3, .* \(2 such corners\)"),
        (np.eye(3), [[0, 1, -1]], "face 0 refers to vertex -1, but the mesh has 3 vertices"),
        (np.eye(3), Polygons(np.arange(3), np.array([0, 2])), "offsets of polygons must rise"),
    ],
)
def test_what_is_no_mesh_is_refused(vertices, faces, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        Mesh(vertices, faces)


@pytest.mark.parametrize("stray", [np.nan, np.inf, -1e300])
def test_what_no_face_uses_may_be_anywhere(stray):
    vertices = np.vstack((np.eye(3), [[0, stray, 0]]))
    with pytest.warns(MeshdepictWarning, match="1 vertices that no face uses are NaN"):
        mesh = Mesh(vertices, [[0, 1, 2]])
    assert mesh.diagonal == Mesh(np.eye(3), [[0, 1, 2]]).diagonal
    assert np.isfinite(mesh.vertices).all()
    assert np.isfinite(mesh.normals).all()
    np.testing.assert_array_equal(mesh.vertices[:3], np.eye(3))


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"winding": "left"}, "winding='left' is neither 'auto' nor 'keep'"),
        ({"attributes": {"edge": {}}}, "belong to 'vertex' or 'face', not 'edge'"),
        ({"attributes": {"vertex": {"x": [1, 2]}}}, r"'x' has shape \(2,\), expected 3 rows"),
        ({"attributes": {"face": {"x": 1}}}, r"face attribute 'x' has shape \(\), expected 1 rows"),
    ],
)
def test_what_goes_with_a_mesh_is_checked(options, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        Mesh(*CORNER, **options)


def test_repr_counts_polygons():
    assert repr(Mesh(BOX, WALLS)) == "<Mesh: 8 vertices, 4 faces, diagonal 2.449>"


# --- normals ----------------------------------------------------------------------------------


def test_normals_are_exact_on_a_sphere(sphere):
    # Max's weights; what is left is rounding, relative to edges of 1/20.
    np.testing.assert_allclose(sphere.normals, sphere.vertices, atol=1e-12)


def test_an_inside_out_mesh_gets_outward_normals_and_a_warning(sphere):
    wrong = Mesh(sphere.vertices, sphere.faces[:, ::-1])
    with pytest.warns(MeshdepictWarning, match="the mesh was inside out"):
        normals = wrong.normals
    np.testing.assert_allclose(normals, sphere.normals, atol=1e-12)
    np.testing.assert_array_equal(wrong.faces, sphere.faces[:, ::-1])  # as given


def test_winding_is_believed_where_it_shall_be(sphere):
    kept = Mesh(sphere.vertices, sphere.faces[:, ::-1], winding="keep")
    np.testing.assert_allclose(kept.normals, -sphere.normals, atol=1e-12)
    assert kept.orientation.message is None


def test_vertices_without_a_proper_face_have_a_normal_all_the_same():
    vertices = np.vstack([np.eye(3), [[5, 5, 5], [0, 0, 0], [1, 1, 1], [2, 2, 2]]])
    mesh = Mesh(vertices, [[0, 1, 2], [4, 5, 6]])
    np.testing.assert_array_equal(mesh.normals[3:], np.tile([0, 0, 1], (4, 1)))
    np.testing.assert_allclose(mesh.normals[:3], np.full((3, 3), 3**-0.5))
    np.testing.assert_array_equal(mesh.areas[3:], 0)


def test_a_seam_is_no_edge(sphere):
    soup = Mesh(
        sphere.vertices[sphere.faces].reshape(-1, 3), np.arange(sphere.faces.size).reshape(-1, 3)
    )
    np.testing.assert_allclose(soup.normals, sphere.normals[sphere.faces.ravel()], atol=1e-12)
    valence = np.bincount(sphere.faces.ravel())
    share = (sphere.areas / valence)[sphere.faces.ravel()]
    np.testing.assert_allclose(soup.areas, share, rtol=1e-9)


def test_a_sheet_doubled_with_two_sides_keeps_both():
    sheet = samples.wavy_sheet(400)
    n = len(sheet.vertices)
    both = Mesh(np.tile(sheet.vertices, (2, 1)), np.vstack([sheet.faces, sheet.faces[:, ::-1] + n]))
    np.testing.assert_allclose(both.normals, np.vstack([sheet.normals, -sheet.normals]), atol=1e-12)
    np.testing.assert_allclose(both.areas, np.tile(sheet.areas, 2))


# --- size -------------------------------------------------------------------------------------


def test_the_edge_length_is_the_median_over_edges_not_over_sides():
    # A wheel of 12 spokes of length 1, each a side of two faces, and 12 pieces of rim, of one.
    angle = np.arange(12) * np.pi / 6
    wheel = np.vstack([[0, 0, 0], np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)])
    mesh = Mesh(wheel, [[0, 1 + i, 1 + (i + 1) % 12] for i in range(12)])
    rim = 2 * np.sin(np.pi / 12)
    assert mesh.edge_length == pytest.approx((1 + rim) / 2)


def test_edges_without_length_do_not_count():
    mesh = Mesh([[0, 0, 0]] * 6 + [[3, 0, 0]], [[0, 1, 2], [3, 4, 5], [0, 5, 6]])
    assert mesh.edge_length == pytest.approx(3)


@pytest.mark.parametrize("place", [0.0, 7.0, 1e20])
def test_a_mesh_in_one_point_has_a_length_to_smooth_by(place):
    mesh = Mesh(np.full((3, 3), place), [[0, 1, 2]])
    assert mesh.diagonal == 0
    assert mesh.edge_length > 0
    assert np.isfinite(mesh.normals).all()


def test_the_diagonal_is_that_of_the_box(rng):
    points = rng.normal(size=(20, 3))
    mesh = Mesh(points, [[0, 1, 2]])
    assert mesh.diagonal == pytest.approx(np.linalg.norm(np.ptp(points, axis=0)))


@pytest.mark.parametrize("factor", [1e-140, 1e-30, 1.0, 1e30, 1e140])
def test_units_change_nothing_but_lengths(ball, factor):
    scaled = Mesh(ball.vertices * factor, ball.faces)
    # Scaling by a power of ten rounds the coordinates: 1e-16 of a radius, 1e-14 of an edge.
    np.testing.assert_allclose(scaled.normals, ball.normals, atol=1e-12)
    assert scaled.edge_length == pytest.approx(ball.edge_length * factor, rel=1e-12)
    assert scaled.diagonal == pytest.approx(ball.diagonal * factor, rel=1e-12)
    assert scaled.areas.sum() == pytest.approx(area_of(ball).sum() * factor**2, rel=1e-12)


def test_survey_coordinates_cost_no_more_than_their_own_rounding(ball, rng):
    turn = rotation(rng)
    moved = Mesh(ball.vertices @ turn.T + 5e6, ball.faces)
    # At 5e6 a coordinate is rounded by 5e-10, which is 1e-8 of an edge of 0.05.
    assert angle_between(moved.normals, ball.normals @ turn.T).max() < 1e-7
    np.testing.assert_allclose(moved.areas, ball.areas, rtol=1e-6)
    assert moved.edge_length == pytest.approx(ball.edge_length, rel=1e-8)


def test_areas_add_up_to_the_surface(ball):
    assert ball.areas.sum() == pytest.approx(area_of(ball).sum(), rel=1e-12)
