"""``mesh.depict`` in PyVista: the bake's colours, chained, with the smoothed normals kept."""

import gc
import inspect
import os
import subprocess
import sys
import textwrap
import tomllib
import weakref
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from conftest import PATIENCE

import meshdepict as md
from meshdepict import MeshdepictError, accessor, samples
from meshdepict.options import options_of
from meshdepict.shading import METHODS
from meshdepict.shapes.sheet import height_sheet, scalar_array

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def poly():
    ball = samples.golf_ball(400, dimples=12)
    return pv.PolyData.from_regular_faces(ball.vertices, ball.faces)


@pytest.fixture
def spaces(monkeypatch):
    """The scale spaces that are made."""
    made = []
    make = accessor.scale_space

    def counted(mesh, **words):
        made.append(words)
        return make(mesh, **words)

    monkeypatch.setattr(accessor, "scale_space", counted)
    return made


def waves(dimensions=(30, 20, 1), spacing=(0.5, 0.25, 1.0), **place):
    image = pv.ImageData(dimensions=dimensions, spacing=spacing, **place)
    x, y, _ = (np.asarray(image.points) - image.origin).T
    image.point_data["height"] = np.sin(x) + 0.3 * np.cos(3 * y)
    return image


# --- meshes ---------------------------------------------------------------------------------------


def test_depict_returns_a_copy_with_the_colors_of_bake(poly):
    before = poly.copy()
    result = poly.depict.exaggerated(light="northwest", exaggeration=20)
    baked = md.bake(poly, "exaggerated", light="northwest", exaggeration=20)
    np.testing.assert_array_equal(result["RGB"], baked.colors)
    np.testing.assert_array_equal(result["depict_exaggerated"], baked.intensity)
    assert list(result.field_data["meshdepict"]) == baked.comments
    assert result.active_scalars_name == "RGB"
    assert poly == before
    assert poly.depict("exaggerated", exaggeration=20) == result
    assert poly.depict().point_data.keys() == result.point_data.keys()


def test_everything_that_the_dataset_had_stays(poly):
    poly.point_data["age"] = np.arange(poly.n_points)
    poly.cell_data["part"] = np.arange(poly.n_cells)
    poly.point_data["RGB"] = np.full((poly.n_points, 3), 7, np.uint8)
    poly.lines = [2, 0, 1]
    result = poly.depict.lambert().depict.toon()
    assert (result.point_data["original_RGB"] == 7).all()
    np.testing.assert_array_equal(result.point_data["age"], poly.point_data["age"])
    np.testing.assert_array_equal(result.lines, poly.lines)
    assert "part" in result.cell_data
    assert result.point_data["RGB"].max() > 7


def test_calls_chain_on_the_original_geometry(poly):
    chained = poly.depict.lambert().depict.exaggerated()
    np.testing.assert_array_equal(chained["RGB"], poly.depict.exaggerated()["RGB"])
    assert {"depict_lambert", "depict_exaggerated"} <= set(chained.point_data)


def test_a_scale_space_is_made_once_for_a_dataset_and_its_depictions(poly, spaces):
    poly.depict.exaggerated(light="east")
    poly.depict.exaggerated(light="west", exaggeration=40)
    poly.depict.exaggerated().depict.exaggerated(light="south")
    assert [words["scales"] for words in spaces] == [9]
    poly.depict.light_alignment()  # other scales, another ratio
    poly.depict.exaggerated(scales=3)
    poly.depict.exaggerated(scales=3, width="3%")
    assert [words["scales"] for words in spaces] == [9, 5, 3, 3]


@pytest.mark.parametrize(
    "change",
    [
        lambda poly: poly.points.__setitem__(0, poly.points[0] * 1.5),
        lambda poly: setattr(poly, "points", poly.points * 2),
        lambda poly: (poly.points.__imul__(2), poly.GetPoints().Modified()),  # VTK can't see why
        lambda poly: poly.translate((1, 0, 0), inplace=True),
        lambda poly: setattr(poly, "faces", poly.faces[:-4]),
        lambda poly: poly.SetPolys(pv.PolyData(poly.points, faces=poly.faces[:-8]).GetPolys()),
    ],
)
def test_a_changed_geometry_is_noticed(poly, spaces, change):
    poly.depict.exaggerated(scales=1)
    change(poly)
    again = poly.depict.exaggerated(scales=1)
    assert len(spaces) == 2
    np.testing.assert_array_equal(again["RGB"], md.bake(poly, scales=1).colors)


def test_new_arrays_and_colors_are_no_new_geometry(poly, spaces):
    poly.depict.exaggerated(scales=1)
    poly.point_data["age"] = np.arange(poly.n_points)
    assert "age" in poly.depict.exaggerated(scales=1).point_data
    assert len(spaces) == 1


def test_own_colors_are_multiplied_as_they_are_now(poly):
    for level in (255, 100):
        poly.point_data["RGB"] = np.full((poly.n_points, 3), (255, level, 0), np.uint8)
        result = poly.depict.lambert(albedo="keep")
        expected = md.bake(poly, "lambert", albedo="keep").colors
        np.testing.assert_array_equal(result["RGB"], expected)
        again = result.depict.lambert(albedo="keep")
        np.testing.assert_array_equal(again["RGB"], expected)


def test_every_method_is_there_with_its_options(poly):
    assert set(METHODS) <= set(dir(poly.depict))
    for name, function in METHODS.items():
        method = getattr(poly.depict, name)
        parameters = inspect.signature(method).parameters
        assert set(options_of(function)) | {"light", "view", "scales"} <= set(parameters)
        assert method.__name__ == name
        for option in options_of(function).values():
            assert parameters[option.name].default == option.default
            assert option.help in method.__doc__
    assert "exaggerated" in repr(poly.depict)


def test_wrong_words_are_one_sentence(poly, spaces):
    with pytest.raises(MeshdepictError, match="exaggerated has no option 'exageration'; did you"):
        poly.depict.exaggerated(exageration=3)
    with pytest.raises(MeshdepictError, match="no method is called 'lampert'"):
        poly.depict("lampert")
    with pytest.raises(AttributeError):
        poly.depict.lampert  # noqa: B018
    assert spaces == []


@pytest.mark.parametrize("kind", [pv.UnstructuredGrid, pv.StructuredGrid, pv.RectilinearGrid])
def test_datasets_without_a_surface_say_what_to_do(kind):
    with pytest.raises(MeshdepictError, match=rf"an? {kind.__name__} has .*\.extract_surface\(\)"):
        kind().depict.lambert()


def test_a_dataset_that_was_depicted_is_freed():
    sphere = pv.Sphere(theta_resolution=8, phi_resolution=8)
    gone = weakref.ref(sphere.depict)
    result = sphere.depict.lambert()
    del sphere
    gc.collect()
    assert gone() is None
    assert result.n_points == 50


# --- height fields --------------------------------------------------------------------------------


def test_a_height_field_is_shaded_as_the_sheet_that_it_is():
    image = waves((120, 80, 1), (0.125, 0.0625, 1), origin=(1000, 2000, 5))
    result = image.depict.lambert(light=(0.2, 0.3, 0.9))
    x, y, _ = np.asarray(image.points).T
    slope = np.stack(
        [-np.cos(x - 1000), 0.9 * np.sin(3 * (y - 2000)), np.ones(len(x))], axis=1
    )  # analytic normal
    slope /= np.linalg.norm(slope, axis=1, keepdims=True)
    light = np.array((0.2, 0.3, 0.9)) / 0.94**0.5
    inner = np.zeros((80, 120), bool)
    inner[1:-1, 1:-1] = True
    difference = result["depict_lambert"] - np.maximum(slope @ light, 0)
    assert (
        np.abs(difference[inner.ravel()]).max() < 5e-3
    )  # second order: (0.125 · 1)² / 6 and (0.0625 · 3)² / 6 of a slope
    assert isinstance(result, pv.ImageData)
    assert result.active_scalars_name == "RGB"
    assert "height" in result.point_data
    assert "RGB" not in image.point_data


def test_heights_that_are_missing_are_left_out_and_grey():
    image = waves()
    heights = np.array(image["height"])
    heights[[0, 45, 46, 200]] = np.nan, np.inf, np.nan, np.nan
    image["height"] = heights
    result = image.depict.exaggerated(scales=2)
    missing = ~np.isfinite(heights)
    assert (result["RGB"][missing] == 127).all()
    assert np.isfinite(result["depict_exaggerated"]).all()
    there = waves().depict.exaggerated(scales=2)
    assert np.corrcoef(result["depict_exaggerated"], there["depict_exaggerated"])[0, 1] > 0.9


def test_height_fields_chain_and_keep_their_scale_space(spaces):
    image = waves()
    result = image.depict.exaggerated(scales=2).depict.exaggerated(scales=2, light="east")
    assert len(spaces) == 1
    image["height"] = image["height"] * 2
    image.depict.exaggerated(scales=2)
    assert len(spaces) == 2
    np.testing.assert_array_equal(
        result["RGB"], waves().depict.exaggerated(scales=2, light="east")["RGB"]
    )


def test_heights_of_cells_give_colors_of_cells():
    points = waves((9, 7, 1))
    cells = pv.ImageData(dimensions=(10, 8, 1), spacing=points.spacing, origin=(0, 0, 0))
    cells.cell_data["height"] = points["height"]
    result = cells.depict.lambert()
    np.testing.assert_array_equal(result.cell_data["RGB"], points.depict.lambert()["RGB"])
    assert result.active_scalars_name == "RGB"


@pytest.mark.parametrize("flat", [0, 1, 2])
@pytest.mark.parametrize("mirrored", [False, True])
def test_normals_point_to_where_heights_grow(flat, mirrored):
    dimensions = [4, 5, 6]
    dimensions[flat] = 1
    image = pv.ImageData(dimensions=dimensions)
    image["height"] = np.zeros(image.n_points)
    if mirrored:
        image.direction_matrix = np.diag((-1.0, 1.0, 1.0))
    sheet = height_sheet(image, "point", "height")
    upwards = np.asarray(image.direction_matrix)[:, flat]
    np.testing.assert_allclose(sheet.mesh.normals @ upwards, 1)


def test_which_array_holds_the_heights():
    image = waves()
    assert scalar_array(image) == ("point", "height")
    image["other"] = image["height"] * 2
    image.set_active_scalars("height")
    assert scalar_array(image) == ("point", "height")
    assert scalar_array(image, "other") == ("point", "other")
    named = image.depict.lambert(scalars="other")
    assert scalar_array(named) == ("point", "other")
    with pytest.raises(MeshdepictError, match=r"no array 'nothing' .*\(it has height, other\)"):
        image.depict.lambert(scalars="nothing")
    with pytest.raises(MeshdepictError, match=r"no active scalars .*\(it has none\)"):
        pv.ImageData(dimensions=(3, 3, 1)).depict.lambert()


def test_what_is_no_height_field_is_refused():
    image = pv.ImageData(dimensions=(3, 3, 1))
    image["RGB"] = np.zeros((9, 3), np.uint8)
    with pytest.raises(MeshdepictError, match="'RGB' has not one number for each point"):
        image.depict.lambert(scalars="RGB")
    image["holes"] = np.where(np.arange(9) == 4, np.nan, 0.0)
    with pytest.raises(MeshdepictError, match="'holes' are no surface"):
        image.depict.lambert(scalars="holes")


def ground(even=True):
    i, j = np.meshgrid(np.arange(30), np.arange(20), indexing="ij")
    x, y = 0.5 * i, 0.25 * j
    if not even:
        x = x**1.1
    z = np.sin(x) + 0.3 * np.cos(3 * y)
    return pv.StructuredGrid(*(a[..., None] for a in (x, y, z)))


def test_an_even_structured_grid_is_the_height_field_that_an_image_is(spaces):
    grid = ground()
    before = grid.copy()
    result = grid.depict.exaggerated(scales=2, light="north")
    assert isinstance(result, pv.StructuredGrid)
    assert result.dimensions == grid.dimensions
    np.testing.assert_array_equal(result.points, grid.points)
    image = waves().depict.exaggerated(scales=2, light="north")
    np.testing.assert_allclose(
        result["depict_exaggerated"], image["depict_exaggerated"], rtol=0, atol=1e-5
    )
    assert grid == before
    assert result.active_scalars_name == "RGB"
    result.depict.exaggerated(scales=2)  # goes on with the same normals
    assert len(spaces) == 2
    grid.points[:, 2] *= 2
    grid.GetPoints().Modified()
    grid.depict.exaggerated(scales=2)
    assert len(spaces) == 3


def test_points_without_a_height_are_grey():
    grid = ground()
    grid.points[[0, 45], 2] = np.nan
    result = grid.depict.lambert()
    assert (result["RGB"][[0, 45]] == 127).all()
    assert np.isfinite(result["depict_lambert"]).all()


def test_an_uneven_structured_grid_is_a_sheet():
    grid = ground(even=False)
    result = grid.depict.lambert(light=(0, 0, 1))
    assert isinstance(result, pv.StructuredGrid)
    surface = grid.extract_surface(algorithm="geometry")
    np.testing.assert_allclose(
        result["depict_lambert"], surface.depict.lambert(light=(0, 0, 1))["depict_lambert"],
        atol=1e-6,
    )  # fmt: skip
    with pytest.raises(MeshdepictError, match="z_factor is about a height field"):
        grid.depict.lambert(z_factor=2)


def test_heights_are_raised_by_a_factor(spaces):
    image = waves()
    raised = image.depict.lambert(z_factor=3)
    image["height"] = image["height"] * 3
    np.testing.assert_array_equal(raised["RGB"], image.depict.lambert()["RGB"])
    assert any("z factor: 3" in line for line in raised.field_data["meshdepict"])
    again = waves()
    again.depict.lambert()
    again.depict.lambert(z_factor=3)
    again.depict.lambert(z_factor=3, light="east")
    assert len(spaces) == 4  # two for the factors, and those before


def test_terrain_of_pyvista_is_baked_as_a_height_field():
    image = waves()
    for dataset in (image, ground()):
        baked = md.bake(dataset, "lambert")
        assert baked.shape.kind == md.Look("lambert").bake(dataset).shape.kind == "height field"
        np.testing.assert_allclose(
            baked.intensity, image.depict.lambert()["depict_lambert"], atol=1e-6
        )


# --- volumes --------------------------------------------------------------------------------------


def test_a_volume_gets_the_colors_of_bake_volume():
    baking = pytest.importorskip("meshdepict.baking.look", reason="volumes are shaded elsewhere")
    from meshdepict.shapes.volume import Volume

    image = pv.ImageData(dimensions=(12, 10, 8), spacing=(1, 1, 1.5))
    distance = np.linalg.norm(np.asarray(image.points) - image.center, axis=1)
    image["ct"] = np.round(2000 - 400 * distance).astype(np.int16)
    image["other"] = np.zeros(image.n_points)
    image.field_data["unit"] = ["HU"]
    image.set_active_scalars("ct")
    words = {"transfer": "bone", "scales": 2}
    result = image.depict.exaggerated(**words)
    alone = image.copy()
    del alone.point_data["other"]
    expected = baking.bake_volume(Volume.from_pyvista(alone), "exaggerated", **words)
    np.testing.assert_array_equal(result["RGBA"], expected.rgba.reshape(-1, 4))
    assert result["RGBA"][:, 3].any()
    assert list(result.point_data) == ["ct", "other", "RGBA"]
    assert result.active_scalars_name == "RGBA"
    lit = image.depict.exaggerated(light="east", **words)
    chained = result.depict.exaggerated(light="east", **words)
    np.testing.assert_array_equal(lit["RGBA"], chained["RGBA"])
    assert (lit["RGBA"] != result["RGBA"]).any()


# --- PyVista's contract ---------------------------------------------------------------------------


def run_python(code, tmp_path, **environment):
    return subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-c", textwrap.dedent(code)],
        capture_output=True, text=True, timeout=PATIENCE, check=False, cwd=tmp_path,
        env={**os.environ, **environment},
    )  # fmt: skip


def test_installing_is_all_it_takes(tmp_path):
    """PyVista finds .depict by the entry point of pyproject.toml, and imports it on first use."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = project["entry-points"]["pyvista.accessors"]
    installed = tmp_path / "proof-1.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: proof\nVersion: 1\n")
    lines = "".join(f"{name} = {value}\n" for name, value in declared.items())
    (installed / "entry_points.txt").write_text(f"[pyvista.accessors]\n{lines}")
    code = """
        import sys, pyvista as pv
        sphere = pv.Sphere(theta_resolution=8, phi_resolution=8)
        assert "depict" in dir(sphere) and "meshdepict" not in sys.modules
        print(sphere.depict.half_lambert()["RGB"].max())
    """
    done = run_python(code, tmp_path, PYTHONPATH=os.pathsep.join((str(tmp_path), str(ROOT))))
    assert done.stderr == ""
    assert int(done.stdout) > 200


def test_registering_twice_does_no_harm():
    accessor.register()
    assert pv.PolyData.depict is accessor.Depict


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["static", "trame"])
def test_notebooks_show_it(backend, tmp_path):
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    if backend == "trame":
        pytest.importorskip("trame", reason="trame is not installed")
    cells = [
        f"import meshdepict.accessor, pyvista as pv\npv.set_jupyter_backend('{backend}')",
        "ball = pv.Sphere().depict.exaggerated(light='northwest', scales=2)",
        "plotter = pv.Plotter(notebook=True, window_size=(80, 80))\n"
        "plotter.add_mesh(ball, scalars='RGB', rgb=True, lighting=False)\n"
        "viewer = plotter.show(return_viewer=True)\nviewer",
        "ball.depict.lambert().n_points",
    ]
    if backend == "trame":  # what the frame in the page asks for is there
        cells.append(
            "import asyncio, re, urllib.request\n"
            "address = re.search('src=\"([^\"?]+)', viewer.value)[1]\n"
            "page = await asyncio.to_thread(lambda: urllib.request.urlopen(address).read())\n"
            "b'<html' in page.lower()"
        )
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    client = nbclient.NotebookClient(
        notebook,
        timeout=PATIENCE,
        kernel_name="python3",
        resources={"metadata": {"path": tmp_path}},
    )
    client.execute()
    results = [
        next(output["data"] for output in cell.outputs if "data" in output)
        for cell in notebook.cells[2:]
    ]
    assert results[1]["text/plain"] == "842"
    if backend == "static":
        assert "image/png" in results[0]
    else:
        assert "<iframe" in results[0]["text/plain"]
        assert results[2]["text/plain"] == "True"


def test_an_unknown_method_names_the_nearest():
    with pytest.raises(AttributeError, match="no method 'exagerated'; did you mean 'exaggerated'"):
        pv.Sphere().depict.exagerated()
