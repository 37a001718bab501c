"""Baking textures: texels are samples, and a method shades them as it shades vertices."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.atlases import Atlas, atlas_of
from meshdepict.baking.baked_texture import MAPS, BakedTexture
from meshdepict.baking.choice_list import LADDER, MESH, SIDES
from meshdepict.baking.choices import Choices, takes_choices
from meshdepict.baking.layers import Layered
from meshdepict.baking.look import Look
from meshdepict.baking.provenance import describe, was_baked
from meshdepict.baking.sample_shading import SampleShading
from meshdepict.baking.sheets import warn_of_backs
from meshdepict.baking.surfaces import as_mesh, own_colors, with_choices
from meshdepict.baking.texel_sampling import Places, TexelSampling
from meshdepict.baking.tinting import heights_of, tinted
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.files.limits import as_text, max_memory
from meshdepict.options import real
from meshdepict.scales.making import scale_space
from meshdepict.scales.mapped_normals import TangentFrames
from meshdepict.shapes.colors import vertex_colors

if TYPE_CHECKING:
    from meshdepict.baking.finer_surface import FinerSurface
    from meshdepict.scales.ladder import Progress
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["MOST_TEXELS", "SIZE", "bake_texture", "texture_look"]

Ladder = tuple[int, float]
Bytes = NDArray[np.uint8]

SIZE = 4096
"""Texels along the side of a texture unless somebody says otherwise."""

MOST_TEXELS = 16_384
"""… and at most: what graphics cards take."""

_TEXEL_BYTES = 6  # of the picture, with what tells gutters
_WORKING = 1 << 29


@takes_choices
def bake_texture(
    mesh: object,
    method: str | Callable[..., Any] = "exaggerated",
    *,
    size: int = SIZE,
    atlas: str | None = None,
    map: str = "color",  # noqa: A002
    detail: object = None,
    cage: float | str | None = None,
    progress: Progress | None = None,
    **chosen: Any,
) -> BakedTexture:
    """Shade a mesh texel by texel.

    Between vertices normals, curvature and positions are interpolated before they are shaded, as at
    the pixels of a picture; the mesh's normal map, if it has one, gives the unsmoothed normals.
    Methods that cast rays cast each texel's own.

    Parameters
    ----------
    mesh : path, Mesh, pyvista.PolyData or trimesh.Trimesh
    method : str or function
        As for `bake`.
    size : int
        Texels along the side of the texture, 16 … 16384.
    atlas : {"own", "new", "xatlas"}, optional
        Texture coordinates: the mesh's own, new ones with a place for every triangle, or charts by
        xatlas (an extra). Own ones unless given, new ones where it has none.
    map : {"color", "normal", "curvature", "occlusion"}
        What the texture shows: the method's colours, or numbers that other programs understand. A
        normal map has the normals of the coarsest of the ``scales`` that are given, the unsmoothed
        ones unless they are, in the tangent space of the mesh's vertex normals, green up.
    detail : path or mesh, optional
        A finer mesh of the same surface: it is shaded, and seen from the texels along their
        normals, both ways.
    cage : float or str, optional
        How far away detail may be, in world units or as "2%" of the diagonal, which is usual.
    progress : callable, optional
        ``progress(done, total)``.
    **chosen
        Light, view, scales and so on, as `Look` has them, and the method's own options.

    Returns
    -------
    BakedTexture

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range, texture coordinates that overlap, and textures that
        memory doesn't hold.
    """
    look = texture_look(Look(method, **chosen), map)
    return texture_of(
        mesh, look, size=size, atlas=atlas, map_kind=map, detail=detail, cage=cage,
        progress=progress,
    )  # fmt: skip


def texture_look(look: Choices, map_kind: str) -> Choices:
    """Return a look as a map wants it: methods of their own show curvature and occlusion.

    Raises
    ------
    MeshdepictError
        For an unknown map, and a method beside one that has its own.
    """
    if not isinstance(map_kind, str) or map_kind not in MAPS:
        raise MeshdepictError(f"map={map_kind!r} is none of {', '.join(MAPS)}")
    own = {"curvature": "mean_curvature", "occlusion": "ambient_occlusion"}.get(map_kind)
    if map_kind == "color":
        return look
    if look.blend is not None or look.method not in (Choices().method, own):
        raise MeshdepictError(
            f"a map of {map_kind} is shaded by no method: leave {look.title} out, or map"
        )
    for name in ("colormap", "colormap2d", "tint"):
        if getattr(look, name) is not None:
            raise MeshdepictError(
                f"{name} colours shading, and a map of {map_kind} holds numbers: leave it out"
            )
    if own is None:
        return look
    options = {"darkest": 0.0} if map_kind == "occlusion" else {}
    return look.replace(method=own, **{**options, **look.replace(method=own).options})


def texture_of(
    shape: object,
    look: Choices,
    *,
    size: int = SIZE,
    atlas: str | None = None,
    map_kind: str = "color",
    detail: object = None,
    cage: float | str | None = None,
    progress: Progress | None = None,
) -> BakedTexture:
    """Shade a mesh's texture by a look; see `bake_texture`."""
    count = real(size)
    if count is None or not count.is_integer() or not 16 <= count <= MOST_TEXELS:
        raise MeshdepictError(f"size={size!r} is not a whole number from 16 to {MOST_TEXELS}")
    size = int(count)
    needed = _TEXEL_BYTES * size**2 + _WORKING
    if needed > max_memory():
        raise MeshdepictError(
            f"a texture of {size:,} x {size:,} texels takes {as_text(needed)}, more than the "
            f"{as_text(max_memory())} of memory that are allowed: take a smaller --size, or allow "
            "more with --max-memory"
        )
    if look.refine is not None:
        raise MeshdepictError("refine splits triangles, and texels need none split: leave it out")
    if cage is not None and detail is None:
        raise MeshdepictError("cage says how far away detail may be: give detail, too, or none")
    mesh = as_mesh(shape)
    found = atlas_of(mesh, size, atlas)
    given = mesh.textures
    if found.kind != "own":
        with warnings.catch_warnings():  # coordinates that were lost are replaced
            warnings.filterwarnings("ignore", "texture coordinates are lost")
            mesh = mesh.as_triangles()
    setting = _Setting(mesh, found, map_kind, given)
    return setting.shaded_by(look, detail, cage, progress)


@dataclass(frozen=True, eq=False)
class _Setting:
    """A mesh and where its triangles lie in a texture."""

    mesh: Mesh
    atlas: Atlas
    map_kind: str
    textures: Textures | None

    def shaded_by(
        self, look: Choices, detail: object, cage: float | str | None, progress: Progress | None
    ) -> BakedTexture:
        """Make scale spaces for a look, and shade."""
        chosen = look
        look = look.of_kind(MESH)
        whole, textures = self.mesh, self.textures
        finer: FinerSurface | None = None
        if detail is not None:
            from meshdepict.baking.finer_surface import FinerSurface

            whole = as_mesh(detail)
            textures = whole.textures
            finer = FinerSurface(self.mesh, whole, cage)
        shaded = with_choices(whole, look)
        look = look.posed(shaded)
        eye = look.eye(shaded)
        if self.map_kind == "normal":
            last = 0 if chosen.scales is None else chosen.scales
            look = look.replace(method="lambert", scales=last)
        layered = None
        if look.blend is not None:
            layered = Layered(chosen.replace(view=look.view, up=look.up), MESH)
        shading = SampleShading(look, look.lighting(eye, MESH), eye, layered)
        spaces: dict[Ladder, ScaleSpace] = {}
        ladders = {(last, look.ladder[1])} if self.map_kind == "normal" else {*shading.ladders}
        for ladder in ladders:
            spaces[ladder] = space = scale_space(
                shaded, scales=ladder[0], ratio=ladder[1], width=look.width, facing=look.facing,
                tolerance=look.tolerance, view=eye, at_once=(),
            )  # fmt: skip
            if self.map_kind == "normal":
                space.smooth((space.last,), progress=progress)
            else:
                _prepare(space, shading.reads(ladder, space.last), progress)
        mapped = None if finer is not None else _normal_maps(textures, shaded, spaces)
        sampling = TexelSampling(self.mesh, self.atlas, spaces, mapped, finer)
        if not look.two_sided:
            space = next(iter(spaces.values()))
            warn_of_backs(space.points, space.normals_at(0), eye)
        albedo = _albedo(whole, textures) if look.albedo == "keep" else None
        return self._shaded(sampling, shading, albedo, chosen, progress)

    def _shaded(
        self,
        sampling: TexelSampling,
        shading: SampleShading,
        albedo: Callable[[Places], NDArray[Any]] | None,
        chosen: Choices,
        progress: Progress | None,
    ) -> BakedTexture:
        spaces = sampling.spaces
        first = next(iter(spaces.values()))
        if self.map_kind == "normal":
            frames = TangentFrames(self.mesh, self.mesh.normals, self.atlas.texcoords)
            image = sampling.image(_normal_painter(frames), progress=progress)
        else:
            shading = shading.settled(spaces)
            look = shading.look
            if look.tint is not None:
                look, _ = tinted(look, heights_of(first, look.axis(MESH)))
                shading = replace(shading, look=look)
            image = sampling.image(_painter(shading, spaces, albedo), progress=progress)
        look = shading.look
        provenance = describe(look, max(spaces.items())[1], light=shading.light)
        size = self.atlas.size
        provenance["texture"] = f"{size} x {size} texels, {self.map_kind}, atlas {self.atlas.kind}"
        if sampling.mapped is not None:
            provenance["texture"] += ", normals of its normal map"
        if sampling.finer is not None:
            provenance["texture"] += f", detail {sampling.finer.described}"

        def again(**changes: Any) -> BakedTexture:
            _refuse_new_samples(changes, chosen)
            other = chosen.replace(**changes)
            posed = other.of_kind(MESH).posed(first.surface)
            eye = posed.eye(first.surface)
            layered = None
            if posed.blend is not None:
                layered = Layered(other.replace(view=posed.view, up=posed.up), MESH)
            light = posed.lighting(eye, MESH)
            return self._shaded(
                sampling, SampleShading(posed, light, eye, layered), albedo, other, None
            )

        return BakedTexture(
            self.mesh, self.atlas, image, provenance, look.replace(light=shading.light),
            map_kind=self.map_kind, again=again,
        )  # fmt: skip


def _refuse_new_samples(changes: Mapping[str, Any], chosen: Choices) -> None:
    for name in changes:
        if name in (*LADDER, *SIDES, "method", "blend", "albedo", "refine"):
            raise MeshdepictError(
                f"{name} comes too late: the texels have been sampled; bake the texture anew"
            )
    del chosen


def _prepare(space: ScaleSpace, reads: Any, progress: Progress | None) -> None:
    """Compute what texels are interpolated from, once, and not by every thread."""
    space.smooth(reads.sets, progress=progress)
    for scale in sorted(reads.curvature | reads.seen):
        space.curvature(scale)
    for scale in sorted(reads.seen):
        space.crease_cosines(scale)


def _normal_maps(
    textures: Textures | None, mesh: Mesh, spaces: Mapping[Ladder, ScaleSpace]
) -> tuple[TangentFrames, Textures] | None:
    """Return the normal maps of a mesh with the frames that they refer to, if it has any."""
    if textures is None or not any(each is not None for each in textures.normal_maps):
        return None
    kept = []
    for texture in textures.normal_maps:
        try:
            if texture is not None:
                _ = texture.pixels
            kept.append(texture)
        except MeshdepictError as error:
            warnings.warn(f"{error}: shaded without it", MeshdepictWarning, stacklevel=3)
            kept.append(None)
    if not any(each is not None for each in kept):
        return None
    textures = replace(textures, normal_maps=tuple(kept))
    texcoords = textures.texcoords
    if textures.normal_texcoords is not None:
        texcoords = textures.normal_texcoords
    normals = next(iter(spaces.values())).normals_at(0)
    return TangentFrames(mesh, normals, texcoords), textures


def _albedo(mesh: Mesh, textures: Textures | None) -> Callable[[Places], NDArray[Any]]:
    """Return what gives the mesh's own colours at places: its textures', else its vertices'."""
    laid = textures if textures is not None and any(textures.base_colors) else None
    linear = None
    if laid is None:
        linear = color.srgb_to_linear(own_colors(mesh) / np.float32(255))
    else:
        for texture in laid.base_colors:
            try:
                _ = None if texture is None else texture.pixels
            except MeshdepictError as error:  # before any work is done
                raise MeshdepictError(f"albedo='keep' needs what can't be had: {error}") from error
        found = vertex_colors(mesh, baked=was_baked(mesh), faces=False)
        if laid.tinted and found is not None:
            linear = color.srgb_to_linear(found / np.float32(255))

    def colors(places: Places) -> NDArray[Any]:
        found = np.ones(1, np.float32)
        if linear is not None:
            at = linear[mesh.faces[places.shaded_triangle]]
            found = np.einsum("nc,ncx->nx", places.shaded_weights, at)
        if laid is not None:
            painted = laid.colors(places.shaded_triangle, places.shaded_weights)
            found = found * color.srgb_to_linear(painted)
        return np.asarray(color.linear_to_srgb(found))

    return colors


def _painter(
    shading: SampleShading,
    whole: Mapping[Ladder, ScaleSpace],
    albedo: Callable[[Places], NDArray[Any]] | None,
) -> Callable[[Places, Mapping[Ladder, ScaleSpace]], Bytes]:
    """Return what shades texels."""
    look = shading.look
    looks = [look] if shading.layered is None else shading.layered.looks
    # What looks at the samples around, and casts no rays, is shaded at the vertices.
    alone = all(each.declared.local or "rays" in each.declared.needs for each in looks)
    at_vertices = None if alone else shading.values(whole)

    def paint(places: Places, spaces: Mapping[Ladder, ScaleSpace]) -> Bytes:
        space = next(iter(spaces.values()))
        if at_vertices is None:
            values = shading.values(spaces)
        else:
            values = np.clip(space.of_vertices(at_vertices), 0, 1).astype(np.float32)
        colors = shading.colors(values, lambda: heights_of(space, look.axis(MESH)))
        if albedo is not None:
            colors = color.multiply_albedo(
                colors / np.float32(255), np.clip(albedo(places), 0, 1), linear=False
            )
        return colors

    return paint


def _normal_painter(
    frames: TangentFrames,
) -> Callable[[Places, Mapping[Ladder, ScaleSpace]], Bytes]:
    """Return what writes the coarsest normals into a tangent-space map."""

    def paint(places: Places, spaces: Mapping[Ladder, ScaleSpace]) -> Bytes:
        space = next(iter(spaces.values()))
        wanted = space.normals_at(space.last).astype(np.float64)
        basis = np.stack(frames.at(places.triangle, places.weights), axis=2)
        # So that a viewer's x T + y B + z N, not made unit before, points there.
        firm = np.abs(np.linalg.det(basis)) > 1e-9
        basis[~firm] = np.eye(3)
        local = np.linalg.solve(basis, wanted[..., None])[..., 0]
        local[~firm] = (0, 0, 1)
        local /= np.maximum(np.linalg.norm(local, axis=1, keepdims=True), 1e-12)
        return np.rint(255 * np.clip(local / 2 + 0.5, 0, 1)).astype(np.uint8)

    return paint
