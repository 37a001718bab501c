"""The materials that live shading has, Lambert's and Phong's, as uniforms and in GLSL."""

from __future__ import annotations

from meshdepict.drawing.shader import Uniforms
from meshdepict.errors import MeshdepictError
from meshdepict.scene.material import Lambert, Phong, adjusted, ambient_term, as_material
from meshdepict.viewer.live.live_method import Options

__all__ = ["GLSL", "live_material", "material_defines", "material_uniforms"]

_PARAMETERS = ("diffuse", "specular", "shininess", "roughness", "bins")

GLSL = """
float highlight(vec3 normal, vec3 e, vec3 l) {
  vec3 r = 2.0 * dot(normal, e) * normal - e;
  float along = clamp(dot(r, l), 0.0, 1.0);
  return along > 0.0 ? pow(along, shininess) : 0.0;
}

// The eye, mirrored in the tangent plane of points that face away from it.
vec3 visible(vec3 normal, vec3 e) {
  return e - 2.0 * min(dot(normal, e), 0.0) * normal;
}
"""


def live_material(options: Options) -> Lambert | Phong:
    """Return the material that a method's options name, with its parameters.

    Raises
    ------
    MeshdepictError
        For other materials than Lambert and Phong, and parameters that these don't have.
    """
    material = as_material(options["material"])
    if not isinstance(material, (Lambert, Phong)):
        raise MeshdepictError(
            f"live shading has the materials lambert and phong, not {type(material).__name__}; "
            "bake it instead"
        )
    given = {name: options[name] for name in _PARAMETERS if name in options}
    return adjusted(material, **given)


def material_uniforms(material: Lambert | Phong) -> Uniforms:
    """Return a material's numbers."""
    highlights = (material.specular, material.shininess) if isinstance(material, Phong) else (0, 1)
    return {
        "ambient": ambient_term(material),
        "diffuse": material.diffuse,
        "specular": float(highlights[0]),
        "shininess": float(highlights[1]),
    }


def material_defines(material: Lambert | Phong) -> dict[str, int]:
    """Return whether there are highlights."""
    return {"GLOSSY": 1} if isinstance(material, Phong) and material.specular > 0 else {}
