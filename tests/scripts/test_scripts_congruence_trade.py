"""What scripts/congruence_trade.py says of means: who is highest, and in which order."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import meshdepict as md
from meshdepict.congruence.comparison import compare

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.fixture(scope="module")
def trade():
    sys.path.insert(0, str(SCRIPTS))
    try:
        import congruence_trade
    finally:
        sys.path.remove(str(SCRIPTS))
    return congruence_trade


@pytest.fixture
def found(trade):
    """Exaggerated Shading leads by less than 0.005 at 0.4, and not at all at 0.7."""
    means = dict.fromkeys(trade.OTHERS, 0.5)
    return means | {"exaggerated": 0.803, "lambert": 0.2} | {
        "0.3": 0.7, "0.4": 0.8, "0.7": 0.9, "fig. 9": 0.803,
    }  # fmt: skip


def test_strengths_meet_the_other_methods_and_those_meet_one_strength(trade, found):
    highest = {name for name in found if trade.highest(found, name)}
    assert highest == {"exaggerated", "0.7", "fig. 9"}
    assert not trade.highest(found | {"0.4": 0.81}, "exaggerated")


def test_an_order_goes_down_and_tells_what_is_alike(trade, found):
    order = trade.order(found)
    assert order.startswith("ES ≈ LLA > ")
    assert order.endswith(" > L")
    assert order.count("LLA") == 1


def test_means_are_those_of_comparisons(trade):
    ball = md.samples.golf_ball(400, dimples=12)
    chosen = {"size": (60, 60), "scales": 2, "flow": "slope", "lights": ["north", "east"]}
    trade_strengths = {name: value for name, value in trade.STRENGTHS.items() if name != "fig. 9"}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(trade, "STRENGTHS", trade_strengths)  # fig. 9's are for six scales
        found = trade.means(ball, **chosen)
    assert set(found) == {*trade.OTHERS, *trade_strengths}
    options = {"light_alignment": {"strength": 0.7}}
    aligned = compare(ball, ["light_alignment"], options=options, **chosen)
    assert found["0.7"] == pytest.approx(float(aligned.means[0]))
    assert found["0.3"] != found["0.7"]
