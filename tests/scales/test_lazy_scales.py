"""Sets of normals that are smoothed when they are read are those of a full scale space."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import meshdepict as md
from meshdepict.errors import MeshdepictError
from meshdepict.scales.chosen_samples import ChosenSamples
from meshdepict.scales.image_scales import image_space
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.making import scale_space
from meshdepict.scales.seen_side import SeenSide
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.view import View

SCALES = 4
Made = Callable[..., ScaleSpace]


class StoppedError(Exception):
    """Somebody has enough."""


@pytest.fixture(scope="module")
def ball() -> md.Mesh:
    return md.samples.golf_ball(900, dimples=12, depth=0.05)


@pytest.fixture(
    scope="module",
    params=["facing", "paper", "bilateral", "diffusion", "importance", "volume", "solid volume"],
)
def made(request: pytest.FixtureRequest, ball: md.Mesh) -> Made:
    """What makes a scale space of some kind, given what to smooth at once."""
    kind = request.param
    if kind in ("facing", "paper"):
        facing = 1 if kind == "facing" else 0
        return lambda **more: scale_space(ball, scales=SCALES, facing=facing, **more)
    if "volume" in kind:
        values = np.random.default_rng(1).normal(size=(9, 10, 11))
        if kind == "solid volume":  # most voxels have no gradient of their own
            values = np.zeros((14, 15, 16))
            values[5:9, 4:9, 5:8] = 1000
            values[:2] = 500
        volume = md.Volume(values)
        return lambda **more: scale_space(volume, scales=SCALES, **more)
    picture = md.GBuffer.of(ball, "front", size=(40, 40))
    if kind == "bilateral":
        return lambda **more: image_space(picture, scales=SCALES, **more)
    share = np.linspace(0, 1, len(picture.normals)) if kind == "importance" else None
    return lambda **more: image_space(
        picture, scales=SCALES, filter="diffusion", importance=share, **more
    )


@pytest.fixture(scope="module")
def full(made: Made) -> np.ndarray[Any, Any]:
    return made().normals.copy()


@pytest.mark.parametrize("order", [(1, 2, 3, 4), (4, 3, 2, 1), (2, 4, 1, 3), (3, 0, 1)], ids=str)
def test_sets_are_the_same_in_whatever_order_they_are_read(
    made: Made, full: np.ndarray[Any, Any], order: tuple[int, ...]
) -> None:
    space = made(at_once=())
    assert space.smoothed == {0}
    for scale in order:
        np.testing.assert_array_equal(space.normals_at(scale), full[scale])
        assert scale in space.smoothed
    np.testing.assert_array_equal(space.normals, full)
    assert space.smoothed == set(range(SCALES + 1))


@pytest.mark.parametrize("wanted", [(0,), (2,), (4,), (1, 4), (3, 1)], ids=str)
def test_some_sets_are_smoothed_at_once(
    made: Made, full: np.ndarray[Any, Any], wanted: tuple[int, ...]
) -> None:
    space = made(at_once=wanted)
    before = space.smoothed
    assert set(wanted) <= before
    found = space.planes_of(wanted)
    np.testing.assert_array_equal(found, np.moveaxis(full, 1, 2)[list(wanted)])
    assert space.smoothed == before
    assert not found.flags.writeable
    assert not space.planes_at(wanted[0]).flags.writeable
    np.testing.assert_array_equal(space.planes, np.moveaxis(full, 1, 2))


def test_there_are_as_many_samples_whatever_is_smoothed(made: Made) -> None:
    whole, bare = made(), made(at_once=())
    np.testing.assert_array_equal(whole.points, bare.points)
    np.testing.assert_array_equal(whole.curvature(2).k1, bare.curvature(2).k1)


@pytest.mark.parametrize("after", [0.3, 1.0, 2.5])
def test_what_was_stopped_goes_on(made: Made, full: np.ndarray[Any, Any], after: float) -> None:
    space = made(at_once=())

    def stop(done: float, total: float) -> None:
        assert total == len(missing)
        if done >= after:
            raise StoppedError

    missing = set(range(1, SCALES + 1))
    with pytest.raises(StoppedError):
        space.smooth(progress=stop)
    np.testing.assert_array_equal(space.normals, full)


def test_progress_is_of_what_is_missing(made: Made) -> None:
    space, told = made(at_once=(1,)), []
    space.smooth((1,), progress=lambda *done: told.append(done))
    assert not told
    space.smooth((1, 2), progress=lambda *done: told.append(done))
    assert told[-1] == (1, 1)
    space.smooth(progress=lambda *done: told.append(done))
    assert told[-1] == (2, 2)
    assert sorted(told[-2:]) == told[-2:]


def test_scales_that_are_not_there_are_refused(made: Made) -> None:
    space = made(at_once=())
    for read in (space.normals_at, space.planes_at, lambda scale: space.smooth((scale,))):
        with pytest.raises(MeshdepictError, match="scale=5 is not one of the scale space's, 0 to"):
            read(5)
    with pytest.raises(MeshdepictError, match="scale=5 is not one"):
        made(at_once=(5,))
    with pytest.raises(MeshdepictError, match="True are no scales: give numbers"):
        made(at_once=True)
    with pytest.raises(MeshdepictError, match="scale='1' is not one of"):
        made(at_once="1")
    assert space.smoothed == {0}


@pytest.mark.parametrize(
    "of",
    [
        lambda space: SeenSide(space, View.fitted("left", space.shape)),
        lambda space: ChosenSamples(space, np.arange(0, 300, 7)),
        lambda space: InterpolatedSpace(space, space.shape.faces[:50], np.full((50, 3), 1 / 3)),
    ],
    ids=["seen side", "chosen", "interpolated"],
)
def test_samples_of_another_space_ask_it_for_what_they_are_asked(
    ball: md.Mesh, of: Callable[[ScaleSpace], ScaleSpace]
) -> None:
    source = scale_space(ball, scales=SCALES, at_once=())
    some = of(source)
    assert source.smoothed == some.smoothed == {0}
    second = some.normals_at(2)
    assert source.smoothed == {0, 1, 2}
    assert some.smoothed == {0, 2}
    expected = of(scale_space(ball, scales=SCALES))
    np.testing.assert_array_equal(second, expected.normals[2])
    np.testing.assert_array_equal(some.normals, expected.normals)


def test_the_paper_s_sum_smooths_one_width_without_those_before(ball: md.Mesh) -> None:
    space = scale_space(ball, scales=SCALES, facing=0, at_once=(SCALES,))
    assert space.smoothed == {0, SCALES}
    np.testing.assert_array_equal(
        md.smooth_normals(ball, 0.3, facing=0),
        scale_space(ball, scales=1, width=0.3, facing=0).normals[1],
    )


def test_where_the_paper_s_sum_cancels_the_next_finer_set_is_asked() -> None:
    """Two sheets back to back: wide sums vanish, and what is finer is kept."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    both = np.concatenate([corners, corners + np.array((0, 0, 1e-4))])
    mesh = md.Mesh(both, [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)], winding="keep")
    widths = {"scales": 2, "width": 0.5, "facing": 0}
    space, full = scale_space(mesh, **widths, at_once=(2,)), scale_space(mesh, **widths)
    assert space.smoothed == {0, 1, 2}
    np.testing.assert_array_equal(space.normals, full.normals)


def test_a_scale_space_can_be_sent_to_another_process(
    made: Made, full: np.ndarray[Any, Any]
) -> None:
    there = pickle.loads(pickle.dumps(made(at_once=(2,))))
    np.testing.assert_array_equal(there.normals, full)
    np.testing.assert_array_equal(there.normals_at(3), full[3])
    np.testing.assert_array_equal(there.planes_of((3, 1))[0], full[3].T)
    assert not there.normals_at(1).flags.writeable
    np.testing.assert_array_equal(there.curvature(1).k1, made(at_once=()).curvature(1).k1)
