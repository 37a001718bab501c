"""Textures drawn off screen: each pixel is looked up by ourselves, too."""

import numpy as np
import pytest
from PIL import Image
from textured_shapes import globe
from textured_views import hill, islands, looked_up, wrapped

import meshdepict as md
from meshdepict import samples
from meshdepict.baking.own_colors import own_appearance
from meshdepict.drawing import textured
from meshdepict.drawing.canvas import off_screen, pixels_of
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.drawing.picture_files import read_picture_provenance
from meshdepict.drawing.textured import add_appearance
from meshdepict.errors import MeshdepictError
from meshdepict.scene.names import as_view

pytest.importorskip("pyvista")

SIZE = (300, 240)


def differences(appearance, view="front"):
    """How far a drawing is from what we look up, in grey levels, but for edges."""
    mesh = appearance.mesh
    eye = frame(as_view(view, mesh), mesh, Figure(size=SIZE)).view
    wanted, inner = looked_up(appearance, eye, SIZE)
    with off_screen(SIZE) as window:
        add_appearance(window, appearance)
        seen = pixels_of(window, eye, mesh)[..., :3]
    assert inner.mean() > 0.3
    assert np.ptp(wanted[inner]) > 40
    return np.abs(seen - wanted)[inner]


@pytest.mark.parametrize(
    "wrap", [("repeat", "repeat"), ("clamp", "clamp"), ("mirror", "mirror"), ("mirror", "repeat")]
)
def test_a_files_textures_are_drawn_as_they_are(wrap):
    assert differences(own_appearance(wrapped(wrap))).max() <= 2


def test_colours_of_vertices_nearly_multiply_textures_in_linear_light():
    mesh = wrapped(("repeat", "repeat"), tinted=True)
    assert own_appearance(mesh).colors is not None
    assert differences(own_appearance(mesh)).max() <= 9  # products of bytes: at most 9 levels off


@pytest.mark.parametrize("atlas", ["own", "new"])
def test_a_baked_texture_is_drawn_as_it_is(atlas):
    baked = md.bake_texture(hill(), "lambert", size=256, atlas=atlas)
    assert differences(baked.appearance).max() <= 2


def test_pairs_show_less_beside_their_triangles_where_samples_hit_their_edges(monkeypatch):
    import pyvista as pv

    ball = islands(md.bake_texture(samples.sphere(300), "lambert", size=256, atlas="new"))
    assert (ball.image == 0).mean() > 0.1

    def specks():
        """How many pixels of a white ball on white show black gutters."""
        window = pv.Plotter(off_screen=True, window_size=[200, 200])
        window.set_background("white")
        window.render_window.SetMultiSamples(4)
        add_appearance(window, ball.appearance)
        window.reset_camera()
        window.render()
        image = window.screenshot(return_img=True)
        window.close()
        return (image < 250).any(axis=2).sum()

    few = specks()
    monkeypatch.setattr(textured, "_stay_within", lambda actor: None)
    assert few <= specks() / 2  # none by OpenGL; Mesa's software takes places beside some edges


def test_a_picture_of_a_texture_is_in_its_view_and_knows_how_it_came_about(tmp_path):
    baked = md.bake_texture(globe(6), "lambert", size=256, view="left")
    path = baked.picture(tmp_path / "globe.png", size=(120, 90), scale_bar=True, caption="a globe")
    with Image.open(path) as image:
        assert image.size[0] == 120
        assert np.asarray(image).std() > 20
    assert "256 x 256" in str(read_picture_provenance(path))
    pictures = [md.bake_texture(globe(6), "lambert", size=256, light="west", view=view)
                for view in ("left", "right")]  # fmt: skip
    for each, name in zip(pictures, "ab", strict=True):
        each.picture(tmp_path / f"{name}.png", size=(60, 60))
    with Image.open(tmp_path / "a.png") as a, Image.open(tmp_path / "b.png") as b:
        one, other = (np.asarray(each).astype(float) for each in (a, b))
        assert np.abs(one - other).mean() < 1  # lit from the left of either eye; charts differ


def test_a_texture_is_a_picture_in_notebooks_and_a_plot(tmp_path):
    baked = md.bake_texture(globe(6), "lambert", size=256)
    assert baked._repr_png_().startswith(b"\x89PNG")
    image = baked.plot(off_screen=True, window_size=[90, 80], return_img=True)
    assert np.shape(image) == (80, 90, 3)
    assert np.std(image) > 20
    with pytest.raises(MeshdepictError, match="no keyword 'show_edgs'"):
        baked.plot(off_screen=True, show_edgs=True)


def test_pyvista_gets_coordinates_for_the_picture():
    baked = md.bake_texture(globe(3), "lambert", size=64)
    poly = baked.to_pyvista()
    assert poly.n_cells == len(baked.texcoords)
    at = poly.active_texture_coordinates[poly.regular_faces]
    np.testing.assert_allclose(at, baked.texcoords, atol=1e-6)
    np.testing.assert_allclose(
        poly.points[poly.regular_faces], baked.shape.vertices[baked.shape.faces], atol=1e-6
    )
