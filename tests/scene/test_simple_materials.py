"""Phong, toon and lit sphere as methods."""

import numpy as np
import pytest

from meshdepict import MeshdepictError, samples, scale_space, shading
from meshdepict.color.srgb import srgb_to_linear
from meshdepict.scene.light import Light
from meshdepict.scene.material import LitSphere, soft_steps


@pytest.fixture(scope="module")
def space():
    return scale_space(samples.sphere(2_000), scales=0)


def test_phong(space):
    light = Light((1, 1, 2)).direction
    found = shading.phong(space, light, ambient=0.05, diffuse=0.4, specular=0.5, shininess=9)
    n = space.normals[0].astype(float)
    front = n[:, 2] >= 0
    r = 2 * n[:, 2:] * n - [0, 0, 1]
    expected = 0.05 + 0.4 * np.clip(n @ light, 0, 1) + 0.5 * np.clip(r @ light, 0, 1) ** 9
    np.testing.assert_allclose(found[front], np.clip(expected, 0, 1)[front], atol=1e-5)
    lambert = shading.phong(space, light, ambient=0, diffuse=1, specular=0)
    np.testing.assert_allclose(lambert, shading.lambert(space, light), atol=1e-6)


def test_a_light_of_a_colour_colours(space):
    red = shading.phong(space, Light((0, 0, 1), color=(1, 0, 0)), ambient=0)
    assert red.shape == (len(space.points), 3)
    assert red[:, 0].max() > 0.9
    assert not red[:, 1:].any()


@pytest.mark.parametrize("bins", [1, 4, 9])
def test_toon(space, bins):
    found = shading.toon(space, "northwest", bins=bins, sharpness=5)
    expected = soft_steps(shading.lambert(space, "northwest"), bins=bins, sharpness=5)
    np.testing.assert_allclose(found, expected, atol=1e-5)


def write_sphere(path, rng):
    """A picture of a sphere with transparent corners: red is right, green up, blue towards you."""
    from PIL import Image

    ticks = (np.arange(100) + 0.5) / 50 - 1
    x, y = np.meshgrid(ticks, -ticks)
    inside = x * x + y * y < 1
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    rgba = np.stack([(x + 1) / 2, (y + 1) / 2, z, inside], axis=-1) * inside[..., None]
    Image.fromarray(np.uint8(np.round(rgba * 255)), "RGBA").save(path)


def test_lit_sphere_from_a_file_shows_its_normals(space, tmp_path, rng):
    write_sphere(tmp_path / "normals.png", rng)
    n = space.normals[0]
    for sphere in (tmp_path / "normals.png", str(tmp_path / "normals.png")):
        found = shading.lit_sphere(space, "north", sphere=sphere)
        # The rim is looked up a hundredth further in, where z is up to √(1 − 0.985²) = 0.17,
        # and a pixel counts 0.02.
        np.testing.assert_allclose(found[:, :2], (1 + n[:, :2]) / 2, atol=0.02)
        np.testing.assert_allclose(found[:, 2], np.abs(n[:, 2]), atol=0.2)
    top = shading.lit_sphere(space, "north", view="top", sphere=tmp_path / "normals.png")
    np.testing.assert_allclose(top[:, 1], (1 - n[:, 2]) / 2, atol=0.02)


@pytest.mark.parametrize("sphere", ["clay", "metal"])
def test_built_in_spheres_have_light_and_dark(space, sphere):
    found = shading.lit_sphere(space, "north", sphere=sphere)
    assert found.shape == (len(space.points), 3)
    assert found.min() < 0.3
    assert found.max() > 0.9


def test_real_spheres_have_no_transparent_rim(space, data):
    for path in sorted((data / "litsphere").glob("*.png")):
        found = shading.lit_sphere(space, "north", sphere=path)
        assert np.isfinite(found).all()
        linear = shading.radiance_scaling(
            scale_space(samples.sphere(500), scales=1), "north", material=LitSphere(path)
        )
        assert np.isfinite(srgb_to_linear(linear)).all()


def test_refusals(space, tmp_path):
    with pytest.raises(MeshdepictError, match="called 'klay'; did you mean 'clay'"):
        shading.lit_sphere(space, "north", sphere="klay")
    (tmp_path / "no.png").write_text("no picture")
    with pytest.raises(MeshdepictError, match="cannot be read as a picture"):
        shading.lit_sphere(space, "north", sphere=tmp_path / "no.png")
    from PIL import Image

    Image.new("RGB", (1, 1)).save(tmp_path / "dot.png")
    with pytest.raises(MeshdepictError, match="too small for a lit sphere"):
        shading.lit_sphere(space, "north", sphere=tmp_path / "dot.png")
