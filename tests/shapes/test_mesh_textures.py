"""Textures: what lies between texels and beyond edges, and the colours at vertices."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import meshdepict as md
from meshdepict.color.srgb import linear_to_srgb, srgb_to_linear
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.images.encoded import encode
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.parted import parted_at_creases
from meshdepict.shapes.texture_colors import texture_colors
from meshdepict.shapes.textures import WRAPS, Texture, Textures, laid_textures
from meshdepict.surface.icosahedron import icosphere


def texture(pixels: np.ndarray, u: str = "repeat", v: str = "repeat") -> Texture:
    return Texture("made.png", encode(pixels), "png", (u, v))


def ramp(size: int = 64, kind: type = np.uint16) -> np.ndarray:
    """A picture whose red is u and whose green is v, at the centres of texels."""
    largest = np.iinfo(kind).max
    u = (np.arange(size) + 0.5) / size
    channels = np.broadcast_arrays(u[None, :], 1 - u[:, None], 0.5)
    return np.rint(largest * np.stack(channels, axis=2)).astype(kind)


def textures(
    mesh: Mesh, laid: Texture | None, factor: tuple[float, ...] = (1, 1, 1, 1)
) -> Textures:
    """A texture on a mesh from above: x and y are its coordinates."""
    count = len(mesh.faces)
    return Textures(
        mesh.vertices[mesh.faces][..., :2], np.zeros(count, np.int64), (laid,),
        np.array([factor], float), (None,), np.ones(1),
    )  # fmt: skip


@pytest.mark.parametrize(("kind", "step"), [(np.uint8, 1 / 255), (np.uint16, 1 / 65535)])
def test_a_ramp_is_read_as_it_is_between_the_centres_of_texels(rng, kind, step):
    at = rng.uniform(1 / 128, 1 - 1 / 128, (1000, 2))
    found = texture(ramp(kind=kind)).lookup(at)
    np.testing.assert_allclose(found[:, :2], at, atol=step)
    assert found.dtype == np.float32


@pytest.mark.parametrize("u", WRAPS)
@pytest.mark.parametrize("v", WRAPS)
def test_beyond_the_edges_is_what_a_larger_picture_would_show(rng, u, v):
    """One that is put together from copies, with nothing beyond."""
    pixels = rng.integers(0, 256, (5, 7, 3)).astype(np.uint8)
    modes = {"repeat": "wrap", "mirror": "symmetric", "clamp": "edge"}
    wide = np.pad(pixels, ((0, 0), (14, 14), (0, 0)), mode=modes[u])
    large = np.pad(wide, ((10, 10), (0, 0), (0, 0)), mode=modes[v])
    at = rng.uniform(-1.5, 2.5, (500, 2))
    inside = (at + 2) / 5
    expected = texture(large, "clamp", "clamp").lookup(inside)
    np.testing.assert_allclose(texture(pixels, u, v).lookup(at), expected, atol=2e-5)


def test_coordinates_that_are_none_count_as_zero():
    laid = texture(ramp())
    odd = [[np.nan, 0.3], [np.inf, 0.3], [0, 0.3]]
    found = laid.lookup(odd)
    np.testing.assert_array_equal(found[:2], found[[2, 2]])
    assert np.isfinite(laid.lookup([[1e300, -1e300], [1e18, 3]])).all()


def test_a_grey_picture_has_three_channels_and_alpha_is_left_out():
    assert texture(ramp()[..., 0]).pixels.shape == (64, 64, 3)
    clear = np.dstack([ramp(4, np.uint8), np.zeros((4, 4), np.uint8)])
    np.testing.assert_array_equal(texture(clear).lookup([[0.125, 0.875]])[0] * 255, clear[0, 0, :3])


def test_pixels_are_decoded_once_and_not_to_be_changed():
    laid = texture(ramp())
    assert laid.pixels is laid.pixels
    with pytest.raises(ValueError, match="read-only"):
        laid.pixels[0] = 0


def test_a_texture_without_a_picture_says_why():
    with pytest.raises(
        MeshdepictError, match="the mesh's file holds no picture for the texture 'x'"
    ):
        _ = Texture("x", None).pixels
    with pytest.raises(MeshdepictError, match="the mesh's file names it wrongly"):
        _ = Texture("x", None, fault="names it wrongly").pixels
    with pytest.raises(MeshdepictError, match="the texture 'x' can't be read as a picture"):
        _ = Texture("x", b"nothing").pixels


def test_parts_that_do_not_fit_are_refused():
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    whole = textures(mesh, None)
    for change, said in (
        ({"normal_maps": ()}, "a base colour, factors"),
        ({"texcoords": np.zeros((1, 3, 3))}, "textures need coordinates"),
        ({"normal_texcoords": np.zeros((2, 3, 2))}, "textures need coordinates"),
        ({"material": np.array([1])}, "a triangle's material is none of the 1"),
        ({"texcoords": np.full((1, 3, 2), np.nan)}, "texture coordinates are NaN or infinite"),
    ):
        with pytest.raises(MeshdepictError, match=said):
            replace(whole, **change)
    with pytest.raises(MeshdepictError, match="textures of 1 triangles don't fit a mesh of 2"):
        Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 2]], textures=whole)
    for wrong in (True, [whole]):
        with pytest.raises(MeshdepictError, match="are neither Textures nor a function"):
            Mesh(mesh.vertices, mesh.faces, textures=wrong)
    assert Mesh(mesh.vertices, mesh.faces, textures=whole).textures is whole
    assert Mesh(mesh.vertices, mesh.faces, textures=lambda: whole).textures is whole
    assert Mesh(mesh.vertices, mesh.faces, textures=lambda: None).textures is None


def test_a_mesh_without_textures_has_none():
    assert md.samples.sphere(12).textures is None
    assert md.samples.sphere(12).texcoords is None


def test_what_a_file_lays_nowhere_is_none():
    uv = np.zeros((2, 3, 2))
    assert laid_textures(uv, np.array([-1, 5]), [None], np.ones((1, 4)), [None], np.ones(1)) is None
    with pytest.warns(MeshdepictWarning, match="all triangles with a texture have no coordinates"):
        made = laid_textures(
            uv * np.nan, np.zeros(2), [texture(ramp())], np.ones((1, 4)), [None], np.ones(1)
        )
    assert made is None


# --- colours at vertices ------------------------------------------------------------------------


def flat(*, textured: bool = True, factor: tuple[float, ...] = (1, 1, 1, 1)) -> Mesh:
    """A square of four by four cells, on which a ramp lies."""
    x, y = np.meshgrid(np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 5))
    points = np.c_[x.ravel(), y.ravel(), np.zeros(25)]
    corners = np.array([k for k in range(19) if k % 5 < 4])
    faces = np.stack([corners, corners + 1, corners + 6, corners + 5], axis=1)
    bare = Mesh(points, faces)
    laid = textures(bare, texture(ramp()), factor)
    return Mesh(points, faces, textures=laid if textured else None)


def test_vertices_have_the_textures_colour_times_its_factor():
    mesh = flat()
    expected = np.c_[mesh.vertices[:, :2], np.full(25, 0.5)]
    np.testing.assert_allclose(texture_colors(mesh) / 255, expected, atol=0.6 / 255)
    halved = texture_colors(flat(factor=(0.25, 1, 1, 1)))
    linear = 0.25 * srgb_to_linear(expected[:, 0])
    np.testing.assert_allclose(halved[:, 0] / 255, linear_to_srgb(linear), atol=0.6 / 255)


def test_along_a_seam_they_are_the_mean_of_its_sides_in_linear_light():
    """Two triangles share an edge: black on one side, white on the other, whatever their number."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]]
    bare = Mesh(points, [[0, 1, 2], [0, 1, 2], [0, 2, 3]])
    pixels = np.array([[[0, 0, 0], [255, 255, 255]]], np.uint8)
    uv = np.full((3, 3, 2), 0.25)
    uv[2] = 0.75
    laid = replace(textures(bare, texture(pixels)), texcoords=uv)
    found = texture_colors(Mesh(points, bare.faces, textures=laid))
    assert found[:, 0].tolist() == [188, 0, 188, 255, 255]
    assert texture_colors(Mesh(points, bare.faces, textures=textures(bare, None))) is None


def test_albedo_keep_multiplies_the_texture():
    plain = md.bake(flat(textured=False), "lambert", light="front")
    baked = md.bake(flat(), "lambert", light="front", albedo="keep")
    expected = linear_to_srgb(
        srgb_to_linear(plain.colors / 255) * srgb_to_linear(texture_colors(flat()) / 255)
    )
    np.testing.assert_allclose(baked.colors / 255, expected, atol=1 / 255)


def test_own_colours_of_vertices_come_first_and_multiply_in_gltf():
    mesh = flat()
    own = dict.fromkeys(("red", "green", "blue"), np.full(25, 128, np.uint8))
    for tinted, expected in (
        (False, np.full((25, 3), 128.0)),
        (True, 255 * linear_to_srgb(srgb_to_linear(texture_colors(mesh) / 255) * 0.2159)),
    ):
        both = Mesh(
            mesh.vertices, mesh.polygons or mesh.faces, attributes={"vertex": own},
            textures=replace(mesh.textures, tinted=tinted),
        )  # fmt: skip
        baked = md.bake(both, "lambert", light="front", albedo="keep")
        np.testing.assert_allclose(baked.colors, expected, atol=1.5)


def test_a_texture_comes_before_the_colours_of_faces():
    """MeshLab writes white ones beside every texture."""
    mesh = flat()
    white = dict.fromkeys(("red", "green", "blue"), np.full(16, 255, np.uint8))
    both = Mesh(mesh.vertices, mesh.polygons, attributes={"face": white}, textures=mesh.textures)
    baked = md.bake(both, "lambert", light="front", albedo="keep")
    np.testing.assert_allclose(baked.colors, texture_colors(mesh), atol=1)


def test_a_picture_that_cannot_be_had_is_one_sentence():
    mesh = flat()
    lost = Texture("a.png", None, fault="names the texture 'a.png', which is not there")
    gone = Mesh(mesh.vertices, mesh.polygons, textures=replace(mesh.textures, base_colors=(lost,)))
    said = r"albedo='keep' needs what can't be had: .* names the texture 'a\.png'"
    with pytest.raises(MeshdepictError, match=said):
        md.bake(gone, "lambert", albedo="keep")
    md.bake(gone, "lambert")


def test_parted_and_refined_meshes_keep_their_textures():
    """On a sphere that is seen from above, each corner's coordinates are its x and y."""
    points, faces = icosphere(162)
    bare = Mesh(points / 2.5 + 0.5, faces)
    mesh = Mesh(bare.vertices, bare.faces, textures=textures(bare, texture(ramp())))
    parted = parted_at_creases(mesh, 10)
    assert len(parted.vertices) > len(mesh.vertices)
    plain = md.bake(mesh, "lambert", refine=1)
    refined = plain.mesh
    assert len(refined.faces) > len(mesh.faces)
    for each in (parted, refined):
        np.testing.assert_allclose(each.texcoords, each.vertices[each.faces][..., :2], atol=1e-9)
    colors = md.bake(mesh, "lambert", refine=1, albedo="keep").colors
    shares = [srgb_to_linear(each / 255) for each in (plain.colors, texture_colors(refined))]
    np.testing.assert_allclose(colors / 255, linear_to_srgb(shares[0] * shares[1]), atol=1.5 / 255)


@pytest.mark.parametrize("polygons", [False, True])
def test_turned_and_split_faces_keep_each_corners_place(polygons):
    """A box that is inside out: coordinates are x and y, as they are of every corner."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = np.array(
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    )
    faces = quads if polygons else np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    bare = Mesh(corners, faces)
    laid = textures(bare, texture(ramp()))
    laid = replace(laid, material=np.arange(12) % 2 - 1 if not polygons else laid.material)
    mesh = Mesh(corners, faces, textures=replace(laid, normal_texcoords=laid.texcoords * 2))
    with pytest.warns(MeshdepictWarning, match="the mesh was inside out"):
        assert mesh.orientation.flipped.all()
    turned = mesh.rewound()
    assert not turned.orientation.flipped.any()
    for each in (turned, mesh.as_triangles(), turned.as_triangles()):
        np.testing.assert_array_equal(each.texcoords, each.vertices[each.faces][..., :2])
        np.testing.assert_array_equal(each.textures.normal_texcoords, 2 * each.texcoords)
        np.testing.assert_array_equal(each.textures.material, laid.material)
        assert pickle.loads(pickle.dumps(each)).textures.material.tolist() == [*laid.material]
