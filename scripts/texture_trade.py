"""How near a texture comes to the same shading at the pixels, and what shows at its seams.

    python scripts/texture_trade.py > tables.md      # two minutes

Prints Markdown for docs/textures.md: grey levels of a sphere, of the photographed tablet of the
samples, and of the bunny in the folder that MESHDEPICT_DATA names, if it is set.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from tables import head, row

import meshdepict as md
from meshdepict import color
from meshdepict.baking.baked_texture import BakedTexture
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.making import scale_space
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.textures import Texture

Floats = NDArray[np.float64]
METHODS = ("exaggerated", "lambert", "radiance_scaling", "light_alignment", "light_warping")
VIEWS = ("front", "left", "top")
PIXELS = 500


def texture_of(image: NDArray[np.uint8]) -> Texture:
    """Return pixels as a texture that repeats."""
    texture = Texture("baked", None)
    vars(texture)["pixels"] = image
    return texture


def errors(mesh: Mesh, baked: BakedTexture, view: str, side: int = PIXELS) -> Floats:
    """Return how far the pixels of a view are from shading their own normals, in grey levels."""
    buffer, look = GBuffer.of(mesh, view, size=(side, side)), baked.look
    space = scale_space(mesh, scales=look.ladder[0], ratio=look.ladder[1], width=look.width)
    seen = InterpolatedSpace(space, mesh.faces[buffer.triangle], buffer.barycentric)
    values = look.shade(seen, look.light, look.eye(mesh))
    wanted = color.encode(values, linear=look.declared.linear).astype(float)
    at = np.einsum("nc,ncx->nx", buffer.barycentric, baked.texcoords[buffer.triangle])
    return np.asarray(np.abs(255 * texture_of(baked.image).lookup(at) - wanted).max(axis=1))


def seams(mesh: Mesh, baked: BakedTexture, times: int) -> tuple[float, float]:
    """Return the differences across seams, and across other edges, of a picture halved so often.

    Both rms, in grey levels, and of places a texel apart there.
    """
    image = baked.image.astype(float)
    for _ in range(times):
        image = sum(image[a::2, b::2] for a in (0, 1) for b in (0, 1)) / 4
    texture = texture_of(np.rint(image).astype(np.uint8))
    sides = [np.arange(3), np.roll(np.arange(3), -1)]
    edge = np.stack([mesh.faces[:, s] for s in sides], 2).reshape(-1, 2)
    at = np.stack([baked.texcoords[:, s] for s in sides], 2).reshape(-1, 2, 2)
    forward, backward = np.lexsort(edge.T), np.lexsort(edge[:, ::-1].T)
    if not np.array_equal(edge[forward], edge[backward][:, ::-1]):
        raise SystemExit("seams are looked at on closed meshes")
    one, other = at[forward], at[backward][:, ::-1]
    apart = np.abs(one - other).max(axis=(1, 2)) > 1e-9
    along = one[:, 1] - one[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], 1)
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    half = across * 2**times / len(baked.image) / 2
    middles, others = one.mean(axis=1), other.mean(axis=1)
    here = texture.lookup(middles[apart]) - texture.lookup(others[apart])
    within = texture.lookup((middles + half)[~apart]) - texture.lookup((middles - half)[~apart])
    over, inside = (255 * float(np.sqrt(np.mean(part**2))) for part in (here, within))
    return over, inside


def shapes() -> dict[str, tuple[Mesh, int, tuple[str, ...]]]:
    """Return meshes by name, with the size of their textures and their atlases."""
    found: dict[str, tuple[Mesh, int, tuple[str, ...]]] = {
        "sphere": (md.samples.sphere(2_000), 1024, ("new", "xatlas")),
        "tablet": (md.samples.photographed_tablet(), 2048, ("own", "new", "xatlas")),
    }
    if folder := os.environ.get("MESHDEPICT_DATA"):
        found["bunny"] = md.read_mesh(Path(folder, "mesh", "bunny_69k.ply")), 4096, ("new",)
    return found


def main() -> None:
    """Print the tables."""
    head("shape", "atlas", "method", "rms", "within three")
    baked: dict[tuple[str, str], BakedTexture] = {}
    for name, (mesh, size, atlases) in shapes().items():
        for atlas in atlases:
            for method in METHODS:
                made = md.bake_texture(mesh, method, size=size, atlas=atlas)
                baked.setdefault((name, atlas), made)
                off = np.concatenate([errors(mesh, made, view) for view in VIEWS])
                rms = float(np.sqrt(np.mean(off**2)))
                row(name, atlas, method, f"{rms:.2f}", f"{np.mean(off <= 3):.2%}")
    head("seams of", "1", "1/2", "1/4", "1/8", "1/16")
    for (name, atlas), made in baked.items():
        if atlas in ("own", "xatlas"):
            both = [seams(made.mesh, made, times) for times in range(5)]
            row(f"{name}, {atlas}", *(f"{over:.1f} ({inside:.1f})" for over, inside in both))


if __name__ == "__main__":
    main()
