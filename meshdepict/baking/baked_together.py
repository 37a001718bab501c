"""What a bake of several objects gives: each one's colours, and all of them in one picture."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from meshdepict.baking.baked import Baked
from meshdepict.scene.view import View
from meshdepict.shapes.joined import JoinedMesh

__all__ = ["BakedTogether"]


class BakedTogether(Sequence[Baked]):
    """Bakes of objects that stand together, in the order in which they were given.

    Parameters
    ----------
    bakes : sequence of Baked
    shown : sequence of Baked
        What pictures show: these, but for mirrors, and the ground.
    view : View
    ground : Baked, optional

    Attributes
    ----------
    scene : Baked
        All of them as one, with the ground: what pictures show.
    ground : Baked or None
        The ground, where the look asked for one.
    """

    def __init__(
        self,
        bakes: Sequence[Baked],
        shown: Sequence[Baked],
        view: View,
        *,
        ground: Baked | None = None,
    ) -> None:
        self._bakes, self.ground = tuple(bakes), ground
        facts = dict(bakes[0].provenance)
        if len(bakes) > 1:
            facts["objects"] = str(len(bakes))
        self.scene = Baked(
            JoinedMesh([baked.mesh for baked in shown]),
            _one_below_another([baked.intensity for baked in shown]),
            np.concatenate([baked.colors for baked in shown]),
            facts, view, look=bakes[0].look,
        )  # fmt: skip
        if len(shown) > 1:
            for baked in bakes:
                baked.scene = self.scene

    def __len__(self) -> int:
        """Return the number of objects."""
        return len(self._bakes)

    def __iter__(self) -> Iterator[Baked]:
        """Go through the objects."""
        return iter(self._bakes)

    @overload
    def __getitem__(self, index: int) -> Baked: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Baked]: ...

    def __getitem__(self, index: int | slice) -> Baked | Sequence[Baked]:
        """Return the bake of an object."""
        return self._bakes[index]

    def __repr__(self) -> str:
        """Return the bakes."""
        return f"<BakedTogether: {', '.join(repr(baked).strip('<>') for baked in self)}>"

    def picture(self, path: str | Path, **layout: Any) -> Path:
        """Render a picture of all objects and the ground; see `Baked.picture`."""
        return self.scene.picture(path, **layout)

    def _repr_png_(self) -> bytes | None:
        """Return a small picture, which notebooks show; None where nothing can be drawn."""
        return self.scene._repr_png_()


def _one_below_another(values: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return the values of all, in colour where any has some."""
    if all(each.ndim == 1 for each in values):
        return np.concatenate(values)
    rows = (each if each.ndim == 2 else np.repeat(each[:, None], 3, axis=1) for each in values)
    return np.concatenate([*rows])
