"""The object's own colours, however a program has spelled them."""

import numpy as np
import pytest
from conftest import tetrahedron

from meshdepict import Mesh, MeshdepictError, MeshdepictWarning, bake
from meshdepict.io import read_mesh, write_mesh
from meshdepict.shapes.colors import after_position, vertex_colors
from meshdepict.shapes.document import as_bytes
from meshdepict.surface.icosahedron import icosphere

OWN = np.array([[200, 100, 50], [10, 20, 30], [0, 255, 128], [90, 80, 70]], np.uint8)


def of(**vertex):
    return Mesh(*tetrahedron(), attributes={"vertex": vertex})


def three(names, values=OWN):
    return dict(zip(names, values.T, strict=True))


@pytest.mark.parametrize(
    "vertex",
    [
        three(("red", "green", "blue")),
        three(("r", "g", "b")),
        three(("R", "G", "B")),
        three(("Red", "Green", "Blue"), OWN / 255),
        three(("diffuse_red", "diffuse_green", "diffuse_blue")),
        three(("color_r", "color_g", "color_b"), OWN.astype(np.uint16) * 257),
        three(("colors_0", "colors_1", "colors_2")),
        {"rgb": OWN},
        {"colours": np.concatenate((OWN, np.full((4, 1), 7, np.uint8)), axis=1)},
        {"rgb": (OWN.astype(np.uint32) @ [1 << 16, 1 << 8, 1]).astype(np.uint32)},
        {"rgb": (OWN.astype(np.uint32) @ [1 << 16, 1 << 8, 1]).astype(np.uint32).view(np.float32)},
        {**three(("original_red", "original_green", "original_blue")),
         **three(("red", "green", "blue"), 0 * OWN)},
        {**three(("red", "green", "blue")), **three(("r", "g", "b"), 0 * OWN)},
    ],
)  # fmt: skip
def test_spellings(vertex):
    np.testing.assert_array_equal(vertex_colors(of(**vertex), baked=False), OWN)


@pytest.mark.parametrize(
    "vertex",
    [
        {},
        three(("ambient_red", "ambient_green", "ambient_blue")),
        {"red": OWN[:, 0], "green": OWN[:, 1]},
        {"rgb": np.zeros(4)},  # no packed ones: double
        {"color": np.zeros((4, 2), np.uint8)},
        three(("0", "1", "2")),
    ],
)
def test_what_is_no_colour(vertex):
    assert vertex_colors(of(**vertex), baked=False) is None
    with pytest.raises(MeshdepictError, match="albedo='keep' needs"):
        bake(of(**vertex), "lambert", albedo="keep")


def test_a_former_bakes_colours_are_not_the_objects():
    mesh = of(**three(("red", "green", "blue")), **three(("r", "g", "b"), 255 - OWN))
    np.testing.assert_array_equal(vertex_colors(mesh, baked=True), 255 - OWN)


def test_colours_of_faces_are_averaged_by_their_areas_in_linear_light():
    """Two triangles of areas 1 and 3: black and white make a linear 3/4 where they meet."""
    points = [[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, -3, 0], [9, 9, 9]]
    channels = {name: np.array([0, 255], np.uint8) for name in ("red", "green", "blue")}
    mesh = Mesh(points, [[0, 1, 2], [0, 3, 1]], attributes={"face": channels})
    with pytest.warns(MeshdepictWarning, match="at its faces: they are averaged to its vertices"):
        found = vertex_colors(mesh, baked=False)
    level = round(255 * (1.055 * 0.75 ** (1 / 2.4) - 0.055))
    expected = [level, level, 0, 255, level]  # the last is at no face, and has the mean of all
    np.testing.assert_array_equal(found, np.repeat(np.array(expected)[:, None], 3, axis=1))


def test_colours_of_polygons_are_those_of_their_triangles():
    points, faces = icosphere(100)
    quads = [[a, b, c] for a, b, c in faces.tolist()]
    quads[0] = [*quads[0], quads[0][0]]
    channels = {name: np.full(len(quads), 77, np.uint8) for name in ("red", "green", "blue")}
    mesh = Mesh(points, quads, attributes={"face": channels})
    with pytest.warns(MeshdepictWarning, match="averaged"):
        assert set(vertex_colors(mesh, baked=False).ravel().tolist()) == {77}


def test_the_file_after_a_public_report(data):
    mesh = read_mesh(data / "cases" / "ply-face-colours" / "ply_face_colour.ply")
    with pytest.warns(MeshdepictWarning, match="averaged"):
        kept = bake(mesh, "lambert", albedo="keep").colors
    assert (kept != bake(mesh, "lambert").colors).any()


# --- numbers ------------------------------------------------------------------------------------


@pytest.mark.parametrize("wild", [1.02, 2.0, 37, 255, 1e30, np.inf])
@pytest.mark.parametrize("usual", [0.5, 1.0])
def test_one_value_above_one_darkens_no_other(usual, wild):
    values = np.full((50, 3), usual)
    values[7, 1] = wild
    found = as_bytes(values)
    assert found[7, 1] == 255
    assert set(np.delete(found.ravel(), 22).tolist()) == {round(usual * 255 + 1e-9)}


def test_one_value_above_255_darkens_no_other():
    values = np.full(50, 200, np.int32)
    values[3] = 300
    assert set(as_bytes(values).tolist()) == {200, 255}


def test_an_obj_with_one_value_above_one(tmp_path):
    rows = [f"v {x} {y} 0 0.5 {g} 0.5" for x, y, g in ((0, 0, 0.5), (1, 0, 1.02), (0, 1, 0.5))]
    (tmp_path / "one.obj").write_text("\n".join([*rows, "f 1 2 3"]))
    green = read_mesh(tmp_path / "one.obj").attributes["vertex"]["green"]
    assert green.tolist() == [128, 255, 128]


# --- what follows x, y and z --------------------------------------------------------------------

RGB = np.array([[0.2, 0.4, 0.6], [0.1, 0.3, 0.5]])
W, ALPHA = np.ones((2, 1)), np.array([[0.5], [1.0]])


@pytest.mark.parametrize("w_first", [True, False])
@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        ([RGB], RGB),
        ([W, RGB], RGB),
        ([RGB, W], RGB),  # opaque
        ([RGB, 255 * W], RGB),
        ([RGB, ALPHA], np.hstack((RGB, ALPHA))),
        ([W, RGB, ALPHA], np.hstack((RGB, ALPHA))),
        ([W, RGB, W], RGB),
        ([W], None),
        ([W, W], None),
        ([RGB, RGB], None),
    ],
)
def test_weights_and_opacities_are_no_colours(parts, expected, w_first):
    found = after_position(np.hstack(parts), w_first=w_first)
    if expected is None:
        assert found is None
    else:
        np.testing.assert_array_equal(found, expected)


def test_where_both_readings_fit_the_format_decides():
    both = np.hstack((W, RGB[:, :2], W))
    np.testing.assert_array_equal(after_position(both, w_first=True), both[:, 1:])
    np.testing.assert_array_equal(after_position(both, w_first=False), both[:, :3])


def test_an_obj_with_weights_keeps_its_colours(tmp_path):
    rows = [f"v {x} {y} 0 1 0.2 {y} 0.6" for x, y in ((0, 0), (1, 0), (0, 1))]
    path = tmp_path / "weights.obj"
    path.write_text("\n".join([*rows, "f 1 2 3"]))
    mesh = read_mesh(path)
    vertex = mesh.attributes["vertex"]
    assert [vertex[name].tolist() for name in ("red", "green", "blue")] == [
        [51] * 3, [0, 0, 255], [153] * 3,
    ]  # fmt: skip
    write_mesh(path, mesh, colors=OWN[:3], keep_colors=False)
    again = read_mesh(path).attributes["vertex"]
    np.testing.assert_array_equal(
        np.stack([again[n] for n in ("red", "green", "blue")], 1), OWN[:3]
    )
