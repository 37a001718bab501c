"""Sums that stay between creases: what lies beyond a sharp edge isn't averaged."""

import numpy as np
import pytest
from parts import bevelled_box, box, cylinder, plane_normals, running_out

import meshdepict as md
from meshdepict.scales.patches import PatchSums
from meshdepict.shapes.parted import parted_at_creases
from meshdepict.sums.gaussian import gaussian_sums

RNG = np.random.default_rng(5)


def scattered(sizes):
    count = sum(sizes)
    points = RNG.normal(size=(count, 3))
    channels = RNG.uniform(0.1, 1, size=(3, count))
    channels[1:] *= channels[0]  # the first is the mass
    patches = RNG.permutation(np.repeat(np.arange(len(sizes)), sizes))
    return patches, points, channels


@pytest.mark.parametrize("width", [0.05, 0.5, 5.0])
def test_each_patch_is_summed_as_if_it_were_alone(width):
    patches, points, channels = scattered([1, 5, 5, 64, 65, 300])
    found = PatchSums(patches, points, channels).at(width, error=1e-7)
    for patch in range(6):
        own = patches == patch
        squared = ((points[own][:, None] - points[own]) ** 2).sum(axis=-1)
        exact = channels[:, own] @ np.exp(-squared / (2 * width**2))
        assert (np.abs(found[:, own] - exact) <= 1e-7 * exact[0]).all()


def test_one_patch_is_all():
    _, points, channels = scattered([300])
    np.testing.assert_array_equal(
        PatchSums(None, points, channels).at(0.3, error=1e-6),
        gaussian_sums(points, channels, 0.3, error=1e-6),
    )


def test_only_targets_are_summed():
    patches, points, channels = scattered([5, 5, 100, 100])
    targets = (patches == 0) | ((patches == 2) & (points[:, 0] > 0))
    done = []
    found = PatchSums(patches, points, channels).at(
        0.5, error=1e-7, targets=targets, heaviest=1.0, done=done.append
    )
    whole = PatchSums(patches, points, channels).at(0.5, error=1e-9)
    assert not found[:, ~targets].any()
    assert (np.abs(found - whole)[:, targets] <= 1.1e-7 * whole[0, targets]).all()
    assert sum(done) == 1


@pytest.mark.parametrize("make", [box, bevelled_box])
@pytest.mark.parametrize("facing", [0, 1])
def test_a_plane_keeps_its_normal_at_every_width(make, facing):
    mesh = parted_at_creases(make(), 40)
    space = md.scale_space(mesh, scales=6, facing=facing)
    for normals in space.normals:
        corners = normals[mesh.outward_faces]
        plane = np.broadcast_to(plane_normals(mesh)[:, None], corners.shape)
        np.testing.assert_allclose(corners, plane, atol=1e-6)


def test_values_are_averaged_over_their_own_patch_alone():
    mesh = parted_at_creases(cylinder(), 40)
    cap = np.abs(mesh.normals[:, 2]) > 0.5
    space = md.scale_space(mesh, scales=1)
    found = space.mean(np.where(cap, 1.0, 0.0), 10.0)
    np.testing.assert_allclose(found, cap, atol=1e-6)


def test_where_a_crease_runs_out_there_is_one_patch():
    mesh = parted_at_creases(running_out(), 40)
    assert mesh.added
    assert mesh.patches is None
    assert len(np.unique(parted_at_creases(box(), 40).patches)) == 6
