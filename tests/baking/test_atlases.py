"""Which texture coordinates a bake takes, and what is wrong with some."""

import numpy as np
import pytest
from textured_shapes import globe, laid, sheet

from meshdepict import samples
from meshdepict.baking.atlases import atlas_of
from meshdepict.baking.texture_choices import ATLASES
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.shapes.textures import Textures


def test_a_mesh_keeps_its_own_coordinates_unless_others_are_asked_for():
    mesh = globe(6)
    own = atlas_of(mesh, 128)
    assert own.kind == "own"
    assert own.mipmaps
    assert np.array_equal(own.texcoords, mesh.texcoords)
    new = atlas_of(mesh, 128, "new")
    assert new.kind == "new"
    assert not new.mipmaps
    assert new.gutter == 24
    assert not np.array_equal(new.texcoords, mesh.texcoords)


def test_a_mesh_without_coordinates_gets_new_ones():
    ball = samples.golf_ball(300)
    assert atlas_of(ball, 256).kind == "new"
    with pytest.raises(MeshdepictError, match="has no texture coordinates: leave --atlas own out"):
        atlas_of(ball, 256, "own")


def test_gutters_are_wide_enough_for_sixteenths():
    assert atlas_of(globe(6), 128).gutter == 24


def test_an_atlas_of_another_name_is_refused():
    with pytest.raises(MeshdepictError, match=f"atlas='best' is none of {', '.join(ATLASES)}"):
        atlas_of(globe(4), 64, "best")


def test_mirrored_halves_that_share_texels_are_refused_until_a_new_atlas_is_asked_for():
    mesh = sheet(6)
    folded = laid(mesh, np.abs(mesh.texcoords - (0.5, 0)) * (1, 0.9))
    with pytest.raises(MeshdepictError, match=r"overlap.*100% of their texels.*--atlas new"):
        atlas_of(folded, 128)
    assert atlas_of(folded, 128, "new").kind == "new"


def test_a_pattern_that_repeats_is_refused_after_wrapping():
    mesh = sheet(6)
    for moved in (mesh.texcoords * 3, mesh.texcoords * (2, 0.5)):
        with pytest.raises(MeshdepictError, match="overlap in texture coordinates"):
            atlas_of(laid(mesh, moved), 128)


def test_coordinates_outside_the_square_wrap():
    mesh = sheet(6)
    moved = atlas_of(laid(mesh, mesh.texcoords * 0.9 + (0.5, 1.5)), 128)
    assert moved.kind == "own"
    assert moved.grid.claims(0, 128).shared == 0


def test_several_materials_in_one_square_are_named():
    mesh = globe(4)
    both = mesh.textures
    alike = np.tile(both.texcoords[: len(both.texcoords) // 6], (6, 1, 1))
    material = np.arange(6).repeat(len(both.texcoords) // 6)
    several = mesh.with_textures(
        Textures(alike, material, (None,) * 6, np.ones((6, 4)), (None,) * 6, np.ones(6))
    )
    with pytest.raises(MeshdepictError, match="its 6 materials, or mirrored or repeated parts"):
        atlas_of(several, 128)


def test_an_overlap_of_few_texels_is_said_and_goes():
    mesh = sheet(6)
    texcoords = mesh.texcoords.copy() * 0.98
    texcoords[0] += (0.02, 0.005)
    with pytest.warns(MeshdepictWarning, match=r"triangles overlap others in the atlas, by \d+"):
        atlas_of(laid(mesh, texcoords), 256)


def test_triangles_without_coordinates_are_counted():
    mesh = sheet(3)
    texcoords, material = mesh.texcoords.copy(), np.zeros(len(mesh.faces), np.int64)
    texcoords[4:6], material[4:6] = 0, -1
    some = mesh.with_textures(
        Textures(texcoords, material, (None,), np.ones((1, 4)), (None,), np.ones(1))
    )
    with pytest.raises(
        MeshdepictError, match="2 of 18 triangles have no texture coordinates, the first is 4"
    ):
        atlas_of(some, 64)
    none = mesh.with_textures(
        Textures(0 * texcoords, 0 * material - 1, (None,), np.ones((1, 4)), (None,), np.ones(1))
    )
    assert atlas_of(none, 128).kind == "new"
    with pytest.raises(MeshdepictError, match="no texture coordinates"):
        atlas_of(none, 128, "own")


def test_coordinates_that_cover_no_texel_are_replaced_with_a_note():
    mesh = sheet(3)
    for flat in (np.full_like(mesh.texcoords, 0.3), mesh.texcoords * (1, 0)):
        with pytest.warns(MeshdepictWarning, match="cover no texel.*: a new atlas is made"):
            found = atlas_of(laid(mesh, flat), 64)
        assert np.array_equal(found.texcoords, atlas_of(mesh, 64, "new").texcoords)
        with pytest.raises(MeshdepictError, match=r"cover no texel.*\(--atlas new\)"):
            atlas_of(laid(mesh, flat), 64, "own")


def test_surface_that_is_smaller_than_a_texel_is_said():
    mesh = sheet(6)
    texcoords = mesh.texcoords.copy()
    texcoords[::4] = texcoords[::4].mean(axis=1, keepdims=True)
    with pytest.warns(MeshdepictWarning, match="25% of the surface, in 18 triangles, is smaller"):
        atlas_of(laid(mesh, texcoords), 64)


def test_xatlas_is_one_of_them():
    pytest.importorskip("xatlas")
    found = atlas_of(samples.golf_ball(300), 256, "xatlas")
    assert found.kind == "xatlas"
    assert found.mipmaps
    assert found.grid.claims(0, 256).shared == 0
