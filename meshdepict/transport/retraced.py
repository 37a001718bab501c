"""Rays that are traced again for every sum: those of more samples than memory holds.

What they bring is bit for bit what kept rays would: each sample's are its own, whatever is traced
beside them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.limits import as_text, max_memory
from meshdepict.transport.rays import BATCH, FIRST, Steps, checked_rays
from meshdepict.transport.transfer import (
    RAY_BYTES,
    USUAL,
    Leaving,
    Probes,
    Transfer,
    fits_memory,
    places,
    probe_places,
    traced_part,
)

if TYPE_CHECKING:
    from meshdepict.scene.environment import Environment
    from meshdepict.shapes.mesh import Mesh

__all__ = ["InParts", "Retraced", "transfer_of"]

Floats = NDArray[np.float64]
Single = NDArray[np.float32]
Ints = NDArray[np.int64]
Progress = Callable[[float, float], None]


class _Sums(Protocol):
    """What takes light that comes by rays to samples."""

    def from_surface(self, values: NDArray[Any], /) -> Single: ...

    def from_sky(self, environment: Environment, /) -> Single: ...


class Retraced:
    """What a `Transfer` is, of rays that are not kept: every sum traces them, part after part.

    Parameters
    ----------
    mesh : Mesh
        What rays can meet.
    at : three (n, 3) arrays
        Of the samples: points in the mesh's unit frame, unit normals, and where rays start off.
    rays : int
        Of each sample.
    steps : (2, 3) array
        Which set; see `rays`.
    how : Leaving
    probes : Probes, optional
        What tells the error.

    Attributes
    ----------
    progress : callable, optional
        ``progress(done, total)``, in each sum from its beginning.

    Raises
    ------
    MeshdepictError
        Where memory doesn't hold a part either.
    """

    def __init__(
        self,
        mesh: Mesh,
        at: tuple[Floats, NDArray[Any], Floats],
        rays: int,
        *,
        steps: Steps = FIRST,
        how: Leaving = USUAL,
        probes: Probes | None = None,
    ) -> None:
        least = RAY_BYTES * max(rays, BATCH)
        if least > max_memory():
            raise MeshdepictError(
                f"rays={rays} take {as_text(least)} at a time, more than the "
                f"{as_text(max_memory())} of memory that are allowed: allow more with --max-memory"
            )
        self.rays, self.probes = rays, probes
        self.points, normals, self.lifts = at
        self.normals = np.asarray(normals, np.float32)
        self._mesh, self._axes, self._steps = mesh, np.asarray(normals), steps
        self._how = how
        self._step = max_memory() // (RAY_BYTES * rays)
        self.progress: Progress | None = None

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.points)

    def __getstate__(self) -> dict[str, Any]:
        """Return all but whom progress is told."""
        return {**self.__dict__, "progress": None}

    def parts(self) -> Iterator[tuple[Ints, Transfer]]:
        """Trace the rays; yield which samples a part has, and where their rays go."""
        count = len(self)
        batch = max(1, BATCH // self.rays)
        for begin in range(0, count, self._step):
            here = np.arange(begin, min(begin + self._step, count))
            finished = 0

            def done(_: int, first: int = begin, last: int = int(here[-1]) + 1) -> None:
                nonlocal finished
                finished += 1
                if self.progress is not None:
                    self.progress(min(first + finished * batch, last), count)

            at = self.points[here], self._axes[here], self.lifts[here]
            yield (
                here,
                traced_part(
                    self._mesh, at, self.rays, steps=self._steps, how=self._how.of(here), done=done
                ),
            )

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return T B; see `Transfer.from_surface`."""
        return InParts(self, lambda part, _: part).from_surface(values)

    def from_sky(self, environment: Environment, /) -> Single:
        """Return S (n, 3); see `Transfer.from_sky`."""
        return InParts(self, lambda part, _: part).from_sky(environment)

    @property
    def sky_share(self) -> Single:
        """(n,) shares of the rays that get away."""
        out = np.empty(len(self), np.float32)
        for here, part in self.parts():
            out[here] = part.sky_share
        return out


class InParts:
    """What gathers light along rays that are not kept, as something makes of each part.

    Parameters
    ----------
    transfer : Retraced
    along : callable (Transfer, which samples) → what has from_surface and from_sky
    """

    def __init__(self, transfer: Retraced, along: Callable[[Transfer, Ints], _Sums]) -> None:
        self._transfer, self._along = transfer, along

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self._transfer)

    def from_surface(self, values: NDArray[Any], /) -> Single:
        """Return what arrives of what each vertex sends, values (v,) or (v, c)."""
        out = np.empty((len(self), *values.shape[1:]), np.float32)
        for here, part in self._transfer.parts():
            out[here] = self._along(part, here).from_surface(values)
        return out

    def from_sky(self, environment: Environment, /) -> Single:
        """Return what arrives (n, 3) of an environment."""
        out = np.empty((len(self), 3), np.float32)
        for here, part in self._transfer.parts():
            out[here] = self._along(part, here).from_sky(environment)
        return out


def transfer_of(
    mesh: Mesh,
    *,
    normals: NDArray[Any] | None = None,
    rays: int = 64,
    part: slice = slice(None),
    how: Leaving = USUAL,
    progress: Progress | None = None,
) -> Transfer | Retraced:
    """Return where rays from the vertices of a mesh go, kept where the memory that is allowed does.

    Parameters
    ----------
    mesh, normals, rays, part, how
        As for `traced_transfer`.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    MeshdepictError
        For another number of rays, and where memory holds next to nothing.
    """
    from meshdepict.transport.transfer import traced_transfer

    count = checked_rays(rays)
    samples = len(mesh.vertices[part])
    if fits_memory(samples, count):
        batches = -(-samples // max(1, BATCH // count))
        finished = 0

        def done(_: int) -> None:
            nonlocal finished
            finished += 1
            if progress is not None:
                progress(min(finished, batches), batches)

        return traced_transfer(mesh, normals=normals, rays=count, part=part, how=how, done=done)
    at = places(mesh, normals, part)
    chosen, again, steps = probe_places(at)
    second: Transfer | Retraced = (
        traced_part(mesh, again, count, steps=steps, how=how.of(chosen))
        if fits_memory(len(chosen), count)
        else Retraced(mesh, again, count, steps=steps, how=how.of(chosen))
    )
    return Retraced(mesh, at, count, how=how, probes=Probes(chosen, second))
