"""Methods that other packages bring along, by the entry point group ``meshdepict.methods``.

In the ``pyproject.toml`` of such a package::

    [project.entry-points."meshdepict.methods"]
    contour_light = "my_package.contours:contour_light"
"""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from typing import TYPE_CHECKING, Any

from meshdepict.errors import MeshdepictWarning
from meshdepict.shading.method import is_method

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["GROUP", "Methods"]

GROUP = "meshdepict.methods"


class Methods(MutableMapping[str, Callable[..., Any]]):
    """Shading functions by name: those given, then those of other packages.

    Other packages are looked for when a name is asked for that isn't among those given, or all
    are; each of their functions is imported when it is asked for, or all are. What can't be taken
    is left out with a `MeshdepictWarning`, once.

    Parameters
    ----------
    own : mapping of str to shading function
    """

    def __init__(self, own: Mapping[str, Callable[..., Any]]) -> None:
        self._known = dict(own)
        self._waiting: dict[str, EntryPoint] | None = None
        self._lock = threading.RLock()

    def __getitem__(self, name: str) -> Callable[..., Any]:
        """Return the method of a name."""
        if name not in self._known:
            self._load(name)
        return self._known[name]

    def __setitem__(self, name: str, function: Callable[..., Any]) -> None:
        """Let a method be known, until the program ends."""
        self._known[name] = function

    def __delitem__(self, name: str) -> None:
        """Forget a method."""
        del self._known[name]

    def __iter__(self) -> Iterator[str]:
        """Go through the names of all methods."""
        self._load()
        return iter(list(self._known))

    def __len__(self) -> int:
        """Return how many there are."""
        self._load()
        return len(self._known)

    def __repr__(self) -> str:
        """Return the names."""
        return f"<methods: {', '.join(self)}>"

    def _load(self, *names: str) -> None:
        """Import those of other packages that are called so, or all that are left."""
        from importlib.metadata import entry_points

        with self._lock:
            notes: list[str] = []
            if self._waiting is None:
                self._waiting = {}
                for point in entry_points(group=GROUP):
                    other = self._waiting.setdefault(point.name, point)
                    if point.name in self._known:
                        del self._waiting[point.name]
                    if point.name in self._known or other != point:
                        notes.append(f"{_package(point)} offers a method {point.name!r}, a name "
                                     "that is taken: it is left out")  # fmt: skip
            for name in names or list(self._waiting):
                if name in self._waiting:
                    notes += self._take(self._waiting.pop(name))
            for note in notes:
                warnings.warn(note, MeshdepictWarning, stacklevel=3)

    def _take(self, point: EntryPoint) -> list[str]:
        """Import a method; return what is wrong with it, if anything is."""
        what = f"{_package(point)}: its method {point.name!r}"
        try:
            function = point.load()
        except (Exception, SystemExit) as error:  # whatever another's code may do
            text = " ".join(f"{type(error).__name__}: {error}".split())
            return [f"{what} can't be loaded and is left out ({text:.200})"]
        if not is_method(function):
            return [f"{what} is left out: {point.value} is no function declared with md.method"]
        if function.__name__ != point.name:
            return [f"{what} is left out: the function is called {function.__name__!r}, and both "
                    "need one name"]  # fmt: skip
        self._known[point.name] = function
        return []


def _package(point: EntryPoint) -> str:
    """Return the name of the package that an entry point is of."""
    return point.dist.name if point.dist is not None else point.module
