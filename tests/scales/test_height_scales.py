"""The scale space of a height field: planes, hills, gaps, offsets, and the mesh of its ground."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import HeightField

NORMAL = np.array([-0.3, 0.2, 1]) / np.linalg.norm([-0.3, 0.2, 1])


def plane(valid=None, *, rows=40, columns=60, transform=None):
    field = HeightField(np.zeros((rows, columns)), transform=transform)
    z = field.image(0.3 * field.points[:, 0] - 0.2 * field.points[:, 1])
    return HeightField(z, transform=transform, valid=valid)


def hill(rows=81, columns=101, width=12.0, height=5.0):
    y, x = np.mgrid[:rows, :columns] - np.array([rows // 2, columns // 2])[:, None, None]
    return HeightField(height * np.exp(-(x**2 + y**2) / (2 * width**2)))


@pytest.mark.parametrize("turn", [0, 30, 180])
def test_a_plane_has_one_normal_at_every_scale_up_to_its_border(turn):
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    space = md.scale_space(plane(transform=(2 * c, 2 * s, 5, 2 * s, -2 * c, 7)), scales=7)
    assert np.abs(space.normals - NORMAL).max() < 1e-6


def test_nothing_bleeds_from_where_nothing_is_known():
    valid = np.random.default_rng(0).random((40, 60)) > 0.2
    valid[10:20, 5:30] = False
    space = md.scale_space(plane(valid), scales=7)
    assert np.abs(space.normals[1:] - NORMAL).max() < 2e-6


def test_a_cell_alone_is_level():
    valid = np.zeros((40, 60), bool)
    valid[3, 3] = True
    space = md.scale_space(plane(valid), scales=3)
    assert space.normals.reshape(-1, 3).tolist() == [[0, 0, 1]] * 4


def test_a_gap_changes_nothing_beyond_the_gaussian():
    field = hill()
    valid = np.ones_like(field.valid)
    valid[:3, :3] = False
    torn = HeightField(field.z, valid=valid)
    whole, part = (md.scale_space(f, scales=3) for f in (field, torn))
    far = np.zeros_like(valid)
    far[40:, 40:] = True
    assert np.array_equal(part.normals[:, torn.sample(far)], whole.normals[:, field.sample(far)])


def test_a_smoothed_hill_is_a_wider_and_lower_one():
    field = hill()
    space = md.scale_space(field, scales=4, width=4.0)
    for scale, width in enumerate(space.widths):
        if scale in (1, 2):
            spread = 12.0**2 + width**2
            x, y, _ = (field.points - field.points[field.count // 2]).T
            height = 5 * 12.0**2 / spread * np.exp(-(x**2 + y**2) / (2 * spread))
            exact = np.stack([height * x / spread, height * y / spread, np.ones_like(x)], axis=1)
            exact /= np.linalg.norm(exact, axis=1, keepdims=True)
            middle = field.sample(np.pad(np.ones((31, 51), bool), 25))
            assert np.abs(space.normals[scale][middle] - exact[middle]).max() < 1e-3


def test_curvature_is_that_of_a_sphere():
    y, x = np.mgrid[-30:31, -30:31] * 0.5
    space = md.scale_space(
        HeightField(np.sqrt(60.0**2 - x**2 - y**2), transform=(0.5, 0, 0, 0, -0.5, 0)), scales=0
    )
    found = space.curvature(0)
    inner = space.shape.sample(np.pad(np.ones((51, 51), bool), 5))
    np.testing.assert_allclose(found.k1[inner], 1 / 60, rtol=1e-3)
    np.testing.assert_allclose(found.k2[inner], 1 / 60, rtol=1e-3)


@pytest.mark.parametrize("turn", [0, 40])
def test_curvature_of_a_ridge_runs_across_it(turn):
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    transform = (0.5 * c, 0.5 * s, 0, 0.5 * s, -0.5 * c, 0)
    flat = HeightField(np.zeros((50, 60)), transform=transform)
    x = flat.points[:, 0] - flat.points[:, 0].mean()
    field = HeightField(flat.image(-0.5 * 0.02 * x**2), transform=transform)
    found = md.scale_space(field, scales=0).curvature(0)
    middle = np.abs(x) < 2
    inner = field.sample(np.pad(np.ones((46, 56), bool), 2)) & middle
    np.testing.assert_allclose(found.k1[inner], 0.02, rtol=0.02)
    np.testing.assert_allclose(found.k2[inner], 0, atol=1e-4)
    assert np.abs(found.d1[inner][:, 0]).min() > 0.99


def test_heights_far_up_and_maps_far_away_give_the_same_normals():
    near = hill()
    far = HeightField(near.z + 2.0**20, transform=(1, 0, 5e5, 0, -1, 5e6))
    a, b = (md.scale_space(field, scales=5).normals for field in (near, far))
    assert np.abs(a - b).max() < 1e-6


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_units_change_nothing(unit):
    near = hill()
    other = HeightField(near.z * unit, transform=(unit, 0, 0, 0, -unit, 0))
    a, b = (md.scale_space(field, scales=5).normals for field in (near, other))
    assert np.abs(a - b).max() < 1e-6


@pytest.mark.parametrize("height", [1e-30, 1e30])
def test_heights_at_the_extremes_have_finite_normals(height):
    field = HeightField(np.random.default_rng(0).normal(size=(20, 20)) * height)
    space = md.scale_space(field, scales=3)
    assert np.allclose(np.linalg.norm(space.normals, axis=2), 1, atol=1e-5)
    assert np.isfinite(space.curvature(1).k1).all()


def test_the_mesh_of_the_ground_has_nearly_the_normals_of_the_field():
    field = hill()
    mesh = field.mesh
    inner = field.sample(np.pad(np.ones((77, 97), bool), 2))
    assert np.abs(mesh.normals - md.scale_space(field, scales=0).normals[0])[inner].max() < 5e-3


def test_means_leave_out_what_has_no_height():
    valid = np.random.default_rng(0).random((40, 60)) > 0.3
    space = md.scale_space(plane(valid), scales=1)
    assert np.allclose(space.mean(np.full(valid.sum(), 3.0), 4.0), 3.0)
    noise = np.random.default_rng(1).normal(size=valid.sum())
    assert space.mean(noise, 6.0).std() < 0.2 * noise.std()


def test_it_can_be_sent_to_another_process():
    import pickle

    space = md.scale_space(hill(), scales=2)
    again = pickle.loads(pickle.dumps(space))
    assert np.array_equal(again.normals, space.normals)


@pytest.mark.parametrize("name", sorted(md.shading.METHODS))
def test_every_method_shades_terrain_with_gaps(name):
    valid = np.random.default_rng(0).random((24, 30)) > 0.1
    field = HeightField(hill(24, 30).z, valid=valid)
    values = md.bake(field, name).intensity
    assert len(values) == field.count
    assert np.isfinite(values).all()
    assert values.min() >= 0
    assert values.max() <= 1


@pytest.mark.parametrize("name", sorted(md.shading.METHODS))
def test_any_number_of_threads_gives_the_same_bits(name):
    from meshdepict import threads

    y, x = np.mgrid[:150, :170]
    field = HeightField(np.sin(x / 5.0) * np.cos(y / 9.0) + 0.01 * ((x * 7 + y * 13) % 11))
    found = []
    try:
        for count in (1, 3):
            threads.limit(count)
            found.append(md.bake(field, name).intensity)
    finally:
        threads.limit(None)
    assert np.array_equal(*found)


@pytest.mark.parametrize("name", ["lambert", "half_lambert", "radiance_scaling", "mean_curvature"])
def test_a_mesh_of_smooth_ground_gives_the_same_picture(name):
    y, x = np.mgrid[:120, :140]
    field = HeightField(20 * np.sin(x / 30) * np.cos(y / 25))
    flat = md.bake(field, name, light="northwest")
    mesh = md.bake(field.mesh, name, light=flat.look.light, view=flat.view)
    inner = field.sample(np.pad(np.ones((110, 130), bool), 5))
    assert np.abs(flat.colors.astype(int) - mesh.colors.astype(int))[inner].max() <= 2
