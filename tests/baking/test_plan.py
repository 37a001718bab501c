"""What is planned is what a bake computes, and costs what it costs within a small factor."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from test_computed import COMPUTED, Row, shapes  # noqa: F401

import meshdepict as md
from meshdepict import threads
from meshdepict.baking.choices import Choices
from meshdepict.baking.plan import plan
from meshdepict.errors import MeshdepictError
from meshdepict.sums.gaussian import gaussian_sums, predicted_seconds


@pytest.mark.parametrize("kind", ["mesh", "volume", "image"])
@pytest.mark.parametrize(("method", "options", "row"), COMPUTED, ids=str)
def test_the_plan_has_as_many_steps_as_are_written_down(
    kind: str,
    method: str,
    options: dict[str, Any],
    row: Row,
    shapes: dict[str, Any],  # noqa: F811
) -> None:
    if kind != "mesh" and "facing" in options:
        pytest.skip("facing is about meshes")
    found = plan(shapes[kind], Choices(method, **options))
    expected = row.of(kind)
    steps = [step.what for step in found.steps]
    assert steps.count("normals") == len(found.sets) == expected["sets"]
    assert steps.count("curvature") == expected["curvature"] + expected["seen"]
    assert steps.count("mean") == expected["means"]
    assert steps.count("rays") == expected["rays"]
    assert all(step.seconds >= 0 and step.size >= 0 for step in found.steps)
    assert (found.working > 0) == bool(expected["sets"] or expected["means"])
    assert found.seconds == pytest.approx(sum(step.seconds for step in found.steps))


def test_sets_on_the_way_to_a_coarser_one_are_said_to_be() -> None:
    ball = md.samples.sphere(300)
    climbing = plan(ball, Choices("normal_enhancement"))
    assert [step.where.endswith("on the way") for step in climbing.steps[1:6]] == [True] * 4 + [
        False
    ]
    assert plan(ball, Choices("normal_enhancement", facing=0)).sets == (5,)


def test_a_plan_has_the_widths_of_the_bake(shapes: dict[str, Any]) -> None:  # noqa: F811
    for width in (None, 0.1, "5%", "20px"):
        look = Choices("light_alignment", width=width)
        baked = md.bake(shapes["mesh"], "light_alignment", width=width)
        np.testing.assert_allclose(plan(shapes["mesh"], look).widths, baked.space.widths)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"method": "light_warping", "scale": 4},
            "scale=4 is not one of the scale space's",
        ),
        ({"method": "light_alignment", "strength": (1, 0)}, "strength has 2 values for 5 scales"),
        ({"method": "exaggerated", "scales": 100}, "scales=100 is not a whole number"),
        ({"method": "exaggerated", "width": -1}, "is not a positive length"),
    ],
)
def test_what_can_t_be_baked_can_t_be_planned(options: dict[str, Any], message: str) -> None:
    ball = md.samples.sphere(300)
    for refused in (lambda **o: plan(ball, Choices(**o)), lambda **o: md.bake(ball, **o)):
        with pytest.raises(MeshdepictError, match=message):
            refused(**options)


def test_more_vertices_and_finer_tolerances_cost_more() -> None:
    small, large = (plan(md.samples.sphere(n), Choices()) for n in (500, 20_000))
    assert small.seconds < large.seconds
    assert small.size < large.size
    finer = plan(md.samples.sphere(20_000), Choices(tolerance=1e-6))
    assert large.seconds < finer.seconds


@pytest.mark.parametrize("width", [0.003, 0.02, 0.2])
def test_sums_take_about_as_long_as_predicted(width: float) -> None:
    """Within a factor of six either way: constants are of one machine, and others are busy."""
    points = md.samples.golf_ball(20_000).unit_points
    channels = np.abs(np.random.default_rng(0).normal(size=(10, len(points))))
    channels[0] = channels.max()
    threads.limit(1)
    gaussian_sums(points[:500], channels[:, :500], width, error=2.5e-5)  # compiles and loads
    start = time.process_time()
    gaussian_sums(points, channels, width, error=2.5e-5)
    taken = time.process_time() - start
    predicted = predicted_seconds(points, width, channels=10, error=2.5e-5)
    assert predicted / 6 < taken < 6 * predicted
