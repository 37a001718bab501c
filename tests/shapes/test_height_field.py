"""HeightField: heights on a raster, their place in metres, and what they can't be."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import HeightField, MeshdepictError
from meshdepict.heights.cells import METRES_PER_DEGREE

Z = np.arange(12.0).reshape(3, 4)


def test_samples_stand_at_the_centres_of_cells_row_by_row():
    field = HeightField(Z, transform=(2, 0, 100, 0, -3, 60))
    assert field.points[0].tolist() == [101, 58.5, 0]
    assert field.points[-1].tolist() == [107, 52.5, 11]
    assert field.spacing == (2, 3)
    assert field.edge_length == 2


def test_cells_without_a_height_are_no_samples():
    z = Z.copy()
    z[1, 2] = np.nan
    field = HeightField(z)
    assert field.count == 11
    assert not field.valid[1, 2]
    assert field.z[1, 2] == 0
    assert np.isnan(z[1, 2])
    values = np.arange(11)
    assert np.array_equal(field.sample(field.image(values, background=-1)), values)
    assert field.image(values, background=-1)[1, 2] == -1


def test_a_turned_raster_turns_its_samples():
    turn = np.radians(90)
    c, s = np.cos(turn), np.sin(turn)
    turned = HeightField(Z, transform=(c, s, 0, s, -c, 0)).points
    straight = HeightField(Z, transform=(1, 0, 0, 0, -1, 0)).points
    np.testing.assert_allclose(turned[:, 0], -straight[:, 1], atol=1e-12)
    np.testing.assert_allclose(turned[:, 1], straight[:, 0], atol=1e-12)


def test_degrees_become_metres():
    field = HeightField(Z, transform=(0.5, 0, 8, 0, -0.5, 60.75), degrees=True)
    along, down = field.spacing
    assert along == pytest.approx(0.5 * METRES_PER_DEGREE * np.cos(np.radians(60)))
    assert down == pytest.approx(0.5 * METRES_PER_DEGREE)
    box = np.ptp(field.points, axis=0)
    np.testing.assert_allclose(np.ptp(field.outline, axis=0), box, rtol=1e-9)
    assert box[1] == pytest.approx(METRES_PER_DEGREE)


def test_a_box_is_that_of_the_samples():
    z = np.where(np.arange(12).reshape(3, 4) % 4 < 3, Z, np.nan)
    field = HeightField(z, transform=(2, 0, 100, 0, -3, 60))
    assert np.array_equal(field.outline.min(axis=0), field.points.min(axis=0))
    assert np.array_equal(field.outline.max(axis=0), field.points.max(axis=0))


def test_a_window_stands_where_it_stood():
    field = HeightField(Z, transform=(2, 0, 100, 0, -3, 60), crs="here")
    part = field.window(slice(1, 3), slice(2, 4))
    assert np.array_equal(part.points, field.points.reshape(3, 4, 3)[1:, 2:].reshape(-1, 3))
    assert part.crs == "here"


def test_the_ground_has_a_vertex_for_each_sample_and_looks_up():
    rng = np.random.default_rng(0)
    z = np.where(rng.random((20, 30)) > 0.2, rng.random((20, 30)), np.nan)
    for transform in ((1, 0, 0, 0, -1, 0), (1, 0, 0, 0, 1, 0), (0, 1, 0, 1, 0, 0)):
        field = HeightField(z, transform=transform)
        mesh = field.mesh
        assert np.array_equal(mesh.vertices, field.points)
        a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
        assert (np.cross(b - a, c - a)[:, 2] > 0).all()
        assert mesh.length_unit == "m"


def test_three_cells_around_a_gap_have_one_triangle():
    field = HeightField([[0.0, 1.0], [2.0, np.nan]])
    assert len(field.mesh.faces) == 1


def test_a_row_is_no_surface():
    with pytest.raises(MeshdepictError, match="no surface"):
        _ = HeightField(Z[:1]).mesh


def test_heights_are_multiplied_by_a_z_factor():
    field = HeightField(Z)
    assert np.array_equal(field.raised(3).z, 3 * Z)
    assert field.raised(1) is field
    for factor in (0, -1, np.nan, "high", 1e7):
        with pytest.raises(MeshdepictError, match="z_factor"):
            field.raised(factor)
    with pytest.raises(MeshdepictError, match=r"heights reach from 0 to 1e\+33 m on cells of 1 m"):
        HeightField(np.array([[1e28, 0]], np.float32)).raised(1e5)


def test_arrays_of_floats_are_not_copied_and_not_changed():
    z = Z.astype(np.float32)
    field = HeightField(z)
    assert np.shares_memory(field.z, z)
    assert z.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        field.z[0, 0] = 1


def test_small_integers_are_single_precision_and_large_ones_double():
    assert HeightField(Z.astype(np.int16)).z.dtype == np.float32
    assert HeightField(Z.astype(np.int32)).z.dtype == np.float64
    assert HeightField(Z.astype(">f4")).z.dtype == np.float32


@pytest.mark.parametrize(
    ("z", "words", "said"),
    [
        (np.full((3, 4), np.nan), {}, "none of 12 cells"),
        (np.zeros((3, 4, 3)), {}, "give one band"),
        ([[1, 2], [3]], {}, "real numbers in rows and columns"),
        (np.zeros((0, 3)), {}, "rows and columns"),
        (Z, {"valid": np.zeros((3, 4), bool)}, "none of 12 cells"),
        (Z, {"valid": np.ones((4, 3), bool)}, "valid says"),
        ([[0, np.inf]], {"valid": [[True, True]]}, "NaN or infinite, the first in row 0, column 1"),
        (Z, {"unit": 0}, "unit=0"),
        (Z, {"crs": 4326}, "crs is a text"),
        (Z, {"attributes": 3}, "no mapping"),
    ],
)  # fmt: skip
def test_what_holds_no_heights_is_refused(z, words, said):
    with pytest.raises(MeshdepictError, match=said):
        HeightField(z, **words)


def test_values_and_rasters_of_another_size_are_refused():
    field = HeightField(Z)
    with pytest.raises(MeshdepictError, match="not one for each of 12 cells"):
        field.image(np.zeros(11))
    with pytest.raises(MeshdepictError, match="not one of"):
        field.sample(np.zeros((4, 3)))


def test_its_table_and_its_repr_say_what_it_is():
    field = HeightField(Z, crs='PROJCRS["NAD27 / UTM zone 10N", …]', attributes={"band": 1})
    assert repr(field) == "<HeightField: 4 x 3 cells of 1 x 1 m>"
    table = field._repr_html_()
    assert "NAD27 / UTM zone 10N" in table
    assert "0 … 11 m" in table


def test_the_identity_knows_heights_and_place():
    field = HeightField(Z)
    assert field.identity == HeightField(Z.copy()).identity
    assert field.identity != HeightField(Z + 1).identity
    assert field.identity != HeightField(Z, transform=(2, 0, 0, 0, -2, 0)).identity


def test_a_bake_of_terrain_sees_the_map():
    baked = md.bake(HeightField(Z), "lambert")
    assert baked.view.towards_eye.tolist() == [0, 0, 1]
    assert baked.view.up.tolist() == [0, 1, 0]
    assert md.bake(HeightField(Z[::-1]), "lambert", view="front", up="z").view.towards_eye[1] == -1


@pytest.mark.parametrize("up", [None, "auto", "z"])
@pytest.mark.parametrize(("view", "towards"), [("isometric", 0.577), ("auto", 1), ("top", 1)])
def test_terrain_stands_on_its_ground_in_every_view(up, view, towards):
    baked = md.bake(HeightField(0.01 * Z), "lambert", view=view, up=up)
    assert baked.view.towards_eye[2] == pytest.approx(towards, abs=1e-3)
