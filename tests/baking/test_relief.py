"""Relief in windows: the whole's numbers without seams, in bounded memory, and honest refusals."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import HeightField, MeshdepictError
from meshdepict.baking.layer_list import Layer
from meshdepict.baking.look import Look
from meshdepict.baking.relief import Relief
from meshdepict.heights.spread_cells import typical_cells, typical_places

ROWS, COLUMNS = 700, 620


def ground(kind="metres", *, gaps=True):
    rng = np.random.default_rng(0)
    y, x = np.mgrid[:ROWS, :COLUMNS]
    z = 20 * np.sin(x / 31) * np.cos(y / 23) + 0.2 * rng.normal(size=x.shape)
    valid = np.ones(z.shape, bool)
    if gaps:
        valid = rng.random(z.shape) > 0.01
        valid[100:180, 300:420] = False
    if kind == "degrees":
        return HeightField(z, valid=valid, transform=(1e-5, 0, 8, 0, -1e-5, 60), degrees=True)
    return HeightField(z.astype(np.float32), valid=valid)


def shaded(relief):
    colors = np.zeros((ROWS, COLUMNS, 3), np.uint8)
    values = np.zeros((ROWS, COLUMNS, relief.bands), np.float32)
    seen = np.zeros((ROWS, COLUMNS), int)
    for part in relief.windows():
        colors[part.rows, part.columns] = part.colors
        values[part.rows, part.columns] = part.values.reshape(*part.valid.shape, -1)
        seen[part.rows, part.columns] += 1
    assert (seen == 1).all()
    return colors, values


@pytest.mark.parametrize("kind", ["metres", "degrees"])
@pytest.mark.parametrize(
    ("method", "options", "memory"),
    [
        ("exaggerated", {}, 8e7),
        ("exaggerated", {"one_light": False, "scales": 5}, 7e7),
        ("exaggerated", {"scales": 3, "colormap2d": "swiss", "z_factor": 3}, 7e7),
        ("light_alignment", {}, 8e7),
        ("light_warping", {}, 7e7),
        ("radiance_scaling", {}, 7e7),
        ("unsharp_masking", {}, 5e7),
        ("mean_curvature", {"colormap": "viridis"}, 7e7),
        ("hillshade", {}, 5e7),
        ("sky_view", {}, 5e7),
        ("sky_view", {"horizon": "cells"}, 5e7),
        ("multidirectional_hillshade", {}, 5e7),
        ("positive_openness", {"radius": 17.5}, 5e7),
        ("negative_openness", {}, 5e7),
        ("local_dominance", {}, 5e7),
        ("topographic_position", {"broad": 40}, 5.5e7),
    ],
)
def test_windows_give_the_bits_of_the_whole(kind, method, options, memory):
    field = ground(kind)
    baked = md.bake(field, method, **options)
    relief = Relief(field, Look(method, **options), memory=memory)
    assert len(relief.cut) > 1
    colors, values = shaded(relief)
    assert np.array_equal(colors, field.image(baked.colors))
    whole = baked.intensity.reshape(field.count, -1).astype(np.float32)
    assert np.array_equal(values, field.image(whole, background=np.nan), equal_nan=True)
    assert relief.look.options == baked.look.options


@pytest.mark.parametrize("kind", ["metres", "degrees"])
def test_balls_in_windows_are_those_of_the_whole_but_for_rounding(kind):
    field = ground(kind)
    baked = md.bake(field, "integral_invariant", radius=6, contrast=5)
    relief = Relief(field, Look("integral_invariant", radius=6, contrast=5), memory=5e7)
    assert len(relief.cut) > 1
    _, values = shaded(relief)
    off = np.abs(values[..., 0] - field.image(baked.intensity, background=np.nan))
    assert np.nanmax(off) < 2e-4  # single precision of positions in a ball, times the contrast


def test_wide_smoothing_gives_the_bits_of_the_whole():
    field = ground()
    words = {"width": 8.0, "scales": 2}
    relief = Relief(field, Look("exaggerated", **words), memory=6e7)
    assert relief.cut.align > 1
    assert len(relief.cut) > 1
    assert np.array_equal(shaded(relief)[0], field.image(md.bake(field, **words).colors))


def test_the_windows_fit_into_the_memory_that_is_allowed():
    field = ground()
    sides = [Relief(field, Look(), memory=m).cut.side for m in (4e7, 1e8, 1e9)]
    assert sides == sorted(sides)
    assert sides[0] < sides[-1]


def test_a_window_that_memory_does_not_hold_is_refused():
    with pytest.raises(MeshdepictError, match=r"widths of .* m look at .*or take smaller widths"):
        Relief(ground(), Look(width=100.0), memory=1e7)
    with pytest.raises(MeshdepictError, match=r"303 around it that the method .*look less far"):
        Relief(ground(), Look("topographic_position", broad=300), memory=1e7)


def test_methods_that_look_at_everything_are_refused_where_it_does_not_fit():
    with pytest.raises(MeshdepictError, match="looks at all 434,000 cells at once"):
        Relief(ground(), Look("texture_shading"), memory=1e7)


@pytest.mark.parametrize("words", [{"refine": 2}, {"albedo": "keep"}])
def test_what_is_about_meshes_is_refused(words):
    with pytest.raises(MeshdepictError, match="about a mesh"):
        Relief(ground(), Look("lambert", **words))


def test_all_no_data_is_refused():
    class Empty:
        rows, cols, transform, crs, degrees, unit = 30, 30, (1, 0, 0, 0, -1, 0), "", False, 1.0

        def __init__(self):
            self.attributes = {"source": "nothing.tif"}

        def read(self, rows, cols):
            shape = rows.stop - rows.start, cols.stop - cols.start
            return np.zeros(shape), np.zeros(shape, bool)

    with pytest.raises(MeshdepictError, match=r"nothing\.tif holds no heights"):
        list(Relief(Empty(), Look()).windows())


def test_cells_that_stand_for_a_raster_are_few_and_spread():
    for rows, columns in ((1, 1), (1, 5000), (30, 20), (1500, 1500), (3000, 4000), (1, 5_000_000)):
        cells = typical_cells(rows, columns)
        assert 0 < cells.sum() <= 9000
        assert cells.any(axis=0).sum() >= min(columns, 11)
        assert cells.any(axis=1).sum() >= min(rows, 11)


def test_what_is_fitted_to_a_large_raster_is_fitted_to_blocks_of_it(monkeypatch):
    from meshdepict.heights import spread_cells

    monkeypatch.setattr(spread_cells, "_SMALL", 1000)
    assert len(list(typical_places(ROWS, COLUMNS))) == 121
    field = ground()
    whole, parts = md.bake(field), Relief(field, Look(), memory=8e7)
    assert parts.look.options == whole.look.options
    assert np.array_equal(shaded(parts)[0], field.image(whole.colors))


def test_progress_counts_windows():
    told = []
    relief = Relief(ground(), Look("lambert"), memory=3e7)
    list(relief.windows(lambda done, total: told.append((done, total))))
    assert told == [(n, len(relief.cut)) for n in range(1, len(relief.cut) + 1)]


def test_a_saved_relief_says_how_it_came_about(tmp_path):
    from meshdepict.io import read_provenance

    relief = Relief(ground(), Look("lambert", z_factor=2.5))
    relief.save(tmp_path / "relief.png")
    from meshdepict.drawing.picture_files import read_picture_provenance

    said = "\n".join(map(str, read_picture_provenance(tmp_path / "relief.png")))
    assert "lambert" in said
    pytest.importorskip("rasterio")
    relief.save(tmp_path / "relief.tif")
    said = "\n".join(read_provenance(tmp_path / "relief.tif"))
    assert "z factor: 2.5" in said


def test_values_are_one_band_of_numbers(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    field = ground()
    Relief(field, Look("hillshade")).save(tmp_path / "values.tif", values=True)
    with rasterio.open(tmp_path / "values.tif") as file:
        found = file.read(1)
    whole = md.bake(field, "hillshade").intensity
    assert np.array_equal(found, field.image(whole, background=np.nan), equal_nan=True)
    with pytest.raises(MeshdepictError, match="leave --values out"):
        Relief(field, Look("gooch")).save(tmp_path / "colours.tif", values=True)


@pytest.mark.parametrize("large", [False, True])
def test_windows_know_their_own_of_the_cells_that_stand_for_a_raster(monkeypatch, large):
    from meshdepict.heights import spread_cells

    monkeypatch.setattr(spread_cells, "_SMALL", 1000 if large else 10**6)
    whole = typical_cells(ROWS, COLUMNS)
    for rows, columns in ((slice(0, 256), slice(512, 620)), (slice(511, 700), slice(3, 300))):
        part = typical_cells(ROWS, COLUMNS, rows, columns)
        assert np.array_equal(part, whole[rows, columns])


def test_what_is_fitted_to_one_large_window_is_fitted_to_blocks_of_it(monkeypatch):
    from meshdepict.heights import spread_cells

    monkeypatch.setattr(spread_cells, "_SMALL", 1000)
    field = ground()
    relief = Relief(field, Look(), memory=1e9)
    assert len(relief.cut) == 1
    assert relief.look.options == md.bake(field).look.options


@pytest.mark.parametrize("kind", ["metres", "degrees"])
@pytest.mark.parametrize("width", ["0.2%", "1px", "0.1%,1px"])
def test_widths_of_the_whole_are_those_of_a_bake(kind, width):
    field = ground(kind)
    valid = field.valid.copy()
    valid[:90, :] = valid[:, 500:] = False  # the box is that of the heights
    field = HeightField(
        np.where(valid, 9 * field.z, np.nan), transform=field.transform, degrees=field.degrees
    )
    words = {"width": width, "scales": 3, "z_factor": 2.0}
    baked, relief = md.bake(field, **words), Relief(field, Look(**words), memory=7e7)
    assert len(relief.cut) > 1
    assert np.array_equal(relief.widths, baked.space.widths)
    assert np.array_equal(shaded(relief)[0], field.image(baked.colors))


def test_rays_that_were_found_are_recorded_and_those_of_the_bake(rng, monkeypatch):
    monkeypatch.setattr("meshdepict.shading.sampled.AUTO_SECONDS", 1e3)
    field, options = HeightField(3 * rng.random((20, 30))), {"shadows": True, "bounces": 1}
    relief = Relief(field, Look("lambert", rays="auto", **options))
    number = relief.look.options["rays"]
    assert f"rays={number}" in relief.provenance["options"].split()
    assert relief.provenance["rays auto"].startswith(f"{number}, ")
    assert number == md.bake(field, "lambert", rays="auto", **options).look.options["rays"]
    layers = Layer("lambert", options={**options, "rays": "auto"}), Layer("slope")
    blended = Relief(field, Look(blend=layers))
    assert blended.look.layers[0].options["rays"] == number
