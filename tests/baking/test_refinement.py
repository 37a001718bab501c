"""Colours between vertices: interpolated samples, their error, triangles split where it shows."""

import numpy as np
import pytest
from conftest import angle_between

import meshdepict as md
from meshdepict.baking import refinement
from meshdepict.baking.finer_mesh import FinerMesh
from meshdepict.baking.plane_sampling import with_sampled_planes
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_mesh
from meshdepict.samples import sphere as make_sphere
from meshdepict.samples import torus
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.mesh_scales import mesh_space
from meshdepict.scales.smoothing import NormalSums
from meshdepict.shading import METHODS, declaration
from meshdepict.shapes.mesh import Mesh
from meshdepict.surface.edges import is_balanced
from meshdepict.surface.splitting import edge_pairs, split_faces

LOCAL = [name for name, function in METHODS.items() if declaration(function).local]


@pytest.fixture(scope="module")
def space(ball):
    return md.scale_space(ball, scales=3)


def at_vertices(space):
    count = len(space.points)
    corners = np.repeat(np.arange(count)[:, None], 3, axis=1)
    return InterpolatedSpace(space, corners, np.tile((1.0, 0, 0), (count, 1)))


def within_faces(space, rng):
    weights = rng.dirichlet((1, 1, 1), len(space.shape.faces))
    return InterpolatedSpace(space, space.shape.faces, weights)


def face_areas(points, faces):
    a, b, c = points[faces].swapaxes(0, 1)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


# --- interpolated samples -------------------------------------------------------------------------


def test_at_the_vertices_nothing_changes(space):
    same = at_vertices(space)
    np.testing.assert_allclose(same.points, space.points, atol=1e-12)
    assert angle_between(same.normals, space.normals).max() < 1e-6
    for a, b in zip(same.curvature(1)[:2], space.curvature(1)[:2], strict=True):
        np.testing.assert_allclose(a, b, atol=1e-5 * np.abs(b).max())
    np.testing.assert_array_equal(same._turns(1), space._turns(1))


@pytest.mark.parametrize("name", LOCAL)
def test_methods_shade_interpolated_vertices_as_vertices(name, space):
    there = METHODS[name](space, "northwest")
    np.testing.assert_allclose(METHODS[name](at_vertices(space), "northwest"), there, atol=5e-3)


def test_on_a_sphere_normals_and_curvature_are_the_spheres(rng):
    fine = make_sphere(10_000)
    inside = within_faces(md.scale_space(fine, scales=1), rng)
    radial = inside.points / np.linalg.norm(inside.points, axis=1, keepdims=True)
    # Normals interpolated linearly: second order in the edge (1/50), far below it.
    assert angle_between(inside.normals[0], radial).max() < 1e-4
    k1, k2, d1, d2 = inside.curvature(0)
    np.testing.assert_allclose(k1, 1, rtol=2e-3)
    np.testing.assert_allclose(k2, 1, rtol=2e-3)
    frame = np.stack([d1, d2, inside.normals[0]], axis=1)
    np.testing.assert_allclose(np.linalg.det(frame), 1, atol=1e-4)


def test_on_a_torus_principal_curvatures_keep_order_and_direction(rng):
    ring = md.scale_space(torus(20_000), scales=1)
    inside = within_faces(ring, rng)
    found, corner = inside.curvature(0), ring.curvature(0)
    assert (np.abs(found.k1) >= np.abs(found.k2) - 1e-9).all()
    first = ring.shape.faces[:, 0]
    clear = np.abs(np.abs(corner.k1) - np.abs(corner.k2))[first] > 0.5 * np.abs(corner.k1[first])
    assert clear.sum() > 1000
    along = np.abs(np.einsum("ni,ni->n", found.d1, corner.d1[first]))
    assert np.quantile(along[clear], 0.01) > 0.99


@pytest.mark.filterwarnings("ignore:winding of 1 faces was turned")  # there twice on purpose
def test_opposite_normals_leave_the_nearest():
    mesh = Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1e-3)], [(0, 1, 2), (0, 2, 1), (0, 1, 3)])
    space = md.scale_space(mesh, scales=1)
    space.planes.setflags(write=True)
    space.planes[:] = np.where(np.arange(4) < 1, [[0], [0], [1]], [[0], [0], [-1]])
    middle = InterpolatedSpace(space, np.array([(0, 1, 1)]), np.array([(0.5, 0.5, 0)]))
    np.testing.assert_allclose(np.abs(middle.normals[0]), [(0, 0, 1)])


# --- splitting ------------------------------------------------------------------------------------


@pytest.mark.parametrize("share", [0.0, 0.05, 0.5, 1.0])
def test_splitting_leaves_no_gaps_and_keeps_area_and_winding(ball, rng, share):
    edges = edge_pairs(ball.faces)
    chosen = edges[rng.random(len(edges)) < share]
    if len(chosen) == 0:
        chosen = edges[:1]
    number = len(ball.vertices) + np.arange(len(chosen))
    vertices = np.concatenate([ball.vertices, ball.vertices[chosen].mean(axis=1)])
    faces, parent = split_faces(ball.faces, chosen, number)
    assert is_balanced(faces, len(vertices))
    whole = np.bincount(parent, face_areas(vertices, faces))
    np.testing.assert_allclose(whole, face_areas(ball.vertices, ball.faces), rtol=1e-12)
    assert len(faces) == len(ball.faces) + 2 * len(chosen)
    a, b, c = vertices[faces].swapaxes(0, 1)
    A, B, C = ball.vertices[ball.faces[parent]].swapaxes(0, 1)
    assert (np.einsum("ni,ni->n", np.cross(b - a, c - a), np.cross(B - A, C - A)) > 0).all()


@pytest.mark.parametrize(("method", "levels"), [("exaggerated", 4), ("lambert", 4), ("phong", 6)])
def test_a_refined_bake_is_within_its_levels(ball, method, levels):
    function = METHODS[method]
    space = md.scale_space(ball, scales=3)
    view = md.View.fitted("front", ball)

    def shade(space):
        given = {"view": view} if "view" in declaration(function).needs else {}
        return function(space, (-1, 1, 1), **given)

    linear = declaration(function).linear
    before = refinement.edge_error(space, shade, linear=linear)
    mesh, values = refinement.refine(space, shade, linear=linear, levels=levels)
    assert len(mesh.faces) > len(ball.faces)
    shown = 255 * (linear_to_srgb(values) if linear else values)
    # Seen anew: old edges in the middle, against shading there.
    corners = ball.faces
    thirds = InterpolatedSpace(space, corners, np.tile((0.5, 0.5, 0), (len(corners), 1)))
    there = shade(thirds)
    there = 255 * (linear_to_srgb(there) if linear else there)
    from scipy.spatial import KDTree

    _, nearest = KDTree(mesh.vertices).query(thirds.points)
    split = np.linalg.norm(mesh.vertices[nearest] - thirds.points, axis=1) < 1e-9
    ends = (shown[corners[:, 0]] + shown[corners[:, 1]]) / 2
    assert np.abs(shown[nearest] - there)[split].max() < 0.05
    assert np.abs(ends - there)[~split].max() <= levels + 1e-3
    assert np.abs(ends - there)[split].min() > levels - 1e-3
    assert before.share > 0


def test_what_is_evenly_lit_is_left_as_it_is():
    sheet = md.samples.wavy_sheet(900, waves=0)
    baked = md.bake(sheet, "lambert", light=(0, 0, 1), refine=1)
    assert len(baked.shape.faces) == len(sheet.faces)
    assert md.bake(sheet, "lambert", light=(0, 0, 1)).edge_error.rms < 1e-3


def test_old_vertices_come_first_with_their_colours_and_attributes(ball):
    count = len(ball.vertices)
    mesh = Mesh(
        ball.vertices,
        ball.faces,
        attributes={
            "vertex": {"height": ball.vertices[:, 2], "red": np.full(count, 7, np.uint8)},
            "face": {"part": np.arange(len(ball.faces))},
        },
    )
    plain, fine = md.bake(mesh, scales=3), md.bake(mesh, scales=3, refine=2)
    assert len(fine.colors) == len(fine.shape.vertices) > count
    # Interpolated normals of single precision at the vertices themselves.
    assert np.abs(fine.colors[:count].astype(int) - plain.colors).max() <= 1
    np.testing.assert_array_equal(fine.shape.vertices[:count], mesh.vertices)
    attributes = fine.shape.attributes
    np.testing.assert_allclose(attributes["vertex"]["height"], fine.shape.vertices[:, 2])
    assert (attributes["vertex"]["red"] == 7).all()
    assert attributes["vertex"]["red"].dtype == np.uint8
    assert set(attributes["face"]["part"]) == set(range(len(ball.faces)))
    assert fine.edge_error is None
    assert "to 2 grey levels" in fine.provenance["refined"]


# --- planes and sharp edges -----------------------------------------------------------------------


def grey(values):
    return 255 * linear_to_srgb(values)


def box(size=(4, 3, 1)):
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
             (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
    return Mesh(corners * size, faces)


def inside_of_walls(mesh, size=(4, 3, 1)):
    """Which vertices lie within a wall of the box, not on its edges, and the walls' normals."""
    low, high = mesh.vertices == 0, mesh.vertices == size
    within = (low | high).sum(axis=1) == 1
    return within, high.astype(float) - low


@pytest.mark.parametrize("light", [(-1, 1, 1), (0, 0, 1)])
def test_what_is_new_on_a_plane_is_lit_as_the_plane(light):
    # From straight above, all corners of all walls are lit alike, and so are the edges' middles.
    fine = md.bake(box(), "lambert", light=light, refine=2)
    within, normals = inside_of_walls(fine.shape)
    toward = np.array(light) / np.linalg.norm(light)
    expected = np.clip(normals[within] @ toward, 0, 1)
    assert np.abs(grey(fine.intensity[within]) - grey(expected)).max() < 0.01
    assert is_balanced(fine.shape.faces, len(fine.shape.vertices))
    # What is not lit as a wall is a narrow seam along the edges.
    tones = grey(fine.intensity)[fine.shape.faces]
    even = np.ptp(tones, axis=1) <= 2
    areas = face_areas(fine.shape.vertices, fine.shape.faces)
    assert areas[even].sum() > 0.85 * areas.sum()
    np.testing.assert_allclose(areas.sum(), 2 * (12 + 4 + 3))


@pytest.mark.parametrize("name", [n for n in LOCAL if declaration(METHODS[n]).scales])
def test_smoothed_methods_are_even_in_the_middle_of_a_plane(name):
    fine = md.bake(box(), name, width="1%", scales=3, ratio=2**0.5, refine=60)
    vertices = fine.shape.vertices
    top = vertices[:, 2] == 1
    # Five of the widest widths and more from every edge.
    middle = top & (np.abs(vertices[:, :2] - (2, 1.5)) < (1.4, 0.9)).all(axis=1)
    assert middle.sum() > 20
    assert (255 * np.ptp(fine.intensity[middle], axis=0)).max() < 0.5


@pytest.fixture
def box_apart():
    """A box of triangles that share no vertices."""
    joined = box()
    return Mesh(joined.vertices[joined.faces.ravel()], np.arange(36).reshape(12, 3))


def test_triangles_with_vertices_of_their_own_are_lit_as_planes_from_edge_to_edge(box_apart):
    fine = md.bake(box_apart, "lambert", light=(1, 2, 3), refine=2)
    assert len(fine.shape.faces) == 12
    a, b, c = fine.shape.vertices[fine.shape.faces].swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    exact = np.clip(normals @ (1, 2, 3) / np.sqrt(14), 0, 1)
    np.testing.assert_allclose(
        fine.intensity[fine.shape.faces], np.repeat(exact[:, None], 3, axis=1), atol=1e-6
    )


def test_copies_of_vertices_along_seams_are_split_alike(box_apart):
    fine = md.bake(box_apart, scales=2, width="3%", light=(1, 2, 3), refine=20).shape
    assert len(fine.faces) > 100
    label = np.unique(fine.vertices, axis=0, return_inverse=True)[1].ravel()
    assert is_balanced(label[fine.faces], int(label.max()) + 1)


def test_sums_take_corner_normals_for_what_they_are(ball):
    own = md.scale_space(ball, scales=3)
    same = mesh_space(
        ball, own.widths, own.ratio, facing=1, tolerance=1e-4,
        normals=(ball.normals, ball.normals[ball.faces]),
    )  # fmt: skip
    assert angle_between(same.normals, own.normals).max() < 2e-4


def test_sums_over_a_part_are_integrals_over_its_faces():
    space = md.scale_space(box(), scales=2, width="5%")
    finer, again = with_sampled_planes(FinerMesh(space.shape), space)
    assert len(finer.faces) > 100
    sums = NormalSums(again.shape, 1, 1e-4, corner_normals=finer.pieces.corners).channels.sum(
        axis=1
    )
    mass, first, second = sums[0], sums[1:4], sums[4:]
    np.testing.assert_allclose(first / mass, 0, atol=1e-12)  # of a closed surface
    walls = np.array([3, 4]) / 19  # shares of the surface that face along x and y; the rest, z
    np.testing.assert_allclose(second / mass, [*walls, 0, 0, 0], atol=1e-12)


@pytest.mark.parametrize("name", ["fandisk_13k", "gears_19k"])
def test_parts_come_nearer_to_their_geometry_than_before(data, name):
    part = read_mesh(data / "mesh" / f"{name}.ply")
    view = md.View.fitted("isometric", part, height_px=300)
    light = (0.3, 1, 0.6)
    seen = md.GBuffer.of(part, view, size=(300, 300))
    a, b, c = part.vertices[part.outward_faces].swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    exact = np.clip(normals[seen.triangle] @ np.array(light) / np.linalg.norm(light), 0, 1)
    reference = seen.image(grey(exact))

    def error(baked):
        buffer = md.GBuffer.of(baked.shape, view, size=(300, 300))
        picture = buffer.image(buffer.sample(grey(baked.intensity)))
        both = buffer.mask & seen.mask
        off = np.abs(picture - reference)[both]
        return np.sqrt(np.mean(off**2)), np.mean(off > 8)

    plain = error(md.bake(part, "lambert", light=light))
    fine = error(md.bake(part, "lambert", light=light, refine=2))
    # A fifth of the pixels at the most is left: facets of what is round, and lines of the edges.
    assert fine[0] < plain[0] / 2
    assert fine[1] < plain[1]


def test_refining_is_worth_it_unless_large_triangles_are_no_planes(ball, data):
    assert refinement.worth_refining(ball)
    assert refinement.worth_refining(box())
    for name, worth in (("beetle_2k", False), ("gears_19k", True), ("bunny_69k", True)):
        mesh = read_mesh(data / "mesh" / f"{name}.ply", winding="keep")
        assert refinement.worth_refining(mesh) == worth


# --- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"refine": 0}, "refine=0 is not a number of grey levels"),
        ({"refine": True}, "refine=True"),
        ({"refine": 300}, "refine=300"),
        ({"refine": 2, "method": "accessibility"}, "leave it out with accessibility"),
        ({"refine": 2, "colormap2d": "dusk"}, "leave it out with colormap2d"),
    ],
)
def test_refining_what_cannot_be_is_refused(sphere, options, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        md.bake(sphere, **options)


def test_methods_that_look_around_have_no_edge_error(sphere):
    assert md.bake(sphere, "ambient_occlusion", rays=4).edge_error is None


def test_values_are_not_averaged_between_vertices(space):
    with pytest.raises(MeshdepictError, match="can't be averaged over a mesh"):
        at_vertices(space).mean(np.zeros(3), 1.0)
