"""How a bake came about, in words that go into its file: enough to make it again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from meshdepict.baking.accuracy import NORMAL
from meshdepict.baking.layer_list import Layer, blend_text
from meshdepict.files.mark import MARK, VERSION
from meshdepict.options import as_text, options_of
from meshdepict.scene.names import Lighting
from meshdepict.scene.shape import Shape
from meshdepict.shapes.document import Document

if TYPE_CHECKING:
    from meshdepict.baking.choices import Choices
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.shapes.mesh import Mesh

__all__ = ["comment_lines", "describe", "fitted_text", "sampled_text", "was_baked"]


def describe(look: Choices, space: ScaleSpace, *, light: Lighting) -> dict[str, str]:
    """Return what was shaded, and how, by keyword.

    Parameters
    ----------
    look : Choices
        Options that were not chosen have their defaults.
    space : ScaleSpace
    light : Light, Lights or Environment
        What the look's light became in its view.
    """
    known = options_of(look.function) if look.blend is None else {}  # layers say theirs
    values = {name: option.default for name, option in known.items()} | dict(look.options)
    occlusion = [
        f"{rays} rays, rms error {error:.2g}" for rays, error in space.occlusion_errors.items()
    ]
    return {
        "version": VERSION,
        "method": look.title,
        "options": " ".join(
            f"{name}={as_text(value)}" for name, value in values.items() if value is not None
        ),
        "scales": _scales(space),
        **({} if look.accuracy == NORMAL else {"accuracy": look.accuracy}),
        **({"occlusion": "; ".join(occlusion)} if occlusion else {}),
        **_sampled_light(look, space),
        **_sharp(space.shape),
        **_raised(space.shape),
        "light": str(light),
        "view": f"{look.view}, up {look.up}" if isinstance(look.view, str) else str(look.view),
        "colormap": look.colormap or look.colormap2d or "gray",
        **({} if look.blend is None else {"blend": blend_text(_lit_layers(look))}),
        **({} if look.tint is None else {"tint": look.tint}),
        "albedo": look.albedo,
        **({"sides": "the one that is seen"} if look.two_sided else {}),
        space.shape.kind: space.shape.identity,
        **_beside(space),
    }


def _lit_layers(look: Choices) -> list[Layer]:
    """Return the layers of a blend; those that declare another light than it has, with that."""
    found = []
    for layer in look.layers:
        alone = look.of_layer(layer)
        unsaid = look.light is None and layer.light is None
        other = unsaid and alone.lit and alone.lit_by != look.lit_by
        found.append(layer.replace(light=alone.lit_by) if other else layer)
    return found


def fitted_text(look: Choices) -> str:
    """Return the options that followed the shape, or could have, in a few words; "" if none."""
    texts = []
    for name, value in look.fitted.items():
        numbers = sorted(value) if isinstance(value, tuple) else [value]
        ends = dict.fromkeys(f"{n:.3g}" for n in (numbers[0], numbers[-1]) if n is not None)
        if ends:
            texts.append(f"{name} {' to '.join(ends)}")
    return ", ".join(texts)


def sampled_text(provenance: Mapping[str, str]) -> str:
    """Return how sure light is that was sampled by rays, in a few words; "" where none was."""
    if found := provenance.get("rays auto"):
        return f"rays auto: {found}"
    error = provenance.get("light error")
    return "" if error is None else f"light off by {error} (rms)"


def comment_lines(provenance: Mapping[str, str]) -> list[str]:
    """Return provenance as lines for a file's header, in ASCII.

    Headers that go beyond it are more than VTK and several PLY readers take.
    """
    lines = (f"{MARK}{key}: {text}" for key, text in provenance.items())
    return [line.encode("ascii", "backslashreplace").decode() for line in lines]


def was_baked(mesh: Mesh) -> bool:
    """Whether a mesh's red, green and blue are those of a former bake."""
    return isinstance(mesh.document, Document) and mesh.document.is_recolored


def _beside(space: ScaleSpace) -> dict[str, str]:
    """Return what else stands where rays go: other objects, and a ground."""
    from meshdepict.shapes.ground_plane import GroundPlane

    meshes = () if space.company is None else space.company.surface.meshes
    grounds = [mesh for mesh in meshes if isinstance(mesh, GroundPlane)]
    others = [
        mesh.identity for number, mesh in enumerate(meshes)
        if number != space.member and mesh not in grounds
    ]  # fmt: skip
    found = {"together": f"with {'; '.join(others)}"} if others else {}
    if grounds:
        found["ground"] = "mirror" if grounds[0].mirror else "matt"
    return found


def _sharp(shape: Shape) -> dict[str, str]:
    """Return which normals were not computed from all that meets at a vertex."""
    from meshdepict.shapes.parted import PartedMesh

    if not isinstance(shape, PartedMesh):
        return {}
    if shape.chosen_normals == "file":
        return {"normals": f"the file's, {shape.added} vertices added"}
    return {"creases": f"{shape.creases:g} degrees, {shape.added} vertices added"}


def _sampled_light(look: Choices, space: ScaleSpace) -> dict[str, str]:
    """Return how sure light is that was sampled by rays, of the look's own number."""
    from meshdepict.shading.reached import USUAL_RAYS

    known = options_of(look.function)
    rays = look.options.get("rays", known["rays"].default if "rays" in known else 0)
    hidden = any(look.options.get(name) for name in ("shadows", "bounces"))
    error = space.light_errors.get(rays or USUAL_RAYS) if hidden else None
    return {} if error is None else {"light error": f"{error:.2g} grey levels"}


def _raised(shape: Shape) -> dict[str, str]:
    """Return times what heights are those of the ground, where they are not."""
    from meshdepict.shapes.height_field import HeightField

    raised = isinstance(shape, HeightField) and shape.z_factor != 1
    return {"z factor": f"{shape.z_factor:g}"} if raised else {}  # type: ignore[attr-defined]


def _scales(space: ScaleSpace) -> str:
    from meshdepict.scales.image_scales import ImageSpace

    count = len(space.widths) - 1
    if count == 0:
        return "0"
    texts = [
        f"{count}, widths {space.widths[1]:.6g} to {space.widths[-1]:.6g}",
        f"ratio {space.ratio:.6g}",
    ]
    if isinstance(space, ImageSpace):
        texts.append(f"filter {space.filter}")
    else:
        texts += [f"facing {space.facing:g}", f"tolerance {space.tolerance:g}"]
    return ", ".join(texts)
