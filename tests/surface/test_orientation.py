"""Neighbours agree, closed parts enclose, cavities stay, and nothing else matters."""

import igl
import numpy as np
import plyfile
import pytest
from windings import BALL, CUBE, both, flips, inside_out, moved, opened, scrambled, sheet, turned

from meshdepict.surface.edges import cleaned
from meshdepict.surface.icosahedron import icosphere
from meshdepict.surface.orientation import orient

# --- closed surfaces ------------------------------------------------------------------------


@pytest.mark.parametrize("mesh", [BALL, CUBE])
def test_outward_surfaces_stay_and_inward_ones_are_turned(mesh):
    assert not flips(mesh).any()
    assert flips(inside_out(mesh)).all()
    assert orient(*inside_out(mesh)).message.endswith("the mesh was inside out")


@pytest.mark.parametrize("share", [0.01, 0.3, 0.5, 0.7, 1.0])
def test_scrambled_surfaces_are_restored(share):
    points, faces = BALL
    given, which = scrambled(faces, share)
    np.testing.assert_array_equal(flips((points, given)), which)


def test_cavities_stay_cavities():
    hollow = both(BALL, inside_out(moved(BALL, 0, 0.5)))
    assert not flips(hollow).any()
    assert flips(inside_out(hollow)).all()
    # Also with two faces wrong, one on each wall.
    wrong = np.zeros(len(hollow[1]), bool)
    wrong[[3, len(BALL[1]) + 5]] = True
    np.testing.assert_array_equal(flips((hollow[0], turned(hollow[1], wrong))), wrong)


def test_sign_is_chosen_once_for_all_closed_parts():
    # A small part wound otherwise than the large one is as it is in the file, for better or worse.
    beside = both(BALL, inside_out(moved(BALL, (3, 0, 0), 0.5)))
    assert not flips(beside).any()
    assert flips(inside_out(beside)).all()


@pytest.mark.parametrize("which", [np.arange(12) < 6, np.arange(12) >= 6])
def test_a_tie_between_windings_is_decided_by_the_volume(which):
    # Beside a large ball, so that the cube's own sign is not that of the sum.
    mesh = both(moved(BALL, (9, 0, 0), 2), (CUBE[0], turned(CUBE[1], which)))
    np.testing.assert_array_equal(flips(mesh)[-12:], which)


def test_surfaces_that_enclose_nothing_stay():
    points, faces = sheet(5)
    pillow = points, np.concatenate((faces, faces[:, ::-1]))
    assert not flips(pillow).any()
    assert not flips(inside_out(pillow)).any()


# --- agreement ------------------------------------------------------------------------------


@pytest.mark.parametrize("share", [0.2, 0.8])
def test_sheets_follow_the_majority_of_their_area(share):
    points, faces = sheet(30, lambda x, y: 0.02 * np.sin(9 * x))
    given, which = scrambled(faces, share)
    expected = which if share < 0.5 else ~which
    np.testing.assert_array_equal(flips((points, given)), expected)
    count = f"{expected.sum():,}"
    assert orient(points, given).message == (
        f"winding of {count} faces was turned: {count} disagreed with their neighbours"
    )


def test_majority_is_of_area_not_of_number():
    # One large triangle among four thin ones in a fan, the thin ones against it.
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), *((-0.01 * k, 1, 0) for k in range(1, 5))])
    faces = np.array([(0, 1, 2), (0, 3, 2), (0, 4, 3), (0, 5, 4), (0, 6, 5)])
    np.testing.assert_array_equal(flips((points, faces)), [False, True, True, True, True])


def test_two_faces_that_disagree_agree_afterwards():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], float)
    assert flips((points, np.array([(0, 1, 2), (1, 2, 3)]))).sum() == 1


def test_components_agree_as_libigl_orients_them():
    points, faces = both(BALL, opened(moved(BALL, 0, 0.6), 0.3), moved(CUBE, (4, 0, 0)))
    given, _ = scrambled(faces, 0.4, seed=2)
    theirs, component = igl.bfs_orient(given)
    # Both only swap corners, so a face was turned if its corners are no rotation of the given ones.
    rotations = [np.roll(given, k, axis=1) for k in range(3)]
    turned_by_them = ~np.any([(theirs == r).all(axis=1) for r in rotations], axis=0)
    different = flips((points, given)) != turned_by_them
    assert component.max() + 1 == 3
    for number in range(3):
        one = different[component == number]
        assert one.all() or not one.any()  # the sign is another step


def moebius(across, along=60):
    """A band of across × along cells, closed after half a turn."""
    i, j = np.mgrid[: along + 1, : across + 1]
    angle, side = i * (2 * np.pi / along), 0.8 * (j / across - 0.5)
    radius = 1 + side * np.cos(angle / 2)
    points = np.stack(
        (radius * np.cos(angle), radius * np.sin(angle), side * np.sin(angle / 2)), axis=-1
    )
    number = np.arange(i.size).reshape(i.shape)
    number[-1] = number[0, ::-1]
    a, b, c, d = (
        number[x : x + along, y : y + across].ravel() for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    return points.reshape(-1, 3), np.concatenate((np.stack((a, b, c), 1), np.stack((a, c, d), 1)))


def disagreements(faces):
    sides = np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)])
    _, count = np.unique(sides, axis=0, return_counts=True)
    return (count > 1).sum()


@pytest.mark.parametrize("across", [1, 8])
def test_one_sided_surfaces_keep_a_seam(across):
    points, faces = moebius(across)
    assert disagreements(faces) == across
    assert not flips((points, faces)).any()
    for seed in range(3):
        given, _ = scrambled(faces, seed=seed)
        assert disagreements(given) > 30 * across
        assert disagreements(turned(given, flips((points, given)))) < 2 * across


def test_message_gives_all_reasons():
    wrong = inside_out(BALL)[1].copy()
    wrong[0] = wrong[0, ::-1]
    vessel = moved(inside_out(opened(icosphere(1000), 0.9)), (4, 0, 0))
    found = orient(*both((BALL[0], wrong), vessel, sheet(3)))
    assert found.message == (
        f"winding of {found.flipped.sum():,} faces was turned: 1 disagreed with its neighbours, "
        "closed parts were inside out, 1 open part faced inwards"
    )


# --- what must not matter -------------------------------------------------------------------


@pytest.fixture(scope="module")
def motley():
    """Closed, hollow, open and flat parts, a fifth of the faces turned."""
    points, faces = both(
        BALL,
        inside_out(moved(BALL, 0, 0.5)),
        inside_out(moved(opened(icosphere(900), 0.9), (3, 0, 0))),
        moved(sheet(9), (0, 3, 0)),
    )
    faces, _ = scrambled(faces, 0.2, seed=5)
    return points, faces


def test_numbering_does_not_matter(motley):
    points, faces = motley
    generator = np.random.default_rng(8)
    place, order = generator.permutation(len(points)), generator.permutation(len(faces))
    shuffled = np.empty_like(points)
    shuffled[place] = points
    np.testing.assert_array_equal(flips((shuffled, place[faces][order])), flips(motley)[order])
    np.testing.assert_array_equal(flips((points, np.roll(faces, 1, axis=1))), flips(motley))


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("offset", [0.0, 1e7])  # where float32, as Embree has it, is too coarse
def test_place_size_and_direction_do_not_matter(motley, scale, offset):
    points, faces = motley
    axes = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
    axes *= np.linalg.det(axes)  # a rotation, no mirror
    np.testing.assert_array_equal(flips(((points @ axes + offset) * scale, faces)), flips(motley))


def test_unused_vertices_do_not_matter(motley):
    points, faces = motley
    astray = np.concatenate((points, [(1e9, 0, 0)]))
    np.testing.assert_array_equal(flips((astray, faces)), flips(motley))


def test_turning_twice_is_turning_once(motley):
    points, faces = motley
    assert not flips((points, turned(faces, flips(motley)))).any()


# --- real scans -----------------------------------------------------------------------------


@pytest.fixture
def real(data):
    def load(name):
        ply = plyfile.PlyData.read(data / name)
        points = np.stack([np.asarray(ply["vertex"][axis], np.float64) for axis in "xyz"], axis=1)
        return points, np.vstack(ply["face"]["vertex_indices"]).astype(np.int64)

    return load


@pytest.mark.parametrize(
    "name", ["bunny_69k", "armadillo_86k", "gears_19k", "dragon_203k", "nefertiti_100k"]
)
def test_good_scans_stay_and_reversed_ones_are_turned(real, name):
    mesh = real(f"mesh/{name}.ply")
    assert not flips(mesh).any()
    assert flips(inside_out(mesh)).all()


def test_inside_out_bunny_is_turned(real):
    mesh = real("formats/ply_ascii_inside_out_bunny.ply")
    assert flips(mesh).all()
    assert orient(*mesh).message == "winding of 69,451 faces was turned: 1 open part faced inwards"


def test_scrambled_scans_are_restored(real):
    points, faces = real("mesh/gears_19k.ply")
    given, which = scrambled(faces)
    np.testing.assert_array_equal(flips((points, given)), which)
    points, faces = real("mesh/bunny_69k.ply")
    given, which = scrambled(faces)
    np.testing.assert_array_equal(flips((points, given)), which)


def test_a_broken_scan_is_restored_but_for_loose_ends(real):
    # 2,534 edges of more than two faces separate patches of a few faces, which nothing binds.
    points, faces = real("mesh/dragon_203k.ply")
    given, which = scrambled(faces)
    assert (flips((points, given)) != which).mean() < 0.02
    large = np.bincount(cleaned(points, faces).edges.count)
    assert large[3:].sum() > 1000  # broken it is


def test_a_range_map_stays(real):
    assert not flips(real("formats/ply_camera_element_rangemap.ply")).any()
