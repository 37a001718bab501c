"""A volume knows its voxels' places, never copies what it needn't, and refuses what is none."""

import pickle

import numpy as np
import pytest
from conftest import rotation

from meshdepict.errors import MeshdepictError
from meshdepict.shapes.volume import Volume


@pytest.fixture
def values(rng):
    return rng.integers(-1000, 2000, (5, 4, 3)).astype(np.int16)


def test_an_array_is_used_as_it_is_and_can_not_be_written_to(values):
    volume = Volume(values)
    assert np.shares_memory(volume.values, values)
    assert values.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        volume.values[0] = 0
    assert volume.values.dtype == np.int16
    assert volume.n_samples == 60
    assert volume.unit == "raw"
    assert repr(volume) == "<Volume: 3 x 4 x 5 int16, spacing (1, 1, 1), raw>"


@pytest.mark.parametrize("kind", ["u1", "i2", ">i2", "u2", "i4", "f4", ">f8", "?", "f2"])
def test_types_of_files_are_kept_in_native_order(values, kind):
    volume = Volume((values % 2).astype(kind))
    assert volume.values.dtype.isnative
    assert volume.values.dtype == {"?": np.uint8, "f2": np.float32}.get(
        kind, np.dtype(kind).newbyteorder("=")
    )
    np.testing.assert_array_equal(volume.values, values % 2)


def test_memory_mapped_values_stay_on_the_disk(tmp_path, values):
    np.save(tmp_path / "a.npy", values)
    mapped = np.load(tmp_path / "a.npy", mmap_mode="r")
    assert np.shares_memory(Volume(mapped).values, mapped)


def test_to_world_is_origin_plus_directions_times_spacing(values, rng):
    spacing, origin, direction = (0.5, 0.7, 2.0), (10, -20, 30), rotation(rng)
    volume = Volume(values, spacing=spacing, origin=origin, direction=direction)
    np.testing.assert_array_equal(volume.to_world((0, 0, 0)), origin)
    for axis in range(3):  # one voxel along an axis is one spacing along a column
        step = volume.to_world(np.eye(3)[axis]) - origin
        np.testing.assert_allclose(step, spacing[axis] * direction[:, axis], atol=1e-14)
    assert volume.to_world(np.zeros((2, 7, 3))).shape == (2, 7, 3)


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_size_does_not_change_when_turned_or_mirrored(values, rng, mirror):
    spacing = np.array((0.5, 0.7, 2.0))
    turned = Volume(values, spacing=spacing, direction=rotation(rng) * (1, mirror, 1))
    size = np.linalg.norm(spacing * (2, 3, 4))
    assert turned.diagonal == pytest.approx(size, rel=1e-14)
    assert turned.edge_length == 2
    corners = turned.outline
    assert corners.shape == (8, 3)
    apart = np.linalg.norm(corners[:, None] - corners, axis=-1)
    assert apart.max() == pytest.approx(size)
    assert np.linalg.det(turned.direction) == pytest.approx(mirror)
    np.testing.assert_allclose(turned.centre, turned.to_world((1, 1.5, 2)), atol=1e-14)
    np.testing.assert_allclose(corners.mean(axis=0), turned.centre, atol=1e-14)


def test_rounded_directions_become_orthonormal(values, rng):
    exact = rotation(rng)
    volume = Volume(values, direction=np.round(exact, 4))
    np.testing.assert_allclose(volume.direction.T @ volume.direction, np.eye(3), atol=1e-15)
    assert np.abs(volume.direction - exact).max() < 1e-4
    np.testing.assert_array_equal(Volume(values, direction=-np.eye(3)).direction, -np.eye(3))


def test_range_is_of_all_slabs(values, monkeypatch):
    monkeypatch.setattr("meshdepict.shapes.volume._SLAB", 12)  # one slice a slab
    volume = Volume(values)
    assert len(list(volume.slabs())) == 5
    assert volume.range == (values.min(), values.max())


@pytest.mark.parametrize(
    ("kind", "slope", "intercept", "wanted"),
    [("u2", 1, -1024, "i2"), ("u2", 40, 0, "i4"), ("u1", 200, 5, "u2"), ("i2", 0.5, 0, "f4"),
     ("f4", 1, -1024, "f4"), ("u2", 2_000_000, 0, "i8")],
)  # fmt: skip
def test_rescaled_keeps_the_narrowest_type(rng, kind, slope, intercept, wanted):
    raw = rng.integers(0, 250 if kind == "u1" else 3000, (3, 3, 3)).astype(kind)
    volume = Volume(raw, spacing=(1, 2, 3), attributes={"modality": "CT"})
    rescaled = volume.rescaled(slope, intercept)
    np.testing.assert_array_equal(rescaled.values, raw.astype(float) * slope + intercept)
    assert rescaled.values.dtype == wanted
    assert rescaled.unit == "HU"
    assert rescaled.attributes == volume.attributes
    np.testing.assert_array_equal(rescaled.spacing, volume.spacing)


def test_slope_one_says_only_the_unit(values):
    volume = Volume(values).rescaled(1, 0)
    assert volume.unit == "HU"
    assert np.shares_memory(volume.values, values)


def test_pyvista_and_back_is_the_same_volume_and_memory(values, rng):
    volume = Volume(
        values,
        spacing=(0.5, 0.7, 2),
        origin=(1, 2, 3),
        direction=rotation(rng) * (1, 1, -1),
        hounsfield=True,
    )
    image = volume.to_pyvista()
    assert np.shares_memory(image.point_data["values"], values)
    # VTK numbers points with x fastest and places them itself.
    np.testing.assert_allclose(image.points[1], volume.to_world((1, 0, 0)), atol=1e-6)
    np.testing.assert_allclose(image.points[-1], volume.to_world((2, 3, 4)), atol=1e-6)
    back = Volume.from_pyvista(image)
    np.testing.assert_array_equal(back.values, values)
    for name in ("spacing", "origin", "direction"):
        np.testing.assert_allclose(getattr(back, name), getattr(volume, name), atol=1e-15)
    assert back.hounsfield
    assert not Volume.from_pyvista(image, hounsfield=False).hounsfield


def test_from_pyvista_takes_cells_at_their_centres_and_any_extent(rng):
    import pyvista as pv

    image = pv.ImageData(dimensions=(4, 4, 4), spacing=(1, 2, 3), origin=(5, 5, 5))
    image.cell_data["density"] = rng.random(27)
    volume = Volume.from_pyvista(image)
    assert volume.values.shape == (3, 3, 3)
    np.testing.assert_allclose(volume.origin, image.cell_centers().points[0])
    image.set_active_scalars(None)
    assert Volume.from_pyvista(image).values.shape == (3, 3, 3)  # there is no other array
    shifted = pv.ImageData(spacing=(1, 2, 3), origin=(5, 5, 5))
    shifted.extent = (10, 13, 0, 3, -2, 1)
    shifted.point_data["density"] = rng.random(64)
    np.testing.assert_allclose(Volume.from_pyvista(shifted).origin, shifted.points[0])


def test_from_pyvista_refuses_what_is_no_single_scalar_field(rng):
    import pyvista as pv

    image = pv.ImageData(dimensions=(3, 3, 3))
    with pytest.raises(MeshdepictError, match="has no values at its voxels"):
        Volume.from_pyvista(image)
    image.point_data["RGB"] = rng.random((27, 3))
    with pytest.raises(MeshdepictError, match="has 3 values in a voxel, not one"):
        Volume.from_pyvista(image)
    image.point_data["b"] = rng.random(27)
    image.set_active_scalars(None)
    with pytest.raises(MeshdepictError, match=r"several arrays \(RGB, b\)"):
        Volume.from_pyvista(image)
    with pytest.raises(MeshdepictError, match="holds PolyData, not image data"):
        Volume.from_pyvista(pv.Sphere())


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (np.zeros((3, 3)), r"three axes \(z, y, x\), not an array of shape \(3, 3\)"),
        (np.zeros((3, 0, 3)), "the volume is empty"),
        (np.zeros((1, 3, 3)), "a single slice along z"),
        (np.zeros((3, 3, 1)), "a single slice along x"),
        (np.zeros((3, 3, 3)), r"constant: every voxel is 0\.0"),
        (np.full((3, 3, 3), 7), "constant: every voxel is 7"),
        (np.zeros((3, 3, 3), complex), "must be real numbers, not complex128"),
        (np.full((3, 3, 3), "a"), "must be real numbers, not <U1"),
    ],
)
def test_what_is_no_volume_is_refused(wrong, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        Volume(wrong)


@pytest.mark.parametrize("slab", [9, 1 << 22])
def test_nan_are_counted_and_the_first_is_named(rng, monkeypatch, slab):
    monkeypatch.setattr("meshdepict.shapes.volume._SLAB", slab)
    values = rng.random((4, 3, 3))
    values[1, 2, 0] = np.nan
    values[3, 0, 1] = np.inf
    with pytest.raises(
        MeshdepictError, match=r"2 values .* first at voxel \(x, y, z\) = \(0, 2, 1\)"
    ):
        Volume(values)


@pytest.mark.parametrize(
    ("place", "sentence"),
    [
        ({"spacing": (1, 0, 1)}, r"spacing \(1, 0, 1\) is not positive"),
        ({"spacing": (1, -2, 1)}, "is not positive"),
        ({"spacing": (1, np.nan, 1)}, r"spacing=.* is not three finite numbers"),
        ({"spacing": 1}, "is not three finite numbers"),
        ({"origin": ("a", 0, 0)}, r"origin=.* is not three finite numbers"),
        ({"origin": (1e200, 0, 0)}, r"reaches beyond 1e\+150"),
        ({"direction": np.diag((1, 1, 2))}, "orthonormal columns"),
        ({"direction": np.zeros((3, 3))}, "orthonormal columns"),
        ({"direction": np.eye(2)}, "orthonormal columns"),
        ({"direction": np.full((3, 3), np.nan)}, "orthonormal columns"),
        ({"direction": [["x"] * 3] * 3}, "orthonormal columns"),
        ({"direction": [[1, 0.5, 0], [0, 0.866, 0], [0, 0, 1]]}, "resample a skewed grid"),
    ],
)
def test_a_place_that_is_none_is_refused(values, place, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        Volume(values, **place)


def test_volumes_can_be_sent_to_other_processes(values):
    volume = Volume(values, spacing=(1, 2, 3), hounsfield=True, attributes={"modality": "CT"})
    sent = pickle.loads(pickle.dumps(volume))
    np.testing.assert_array_equal(sent.values, values)
    np.testing.assert_array_equal(sent.outline, volume.outline)
    assert (sent.unit, sent.attributes) == ("HU", {"modality": "CT"})


@pytest.mark.parametrize(("slope", "intercept"), [(0, 0), (-1, 0), (np.nan, 0), (1, np.inf)])
def test_rescaling_is_refused_where_it_makes_no_sense(values, slope, intercept):
    with pytest.raises(MeshdepictError, match="take a positive slope and a finite intercept"):
        Volume(values).rescaled(slope, intercept)
    with pytest.raises(MeshdepictError, match="in Hounsfield units already"):
        Volume(values, hounsfield=True).rescaled(1, 0)
