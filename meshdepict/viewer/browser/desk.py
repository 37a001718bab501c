"""What the page asks for, done to a session: one thing after the other, apart from the server."""

from __future__ import annotations

import copy
import inspect
import re
from collections.abc import Callable, Iterable
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from meshdepict.baking.recipe import save_recipe
from meshdepict.errors import MeshdepictError
from meshdepict.options import as_text
from meshdepict.scene.light import Light
from meshdepict.scene.rig import Rig
from meshdepict.scene.view import View
from meshdepict.viewer.browser.looks import Looks
from meshdepict.viewer.controls import Control, place_option, slid
from meshdepict.viewer.packing import sight

if TYPE_CHECKING:
    from meshdepict.baking.baked import Baked
    from meshdepict.baking.baked_texture import BakedTexture
    from meshdepict.viewer.session import Session

__all__ = ["KINDS", "Desk"]

KINDS = {"ply": "ply", "glb": "glb", "png": "png", "html": "html", "recipe": "toml"}
"""What can be saved, and the suffix of its file."""

_OFFERED = ("gray", "sepia", "stone", "gooch", "viridis", "cividis", "magma", "RdBu_r")


class Desk:
    """A session as a page sees it.

    Parameters
    ----------
    session : Session
    title : str
        What the page calls the shape; files are named after it.
    """

    def __init__(self, session: Session, title: str) -> None:
        self.session = session
        self.title = title
        self.looks = Looks(session)
        self._distance = float(np.linalg.norm(session.view.position - session.view.focus))

    def apply(self, changes: Iterable[Any]) -> str:
        """Make changes, each [kind, values…], and shade; return what went wrong, if anything did.

        Kinds: method name; option method name value (None: the default); light x y z in a list;
        attend x y z in a list or None; follow whether; view frame focus half-height;
        colormap name; reset; texture whether.
        """
        faults = []
        for change in changes:
            try:
                kind, *values = change
                if kind not in _VERBS:
                    raise MeshdepictError(f"the page asked for {kind!r}, which is unknown")
                _VERBS[kind](self, *values)
            except MeshdepictError as error:
                faults.append(str(error))
            except (TypeError, ValueError):
                faults.append(f"the page sent what is no change: {change!r:.80}")
        try:
            self.session.baked()
            self.looks.refresh()
        except (MeshdepictError, MemoryError) as error:
            faults.append(str(error) or "out of memory")
        return "; ".join(faults)

    def look(self) -> dict[str, Any]:
        """Return all that the page's controls show."""
        from meshdepict.shading.registry import METHODS

        session, light = self.session, self.session.light
        summary = (inspect.getdoc(session.function) or "").partition("\n\n")[0]
        handle = session.light.lamps[0] if isinstance(session.light, Rig) else session.light
        return {
            "title": self.title,
            "kinds": list(KINDS),
            "method": session.method,
            "methods": list(METHODS),
            "about": " ".join(summary.split()),
            "place": place_option(session.function) or "",
            "controls": [self._control(control) for control in session.controls],
            "light": handle.direction.tolist() if isinstance(handle, Light) else None,
            "follows": session.light_fixed_to == "eye",
            "lightText": str(light)[:200],
            "colormap": session.colormap or "",
            "colormaps": list(_OFFERED),
            **self.looks.described(),
        }

    def home(self) -> dict[str, Any]:
        """Return the view from which the page should look."""
        return sight(self.session.view)

    def shown(self, kind: str) -> Baked | BakedTexture:
        """Return what a kind of file holds, as it is seen now: a texture, or colours at vertices.

        The session's own go on with its view.
        """
        texture = None if kind == "ply" else self.looks.texture
        return copy.copy(self.session.baked()) if texture is None else texture

    def name(self, kind: str) -> str:
        """Return a name for a file, in letters that every disk and header takes."""
        stem = re.sub(r"[^A-Za-z0-9._-]+", "-", Path(self.title).stem).strip("-.") or "mesh"
        return f"{stem}-{self.session.method}.{KINDS[kind]}"

    def save(self, kind: str, shown: Baked | BakedTexture, size: tuple[int, int]) -> bytes:
        """Return a file of one of `KINDS`.

        Raises
        ------
        MeshdepictError
            For a recipe that no file can hold, and a picture of an impossible size.
        """
        with TemporaryDirectory(prefix="meshdepict-") as folder:
            path = Path(folder) / self.name(kind)
            if kind == "recipe":
                save_recipe(path, self.session.recorded())
            elif kind == "png":
                shown.picture(path, size=size)
            else:
                shown.save(path)
            return path.read_bytes()

    def _control(self, control: Control) -> dict[str, Any]:
        value = self.session.value(control)
        shown = control.start if value is None else value
        if control.kind == "slider":
            shown = slid(control, value)
        if control.kind == "text":
            shown = "" if value is None else as_text(value)
        word = value if control.kind == "slider" and isinstance(value, str) else ""
        return {**asdict(control), "default": None, "value": _plain(shown), "unset": value is None,
                "word": word, "changed": value != control.default}  # fmt: skip

    # --- changes ------------------------------------------------------------------------------

    def _option(self, method: str, name: str, value: object) -> None:
        if method == self.session.method:  # else another one was chosen meanwhile
            self.session.set(**{name: value})

    def _look(self, frame: ArrayLike, focus: ArrayLike, half_height: float) -> None:
        axes, centre = (np.asarray(numbers, dtype=np.float64) for numbers in (frame, focus))
        if axes.shape != (3, 3) or centre.shape != (3,):
            raise MeshdepictError("a view needs three axes and a focus")
        self.session.look(
            View(
                centre + self._distance * axes[2], centre, axes[1],
                height_px=self.session.view.height_px, parallel_scale=half_height,
            )
        )  # fmt: skip

    def _use(self, method: str) -> None:
        self.session.use(method)

    def _attend(self, point: ArrayLike | None) -> None:
        self.session.attend(point)

    def _shine(self, direction: ArrayLike) -> None:
        self.session.shine(Light(direction))

    def _follow(self, follow: object) -> None:
        self.session.fix_light("eye" if follow else "object")

    def _paint(self, colormap: str | None) -> None:
        self.session.paint(colormap)

    def _reset(self) -> None:
        self.session.reset()

    def _bake_texture(self, wanted: object) -> None:
        self.looks.bake(wanted=bool(wanted))


_VERBS: dict[str, Callable[..., None]] = {
    "method": Desk._use,
    "option": Desk._option,
    "light": Desk._shine,
    "attend": Desk._attend,
    "follow": Desk._follow,
    "view": Desk._look,
    "colormap": Desk._paint,
    "reset": Desk._reset,
    "texture": Desk._bake_texture,
}


def _plain(value: Any) -> Any:
    """Return a value that travels: a number, a text or None."""
    return value if value is None or isinstance(value, (int, float, str)) else str(value)
