"""Exaggerated Shading that follows the shape: what it promises of tones, and how it is told."""

import numpy as np
import pytest
import pyvista as pv
from scipy.ndimage import gaussian_filter

import meshdepict as md
from meshdepict import samples
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.seen_side import SeenSide
from meshdepict.scene.names import as_light
from meshdepict.scene.view import View
from meshdepict.shading import exaggerated, half_lambert
from meshdepict.shading.bands import band_weights
from meshdepict.shading.fitted_tones import (
    BROAD_CONFORMITY,
    CONFORMITY,
    CONFORMITY_OF_PLANES,
    SATURATED,
    STEEPEST,
    broad_bands,
    fitted_tones,
    flatness,
    tone_moments,
)
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


def box(cells):
    """Six planes that meet at right angles, each of cells × cells squares."""
    surface = pv.Box(level=cells - 1, quads=True).clean().triangulate()
    return md.Mesh.from_pyvista(surface)


def follows(normals, tones, weights):
    """Correlation with half-Lambert over all samples under lights round each."""
    detail, coat, lambert = tone_moments(np.ascontiguousarray(normals), *weights)
    total = detail + np.float32(tones.base) * coat
    return (total * lambert).mean() / np.sqrt((total**2).mean() * (lambert**2).mean())


def test_shapes_of_planes_are_told_from_smooth_and_rough_ones(spaces):
    for name, space in spaces.items():
        assert flatness(space.normals) == 0, name
    assert flatness(md.scale_space(samples.torus(40_000), scales=9).normals) == 0  # fine, too
    assert flatness(md.scale_space(box(60), scales=9).normals) > 0.9
    flat = np.broadcast_to(np.float32((0, 0, 1)), (5, 30, 3))
    assert flatness(flat) == 0  # one plane alone has no haloes


def test_planes_keep_their_tone_by_a_closer_base_coat():
    space = md.scale_space(box(60), scales=9)
    tones = fitted_tones(space, emphasis=-0.5)
    weights = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
    found = follows(space.normals, tones, (tones.exaggeration, weights))
    least = CONFORMITY + flatness(space.normals) * (CONFORMITY_OF_PLANES - CONFORMITY)
    less = tones._replace(base=0.9 * tones.base)
    best = max(
        follows(space.normals, tones._replace(base=b), (tones.exaggeration, weights))
        for b in np.geomspace(8, 64, 30)
    )
    assert found >= min(least, best) - 0.01
    assert follows(space.normals, less, (tones.exaggeration, weights)) < found


def test_the_broad_tone_alone_follows_the_light_more_closely(spaces):
    for name, space in spaces.items():
        broad = broad_bands(space)
        wide = space.widths[broad]
        assert (wide > 0.05 * space.shape.diagonal).all()
        assert (space.widths[: broad.start] <= 0.05 * space.shape.diagonal).all()
        tones = fitted_tones(space, emphasis=-0.5)
        if len(wide) < 2:  # the coat alone
            continue
        weights = band_weights(space.widths, space.ratio, emphasis=-0.5, contrast=1.0)
        parts = tones.exaggeration[broad], weights[broad]
        found = follows(space.normals[broad], tones, parts)
        other = (tones._replace(base=b) for b in np.geomspace(tones.base, 64, 30))
        best = max(follows(space.normals[broad], more, parts) for more in other)
        assert found >= min(BROAD_CONFORMITY, best) - 0.005, name


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

SCANS = {
    "armadillo_86k": "y", "bunny_69k": "y", "dragon_203k": "y", "flake1_152k": "z",
    "lucy_100k": "z", "nefertiti_100k": "z", "beetle_2k": "y", "gears_19k": "y",
}  # fmt: skip


class Seen:
    """A scan in a small picture under the northwest light, as fitted and as it was before."""

    def __init__(self, space, view, up):
        self.space, mesh = space, space.shape
        self.buffer = md.GBuffer.of(
            mesh, View.fitted(view, mesh, up=up, height_px=200), size=(200, 200)
        )
        light = as_light("northwest", self.buffer.view)
        self.lambert = self.buffer.sample(half_lambert(space, light))
        self.fitted = self.buffer.sample(exaggerated(space, light))
        self.today = self.buffer.sample(exaggerated(space, light, **TODAY))

    def broad(self, values, width=6):  # pixels: 3 % of the picture
        cover = gaussian_filter(self.buffer.mask.astype(float), width)
        blurred = gaussian_filter(self.buffer.image(values.astype(float)), width)
        return (blurred / cover.clip(1e-9))[self.buffer.mask]

    def follows(self, values):
        return np.corrcoef(self.broad(values), self.broad(self.lambert))[0, 1]

    def local(self, values):
        """Contrast of what bands show: the picture minus its blur at the widest width."""
        widest = 200 * self.space.widths[-1] / (2 * self.buffer.view.parallel_scale)
        return (values - self.broad(values, widest)).std()


def scanned(data, name):
    return md.scale_space(md.read_mesh(data / "mesh" / f"{name}.ply"), scales=9, tolerance=1e-3)


@pytest.mark.parametrize("name", SCANS)
@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_on_scans_broad_tones_follow_the_light_and_detail_stays(data, name):
    seen = Seen(scanned(data, name), "front", SCANS[name])
    fitted, today = seen.fitted, seen.today
    assert seen.follows(fitted) >= 0.6
    assert (fitted - seen.broad(fitted)).std() >= 0.75 * (today - seen.broad(today)).std()
    assert seen.local(fitted) >= 0.8 * seen.local(today)
    assert (fitted < 8 / 255).mean() < 0.01
    assert (fitted > 247 / 255).mean() < 0.05


@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_gears_from_the_back_follow_the_light(data):
    seen = Seen(scanned(data, "gears_19k"), "back", "y")
    assert seen.follows(seen.fitted) >= 0.6
    assert seen.local(seen.fitted) >= 0.8 * seen.local(seen.today)


@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_planes_of_a_part_follow_the_light_where_it_tells_them_apart(data):
    space = scanned(data, "fandisk_13k")
    assert flatness(space.normals) == 1
    for view in ("front", "left", "right"):
        seen = Seen(space, view, "y")
        assert seen.follows(seen.fitted) >= 0.6, view
    # From the top nearly all is one plane: what half-Lambert shows there is a third of what haloes
    # made, and to follow it is to give them up.
    top = Seen(space, "top", "y")
    assert top.local(top.lambert) < 0.35 * top.local(top.today)


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
