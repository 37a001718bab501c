"""``da.depict`` on xarray's DataArrays: relief of terrain, at the same coordinates.

``import meshdepict.xarray`` makes it known, as ``import rioxarray`` does ``da.rio``::

    import meshdepict.xarray, rioxarray

    shaded = rioxarray.open_rasterio("dem.tif").depict.exaggerated(z_factor=2)
    shaded.plot.imshow(cmap="gray")
"""

from __future__ import annotations

from meshdepict.xarray.depict import Depict, height_field, register

__all__ = ["Depict", "height_field", "register"]

register()
