"""How a bake came about, in words that go into its file: enough to make it again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from meshdepict.files.mark import MARK, VERSION
from meshdepict.options import as_text, options_of
from meshdepict.shapes.document import Document

if TYPE_CHECKING:
    from meshdepict.scales.space import ScaleSpace
    from meshdepict.scene.light import Light
    from meshdepict.scene.view import View
    from meshdepict.shapes.mesh import Mesh

__all__ = ["comment_lines", "describe", "was_baked"]


def describe(
    function: Callable[..., Any],
    space: ScaleSpace,
    *,
    options: Mapping[str, Any],
    light: Light,
    view: str | View,
    up: str,
    colormap: str | None,
    albedo: str,
) -> dict[str, str]:
    """Return what was shaded, and how, by keyword.

    Parameters
    ----------
    function : shading function
    space : ScaleSpace
    options : mapping
        Those given; the others have their defaults.
    light, view, up, colormap, albedo
        As for `bake`.
    """
    values = {name: options.get(name, o.default) for name, o in options_of(function).items()}
    occlusion = [
        f"{rays} rays, rms error {error:.2g}" for rays, error in space.occlusion_errors.items()
    ]
    return {
        "version": VERSION,
        "method": function.__name__,
        "options": " ".join(
            f"{name}={as_text(value)}" for name, value in values.items() if value is not None
        ),
        "scales": _scales(space),
        **({"occlusion": "; ".join(occlusion)} if occlusion else {}),
        "light": str(light),
        "view": f"{view}, up {up}" if isinstance(view, str) else str(view),
        "colormap": colormap or "gray",
        "albedo": albedo,
        space.shape.kind: space.shape.identity,
    }


def comment_lines(provenance: Mapping[str, str]) -> list[str]:
    """Return provenance as lines for a file's header, in ASCII.

    Headers that go beyond it are more than VTK and several PLY readers take.
    """
    lines = (f"{MARK}{key}: {text}" for key, text in provenance.items())
    return [line.encode("ascii", "backslashreplace").decode() for line in lines]


def was_baked(mesh: Mesh) -> bool:
    """Whether a mesh's red, green and blue are those of a former bake."""
    return isinstance(mesh.document, Document) and bool(mesh.document.provenance)


def _scales(space: Any) -> str:
    count = len(space.widths) - 1
    if count == 0:
        return "0"
    texts = [
        f"{count}, widths {space.widths[1]:.6g} to {space.widths[-1]:.6g}",
        f"ratio {space.ratio:.6g}",
    ]
    if space.shape.kind == "image":
        texts.append(f"filter {space.filter}")
    else:
        texts += [f"facing {space.facing:g}", f"tolerance {space.tolerance:g}"]
    return ", ".join(texts)
