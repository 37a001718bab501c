"""Commands take files of terrain where they take meshes."""

import numpy as np
import pytest
from height_files import geotiff, hills

import meshdepict as md

pytest.importorskip("pyvista")
pytest.importorskip("rasterio")


@pytest.fixture
def hill(folder):
    z = hills(40, 30)
    y, x = np.mgrid[:40, :30]
    z = (60 * np.exp(-((x - 14) ** 2 + (y - 18) ** 2) / 90)).astype(np.float32)
    return geotiff(folder / "hill.tif", z)


def test_bake_writes_the_ground_and_the_map(run, hill, folder):
    status, out, err = run(
        "bake", "hill.tif", "--picture", "map.png", "--z-factor", 2, "--save-recipe", "look.toml"
    )
    assert (status, err) == (0, [])
    assert out[0].startswith("hill-exaggerated.ply: exaggerated, light northwest, 9 widths 10 ")
    field = md.read(hill)
    expected = md.bake(field, z_factor=2)
    mesh = md.read_mesh("hill-exaggerated.ply")
    np.testing.assert_allclose(mesh.vertices[:, 2], 2 * field.z.ravel(), rtol=1e-6)
    np.testing.assert_array_equal(mesh.attributes["vertex"]["red"], expected.colors[:, 0])
    from PIL import Image

    shown = np.asarray(Image.open("map.png").convert("L"))
    side = 500 // 40
    np.testing.assert_array_equal(shown[::side, ::side], field.image(expected.colors[:, 0]))
    assert "z_factor = 2.0" in (folder / "look.toml").read_text()
    assert run("bake", "hill.tif", "--recipe", "look.toml", "-o", "again.ply")[0] == 0
    again = md.read_mesh("again.ply")
    np.testing.assert_array_equal(again.attributes["vertex"]["red"], expected.colors[:, 0])


def test_meshes_and_terrain_may_be_mixed(run, hill, ball_ply):
    words = ("--fix-winding", "--triangles", "-m", "lambert")
    status, out, err = run("bake", "ball.ply", "hill.tif", *words)
    assert status == 0
    assert [line.partition(":")[0] for line in out] == ["ball-lambert.ply", "hill-lambert.ply"]
    assert err[-1] == "meshdepict: 2 of 2 baked"
    status, out, err = run("bake", "ball.ply", "hill.tif", "--z-factor", 2, "--force")
    assert (status, len(out)) == (2, 1)
    assert "z_factor is about a height field, and this is a mesh" in err[0]
    status, out, err = run("bake", "hill.tif", "--creases", 40, "--force")
    assert status == 2
    assert "creases is about a mesh, and this is a height field" in err[-1]


def test_view_opens_a_window_on_terrain(run, hill):
    status, out, err = run("view", "hill.tif", "--z-factor", 3, "--frames", 2)
    assert (status, out) == (0, [])
    assert err == ["meshdepict: h shows the keys, q closes the window"]


def test_view_serves_terrain_to_a_browser(run, hill, monkeypatch):
    from meshdepict.viewer import browser

    served = []
    for place in (browser, browser.server):
        monkeypatch.setattr(place, "serve", lambda session, **how: served.append((session, how)))
    assert run("view", "hill.tif", "--browser", "--z-factor", 3)[0] == 0
    ((session, how),) = served
    assert (session.shape.kind, session.z_factor, how["title"]) == ("height field", 3, "hill")


def test_compare_scores_terrain(run, hill):
    words = ("-m", "lambert", "-m", "exaggerated", "--light", "northwest", "--size", "120x120")
    status, out, err = run("compare", "hill.tif", *words, "--z-factor", 2)
    assert (status, err) == (0, [])
    assert out[-1].startswith("hill-compare.png: mean congruence, 1 light")


def test_a_plate_has_the_map_and_its_sides(run, hill):
    status, out, err = run("plate", "hill.tif", "--size", "300x300", "-m", "lambert")
    assert (status, err) == (0, [])
    assert out[0].startswith("hill-plate.png")


def test_info_says_what_a_terrain_is_and_costs(run, hill):
    status, out, err = run("info", "hill.tif")
    assert (status, err) == (0, [])
    rows = {line[2:20].strip(): line[20:].strip() for line in out[1:]}
    assert rows["cells"] == "30 x 40"
    assert rows["cell"] == "10 x 10 m"
    assert rows["default bake"].startswith("about ")
    status, out, err = run("info", "hill.tif", "--explain", "exaggerated")
    assert (status, err) == (0, [])
    assert any("1,200 cells" in line for line in out)
    assert sum(line.lstrip().startswith("normals") for line in out) == 9


def test_a_movie_turns_terrain(run, hill):
    words = ("-m", "lambert", "--seconds", 0.2, "--fps", 10, "--size", "80x60", "--view", "front")
    status, out, err = run("movie", "hill.tif", "-o", "turn.gif", *words, "--z-factor", 2)
    assert (status, err) == (0, [])
    assert out[0].startswith("turn.gif: lambert, object turning, 2 frames")
