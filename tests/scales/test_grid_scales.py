"""The scale space of a volume: exact normals of a Gaussian blob, extremes, and every method."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import angle_between, rotation

from meshdepict.color.transfer import TransferFunction
from meshdepict.errors import MeshdepictError
from meshdepict.samples.phantom import ct_phantom
from meshdepict.scales.grid_making import grid_space
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.shading import METHODS, declaration
from meshdepict.shapes.volume import Volume
from meshdepict.voxels.length_unit import MILLIMETRES

BONE = TransferFunction([(200, 0, (1, 0.9, 0.8)), (400, 1, (1, 1, 1))])


def ladder(first: float, scales: int) -> np.ndarray:
    return np.concatenate(([0.0], first * np.sqrt(2) ** np.arange(scales)))


def blob(spacing, direction, origin=(0.0, 0.0, 0.0), size=26.0) -> tuple[Volume, np.ndarray]:
    """A Gaussian blob exp(−½ xᵀ S⁻¹ x) in the middle of a box, and S."""
    spacing, direction = np.array(spacing, float), np.array(direction, float)
    counts = np.ceil(size / spacing).astype(int)
    middle = direction @ (spacing * (counts - 1) / 2)
    frame = Volume(
        np.arange(counts.prod()).reshape(counts[::-1]),
        spacing=spacing, origin=np.array(origin) - middle, direction=direction,
    )  # fmt: skip
    form = np.array([[9.0, 2.0, 0.0], [2.0, 6.0, -1.0], [0.0, -1.0, 5.0]])
    x, y, z = np.meshgrid(*(np.arange(n) for n in counts), indexing="ij")
    at = frame.to_world(np.stack([x, y, z], -1).transpose(2, 1, 0, 3)) - np.array(origin)
    values = np.exp(-0.5 * np.einsum("...i,ij,...j", at, np.linalg.inv(form), at))
    volume = Volume(values, spacing=spacing, origin=frame.origin, direction=direction)
    return volume, form


@pytest.fixture(scope="module")
def head() -> GridSpace:
    return grid_space(ct_phantom((40, 36, 32), noise=5), ladder(8, 3), 2**0.5, transfer=BONE)


@pytest.mark.parametrize("case", ["cubes", "boxes", "oblique", "left-handed"])
def test_normals_are_those_of_the_smoothed_field(case: str, rng: np.random.Generator) -> None:
    # A Gaussian under a Gaussian of width σ has S + σ² in place of S: exact, on any grid.
    direction = rotation(rng) if case in ("oblique", "left-handed") else np.eye(3)
    if case == "left-handed":
        direction = direction * (1, 1, -1)
    spacing = (1, 1, 1) if case == "cubes" else (0.8, 1.0, 1.3)
    volume, form = blob(spacing, direction)
    widths = np.array([0.0, 1.4, 2.0, 2.8])
    space = grid_space(volume, widths, 2**0.5, where=volume.values > 0.2)
    for width, normals in zip(widths[1:], space.normals[1:], strict=True):
        outwards = space.points @ np.linalg.inv(form + width**2 * np.eye(3))
        outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
        away = np.linalg.norm(space.points, axis=1) > 1.0  # in the middle there is no gradient
        # A kernel of 1.08 voxels (1.4 / 1.3) is off by e^−2π²σ² = 1e-10; the box cuts the blob
        # where it has fallen to e^−½·13²/9 = 8e-5, and mirrors what is left.
        assert angle_between(normals, outwards)[away].max() < 1e-3


def test_scale_0_is_the_central_difference() -> None:
    volume, _ = blob((0.8, 1.0, 1.3), np.eye(3))
    space = grid_space(volume, ladder(1, 1), 2**0.5)
    gz, gy, gx = np.gradient(volume.values, *volume.spacing[::-1])
    z, y, x = (slice(1, -1),) * 3
    expected = -np.stack([gx, gy, gz], -1)[z, y, x]
    length = np.linalg.norm(expected, axis=-1)
    found = np.zeros((*volume.values.shape, 3))
    found.reshape(-1, 3)[space.voxels] = space.normals[0]
    sizes = np.zeros(volume.values.shape)
    sizes.reshape(-1)[space.voxels] = space.gradient
    clear = length > 1e-3
    unit = expected[clear] / length[clear][:, None]
    assert angle_between(found[z, y, x][clear], unit).max() < 1e-4
    np.testing.assert_allclose(sizes[z, y, x][clear], length[clear], rtol=1e-4)


@pytest.mark.parametrize("unit", [1e-12, 1e12])
def test_units_do_not_matter(unit: float) -> None:
    volume = ct_phantom((24, 20, 28), noise=5)
    widths = ladder(12, 3)
    plain = grid_space(volume, widths, 2**0.5, transfer=BONE)
    other = Volume(
        volume.values, spacing=volume.spacing * unit, origin=volume.origin * unit + 1e3 * unit
    )
    space = grid_space(other, widths * unit, 2**0.5, transfer=BONE)
    assert angle_between(space.normals, plain.normals).max() < 1e-5
    ours, theirs = space.curvature(1), plain.curvature(1)
    np.testing.assert_allclose(ours.k1 * unit, theirs.k1, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize(
    ("kind", "low", "high"),
    [
        (np.int16, -32768, 32767),
        (np.uint8, 0, 1),
        (np.float32, -3e38, 3e38),
        (np.float32, 0, 1e-38),
        (np.float64, -1.7e308, 1.7e308),
        (np.float64, 1e9, 1e9 + 1e-3),
        (np.int64, -(2**62), 2**62),
    ],
)
def test_extreme_values_give_unit_normals(kind: type, low: float, high: float) -> None:
    volume = ct_phantom((24, 20, 22))
    share = (volume.values > 0).astype(np.float64)
    middle, half = low / 2 + high / 2, high / 2 - low / 2
    values = (middle + half * (2 * share - 1)).astype(kind)
    scaled = Volume(values, spacing=volume.spacing)
    space = grid_space(scaled, ladder(8, 4), 2**0.5)
    np.testing.assert_allclose(np.linalg.norm(space.normals, axis=2), 1, atol=1e-6)
    for scale in range(5):
        assert np.isfinite(space.curvature(scale).k1).all()
    plain = grid_space(Volume(share, spacing=volume.spacing), ladder(8, 4), 2**0.5)
    if kind is not np.float64 or low != 1e9:  # whose values are rounded to 1e-4 of the range
        assert len(space.points) == len(plain.points)
        assert angle_between(space.normals[-1], plain.normals[-1]).max() < 1e-2


def test_without_a_gradient_the_next_finer_normal_is_kept() -> None:
    values = np.zeros((24, 24, 24))
    values[:, :, 12:] = 1
    values[:, :, 13:] = 0  # a thin sheet, seen from both sides
    space = grid_space(Volume(values), ladder(1, 12), 2**0.5, where=values < 0.5)
    # Where the sheet is just felt, rounding (1e-7 of the range) turns the least gradients (1e-6).
    assert (np.abs(space.normals[..., 0]) > 0.99).all()
    # 64 voxels are more than two axes' lengths: nothing is left of the sheet, so the coarsest
    # normals are those of the scale before.
    np.testing.assert_array_equal(space.normals[-1], space.normals[-2])
    # Far from the sheet only a wide Gaussian reaches it, and finer scales take its normal.
    far = space.points[:, 0] < 8
    np.testing.assert_allclose(space.normals[0][far], [[-1, 0, 0]] * int(far.sum()), atol=0.1)


@pytest.mark.parametrize("width", [1e3, 1e9, 1e300])
def test_a_width_beyond_the_volume_adds_nothing(width: float) -> None:
    volume = ct_phantom((24, 20, 22))
    space = grid_space(volume, np.array([0, 20, width]), 2**0.5, transfer=BONE)
    np.testing.assert_array_equal(space.normals[2], space.normals[1])
    assert (space.curvature(2).k1 == 0).all()
    assert np.isfinite(space.mean(space.points[:, 0], width)).all()


def test_what_has_no_gradient_at_all_is_no_sample() -> None:
    values = np.zeros((30, 8, 8))
    values[0] = 1
    space = grid_space(Volume(values), ladder(1, 1), 2**0.5)
    assert len(space.points) + len(space.flat) == values.size
    assert space.points[:, 2].max() < 8
    assert space.flat.low[0] == 0
    assert space.shaded_share == len(space.points) / values.size


def test_gradient_opacity_hides_what_is_even(head: GridSpace) -> None:
    points = zip(BONE.values, BONE.opacities, BONE.colors, strict=True)
    edges = TransferFunction(points, gradient_opacity=[(20, 0), (60, 1)])
    space = grid_space(head.shape, head.widths, head.ratio, transfer=edges)
    assert 0 < len(space.points) < len(head.points)
    shown = np.isin(head.voxels, space.voxels[space.alpha > 0])
    np.testing.assert_array_equal(shown, (head.gradient > 20.1) & (head.alpha > 0) | shown)
    assert (head.gradient[shown] > 20).all()
    np.testing.assert_array_equal(space.normals[2][space.alpha > 0], head.normals[2][shown])


@pytest.mark.parametrize("unit", sorted(MILLIMETRES))
def test_gradient_opacity_is_per_mm_in_any_unit_of_length(head: GridSpace, unit: str) -> None:
    """The same object in µm, mm or m is shown alike; without a unit its own counts as mm."""
    points = list(zip(BONE.values, BONE.opacities, BONE.colors, strict=True))
    edges = TransferFunction(points, gradient_opacity=[(20, 0), (60, 1)])
    wanted = grid_space(head.shape, head.widths, head.ratio, transfer=edges)
    size, volume = MILLIMETRES[unit], head.shape
    same = Volume(
        volume.values, spacing=volume.spacing / size, origin=volume.origin / size,
        direction=volume.direction, hounsfield=True, length_unit=unit,
    )  # fmt: skip
    found = grid_space(same, head.widths / size, head.ratio, transfer=edges)
    np.testing.assert_array_equal(found.voxels, wanted.voxels)
    np.testing.assert_allclose(found.alpha, wanted.alpha, atol=1)
    assert (wanted.alpha < 255).any()
    np.testing.assert_allclose(found.gradient, wanted.gradient * size, rtol=1e-5)


def test_what_is_beside_the_shown_is_shaded_without_opacity(head: GridSpace) -> None:
    shown = head.shape.values.ravel()[head.voxels] > 200
    np.testing.assert_array_equal(head.alpha > 0, shown)
    assert 0 < shown.mean() < 1


def test_means_are_averages_over_the_samples(head: GridSpace, rng: np.random.Generator) -> None:
    values, width = rng.random(len(head.points)), 12.0
    found = head.mean(values, width)
    some = rng.integers(0, len(values), 50)
    squared = ((head.points[some, None] - head.points[None]) ** 2).sum(axis=2)
    weights = np.exp(-0.5 * squared / width**2)
    expected = weights @ values / weights.sum(axis=1)
    near = (np.abs(head.points[some]) < 120 - 3 * width).all(axis=1)  # the border mirrors
    np.testing.assert_allclose(found[some][near], expected[near], atol=2e-3)
    np.testing.assert_allclose(head.mean(np.full(len(values), 0.25), width), 0.25, rtol=1e-5)


def test_creases_are_the_least_cosines_to_the_six_neighbours(head: GridSpace) -> None:
    found, normals = head._turns(1), head.normals[1].astype(float)
    nz, ny, nx = head.shape.values.shape
    at = {int(v): i for i, v in enumerate(head.voxels)}
    for i in range(0, len(normals), 97):
        z, y, x = np.unravel_index(head.voxels[i], (nz, ny, nx))
        least = 1.0
        for dz, dy, dx in np.concatenate((np.eye(3, dtype=int), -np.eye(3, dtype=int))):
            a, b, c = z + dz, y + dy, x + dx
            if 0 <= a < nz and 0 <= b < ny and 0 <= c < nx:
                j = at.get(int((a * ny + b) * nx + c))
                least = least if j is None else min(least, normals[i] @ normals[j])
        assert found[i] == pytest.approx(least, abs=1e-6)


@pytest.mark.parametrize("name", METHODS)
def test_every_method_that_needs_no_surface_shades_voxels(name: str, head: GridSpace) -> None:
    if declaration(METHODS[name]).needs & {"rays", "areas", "heights"}:
        with pytest.raises(MeshdepictError, match=r"need.* a volume (is|have|has) none"):
            METHODS[name](head, "northwest")
        return
    values = METHODS[name](head, "northwest")
    assert values.shape[0] == len(head.points)
    assert np.isfinite(values).all()
    assert values.min() >= 0
    assert values.max() <= 1
    assert np.ptp(values) > 0.1


def test_progress_ends_with_the_total() -> None:
    told = []
    volume = ct_phantom((20, 20, 20))
    grid_space(
        volume, ladder(12, 3), 2**0.5, transfer=BONE, progress=lambda *done: told.append(done)
    )
    assert told[-1] == (pytest.approx(3), 3)
    assert told == sorted(told)


def test_wrong_input_says_so(head: GridSpace) -> None:
    volume, widths = head.shape, head.widths
    with pytest.raises(MeshdepictError, match=r"where has shape \(2, 3\)"):
        grid_space(volume, widths, 2.0, where=np.ones((2, 3), bool))
    with pytest.raises(MeshdepictError, match="no voxel of the volume is shown"):
        grid_space(volume, widths, 2.0, where=np.zeros(volume.values.shape, bool))
    with pytest.raises(MeshdepictError, match=r"more than the 0\.001 GB allowed"):
        grid_space(volume, widths, 2.0, memory=1e6)
    even = np.zeros((30, 8, 8))
    even[0] = 1
    with pytest.raises(MeshdepictError, match="all alike"):
        grid_space(Volume(even), widths[:1], 2.0, where=even < np.arange(30)[:, None, None] - 9)
