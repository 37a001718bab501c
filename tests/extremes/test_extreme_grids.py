"""Volumes, terrain and pictures at the ends of what they can hold."""

from __future__ import annotations

import numpy as np
import pytest
from extreme_calls import always, proper, refused, taken_or_refused, usual, variants
from hypothesis import given
from hypothesis import strategies as st
from method_families import ON_MESHES

import meshdepict as md
from meshdepict.shading import METHODS
from meshdepict.shapes.isosurface import isosurface

pytestmark = pytest.mark.filterwarnings("ignore::meshdepict.MeshdepictWarning")


def hill(rows, columns):
    return 3 * np.cos(np.arange(rows))[:, None] + np.sin(np.arange(columns))


def cells(across, down=None, x=0.0, y=0.0):
    return {"transform": (across, 0, x, 0, -(down or across), y)}


TERRAINS = {
    "one cell": ([[3.0]], {}),
    "one row": (hill(1, 9), {}),
    "one column": (hill(9, 1), {}),
    "level": (np.full((5, 6), 7.0), {}),
    "one height": (np.where(np.arange(30).reshape(5, 6) == 14, 1, np.nan), {}),
    "every other cell": (np.where(np.indices((7, 8)).sum(axis=0) % 2, np.nan, hill(7, 8)), {}),
    "1e32": (2e31 * hill(7, 8), {}),
    "1e-300": (1e-300 * hill(7, 8), {}),
    "denormal": (5e-324 * np.round(hill(7, 8)), {}),
    "single and denormal": (np.float32(1e-45) * np.round(hill(7, 8)).astype("f4"), {}),
    "a spike": (np.where(np.arange(56).reshape(7, 8) == 20, 1e12, 0.0), {}),
    "1e15 above the sea": (1e15 + 100 * hill(7, 8), {}),
    "cells of a picometre": (1e-12 * hill(7, 8), cells(1e-12)),
    "cells of 1e12 metres": (1e12 * hill(7, 8), cells(1e12)),
    "steep": (hill(7, 8), cells(1e-9)),
    "long cells": (hill(7, 8), cells(1e-6, 1e6)),
    "far away": (hill(7, 8), cells(1, 1, 1e14, -1e14)),
    "degrees at the pole": (hill(7, 8), cells(1, 1, 0, 90) | {"degrees": True}),
    "the world": (hill(18, 36), cells(10, 10, -180, 90) | {"degrees": True}),
}

BEYOND = {
    "NaN alone": (np.full((3, 3), np.nan), {}, "none of 9 cells holds a height"),
    "what stands for no height": (
        np.array([[-3.4e38, 1], [2, 3]], np.float32), {}, "mark the cells that hold none"),
    "1e300": (1e300 * hill(3, 3), {}, "heights reach from"),
    "no area": (hill(3, 3), cells(1e-300), "no area"),
    "tiny cells": (hill(3, 3), cells(1e-30), "not between 1e-12 and 1e\\+12 m"),
    "huge cells": (hill(3, 3), cells(1e30), "not between 1e-12 and 1e\\+12 m"),
    "too far": (hill(3, 3), cells(1, 1, 1e300), "cells can't be told apart"),
}  # fmt: skip


@pytest.mark.parametrize("name", TERRAINS)
def test_every_method_shades_terrain(name):
    z, place = TERRAINS[name]
    field = md.HeightField(z, **place)
    space = md.scale_space(field, scales=2)
    for method in METHODS:
        ways = variants(method)
        if "openness" in method:
            ways = [{"horizon": "lines"}, {"horizon": "cells"}]
        for options in ways:
            with taken_or_refused():  # rays need a surface
                proper(METHODS[method](space, "northwest", **options), space.count)
    for width in ("1e-300cells", 5e-324, 1e300):
        with taken_or_refused():
            proper(md.bake(field, "exaggerated", scales=1, width=width).intensity, field.count)


@pytest.mark.parametrize("name", BEYOND)
def test_what_is_beyond_is_refused_at_the_door(name):
    z, place, said = BEYOND[name]
    with pytest.raises(md.MeshdepictError, match=said):
        md.HeightField(z, **place)


def test_cells_that_a_mask_hides_hold_no_height():
    z = np.ma.masked_array(hill(3, 4).astype("f4"), np.eye(3, 4, dtype=bool))
    field = md.HeightField(z)
    assert field.z.dtype == np.float32
    np.testing.assert_array_equal(field.valid, ~np.eye(3, 4, dtype=bool))
    np.testing.assert_array_equal(md.HeightField(z.astype("i2")).valid, field.valid)


def test_a_width_is_a_limit_on_cells_and_voxels():
    point, all_ = ({"scales": 1, "width": width} for width in (1e-300, 1e300))
    field = md.HeightField(hill(7, 8), **cells(1e-9))
    own = md.scale_space(field, **point)
    np.testing.assert_array_equal(own.normals_at(1), own.normals_at(0))
    one = md.scale_space(field, **all_).normals_at(1)
    assert np.abs(one - one[0]).max() < 1e-5
    volume = md.Volume(ball(), spacing=(1e9, 1e9, 1e9))
    own = md.scale_space(volume, **point)
    np.testing.assert_allclose(own.normals_at(1), own.normals_at(0), atol=1e-6)


# --- volumes ------------------------------------------------------------------------------------


def ball():
    z, y, x = np.mgrid[:7, :8, :9] - np.array([3, 4, 4]).reshape(3, 1, 1, 1)
    return 100 - 30 * np.sqrt(x**2 + y**2 + z**2)


VOLUMES = {
    "two by two by two": (np.arange(8.0).reshape(2, 2, 2), {}),
    "two by two by many": (np.arange(40.0).reshape(2, 2, 10), {}),
    "voxels of 1e-9": (ball(), {"spacing": (1e-9,) * 3}),
    "voxels of 1e9": (ball(), {"spacing": (1e9,) * 3}),
    "voxels of 1e-9 by 1 by 1e9": (ball(), {"spacing": (1e-9, 1, 1e9)}),
    "voxels of 1e-140": (ball(), {"spacing": (1e-140,) * 3}),
    "voxels of 1e140": (ball(), {"spacing": (1e140,) * 3}),
    "far away": (ball(), {"origin": (1e8, -1e8, 1e8)}),
    "1e300": (1e300 * ball(), {}),
    "1e-290": (1e-290 * ball(), {}),
    "both ends of double precision": (1.7e308 * np.sign(ball()), {}),
    "both ends of single precision": ((3.4e38 * np.sign(ball())).astype("f4"), {}),
    "single and denormal": ((1e-44 * np.sign(ball())).astype("f4"), {}),
    "both ends of 64 bits": (np.where(ball() > 0, 2**63 - 1, -(2**63)), {}),
    "on a large number": (1e12 + ball(), {}),
    "yes and no": (ball() > 0, {}),
    "one voxel": ((np.arange(504) == 250).reshape(7, 8, 9).astype("f4"), {}),
}

NO_VOLUMES = {
    "one by one by many": (np.arange(9.0).reshape(1, 1, 9), {}, "a single slice"),
    "constant": (np.full((3, 4, 5), 7.0), {}, "is constant"),
    "constant but for rounding": (
        np.where(ball() > 0, 1 + 2e-16, 1.0), {}, "as good as constant"),
    "denormal": (1e-320 * ball(), {}, "as good as constant"),
    "NaN": (np.where(ball() > 0, np.nan, 1.0), {}, "NaN or infinite"),
    "infinite": (np.where(ball() > 0, np.inf, 1.0), {}, "NaN or infinite"),
    "tiny": (ball(), {"spacing": (1e-300,) * 3}, "smaller than 1e-150"),
    "huge": (ball(), {"spacing": (1e300,) * 3}, "beyond 1e\\+150"),
    "too far": (ball(), {"origin": (1e39, 0, 0)}, "can't be told apart"),
}  # fmt: skip


@pytest.mark.parametrize("name", VOLUMES)
def test_every_method_shades_a_volume(name):
    values, place = VOLUMES[name]
    volume = md.Volume(values, **place)
    space = md.scale_space(volume, scales=2)
    for method in ON_MESHES:
        for options in variants(method):
            with taken_or_refused():  # rays and areas need a surface
                proper(METHODS[method](space, "northwest", **options), space.count)
    with taken_or_refused():  # a preset may show nothing of it
        md.bake_volume(volume, "exaggerated", scales=2)
    for width in (5e-324, 1e300):
        with taken_or_refused():
            assert np.isfinite(md.scale_space(volume, scales=2, width=width).normals).all()
    low, high = volume.range
    with taken_or_refused():
        surface = isosurface(volume, low / 2 + high / 2)
        proper(md.bake(surface, "lambert").intensity, len(surface.vertices))


@pytest.mark.parametrize("name", NO_VOLUMES)
def test_what_is_no_volume_is_refused_at_the_door(name):
    values, place, said = NO_VOLUMES[name]
    with pytest.raises(md.MeshdepictError, match=said):
        md.Volume(values, **place)


def test_values_whose_difference_is_no_number_have_no_surface():
    volume = md.Volume(1.7e308 * np.sign(ball()))
    assert "whose difference is no number" in refused(lambda: isosurface(volume, 0.0))


def test_air_and_object_are_told_apart_in_any_unit():
    from meshdepict.color.transfer import landmarks

    plain = landmarks(md.Volume(ball()))
    for exponent in (-900, 900):
        found = landmarks(md.Volume(np.ldexp(ball(), exponent)))
        assert found == tuple(np.ldexp(plain, exponent))


# --- pictures -----------------------------------------------------------------------------------

FLAT = np.tile([0.0, 0.0, 1.0], (42, 1))
MASK = np.ones((6, 7), bool)
EYES = {
    "parallel": md.View((0, 0, 5), (0, 0, 0), (0, 1, 0), height_px=6, parallel_scale=3),
    "perspective": md.View((0, 0, 5), (0, 0, 0), (0, 1, 0), height_px=6, field_of_view=30),
}


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("depth", [1e-150, 1e-30, 1.0, 1e29, 1e150])
@pytest.mark.parametrize("alike", [True, False])
def test_every_method_shades_depths_near_and_far(eye, depth, alike):
    depths = np.full(42, depth)
    if not alike:
        depths[::5] = 1.0
    with taken_or_refused():
        space = md.scale_space(md.GBuffer(EYES[eye], MASK, FLAT, depths), scales=2)
        for method in ON_MESHES:
            with taken_or_refused():  # rays need a surface
                proper(METHODS[method](space, "northwest", **usual(method)), 42)
        return
    assert not alike or depth > 1


@pytest.mark.parametrize(
    ("eye", "depth", "said"),
    [("parallel", 1e200, "may be -1e\\+150 to 1e\\+150"), ("perspective", 1e200, "leave no room"),
     ("perspective", 5e-324, "may be 1e-150 to"), ("parallel", 1e40, "pixels of 1 apart")],
)  # fmt: skip
def test_depths_beyond_are_refused(eye, depth, said):
    depths = np.ones(42)
    depths[5] = depth
    with pytest.raises(md.MeshdepictError, match=said):
        md.GBuffer(EYES[eye], MASK, FLAT, depths)


@st.composite
def rasters(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    shape = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    z = rng.normal(size=shape) * 10.0 ** draw(st.integers(-300, 7))
    z[rng.random(shape) < draw(st.floats(0, 0.9))] = np.nan
    z[rng.random(shape) < 0.2] = rng.normal() * 10.0 ** draw(st.integers(-20, 7))
    sides = 10.0 ** rng.uniform(-12, 12, 2)
    return z, cells(
        *sides, *(rng.normal(size=2) * sides.min() * draw(st.sampled_from([0, 1e6, 1e14])))
    )


@always(120)
@given(raster=rasters(), method=st.sampled_from(list(METHODS)), choices=st.data())
def test_any_terrain(raster, method, choices):
    z, place = raster
    with taken_or_refused():
        space = md.scale_space(md.HeightField(z, **place), scales=1)
        options = choices.draw(st.sampled_from(variants(method)))
        proper(METHODS[method](space, "northwest", **options), space.count)
