"""Procedural finds have what they stand for: letters, wedges, a struck picture, scars."""

import numpy as np
import pytest

from meshdepict import MeshdepictError, samples
from meshdepict.samples.capitals import ALPHABET, distance_to_strokes, strokes
from meshdepict.samples.roughness import roughness
from meshdepict.samples.slab import slab


def heights(mesh):
    """The sheet's z by place, so that two of the same layout can be compared."""
    return mesh.vertices[:, 2]


def test_a_letter_is_cut_along_its_strokes_and_nowhere_else():
    cut = samples.inscription(40_000, text="I", depth=2.0, wear=0)
    uncut = samples.inscription(40_000, text="I", depth=0.0, wear=0)
    deep = heights(uncut) - heights(cut)
    x, y = cut.vertices[:, :2].T
    middle = (x.max() + x.min()) / 2
    assert deep.max() == pytest.approx(2.0, rel=0.1)  # between two columns of the grid
    assert (np.abs(x - middle)[deep > 0] <= 5.0 + 1e-9).all()
    assert np.ptp(y[deep > 1.0]) == pytest.approx(40, abs=6)  # its height, and round ends


def test_wear_takes_from_letters_what_it_says():
    def left(wear):
        cut, uncut = (
            heights(samples.inscription(20_000, text="OHO", depth=d, wear=wear)) for d in (2.0, 0.0)
        )
        return (uncut - cut).clip(0).sum()

    new, worn, gone = left(0.0), left(0.5), left(1.0)
    assert new > worn > gone > 0


def test_an_inscription_is_as_wide_as_its_longest_line():
    wide = samples.inscription(1000, text="I/MMMM").vertices
    only = samples.inscription(1000, text="MMMM").vertices
    assert np.ptp(wide[:, 0]) == np.ptp(only[:, 0])
    assert np.ptp(wide[:, 1]) > np.ptp(only[:, 1])


@pytest.mark.parametrize("text", ["FORMA 7", 3, "/é"])
def test_what_cannot_be_written_is_refused(text):
    with pytest.raises(MeshdepictError, match="inscription: "):
        samples.inscription(100, text=text)


def test_no_text_is_a_plain_stone():
    assert np.isfinite(samples.inscription(100, text="").vertices).all()


@pytest.mark.parametrize("letter", [letter for letter in ALPHABET if letter != " "])
def test_letters_stand_on_their_line(letter):
    pieces, width = strokes(letter, "a test")
    low = 0.25 if letter == "Q" else 0.0
    assert (pieces[..., 1] >= -low).all()
    assert (pieces[..., 1] <= 1).all()
    assert (pieces[..., 0] <= width + 0.25).all()
    assert (pieces[..., 0] >= -0.1).all()


def test_distances_to_strokes_are_those_to_their_nearest_points():
    pieces, _ = strokes("RQ", "a test")
    generator = np.random.default_rng(5)
    x, y = generator.uniform(-0.5, 2, (2, 400))
    along = np.linspace(0, 1, 4001)[:, None]
    drawn = np.concatenate([a * (1 - along) + b * along for a, b in pieces])
    exact = np.hypot(x[:, None] - drawn[:, 0], y[:, None] - drawn[:, 1]).min(axis=1)
    found = distance_to_strokes(x, y, pieces, 0.4)
    np.testing.assert_allclose(found, exact.clip(max=0.4), atol=1e-3)  # of a step along a stroke


def test_wedges_are_pressed_into_the_front_alone():
    written, plain = samples.tablet(20_000, lines=6), samples.tablet(20_000, lines=0)
    moved = np.linalg.norm(written.vertices - plain.vertices, axis=1) > 0.2
    assert moved.mean() > 0.02
    assert (plain.vertices[moved, 2] > 0).all()
    assert np.median(written.vertices[moved, 2] - plain.vertices[moved, 2]) < 0


def test_the_ear_stands_in_front_and_is_sunk_behind():
    coin = samples.coin(30_000, wear=0)
    x, y, z = coin.vertices.T
    stem = (np.abs(x) < 1.2) & (np.abs(y) < 3)
    field = (np.abs(x) > 4.6) & (np.abs(x) < 5.4) & (y < -5) & (np.hypot(x, y) < 8)
    for side, sign in ((z > 0, 1), (z < 0, -1)):
        relief = np.median(np.abs(z[stem & side])) - np.median(np.abs(z[field & side]))
        assert 0.1 < sign * relief < 0.42
    worn = samples.coin(30_000, wear=1)
    assert np.abs(worn.vertices[:, 2]).max() < np.abs(z).max()


def test_flakes_only_take_away_but_for_their_ripples():
    nodule = samples.knapped_core(10_000, flakes=0)
    core = samples.knapped_core(10_000, ripples=0)
    before, after = (np.linalg.norm(mesh.vertices, axis=1) for mesh in (nodule, core))
    assert (after <= before + 1e-12).all()
    assert (after < before - 0.5).mean() > 0.5
    rippled = np.linalg.norm(samples.knapped_core(10_000).vertices, axis=1)
    assert 0 < np.abs(rippled - after).max() < 8  # the ridges move, a little


def test_roughness_is_smooth_centred_and_of_unit_height():
    generator = np.random.default_rng(3)
    points = generator.uniform(-500, 500, (40_000, 3))
    noise = roughness(points, 10.0)
    assert abs(noise.mean()) < 0.03
    assert noise.std() == pytest.approx(1, abs=0.15)
    near = roughness(points + 1e-4, 10.0)
    assert np.abs(near - noise).max() < 0.01
    assert np.corrcoef(noise, roughness(points, 10.0, seed=1))[0, 1] == pytest.approx(0, abs=0.03)


def test_a_slab_with_exponents_of_two_is_an_ellipsoid():
    points, _, share = slab(1000, (3.0, 2.0, 1.0), corner=2.0, edge=2.0)
    np.testing.assert_allclose((points / (3, 2, 1)) ** 2 @ np.ones(3), 1, rtol=1e-12)
    np.testing.assert_allclose(share, points[:, 2], atol=1e-12)
