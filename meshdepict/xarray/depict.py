"""What ``da.depict`` does."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from meshdepict.baking.look import bake
from meshdepict.errors import MeshdepictError
from meshdepict.io.data_arrays import from_data_array, is_data_array, like_data_array
from meshdepict.options import nearest
from meshdepict.shading.registry import METHODS
from meshdepict.shapes.height_field import HeightField

__all__ = ["Depict", "height_field", "register"]


def height_field(array: Any) -> HeightField:
    """Return the terrain that a ``DataArray`` holds; see `io.data_arrays.from_data_array`.

    Raises
    ------
    MeshdepictError
        For what is none.
    """
    if not is_data_array(array):
        raise MeshdepictError(f"a {type(array).__name__} is no xarray.DataArray")
    return from_data_array(array)


class Depict:
    """Shading of a ``DataArray`` of heights: ``da.depict.exaggerated(light="northwest")``.

    Every method returns a new DataArray with the same coordinates and what a picture shows: 0 …
    1, black to white, or with a last dimension "band" in red, green and blue; NaN where no height
    is known. Its attribute "meshdepict" says how it came about.
    """

    def __init__(self, array: Any) -> None:
        self._array = array

    def __getattr__(self, name: str) -> Any:
        """Shade by the method of this name, with the settings of `bake`."""
        if name not in METHODS:
            raise AttributeError(
                f"da.depict has no method {name!r}{nearest(name, METHODS)} (there are "
                f"{', '.join(METHODS)})"
            )

        def shade(**settings: Any) -> Any:
            return self(name, **settings)

        shade.__name__, shade.__doc__ = name, inspect.getdoc(METHODS[name])
        return shade

    def __call__(self, method: str | Callable[..., Any] = "exaggerated", **settings: Any) -> Any:
        """Shade by a method of `shading.METHODS`; keywords as for `bake`.

        Returns
        -------
        xarray.DataArray

        Raises
        ------
        MeshdepictError
            As `bake`, and for what is no terrain.
        """
        field = from_data_array(self._array)
        baked = bake(field, method, **settings)
        colored = baked.intensity.ndim > 1 or any(
            getattr(baked.look, name) is not None for name in ("colormap", "colormap2d", "tint")
        )
        values = baked.colors / 255.0 if colored else baked.colors[:, 0] / 255.0
        attributes = {
            "long_name": f"{baked.provenance['method'].replace('_', ' ')} shading",
            "meshdepict": "\n".join(baked.comments),
        }
        return like_data_array(self._array, field, values, attributes)

    def __dir__(self) -> list[str]:
        """Return the methods, too, for tab completion."""
        return sorted({*super().__dir__(), *METHODS})

    def __repr__(self) -> str:
        """Return the methods."""
        return f"<depict: {', '.join(METHODS)}>"


def register() -> None:
    """Make ``.depict`` known to xarray; more than once does no harm.

    Raises
    ------
    MeshdepictError
        Where xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise MeshdepictError("da.depict needs xarray: pip install 'meshdepict[xarray]'") from None
    if getattr(xarray.DataArray, "depict", None) is not Depict:
        xarray.register_dataarray_accessor("depict")(Depict)
