"""The sRGB curve, the 256 levels, the colour maps and the albedo keep their promises."""

import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest

from meshdepict import MeshdepictError
from meshdepict.color.colormaps import colormap
from meshdepict.color.encoding import apply_colormap, encode, multiply_albedo
from meshdepict.color.srgb import linear_to_srgb, quantise, srgb_to_linear

RAMP = np.linspace(0, 1, 100_001)
BUILT_IN = ["gray", "sepia", "stone", "gooch"]


# --- the curve ------------------------------------------------------------------------------


def test_curve_has_the_values_of_the_standard():
    # IEC 61966-2-1: middle grey 0.5 decodes to 0.2140, 18 % grey encodes to 0.4614.
    assert srgb_to_linear(0.5) == pytest.approx(0.2140411, abs=1e-7)
    assert linear_to_srgb(0.18) == pytest.approx(0.4613561, abs=1e-7)
    assert linear_to_srgb(0.001) == pytest.approx(0.01292)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_curve_and_inverse_cancel(dtype):
    ramp = RAMP.astype(dtype)
    few_roundings = 8 * np.finfo(dtype).eps  # a power amplifies the rounding of its base by 2.4
    for there, back in ((linear_to_srgb, srgb_to_linear), (srgb_to_linear, linear_to_srgb)):
        assert back(there(ramp)).dtype == dtype
        np.testing.assert_allclose(back(there(ramp)), ramp, rtol=0, atol=few_roundings)


@pytest.mark.parametrize("curve", [linear_to_srgb, srgb_to_linear])
def test_curve_rises_from_0_to_1_also_where_its_branches_meet(curve):
    knee, half = {linear_to_srgb: (0.0031307, 2e-7), srgb_to_linear: (0.040449, 3e-6)}[curve]
    close = np.linspace(knee - half, knee + half, 10_001)  # with the knee as the standard has it
    assert (np.diff(curve(RAMP)) > 0).all()
    assert (np.diff(curve(close)) > 0).all()
    assert np.diff(curve(close), 2).max() < 1e-10  # no step
    assert curve(0.0) == 0
    assert curve(1.0) == 1


@pytest.mark.parametrize("function", [linear_to_srgb, srgb_to_linear, quantise])
def test_values_outside_are_clipped_and_nan_is_black(function):
    wild = np.array([-1.0, -np.inf, np.nan, 2.0, np.inf])
    np.testing.assert_array_equal(function(wild), function([0.0, 0.0, 0.0, 1.0, 1.0]))


# --- levels ---------------------------------------------------------------------------------


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_levels_round_half_up(dtype):
    levels = np.arange(256)
    assert quantise(levels.astype(dtype) / dtype(255)).tolist() == levels.tolist()
    assert quantise(dtype(0.5)) == 128  # 127.5
    assert quantise(np.array([100.4, 100.6], dtype) / dtype(255)).tolist() == [100, 101]
    assert (np.diff(quantise(RAMP.astype(dtype)).astype(int)) >= 0).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_table_of_levels_is_the_curve(dtype):
    # At random, and just beside every one of the 255 thresholds.
    thresholds = srgb_to_linear((np.arange(1, 256) - 0.5) / 255)
    beside = thresholds[:, None] * (1 + np.array([-1e-6, 1e-6]))
    values = np.concatenate((np.random.default_rng(3).random(100_000), beside.ravel(), [0, 1]))
    above = np.searchsorted(thresholds[:-1], values)
    nearest = thresholds[np.stack((np.maximum(above - 1, 0), above))]
    values = values[np.abs(values / nearest - 1).min(axis=0) > 5e-7]  # float32 decides
    exact = quantise(linear_to_srgb(values))
    np.testing.assert_array_equal(encode(values.astype(dtype), linear=True)[:, 0], exact)


# --- encoding -------------------------------------------------------------------------------


@pytest.mark.parametrize("linear", [True, False])
def test_encoding_keeps_black_and_white_and_order(linear):
    colors = encode(RAMP, linear=linear)
    assert colors.shape == (len(RAMP), 3)
    assert colors.dtype == np.uint8
    assert colors[0].tolist() == [0, 0, 0]
    assert colors[-1].tolist() == [255, 255, 255]
    assert (np.diff(colors.astype(int), axis=0) >= 0).all()
    np.testing.assert_array_equal(np.unique(colors), np.arange(256))


@pytest.mark.parametrize("linear", [True, False])
def test_gray_is_the_same_as_equal_rgb_and_as_the_gray_map(linear):
    gray = encode(RAMP, linear=linear)
    np.testing.assert_array_equal(encode(np.repeat(RAMP[:, None], 3, axis=1), linear=linear), gray)
    np.testing.assert_array_equal(encode(RAMP, linear=linear, colormap="gray"), gray)


def test_linear_values_are_encoded_before_the_colour_map():
    expected = apply_colormap(linear_to_srgb(RAMP), "gooch")
    np.testing.assert_array_equal(encode(RAMP, linear=True, colormap="gooch"), expected)


def test_nothing_to_encode_is_fine():
    assert encode(np.empty(0), linear=True).shape == (0, 3)
    assert encode(np.empty((0, 3)), linear=False).shape == (0, 3)


@pytest.mark.parametrize("shape", [(), (4, 2), (2, 3, 3)])
def test_other_shapes_are_refused(shape):
    with pytest.raises(MeshdepictError, match=r"shape \(n,\) or \(n, 3\)"):
        encode(np.zeros(shape), linear=True)


def test_a_colour_map_for_colours_is_refused():
    with pytest.raises(MeshdepictError, match="'sepia' needs one value per point"):
        encode(np.zeros((4, 3)), linear=True, colormap="sepia")


# --- colour maps ----------------------------------------------------------------------------


def lightness(colors):
    luminance = srgb_to_linear(colors / 255) @ (0.2126, 0.7152, 0.0722)
    return np.where(luminance > 216 / 24389, 116 * np.cbrt(luminance) - 16, luminance * 24389 / 27)


@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in_maps_grow_evenly_lighter(name):
    table = colormap(name)
    assert table.shape == (256, 3)
    assert table.dtype == np.uint8
    steps = np.diff(lightness(table)[::8])
    assert steps.min() > 0.5 * steps.mean()
    assert steps.max() < 1.5 * steps.mean()
    assert np.ptp(lightness(table)) > 80  # of 100: a plate needs the contrast


def test_gray_map_changes_nothing():
    np.testing.assert_array_equal(colormap("gray"), np.arange(256)[:, None].repeat(3, axis=1))


def test_gooch_map_runs_from_blue_to_yellow():
    blue, yellow = colormap("gooch")[[0, -1]].astype(int)
    assert blue[2] > 2 * max(blue[:2])
    assert min(yellow[:2]) > yellow[2] + 80


@pytest.mark.parametrize("name", [*BUILT_IN, "viridis"])
def test_reversed_maps(name):
    np.testing.assert_array_equal(colormap(f"{name}_r"), colormap(name)[::-1])


def test_colours_are_looked_up_by_level():
    values = np.random.default_rng(0).random(1000)
    expected = colormap("stone")[quantise(values)]
    np.testing.assert_array_equal(apply_colormap(values, "stone"), expected)
    assert apply_colormap([0.0, 1.0], "stone").tolist() == colormap("stone")[[0, -1]].tolist()


def test_tables_cannot_be_spoilt():
    with pytest.raises(ValueError, match="read-only"):
        colormap("sepia")[0] = 0


def test_maps_of_matplotlib_are_its_own():
    matplotlib = pytest.importorskip("matplotlib")
    for name in ("viridis", "RdBu", "tab10"):
        theirs = matplotlib.colormaps[name](np.linspace(0, 1, 256))[:, :3]
        assert np.abs(colormap(name) / 255 - theirs).max() <= 0.5 / 255 + 1e-12
    np.testing.assert_array_equal(colormap("mpl.viridis"), colormap("viridis"))


@pytest.mark.parametrize(
    ("package", "name", "prefixed"),
    [
        ("cmcrameri", "batlow", "cmc.batlow"),
        ("colorcet", "fire", "cet_fire"),
        ("cmocean", "thermal", "cmo.thermal"),
    ],
)
def test_maps_of_other_packages(package, name, prefixed):
    if find_spec(package) is None:  # not importorskip: the import of cmocean warns
        pytest.skip(f"{package} is not installed")
    np.testing.assert_array_equal(colormap(name), colormap(prefixed))
    assert len(np.unique(colormap(name), axis=0)) > 200


@pytest.mark.parametrize(
    ("wrong", "nearest"), [("seipa", "sepia"), ("viridus", "viridis"), ("goch", "gooch")]
)
def test_unknown_maps_are_refused_with_the_nearest(wrong, nearest):
    with pytest.raises(MeshdepictError, match=f"no colour map '{wrong}'; did you mean '{nearest}'"):
        colormap(wrong)


def test_packages_of_maps_are_imported_only_on_demand():
    code = (
        "import sys; from meshdepict.color.encoding import encode\n"
        "for name in (None, 'gray', 'sepia', 'stone_r', 'gooch'):\n"
        "    encode([0.5], linear=True, colormap=name)\n"
        "packages = {'matplotlib', 'cmcrameri', 'colorcet', 'cmocean', 'scipy', 'pyvista', 'vtk'}\n"
        "print(sorted(packages & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


# --- albedo ---------------------------------------------------------------------------------


@pytest.fixture
def albedo():
    return np.random.default_rng(5).integers(0, 256, (2000, 3), dtype=np.uint8)


@pytest.mark.parametrize("linear", [True, False])
def test_full_light_shows_the_colours_and_none_black(albedo, linear):
    ones, zeros = np.ones(len(albedo)), np.zeros(len(albedo))
    np.testing.assert_array_equal(multiply_albedo(ones, albedo, linear=linear), albedo)
    assert not multiply_albedo(zeros, albedo, linear=linear).any()


@pytest.mark.parametrize("linear", [True, False])
def test_white_shows_the_shading(linear):
    white = np.full((len(RAMP), 3), 255, np.uint8)
    found = multiply_albedo(RAMP, white, linear=linear)
    levels = np.abs(found.astype(int) - encode(RAMP, linear=linear))
    assert levels.max() <= 1  # a value within a rounding of a threshold may fall to either side
    assert (levels > 0).mean() < 1e-3


def test_light_is_multiplied_in_linear_light(albedo):
    light = np.random.default_rng(6).random(len(albedo))
    expected = linear_to_srgb(light[:, None] * srgb_to_linear(albedo / 255))
    found = multiply_albedo(light, albedo, linear=True)
    assert np.abs(found / 255 - expected).max() < 0.5001 / 255
    np.testing.assert_array_equal(
        multiply_albedo(np.repeat(light[:, None], 3, axis=1), albedo, linear=True), found
    )


def test_colours_of_other_types_are_the_same_colours(albedo):
    light = np.random.default_rng(7).random(len(albedo))
    found = multiply_albedo(light, albedo, linear=True)
    wide = albedo.astype(np.uint16) * 257  # 255 → 65535
    for same in (wide, albedo / 255, (albedo / 255).astype(np.float32)):
        other = multiply_albedo(light, same, linear=True)
        assert np.abs(other.astype(int) - found).max() <= 1
        assert (other != found).mean() < 1e-3


@pytest.mark.parametrize("wrong", [np.zeros((4, 4)), np.zeros((3, 3)), np.zeros(4)])
def test_albedo_of_another_shape_is_refused(wrong):
    with pytest.raises(MeshdepictError, match="one RGB colour for each of 4 points"):
        multiply_albedo(np.ones(4), wrong, linear=True)


@pytest.mark.parametrize(
    "wrong", [np.full((4, 3), 255.0), np.full((4, 3), np.nan), np.full((4, 3), -1)]
)
def test_albedo_out_of_range_is_refused(wrong):
    with pytest.raises(MeshdepictError, match="unsigned integers over their full range or floats"):
        multiply_albedo(np.ones(4), wrong, linear=True)
