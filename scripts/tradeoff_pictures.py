"""Knobs of where shading happens: vertices, texels and pixels, a G-buffer's size, voxels."""

from __future__ import annotations

import copy
from collections.abc import Iterator

import numpy as np
from tradeoff_subjects import SIDE, Row, ct, scans, trade

import meshdepict as md
from meshdepict import color
from meshdepict.scales.image_scales import image_space
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.textures import Texture
from meshdepict.viewer.live.octahedral import fold, unfold

METHOD = "exaggerated"


def pixels(one, buffer=None):
    """Return what every pixel of a picture shows, shaded by itself."""
    buffer = buffer or one.buffer
    space = md.scale_space(one.shape)
    look = md.Look(METHOD).of_kind("mesh").settled(space)
    seen = InterpolatedSpace(space, one.shape.faces[buffer.triangle], buffer.barycentric)
    light = look.lighting(buffer.view, "mesh")
    return color.encode(look.shade(seen, light, buffer.view), linear=look.declared.linear)


def where() -> Iterator[Row]:
    """Shade vertices, those of split triangles, or texels; against every pixel."""
    for one in scans():

        def textured(size, s=one):
            baked = md.bake_texture(s.shape, METHOD, size=size, view=s.buffer.view)
            texture = Texture("baked", None)
            vars(texture)["pixels"] = baked.image
            corners = baked.texcoords[s.buffer.triangle]
            places = np.einsum("nc,ncx->nx", s.buffer.barycentric, corners)
            return np.rint(255 * texture.lookup(places)).astype(np.uint8)

        def refined(s=one):
            baked = s.bake(METHOD, refine=2)
            finer = GBuffer.of(baked.shape, s.buffer.view, size=(SIDE, SIDE))
            shown = finer.image(finer.sample(baked.colors.astype(np.float32)))[s.buffer.mask]
            return np.rint(shown).astype(np.uint8)

        settings = {
            "vertices": lambda s=one: np.rint(
                s.buffer.sample(s.bake(METHOD).colors.astype(np.float32))
            ).astype(np.uint8),
            "vertices, refine 2": refined,
            "2048² texels": lambda f=textured: f(2048),
            "4096² texels": lambda f=textured: f(4096),
            f"{SIDE}² pixels": lambda s=one: pixels(s),
        }
        yield from trade(
            "mesh against pixel and texel", one, settings, exact=f"{SIDE}² pixels",
            seen=lambda found: found,
        )  # fmt: skip


def buffers() -> Iterator[Row]:
    """Shade fewer pixels, enlarged to the most."""
    largest = 2 * SIDE
    for one in scans():

        def enlarged(side, s=one):
            buffer = GBuffer.of(s.shape, s.buffer.view, size=(side, side))
            picture = buffer.image(pixels(s, buffer).astype(np.uint8), background=255)
            return np.kron(picture, np.ones((largest // side,) * 2 + (1,), np.uint8))

        settings = {f"{n}²": lambda n=n, f=enlarged: f(n) for n in (150, 300, 600, 1200)}
        yield from trade(
            "G-buffer size", one, settings, exact=f"{largest}²", seen=lambda found: found
        )


def packed() -> Iterator[Row]:
    """Hand normals to graphics cards as two coordinates on an octahedron."""
    for one in scans():
        space = md.scale_space(one.shape)
        exact = [space.normals_at(i) for i in range(space.last + 1)]
        look = md.Look(METHOD).of_kind("mesh").settled(space)
        light = look.lighting(one.buffer.view, "mesh")

        def shaded(bits, s=one, exact=exact, space=space, look=look, light=light):
            packed = copy.copy(space)
            sets = [
                n if bits is None else unfold(fold(n, bits=bits), bits=bits).astype(np.float32)
                for n in exact
            ]
            packed.normals_at = lambda scale: sets[scale]
            values = look.shade(packed, light, s.buffer.view)
            return color.encode(values, linear=look.declared.linear)

        settings = {
            "2 × 16 bits": lambda f=shaded: f(16), "2 × 24 bits": lambda f=shaded: f(24),
            "3 × float32": lambda f=shaded: f(None),
        }  # fmt: skip
        yield from trade("packed normals", one, settings, exact="3 × float32")


def diffusion() -> Iterator[Row]:
    """Diffuse slopes as Light Warping does: more steps smooth more, which is another picture."""
    for one in scans():

        def shaded(steps, s=one):
            space = image_space(s.buffer, filter="diffusion", iterations=steps)
            look = md.Look("light_warping", curvature="view")
            light = look.lighting(s.buffer.view, "image")
            return color.encode(look.shade(space, light, s.buffer.view), linear=True)

        settings = {str(n): lambda n=n, f=shaded: f(n) for n in (5, 10, 20, 40, 80)}
        yield from trade("diffusion iterations", one, settings, exact="80", seen=lambda f: f)


def stride() -> Iterator[Row]:
    """Take every second or third voxel alone; seen at voxels that all of them have."""
    one, common = ct(), 6

    def shaded(step):
        shape = one.shape
        thinned = md.Volume(
            shape.values[::step, ::step, ::step], spacing=np.asarray(shape.spacing) * step
        )
        width = float(np.max(shape.spacing)) * 3
        rgba = md.bake_volume(thinned, width=width, scales=4).rgba
        every = common // step
        return rgba[::every, ::every, ::every]

    sizes = [shaded(step).shape for step in (1, 2, 3)]
    least = tuple(min(size[axis] for size in sizes) for axis in range(3))

    def both(found):
        nz, ny, nx = least
        part = found[:nz, :ny, :nx]
        return part[..., :3][whole[:nz, :ny, :nx, 3] > 0]

    whole = shaded(1)
    settings = {str(step): lambda step=step: shaded(step) for step in (1, 2, 3)}
    yield from trade("voxel stride", one, settings, exact="1", seen=both)


KNOBS = (where, buffers, packed, diffusion, stride)
