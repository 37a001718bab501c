"""Light that bounces between matt surfaces: B = e + ρ E, as often as asked for."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["bounced", "sent_on"]

Single = NDArray[np.float32]

_BRIGHTEST = np.float32(1e30)  # that is counted: what sends on more than it gets grows with bounces


class Gathers(Protocol):
    """What takes light from a surface to samples: a `Transfer`, or what scales its rays."""

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return what arrives of what each vertex sends."""


def bounced(
    transfer: Gathers,
    light: NDArray[Any],
    *,
    albedo: float | NDArray[Any],
    bounces: int,
    emitted: float | NDArray[Any] = 0.0,
) -> tuple[Single, Single]:
    """Return what arrives at each sample after so many bounces, and what was on the way there.

    ``E_0`` is the light that comes from outside, B_k = e + ρ E_k, and E_k = E_0 + T B_{k−1}.

    Parameters
    ----------
    transfer : Gathers
        T.
    light : (n,) or (n, c) array
        E_0 in units of irradiance over π: a light of 1 along the normal gives 1.
    albedo : float, (n,) or (n, c) array
        ρ in [0, 1]; what it colours has its channels.
    bounces : int
        k; with 0 the light comes back as it is.
    emitted : float or array that fits the light
        e, what the samples themselves send.

    Returns
    -------
    arriving : array
        E_k.
    sent : array
        B_{k−1}, whose light the last bounce brought; B_0 where there was none.
    """
    sent = sent_on(transfer, light, albedo=albedo, bounces=bounces, emitted=emitted)
    start = np.asarray(light, np.float32)
    if sent.ndim > start.ndim:  # colours under light that has none
        start = np.repeat(start[:, None], sent.shape[1], axis=1)
    return (start, sent) if bounces == 0 else (_arriving(transfer, start, sent), sent)


def sent_on(
    transfer: Gathers,
    light: NDArray[Any],
    *,
    albedo: float | NDArray[Any],
    bounces: int,
    emitted: float | NDArray[Any] = 0.0,
) -> Single:
    """Return B_{k−1}, what each sample sends that the last of k bounces brings; B_0 without any.

    Parameters are those of `bounced`.
    """
    start = np.asarray(light, np.float32)
    reflected, own = np.asarray(albedo, np.float32), np.asarray(emitted, np.float32)
    if reflected.ndim > start.ndim:
        start = np.repeat(start[:, None], reflected.shape[1], axis=1)
    elif 0 < reflected.ndim < start.ndim:
        reflected = reflected[:, None]
    sent = own + reflected * start
    for _ in range(bounces - 1):
        sent = own + reflected * _arriving(transfer, start, sent)
    return np.asarray(sent, np.float32)


def _arriving(transfer: Gathers, start: Single, sent: Single) -> Single:
    """Return E_0 + T B."""
    return np.minimum(start + transfer.from_surface(sent), _BRIGHTEST)
