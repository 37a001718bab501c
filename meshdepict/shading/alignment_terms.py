"""A material's terms under aligned light: matt, glossy and what is let through."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdepict.scene.light import Light
from meshdepict.scene.material import Lambert, Material, Phong, diffuse_term, specular_term
from meshdepict.shading.seen_through import transmitted_guides
from meshdepict.shading.transmission import rough_transmission

__all__ = ["Term", "aligned_terms", "lit_by", "visible_eye"]

Term = Callable[[NDArray[np.float64]], NDArray[np.float32]]
"""What a light of 1 from a direction shows (n,)."""


def aligned_terms(
    normals: NDArray[np.float32],
    eye: NDArray[np.float32],
    surface: Material,
    *,
    transmitted: float,
    refraction: float,
    frosting: float,
    sharpness: float,
    diffuse_strength: NDArray[Any],
    specular_strength: NDArray[Any],
    transmitted_strength: NDArray[Any],
) -> dict[str, Term]:
    """Return the terms that there are, each from a light to (n,), with guides of its own."""
    from meshdepict.shading.alignment_kernel import align_chain

    finest = normals[0]

    def matt(light: NDArray[Any]) -> NDArray[np.float32]:
        turned = align_chain(normals, light, diffuse_strength, sharpness)
        if isinstance(surface, (Lambert, Phong)):  # in a tenth of the time
            return np.float32(surface.diffuse) * np.maximum(_dot(finest, turned), 0)
        return diffuse_term(surface, finest.T, turned.T, eye.T)

    found: dict[str, Term] = {"matt": matt}
    if transmitted == 0 and isinstance(surface, Lambert):
        return found
    eye = visible_eye(finest, eye)
    if not isinstance(surface, Lambert):
        reflected = np.stack([2 * _dot(n, eye) * n - eye for n in normals])

        def glossy(light: NDArray[Any]) -> NDArray[np.float32]:
            turned = align_chain(reflected, light, specular_strength, sharpness)
            return specular_term(surface, finest.T, turned.T, eye.T) * (_dot(finest, turned) > 0)

        found["glossy"] = glossy
    if transmitted > 0:
        through = transmitted_guides(normals, eye, refraction)

        def clear(light: NDArray[Any]) -> NDArray[np.float32]:
            turned = align_chain(through, light, transmitted_strength, sharpness)
            shown = rough_transmission(
                finest, eye, turned, refraction=refraction, roughness=frosting
            )
            return np.float32(transmitted) * shown

        found["clear"] = clear
    return found


def lit_by(
    lamp: Light, terms: Mapping[str, Term], share: NDArray[np.float32] | None = None
) -> NDArray[np.float32]:
    """Return the terms (n, 1 or 3) of a light, as much as it is seen; what shines through is."""
    color = lamp.color.astype(np.float32)
    parts = {name: term(lamp.direction) for name, term in terms.items()}
    if share is not None:
        parts = {name: p if name == "clear" else p * share for name, p in parts.items()}
    shaded = np.sum(list(parts.values()), axis=0)
    found: NDArray[np.float32] = shaded[:, None] * (color[:1] if np.ptp(color) == 0 else color)
    return found


def visible_eye(normals: NDArray[np.float32], eye: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the eye (3, n), mirrored in the tangent plane of points that face away from it."""
    return eye - np.float32(2) * np.minimum(_dot(normals, eye), np.float32(0)) * normals


def _dot(a: NDArray[np.float32], b: NDArray[np.float32]) -> NDArray[np.float32]:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
