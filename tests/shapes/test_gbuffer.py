"""What a G-buffer sees of a mesh: exact on spheres, the same as Embree's rays and VTK's depth."""

import math

import numpy as np
import pytest
from scipy.ndimage import binary_dilation, binary_erosion, maximum_filter, minimum_filter

from meshdepict import samples, scale_space
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import VIEWS, View
from meshdepict.shading import lambert
from meshdepict.shapes.fingerprint import fingerprint
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.visibility import projected

SIZE = (120, 90)


def views(mesh, height=SIZE[1]):
    """A parallel view from aslant and a perspective one from near by."""
    parallel = View.fitted("isometric", mesh, aspect=4 / 3, height_px=height)
    near = parallel.focus + 1.2 * mesh.diagonal * np.array([0.36, 0.48, 0.8])
    return [parallel, View(near, parallel.focus, (0.1, 1, 0), height_px=height, field_of_view=50)]


def quad(corners):
    """Two triangles."""
    return Mesh(corners, [[0, 1, 2], [0, 2, 3]], winding="keep")


SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)


# --- exact answers ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def fine_sphere():
    return samples.sphere(40_000)


# A sphere of 40,000 vertices has edges of 0.02: its faces lie up to 0.02²/8·(4/3) inside it.
SAG = 1e-4


@pytest.mark.parametrize("which", [0, 1])
def test_a_sphere_has_its_normals_positions_and_depths(fine_sphere, which):
    view = views(fine_sphere)[which]
    buffer = GBuffer.of(fine_sphere, view, size=SIZE)
    np.testing.assert_allclose(np.linalg.norm(buffer.points, axis=1), 1, atol=SAG)
    np.testing.assert_allclose(buffer.normals, buffer.points, atol=SAG)
    np.testing.assert_allclose(np.linalg.norm(buffer.normals, axis=1), 1, atol=1e-12)
    away = (view.position - buffer.points) @ view.towards_eye
    np.testing.assert_allclose(buffer.depths, away, atol=1e-12)


def test_a_parallel_view_sees_the_disc_of_a_sphere(fine_sphere):
    buffer = GBuffer.of(fine_sphere, "front", size=(200, 200))
    y, x = (np.mgrid[:200, :200] - 99.5) * buffer.edge_length
    distance = np.hypot(x, y)
    assert buffer.mask[distance < 1 - SAG].all()
    assert not buffer.mask[distance > 1].any()
    expected = buffer.view.position[2] - np.sqrt(np.maximum(1 - distance**2, 0))
    # Near the rim the faces' sag is magnified by the slope.
    flat = distance < 0.9
    np.testing.assert_allclose(buffer.depth[flat], expected[flat], atol=SAG / math.sqrt(1 - 0.81))


@pytest.mark.parametrize("which", [0, 1])
def test_positions_are_where_the_barycentric_coordinates_say(ball, which):
    buffer = GBuffer.of(ball, views(ball)[which], size=SIZE)
    corners = ball.vertices[ball.faces[buffer.triangle]]
    place = np.einsum("nk,nka->na", buffer.barycentric, corners)
    np.testing.assert_allclose(buffer.points, place, atol=1e-12)
    assert buffer.barycentric.min() >= 0
    np.testing.assert_allclose(buffer.sample(ball.vertices), place, atol=1e-12)


@pytest.mark.parametrize("which", [0, 1])
def test_projecting_the_positions_gives_the_pixels_back(ball, which):
    buffer = GBuffer.of(ball, views(ball)[which], size=SIZE)
    cloud = Mesh(buffer.points, [[0, 1, 2]], winding="keep")
    corners, _ = projected(cloud, buffer.view, SIZE[0])
    rows, columns = np.nonzero(buffer.mask)
    np.testing.assert_allclose(corners[:, 0] / corners[:, 2], columns, atol=1e-9)
    np.testing.assert_allclose(corners[:, 1] / corners[:, 2], rows, atol=1e-9)


def test_neighbouring_triangles_leave_no_gap():
    # Corners exactly on pixels' centres, where every rounding matters.
    rng = np.random.default_rng(3)
    grid = np.stack(np.meshgrid(np.arange(12.0), np.arange(12.0)), axis=-1).reshape(-1, 2)
    inner = ((grid > 0) & (grid < 11)).all(axis=1)
    grid[inner] += rng.integers(-1, 2, (int(inner.sum()), 2)) / 3
    vertices = np.column_stack([grid * 10, rng.normal(size=len(grid))])
    i = np.arange(11 * 12).reshape(11, 12)[:, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + 13], 1), np.stack([i, i + 13, i + 12], 1)])
    mesh = Mesh(vertices, faces, winding="keep")
    view = View((55, 55, 50), (55, 55, 0), (0, 1, 0), parallel_scale=45, height_px=90)
    assert GBuffer.of(mesh, view).mask.all()
    near = View((55, 55, 50), (55, 55, 0), (0, 1, 0), field_of_view=80, height_px=90)
    assert GBuffer.of(mesh, near).mask.all()


def test_a_plane_that_passes_below_the_eye_is_seen_up_to_the_horizon():
    floor = quad(1e4 * SQUARE[:, [0, 2, 1]])
    view = View((0, 1, 0), (0, 1, -1), (0, 1, 0), field_of_view=90, height_px=100)
    buffer = GBuffer.of(floor, view)
    assert not buffer.mask[:50].any()
    assert buffer.mask[50:].all()
    np.testing.assert_allclose(buffer.depth[99], 1 / 0.99, rtol=1e-9)


def test_inside_a_ball_there_is_surface_all_around(ball):
    for focus in ((1, 0, 0), (0, -1, 0.2), (0.3, 0.3, -1)):
        eye = View((0.2, 0.1, 0), focus, (0, 0.1, 1), field_of_view=120, height_px=60)
        buffer = GBuffer.of(ball, eye, size=(80, 60))
        assert buffer.mask.all()
        distance = np.linalg.norm(buffer.points, axis=1)
        assert distance.min() > 0.8
        assert distance.max() < 1.1


def test_what_is_behind_the_eye_is_not_seen(ball):
    inside = View((0, 0, 0), (0, 0, -1), (0, 1, 0), parallel_scale=1.2, height_px=60)
    assert (GBuffer.of(ball, inside).points[:, 2] < 0).all()


def test_the_nearer_of_two_surfaces_is_seen():
    far = SQUARE * 2 - [0, 0, 1]
    mesh = Mesh(np.vstack([far, SQUARE]), [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    buffer = GBuffer.of(mesh, "front", size=(50, 50))
    near = np.abs(buffer.points[:, :2]).max(axis=1) < 1
    np.testing.assert_allclose(buffer.points[near, 2], 0, atol=1e-12)
    np.testing.assert_allclose(buffer.points[~near, 2], -1, atol=1e-12)


@pytest.mark.parametrize("name", VIEWS)
def test_a_named_view_shows_all_of_the_shape(ball, name):
    mask = GBuffer.of(ball, name, size=SIZE).mask
    border = np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])
    assert not border.any()
    assert mask.any(axis=1).sum() >= 0.93 * SIZE[1]


def test_the_height_shown_is_the_views_whatever_the_pixels(ball):
    view = View.fitted("front", ball, height_px=300)
    small, large = (GBuffer.of(ball, view, size=(n, n)) for n in (60, 120))
    assert small.view.height_px == 60
    assert small.edge_length == pytest.approx(2 * large.edge_length)
    assert GBuffer.of(ball, view).size == (300, 300)
    assert GBuffer.of(ball).size == (1000, 1000)


# --- other machinery as the judge -------------------------------------------------------------


@pytest.fixture(params=["ball", "bunny"])
def seen(request):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize("which", [0, 1])
def test_embree_meets_the_same_triangles(seen, which):
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    buffer = GBuffer.of(seen, views(seen)[which], size=SIZE)
    scene = EmbreeScene()
    TriangleMesh(scene, seen.unit_points.astype(np.float32), seen.faces.astype(np.int32))
    to_eye = -buffer.view.towards_eye
    if buffer.view.parallel_scale is None:
        to_eye = buffer.points - buffer.view.position
        to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
    directions = np.broadcast_to(to_eye, buffer.points.shape).astype(np.float32)
    origins = (seen.recentred(buffer.points) - 1.5 * to_eye).astype(np.float32)
    hit = scene.run(origins, directions, query="INTERSECT", output=True)
    # Single precision takes the neighbour at some edges, and misses at some silhouettes.
    assert (hit["primID"] == buffer.triangle).mean() > 0.99
    met = np.abs(hit["tfar"] - 1.5) < 1e-5
    assert met.mean() > 0.998


def vtk_depth(mesh, view, size):
    """Distances from the eye along its axis, NaN where nothing is, by VTK's rasteriser."""
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=list(size))
    plotter.render_window.SetMultiSamples(0)  # depth at the centres of pixels
    poly = pv.PolyData.from_regular_faces(mesh.unit_points, mesh.faces)
    plotter.add_mesh(poly, lighting=False)
    camera = plotter.camera
    camera.position = tuple(mesh.recentred(view.position))
    camera.focal_point = tuple(mesh.recentred(view.focus))
    camera.up = tuple(view.up)
    camera.parallel_projection = view.parallel_scale is not None
    if view.parallel_scale is None:
        camera.view_angle = view.field_of_view
    else:
        camera.parallel_scale = view.parallel_scale / mesh.diagonal
    plotter.reset_camera_clipping_range()
    plotter.show(auto_close=False)
    depth = -np.asarray(plotter.get_image_depth(), float) * mesh.diagonal
    plotter.close()
    return depth


@pytest.mark.parametrize("which", [0, 1])
def test_vtk_sees_the_same_silhouette_and_depth(seen, which):
    size = (320, 240)
    view = views(seen, 240)[which]
    buffer = GBuffer.of(seen, view, size=size)
    vtk = vtk_depth(seen, view, size)
    there = np.isfinite(vtk)
    square = np.ones((3, 3), bool)
    assert not (there & ~binary_dilation(buffer.mask, square)).any()
    assert not (binary_erosion(buffer.mask, square) & ~there).any()
    # At an inner silhouette VTK may show what the pixel beside shows here.
    off = 1e-4 * seen.diagonal
    ours = np.where(buffer.mask, buffer.depth, np.inf)
    low, high = minimum_filter(ours, 3) - off, maximum_filter(ours, 3) + off
    both = there & buffer.mask
    assert ((vtk >= low) & (vtk <= high))[both].all()
    assert (np.abs(vtk - buffer.depth) <= off)[both].mean() > 0.999


# --- values on pixels -------------------------------------------------------------------------


def test_baked_and_per_pixel_shading_agree(fine_sphere):
    light = (1, 2, 3)
    buffer = GBuffer.of(fine_sphere, "front", size=(200, 200))
    baked = buffer.sample(lambert(scale_space(fine_sphere, scales=0), light))
    direct = np.maximum(buffer.normals @ np.array(light) / math.sqrt(14), 0)
    # Linear over an edge of 0.02 but at the terminator, where both have a kink.
    np.testing.assert_allclose(baked, direct, atol=0.02)
    lit = direct > 0.05
    np.testing.assert_allclose(baked[lit], direct[lit], atol=SAG)


def test_an_image_has_the_values_where_the_mask_is(ball, rng):
    buffer = GBuffer.of(ball, "front", size=SIZE)
    values = rng.random((len(buffer.normals), 3))
    picture = buffer.image(values, background=(1, 0.5, 0))
    assert picture.shape == (SIZE[1], SIZE[0], 3)
    np.testing.assert_array_equal(picture[buffer.mask], values)
    assert (picture[~buffer.mask] == (1, 0.5, 0)).all()
    assert buffer.image(values[:, 0]).shape == (SIZE[1], SIZE[0])
    np.testing.assert_array_equal(buffer.uncropped(buffer.cropped(values.T)), values.T)


def test_it_is_a_shape_like_others(ball):
    buffer = GBuffer.of(ball, "front", size=SIZE)
    assert buffer.kind == "image"
    assert buffer.identity.startswith(f"120 x 90 pixels {len(buffer.normals)} samples sha256 ")
    assert buffer.identity.endswith(fingerprint(buffer.mask, buffer.normals, buffer.depths))
    assert buffer.diagonal == ball.diagonal
    np.testing.assert_array_equal(buffer.centre, ball.centre)
    assert buffer.outline.shape == (len(buffer.normals), 3)
    assert buffer.edge_length == pytest.approx(2 * buffer.view.parallel_scale / 90)
    assert repr(buffer) == f"<GBuffer: 120 x 90 pixels, {len(buffer.normals):,} samples>"


@pytest.mark.parametrize("factor", [1e-140, 1e140])
def test_units_do_not_matter(ball, factor):
    plain = GBuffer.of(ball, "front", size=SIZE)
    scaled = GBuffer.of(Mesh(ball.vertices * factor, ball.faces), "front", size=SIZE)
    assert (plain.mask != scaled.mask).mean() < 1e-3  # at silhouettes roundings decide
    both = plain.mask & scaled.mask
    np.testing.assert_allclose(scaled.depth[both] / factor, plain.depth[both], rtol=1e-9)


def test_normals_that_face_away_stay_finite_unit_vectors():
    # Seen from behind, and with corner normals that cancel.
    behind = GBuffer.of(quad(SQUARE[::-1]), "front", size=(20, 20))
    np.testing.assert_allclose(behind.normals @ behind.view.towards_eye, -1)
    two = Mesh(np.vstack([SQUARE[:3], SQUARE[:3]]), [[0, 1, 2], [5, 4, 3]], winding="keep")
    both = GBuffer.of(two, "front", size=(20, 20))
    np.testing.assert_allclose(np.linalg.norm(both.normals, axis=1), 1)


def test_normals_of_corners_that_cancel_are_those_of_the_nearest():
    strip = Mesh([[0, 0, 0], [2, 0, 0], [1, 1, 0]], [[0, 1, 2]], winding="keep")
    opposite = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 0, 0]])
    strip.__dict__["normals"] = opposite  # as a cached property would
    view = View((1, 0, 5), (1, 0, 0), (0, 1, 0), parallel_scale=0.5, height_px=1)
    buffer = GBuffer.of(strip, view, size=(1, 1))
    np.testing.assert_allclose(np.abs(buffer.normals), [[1, 0, 0]])


# --- wrong input ------------------------------------------------------------------------------


def test_a_view_that_shows_nothing_is_refused(ball):
    aside = View((9, 9, 5), (9, 9, 0), (0, 1, 0), parallel_scale=1, height_px=20, name="aside")
    with pytest.raises(MeshdepictError, match=r"the view aside from .* shows nothing of the shape"):
        GBuffer.of(ball, aside)


@pytest.mark.parametrize("size", [(0, 10), (10, 20_000), (10,), (2.5, 3), 100])
def test_a_size_out_of_range_is_refused(ball, size):
    with pytest.raises(MeshdepictError, match="is not a width and a height from 1 to 16,384"):
        GBuffer.of(ball, "front", size=size)


def test_only_meshes_are_looked_at():
    with pytest.raises(MeshdepictError, match="a ndarray can't be looked at: give a Mesh"):
        GBuffer.of(np.zeros(3))


def test_values_of_another_number_are_refused(ball):
    buffer = GBuffer.of(ball, "front", size=(20, 20))
    with pytest.raises(MeshdepictError, match=r"shape \(3,\) are not one for each of .* samples"):
        buffer.image(np.zeros(3))
    with pytest.raises(MeshdepictError, match=r"shape \(3,\) are not one for each of .* vertices"):
        buffer.sample(np.zeros(3))


FRONT = View((0, 0, 1), (0, 0, 0), (0, 1, 0), parallel_scale=1)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ((np.ones(3), np.zeros((3, 3)), np.zeros(3)), r"a mask has rows and columns"),
        ((np.zeros((2, 2)), np.zeros((0, 3)), np.zeros(0)), "the mask is empty"),
        ((np.ones((2, 2)), np.zeros((3, 3)), np.zeros(4)), r"normals have the shape \(3, 3\)"),
        ((np.ones((2, 2)), np.ones((4, 3)), np.zeros(3)), r"depths have the shape \(3,\)"),
        ((np.ones((1, 2)), [[0, 0, 2], [0, 0, 1]], [1, 1]), "normals of 1 pixels are not of unit"),
        ((np.ones((1, 1)), [[0, 0, 1]], [math.inf]), "depths of 1 pixels are not finite"),
    ],
)
def test_wrong_arrays_are_refused(arrays, words):
    with pytest.raises(MeshdepictError, match=words):
        GBuffer(FRONT, *arrays)


def test_depths_behind_a_perspective_eye_are_refused():
    view = View((0, 0, 1), (0, 0, 0), (0, 1, 0), field_of_view=30)
    with pytest.raises(MeshdepictError, match=r"1 depths are not positive, so behind the eye"):
        GBuffer(view, np.ones((1, 2)), [[0, 0, 1], [0, 0, 1]], [1, 0])
