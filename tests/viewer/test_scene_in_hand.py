"""Windows on one of several objects: the others stay where rays from it go."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.viewer.windows.reopened import session_of


@pytest.mark.parametrize("ground", [None, "matt"])
def test_a_new_light_has_the_shadows_and_bounces_of_the_scene(ground):
    ball, torus = md.samples.golf_ball(700, dimples=12), md.samples.torus(500)
    torus = md.Mesh(torus.vertices + np.array((2.5, 0, 0)), torus.faces)
    options = {"shadows": True, "bounces": 2, "rays": 16, "ground": ground, "view": "isometric"}
    scene = md.bake_together([ball, torus], "lambert", light="northwest", **options)
    session = session_of(scene[0])
    np.testing.assert_array_equal(session.colors, scene[0].colors)
    session.shine("east")
    again = md.bake_together([ball, torus], "lambert", light=session.light, **options)
    np.testing.assert_array_equal(session.colors, again[0].colors)
    saved = session.baked().provenance
    assert {"together", "ground"} & {*saved} == {"together", *(["ground"] if ground else [])}
