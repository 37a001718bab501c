"""What a viewer of volumes shows and lets people change: `Session`, and the transfer function."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from meshdepict.baking.volumes import BakedVolume, as_volume, bake_volume
from meshdepict.color.transfer import for_volume
from meshdepict.color.transfer_function import TransferFunction
from meshdepict.scales.grid_scales import GridSpace
from meshdepict.scene.names import as_lighting, as_view
from meshdepict.scene.view import View
from meshdepict.viewer.session import Session

__all__ = ["VolumeSession"]

_KEPT = 3  # scale spaces, so that going back to a transfer function or method takes no smoothing


class VolumeSession(Session):
    """A volume under a light, shaded by a method, shown by a transfer function.

    Parameters
    ----------
    volume : path, Volume, pyvista.ImageData or BakedVolume
        A bake brings its transfer function, view and normals along.
    method, transfer, light, view, up, scales, width, ratio, tolerance, **options
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
        volume: Any,
        method: str = "exaggerated",
        *,
        transfer: str | TransferFunction = "bone",
        light: Any = "northwest",
        view: str | View = "front",
        up: str = "z",
        scales: int | None = None,
        width: float | str | None = None,
        ratio: float | None = None,
        tolerance: float = 1e-3,
        progress: Callable[[float, float], None] | None = None,
        **options: Any,
    ) -> None:
        given = volume if isinstance(volume, BakedVolume) else None
        self.shape: Any = given.shape if given is not None else as_volume(volume)
        self.up = up
        self.view = as_view(view if given is None else given.view, self.shape, up=up)
        self.light = as_lighting(light, self.view, up=up)
        self.progress = progress
        self._asked = {"scales": scales, "ratio": ratio}
        self._smoothing = {"width": width, "tolerance": tolerance}
        self._transfers: dict[str, TransferFunction] = {}
        self._grids: dict[tuple[str, int, float | None], GridSpace] = {}
        self._options = {}
        self._baked: Any = None
        self.method = method
        self.colormap = None
        self.light_fixed_to = "object"
        self.use(method)
        self.set(**options)
        if given is not None and given.transfer is not None:
            transfer = given.transfer
        self.show(transfer)
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

    def look_now(self) -> Any:
        """Return what is chosen, for `go_back`."""
        return self.transfer, super().look_now()

    def go_back(self, look: Any) -> None:
        """Choose again what `look_now` returned."""
        self.show(look[0])
        super().go_back(look[1])

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
            smoothing: dict[str, Any] = {}
            if found is None:
                smoothing = {
                    "transfer": self.transfer, "progress": self.progress,
                    **self._asked, **self._smoothing,
                }  # fmt: skip
            self._baked = bake_volume(
                self.shape if found is None else found, self.method, light=self.light,
                view=self.view, up=self.up, **smoothing, **self.options,
            )  # fmt: skip
            if found is None and self._baked.space is not None:
                self._keep(self._baked.space)
        return self._baked

    def settings(self) -> dict[str, Any]:
        """Return the keywords of `bake_volume` that make this look."""
        return {
            "method": self.method, "transfer": self.transfer, "light": self.light,
            "view": self.view, "up": self.up, **self._asked, **self._smoothing, **self.options,
        }  # fmt: skip

    def _key(self) -> tuple[str, int, float | None]:
        declared = self.declared
        scales = declared.scales if self._asked["scales"] is None else self._asked["scales"]
        ratio = self._asked["ratio"] or declared.ratio
        return self.transfer.name, scales if declared.scales else 0, ratio

    def _keep(self, space: GridSpace) -> None:
        self._grids[self._key()] = space
        while len(self._grids) > _KEPT:
            del self._grids[next(iter(self._grids))]
