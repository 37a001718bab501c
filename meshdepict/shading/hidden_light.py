"""Light on a material, as much of it as samples see, and what comes to them by other ways."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.scales.space import ScaleSpace
from meshdepict.scene.environment import Environment
from meshdepict.scene.light import Light
from meshdepict.scene.material import (
    AshikhminShirley,
    CookTorrance,
    HalfLambert,
    LitSphere,
    Material,
    Refractive,
    diffuse_term,
)
from meshdepict.scene.vectors import cosines
from meshdepict.shading.direct import direct, kernel_parameters
from meshdepict.shading.first_light import added
from meshdepict.shading.lobe_samples import LobeSamples
from meshdepict.shading.lobes import lobe_samples
from meshdepict.shading.material_kinds import PHONG
from meshdepict.shading.reached import Reached

__all__ = ["albedo", "hidden_direct", "matt", "refuse_unhidden"]

Single = NDArray[np.float32]

# Gauss and Legendre's rule on [0, 1]: Schlick's fifth powers come out exactly.
_NODES, _WEIGHTS = leggauss(8)
_NODES, _WEIGHTS = (_NODES + 1) / 2, _WEIGHTS / 2


def hidden_direct(
    space: ScaleSpace,
    lights: Sequence[Light],
    eyes: Single,
    material: Material,
    reach: Reached,
    *,
    environments: Sequence[Environment] = (),
    count: int = 54,
    rays: int = 0,
    **settings: Any,
) -> Single:
    """Return what `direct` does, each light as much as it is seen, and what came around.

    In the latter is the matt part of the environments. Highlights of them, and of what bounced, are
    sampled: see `hidden_lobes`.

    Parameters
    ----------
    space, lights, eyes, material, environments, count, **settings
        As for `direct`.
    reach : Reached
        Of these lights and environments.
    rays : int
        Samples in a lobe, if more than ``count``.

    Returns
    -------
    (n,) array, (n, 3) where a light is coloured
    """
    around = reach.around is not None
    if not around and all(share is None for share in reach.seen):
        return direct(
            space, lights, eyes, material, environments=environments, count=count, **settings
        )
    total = np.zeros(len(space.points), np.float32)
    for light, share in zip(lights, reach.seen, strict=True):
        part = direct(space, [light], eyes, material, **settings)
        if share is not None and isinstance(material, HalfLambert):
            share = _wrapped(cosines(space.normals_at(0), light.direction), share)
        total = added(total, part if share is None else (part.T * share).T)
    if reach.around is not None:
        shown = matt(material, space.normals_at(0), eyes)
        total = added(total, (shown * reach.around.T).T)
    if environments or reach.sent is not None:
        gloss = _gloss(space, eyes, material, reach, environments, max(count, rays), **settings)
        total = total if gloss is None else added(total, gloss)
    return total


def albedo(material: Material) -> float:
    """Return the share of even light that a material's matt part sends on in all, at most 1."""
    if isinstance(material, (CookTorrance, AshikhminShirley)):
        return min(float(2 * _WEIGHTS @ (_NODES * _shown(material, _NODES))), 1.0)
    return float(getattr(material, "diffuse", 1.0))


def matt(material: Material, normals: Single, eyes: Single) -> Single:
    """Return the share (n,) or () of even light that a material shows the eye diffusely.

    A half-Lambertian one shows half of what comes to it.
    """
    if isinstance(material, (CookTorrance, AshikhminShirley)):
        facing = np.abs(np.einsum("ij,ij->i", normals, np.broadcast_to(eyes.T, normals.shape)))
        along = np.linspace(0, 1, 257)
        return np.interp(facing, along, _shown(material, along)).astype(np.float32)
    half = 0.5 if isinstance(material, HalfLambert) else 1.0
    return np.asarray(half * albedo(material), np.float32)


def _shown(material: Material, facing: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 2 ∫ term(u) du over the cosines u of the light, at cosines (k,) to the eye."""

    def tilted(cosine: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine], axis=-1)

    lights, towards = tilted(_NODES)[:, None], tilted(facing)[None]
    terms = diffuse_term(material, np.array([0.0, 0.0, 1.0]), lights, towards)
    return np.asarray(2 * _WEIGHTS @ terms)


def refuse_unhidden(material: Material, illumination: str, *, shadows: bool) -> None:
    """Refuse shadows and bounces of what is no light.

    Raises
    ------
    MeshdepictError
        For a painted material, for shadows of a transparent one, and for precomputed light.
    """
    if isinstance(material, LitSphere):
        raise MeshdepictError(
            f"{type(material).__name__} shows no lights that could cast shadows or bounce: leave "
            "shadows and bounces out"
        )
    if shadows and isinstance(material, Refractive):
        raise MeshdepictError(
            "Refractive lets light through and casts no shadow: leave shadows out, and say by "
            "bounces how many walls light meets within"
        )
    if illumination != "lights":
        raise MeshdepictError(
            f"illumination={illumination!r} has light from all around, with occlusion of its own: "
            "leave shadows and bounces out"
        )


def _wrapped(cosine: Single, seen: Single) -> Single:
    """Return the share of ½ + ½ n·l that is left where a shadow takes ⟨n·l⟩ (1 − V)."""
    return np.asarray(
        1 - np.maximum(cosine, 0) * (1 - seen) / (1 + np.maximum(cosine, 0)), np.float32
    )


def _gloss(
    space: ScaleSpace,
    eyes: Single,
    material: Material,
    reach: Reached,
    environments: Sequence[Environment],
    count: int,
    **settings: Any,
) -> Single | None:
    """Return highlights of environments and of what bounced; None where a material has none."""
    kind, parameters = kernel_parameters(material)
    if kind < PHONG or not parameters[1] > 0:
        return None
    from meshdepict.shading.hidden_lobes import hidden_lobes

    def sampled(environment: Environment) -> list[LobeSamples]:
        return lobe_samples(
            space.planes_of((0,)), eyes, environment, kind, parameters, count=count, **settings
        )

    question: tuple[Any, ...] = kind, parameters, count, eyes
    for each in settings.values():
        question += tuple(each) if isinstance(each, tuple) else (each,)
    return hidden_lobes(space, environments, sampled, sent=reach.sent, question=question)
