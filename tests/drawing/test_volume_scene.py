"""Volumes in VTK's ray caster: the right way round, and colours where rays pass."""

import dataclasses

import numpy as np
import pytest
from volume_shapes import DIRECTIONS, EDGE, SOLID, WHITE, blobs

import meshdepict as md
from meshdepict import color
from meshdepict.baking.look import bake_volume
from meshdepict.color.transfer import TransferFunction
from meshdepict.drawing import empty_space, volume_rays, volume_scene
from meshdepict.drawing.canvas import canvas, place
from meshdepict.drawing.empty_space import BLOCK, clearance
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.framing import frame
from meshdepict.drawing.volume_picture import draw_volume
from meshdepict.drawing.volume_rays import LEVELS
from meshdepict.drawing.volume_scene import (
    add_baked,
    add_rgba,
    levels_of,
    repaint,
    sample_box,
    texture,
    transfer_classes,
    transfer_window,
)
from meshdepict.errors import MeshdepictError
from meshdepict.shapes.isosurface import isosurface
from meshdepict.shapes.volume import Volume

pv = pytest.importorskip("pyvista")

CLEAR = Figure(size=(160, 160), background="transparent")


def drawn(baked, **options):
    return np.asarray(draw_volume(baked, CLEAR, **options))


# --- the right way round ----------------------------------------------------------------------


def within(mask, pixels):
    """A mask grown by some pixels."""
    for _ in range(pixels):
        wide = np.pad(mask, 1)
        mask = (
            wide[1:-1, 1:-1] | wide[2:, 1:-1] | wide[:-2, 1:-1] | wide[1:-1, 2:] | wide[1:-1, :-2]
        )
    return mask


@pytest.mark.parametrize("plain", [False, True], ids=["baked", "plain"])
@pytest.mark.parametrize("direction", DIRECTIONS)
def test_silhouettes_are_those_of_the_isosurface(direction, plain):
    volume = blobs(direction)
    baked = bake_volume(volume, "lambert", transfer=SOLID, view="isometric")
    seen = drawn(baked, plain=plain)[..., 3] > 127
    surface = md.bake(isosurface(volume, EDGE), "lambert")
    framing = frame(baked.view, volume, CLEAR)
    # `place` puts a shape's own middle at the origin: the mesh's view goes along.
    with canvas(surface, framing.drawn) as drawing:
        expected = drawing.draw(framing.view)[..., 3] > 127
    assert expected.sum() > 1000
    assert not (seen & ~within(expected, 2)).any()
    assert not (expected & ~within(seen, 2)).any()
    assert (seen != expected).sum() < 0.05 * expected.sum()


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_shading_is_that_of_the_isosurface(direction):
    volume = blobs(direction)
    baked = bake_volume(volume, "lambert", transfer=WHITE, view="isometric")
    surface = md.bake(isosurface(volume, EDGE), "lambert", view=baked.view)
    with canvas(surface, (160, 160)) as drawing:
        expected = drawing.draw(frame(baked.view, volume, CLEAR).view).astype(int)
    seen = drawn(baked).astype(int)
    inside = (seen[..., 3] == 255) & (expected[..., 3] == 255)
    difference = np.abs(seen - expected)[inside][:, 0]
    # Were near and far, or left and right, exchanged, it would be 100 and more.
    assert np.median(difference) < 8


# --- colours ------------------------------------------------------------------------------------


def test_a_ball_in_full_light_has_the_transfer_functions_colour():
    volume = blobs()
    baked = bake_volume(volume, "lambert", transfer=SOLID, light="front")
    image = drawn(baked)
    found = image[image[..., 3] == 255]
    brightest = found[found[:, 0].argmax(), :3]
    np.testing.assert_allclose(brightest, (0xC0, 0x80, 0x40), atol=3)
    # In linear light every colour is the same multiple of the base colour.
    light = color.srgb_to_linear(found[:, :3] / 255)
    bright = light[:, 0] > 0.1
    base = color.srgb_to_linear(np.array((0xC0, 0x80, 0x40)) / 255)
    np.testing.assert_allclose((light / base)[bright, 1], (light / base)[bright, 0], atol=0.03)


def test_colours_are_taken_where_rays_pass():
    # Voxels of 0 and 200 next to each other: halfway lies 100, which no voxel has, and which alone
    # is red. Between colours of voxels there would be no red at all.
    values = np.zeros((16, 16, 16), np.int16)
    values[:, :, 8:] = 200
    stripe = TransferFunction(
        [(60, 0, "#ff0000"), (70, 1, "#ff0000"), (170, 1, "#ff0000"), (180, 1, "#00ff00")],
        unit="raw",
    )
    volume = Volume(values, spacing=(1, 1, 1))
    baked = bake_volume(volume, "half_lambert", transfer=stripe, view="left", light="west")
    image = drawn(bake_volume(volume, "half_lambert", transfer=stripe, view="right"))
    there = image[..., 3] > 250
    assert (image[there][:, 1] > image[there][:, 0]).all()
    image = drawn(baked)
    there = image[..., 3] > 250
    assert there.any()
    assert (image[there][:, 0] > 100).all()
    assert (image[there][:, 1] < 60).all()


def test_opaque_things_are_wholly_opaque():
    alpha = drawn(bake_volume(blobs(), "lambert", transfer=SOLID))[..., 3]
    assert (alpha == 255).sum() > 0.9 * (alpha > 0).sum()


def test_without_a_shader_colours_are_nearly_the_same(monkeypatch):
    baked = bake_volume(blobs(), "half_lambert", transfer=WHITE)
    with_shader = drawn(baked)
    calls = []
    monkeypatch.setattr(
        "meshdepict.drawing.volume_picture.add_rgba",
        lambda window, baked: calls.append(1) or add_rgba(window, baked),
    )
    monkeypatch.setattr(volume_scene, "_LIGHT", "no GLSL")
    without = drawn(baked)
    assert calls
    inside = (with_shader[..., 3] == 255) & (without[..., 3] > 250)
    assert inside.sum() > 1000
    difference = np.abs(with_shader.astype(int) - without)[inside]
    assert np.percentile(difference, 95) <= 15  # colours of samples a quarter of a voxel apart


@pytest.mark.parametrize("direction", ["straight", "oblique, left-handed"])
def test_repainted_is_as_if_added_anew(direction):
    first = bake_volume(blobs(direction), "lambert", transfer=SOLID, light="west")
    second = bake_volume(first.space, "lambert", view=first.view, light="east")
    pictures = []
    for before, after in ((first, second), (second, second)):
        window = pv.Plotter(off_screen=True, window_size=[100, 100])
        try:
            actor = add_baked(window, before)
            place(window.camera, first.view, first.shape)
            window.reset_camera_clipping_range()
            window.render()
            repaint(actor, after)
            pictures.append(window.screenshot(return_img=True).astype(int))
        finally:
            window.close()
    assert np.ptp(pictures[0]) > 100
    np.testing.assert_array_equal(*pictures)


# --- textures ------------------------------------------------------------------------------------


def test_a_texture_has_light_and_levels_of_the_samples():
    baked = bake_volume(blobs(), "lambert", transfer=SOLID)
    found = texture(baked)
    box = sample_box(baked.space)
    assert found.values.shape[:3] == baked.shape.values[box].shape
    assert found.corner == (box[2].start, box[1].start, box[0].start)
    expected = np.zeros((*baked.shape.values.shape, 3), np.uint8)
    expected.reshape(-1, 3)[baked.space.voxels] = color.encode(baked.intensity, linear=True)
    np.testing.assert_array_equal(
        found.values[..., :3], np.maximum(expected[box], found.values[..., :3] > 0)
    )
    window = transfer_window(SOLID, baked.shape)
    numbers = window[0] + found.values[..., 3] / 255 * (window[1] - window[0])
    np.testing.assert_allclose(
        numbers,
        np.clip(baked.shape.values[box], *window),
        atol=(window[1] - window[0]) / 255 / 2 + 1e-3,
    )


def test_classes_are_the_transfer_functions(rng):
    classes = transfer_classes(SOLID, (50, 150))
    places = np.linspace(50, 150, LEVELS)
    np.testing.assert_allclose(classes[:, 3], SOLID.opacity(places), atol=1e-6)
    np.testing.assert_allclose(classes[:, :3], color.srgb_to_linear(SOLID.color(places)), atol=1e-6)
    np.testing.assert_allclose(transfer_classes(None, (0, 1))[:, 3], np.linspace(0, 1, LEVELS))
    assert (levels_of(np.array([49, 50, 100, 150, 151]), (50, 150)) == [0, 0, 0.5, 1, 1]).all()


def test_with_gradient_opacity_and_without_transfer_colours_are_those_baked():
    edges = TransferFunction(
        [(99, 0, "#c08040"), (101, 1, "#c08040")],
        gradient_opacity=[(0, 0), (10, 1)],
        unit="raw",
    )
    for transfer in (edges, None):
        baked = bake_volume(blobs(), "lambert", transfer=SOLID)
        if transfer is not None:
            baked = bake_volume(blobs(), "lambert", transfer=transfer)
        else:
            baked._shading = dataclasses.replace(baked._shading, transfer=None)
        found = texture(baked)
        expected = baked.rgba[sample_box(baked.space)]
        np.testing.assert_array_equal(found.values[..., 3], expected[..., 3])
        np.testing.assert_array_equal(found.values[..., :3], np.maximum(expected[..., :3], 1))
        assert (found.classes[:, :3] == 1).all()


def test_slab_by_slab_the_picture_is_the_same():
    whole = bake_volume(blobs(), "lambert", transfer=WHITE)
    slabs = bake_volume(blobs(), "lambert", transfer=WHITE, memory=20_000)
    assert slabs.space is None
    np.testing.assert_allclose(drawn(slabs).astype(int), drawn(whole), atol=2)


def test_nothing_of_the_bake_changes():
    baked = bake_volume(blobs("left-handed"), "lambert", transfer=SOLID)
    before = baked.rgba.copy(), baked.intensity.copy()
    texture(baked).values[:] = 7
    drawn(baked)
    assert (baked.rgba == before[0]).all()
    assert (baked.intensity == before[1]).all()


# --- empty space ----------------------------------------------------------------------------------


def test_clearance_counts_blocks_to_the_next_matter():
    levels = np.zeros((8 * BLOCK + 1, BLOCK + 1, BLOCK + 1), np.uint8)
    levels[2 * BLOCK + 3, 4, 4] = 255
    opacity = (np.arange(LEVELS) > LEVELS // 2).astype(np.float32)
    np.testing.assert_array_equal(clearance(levels, opacity)[:, 0, 0], [2, 1, 0, 1, 2, 3, 4, 5])
    np.testing.assert_array_equal(
        clearance(levels / np.float32(255), opacity), clearance(levels, opacity)
    )


def test_a_corner_belongs_to_the_blocks_on_all_sides():
    levels = np.zeros((2 * BLOCK + 1,) * 3, np.uint8)
    levels[BLOCK, BLOCK, BLOCK] = 255
    opacity = (np.arange(LEVELS) > 0).astype(np.float32)
    assert (clearance(levels, opacity) == 0).all()


def test_between_hidden_levels_there_may_be_matter():
    levels = np.zeros((3, 3, 3), np.uint8)
    levels[1] = 255
    opacity = np.zeros(LEVELS, np.float32)
    opacity[LEVELS // 2] = 1
    assert clearance(levels, opacity) == 0
    assert clearance(levels, opacity * 0) > 0


def test_rays_lose_nothing_by_leaping(monkeypatch):
    z, y, x = np.mgrid[:40, :40, :40]
    away = np.sqrt((x - 9) ** 2 + (y - 30) ** 2 + (z - 12) ** 2)
    volume = Volume(np.rint(np.clip(200 - 20 * away, 0, 200)).astype(np.int16))
    volume.values.setflags(write=True)
    volume.values[35, 5, 33] = 200  # far from the ball
    volume.values.setflags(write=False)
    baked = bake_volume(volume, "lambert", transfer=SOLID, view="isometric")
    leapt = drawn(baked)
    monkeypatch.setattr(volume_rays, "clearance", lambda *given: 0 * clearance(*given))
    np.testing.assert_allclose(leapt.astype(int), drawn(baked), atol=2)  # rounding of places


def test_more_than_a_table_holds_is_refused(monkeypatch):
    monkeypatch.setattr(volume_rays, "_SIDES", (32, 64))
    parts = [np.ones((n, 4), np.float32) for n in (20, 10)]
    assert volume_rays._table(*parts).shape == (1, 32, 4)
    assert volume_rays._table(*parts, *parts).shape == (1, 64, 4)
    assert volume_rays._table(*parts * 3).shape == (32, 32, 4)
    assert volume_rays._table(*parts * 50).shape == (32, 64, 4)
    with pytest.raises(MeshdepictError, match="more than a graphics card's table holds"):
        volume_rays._table(*parts * 200)
    assert empty_space.BLOCK > 1
