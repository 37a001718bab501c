"""Texture coordinates of meshes that have no picture to lay there, and of those that have."""

import numpy as np
import pytest
from textured_shapes import sheet

from meshdepict.io import read_mesh
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.own_texcoords import own_texcoords
from meshdepict.shapes.textures import Textures

SQUARE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
PLACES = "vt 0 0\nvt 0.5 0\nvt 0 0.5\nvt 0.5 0.5\n"


def test_an_obj_without_materials_has_its_coordinates(tmp_path):
    (tmp_path / "a.obj").write_text(SQUARE + PLACES + "f 1/1 2/2 4/4 3/3\n")
    mesh = read_mesh(tmp_path / "a.obj")
    assert mesh.textures is None
    assert np.array_equal(own_texcoords(mesh)[0], mesh.vertices[mesh.faces][..., :2] / 2)


def test_corners_without_any_and_such_as_are_no_numbers_are_told(tmp_path):
    (tmp_path / "a.obj").write_text(
        SQUARE + PLACES.replace("0.5 0\n", "nan 0\n") + "f 1/1 3/3 4/4\nf 1/1 2/2 4/4\nf 1 2 3\n"
    )
    _, placed = own_texcoords(read_mesh(tmp_path / "a.obj"))
    assert placed.tolist() == [True, False, False]


@pytest.mark.parametrize("names", [("s", "t"), ("u", "v"), ("texture_u", "texture_v")])
def test_vertices_may_have_them(names):
    flat = sheet(3)
    at = flat.vertices[:, :2].astype(np.float32)
    mesh = Mesh(
        flat.vertices, flat.faces, attributes={"vertex": dict(zip(names, at.T, strict=True))}
    )
    assert np.allclose(own_texcoords(mesh)[0], flat.texcoords)


def test_a_triangle_without_a_material_and_places_has_none():
    flat = sheet(2)
    texcoords, material = flat.texcoords.copy(), np.zeros(len(flat.faces), np.int64)
    texcoords[3, 1], material[3] = 0, -1  # one corner is enough
    mesh = flat.with_textures(
        Textures(texcoords, material, (None,), np.ones((1, 4)), (None,), np.ones(1))
    )
    assert np.flatnonzero(~own_texcoords(mesh)[1]).tolist() == [3]


def test_most_meshes_have_none():
    assert own_texcoords(Mesh(np.eye(3), [[0, 1, 2]])) is None
