"""Attention: detail fades away from a focus, fine scales first; the base coat stays."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shading import exaggerated
from meshdepict.shading.attention import detail_share, remoteness
from meshdepict.shading.bands import band_weights
from meshdepict.shading.exaggerated import local_light, soft_toon

LIGHT = np.array([-1, 1, 1]) / np.sqrt(3)
FOCUS = (0.0, 0.2, 1.0)


@pytest.fixture(scope="module")
def space(ball):
    return md.scale_space(ball, scales=5)


def paper(space, **options):
    return exaggerated(space, LIGHT, exaggeration=15.0, **options)


def plain_twin(space, radius):
    n = space.normals.astype(float)
    weights = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
    distance = np.linalg.norm(space.points - FOCUS, axis=1)
    total = weights[-1] * (n[-1] @ LIGHT)
    for i in range(len(n) - 1):
        detail = soft_toon((n[i] * local_light(LIGHT, n[i + 1])).sum(axis=1), 15.0)
        total += weights[i] * np.exp(-0.5 * (distance / (radius * 2 ** (i / 2))) ** 2) * detail
    return np.clip((1 + total) / 2, 0, 1)


@pytest.mark.parametrize("radius", [0.05, 0.4, 3.0])
def test_attention_follows_its_formula(space, radius):
    c = paper(space, focus=FOCUS, radius=radius)
    np.testing.assert_allclose(c, plain_twin(space, radius), atol=1 / 255)


def test_a_wide_radius_is_no_attention_and_a_narrow_one_leaves_the_base_coat(space):
    plain = paper(space)
    np.testing.assert_allclose(paper(space, focus=FOCUS, radius=1e9), plain, atol=1e-6)
    weights = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
    base = (1 + weights[-1] * (space.normals[-1] @ LIGHT)) / 2
    with pytest.warns(MeshdepictWarning, match="9,9,9 is .* away from it"):
        narrow = paper(space, focus=(9, 9, 9), radius=1e-250)
    np.testing.assert_allclose(narrow, base, atol=1e-6)


def test_fine_scales_fade_first(space):
    shares = [detail_share(remoteness(space, FOCUS, 0.3), i) for i in range(5)]
    assert (np.diff(shares, axis=0) >= 0).all()
    assert shares[0].min() < 0.01 < shares[0].max()


def test_the_default_radius_is_a_tenth_of_the_diagonal(space):
    np.testing.assert_array_equal(
        exaggerated(space, LIGHT, focus=FOCUS),
        exaggerated(space, LIGHT, focus=FOCUS, radius=space.shape.diagonal / 10),
    )


def test_from_the_command_line(run, ball_ply):
    status, out, _ = run("bake", "ball.ply", "--set", "focus=0,0.2,1", "--set", "radius=0.3")
    assert status == 0
    text = "\n".join(md.io.read_provenance(out[0].split(":")[0]))
    assert "focus=0,0.2,1" in text
    assert "radius=0.3" in text


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"focus": (1, 2)}, "is not 3 numbers"),
        ({"focus": (1, 2, np.inf)}, "focus=inf is not a number"),
        ({"focus": FOCUS, "radius": 0}, "radius=0 is not a number in its range"),
    ],
)
def test_wrong_input_is_refused(space, options, message):
    with pytest.raises(MeshdepictError, match=message):
        md.bake(space, "exaggerated", **options)


def test_a_focus_far_from_the_object_is_told(space):
    far = space.points.mean(axis=0) + 9 * space.shape.diagonal
    with pytest.warns(MeshdepictWarning, match=r"the object's diagonals away .*: fine detail"):
        exaggerated(space, "north", focus=far)
    beside = space.points.max(axis=0) + 0.2 * space.shape.diagonal
    assert np.isfinite(exaggerated(space, "north", focus=beside)).all()  # a place beside is one
