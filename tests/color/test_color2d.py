"""Colour maps of two lights."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.color.colormaps2d import NAMES, colormap2d, mix, second_light
from meshdepict.color.srgb import srgb_to_linear
from meshdepict.errors import MeshdepictError
from meshdepict.scene.names import as_light, as_view


@pytest.mark.parametrize("name", NAMES)
def test_each_light_makes_every_colour_brighter(name):
    table = colormap2d(name)
    assert table.shape == (256, 256, 3)
    assert table.dtype == np.uint8
    luminance = srgb_to_linear(table / 255) @ [0.2126, 0.7152, 0.0722]
    step = 0.01  # the tables are rounded to 256 levels
    assert (np.diff(luminance, axis=0) > -step).all()
    assert (np.diff(luminance, axis=1) > -step).all()
    assert luminance[0, 0] < 0.1
    assert luminance[-1, -1] > 0.85
    # What one light alone reaches differs in hue, not in brightness alone.
    assert np.abs(table[255, 0].astype(int) - table[0, 255]).max() > 60


def test_the_table_holds_the_mixed_colours():
    table = colormap2d("earth")
    np.testing.assert_array_equal(
        table[[0, 30, 255], [0, 200, 255]],
        np.round(mix(np.array([0, 30, 255]) / 255, np.array([0, 200, 255]) / 255, "earth") * 255),
    )


def test_the_second_light_of_northwest_is_northeast(ball):
    for name in ("front", "top", "right"):
        view = as_view(name, ball)
        light = second_light(as_light("northwest", view), view)
        np.testing.assert_allclose(light.direction, as_light("northeast", view).direction)


@pytest.mark.parametrize("method", ["exaggerated", "lambert"])
def test_bake_mixes_the_two_shadings(ball, method):
    baked = md.bake(ball, method, colormap2d="dusk")
    one, other = (md.bake(ball, method, light=light) for light in ("northwest", "northeast"))
    expected = colormap2d("dusk")[one.colors[:, 0], other.colors[:, 0]]
    # The levels of the two are rounded, the mixed shading is not: half a level each.
    assert np.abs(baked.colors.astype(int) - expected).max() <= 2
    assert baked.intensity.shape == (len(ball.vertices), 3)
    assert baked.provenance["colormap"] == "dusk"


def test_from_the_command_line(run, ball_ply):
    status, _, err = run("bake", "ball.ply", "--colormap2d", "swiss")
    assert (status, err) == (0, [])
    status, _, err = run("bake", "ball.ply", "--colormap2d", "swis")
    assert status == 2
    assert "did you mean 'swiss'?" in err[0]


def test_wrong_input_is_refused(ball):
    with pytest.raises(MeshdepictError, match="no 2D colour map 'rainbow'"):
        mix(0.5, 0.5, "rainbow")
    with pytest.raises(MeshdepictError, match="exclude each other"):
        md.bake(ball, colormap="sepia", colormap2d="dusk")
    with pytest.raises(MeshdepictError, match="this shading is in colour already"):
        md.bake(ball, "gooch", colormap2d="dusk")
