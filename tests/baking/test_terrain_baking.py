"""Height fields go where meshes go: files, PyVista, trimesh, options; or one sentence says why."""

import warnings

import numpy as np
import pytest

import meshdepict as md
from meshdepict.baking.batch import check_look, stem
from meshdepict.baking.plan import plan
from meshdepict.errors import MeshdepictError
from meshdepict.io import read_mesh
from meshdepict.scales.making import scale_space


@pytest.fixture(scope="module")
def field():
    y, x = np.mgrid[:30, :40] + 0.0
    z = 5 * np.exp(-((x - 15) ** 2 + (y - 12) ** 2) / 60) + 0.5 * np.sin(x / 2)
    z[5:9, 20:30] = np.nan
    return md.HeightField(z, transform=(2, 0, 500, 0, -2, 900))


@pytest.fixture(scope="module")
def baked(field):
    return md.bake(field)


@pytest.mark.parametrize("suffix", [".ply", ".glb", ".vtp", ".obj", ".off"])
def test_a_baked_field_is_saved_as_the_ground_in_its_colors(baked, tmp_path, suffix):
    path = baked.save(tmp_path / f"ground{suffix}")
    mesh = read_mesh(path, winding="keep")
    assert len(mesh.vertices) == baked.shape.count
    scale = np.abs(baked.shape.points).max()
    np.testing.assert_allclose(mesh.vertices, baked.shape.points, rtol=0, atol=1e-6 * scale)
    colors = np.stack([mesh.attributes["vertex"][name] for name in ("red", "green", "blue")], 1)
    np.testing.assert_array_equal(colors, baked.colors)


def test_a_baked_field_is_saved_as_a_page(baked, tmp_path):
    assert "<canvas" in baked.save(tmp_path / "ground.html").read_text()


def test_pyvista_and_trimesh_get_the_ground(baked):
    pytest.importorskip("pyvista")
    poly, tri = baked.to_pyvista(), baked.to_trimesh()
    np.testing.assert_array_equal(poly["RGB"], baked.colors)
    np.testing.assert_array_equal(np.asarray(tri.visual.vertex_colors)[:, :3], baked.colors)
    np.testing.assert_allclose(poly.points, baked.shape.points)
    assert (tri.face_normals[:, 2] > 0).all()


@pytest.mark.parametrize("suffix", [".png", ".tif"])
@pytest.mark.parametrize("colormap", [None, "sepia"])
def test_a_baked_field_is_saved_as_relief_on_its_raster(field, tmp_path, suffix, colormap):
    rasterio = pytest.importorskip("rasterio")
    relief = md.bake(field, "lambert", colormap=colormap)
    path = relief.save(tmp_path / f"relief{suffix}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # rasterio's, of rasters without a reference system
        with rasterio.open(path) as raster:
            bands, place = raster.read(), tuple(raster.transform)[:6]
    assert place == field.transform
    raster = field.image(relief.colors).transpose(2, 0, 1)
    np.testing.assert_array_equal(bands[:-1], raster if colormap else raster[:1])
    np.testing.assert_array_equal(bands[-1] == 255, field.valid)


def test_a_raster_that_is_no_surface_says_so_where_a_mesh_is_needed(tmp_path):
    line = md.bake(md.HeightField(np.arange(9.0)[None]), "lambert")
    for needs in (
        lambda: line.save(tmp_path / "x.ply"),
        lambda: line.save(tmp_path / "x.html"),
        line.to_pyvista,
        line.to_trimesh,
        line.show,
        line.plot,
        lambda: line.edge_error,
    ):
        with pytest.raises(MeshdepictError, match="no surface: nowhere do three neighbouring"):
            needs()
    assert not (tmp_path / "x.ply").exists()


@pytest.mark.parametrize(
    "chosen", [{"creases": 40}, {"normals": "file"}, {"refine": 2}, {"transfer": "bone"}]
)
def test_what_is_about_faces_is_refused(field, chosen):
    (name,) = chosen
    kind = "volume" if name == "transfer" else "mesh"
    with pytest.raises(MeshdepictError, match=f"{name} is about a {kind}, and this is a height"):
        md.bake(field, **chosen)


def test_a_height_field_has_no_colors_of_its_own(field):
    with pytest.raises(MeshdepictError, match="a height field has none"):
        md.bake(field, albedo="keep")


def test_a_mesh_has_no_factor_of_heights():
    with pytest.raises(MeshdepictError, match="z_factor is about a height field, and this is a me"):
        md.bake(md.samples.sphere(40), z_factor=2)


def test_from_below_two_sided_shades_the_side_that_is_seen(field):
    with pytest.warns(md.MeshdepictWarning, match="every face looks away"):
        dark = md.bake(field, "lambert", view="bottom", light="front")
    seen = md.bake(field, "lambert", view="bottom", light="front", two_sided=True)
    assert not dark.intensity.any()
    above = md.bake(field, "lambert", light="front")
    np.testing.assert_allclose(seen.intensity, above.intensity, atol=1e-6)
    relief = md.bake(field, view="bottom", two_sided=True)  # one light on level ground
    assert relief.intensity.std() > 0.05


def test_errors_between_samples_are_measured_as_on_the_ground_s_mesh(field):
    own = md.bake(field, "lambert").edge_error
    mesh = md.bake(field.mesh, "lambert", view="top", up="z").edge_error
    assert own.rms == pytest.approx(mesh.rms, rel=0.2)
    assert md.bake(field).edge_error.rms > 0
    sky = md.Environment(np.random.default_rng(1).random((4, 8, 3)))
    assert md.bake(field, "phong", light=sky).light_error is not None
    assert md.bake(field).light_error is None


# --- the factor of heights ------------------------------------------------------------------------


def test_raising_in_a_look_is_raising_the_field(field):
    looked = md.bake(field, z_factor=3)
    raised = md.bake(field.raised(3))
    np.testing.assert_array_equal(looked.colors, raised.colors)
    assert looked.provenance["z factor"] == raised.provenance["z factor"] == "3"
    assert looked.look.z_factor == raised.look.z_factor == 3
    assert "z factor" not in md.bake(field).provenance
    assert (looked.colors != md.bake(field).colors).any()


def test_a_scale_space_has_the_heights_that_it_was_made_with(field):
    space = scale_space(field.raised(3), scales=9)
    np.testing.assert_array_equal(md.bake(space).colors, md.bake(field, z_factor=3).colors)
    np.testing.assert_array_equal(md.bake(space, z_factor=3).colors, md.bake(space).colors)
    with pytest.raises(MeshdepictError, match=r"z_factor=2 comes too late: .* are 3 times"):
        md.bake(space, z_factor=2)


def test_a_recipe_holds_the_factor_and_one_without_keeps_its_picture(field, tmp_path):
    look = md.bake(field, z_factor=2.5).look
    again = md.Look.load(look.save(tmp_path / "relief.toml"))
    assert again.z_factor == 2.5
    np.testing.assert_array_equal(again.bake(field).colors, md.bake(field, z_factor=2.5).colors)
    old = tmp_path / "old.toml"
    old.write_text('method = "exaggerated"\nlight = "northwest"\n')
    np.testing.assert_array_equal(md.Look.load(old).bake(field).colors, md.bake(field).colors)
    sphere = md.samples.sphere(80)
    look = md.Look("lambert")
    assert "z_factor = 1.0" in look.save(tmp_path / "mesh.toml").read_text()
    np.testing.assert_array_equal(
        md.Look.load(tmp_path / "mesh.toml").bake(sphere).colors, look.bake(sphere).colors
    )


# --- what it costs --------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["lambert", "exaggerated", "light_warping", "sky_view"])
def test_a_plan_names_the_sets_that_are_made(field, method):
    look = md.Look(method)
    found = plan(field, look)
    baked = md.bake(field, method)
    assert {0, *found.sets} == baked.space.smoothed
    assert 0 < found.seconds < 60
    assert found.size > 0


def test_a_plan_of_relief_has_its_own_widths(field):
    np.testing.assert_allclose(plan(field, md.Look()).widths, md.bake(field).space.widths)
    raised = plan(field, md.Look(width="10%", z_factor=40)).widths
    np.testing.assert_allclose(raised, md.bake(field, width="10%", z_factor=40).space.widths)


# --- batches --------------------------------------------------------------------------------------


def test_a_look_about_terrain_alone_passes_the_trial_on_a_sphere():
    check_look(md.Look(z_factor=3, one_light=True))


@pytest.mark.parametrize("name", ["hill.tif", "hill.DEM", "hill.asc", "hill.npy", "hill.vrt"])
def test_names_of_terrain_lose_their_suffix(tmp_path, name):
    assert stem(tmp_path / name) == "hill"
