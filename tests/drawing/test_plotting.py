"""`plot` of bakes does what `mesh.plot` of PyVista does; notebooks show a small picture."""

import io

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.drawing import canvas, plotting


@pytest.fixture(scope="module")
def egg():
    ball = samples.sphere(400)
    mesh = md.Mesh(ball.vertices * (1, 2, 3) + (500, 0, 0), ball.faces)
    return md.bake(mesh, "half_lambert", view="right", light="north", exposure=0.6)


@pytest.fixture(scope="module")
def head():
    return md.bake_volume(samples.ct_phantom((16, 16, 16)), "lambert")


@pytest.fixture(params=["mesh", "volume"])
def baked(request, egg, head):
    return {"mesh": egg, "volume": head}[request.param]


def test_an_image_of_a_size_comes_back(baked, tmp_path):
    path = tmp_path / "plot.png"
    image = baked.plot(off_screen=True, window_size=(90, 60), return_img=True, screenshot=path)
    assert image.shape == (60, 90, 3)
    with Image.open(path) as saved:
        np.testing.assert_array_equal(np.asarray(saved.convert("RGB")), image)
    assert (image < 200).any()


def test_it_is_the_picture_of_the_bake(egg, tmp_path):
    image = egg.plot(off_screen=True, window_size=(120, 120), return_img=True).astype(int)
    with Image.open(egg.picture(tmp_path / "a.png", size=(120, 120))) as saved:
        drawn = np.asarray(saved).astype(int)
    inside = (drawn < 250).all(axis=2) & (image < 250).all(axis=2)
    assert inside.sum() > 0.9 * (drawn < 250).all(axis=2).sum()
    assert np.median(np.abs(image - drawn)[inside]) <= 4


def test_the_camera_is_where_the_view_is_in_the_world(baked):
    position, focus, up = baked.plot(off_screen=True, return_cpos=True, window_size=(50, 50))
    unit = baked.shape.diagonal
    np.testing.assert_allclose(focus, baked.view.focus, atol=1e-6 * unit)
    np.testing.assert_allclose(up, baked.view.up, atol=1e-6)
    there = np.subtract(position, focus)
    np.testing.assert_allclose(there / np.linalg.norm(there), baked.view.towards_eye, atol=1e-6)


def test_the_camera_goes_where_it_is_told_in_the_world(baked):
    unit, centre = baked.shape.diagonal, baked.shape.centre
    place = [(*centre[:2], centre[2] + 2 * unit), tuple(centre), (0.0, 1.0, 0.0)]
    found, image = baked.plot(
        off_screen=True, cpos=place, return_cpos=True, return_img=True, window_size=(60, 40)
    )
    np.testing.assert_allclose(found, place, atol=1e-6 * unit)
    assert image.shape == (40, 60, 3)
    position, focus, _ = baked.plot(
        off_screen=True, cpos="xy", return_cpos=True, window_size=(60, 40)
    )
    there = np.subtract(position, focus)
    np.testing.assert_allclose(there / np.linalg.norm(there), (0, 0, 1), atol=1e-6)


def plotted(baked, **words):
    return baked.plot(off_screen=True, return_img=True, window_size=(100, 100), **words).astype(int)


def test_keywords_of_plot(baked):
    plain = plotted(baked)
    assert (plotted(baked, background="black")[0, 0] == 0).all()
    covered = (plain < 250).any(axis=2).mean()
    assert (plotted(baked, zoom=1.5) < 250).any(axis=2).mean() > 1.5 * covered
    for words in ({"text": "find 1"}, {"show_axes": True}, {"show_bounds": True},
                  {"show_grid": True}):  # fmt: skip
        assert (plotted(baked, **words) != plain).any()
    assert (plotted(baked, parallel_projection=False) != plain).any()
    assert plotted(baked, anti_aliasing="ssaa").shape == plain.shape
    assert plotted(baked, anti_aliasing=True).shape == plain.shape


def test_keywords_of_add_mesh(egg):
    plain = plotted(egg)
    assert (plotted(egg, show_edges=True, edge_color="red") != plain).any()
    assert (plotted(egg, lighting=True) != plain).any()
    values = plotted(egg, scalars="depict_half_lambert", rgb=False, cmap="viridis")
    inside = (plain < 250).all(axis=2)
    assert np.ptp(values[inside], axis=1).mean() > 30  # colours, no greys
    assert np.ptp(plain[inside], axis=1).max() == 0


def test_other_keywords_are_refused(egg, head):
    with pytest.raises(
        MeshdepictError, match=r"plot of a mesh has no keyword 'opacityy'.*'opacity'"
    ):
        egg.plot(off_screen=True, opacityy=0.5)
    with pytest.raises(MeshdepictError, match="plot of a volume has no keyword 'show_edges'"):
        head.plot(off_screen=True, show_edges=True)


def test_without_a_display_no_window_opens(baked, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr("pyvista.OFF_SCREEN", False)
    with pytest.raises(MeshdepictError, match="there is no display"):
        baked.plot(window_size=(20, 20))


def test_an_image_has_no_surface_to_plot():
    image = md.GBuffer.of(samples.sphere(100), "front", size=(20, 20))
    with pytest.raises(MeshdepictError, match="no surface"):
        md.bake(image, "lambert").plot(off_screen=True)


def test_what_is_no_place_comes_back_as_it_is(egg):
    for result in (None, "viewer", ("viewer", None), 3):
        assert plotting._in_world(result, egg.shape) is result


# --- notebooks ------------------------------------------------------------------------------------


def test_a_notebook_shows_a_small_picture(baked):
    image = Image.open(io.BytesIO(baked._repr_png_()))
    assert image.format == "PNG"
    assert image.size == (480, 480)
    assert (np.asarray(image.convert("L")) < 250).mean() > 0.05


def test_an_image_is_shown_as_it_is():
    buffer = md.GBuffer.of(samples.sphere(100), "front", size=(40, 30))
    image = Image.open(io.BytesIO(md.bake(buffer, "lambert")._repr_png_()))
    assert image.size == (40, 30)


def test_a_plate_is_shown_smaller(egg):
    plate = md.plate(egg.shape, "lambert", size=(1000, 1200), views="front")
    image = Image.open(io.BytesIO(plate._repr_png_()))
    assert max(image.size) == 800
    assert repr(plate) == "<Plate: 1 views on 1000 x 1200 pixels>"


@pytest.mark.parametrize("fault", [MeshdepictError("no OpenGL"), ImportError(), RuntimeError()])
def test_where_nothing_can_be_drawn_the_repr_stays(egg, monkeypatch, fault):
    def fail(*_):
        raise fault

    monkeypatch.setattr(canvas, "check_opengl", fail)
    assert egg._repr_png_() is None
    assert repr(egg).startswith("<Baked: half_lambert on ")
