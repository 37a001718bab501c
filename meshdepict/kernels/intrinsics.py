"""What kernels call of numba's own making, without numba being loaded with them.

A file that extends numba imports it. Kernels refer to its functions by these, so that it is read
where something is to be compiled, and nowhere else.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import importlib.util
from pathlib import Path
from typing import Any

__all__ = ["Intrinsic"]


class Intrinsic:
    """A function of a module, declared there by `numba.extending.intrinsic`.

    Parameters
    ----------
    module, name : str
    *constants
        What the module takes from elsewhere.
    """

    def __init__(self, module: str, name: str, *constants: Any) -> None:
        self.module, self.name, self.constants = module, name, constants

    def __call__(self, *_: Any) -> Any:
        """Refuse: kernels alone call it, and numba reads them."""
        raise TypeError(f"{self.name} has a meaning within kernels only")

    @functools.cached_property
    def fingerprint(self) -> str:
        """Of the file that it stands in, and of what that takes from elsewhere."""
        found = importlib.util.find_spec(self.module)
        assert found is not None
        assert found.origin is not None
        text = Path(found.origin).read_bytes()
        return hashlib.sha256(text + repr((self.name, self.constants)).encode()).hexdigest()

    @property
    def _numba_type_(self) -> Any:
        """As what numba sees it."""
        from numba.core.registry import cpu_target

        function = getattr(importlib.import_module(self.module), self.name)
        cpu_target.typing_context.refresh()  # it may have been read this moment
        cpu_target.target_context.refresh()
        return cpu_target.typing_context.resolve_value_type(function)
