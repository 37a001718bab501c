"""Light that bounces between matt surfaces: B = e + ρ E, as often as asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdepict.transport.transfer import Transfer

__all__ = ["bounced"]

Single = NDArray[np.float32]


def bounced(
    transfer: Transfer,
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
    transfer : Transfer
        T.
    light : (n,) or (n, c) array
        E_0 in units of irradiance over π: a light of 1 along the normal gives 1.
    albedo : float or array that fits the light
        ρ in [0, 1].
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
    start = np.asarray(light, np.float32)
    reflected, own = np.asarray(albedo, np.float32), np.asarray(emitted, np.float32)
    arriving, sent = start, own + reflected * start
    for bounce in range(bounces):
        if bounce:
            sent = own + reflected * arriving
        arriving = start + transfer.from_surface(sent)
    return arriving, sent
