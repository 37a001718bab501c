"""Light in hand with shadows and bounces: what a move costs, and what a window shows of it."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.transport import shadows, transfer
from meshdepict.viewer.browser.desk import Desk
from meshdepict.viewer.session import Session

LIT = {"shadows": True, "bounces": 3, "rays": 16}


@pytest.fixture
def traced(monkeypatch):
    """Sets of rays by their number, and shadow rays by that of their directions."""
    calls = []
    real, one = transfer.traced_transfer, shadows.seen_directions
    monkeypatch.setattr(
        transfer,
        "traced_transfer",
        lambda *a, **k: calls.append(("set", k["rays"])) or real(*a, **k),
    )
    monkeypatch.setattr(
        shadows,
        "seen_directions",
        lambda *a, **k: calls.append(("shadow", len(a[1]))) or one(*a, **k),
    )
    return calls


def sky(brightness, size=(8, 16)):
    return Environment(np.full((*size, 3), brightness, np.float32))


def test_a_new_light_costs_its_shadow_rays_alone(ball, traced):
    session = Session(ball, "lambert", **LIT)
    first = session.colors
    assert traced == [("shadow", 1), ("set", 16)]
    for _ in range(3):
        traced.clear()
        session.drag_light((0.1, 0.05))
        assert (session.colors != first).any()
        assert traced == [("shadow", 1)]
    expected = md.bake(ball, "lambert", light=session.light, view=session.view, **LIT)
    np.testing.assert_array_equal(session.colors, expected.colors)


def test_a_new_sky_costs_no_rays(ball, traced):
    session = Session(ball, "phong", light=sky(0.3), specular=0.0, **LIT)
    first = session.colors
    traced.clear()
    session.shine(sky(0.6))
    assert (session.colors > first).any()
    session.set(exposure=0.5)
    assert session.colors.shape == first.shape
    assert traced == []


def test_a_page_moves_it_too(ball, traced):
    session = Session(ball, "lambert", **LIT)
    desk = Desk(session, "ball.ply")
    assert desk.apply([]) == ""
    traced.clear()
    assert desk.apply([["light", [1.0, 0.2, 0.3]]]) == ""
    assert traced == [("shadow", 1)]
    control = next(each for each in desk.look()["controls"] if each["name"] == "rays")
    assert control["words"] == ("auto",)
    assert control["word"] == ""
    assert desk.apply([["option", "lambert", "rays", "auto"]]) == ""
    control = next(each for each in desk.look()["controls"] if each["name"] == "rays")
    assert (control["word"], control["value"]) == ("auto", 64)  # where its slider began


def test_a_light_in_hand_keeps_the_rays_that_were_found(ball, monkeypatch):
    monkeypatch.setattr("meshdepict.shading.sampled.UNSEEN", 0.0)
    monkeypatch.setattr("meshdepict.shading.sampled.AUTO_SECONDS", 0.0)
    session = Session(ball, "lambert", shadows=True, bounces=1, rays="auto")
    found = session.baked()
    assert found.look.options["rays"] == 64
    assert "rays auto" in found.provenance
    session.drag_light((0.1, 0.1))
    assert "rays auto" not in session.baked().provenance  # nothing was looked for
    assert session.recorded().options["rays"] == 64
    session.set(bounces=2)
    assert "rays auto" in session.baked().provenance


def test_what_it_is_doing_is_told_by_name(ball):
    told = []
    session = Session(ball, "exaggerated", scales=2, progress=lambda *_: told.append(session.doing))
    session.baked()
    assert {*told} == {"smoothing normals"}
    told.clear()
    session.use("lambert")
    session.set(**LIT)
    session.baked()
    assert {*told} == {"tracing rays"}
    assert session.doing == "smoothing normals"


def test_the_page_that_is_saved_has_what_is_shown(ball, folder):
    session = Session(ball, "lambert", light=Light((-1, 0.2, 0.3)), **LIT)
    session.drag_light((0.1, 0.1))
    page = session.baked().save(folder / "ball.html")
    text = page.read_text()
    assert "bounces=3" in text
    assert "shadows=true" in text
