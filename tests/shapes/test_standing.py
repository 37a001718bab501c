"""Which way up shapes stand, and from where they are looked at, where nobody says."""

import re

import numpy as np
import pytest
import trimesh

import meshdepict as md
from meshdepict.congruence.comparison import compare
from meshdepict.errors import MeshdepictWarning
from meshdepict.samples.phantom import ct_phantom
from meshdepict.scene.upright import UPS
from meshdepict.scene.view import named_directions
from meshdepict.shapes.isosurface import isosurface
from meshdepict.shapes.standing import automatic_view, standing
from meshdepict.surface.aspects import AXES, aspects, footing, mirrored, spread
from meshdepict.viewer.session import Session

# By looking at pictures of six sides. Where a thing has no way up, or several, all that make sense.
SCANS = {
    "mesh/armadillo_86k.ply": ("y", "front"),
    "mesh/beetle_2k.ply": ("y", "front left right isometric"),
    "mesh/bunny_69k.ply": ("y", "front left"),
    "mesh/dragon_203k.ply": ("y", "front back"),
    "mesh/fandisk_13k.ply": ("y", "back isometric"),
    "mesh/flake1_152k.ply": ("y z", "left right"),
    "mesh/gears_19k.ply": ("z -z", "top"),
    "mesh/lucy_100k.ply": ("z", "back"),
    "mesh/nefertiti_100k.ply": ("z", "front left right"),
}
FILES = {
    "formats/obj_dup_vertices_teapot.obj": ("y", "front back"),
    "formats/obj_mixed_greek_helmet.obj": ("y", "left right"),
    "formats/obj_ngons_trumpet.obj": ("y", "left right"),
    "formats/obj_quads_quadknot.obj": (" ".join(UPS), "front left right back top"),
    "formats/off_binary_beetle.off": ("y", "front left right isometric"),
    "formats/ply_ascii_inside_out_bunny.ply": ("y", "front left"),
    "formats/ply_ascii_ngons_shark.ply": ("y", "front back"),
    "formats/ply_big_endian_screwdriver.ply": ("z", "front left right back"),
    "formats/ply_camera_element_rangemap.ply": ("z", "top"),  # what its camera saw
    "formats/ply_gz_dragon_res4.ply.gz": ("y", "front back"),
    "formats/ply_tristrips_hippo.ply": ("y", "front back"),
    "formats/stl_ascii_tray.stl": ("z", "front back"),
    "formats/stl_binary_featuretype.stl": ("z", "top isometric"),
    "formats/vtp_cowhead.vtp": ("y", "right"),
}
QUARTERS = {
    "x": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "y": np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    "z": np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
}


def vase(axis="z"):
    """A closed vessel with a round lid and a foot, and a handle on one side: up is an axis."""
    radius = np.array([0, 0.5, 0.5, 0.3, 0.3, 0.8, 1, 0.8, 0.4, 0])
    height = np.array([0, 0, 0.1, 0.2, 0.4, 0.8, 1.2, 1.7, 2, 2.15])
    count = 48
    angle = np.arange(count) * 2 * np.pi / count
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate(
        [np.c_[r * ring, np.full(count, h)] for r, h in zip(radius, height, strict=True)]
    )
    i = np.arange(count)
    j = (i + 1) % count
    quads = [np.stack([k + i, k + j, k + count + j, k + count + i], 1)
             for k in range(0, count * (len(radius) - 1), count)]  # fmt: skip
    ball = md.samples.sphere(200)
    handle = ball.vertices * (0.8, 0.1, 0.4) + (1.4, 0, 1.2)
    faces = np.concatenate(quads)
    faces = np.concatenate([faces[:, :3], faces[:, [0, 2, 3]], ball.faces + len(points)])
    points = np.concatenate([points, handle])
    order = {"z": (0, 1, 2), "x": (2, 0, 1), "y": (1, 2, 0)}[axis]
    return md.Mesh(points[:, order], faces)


def plate(thickness=0.1):
    """A plate that lies on a table, z up."""
    corner = np.array([[x, y, z] for x in (0, 3) for y in (0, 2) for z in (0, thickness)], float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return md.Mesh(corner, faces)


def axis_of(up, turn):
    """The axis that one becomes under a turn."""
    direction = np.eye(3)[AXES.index(up) % 3] * (1 if AXES.index(up) < 3 else -1)
    turned = turn @ direction
    number = int(np.abs(turned).argmax())
    return AXES[number if turned[number] > 0 else number + 3]


def judged(data, table):
    """How many of the files' ups and of their views are right."""
    ups = views = 0
    for name, (up, view) in table.items():
        found = standing(md.read_mesh(data / name))
        ups += found.up in up.split()
        views += found.view in view.split()
    return ups / len(table), views / len(table)


@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_at_least_eight_of_ten_scans_stand_and_are_seen_right(data):
    ups, views = judged(data, SCANS)
    assert ups >= 0.8
    assert views >= 0.8


@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
def test_at_least_eight_of_ten_other_files_stand_and_are_seen_right(data):
    ups, views = judged(data, FILES)
    assert ups >= 0.8
    assert views >= 0.8


@pytest.mark.parametrize("name", ["armadillo_86k", "bunny_69k", "lucy_100k", "nefertiti_100k"])
@pytest.mark.parametrize("about", "xyz")
def test_a_turned_scan_gets_the_turned_answer(data, name, about):
    mesh = md.read_mesh(data / "mesh" / f"{name}.ply")
    turn = QUARTERS[about]
    turned = md.Mesh(mesh.vertices @ turn.T, mesh.faces)
    assert standing(turned).up == axis_of(standing(mesh).up, turn)


@pytest.mark.parametrize("about", "xyz")
@pytest.mark.parametrize("times", [1, 2, 3])
def test_a_turned_vase_stands_and_is_seen_as_before(about, times):
    mesh, turn = vase(), np.linalg.matrix_power(QUARTERS[about], times)
    turned = md.Mesh(mesh.vertices @ turn.T, mesh.faces)
    before, after = standing(mesh), standing(turned)
    assert before.up == "z"
    assert after.up == axis_of("z", turn)
    # With its handle to the left or right; front and back show the same.
    across = turn @ (0, 1, 0)
    for found, side in ((before, np.array([0, 1, 0])), (after, across)):
        assert abs(named_directions(found.view, found.up)[0] @ side) == 1


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e12])
@pytest.mark.parametrize("offset", [(0, 0, 0), (5e5, -3e6, 100)])
def test_moving_and_scaling_change_nothing(scale, offset):
    mesh = vase("x")
    moved = md.Mesh((mesh.vertices + offset) * scale, mesh.faces)
    assert standing(moved) == standing(mesh)
    assert standing(mesh).up == "x"


def test_work_is_bounded_whatever_the_size():
    small, large = md.samples.sphere(300), md.samples.sphere(120_000)
    assert len(large.faces) > 200_000  # of which every second is looked at
    found = [spread(mesh.unit_points, mesh.outward_faces) for mesh in (small, large)]
    assert len(found[0][0]) == len(found[1][0])
    points, normals = found[1]
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1, atol=1e-3)
    # Evenly: the mean vanishes as points of a low-discrepancy sequence have it.
    assert np.linalg.norm(points.mean(axis=0)) < 0.02
    np.testing.assert_allclose((points * normals).sum(axis=1), 1, atol=1e-3)


def test_a_ball_shows_half_of_its_box_and_is_its_own_mirror():
    ball = md.samples.sphere(5000)
    points, normals = spread(ball.unit_points, ball.outward_faces)
    seen = aspects(points, normals)
    for aspect in seen:
        assert aspect.area == pytest.approx(np.pi / 4, rel=0.15)  # cells at the rim count wholly
    assert min(mirrored(seen, axis) for axis in range(3)) > 0.97


def test_footings_of_a_plate():
    mesh = plate()
    points, normals = spread(mesh.unit_points, mesh.outward_faces)
    lying, upright = (footing(points, normals, AXES.index(axis)) for axis in "zy")
    share = 6 / (2 * (6 + 0.2 + 0.3))
    assert lying.flat == pytest.approx(share, abs=0.01)
    width = np.sqrt((3**2 + 2**2) / 12)
    assert lying.margin == pytest.approx(1 / width, rel=0.05)
    assert upright.margin < 0.2 < lying.margin


@pytest.mark.parametrize("up", ["z", "x"])
def test_what_lies_is_seen_from_above(up):
    mesh = plate()
    mesh = mesh if up == "z" else md.Mesh(mesh.vertices[:, [2, 0, 1]], mesh.faces)
    assert standing(mesh)[:2] == (up, "top")


def test_a_low_block_is_seen_from_above_at_an_angle():
    assert standing(plate(1.3))[:2] == ("z", "isometric")


def test_y_is_up_where_the_shape_says_nothing():
    balls = [md.samples.sphere(count) for count in (12, 60, 300, 842)]
    for shape in (*balls, md.samples.golf_ball(300), plate(2)):
        assert standing(shape).up == "y"
        assert not standing(shape).note


def test_nothing_but_degenerate_faces_stands_as_usual():
    flat = md.Mesh([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 1, 2]])
    assert standing(flat) == ("y", "front", "")


def test_a_terrain_is_seen_from_above_whichever_axis_its_heights_have():
    x, y = np.meshgrid(np.linspace(-1, 1, 15), np.linspace(-1, 1, 15))
    points = np.stack([x, y, 0.3 * np.exp(-3 * (x**2 + y**2))], axis=-1).reshape(-1, 3)
    i = (np.arange(14)[:, None] * 15 + np.arange(14)).ravel()
    faces = np.concatenate([np.stack([i, i + 1, i + 16], 1), np.stack([i, i + 16, i + 15], 1)])
    for up, order in (("z", (0, 1, 2)), ("x", (2, 0, 1)), ("y", (1, 2, 0))):
        assert standing(md.Mesh(points[:, order], faces))[:2] == (up, "top")


def test_a_format_decides_and_the_shape_has_its_say(folder):
    stl, glb = folder / "vase.stl", folder / "vase.glb"
    mesh = vase("z")
    trimesh.Trimesh(mesh.vertices, mesh.faces).export(stl)
    assert standing(md.read_mesh(stl)) == ("z", standing(mesh).view, "")
    assert standing(md.read_mesh(stl).as_triangles()).up == "z"
    lying = vase("x")
    trimesh.Trimesh(lying.vertices, lying.faces).export(stl)
    found = standing(md.read_mesh(stl))
    assert found.up == "z"
    assert found.note == "z is up, as its format has it: --up x stands it on its base"
    md.io.write_mesh(glb, mesh)
    found = standing(md.read_mesh(glb))
    assert found.up == "y"
    assert "--up z stands it on its base" in found.note


def test_what_is_no_mesh_has_an_up_of_its_own():
    volume = ct_phantom((24, 24, 24))
    assert standing(volume) == ("z", "front", "")  # towards a patient's head, from the front
    assert automatic_view(volume, "-z") == "front"
    buffer = md.GBuffer.of(vase("z"), "front", size=(40, 40))
    assert standing(buffer) == ("y", "front", "")
    assert md.bake(buffer, "lambert", view="auto", up="auto").view is buffer.view
    baked = md.bake_volume(volume, "lambert", view="auto", up="auto")
    assert (baked.look.up, baked.look.view) == ("z", "front")
    assert isosurface(volume, 700).kind == "mesh"


def test_bakes_sessions_and_comparisons_take_it_and_say_so():
    mesh = vase("x")
    found = standing(mesh)
    with pytest.warns(MeshdepictWarning, match=re.escape("x is up, as the shape stands: --up y")):
        baked = md.bake(mesh, "lambert", up="auto", view="auto")
    assert baked.provenance["view"] == f"{found.view}, up x"
    assert (baked.look.up, baked.look.view) == ("x", found.view)
    np.testing.assert_array_equal(
        baked.colors, md.bake(mesh, "lambert", up="x", view=found.view).colors
    )
    with pytest.warns(MeshdepictWarning, match="x is up"):
        session = Session(mesh, "lambert", up="auto", view="auto")
    assert (session.up, session.view.name) == ("x", found.view)
    np.testing.assert_array_equal(session.colors, baked.colors)
    with pytest.warns(MeshdepictWarning, match="x is up"):
        compared = compare(
            mesh, ["lambert"], lights=["north"], up="auto", view="auto", size=(48, 48), scales=1
        )
    np.testing.assert_array_equal(compared.view.up, (1, 0, 0))
    assert compared.view.name == found.view


def test_a_script_does_not_change_with_the_shape():
    baked = md.bake(vase("x"), "lambert")
    assert baked.provenance["view"] == "front, up y"


def test_on_the_command_line(run, folder):
    md.io.write_mesh("vase.ply", vase("z"))
    status, _, (note,) = run("bake", "vase.ply", "-m", "lambert", "--save-recipe", "taken.toml")
    assert status == 0
    assert "note: vase.ply: z is up, as the shape stands: --up y otherwise" in note
    name = standing(vase("z")).view
    assert f"meshdepict view: {name}, up z" in md.io.read_provenance("vase-lambert.ply")
    _, _, err = run("bake", "vase.ply", "-m", "lambert", "--up", "y")
    assert "is up" not in "".join(err)
    _, _, (note,) = run(
        "compare", "vase.ply", "-m", "lambert", "--light", "north", "--size", "48x48"
    )
    assert "z is up" in note
    run("bake", "vase.ply", "vase.ply", "-m", "lambert", "--save-recipe", "any.toml")
    assert md.Look.load("any.toml").up == "auto"  # of several, each has its own
    taken = md.Look.load("taken.toml")  # … and so has each that one recipe is for
    assert taken.words() == md.Look.load("any.toml").words()
    run("bake", "vase.ply", "-m", "lambert")
    first = md.read("vase-lambert.ply").attributes["vertex"]
    run("bake", "vase.ply", "--recipe", "taken.toml")
    again = md.read("vase-lambert.ply").attributes["vertex"]
    np.testing.assert_array_equal(again["red"], first["red"])
    md.io.write_mesh("other.ply", vase("x"))
    _, _, (note,) = run("bake", "other.ply", "--recipe", "taken.toml")
    assert "note: other.ply: x is up" in note
    name = standing(vase("x")).view
    assert f"meshdepict view: {name}, up x" in md.io.read_provenance("other-lambert.ply")


def test_a_recipe_of_a_script_keeps_its_axis(run, folder):
    md.io.write_mesh("vase.ply", vase("z"))
    md.Look("lambert").save("script.toml")
    _, _, err = run("bake", "vase.ply", "--recipe", "script.toml")
    assert "is up" not in "".join(err)
    assert "meshdepict view: front, up y" in md.io.read_provenance("vase-lambert.ply")
