"""Environments: reading, orientation, lights, irradiance and blurred lookups."""

import itertools
import math

import numpy as np
import pytest

import meshdepict as md
from meshdepict import Environment, MeshdepictError


def write_hdr(path, rgbe, *, magic=b"#?RADIANCE"):
    """Write a Radiance picture with literal runs only."""
    height, width, _ = rgbe.shape
    lines = [magic + b"\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width)]
    for row in rgbe:
        lines.append(bytes([2, 2, width >> 8, width & 255]))
        for channel in row.T:
            for begin in range(0, width, 128):
                run = channel[begin : begin + 128]
                lines.append(bytes([len(run)]) + run.tobytes())
    path.write_bytes(b"".join(lines))


def decoded(rgbe):
    """RGBE after Ward: value = mantissa · 2^(exponent − 136), black for exponent 0."""
    mantissa, exponent = rgbe[..., :3].astype(np.float64), rgbe[..., 3:].astype(int)
    return np.where(exponent > 0, np.ldexp(mantissa, exponent - 136), 0).astype(np.float32)


def smooth(rng, rows=32):
    """Radiance of orders 0 to 2 in the direction: what order 2 reproduces exactly."""
    d = Environment(np.ones((rows, 2 * rows, 3)))._directions
    tint = rng.uniform(0.2, 1, 3)
    value = 2 + d @ rng.uniform(-0.5, 0.5, 3) + d**2 @ [0.4, -0.2, 0.1]
    return Environment(value[..., None] * tint)


def exact_irradiance(environment, normals):
    d = environment._directions.reshape(-1, 3)
    flux = (environment.pixels * environment._solid_angles[..., None]).reshape(-1, 3)
    return np.maximum(normals @ d.T, 0) @ flux


def unit(rng, count):
    d = rng.normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


@pytest.mark.parametrize("magic", [b"#?RADIANCE", b"#?RGBE"])
def test_reading_is_exact_and_the_first_row_is_up(tmp_path, rng, magic):
    rgbe = rng.integers(0, 256, (8, 16, 4), dtype=np.uint8)
    rgbe[..., 3] = rng.integers(120, 145, (8, 16))
    rgbe[2, 3] = 0
    write_hdr(tmp_path / "light.hdr", rgbe, magic=magic)
    environment = md.Environment.from_file(tmp_path / "light.hdr")
    np.testing.assert_array_equal(environment.pixels, decoded(rgbe))
    assert str(environment) == "light (16 x 8, up y)"


def test_directions():
    pixels = np.zeros((8, 16, 3))
    pixels[0, :, 0] = pixels[3:5, 7:9, 1] = pixels[3:5, 11:13, 2] = 1
    environment = Environment(pixels)
    seen = environment.lookup([[0, 1, 0], [0, 0, -1], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(seen, [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]], atol=1e-6)
    turned = Environment(pixels, up="z").lookup([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, -1, 0]])
    np.testing.assert_allclose(turned, seen, atol=1e-6)
    first = Environment(pixels, up="z")._directions[0].mean(axis=0)
    np.testing.assert_allclose(first, [0, 0, 1], atol=0.03)


def test_lookup_is_exact_at_pixels_and_goes_round(rng):
    environment = Environment(rng.uniform(0, 5, (10, 20, 3)))
    np.testing.assert_allclose(
        environment.lookup(environment._directions.reshape(-1, 3)),
        environment.pixels.reshape(-1, 3), rtol=1e-4, atol=1e-4,
    )  # fmt: skip
    seam = environment.lookup([[math.sin(a), 0, math.cos(a)] for a in (-1e-9, 1e-9)])
    np.testing.assert_allclose(seam[0], seam[1], rtol=1e-5)


@pytest.mark.parametrize("count", [1, 2, 16, 54, 200])
def test_lights_keep_the_flux_and_are_the_same_every_time(rng, count):
    environment = Environment(rng.uniform(0, 1, (24, 48, 3)) ** 8)
    lights = environment.lights(count)
    assert len(lights) == count
    total = math.pi * sum(light.color for light in lights)
    np.testing.assert_allclose(total, environment.flux, rtol=1e-6)
    again = environment.lights(count)
    assert all((a.direction == b.direction).all() for a, b in zip(lights, again, strict=True))


def test_version_0_1_cut_into_lights_of_equal_power():
    pixels = np.zeros((8, 16, 3))
    pixels[4, 2], pixels[4, 9], pixels[4, 12] = 4, 2, 2
    older = Environment(pixels, sampling="lights")
    first, second = older.lights(2)
    np.testing.assert_allclose(first.color, second.color, rtol=1e-6)
    np.testing.assert_allclose(first.direction, older._directions[4, 2], atol=1e-6)
    assert len(older.lights(1000)) == 8 * 16
    total = sum(light.color for light in older.lights(54))
    np.testing.assert_allclose(math.pi * total, older.flux, rtol=1e-6)


def test_an_unknown_sampling_is_refused():
    with pytest.raises(MeshdepictError, match="sampling='cut' is neither 'lobes' nor 'lights'"):
        Environment(np.ones((2, 4, 3)), sampling="cut")


def test_more_lights_come_closer_to_the_irradiance(rng):
    environment, normals = smooth(rng), unit(rng, 200)
    exact = exact_irradiance(environment, normals)
    errors = []
    for count in (4, 16, 64, 256):
        lights = environment.lights(count)
        cosine = np.maximum(normals @ np.array([x.direction for x in lights]).T, 0)
        found = math.pi * cosine @ np.array([x.color for x in lights])
        errors.append(np.abs(found - exact).max() / exact.max())
    assert all(b < a for a, b in itertools.pairwise(errors))
    assert errors[-1] < 0.02


def test_lights_of_a_single_bright_pixel_black_and_small_pictures():
    pixels = np.zeros((8, 16, 3))
    pixels[2, 5] = 100
    environment = Environment(pixels)
    brightest = max(environment.lights(30), key=lambda light: light.color.sum())
    np.testing.assert_allclose(brightest.direction, environment._directions[2, 5], atol=1e-6)
    np.testing.assert_allclose(brightest.color * math.pi, environment.flux, rtol=1e-6)
    every = environment.lights(1000)
    assert len(every) == 8 * 16
    np.testing.assert_allclose(np.pi * sum(x.color for x in every), environment.flux, rtol=1e-6)
    assert len(Environment(np.zeros((8, 16, 3))).lights(20)) == 20
    assert len(Environment(np.ones((1, 2, 3))).lights(20)) == 2


def test_irradiance_is_exact_for_smooth_light(rng):
    environment, normals = smooth(rng, rows=128), unit(rng, 100)
    exact = exact_irradiance(environment, normals)
    # What remains is the midpoint rule's error over pixels of 1.4°.
    np.testing.assert_allclose(environment.irradiance(normals), exact, rtol=1e-3)
    white = Environment(np.ones((64, 128, 3)))
    np.testing.assert_allclose(white.irradiance(normals), math.pi, rtol=1e-3)


def test_irradiance_of_real_light_is_within_the_papers_error(data, rng):
    for name in ("grace_256x128", "ennis_256x128"):
        environment = Environment.from_file(data / "env" / f"{name}.hdr")
        normals = unit(rng, 100)
        exact = exact_irradiance(environment, normals)
        error = np.abs(environment.irradiance(normals) - exact).max() / exact.max()
        assert error < 0.09


def test_blurred_lookup_keeps_the_mean_and_widens(rng):
    environment = Environment(rng.uniform(0, 1, (64, 128, 3)) ** 6)
    d = unit(rng, 400)
    variances = [environment.lookup(d, blur=b).var(axis=0).mean() for b in (0, 0.05, 0.2, 0.8, 3)]
    assert all(b < a for a, b in itertools.pairwise(variances))
    mean = environment.flux / (4 * math.pi)
    wide = environment.lookup(d, blur=1.6)
    np.testing.assert_allclose(wide.mean(axis=0), mean, rtol=0.1)
    white = Environment(np.full((16, 32, 3), 0.5)).lookup(d, blur=0.3)
    np.testing.assert_allclose(white, 0.5, rtol=1e-4)


def test_each_direction_may_have_a_blur_of_its_own(rng):
    environment = Environment(rng.uniform(0, 1, (64, 128, 3)) ** 6)
    d = unit(rng, 200)
    for blur in (0.0, 0.01, 0.05, 0.2, 0.33, 1.6, 3.0):
        alone = environment.lookup(d, blur=blur)
        together = environment.lookup(d, blur=np.full(len(d), blur))
        np.testing.assert_allclose(together, alone, atol=1e-5)
    blurs = rng.uniform(0, 2, len(d))
    mixed = environment.lookup(d, blur=blurs)
    for i in (0, 17, 199):
        np.testing.assert_allclose(mixed[i], environment.lookup(d[i], blur=blurs[i]), atol=1e-5)
    for wrong in (np.full(3, 0.1), np.full(len(d), -1.0), np.full(len(d), np.nan)):
        with pytest.raises(MeshdepictError, match="is not a width in radians for every direction"):
            environment.lookup(d, blur=wrong)


def test_real_files_have_sensible_lights(data):
    for path in sorted((data / "env").glob("*.hdr")):
        environment = Environment.from_file(path)
        assert environment.pixels.shape[1] == 2 * environment.pixels.shape[0]
        lights = environment.lights(54)
        total = math.pi * sum(light.color for light in lights)
        np.testing.assert_allclose(total, environment.flux, rtol=1e-5)


def test_refusals(tmp_path, rng):
    with pytest.raises(MeshdepictError, match="cannot be read"):
        Environment.from_file(tmp_path / "none.hdr")
    (tmp_path / "text.hdr").write_text("hello, I am not light")
    with pytest.raises(MeshdepictError, match="not a Radiance picture"):
        Environment.from_file(tmp_path / "text.hdr")
    write_hdr(tmp_path / "cut.hdr", rng.integers(0, 256, (8, 16, 4), dtype=np.uint8))
    raw = (tmp_path / "cut.hdr").read_bytes()
    (tmp_path / "cut.hdr").write_bytes(raw[: len(raw) // 2])
    with pytest.raises(MeshdepictError, match="damaged Radiance picture"):
        Environment.from_file(tmp_path / "cut.hdr")
    for pixels in (np.ones((4, 8)), "light", np.ones((0, 8, 3))):
        with pytest.raises(MeshdepictError, match="must have shape"):
            Environment(pixels)
    for value in (np.nan, -1.0):
        with pytest.raises(MeshdepictError, match="finite and not negative"):
            Environment(np.full((2, 4, 3), value))
    white = Environment(np.ones((2, 4, 3)))
    with pytest.raises(MeshdepictError, match="up='w' is not one of y, z, -y, -z, x, -x"):
        Environment(np.ones((2, 4, 3)), up="w")
    for count in (0, True, 2.5):
        with pytest.raises(MeshdepictError, match="not a number of lights"):
            white.lights(count)
    with pytest.raises(MeshdepictError, match="not a width"):
        white.lookup([[0, 1, 0]], blur=-1)


@pytest.mark.parametrize("up", ["y", "z"])
def test_a_file_lights_a_bake_and_its_up_is_the_shapes(tmp_path, up):
    rgbe = np.zeros((8, 16, 4), np.uint8)
    rgbe[:2] = (128, 128, 128, 129)  # radiance 1 from above
    write_hdr(tmp_path / "sky.hdr", rgbe)
    baked = md.bake(
        md.samples.sphere(500), "light_warping", light=str(tmp_path / "sky.hdr"), up=up, magnitude=0
    )
    assert baked.provenance["light"] == f"sky (16 x 8, up {up})"
    height = baked.shape.vertices[:, 1 if up == "y" else 2]
    assert baked.intensity[height > 0.9].min() > 0.2
    assert baked.intensity[height < -0.9].max() < 0.01


@pytest.mark.parametrize(
    ("size", "sentence"),
    [(b"-Y 99999999 +X 99999999", "can't hold"), (b"-Y 0 +X 8", "can't hold"),
     (b"-Y many +X 8", "doesn't say its size"), (b"-Y " + b"9" * 5000 + b" +X 8", "say its size")],
)  # fmt: skip
def test_a_size_that_the_file_cannot_hold_is_refused(tmp_path, size, sentence):
    path = tmp_path / "sky.hdr"
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + b"\n" + bytes(128))
    with pytest.raises(MeshdepictError, match=sentence):
        Environment.from_file(path)


def test_a_lit_sphere_may_be_a_radiance_picture(tmp_path, rng):
    from meshdepict.color.srgb import linear_to_srgb
    from meshdepict.shading.painted import sphere_picture

    rgbe = rng.integers(0, 256, (16, 16, 4), dtype=np.uint8)
    rgbe[..., 3] = rng.integers(125, 132, (16, 16))
    write_hdr(tmp_path / "clay.hdr", rgbe)
    path = str(tmp_path / "clay.hdr")
    shown = sphere_picture(path)
    np.testing.assert_array_equal(shown, linear_to_srgb(decoded(rgbe)))
    baked = md.bake(md.samples.sphere(200), "lit_sphere", sphere=path)
    assert np.isfinite(baked.intensity).all()


def test_each_light_stands_for_light_from_nearly_one_direction(rng):
    pixels = np.full((32, 64, 3), 0.02)  # a dim room with a bright window
    pixels[8:16, 20:28] = 5 * rng.uniform(0.5, 1, (8, 8, 1))
    environment, normals = Environment(pixels), unit(rng, 500)
    exact = exact_irradiance(environment, normals)
    lights = environment.lights(54)
    cosine = np.maximum(normals @ np.array([x.direction for x in lights]).T, 0)
    found = math.pi * cosine @ np.array([x.color for x in lights])
    # Measured: 0.0009, and 0.0025 with parts of equal power.
    assert np.sqrt(np.mean((found - exact) ** 2)) < 0.0015 * exact.max()


def test_a_picture_finer_than_what_is_cut_keeps_flux_and_direction():
    pixels = np.zeros((1024, 2048, 3), np.float32)
    pixels[300:302, 700:702] = 50
    environment = Environment(pixels)
    brightest = max(environment.lights(40), key=lambda light: light.color.sum())
    expected = environment._directions[300:302, 700:702].sum(axis=(0, 1))
    np.testing.assert_allclose(brightest.direction, expected / np.linalg.norm(expected), atol=1e-5)
    np.testing.assert_allclose(brightest.color * math.pi, environment.flux, rtol=1e-5)
