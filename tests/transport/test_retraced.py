"""Rays that memory doesn't hold: the same sums bit for bit, and what is still refused."""

import pickle

import numpy as np
import pytest

import meshdepict as md
from meshdepict import shading
from meshdepict.errors import MeshdepictError
from meshdepict.files import limits
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.transport.retraced import Retraced, transfer_of
from meshdepict.transport.transfer import Transfer

SIDE = (-1.0, 0.2, 0.3)
LITTLE = 2 << 20  # bytes: two batches of rays


@pytest.fixture(scope="module")
def torus():
    return md.samples.torus(5_000)


@pytest.fixture
def little():
    """Memory that doesn't hold the rays of a torus."""
    limits.set_max_memory(LITTLE)
    yield
    limits.set_max_memory(None)


def test_sums_are_those_of_kept_rays_bit_for_bit(torus, little):
    found = transfer_of(torus, rays=64)
    assert isinstance(found, Retraced)
    assert len([*found.parts()]) > 2
    limits.set_max_memory(None)
    kept = transfer_of(torus, rays=64)
    assert isinstance(kept, Transfer)
    limits.set_max_memory(LITTLE)
    values = np.cos(np.arange(len(kept)))
    np.testing.assert_array_equal(found.from_surface(values), kept.from_surface(values))
    colors = np.stack([values, values**2, 1 - values], axis=1)
    np.testing.assert_array_equal(found.from_surface(colors), kept.from_surface(colors))
    rows = np.linspace(0, 1, 16, dtype=np.float32)
    sky = Environment(np.broadcast_to(rows[:, None, None], (16, 32, 3)).copy())
    np.testing.assert_array_equal(found.from_sky(sky), kept.from_sky(sky))
    np.testing.assert_array_equal(found.sky_share, kept.sky_share)
    again, once = found.probes.transfer, kept.probes.transfer
    np.testing.assert_array_equal(again.from_surface(values), once.from_surface(values))
    assert len(found) == len(kept)


@pytest.mark.parametrize(
    "name", ["lambert", "phong", "radiance_scaling", "light_warping", "light_alignment"]
)
def test_methods_shade_the_same_with_little_memory(torus, little, name):
    options = {"shadows": True, "bounces": 2, "rays": 32}
    light = Environment(np.full((8, 16, 3), 0.5, np.float32))
    light = Light(SIDE) if name == "lambert" else light
    small = md.scale_space(torus, scales=1)
    found = getattr(shading, name)(small, light, **options)
    assert isinstance(small.transport(32), Retraced)
    limits.set_max_memory(None)
    large = md.scale_space(torus, scales=1)
    np.testing.assert_array_equal(getattr(shading, name)(large, light, **options), found)
    assert not isinstance(large.transport(32), Retraced)
    assert large.light_errors == small.light_errors


def test_rays_of_the_second_set_may_be_more_than_memory_holds_too(torus, little):
    found = transfer_of(torus, rays=256)
    assert isinstance(found.probes.transfer, Retraced)
    white = Environment(np.ones((8, 16, 3), np.float32))
    error = found.probes.error(found.from_sky(white), found.probes.transfer.from_sky(white))
    assert 0 < error < 0.02


def test_how_far_they_are_is_told_from_beginning_to_end(torus, little):
    told = []
    baked = md.bake(
        torus, "lambert", light=Light(SIDE), bounces=1, rays=64,
        progress=lambda done, total: told.append(done / total),
    )  # fmt: skip
    assert told[-1] == 1
    assert 0 < min(told) < 0.5
    assert baked.space.progress is None  # a bake's own
    pickle.dumps(baked.space)


def test_what_does_not_hold_a_batch_is_refused(torus):
    try:
        limits.set_max_memory(1 << 18)
        with pytest.raises(MeshdepictError, match=r"rays=64 take .* at a time, more than the"):
            shading.lambert(md.scale_space(torus, scales=0), SIDE, bounces=1)
    finally:
        limits.set_max_memory(None)
