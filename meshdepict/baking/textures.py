"""Baking textures: texels are samples, and a method shades them as it shades vertices."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from meshdepict.baking.atlases import Atlas, atlas_of
from meshdepict.baking.baked_texture import BakedTexture
from meshdepict.baking.budget import within_budget
from meshdepict.baking.choice_list import LADDER, MESH, SIDES, choice_fields
from meshdepict.baking.choices import Choices, takes_choices
from meshdepict.baking.clipping import warn_of_clipping
from meshdepict.baking.layers import Layered
from meshdepict.baking.look import Look
from meshdepict.baking.own_colors import own_colors, surface_tints
from meshdepict.baking.provenance import describe
from meshdepict.baking.sample_shading import SampleShading
from meshdepict.baking.sheets import warn_of_backs
from meshdepict.baking.surfaces import as_mesh, bake_surface, with_choices
from meshdepict.baking.texel_painting import normal_painter, own_texel_colors, shading_painter
from meshdepict.baking.texel_sampling import Ladder, TexelSampling, usable_normal_maps
from meshdepict.baking.texture_choices import MAPS, MOST_TEXELS, SIZE
from meshdepict.baking.tinting import heights_of, tinted
from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import as_text, max_memory
from meshdepict.options import real
from meshdepict.scales.making import scale_space
from meshdepict.scales.mapped_normals import TangentFrames
from meshdepict.scene.environment import Environment

if TYPE_CHECKING:
    from meshdepict.baking.baked import Baked
    from meshdepict.scales.ladder import Progress
    from meshdepict.scales.light_errors import FoundRays
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.textures import Textures

__all__ = ["bake_texture", "map_method", "texture_of"]

_METHODS = {"curvature": "mean_curvature", "occlusion": "ambient_occlusion"}
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
    look = Look(map_method(map, method), **chosen)
    return texture_of(
        mesh, look, size=size, atlas=atlas, map_kind=map, detail=detail, cage=cage,
        progress=progress,
    )  # fmt: skip


def map_method(map_kind: str, method: Any = None) -> Any:
    """Return which method shows a map: of curvature and occlusion one of their own.

    Parameters
    ----------
    map_kind : str
        One of `MAPS`.
    method : str or function, optional
        What was asked for; the usual one stands for nothing.

    Raises
    ------
    MeshdepictError
        For an unknown map, and a method beside one that has its own.
    """
    if not isinstance(map_kind, str) or map_kind not in MAPS:
        raise MeshdepictError(f"map={map_kind!r} is none of {', '.join(MAPS)}")
    usual = Choices().method
    own = _METHODS.get(map_kind, usual)
    if map_kind == "color":
        return usual if method is None else method
    if method not in (None, usual, own):
        name = getattr(method, "__name__", method)
        raise MeshdepictError(
            f"a map of {map_kind} is shaded by no method of one's choice: leave {name} out"
        )
    return own


def checked_look(look: Choices, map_kind: str) -> Choices:
    """Return a look that shows a map as numbers; refuse what colours them.

    Raises
    ------
    MeshdepictError
    """
    if map_kind == "color":
        return look
    for name in ("colormap", "colormap2d", "tint", "blend"):
        if getattr(look, name) is not None:
            raise MeshdepictError(
                f"{name} is about colours, and a map of {map_kind} holds numbers: leave it out"
            )
    if map_kind == "occlusion" and look.options.get("darkest") is None:
        return look.replace(darkest=0.0)
    return look


def texture_of(
    shape: object,
    look: Choices,
    *,
    size: int = SIZE,
    atlas: str | None = None,
    map_kind: str = "color",
    detail: object = None,
    cage: float | str | None = None,
    spent: float = 0.0,
    progress: Progress | None = None,
) -> BakedTexture:
    """Shade a mesh's texture by a look; see `bake_texture`. Seconds may be ``spent`` already."""
    begun = time.perf_counter()
    look = checked_look(look, map_kind)
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
    if look.ground is not None:
        raise MeshdepictError(
            "ground is in pictures of a bake, and not in a texture: leave ground out"
        )
    if cage is not None and detail is None:
        raise MeshdepictError("cage says how far away detail may be: give detail, too, or none")
    mesh = as_mesh(shape)
    spent += time.perf_counter() - begun
    whole = mesh if detail is None else as_mesh(detail)
    look, allowed = within_budget(look, whole, spent=spent, writes=True, texels=size * size)
    found = atlas_of(mesh, size, atlas)
    given = mesh
    if found.kind != "own":
        with warnings.catch_warnings():  # coordinates that were lost are replaced
            warnings.filterwarnings("ignore", "texture coordinates are lost")
            mesh = mesh.as_triangles()
    texture = _Texture(mesh, given, found, map_kind, look)
    sampling = texture.sampling(given.textures, None if detail is None else whole, cage, progress)
    baked = texture.shaded(sampling, look, progress)
    if allowed is not None:
        baked.provenance["budget"] = str(allowed)
    return baked


@dataclass(frozen=True, eq=False)
class _Texture:
    """A mesh, where its triangles lie in a texture, and what that is to show.

    Attributes
    ----------
    mesh : Mesh
    given : Mesh
        As it came: with polygons, maybe.
    atlas : Atlas
    map_kind : str
        One of `MAPS`.
    chosen : Choices
        As somebody chose them.
    """

    mesh: Mesh
    given: Mesh
    atlas: Atlas
    map_kind: str
    chosen: Choices

    def sampling(
        self,
        textures: Textures | None,
        detail: object,
        cage: float | str | None,
        progress: Progress | None,
    ) -> TexelSampling:
        """Make the scale spaces that texels are samples of.

        Parameters
        ----------
        textures : Textures or None
            Those that the mesh came with.
        detail, cage, progress
            As for `bake_texture`.
        """
        whole, finer = self.mesh, None
        if detail is not None:
            from meshdepict.baking.finer_surface import FinerSurface

            whole = as_mesh(detail)
            finer = FinerSurface(self.mesh, whole, cage)
            textures = whole.textures
        look = self.chosen.of_kind(MESH)
        shaded = with_choices(whole, look)
        shading = self._shading(self.chosen, shaded)
        look = shading.look
        ladders = {*shading.ladders}
        if self.map_kind == "normal":
            ladders = {(self.chosen.scales or 0, look.ladder[1])}
        tints = None
        if look.albedo == "keep" and look.bounces:
            tints = surface_tints(shaded, own_colors(shaded))
        spaces: dict[Ladder, ScaleSpace] = {}
        for ladder in ladders:
            spaces[ladder] = space = scale_space(
                shaded, scales=ladder[0], ratio=ladder[1], width=look.width, facing=look.facing,
                tolerance=look.tolerance, view=shading.eye, at_once=(),
            )  # fmt: skip
            space.tints = tints  # what bounces has them at vertices
            if self.map_kind == "normal":
                space.smooth((space.last,), progress=progress)
            else:
                _prepare(space, shading.reads(ladder, space.last), progress)
        space = next(iter(spaces.values()))
        if self.map_kind == "color" and not look.two_sided:
            warn_of_backs(space.points, space.normals_at(0), shading.eye)
        albedo = own_texel_colors(whole, textures) if look.albedo == "keep" else None
        mapped = None if finer is not None else usable_normal_maps(textures, shaded, spaces)
        return TexelSampling(self.mesh, self.atlas, spaces, mapped, finer, albedo)

    def shaded(
        self, sampling: TexelSampling, chosen: Choices, progress: Progress | None = None
    ) -> BakedTexture:
        """Shade the texels as a look says that reads the same scale spaces."""
        spaces = sampling.spaces
        first = next(iter(spaces.values()))
        shading, found = self._shading(chosen, first.surface), None
        if self.map_kind == "normal":
            frames = TangentFrames(self.mesh, self.mesh.normals, self.atlas.texcoords)
            paint = normal_painter(frames)
        else:
            shading, found = self._settled(shading, sampling)
            paint = shading_painter(shading, spaces, sampling.albedo)
        image = sampling.image(paint, progress=progress)
        provenance = describe(shading.look, max(spaces.items())[1], light=shading.light)
        if found is not None:
            provenance["rays auto"] = str(found)
        provenance["texture"] = f"{self.map_kind}, {sampling.described}"

        def again(**changes: Any) -> BakedTexture:
            _refuse_new_samples(changes)
            return self.shaded(sampling, chosen.replace(**changes))

        return BakedTexture(
            self.mesh, self.atlas, image, provenance, shading.look.replace(light=shading.light),
            shading.eye, again=again, map_kind=self.map_kind, given=self.given,
            at_vertices=lambda: self._at_vertices(sampling, shading, chosen),
        )  # fmt: skip

    def _at_vertices(
        self, sampling: TexelSampling, shading: SampleShading, chosen: Choices
    ) -> Baked:
        """Shade the mesh's vertices by a look, of the scale space that texels are samples of."""
        if sampling.finer is not None or shading.layered is not None:
            return bake_surface(self.mesh, chosen)
        look = chosen.replace(light=shading.light, view=shading.eye)
        usual = {name: choice_fields()[name].default for name in (*LADDER, *SIDES)}
        return bake_surface(sampling.spaces[shading.look.ladder], look.replace(**usual))

    def _shading(self, chosen: Choices, shape: Mesh) -> SampleShading:
        look = chosen.of_kind(MESH).posed(shape)
        eye = look.eye(shape)
        layered = None
        if look.blend is not None:
            layered = Layered(chosen.replace(view=look.view, up=look.up), MESH)
        return SampleShading(look, look.lighting(eye, MESH), eye, layered)

    def _settled(
        self, shading: SampleShading, sampling: TexelSampling
    ) -> tuple[SampleShading, FoundRays | None]:
        """Find what follows the shape, and how many rays are enough; say what is too bright."""
        spaces = sampling.spaces
        for ladder, space in spaces.items():
            _prepare(space, shading.reads(ladder, space.last), None)
        spread = sampling.spread()
        shading, found = shading.settled(spread).sampled(spread)
        for ladder, space in spaces.items():  # what provenance tells of
            space.light_errors.update(spread[ladder].light_errors)
        look = shading.look
        if look.tint is not None:
            look, _ = tinted(look, heights_of(next(iter(spaces.values())), look.axis(MESH)))
            shading = replace(shading, look=look)
        if isinstance(shading.light, Environment) and shading.layered is None:
            space, light, eye = spaces[look.ladder], shading.light, shading.eye
            warn_of_clipping(
                look, light, shading.values(spaces), lambda other: other.shade(space, light, eye)
            )
        return shading, found


def _refuse_new_samples(changes: Mapping[str, Any]) -> None:
    for name in changes:
        if name in (*LADDER, *SIDES, "method", "blend", "albedo", "refine"):
            raise MeshdepictError(
                f"{name} comes too late: the texels have been sampled; bake the texture anew"
            )


def _prepare(space: ScaleSpace, reads: Any, progress: Progress | None) -> None:
    """Compute what texels are interpolated from, once, and not by every thread."""
    space.smooth(reads.sets, progress=progress)
    for scale in sorted(reads.curvature | reads.seen):
        space.curvature(scale)
    for scale in sorted(reads.seen):
        space.crease_cosines(scale)
