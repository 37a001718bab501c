"""Transfer functions are lines between their points, in the volume's own numbers."""

import numpy as np
import pytest

from meshdepict.color.transfer import PRESETS, TransferFunction, for_volume, landmarks, preset
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.volumes import read_volume
from meshdepict.samples.phantom import ct_phantom
from meshdepict.shapes.volume import Volume

POINTS = [
    (-100, 0.0, (1.0, 0.0, 0.0)),
    (100, 0.5, (0.0, 1.0, 0.0)),
    (300, 1.0, (0.0, 0.5, 1.0)),
]


@pytest.fixture(scope="module")
def head():
    return ct_phantom((60, 60, 60))


def raw_of(volume, slope, intercept, kind="i2"):
    """A volume of the raw numbers whose Hounsfield units are given."""
    return Volume(np.rint((volume.values - intercept) / slope).astype(kind), spacing=volume.spacing)


def test_points_are_met_lines_are_between_and_ends_stay():
    function = TransferFunction(POINTS)
    values = np.array([-5000.0, -100, 0, 100, 200, 300, 9999])
    np.testing.assert_allclose(function.opacity(values), [0, 0, 0.25, 0.5, 0.75, 1, 1])
    np.testing.assert_allclose(function.color(100), (0, 1, 0))
    np.testing.assert_allclose(function.color([[0, 200]]), [[(0.5, 0.5, 0), (0, 0.75, 0.5)]])
    assert function.color(np.zeros((2, 3, 4))).shape == (2, 3, 4, 3)
    assert function.opacity(values).dtype == np.float32


@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2"])
def test_tables_of_integers_are_exact(kind):
    function = TransferFunction(POINTS)
    ends = np.iinfo(kind)
    every = np.arange(ends.min, ends.max + 1).astype(kind)
    every = np.resize(every, (3, 70_000))[:, ::-1]  # enough for a table; not contiguous, too
    np.testing.assert_array_equal(function.opacity(every), function.opacity(every.astype(float)))
    np.testing.assert_array_equal(function.color(every), function.color(every.astype(float)))


def test_gradient_opacity_hides_even_regions():
    function = TransferFunction(POINTS, gradient_opacity=[(10, 0), (30, 1)])
    np.testing.assert_allclose(function.opacity([300] * 4, [0, 10, 20, 40]), [0, 0, 0.5, 1])
    np.testing.assert_array_equal(function.opacity(300), 1)
    np.testing.assert_array_equal(TransferFunction(POINTS).opacity(300, gradient=0), 1)


def test_colors_are_numbers_or_hexadecimal():
    function = TransferFunction([(0, 0, "#ff8000"), (1, 1, [0, 0.2, 1])])
    np.testing.assert_allclose(function.colors, [(1, 128 / 255, 0), (0, 0.2, 1)])
    assert repr(function) == "<TransferFunction 'custom': 2 points, 0 … 1 HU>"


def test_raw_numbers_see_what_their_hounsfield_units_would(rng):
    function = TransferFunction(POINTS, gradient_opacity=[(0, 0), (100, 1)])
    raw = function.in_raw_numbers(0.5, -1000)
    values, gradient = rng.uniform(0, 4000, 99), rng.uniform(0, 300, 99)
    np.testing.assert_allclose(
        raw.opacity(values, gradient),
        function.opacity(0.5 * values - 1000, 0.5 * gradient),
        atol=1e-6,
    )
    np.testing.assert_allclose(raw.color(values), function.color(0.5 * values - 1000), atol=1e-6)
    assert raw.unit == "raw"
    with pytest.raises(MeshdepictError, match="is one of raw numbers"):
        raw.in_raw_numbers(1, 0)
    with pytest.raises(MeshdepictError, match="take a positive slope"):
        function.in_raw_numbers(0, 0)


# --- files ----------------------------------------------------------------------------------


def test_toml_round_trip_is_exact(tmp_path, rng):
    points = [
        (v, o, c) for v, o, c in zip([-0.1, 7, 1e5], rng.random(3), rng.random((3, 3)), strict=True)
    ]
    for gradient in (None, [(0, 0.1), (3, 1 / 3)]):
        function = TransferFunction(
            points, gradient_opacity=gradient, name='a "b" ü', unit="raw", material=77.5
        )
        function.to_toml(tmp_path / "a.toml")
        read = TransferFunction.from_toml(tmp_path / "a.toml")
        for name in ("values", "opacities", "colors"):
            np.testing.assert_array_equal(getattr(read, name), getattr(function, name))
        assert (read.name, read.unit, read.material) == (function.name, "raw", 77.5)
        np.testing.assert_array_equal(read.gradient_opacity, function.gradient_opacity)


def test_the_documented_file_is_read(tmp_path):
    lines = TransferFunction.from_toml.__doc__.split("The file holds::")[1].split("Raises")[0]
    (tmp_path / "enamel.toml").write_text(lines, encoding="utf-8")
    function = TransferFunction.from_toml(tmp_path / "enamel.toml")
    assert function.name == "enamel"
    assert len(function.values) == 2
    assert function.gradient_opacity.shape == (2, 2)


def test_a_file_without_a_name_is_called_as_the_file(tmp_path):
    text = "points = [{value=0, opacity=0, color='#000000'}, {value=1, opacity=1, color='#ffffff'}]"
    (tmp_path / "mine.toml").write_text(text)
    assert TransferFunction.from_toml(tmp_path / "mine.toml").name == "mine"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("points = [", "is no transfer function in TOML"),
        ("pionts = []", "have no 'pionts'; did you mean 'points'"),
        ("", r"points must be a list of \{ value, opacity, color \}"),
        ("points = [1, 2]", "points must be a list"),
        ("points = [{value=1, opacity=0}]", "points must be a list"),
        ("points = [{value=1, opacity=0, color='red'}]", r"points are \(value, opacity"),
    ],
)
def test_wrong_files_are_refused_by_name(tmp_path, text, sentence):
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(MeshdepictError, match=rf"a\.toml.*{sentence}"):
        TransferFunction.from_toml(tmp_path / "a.toml")


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(MeshdepictError, match=r"none\.toml can't be read: No such file"):
        TransferFunction.from_toml(tmp_path / "none.toml")


@pytest.mark.parametrize(
    ("points", "options", "sentence"),
    [
        (POINTS[:1], {}, "at least two points"),
        ([], {}, "at least two points"),
        (POINTS[::-1], {}, "by rising first number"),
        ([POINTS[0], POINTS[0]], {}, "by rising first number"),
        ([(0, 0, (0, 0)), (1, 1, (1, 1))], {}, r"points are \(value, opacity, \(r, g, b\)\)"),
        ([(0, 0, "#xyz"), (1, 1, "#fff")], {}, r"points are"),
        ([(0, np.nan, "#000000"), (1, 1, "#ffffff")], {}, "finite numbers"),
        ([(0, -0.1, "#000000"), (1, 1, "#ffffff")], {}, r"opacity or colour is not in 0 … 1"),
        ([(0, 0, (0, 0, 255)), (1, 1, "#ffffff")], {}, r"opacity or colour is not in 0 … 1"),
        (POINTS, {"unit": "hu"}, "unit='hu' is neither 'HU' nor 'raw'"),
        (POINTS, {"material": -1000}, "material=-1000 is not a number above air's"),
        (POINTS, {"material": "x"}, "material='x' is not a number above air's"),
        (POINTS, {"gradient_opacity": [(0, 1)]}, r"gradient opacity is \(magnitude, factor\)"),
        (POINTS, {"gradient_opacity": [(0, 1), (1, 2)]}, "its factor not in 0 … 1"),
        (POINTS, {"gradient_opacity": [(-1, 1), (1, 1)]}, "magnitude is negative"),
    ],
)
def test_wrong_functions_are_refused(points, options, sentence):
    with pytest.raises(MeshdepictError, match=f"the transfer function 'custom'.*{sentence}"):
        TransferFunction(points, **options)


# --- presets --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", PRESETS)
def test_presets_leave_air_clear_and_are_named(name):
    function = preset(name)
    assert function.name == name
    assert function.unit == "HU"
    assert function.opacity(-1000) == 0
    assert function.opacities.max() > 0.3


@pytest.mark.parametrize(
    ("name", "seen", "hidden"),
    [
        ("bone", {"hard bone": 1000}, {"muscle": 60, "brain": 40, "fat": -90}),
        ("skin", {"skin": 60, "fat": -90}, {"lung": -800}),
        ("muscle", {"muscle": 60}, {"fat": -90, "lung": -800}),
        ("lung", {"vessel's rim": -450}, {"muscle": 60, "fat": -90, "bone": 1000}),
        ("micro-ct", {"mineral": 1500}, {"plastic foam": -900, "water": 0}),
    ],
)
def test_presets_show_their_tissue_and_hide_others(name, seen, hidden):
    function = preset(name)
    assert all(function.opacity(value) > 0.3 for value in seen.values())
    assert all(function.opacity(value) == 0 for value in hidden.values())


def test_every_preset_of_the_file_is_offered():
    from meshdepict.color.transfer import _presets

    assert tuple(_presets()) == PRESETS
    with pytest.raises(
        MeshdepictError, match=r"no transfer function is called 'bones'; did you mean 'bone'"
    ):
        preset("bones")


def test_hounsfield_volumes_get_the_preset_itself(head, tmp_path):
    assert for_volume("bone", head) is preset("bone")
    TransferFunction(POINTS, name="mine").to_toml(tmp_path / "mine.toml")
    assert for_volume(str(tmp_path / "mine.toml"), head).name == "mine"
    assert for_volume(tmp_path / "mine.toml", head).name == "mine"
    own = TransferFunction(POINTS, unit="raw")
    assert for_volume(own, raw_of(head, 1, -1024)) is own


@pytest.mark.parametrize(("slope", "intercept"), [(1, -1024), (0.5, -1000), (12.0, -1010)])
@pytest.mark.parametrize("name", ["bone", "skin", "muscle"])
def test_raw_numbers_are_placed_by_air_and_tissue(head, name, slope, intercept):
    raw = raw_of(head, slope, intercept)
    with pytest.warns(MeshdepictWarning, match=f"for '{name}' air is taken as .* give both if"):
        found = for_volume(name, raw)
    exact = for_volume(name, raw, slope=slope, intercept=intercept)
    # Brain and muscle, most of the head, have 28 … 60 HU instead of 40, and rounding adds half a
    # raw number: 20 HU and slope/2 at tissue, a fiftieth of what lies above it.
    assert abs(slope * (found.values - exact.values)).max() < 20 + slope + 0.02 * 3500
    agree = (found.opacity(raw.values) > 0) == (exact.opacity(raw.values) > 0)
    assert agree.mean() > 0.99


def test_landmarks_are_the_medians_of_two_classes(rng):
    values = np.where(rng.random((20, 20, 20)) < 0.6, 5, 90).astype(np.uint8)
    values[0, 0] += 1
    assert landmarks(Volume(values)) == (5, 90)
    assert landmarks(Volume(np.arange(8).reshape(2, 2, 2) // 4)) == (0, 1)


def test_offset_numbers_are_taken_as_hounsfield_units(head):
    unsaid = Volume(head.values)
    with pytest.warns(MeshdepictWarning, match="with numbers from -1000 on they are taken as"):
        found = for_volume("bone", unsaid)
    np.testing.assert_array_equal(found.values, preset("bone").values)
    assert found.unit == "raw"


@pytest.mark.parametrize(
    ("given", "slope", "intercept"), [({"slope": 2}, 2, 0), ({"intercept": -9}, 1, -9)]
)
def test_one_of_slope_and_intercept_is_enough(head, given, slope, intercept):
    found = for_volume("bone", raw_of(head, 1, -1024), **given)
    np.testing.assert_allclose(found.values, (preset("bone").values - intercept) / slope)


def test_units_that_do_not_match_are_refused(head):
    own = TransferFunction(POINTS, unit="raw")
    with pytest.raises(MeshdepictError, match="is one of raw numbers, but the volume is in Houns"):
        for_volume(own, head)
    with pytest.raises(MeshdepictError, match="the volume is in Hounsfield units already"):
        for_volume("bone", head, slope=1)
    with pytest.raises(MeshdepictError, match="the transfer function is in raw numbers"):
        for_volume(own, raw_of(head, 1, -1024), intercept=0)


def test_the_real_head_shows_skull_and_face(data):
    head = read_volume(data / "ct" / "ct_headsq_64x64x93.nrrd")
    for name, isovalue in (("skin", 500), ("bone", 1150)):  # VTK's usual ones for this head
        with pytest.warns(MeshdepictWarning, match="air is taken as 99"):
            found = for_volume(name, head)
        visible = found.opacity(head.values) > 0.1
        wanted = head.values > isovalue
        assert (visible == wanted).mean() > 0.98
    air, tissue = landmarks(head)
    assert air < 130
    assert 1000 < tissue < 1100


# --- presets that don't fit -----------------------------------------------------------------


def test_a_preset_for_stone_says_so_of_raw_soft_tissue(head):
    raw = raw_of(head, 1, -1024)
    with pytest.warns(MeshdepictWarning, match="'micro-ct' shows nearly all of it as a block, and"):
        for_volume("micro-ct", raw)
    with pytest.warns(MeshdepictWarning, match="give both if you know them$"):
        for_volume("bone", raw)
    stone = np.where(head.values > -200, 2000, 0) + np.indices(head.values.shape)[0] % 7
    with pytest.warns(MeshdepictWarning, match="give both if you know them$"):
        for_volume("micro-ct", Volume(stone))


def test_real_tissue_and_a_real_engine_are_told_apart(data):
    head = read_volume(data / "ct" / "ct_headsq_64x64x93.nrrd")
    engine = read_volume(data / "ct" / "ct_engine_256x256x128.nrrd")
    for volume, end in ((head, "suit it better$"), (engine, "if you know them$")):
        with pytest.warns(MeshdepictWarning, match=end):
            for_volume("micro-ct", volume)


def test_a_preset_that_shows_nearly_everything_names_another():
    # A specimen that fills the grid: tissue of 40 HU with some bone, and no air round it.
    values = np.full((20, 20, 20), 40, np.int16)
    values[5:9, 5:9, 5:9] = 900
    volume = Volume(values, hounsfield=True)
    shown = r"'skin' shows nearly everything, 100% of all voxels, as a block; 'bone' shows 1%"
    with pytest.warns(MeshdepictWarning, match=shown):
        assert for_volume("skin", volume) is preset("skin")
    assert for_volume("bone", volume) is preset("bone")
    even = Volume(np.arange(2000, 2008, dtype=np.int16).reshape(2, 2, 2), hounsfield=True)
    with pytest.warns(MeshdepictWarning, match="100% of all voxels, as a block$"):
        for_volume("bone", even)
