"""What a viewer of volumes shows and lets people change: `Session`, and the transfer function."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from meshdepict.baking.choice_list import choice_fields
from meshdepict.baking.look import Look
from meshdepict.baking.volumes import BakedVolume, as_volume, bake_grid
from meshdepict.color.transfer import PRESETS, for_volume
from meshdepict.color.transfer_function import TransferFunction
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.viewer.session import Session

__all__ = ["VolumeSession"]

_KEPT = 3  # scale spaces, so that going back to a transfer function or method takes no smoothing


class VolumeSession(Session):
    """A volume under a light, shaded by a method, shown by a transfer function.

    Parameters
    ----------
    volume : path, Volume, pyvista.ImageData or BakedVolume
        A bake brings its transfer function, view and normals along.
    method, **chosen
        As for `bake_volume`.
    progress : callable, optional
        ``progress(done, total)``, whenever normals are smoothed.

    Attributes
    ----------
    transfer : TransferFunction
        In the volume's unit.

    Raises
    ------
    MeshdepictError
        As `bake_volume`.
    """

    def __init__(  # not Session's, which wants a mesh
        self,
        volume: object,
        method: str | Callable[..., Any] = "exaggerated",
        *,
        progress: Callable[[float, float], None] | None = None,
        **chosen: Any,
    ) -> None:
        given = volume if isinstance(volume, BakedVolume) else None
        self.shape: Any = given.shape if given is not None else as_volume(volume)
        look = Look(method, **chosen)
        if given is not None:
            look = look.replace(view=given.view, transfer=given.transfer or look.transfer)
        self._transfers: dict[str, TransferFunction] = {}
        self._grids: dict[tuple[str, int, float | None], GridSpace] = {}
        self._begin(look, progress)
        self.show(look.of_kind("volume").transfer)
        if given is not None and given.space is not None:
            self._keep(given.space)
        self._first = self.look_now()

    def show(self, transfer: str | TransferFunction) -> None:
        """Show other things, or in other colours: a preset's name, a .toml file or a function.

        Raises
        ------
        MeshdepictError
            As `for_volume`.
        """
        if isinstance(transfer, TransferFunction) and transfer.unit == self.shape.unit:
            self._transfers[transfer.name] = transfer
        name = transfer.name if isinstance(transfer, TransferFunction) else str(transfer)
        if name not in self._transfers:  # once: it warns where it has to guess
            self._transfers[name] = for_volume(transfer, self.shape)
        self.transfer = self._transfers[name]
        self._baked = None

    @property
    def transfers(self) -> list[str]:
        """Names of what can be shown: the presets, and what else was shown."""
        return [*PRESETS, *(name for name in self._transfers if name not in PRESETS)]

    def look_now(self) -> Look:
        """Return what is chosen, for `go_back`, recipes and bakes."""
        return super().look_now().replace(transfer=self.transfer)

    def go_back(self, look: Look) -> None:
        """Choose again what `look_now` returned."""
        self.show(look.transfer)
        super().go_back(look)

    @property
    def space(self) -> Any:
        """The scale space of what is shown, None where it takes too much memory."""
        return self.baked().space

    def baked(self) -> Any:
        """Return the `BakedVolume` of what is chosen; made once for each choice."""
        if self._baked is None:
            found = self._grids.get(self._key())
            if found is None and self.declared.scales == 0:  # any: it takes their first normals
                same = (s for key, s in self._grids.items() if key[0] == self.transfer.name)
                found = next(same, None)
            look = self.look_now()
            if found is None:
                self._baked = bake_grid(self.shape, look, progress=self.progress)
            else:
                made = dict.fromkeys(("scales", "width", "ratio", "transfer"))
                made["tolerance"] = choice_fields()["tolerance"].default
                self._baked = bake_grid(found, look.replace(**made), progress=self.progress)
            if found is None and self._baked.space is not None:
                self._keep(self._baked.space)
        return self._baked

    def _key(self) -> tuple[str, int, float | None]:
        scales, ratio = self._asked.replace(method=self.function).ladder
        return self.transfer.name, scales, ratio

    def _keep(self, space: GridSpace) -> None:
        self._grids[self._key()] = space
        while len(self._grids) > _KEPT:
            del self._grids[next(iter(self._grids))]
