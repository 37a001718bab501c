"""What a panorama makes too bright is said, with the exposure that shows it."""

import re

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.clipping import MOST_CLIPPED
from meshdepict.errors import MeshdepictWarning

GLOSSY = ("phong", "radiance_scaling", "light_warping")


@pytest.fixture(scope="module")
def ball():
    return md.samples.golf_ball(1_000)


@pytest.fixture(scope="module")
def sky():
    """Radiance 0 … 6 from below to above."""
    rows = np.linspace(6, 0, 8)[:, None, None]
    return md.Environment(np.broadcast_to(rows, (8, 16, 3)))


@pytest.mark.parametrize("name", GLOSSY)
def test_the_exposure_that_a_note_names_clips_few(ball, sky, name):
    with pytest.warns(MeshdepictWarning, match="too bright to be shown") as said:
        md.bake(ball, name, light=sky)
    exposure = float(re.search(r"exposure=([^ ]+)", str(said[0].message))[1])
    shown = md.bake(ball, name, light=sky, exposure=exposure)  # a warning would be an error
    clipped = np.mean(shown.intensity.reshape(len(ball.vertices), -1).max(axis=1) >= 1)
    assert clipped <= MOST_CLIPPED
    brighter = md.shading.METHODS[name](
        shown.space, shown.look.light, view=shown.view, exposure=1.25 * exposure
    )
    assert np.mean(brighter.reshape(len(brighter), -1).max(axis=1) >= 1) > MOST_CLIPPED


def test_what_can_be_shown_needs_no_note(ball):
    dim = md.Environment(np.full((8, 16, 3), 0.2))
    assert md.bake(ball, "phong", light=dim).intensity.max() < 1
    md.bake(ball, "phong", light=["north", "front", "south"])  # lights are what a person chose
