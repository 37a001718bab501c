"""Objects that stand together: each is smoothed by itself, and rays from each meet all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from meshdepict.scales.ladder import Progress
from meshdepict.shapes.joined import JoinedMesh

if TYPE_CHECKING:
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.transport.retraced import Retraced
    from meshdepict.transport.transfer import Leaving, Transfer

__all__ = ["Company", "Rehearsed", "Sending"]


class Samples(Protocol):
    """A scale space, as far as it is asked here."""

    at_vertices: bool
    member: int
    tints: NDArray[np.float32] | None

    def normals_at(self, scale: int, /) -> NDArray[np.float32]:
        """Return the unit normals (n, 3) of a scale."""


class Rehearsed(Exception):  # noqa: N818  # no error: what was to be heard has been said
    """Ends a rehearsal."""


class Sending(NamedTuple):
    """What an object makes of light that it sends on.

    Attributes
    ----------
    albedo : float, or (n, 3) array
        Of its vertices.
    gathering : shading.gathering.Gathering
        How its method gathers light.
    """

    albedo: float | NDArray[np.float32]
    gathering: Any


class Company:
    """The objects of a scene.

    What light an object gets depends on what all others make of theirs: each says so once, in a
    rehearsal, before the first is shaded. What says nothing, because its method has no matt
    material, is in the way of light and sends none on.

    Parameters
    ----------
    meshes : sequence of Mesh

    Attributes
    ----------
    surface : JoinedMesh
        What rays can meet.
    sendings : {int: Sending}
        By the number of the object.
    mirrors : set of int
        The objects that are mirrors.
    """

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        self.surface = JoinedMesh(meshes)
        self.sendings: dict[int, Sending] = {}
        self.mirrors: set[int] = set()
        self._normals: list[NDArray[Any]] = [mesh.normals for mesh in meshes]
        self._listening = False
        self._transfers: dict[tuple[int, int], Transfer | Retraced] = {}
        self._kept: tuple[Any, Any] = None, None

    @contextmanager
    def rehearsal(self) -> Iterator[None]:
        """Shade an object within, to hear what it sends on."""
        self._listening = True
        try:
            yield
        except Rehearsed:
            pass
        finally:
            self._listening = False

    def hear(self, space: Samples, albedo: float, gathering: Any) -> None:
        """Take down what an object says of itself in a rehearsal, and end that."""
        if not self._listening:
            return
        tinted = albedo if space.tints is None else np.float32(albedo) * space.tints
        self.sendings[space.member] = Sending(tinted, gathering)
        self._end(space)

    def hear_mirror(self, space: Samples) -> None:
        """Take down that an object is a mirror in a rehearsal, and end that."""
        if self._listening:
            self.mirrors.add(space.member)
            self._end(space)

    def _end(self, space: Samples) -> None:
        if space.at_vertices:
            self._normals[space.member] = space.normals_at(0)
        raise Rehearsed

    @property
    def normals(self) -> NDArray[Any]:
        """(v, 3) unit normals of all vertices, as they are shaded."""
        return np.concatenate(self._normals)

    @property
    def mirror_faces(self) -> NDArray[np.bool_]:
        """Of each triangle, whether its object is a mirror."""
        known = (number in self.mirrors for number in range(len(self.surface.meshes)))
        counts = [len(mesh.faces) for mesh in self.surface.meshes]
        return np.repeat([*known], counts)

    def transport(
        self, rays: int, member: int, *, progress: Progress | None = None
    ) -> Transfer | Retraced:
        """Return where rays from the vertices of an object go; traced once."""
        from meshdepict.transport.transfer import USUAL

        if (rays, member) not in self._transfers:
            found = self.traced(rays, member, USUAL, progress=progress)
            self._transfers[rays, member] = found
        return self._transfers[rays, member]

    def traced(
        self, rays: int, member: int, how: Leaving, *, progress: Progress | None = None
    ) -> Transfer | Retraced:
        """Return where rays from the vertices of an object go; see `ScaleSpace.traced`."""
        from meshdepict.transport.retraced import transfer_of

        return transfer_of(
            self.surface, normals=self.normals, rays=rays,
            part=self.surface.parts[member], how=how, progress=progress,
        )  # fmt: skip

    def places(self, member: int) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return where the vertices of an object are, in the unit frame of all, and normals."""
        return self.surface.unit_points[self.surface.parts[member]], self._normals[member]

    def once(self, key: Any, find: Callable[[], Any]) -> Any:
        """Return what was found for a key, or find it; of the last key it is kept."""
        known, found = self._kept
        if known != key:
            found = find()
            self._kept = key, found
        return found
