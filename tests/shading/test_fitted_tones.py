"""Exaggerated Shading that follows the shape: what it promises of tones, and how it is told."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.seen_side import SeenSide
from meshdepict.scene.names import as_light
from meshdepict.scene.view import View
from meshdepict.shading import exaggerated, half_lambert
from meshdepict.shading.bands import band_weights
from meshdepict.shading.fitted_tones import (
    CONFORMITY,
    SATURATED,
    STEEPEST,
    fitted_tones,
    tone_moments,
)
from meshdepict.shapes import samples
from meshdepict.surface.icosahedron import icosphere

TODAY = {"exaggeration": 15.0}  # one for all scales, and the paper's base coat


def ellipsoid(vertices):
    points, faces = icosphere(vertices)
    return md.Mesh(points * [1.0, 1.4, 0.8], faces)


def smooth_and_rough():
    return {
        "ellipsoid": ellipsoid(2_500),
        "golf ball": samples.golf_ball(4_000),
        "torus": samples.torus(2_500),
        "ridges": samples.radiating_ridges(2_500, hill=0.15),
    }


@pytest.fixture(scope="module")
def spaces():
    return {name: md.scale_space(mesh, scales=9) for name, mesh in smooth_and_rough().items()}


def conformity(space, values, view):
    """Correlation with half-Lambert under the northwest light over what faces the eye."""
    light = as_light("northwest", view)
    lambert = half_lambert(space, light)
    seen = np.maximum(space.normals[0] @ view.towards_eye, 0)
    pair = np.cov(values, lambert, aweights=seen)
    return pair[0, 1] / np.sqrt(pair[0, 0] * pair[1, 1])


# --- what the numbers are for -------------------------------------------------------------------


@pytest.mark.parametrize("vertices", [2_500, 10_000])
@pytest.mark.parametrize("eye", ["front", "left", "top"])
def test_on_a_smooth_ellipsoid_broad_tones_follow_the_light(vertices, eye):
    mesh = ellipsoid(vertices)
    space, view = md.scale_space(mesh, scales=9), View.fitted(eye, mesh)
    found = conformity(space, exaggerated(space, as_light("northwest", view)), view)
    assert found >= 0.5
    paper = conformity(space, exaggerated(space, as_light("northwest", view), **TODAY), view)
    assert found > paper
    if eye == "front":
        assert paper < 0  # dark where the light is: why the base coat follows


def test_bands_saturate_the_share_they_are_meant_to(spaces):
    for name, space in spaces.items():
        tones = fitted_tones(space, emphasis=-0.5)
        normals = space.normals.astype(float)
        for a, fine, coarse in zip(tones.exaggeration, normals[:-1], normals[1:], strict=True):
            sine = np.linalg.norm(np.cross(fine, coarse), axis=1)
            azimuths = np.abs(np.cos(2 * np.pi * (np.arange(64) + 0.5) / 64))
            share = (a * sine[:, None] * azimuths >= 1).mean()
            assert a <= STEEPEST
            assert share <= SATURATED + 0.02, name
            assert a == STEEPEST or share >= SATURATED - 0.02, name


def test_the_base_coat_is_the_least_that_conforms(spaces):
    for name, space in spaces.items():
        tones = fitted_tones(space, emphasis=-0.5)
        weights = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
        normals = np.ascontiguousarray(space.normals)
        detail, coat, lambert = tone_moments(normals, tones.exaggeration, weights)

        def follows(base, detail=detail, coat=coat, lambert=lambert):
            total = detail + base * coat
            return (total * lambert).mean() / np.sqrt((total**2).mean() * (lambert**2).mean())

        assert follows(tones.base) >= CONFORMITY - 0.01, name
        assert tones.base == 8 or follows(0.9 * tones.base) < CONFORMITY, name
        total = np.abs(detail + tones.base * coat) / (weights[:-1].sum() + tones.base * weights[-1])
        clipped = (tones.contrast * total > 1).mean()
        assert clipped <= 0.012, name
        assert 1 <= tones.contrast <= 2


def test_neither_the_light_nor_the_side_that_is_seen_changes_the_numbers(spaces):
    space = spaces["golf ball"]
    mesh = space.shape
    tones = fitted_tones(space, emphasis=-0.5)
    numbers = tones._asdict()
    for light in ("northwest", (200, -15), "front"):
        np.testing.assert_array_equal(
            exaggerated(space, light), exaggerated(space, light, **numbers)
        )
        baked = md.bake(space, light=light)
        assert {name: baked.look.options[name] for name in numbers} == numbers
    few = mesh.faces[:50]
    between = InterpolatedSpace(space, few, np.tile((0.5, 0.25, 0.25), (50, 1)))
    assert fitted_tones(between, emphasis=-0.5) == tones
    assert fitted_tones(SeenSide(space, View.fitted("back", mesh)), emphasis=-0.5) == tones


# --- scans --------------------------------------------------------------------------------------

SCANS = {  # the parts of a machine apart: their normals at vertices smear edges over planes
    "armadillo_86k": "y", "bunny_69k": "y", "dragon_203k": "y", "flake1_152k": "z",
    "lucy_100k": "z", "nefertiti_100k": "z", "beetle_2k": "y",
}  # fmt: skip


@pytest.mark.parametrize("name", SCANS)
@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_on_scans_broad_tones_follow_the_light_and_detail_stays(data, name):
    from scipy.ndimage import gaussian_filter

    mesh = md.read_mesh(data / "mesh" / f"{name}.ply")
    space = md.scale_space(mesh, scales=9, tolerance=1e-3)
    buffer = md.GBuffer.of(
        mesh, View.fitted("front", mesh, up=SCANS[name], height_px=200), size=(200, 200)
    )
    light = as_light("northwest", buffer.view)

    def broad(values, width=6):  # pixels: 3 % of the picture
        cover = gaussian_filter(buffer.mask.astype(float), width)
        blurred = gaussian_filter(buffer.image(values.astype(float)), width)
        return (blurred / cover.clip(1e-9))[buffer.mask]

    lambert, fitted, today = (
        buffer.sample(values)
        for values in (
            half_lambert(space, light), exaggerated(space, light),
            exaggerated(space, light, **TODAY),
        )
    )  # fmt: skip
    assert np.corrcoef(broad(fitted), broad(lambert))[0, 1] >= 0.6
    assert (fitted - broad(fitted)).std() >= 0.75 * (today - broad(today)).std()
    widest = 200 * space.widths[-1] / (2 * buffer.view.parallel_scale)
    local = [(v - broad(v, widest)).std() for v in (fitted, today)]
    assert local[0] >= 0.8 * local[1]
    assert (fitted < 8 / 255).mean() < 0.01
    assert (fitted > 247 / 255).mean() < 0.05


# --- being told ---------------------------------------------------------------------------------


def test_an_exaggeration_alone_is_the_paper(spaces):
    space = spaces["golf ball"]
    written = {"exaggeration": 25.0, "base": 1.0, "contrast": 1.0}
    np.testing.assert_array_equal(
        exaggerated(space, "northwest", exaggeration=25.0),
        exaggerated(space, "northwest", **written),
    )
    look = md.bake(space, exaggeration=25.0).look
    assert {name: look.options[name] for name in written} == written


def test_each_of_the_numbers_can_be_given(spaces):
    space = spaces["golf ball"]
    fitted = fitted_tones(space, emphasis=-0.5)
    for name, value in {"base": 3.0, "contrast": 0.5}.items():
        wanted = {**fitted._asdict(), name: value}
        np.testing.assert_array_equal(
            exaggerated(space, "west", **{name: value}), exaggerated(space, "west", **wanted)
        )
    steep = tuple(10.0 * a for a in range(1, 10))
    coat = exaggerated(space, "west", exaggeration=0.0)
    alone = [
        exaggerated(space, "west", exaggeration=tuple(a * (i == k) for i, a in enumerate(steep)))
        - coat
        for k in range(9)
    ]
    found = exaggerated(space, "west", exaggeration=steep)
    np.testing.assert_allclose(found - coat, np.sum(alone, axis=0), atol=1e-5)
    assert sum(np.abs(band).max() > 1e-3 for band in alone) >= 2  # wide ones see a sphere
    np.testing.assert_array_equal(
        exaggerated(space, "west", exaggeration=(7.0,) * 9),
        exaggerated(space, "west", exaggeration=7.0),
    )
    with pytest.raises(md.MeshdepictError, match="2 values for 9 scales; give one for all"):
        exaggerated(space, "west", exaggeration=(1.0, 2.0))


def test_the_base_multiplies_the_coat_before_the_sum_is_made_the_contrast():
    widths = np.array([0, 1.0, 2.0, 4.0])
    plain = band_weights(widths, 2, emphasis=-1, contrast=1.0)
    more = band_weights(widths, 2, emphasis=-1, contrast=0.8, base=5.0)
    assert more.sum() == pytest.approx(0.8)
    np.testing.assert_allclose(more[:-1] / more[0], plain[:-1] / plain[0])
    assert more[-1] / more[0] == pytest.approx(5 * plain[-1] / plain[0])


def test_a_recipe_keeps_the_numbers_for_another_shape(spaces, tmp_path):
    baked = md.bake(spaces["golf ball"])
    baked.look.save(tmp_path / "look.toml")
    look = md.Look.load(tmp_path / "look.toml")
    assert look.options["exaggeration"] == baked.look.options["exaggeration"]
    open_look = md.Look("exaggerated")
    assert open_look.following == ("exaggeration", "base", "contrast")
    assert look.following == ()
    assert open_look.settled(spaces["torus"]).options != look.options


def test_the_closing_line_says_the_numbers(run, ball_ply):
    status, out, _ = run("bake", "ball.ply", "-o", "out.ply", "--scales", "3")
    assert status == 0
    assert "exaggeration " in out[0]
    assert ", base " in out[0]
    assert ", contrast " in out[0]
    status, out, _ = run(
        "bake", "ball.ply", "-o", "out.ply", "--scales", "3", "--set", "exaggeration=25"
    )
    assert status == 0
    assert "exaggeration 25, base 1, contrast 1" in out[0]


# --- other kinds and odd shapes -----------------------------------------------------------------


def test_pixels_and_voxels_have_numbers_too():
    ball = samples.golf_ball(3_000)
    pixels = md.bake(md.GBuffer.of(ball, "front", size=(90, 80)))
    assert len(pixels.look.options["exaggeration"]) == 9
    voxels = md.bake_volume(samples.ct_phantom((24, 28, 20)))
    assert len(voxels.look.options["exaggeration"]) == 9
    assert voxels.look.options["base"] > 1
    assert np.isfinite(voxels.intensity).all()


@pytest.mark.parametrize(
    "mesh",
    [
        samples.wavy_sheet(400, amplitude=0),
        samples.sphere(162),
        md.Mesh(np.eye(3), [[0, 1, 2]]),
        md.Mesh(np.full((3, 3), 2.5), [[0, 1, 2]]),
    ],
    ids=["plane", "sphere", "triangle", "point"],
)
def test_shapes_without_detail_have_finite_numbers(mesh):
    space = md.scale_space(mesh, scales=3)
    tones = fitted_tones(space, emphasis=-0.5)
    assert np.isfinite([*tones.exaggeration, tones.base, tones.contrast]).all()
    assert all(0 < a <= STEEPEST for a in tones.exaggeration)
    values = exaggerated(space, "northwest")
    assert ((values >= 0) & (values <= 1)).all()
