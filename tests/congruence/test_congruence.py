"""The congruence score: against its formula written out, and on scenes whose score is known."""

import itertools
import math

import numpy as np
import pytest

from meshdepict import congruence
from meshdepict.congruence.structure_tensor import structure_tensor
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View

REACH = 18  # three widths of both Gaussians, 3 + 15
ROUNDING = 1e-6  # structure tensors are in single precision


@pytest.fixture
def scene(rng):
    """A wavy relief on a disc: depth, mask, and its Lambertian shading from the upper right."""
    y, x = np.mgrid[:110, :124].astype(float)
    depth = sum(
        rng.uniform(0.5, 2)
        * np.sin(rng.uniform(-0.3, 0.3) * x + rng.uniform(-0.3, 0.3) * y + phase)
        for phase in range(6)
    )
    mask = np.hypot(x - 60, y - 53) < 51
    return depth, mask, lambert(depth, (0.5, -0.5, 0.7))


def lambert(depth, light):
    gy, gx = np.gradient(depth)
    normal = np.stack([-gx, -gy, np.ones_like(depth)]) / np.sqrt(1 + gx**2 + gy**2)
    return np.maximum(np.tensordot(np.array(light) / np.linalg.norm(light), normal, 1), 0)


def written_out(shading, depth, mask, reference):
    """Equation 2, pixel by pixel, for a depth without contours."""
    counted = [
        (row, column)
        for row in range(REACH, mask.shape[0] - REACH)
        for column in range(REACH, mask.shape[1] - REACH)
        if mask[row - REACH : row + REACH + 1, column - REACH : column + REACH + 1].all()
    ]

    def flow(image):
        tensor = structure_tensor(image)
        energies, directions = [], []
        for row, column in counted:
            xx, xy, yy = (float(plane[row - REACH, column - REACH]) for plane in tensor)
            values, vectors = np.linalg.eigh([[xx, xy], [xy, yy]])
            energies.append(values.mean())
            directions.append(vectors[:, 1])
        return np.array(energies), np.array(directions)

    (e_c, v_c), (e_s, v_s), (e_r, _) = flow(depth), flow(shading), flow(reference)
    e_c = np.minimum(e_c / np.percentile(e_c, 99), 1)
    e_s = e_s / np.percentile(e_r, 99)
    total = 0.0
    for c, s, v, w in zip(e_c, e_s, v_c, v_s, strict=True):
        total += c * (1 - min(max(c - s, 0), 1)) * abs(v @ w)
    return total / e_c.sum(), counted


def test_equals_the_formula_written_out(scene):
    depth, mask, shading = scene
    reference = lambert(depth, (0, 0, 1))
    expected, counted = written_out(shading, depth, mask, reference)
    assert 0.1 < expected < 0.95  # neither end
    found = congruence.flows(shading, depth, mask, reference=reference)
    assert sorted(map(tuple, np.argwhere(found.counted))) == counted
    assert found.score == pytest.approx(expected, abs=1e-4)


def test_the_parts_make_the_score(scene):
    depth, mask, shading = scene
    parts = congruence.flows(shading, depth, mask)
    along = np.abs(np.sum(parts.shape_direction * parts.shading_direction, axis=-1))
    missing = np.clip(parts.shape_energy - parts.shading_energy, 0, 1)
    np.testing.assert_allclose(parts.congruence, (1 - missing) * along, atol=ROUNDING)
    assert parts.score == pytest.approx(
        np.average(parts.congruence, weights=parts.shape_energy), abs=ROUNDING
    )
    assert np.percentile(parts.shape_energy[parts.counted], 99) == pytest.approx(1, abs=1e-3)
    for direction in (parts.shape_direction, parts.shading_direction):
        np.testing.assert_allclose(np.linalg.norm(direction, axis=-1), parts.counted, atol=ROUNDING)
    for part in parts[:4]:
        assert part.shape[:2] == depth.shape
        assert not part[~parts.counted].any()


def test_one_shot_and_judge_agree_and_leave_their_input_alone(scene):
    depth, mask, shading = scene
    for reference in (None, lambert(depth, (0, 0, 1))):
        judge = congruence.Judge(depth, mask, reference=reference)
        for image in (shading, lambert(depth, (1, 0, 0.2))):
            given = [a.copy() for a in (image, depth, mask)]
            one_shot = congruence.score(image, depth, mask, reference=reference)
            parts = congruence.flows(image, depth, mask, reference=reference)
            assert one_shot == parts.score == judge.score(image) == judge.flows(image).score
            np.testing.assert_array_equal(parts.counted, judge.counted)
            for before, after in zip(given, (image, depth, mask), strict=True):
                np.testing.assert_array_equal(before, after)


def test_the_depth_itself_is_congruent(scene):
    depth, mask, _ = scene
    for image in (depth, 1 - depth):
        assert congruence.score(image, depth, mask, reference=depth) == pytest.approx(1, abs=1e-6)
    # More contrast is exaggeration, which costs nothing; less does.
    scores = [congruence.score(k * depth, depth, mask, reference=depth) for k in (9, 0.7, 0.1)]
    assert scores[0] == pytest.approx(1, abs=1e-6)
    assert scores[0] > scores[1] > scores[2] > 0


def test_a_fainter_copy_loses_what_it_lacks():
    y, x = np.mgrid[:90, :90].astype(float)
    depth = 0.4 * x - 0.3 * y  # a ramp: every energy is 1
    mask = np.ones(x.shape, bool)
    for k in (0, 0.5, 0.9, 1, 2):
        found = congruence.score(k * depth, depth, mask, reference=depth)
        assert found == pytest.approx(min(k**2, 1), abs=ROUNDING)


@pytest.mark.parametrize("angle", [0, 30, 45, 60, 90])
def test_bands_at_an_angle_score_its_cosine(angle):
    y, x = np.mgrid[:90, :100].astype(float)
    turn = math.radians(angle)
    bands = math.cos(turn) * x + math.sin(turn) * y
    mask = np.ones(x.shape, bool)
    found = congruence.score(3 * bands, x, mask, reference=bands)
    assert found == pytest.approx(math.cos(turn), abs=ROUNDING)


def test_ridges_across_ridges_score_nothing():
    y, x = np.mgrid[:120, :100].astype(float)
    mask = np.ones(x.shape, bool)
    assert congruence.score(np.sin(y / 4), np.sin(x / 4), mask) == pytest.approx(0, abs=ROUNDING)
    assert congruence.score(9 * np.sin(x / 4), np.sin(x / 4), mask) == pytest.approx(
        1, abs=ROUNDING
    )


# --- the flow of the slope ------------------------------------------------------------------------


def normals_of(depth, steepness=1.0):
    gy, gx = np.gradient(depth * steepness)
    return np.stack([-gx, -gy, np.ones_like(depth)], axis=-1)


@pytest.mark.parametrize("steep", [0, 0.2, 3])
def test_a_plane_leans_but_does_not_bend(steep):
    y, x = np.mgrid[:90, :90].astype(float)
    depth = steep * (0.8 * x + 0.6 * y) + 7
    mask, shading = np.ones(x.shape, bool), np.sin(x / 4)
    normals = normals_of(depth).astype(np.float32)
    for given in (None, normals):
        found = congruence.flows(shading, depth, mask, flow="slope", reference=x, normals=given)
        assert found.score == 0
        assert not found.shape_energy.any()
    assert congruence.score(9 * shading, depth, mask, reference=x) > 0.5 or not steep


def test_a_leaning_ridge_bends_across_and_leans_along():
    """z = sin(x) + y leans along y as much as x; its slope varies along x alone."""
    y, x = np.mgrid[:100, :110].astype(float)
    depth = np.sin(x / 5) + 0.6 * y
    mask = np.ones(x.shape, bool)
    for given in (None, normals_of(depth)):
        found = congruence.flows(x, depth, mask, flow="slope", reference=x, normals=given)
        along = np.abs(found.shape_direction[found.counted])
        np.testing.assert_allclose(along, np.broadcast_to((1, 0), along.shape), atol=1e-5)
    leaning = congruence.flows(x, depth, mask, reference=x).shape_direction[found.counted]
    assert np.abs(leaning[:, 1]).min() > 0.9


def test_a_leaning_pipe_bends_around_its_axis():
    """The unit normal of a cylinder turns about its axis: it varies across the axis alone."""
    y, x = np.mgrid[-60:61, -80:81].astype(float)
    turn = math.radians(25)
    across = math.cos(turn) * x + math.sin(turn) * y
    mask = np.abs(across) < 45
    height = np.sqrt(np.maximum(50.0**2 - across**2, 1))
    normals = np.stack([math.cos(turn) * across, math.sin(turn) * across, height], axis=-1)
    depth = height + 0.7 * (math.cos(turn) * y - math.sin(turn) * x)  # cut aslant, along its axis
    found = congruence.flows(across, depth, mask, flow="slope", reference=across, normals=normals)
    directions = found.shape_direction[found.counted]
    assert np.abs(directions @ (math.cos(turn), math.sin(turn))).min() > 1 - 1e-5
    assert found.score == pytest.approx(1, abs=1e-4)  # n·l of a light across the axis is `across`


def test_the_tensors_of_the_slope_are_those_of_its_two_numbers_added(scene):
    depth, mask, shading = scene
    normals = normals_of(depth)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    found = congruence.flows(shading, depth, mask, flow="slope", normals=normals)
    parts = [structure_tensor(normals[..., channel]) for channel in (0, 1)]
    inner = found.counted[REACH:-REACH, REACH:-REACH]
    tensors = sum(
        np.stack([[p.xx, p.xy], [p.xy, p.yy]]).astype(float)[..., inner] for p in parts
    ).transpose(2, 0, 1)
    energy = np.trace(tensors, axis1=1, axis2=2)
    expected = np.minimum(energy / np.percentile(energy, 99), 1)
    np.testing.assert_allclose(found.shape_energy[found.counted], expected, atol=1e-4)
    along = np.linalg.eigh(tensors)[1][:, :, 1]
    match = np.abs(np.sum(along * found.shape_direction[found.counted], axis=1))
    assert np.quantile(match, 0.01) > 0.999


def test_estimated_normals_are_right_for_the_usual_slope(scene):
    depth, mask, shading = scene
    counted = congruence.Judge(depth, mask).counted
    gy, gx = np.gradient(depth)
    usual = 0.8 / math.sqrt(np.mean((gx**2 + gy**2)[counted]))
    given = normals_of(depth, usual)
    expected = congruence.flows(shading, depth, mask, flow="slope", normals=given)
    for k in (1, -1e-5, 1e4):  # whatever the unit and the sign
        found = congruence.flows(shading, k * depth + 3, mask, flow="slope")
        np.testing.assert_allclose(found.shape_energy, expected.shape_energy, atol=1e-4)
        assert found.score == pytest.approx(expected.score, abs=1e-4)


def test_signs_and_lengths_of_normals_do_not_matter(scene, rng):
    depth, mask, shading = scene
    normals = normals_of(depth)
    expected = congruence.score(shading, depth, mask, flow="slope", normals=normals)
    longer = normals * rng.uniform(0.1, 9, mask.shape)[..., None]
    beyond = np.where(mask[..., None], normals, np.nan)
    for other in (longer, normals * (1, -1, 1), -normals, beyond, 1e-30 * normals):
        found = congruence.score(shading, depth, mask, flow="slope", normals=other)
        assert found == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"flow": "tilt"}, "flow='tilt' is none of depth, slope"),
        ({"normals": np.ones((110, 124, 3))}, "flow='depth' reads no normals: leave them out"),
        (
            {"flow": "slope", "normals": np.ones((110, 124))},
            "normals must be a picture of 124x110 pixels with three numbers each",
        ),
        ({"flow": "slope", "normals": np.ones((110, 123, 3))}, "normals must be a picture of"),
        ({"flow": "slope", "normals": np.full((110, 124, 3), "x")}, "normals must be a picture of"),
        ({"flow": "slope", "normals": np.zeros((110, 124, 3))}, "no direction .* row 3, column 50"),
        ({"flow": "slope", "normals": np.full((110, 124, 3), np.inf)}, "have no direction"),
    ],
)
def test_a_flow_that_cannot_be_read_is_told_in_one_sentence(scene, given, sentence):
    depth, mask, shading = scene
    for function in (congruence.score, congruence.flows):
        with pytest.raises(MeshdepictError, match=sentence):
            function(shading, depth, mask, **given)


# --- what scores nothing --------------------------------------------------------------------------


@pytest.mark.parametrize("level", [0, 1, 0.1, -1e300])
def test_a_constant_shading_shows_nothing(scene, level):
    depth, mask, _ = scene
    assert congruence.score(np.full(depth.shape, level), depth, mask) == 0


@pytest.mark.parametrize("given", ["flat depth", "flat reference", "thin object"])
def test_what_has_no_flow_scores_nothing(scene, given):
    depth, mask, shading = scene
    reference = None
    if given == "flat depth":
        depth = np.full_like(depth, 5.1)
    elif given == "flat reference":
        reference = np.ones_like(depth)
    else:
        mask = mask & (np.arange(depth.shape[1]) // 30 % 2 == 0)
        assert not congruence.Judge(depth, mask).counted.any()
    found = congruence.flows(shading, depth, mask, reference=reference)
    assert found.score == 0
    assert all(np.isfinite(part).all() for part in found)


def test_units_and_offsets_do_not_matter(scene):
    depth, mask, shading = scene
    expected = congruence.score(shading, depth, mask)
    for a, b in [(1000, 0), (1e-5, 0), (1, 4e4), (-0.2, 7), (1e300, 1e299), (1e-300, 0)]:
        assert congruence.score(shading, a * depth + b, mask) == pytest.approx(expected, abs=1e-5)
    for offset in (0.3, -2, 1e5):
        found = congruence.score(shading + offset, depth, mask)
        assert found == pytest.approx(expected, abs=1e-5)
    reference = lambert(depth, (0, 0, 1))
    expected = congruence.score(shading, depth, mask, reference=reference)
    for k in (1e-200, 30, 1e200):
        found = congruence.score(k * shading, depth, mask, reference=k * reference)
        assert found == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("flow", ["depth", "slope"])
def test_the_scene_may_be_mirrored_and_turned(scene, flow):
    expected = congruence.score(scene[2], scene[0], scene[1], flow=flow)
    for move in (np.flipud, np.fliplr, np.rot90, np.transpose):
        depth, mask, shading = map(move, scene)
        found = congruence.score(shading, depth, mask, flow=flow)
        assert found == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("flow", ["depth", "slope"])
def test_nothing_beyond_the_object_matters(scene, rng, flow):
    depth, mask, shading = scene
    reference = lambert(depth, (0, 0, 1))
    for given in (None, reference):
        expected = congruence.flows(shading, depth, mask, reference=given, flow=flow)
        for beyond in (np.nan, np.inf, -1e308, rng.normal(size=depth.shape)):
            elsewhere = [np.where(mask, image, beyond) for image in (shading, depth, reference)]
            found = congruence.flows(
                *elsewhere[:2], mask, reference=None if given is None else elsewhere[2], flow=flow
            )
            for part, other in zip(found, expected, strict=True):
                np.testing.assert_array_equal(part, other)


def test_the_far_side_of_a_contour_does_not_matter(scene):
    depth, mask, shading = scene
    here = np.arange(depth.shape[1]) < 75
    behind = np.where(here, depth, depth - 60)
    other = np.where(here, depth, 0.5 * depth[::-1] - 90)
    found = [congruence.Judge(image, mask, reference=shading).counted for image in (behind, other)]
    np.testing.assert_array_equal(*found)
    near = found[0] & here
    assert near.any()
    columns = np.flatnonzero(near.any(axis=0))
    assert columns[-1] == 74 - REACH - 1  # pixel 74 is on the contour
    first, second = (congruence.flows(shading, image, mask) for image in (behind, other))
    np.testing.assert_allclose(
        np.abs(np.sum(first.shape_direction * second.shape_direction, axis=-1))[near], 1, atol=1e-5
    )


def test_colours_count_by_their_luminance(scene):
    depth, mask, shading = scene
    weights = np.array([0.2126, 0.7152, 0.0722])
    tint = np.array([0.9, 0.2, 0.4])
    found = congruence.score(shading[..., None] * tint, depth, mask)
    assert found == pytest.approx(congruence.score(shading * (tint @ weights), depth, mask))
    # A change of hue alone is no shading.
    hue = np.stack([shading / weights[0], -shading / weights[1], np.ones_like(shading)], -1)
    assert congruence.score(hue, depth, mask, reference=shading) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.int32, bool])
def test_any_numbers_are_taken(scene, kind):
    depth, mask, shading = scene
    found = congruence.score((9 * shading).astype(kind), depth.astype(kind), mask.astype(np.uint8))
    assert 0 <= found <= 1


@pytest.mark.filterwarnings("error")
def test_every_finite_input_gives_a_finite_score(rng):
    largest = np.finfo(float).max
    images = [
        rng.normal(size=(40, 45)),
        largest * rng.choice([-1.0, 0, 1], (40, 45)),
        5e-324 * rng.integers(0, 3, (40, 45)),
        np.where(rng.random((40, 45)) < 0.01, 1e30, rng.random((40, 45))),
        1 + np.finfo(float).eps * rng.integers(0, 2, (40, 45)),
    ]
    mask = np.ones((40, 45), bool)
    for depth, flow in itertools.product(images, ("depth", "slope")):
        for reference in [None, *images]:
            judge = congruence.Judge(depth, mask, reference=reference, flow=flow)
            for shading in images:
                parts = judge.flows(shading)
                assert 0 <= parts.score <= 1
                assert all(np.isfinite(part).all() for part in parts)


def test_the_estimated_reference_is_right_for_the_usual_slope(scene):
    """A relief of root mean square slope 0.8 gets the reference that was drawn from it."""
    depth, mask, shading = scene
    counted = congruence.Judge(depth, mask).counted
    gy, gx = np.gradient(depth)
    depth = depth * 0.8 / math.sqrt(np.mean((gx**2 + gy**2)[counted]))
    reference = lambert(depth, (0, 0, 1))
    expected = congruence.flows(shading, depth, mask, reference=reference)
    found = congruence.flows(shading, depth, mask)
    np.testing.assert_allclose(found.shading_energy, expected.shading_energy, rtol=1e-5)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"mask": np.zeros((110, 124), bool)}, "the mask is empty"),
        ({"mask": np.ones(5)}, r"mask must be a picture of shape \(h, w\), not float64 of shape"),
        ({"mask": np.full((110, 124), "x")}, "mask must be a picture"),
        ({"depth": np.zeros((110, 123))}, "depth has 123x110 pixels, the mask 124x110"),
        ({"shading": np.zeros((109, 124, 3))}, "shading has 124x109 pixels, the mask 124x110"),
        ({"reference": np.zeros((1, 1))}, "reference has 1x1 pixels"),
        (
            {"depth": np.zeros((110, 124, 3))},
            r"depth must be a picture of numbers of shape \(h, w\),",
        ),
        ({"shading": np.zeros((110, 124, 4))}, r"of shape \(h, w\) or \(h, w, 3\), not float64"),
        ({"shading": np.zeros((110, 124), complex)}, "picture of numbers .* not complex128"),
        ({"shading": np.zeros((110, 124), np.uint8)}, "shading is 8-bit; give linear values"),
        ({"reference": np.zeros((110, 124, 3), np.uint8)}, "reference is 8-bit"),
        (
            {"shading": np.nan},
            "shading is NaN or infinite inside the mask, first at row 50, column 60",
        ),
        ({"depth": np.inf}, "depth is NaN or infinite inside the mask, first at row 50, column 60"),
    ],
)
def test_wrong_input_is_told_in_one_sentence(scene, change, sentence):
    depth, mask, shading = scene
    given = {"depth": depth, "mask": mask, "shading": shading, "reference": None}
    for name, value in change.items():
        if np.ndim(value) == 0:
            given[name] = given[name].copy()
            given[name][50, 60] = given[name][51, 2:9] = value
        else:
            given[name] = value
    with pytest.raises(MeshdepictError, match=sentence) as raised:
        congruence.score(**given)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("shape", [(1, 1), (36, 200), (200, 36)])
def test_a_picture_smaller_than_a_window_is_refused(shape):
    image = np.ones(shape)
    size = f"{shape[1]}x{shape[0]} pixels is too small, at least 37x37"
    with pytest.raises(MeshdepictError, match=size):
        congruence.score(image, image, image)
    assert congruence.score(np.ones((37, 37)), np.ones((37, 37)), np.ones((37, 37))) == 0


def test_the_lights_go_right_over_the_top_and_left():
    lights = congruence.light_directions()
    assert [light.name for light in lights] == [f"#{i}" for i in range(1, 22)]
    towards = np.array([light.direction for light in lights])
    polar = np.degrees(np.arccos(towards[:, 2]))
    outwards = np.arange(15, 106, 15)
    np.testing.assert_allclose(polar, [*outwards, *outwards[::-1], *outwards], atol=1e-9)
    assert (towards[:7, 0] > 0).all()
    assert (towards[7:14, 1] > 0).all()
    assert (towards[14:, 0] < 0).all()
    for run, axis in ((slice(0, 7), 1), (slice(7, 14), 0), (slice(14, 21), 1)):
        np.testing.assert_allclose(towards[run, axis], 0, atol=1e-12)


def test_the_lights_follow_the_view():
    view = View(position=(3, 4, 5), focus=(0, 1, 0), up=(0, 1, 1), parallel_scale=1)
    seen = [light.direction @ view.frame.T for light in congruence.light_directions(view)]
    front = [light.direction for light in congruence.light_directions()]
    np.testing.assert_allclose(seen, front, atol=1e-12)


def test_the_picture_runs_from_red_to_blue_and_is_clear_elsewhere():
    x = np.arange(70) * np.ones((60, 1))
    mask = x > 3
    colors = {}
    for k in (0, 0.5**0.5, 1):
        parts = congruence.flows(k * x, x, mask, reference=x)
        image = congruence.picture(parts)
        assert image.dtype == np.uint8
        assert image.shape == (60, 70, 4)
        np.testing.assert_array_equal(image[..., 3], 255 * parts.counted)
        assert not image[~parts.counted].any()
        colors[k] = image[30, 35].astype(int)
    assert colors[0][0] > colors[0][2] + 100
    assert colors[1][2] > colors[1][0] + 100
    assert min(colors[0.5**0.5][:3]) > 150
