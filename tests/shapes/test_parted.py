"""Vertices parted at sharp edges: one normal for a plane, smooth sides stay smooth."""

import numpy as np
import pytest
from parts import (
    angle_profile,
    bevelled_box,
    box,
    cylinder,
    extruded,
    plane_normals,
    running_out,
)

import meshdepict as md
from meshdepict.curvature.principal import principal_curvatures
from meshdepict.shapes.parted import parted_at_creases
from meshdepict.surface.creases import Fans, parted_corners
from meshdepict.surface.welding import same_position


def per_corner(mesh):
    return mesh.normals[mesh.outward_faces]


@pytest.mark.parametrize(("make", "count"), [(box, 8), (angle_profile, 12), (bevelled_box, 16)])
def test_every_plane_of_a_part_gets_its_own_normal(make, count):
    mesh = make()
    assert len(mesh.vertices) == count
    parted = parted_at_creases(mesh, 40)
    assert len(parted.vertices) == 3 * count  # three planes meet at each
    assert parted.added == 2 * count
    np.testing.assert_allclose(
        per_corner(parted), np.repeat(plane_normals(mesh)[:, None], 3, axis=1), atol=1e-12
    )


def test_bends_below_the_angle_stay_smooth():
    mesh = bevelled_box()
    parted = parted_at_creases(mesh, 50)  # its bevels bend by 45°: the caps alone part
    assert parted.added == len(mesh.vertices)
    upright = np.abs(parted.normals[:, 2]) < 0.5
    np.testing.assert_allclose(parted.normals[upright][:, 2], 0, atol=1e-12)
    np.testing.assert_allclose(np.abs(parted.normals[~upright][:, 2]), 1, atol=1e-12)
    assert parted_at_creases(mesh, 100).added == 0


def test_a_cylinders_side_stays_smooth_and_its_caps_part():
    mesh = cylinder()
    parted = parted_at_creases(mesh, 40)
    assert parted.added == len(mesh.vertices)  # one for the cap, one for the side
    radial = mesh.vertices * (1, 1, 0)
    cap = np.abs(parted.normals[:, 2]) > 0.5
    assert cap.sum() == len(mesh.vertices)
    np.testing.assert_allclose(np.abs(parted.normals[cap][:, 2]), 1, atol=1e-12)
    # Quads are split one way: normals lean by less than half a facet.
    cosine = (parted.normals[~cap] * radial[parted.source[~cap]]).sum(axis=1)
    assert cosine.min() > np.cos(np.pi / 48)
    np.testing.assert_allclose(parted.normals[~cap][:, 2], 0, atol=1e-12)


def test_a_crease_that_runs_out_leaves_its_end_in_one():
    mesh = running_out()
    parted = parted_at_creases(mesh, 40)
    x, y, _ = mesh.vertices[parted.source[len(mesh.vertices) :]].T
    assert parted.added
    np.testing.assert_array_equal(x, 0)
    assert y.min() > 0
    before = np.flatnonzero((mesh.vertices[:, 0] == 0) & (mesh.vertices[:, 1] == 0))
    assert not np.isin(parted.source[len(mesh.vertices) :], before).any()


def test_the_surface_stays_what_it_is():
    mesh = angle_profile()
    parted = parted_at_creases(mesh, 40)
    np.testing.assert_array_equal(parted.vertices[: len(mesh.vertices)], mesh.vertices)
    np.testing.assert_array_equal(parted.vertices, mesh.vertices[parted.source])
    np.testing.assert_array_equal(parted.vertices[parted.faces], mesh.vertices[mesh.faces])
    np.testing.assert_array_equal(parted.source[parted.polygons.connectivity],
                                  mesh.polygons.connectivity)  # fmt: skip
    np.testing.assert_array_equal(parted.polygons.offsets, mesh.polygons.offsets)
    assert parted.areas.sum() == pytest.approx(mesh.areas.sum(), rel=1e-12)
    np.testing.assert_allclose(np.bincount(parted.source, parted.areas), mesh.areas, rtol=1e-12)


def test_parted_vertices_do_not_join_again_by_position():
    parted = parted_at_creases(box(), 40)
    assert same_position(parted.vertices) is not None
    assert len(np.unique(parted.groups)) == 24
    curvature = principal_curvatures(parted)
    np.testing.assert_allclose(curvature.k1, 0, atol=1e-9)  # a plane's


def test_a_seam_that_a_crease_does_not_run_along_stays_closed():
    # A cylinder whose side is stored with a seam, as texture coordinates make it.
    mesh = cylinder()
    faces = [list(f) for f in np.split(mesh.polygons.connectivity, mesh.polygons.offsets[1:-1])]
    n = len(mesh.vertices)
    half = n // 2
    faces[-1] = [v if v not in (0, half) else n + (v == half) for v in faces[-1]]
    sewn = md.Mesh(np.concatenate([mesh.vertices, mesh.vertices[[0, half]]]), faces)
    one, two = (parted_at_creases(each, 40) for each in (mesh, sewn))
    np.testing.assert_allclose(per_corner(two), per_corner(one), atol=1e-12)


def test_colours_texture_coordinates_and_what_else_there_is_go_along(tmp_path):
    mesh = box()
    n, faces = len(mesh.vertices), len(mesh.polygons.offsets) - 1
    red = np.arange(n, dtype=np.uint8) * 20
    attributes = {
        "vertex": {"red": red, "green": red, "blue": red, "quality": np.arange(n, dtype=float),
                   "pairs": np.arange(2 * n).reshape(n, 2)},
        "face": {"part": np.arange(faces, dtype=np.int32)},
    }  # fmt: skip
    mesh = md.Mesh(mesh.vertices, mesh.polygons, attributes=attributes, length_unit="mm")
    parted = parted_at_creases(mesh, 40)
    for name, values in attributes["vertex"].items():
        np.testing.assert_array_equal(parted.attributes["vertex"][name], values[parted.source])
    np.testing.assert_array_equal(parted.attributes["face"]["part"], attributes["face"]["part"])
    assert parted.length_unit == "mm"
    corners = np.diff(mesh.polygons.offsets)
    texture = "".join(f"vt {k / 100} {1 - k / 100}\n" for k in range(corners.sum()))
    rows, at = [], 1
    for polygon in np.split(mesh.polygons.connectivity, mesh.polygons.offsets[1:-1]):
        rows.append("f " + " ".join(f"{v + 1}/{at + k}" for k, v in enumerate(polygon)))
        at += len(polygon)
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in mesh.vertices)
    (tmp_path / "box.obj").write_text(points + texture + "\n".join(rows) + "\n")
    textured = parted_at_creases(md.read_mesh(tmp_path / "box.obj"), 40)
    coordinates, corner = textured.document.texcoords
    np.testing.assert_allclose(coordinates[corner][:, 0], np.arange(corners.sum()) / 100)
    md.io.write_mesh(tmp_path / "box.ply", textured)
    again = md.read_mesh(tmp_path / "box.ply")
    assert len(again.vertices) == 24
    coordinates, corner = again.document.texcoords
    np.testing.assert_allclose(coordinates[corner][:, 0], np.arange(corners.sum()) / 100)


def test_a_mesh_without_sharp_edges_keeps_its_file(tmp_path):
    ball = md.samples.sphere(200)
    md.io.write_mesh(tmp_path / "ball.ply", ball)
    mesh = md.read_mesh(tmp_path / "ball.ply")
    parted = parted_at_creases(mesh, 40)
    assert parted.added == 0
    assert parted.document is mesh.document
    assert parted.patches is None
    np.testing.assert_allclose(parted.normals, mesh.normals, atol=1e-15)


@pytest.mark.parametrize("winding", ["auto", "keep"])
def test_winding_goes_along(winding):
    points, faces = extruded([(0, 0), (3, 0), (3, 2), (0, 2)])
    faces[2] = faces[2][::-1]
    mesh = md.Mesh(points, faces, winding=winding)
    if winding == "auto":
        with pytest.warns(md.errors.MeshdepictWarning, match="winding of"):
            parted = parted_at_creases(mesh, 40)
        assert parted.orientation.flipped.sum() == 2
    else:
        parted = parted_at_creases(mesh, 40)
    np.testing.assert_array_equal(parted.orientation.flipped, mesh.orientation.flipped)
    outward = parted.normals[parted.outward_faces]
    np.testing.assert_allclose(outward[:, 0], plane_normals(mesh), atol=1e-12)


def test_slivers_go_with_the_plane_beyond_their_longest_side():
    # A point on the edge of a box's top, that the top has and the side has not: the two
    # triangles that close the gap have no normal of their own.
    points = np.array([[0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 1, 0], [1, 0, -1]], float)
    mesh = md.Mesh(points, [[0, 2, 3], [2, 1, 3], [0, 1, 2], [1, 0, 4]], winding="keep")
    parted = parted_at_creases(mesh, 40)
    top = parted.normals[parted.faces[:2]]
    np.testing.assert_allclose(top, np.broadcast_to((0, 0, 1), top.shape), atol=1e-12)
    side = parted.normals[parted.faces[3]]
    np.testing.assert_allclose(side, np.broadcast_to((0, -1, 0), side.shape), atol=1e-12)


def test_corners_that_no_crease_ends_at_keep_their_vertices():
    faces = np.array([[0, 1, 2], [2, 1, 3]])
    fans = Fans(np.arange(6).reshape(2, 3), np.zeros((2, 3), bool))
    parts = parted_corners(faces, fans, np.arange(4))
    np.testing.assert_array_equal(parts.corners, faces)
    np.testing.assert_array_equal(parts.source, np.arange(4))


@pytest.mark.parametrize("creases", [0, 180, -40, np.nan, "sharp", True, None, [40]])
def test_what_is_no_angle(creases):
    with pytest.raises(md.MeshdepictError, match="is not an angle in degrees between 0 and 180"):
        parted_at_creases(box(), creases)


def test_a_turned_part_is_parted_alike():
    mesh = angle_profile()
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])
    turned = md.Mesh(mesh.vertices @ turn.T + (1e5, 0, 0), mesh.polygons)
    one, two = (parted_at_creases(each, 40) for each in (mesh, turned))
    np.testing.assert_array_equal(one.polygons.connectivity, two.polygons.connectivity)
    np.testing.assert_allclose(one.normals @ turn.T, two.normals, atol=1e-9)


def test_fandisk(data):
    mesh = md.read_mesh(data / "mesh" / "fandisk_13k.ply")
    parted = parted_at_creases(mesh, 40)
    assert 500 < parted.added < 1000
    # Its back is a plane: all of it has one normal.
    back = (mesh.vertices[mesh.faces][:, :, 2] > -1e-9).all(axis=1)
    assert back.sum() > 100
    np.testing.assert_allclose(np.abs(parted.normals[parted.faces[back]][..., 2]), 1, atol=1e-9)
    assert np.abs(mesh.normals[mesh.faces[back]][..., 2]).min() < 0.8


def test_vertices_share_what_they_are_told_to():
    points, faces = extruded([(0, 0), (1, 0), (1, 1), (0, 1)])
    doubled = md.Mesh(np.concatenate([points, points]), [*faces, [8, 9, 10, 11]], winding="keep")
    alone = md.Mesh(doubled.vertices, doubled.polygons, winding="keep", groups=range(16))
    assert len(np.unique(doubled.groups)) < 16
    np.testing.assert_array_equal(alone.groups, np.arange(16))
    np.testing.assert_allclose(alone.normals[8:12], np.broadcast_to((0, 0, 1), (4, 3)), atol=1e-12)


@pytest.mark.parametrize(
    "groups", [[0, 1], [0.0] * 8, range(1, 9), [-1] * 8, [[0] * 8], [0] * 7 + [2], [[0], [0, 1]]]
)
def test_what_are_no_groups(groups):
    with pytest.raises(md.MeshdepictError, match="groups must be 8 whole numbers from 0 without"):
        md.Mesh(box().vertices, box().polygons, groups=groups)


@pytest.mark.filterwarnings("ignore:.*vertices were added", "ignore:.*are there twice")
@pytest.mark.parametrize(
    "faces",
    [[[0, 1, 2]], [[0, 1, 2], [2, 1, 0]], [[0, 0, 0], [0, 1, 2]], [[0, 1, 1, 2], [0, 2, 3]],
     [[0, 1], [0, 1, 2], [0, 1, 3]], [[0, 1, 2], [0, 1, 3], [1, 0, 4]]],
)  # fmt: skip
def test_what_is_odd_gets_unit_normals_and_keeps_its_corners(faces):
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 1], [0, -1, 0]]
    mesh = md.Mesh(points, faces, winding="keep")
    parted = parted_at_creases(mesh, 40)
    np.testing.assert_array_equal(parted.vertices[parted.faces], mesh.vertices[mesh.faces])
    np.testing.assert_allclose(np.linalg.norm(parted.normals, axis=1), 1, atol=1e-12)
    baked = md.bake(mesh, "exaggerated", scales=2, creases=40)
    assert np.isfinite(baked.intensity).all()
