"""Open sheets: the side that is seen, the view from above, and a note where backs are seen."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict.errors import MeshdepictWarning
from meshdepict.scales.seen_side import SeenSide
from meshdepict.scene.names import as_view
from meshdepict.shapes.standing import automatic_view
from meshdepict.viewer.session import Session

METHODS = [name for name, f in md.shading.METHODS.items() if f.declaration.linear]


def hill(axis=2, n=15):
    """A bump over a square, its heights along an axis."""
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    z = 0.3 * np.exp(-3 * (x**2 + y**2))
    points = np.roll(np.stack([x, y, z], axis=-1).reshape(-1, 3), axis + 1, axis=1)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + n + 1], 1), np.stack([i, i + n + 1, i + n], 1)])
    return points, faces


def sheet(axis=2, *, back=False):
    points, faces = hill(axis)
    return md.Mesh(points, faces[:, ::-1] if back else faces, winding="keep")


@pytest.mark.parametrize("name", METHODS)
def test_the_back_of_a_sheet_is_shaded_as_its_front(name):
    front = md.bake(sheet(), name, light=(300, 40))
    back = md.bake(sheet(back=True), name, light=(300, 40), two_sided=True)
    np.testing.assert_allclose(back.intensity, front.intensity, atol=2e-5)


@pytest.mark.parametrize("name", ["exaggerated", "light_alignment", "mean_curvature"])
def test_what_faces_the_eye_is_shaded_as_always(name):
    mesh = sheet()
    plain, both = (md.bake(mesh, name, two_sided=both).intensity for both in (False, True))
    np.testing.assert_array_equal(plain, both)


def test_a_turned_surface_bends_the_other_way():
    space = md.scale_space(sheet(back=True), scales=2)
    seen = SeenSide(space, as_view("front", space.shape))
    assert seen.turned.all()
    ahead, behind = seen.curvature(1), space.curvature(1)
    np.testing.assert_array_equal(ahead.mean, -behind.mean)
    np.testing.assert_array_equal(ahead.gaussian, behind.gaussian)
    frame = np.stack([ahead.d1, ahead.d2, seen.normals[1]], axis=1)
    assert (np.linalg.det(frame) > 0.99).all()
    np.testing.assert_allclose(
        seen.view_curvature("front").ku,
        md.scale_space(sheet(), scales=2).view_curvature("front").ku,
        rtol=1e-12,  # sums in another order
    )


def test_a_perspective_eye_sees_each_point_for_itself():
    ball = md.samples.sphere(300)
    eye = md.View((0, 0, 3), (0, 0, 0), (0, 1, 0), field_of_view=40)
    seen = SeenSide(md.scale_space(ball, scales=0), eye)
    towards = np.array([0, 0, 3]) - ball.vertices
    assert ((seen.normals[0] * towards).sum(axis=1) >= 0).all()
    np.testing.assert_array_equal(seen.turned, ball.vertices[:, 2] < 1 / 3)


@pytest.mark.parametrize(("axis", "name"), [(0, "right"), (1, "top"), (2, "front")])
@pytest.mark.parametrize("back", [False, True])
def test_a_terrain_is_seen_from_above(axis, name, back):
    assert automatic_view(sheet(axis, back=back), "y") == name
    assert md.bake(sheet(axis), "lambert", view="auto").view.name == name


def test_a_terrain_whose_z_is_up_is_seen_from_its_top():
    assert automatic_view(sheet(2), "z") == "top"


@pytest.mark.parametrize("shape", [md.samples.sphere(300), md.samples.golf_ball(300)])
def test_what_is_closed_is_seen_from_the_front(shape):
    assert automatic_view(shape, "y") == "front"


def test_backs_get_a_note():
    with pytest.warns(MeshdepictWarning, match="every face looks away from the eye"):
        md.bake(sheet(back=True), "lambert")
    md.bake(sheet(back=True), "lambert", two_sided=True)  # a warning would be an error
    md.bake(sheet(back=True), "lambert", view="back")


def test_on_the_command_line(run, folder):
    from meshdepict.io import write_mesh

    write_mesh("tile.ply", sheet(1))
    _, (line,), err = run("bake", "tile.ply", "-m", "lambert", "--picture", "tile.png")
    assert "tile-lambert.ply: lambert" in line
    assert not err
    info = md.io.read_provenance("tile-lambert.ply")
    assert any("view: top" in text for text in info)
    write_mesh("back.ply", sheet(2, back=True))
    status, _, (note,) = run("bake", "back.ply", "-m", "lambert")
    assert (status, "--two-sided" in note) == (0, True)
    run("bake", "back.ply", "-m", "lambert", "--two-sided", "--force", "--save-recipe", "l.toml")
    assert md.Look.load("l.toml").two_sided is True
    assert any(
        "sides: the one that is seen" in t for t in md.io.read_provenance("back-lambert.ply")
    )


def test_two_sides_are_yes_or_no():
    with pytest.raises(md.MeshdepictError, match="two_sided='x' is neither True nor False"):
        md.Look("lambert", two_sided="x")


def test_a_session_shades_the_side_that_is_seen_from_wherever_it_looks():
    session = Session(sheet(), "lambert", light=(300, 40), two_sided=True)
    front = session.colors
    session.look("back")
    session.shine((300, 40))
    assert session.two_sided
    assert session.follows_view
    behind = md.bake(sheet(), "lambert", light=(300, 40), view="back", two_sided=True)
    np.testing.assert_array_equal(session.colors, behind.colors)
    assert not np.array_equal(session.colors, front)


@pytest.mark.parametrize("name", METHODS)
def test_every_method_is_two_sided_if_asked(name):
    space = md.scale_space(sheet(back=True), scales=2)
    function = md.shading.METHODS[name]
    seen = SeenSide(space, as_view("front", space.shape))
    options = {"view": "front"} if "view" in function.declaration.needs else {}
    np.testing.assert_array_equal(
        function(space, (300, 40), two_sided=True, view="front"),
        function(seen, (300, 40), **options),
    )
    with pytest.raises(md.MeshdepictError, match="two_sided=1 is neither True nor False"):
        function(space, (300, 40), two_sided=1)
