"""A mesh by tiles is the mesh at once: numbers, colours, and everything else of its file."""

import numpy as np
import pytest
from conftest import angle_between
from side_pools import Here, rows_of

from meshdepict import samples
from meshdepict.baking.look import Look
from meshdepict.distributed import mesh_tiles, tile_tasks
from meshdepict.distributed.mesh_tiles import bake_by_tiles, check_tiles
from meshdepict.distributed.tiling import SIDE, Extent, cell_of, cut, ranges
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_mesh, write_mesh
from meshdepict.io.ply_ranges import PlyRanges
from meshdepict.scales.making import scale_space
from meshdepict.shapes.mesh import Mesh

TOLERANCE = 1e-3


def here(work):
    from contextlib import nullcontext

    return nullcontext(Here(work))


@pytest.fixture(scope="module")
def scattered(tmp_path_factory):
    """A golf ball whose vertices and faces come in no order: no range is near another."""
    ball = samples.golf_ball(6_000, dimples=72)
    rng = np.random.default_rng(17)
    order, faces = rng.permutation(len(ball.vertices)), rng.permutation(len(ball.faces))
    place = np.argsort(order)
    mesh = Mesh(
        ball.vertices[order].astype(np.float32), place[ball.faces[faces]], winding="keep",
        attributes={"vertex": {"quality": order.astype(np.float32)}},
    )  # fmt: skip
    path = tmp_path_factory.mktemp("tiles") / "ball.ply"
    write_mesh(path, mesh)
    return path, read_mesh(path, winding="keep")


@pytest.mark.parametrize("facing", [0, 1])
def test_normals_are_those_of_the_whole_at_narrow_and_wide_widths(scattered, tmp_path, facing):
    path, mesh = scattered
    look = check_tiles(Look("exaggerated", facing=facing, tolerance=TOLERANCE), 1_000)
    work = mesh_tiles._Work(PlyRanges(path), tmp_path, look, Here(tile_tasks.call), 1_000, None)
    work.prepare()
    provenance = work.settle()
    site, how = work._site, work._how
    assert site.tiles >= 6
    assert how.wide
    exact = scale_space(
        mesh, scales=9, width=float(how.widths[1]), facing=facing, tolerance=1e-6
    ).normals  # fmt: skip
    # The median of edges is found to 2e-5.
    assert how.widths[1] == pytest.approx(mesh.edge_length, rel=3e-5)
    seen = np.zeros(len(mesh.vertices), int)
    for tile in range(site.tiles):
        own = np.array(site.find(f"own-{tile}"))
        seen[own] += 1
        found = np.moveaxis(np.array(site.find(f"planes-{tile}")), 1, 2)
        off = angle_between(found, exact[:, own])
        # Along facing, errors of one scale are the next one's, too.
        assert off.max() < 2 * TOLERANCE
    assert (seen == 1).all()
    assert "doubtful" not in provenance


def test_the_file_is_that_of_the_whole(scattered, tmp_path):
    path, mesh = scattered
    look = Look("exaggerated", tolerance=TOLERANCE, light="east")
    out = tmp_path / "out.ply"
    provenance = bake_by_tiles(path, out, look, here, tile=1_500, marks={"made by": "x"})
    whole = look.bake(mesh)
    found = read_mesh(out, winding="keep")
    np.testing.assert_array_equal(found.vertices, mesh.vertices)
    np.testing.assert_array_equal(found.faces, mesh.faces)
    vertex = found.attributes["vertex"]
    np.testing.assert_array_equal(vertex["quality"], mesh.attributes["vertex"]["quality"])
    colors = np.stack([vertex[name] for name in ("red", "green", "blue")], axis=1)
    # An angle of 1e-3 times an exaggeration of 40 is five of 127 grey levels at the very most, in
    # one band of ten.
    assert np.abs(colors.astype(int) - whole.colors).max() <= 2
    exact = {"method", "light", "view"}
    assert {name: provenance[name] for name in exact} == {
        name: whole.provenance[name] for name in exact
    }
    assert provenance["made by"] == "x"
    assert [*tmp_path.iterdir()] == [out]


def test_other_tiles_and_other_orders_change_no_more_than_rounding(scattered, tmp_path):
    path, _ = scattered
    look = Look("exaggerated", tolerance=TOLERANCE)
    for name, tile in (("one", 100_000), ("many", 1_000)):
        bake_by_tiles(path, tmp_path / f"{name}.ply", look, here, tile=tile)
    colors = [
        read_mesh(tmp_path / f"{name}.ply", winding="keep").attributes["vertex"]["red"].astype(int)
        for name in ("one", "many")
    ]
    assert np.abs(colors[0] - colors[1]).max() <= 2
    bake_by_tiles(path, tmp_path / "again.ply", look, here, tile=1_000)
    assert rows_of(tmp_path / "again.ply") == rows_of(tmp_path / "many.ply")


def test_colours_of_a_former_bake_are_replaced(scattered, tmp_path):
    path, _ = scattered
    once, twice = tmp_path / "once.ply", tmp_path / "twice.ply"
    bake_by_tiles(path, once, Look("lambert"), here, tile=4_000)
    bake_by_tiles(once, twice, Look("lambert"), here, tile=4_000)
    assert twice.read_bytes() == once.read_bytes()


def test_vertices_that_no_face_uses_lie_in_tiles_of_their_own(tmp_path):
    ball = samples.sphere(2_000)
    far = np.concatenate([ball.vertices, [[40.0, 0, 0], [0, 40, 0]]])
    write_mesh(tmp_path / "a.ply", Mesh(far, ball.faces))
    bake_by_tiles(tmp_path / "a.ply", tmp_path / "b.ply", Look("exaggerated"), here, tile=1_000)
    found = read_mesh(tmp_path / "b.ply").attributes["vertex"]["red"]
    whole = Look("exaggerated").bake(read_mesh(tmp_path / "a.ply"))
    assert np.abs(found.astype(int) - whole.colors[:, 0]).max() <= 2


# --- what is refused ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("chosen", "said"),
    [
        ({"ground": "matt"}, "ground looks at the whole mesh"),
        ({"albedo": "keep"}, "albedo looks at"),
        ({"two_sided": True}, "two_sided looks at"),
        ({"method": "ambient_occlusion"}, "more than a vertex"),
        ({"method": "view_curvature"}, "how the surface bends"),
    ],
)
def test_a_look_that_needs_the_whole_is_refused(chosen, said):
    with pytest.raises(MeshdepictError, match=said):
        check_tiles(Look(**chosen), 5_000)


def test_tiles_that_make_no_sense_are_refused(scattered, tmp_path):
    with pytest.raises(MeshdepictError, match="makes no sense"):
        check_tiles(Look(), 10)
    with pytest.raises(MeshdepictError, match=r"written as \.ply"):
        bake_by_tiles(scattered[0], tmp_path / "a.obj", Look(), here)
    with pytest.raises(MeshdepictError, match="can't be written"):
        bake_by_tiles(scattered[0], tmp_path / "no" / "a.ply", Look("lambert"), here)


def test_a_failure_leaves_nothing(scattered, tmp_path):
    def failing(work):
        from contextlib import nullcontext

        def spoil(found):
            return found._replace(error="no more") if found.number == 3 else found

        return nullcontext(Here(work, spoil))

    with pytest.raises(MeshdepictError, match="no more"):
        bake_by_tiles(scattered[0], tmp_path / "a.ply", Look("lambert"), failing, tile=1_500)
    assert not [*tmp_path.iterdir()]


# --- cutting ------------------------------------------------------------------------------------


def test_cells_are_cut_so_that_no_tile_has_more_than_allowed(rng):
    points = rng.normal(size=(20_000, 3)) * (5, 1, 0.2)
    extent = Extent(points.min(axis=0), points.max(axis=0), points)
    cells = cell_of(points, extent)
    table = cut(np.bincount(cells, minlength=SIDE**3), 700)
    number = np.bincount(table[cells])
    assert number.max() <= 700
    assert number.min() > 100
    places = np.stack(np.unravel_index(cells, (SIDE,) * 3), axis=1)
    for tile in range(len(number)):  # a box, in which nothing of another lies
        own = places[table[cells] == tile]
        inside = ((places >= own.min(axis=0)) & (places <= own.max(axis=0))).all(axis=1)
        assert (table[cells[inside]] == tile).all()


def test_a_cell_with_more_than_allowed_is_a_tile():
    count = np.zeros(SIDE**3, np.int64)
    count[5], count[9] = 1_000, 3
    assert len(np.unique(cut(count, 10)[[5, 9]])) == 2


def test_ranges_meet():
    assert [*ranges(5, 2)] == [slice(0, 2), slice(2, 4), slice(4, 5)]
