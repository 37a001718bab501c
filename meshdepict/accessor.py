"""``mesh.depict`` on PyVista's datasets: shading as a chainable filter.

PyVista imports this module when somebody first writes ``.depict``, by the entry point
``pyvista.accessors``.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from meshdepict.baking.baked import Baked
from meshdepict.baking.choice_list import LADDER
from meshdepict.baking.look import Look, bake
from meshdepict.baking.pixel_widths import measured
from meshdepict.baking.surfaces import as_mesh
from meshdepict.errors import MeshdepictError
from meshdepict.options import check, nearest, options_of
from meshdepict.scales.making import scale_space
from meshdepict.scales.space import ScaleSpace
from meshdepict.shading.method import declaration
from meshdepict.shading.registry import METHODS, find_method
from meshdepict.shapes.height_field import HeightField
from meshdepict.shapes.height_grids import image_ground, is_layer, structured_ground
from meshdepict.shapes.lengths import counts_pixels
from meshdepict.shapes.sheet import SCALARS, scalar_array

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meshdepict.shading.method import Declaration
    from meshdepict.shapes.data_set import ImageData
    from meshdepict.shapes.mesh import Mesh
    from meshdepict.shapes.volume import Volume

__all__ = ["Depict", "register"]

_FIELD = "meshdepict"  # the field array that holds the provenance, as in `exchange`
_NEUTRAL = 127  # where there is nothing to shade
_BAKE = {
    name: parameter
    for name, parameter in inspect.signature(bake).parameters.items()
    if parameter.kind is parameter.KEYWORD_ONLY and name not in ("progress", "refine")
}  # a refined bake has vertices that the dataset has not


class Depict:
    """Shading of a PyVista dataset: ``mesh.depict.exaggerated(light="northwest")``.

    Every method returns a copy of the dataset with the colours "RGB", active, and the values
    "depict_<method>"; its own colours become "original_RGB". So calls chain, each working on the
    geometry. The smoothed normals are kept with the dataset until its points or faces change, by
    VTK's clock: who writes into ``points`` by way of NumPy says ``mesh.GetPoints().Modified()``.

    A ``PolyData`` is shaded as it is. An ``ImageData`` with one layer of points is a height field:
    its active scalars are heights, in its units; where they are NaN, the colour is grey. So is a
    ``StructuredGrid`` of one layer, evenly spaced in x and y, with its points' z; other layers are
    sheets, shaded as meshes. An ``ImageData`` with several layers is a volume, whose voxels get
    "RGBA"; see `bake_volume`.
    """

    def __init__(self, dataset: Any) -> None:
        self._dataset = dataset
        self._surface: _Surface | None = None
        self._voxels: tuple[Any, Any] = (None, None)

    def __getattr__(self, name: str) -> Any:
        """Say what is near to an unknown method."""
        raise AttributeError(
            f"mesh.depict has no method {name!r}{nearest(name, METHODS)} (there are "
            f"{', '.join(METHODS)})"
        )

    def __call__(self, method: str | Callable[..., Any] = "exaggerated", **settings: Any) -> Any:
        """Shade by a method of `shading.METHODS`; keywords as for `bake`.

        Parameters
        ----------
        method : str or function
            As for `bake`.
        **settings
            Of `bake`, and the method's own; for an ``ImageData`` also ``scalars``, the name of the
            heights.

        Returns
        -------
        pyvista.PolyData, pyvista.ImageData or pyvista.StructuredGrid

        Raises
        ------
        MeshdepictError
            As `bake`, and for datasets without a surface of their own.
        """
        dataset = self._dataset
        kind = _kind(dataset)
        function = find_method(method)
        scalars = settings.pop("scalars", None) if kind in ("heights", "volume") else None
        if kind == "volume":
            return self._shade_volume(method, scalars, settings)
        check(function, {k: v for k, v in settings.items() if k not in _BAKE}, function.__name__)
        # The file's own colours may change where the geometry doesn't: no memory of those.
        fresh = settings.get("albedo") == "keep" and kind == "mesh"
        surface = self._kept(scalars) if not fresh else _surface_of(dataset, None)
        if counts_pixels(settings.get("width")):
            settings["width"] = measured(Look(method, **settings), surface.shape).width
        settings = _with_ladder(method, settings)
        ladder = {name: settings.pop(name) for name in LADDER if name in settings}
        factor = settings.get("z_factor", 1.0)
        baked = bake(surface.space(declaration(function), ladder, factor), method, **settings)
        result = _dressed(dataset, surface, baked)
        result.depict._surface = surface.of(result)
        return result

    def _shade_volume(
        self, method: str | Callable[..., Any], scalars: str | None, settings: dict[str, Any]
    ) -> Any:
        """Return the image with the voxels' colours and opacities, "RGBA"."""
        from meshdepict.baking.look import bake_volume

        image = self._dataset
        where, name = scalar_array(image, scalars)
        declared = declaration(find_method(method))
        settings = _with_ladder(method, settings, ("tolerance",))
        seen = ("view", "up") if counts_pixels(settings.get("width")) else ()
        ladder = tuple(settings.get(key) for key in ("transfer", *LADDER, *seen))
        key = _stamp(image, scalars), declared.scales, declared.ratio, ladder
        if key == self._voxels[0]:
            shape = self._voxels[1]
            settings = {k: v for k, v in settings.items() if k not in ("transfer", *LADDER)}
        else:
            shape = _volume_of(image, where, name)
        baked = bake_volume(shape, method, **settings)
        if baked.space is not None:
            self._voxels = key, baked.space
        result = image.copy()
        data = result.point_data if where == "point" else result.cell_data
        data["RGBA"] = baked.rgba.reshape(-1, 4)
        result.field_data[_FIELD] = [f"meshdepict {k}: {v}" for k, v in baked.provenance.items()]
        result.field_data[SCALARS] = [name]
        result.set_active_scalars("RGBA", preference=where)
        return result

    def __repr__(self) -> str:
        """Return the methods."""
        return f"<depict: {', '.join(METHODS)}>"

    def _kept(self, scalars: str | None) -> _Surface:
        """Return the surface made last, or a new one where the dataset has changed since."""
        stamp = _stamp(self._dataset, scalars)
        if self._surface is None or self._surface.stamp != stamp:
            self._surface = _surface_of(self._dataset, scalars)
        return self._surface


def _with_ladder(
    method: str | Callable[..., Any], settings: dict[str, Any], names: Sequence[str] = LADDER
) -> dict[str, Any]:
    """Return settings with what their accuracy chooses of a scale space."""
    if settings.get("budget") is not None:
        raise MeshdepictError(
            "budget is for bakes, and mesh.depict keeps what it has smoothed: choose an accuracy"
        )
    if settings.get("accuracy") is None or settings.get("blend") is not None:
        return settings
    taken = Look(method, **settings).taken
    return {**{name: taken[name] for name in names if name in taken}, **settings}


class _Surface:
    """The shape of a dataset as it was, with its scale spaces."""

    def __init__(
        self,
        shape: Mesh | HeightField,
        stamp: tuple[Any, ...],
        where: str,
        name: str = "",
        there: NDArray[np.bool_] | None = None,
    ):
        self.shape, self.stamp = shape, stamp
        self.where, self.name, self.there = where, name, there
        self._spaces: dict[tuple[Any, ...], ScaleSpace] = {}

    def space(
        self, declared: Declaration, ladder: Mapping[str, Any], z_factor: float
    ) -> ScaleSpace:
        """Return the scale space that `bake` would make; made once."""
        shape = self.shape
        if isinstance(shape, HeightField):
            shape = shape.raised(z_factor)
        else:
            z_factor = 1.0  # which `bake` refuses to change
        wanted = {name: ladder.get(name, _BAKE[name].default) for name in LADDER}
        if wanted["scales"] is None or declared.scales == 0:
            wanted["scales"] = declared.scales
        wanted["ratio"] = wanted["ratio"] or declared.ratio
        key = (z_factor, *wanted.values())
        if key not in self._spaces:
            self._spaces[key] = scale_space(shape, **wanted, at_once=())
        return self._spaces[key]

    def of(self, dataset: Any) -> _Surface:
        """Return the same surface, known as that of a copy of the dataset."""
        twin = _Surface(
            self.shape, _stamp(dataset, self.name or None), self.where, self.name, self.there
        )
        twin._spaces = self._spaces
        return twin


def _kind(dataset: Any) -> str:
    """Return "mesh", "layer", "heights" or "volume"; refuse other datasets."""
    if hasattr(dataset, "GetPolys"):
        return "mesh"
    if hasattr(dataset, "direction_matrix"):
        return "heights" if 1 in dataset.dimensions else "volume"
    if is_layer(dataset):
        return "layer"
    raise MeshdepictError(
        f"{_a(type(dataset).__name__)} has no surface of its own to shade: take "
        ".extract_surface() first"
    )


def _a(name: str) -> str:
    return f"an {name}" if name[:1] in "AEIOU" else f"a {name}"


def _stamp(dataset: Any, scalars: str | None) -> tuple[Any, ...]:
    """Return when the geometry last changed, by VTK's own clock."""
    if _kind(dataset) == "mesh":
        parts = dataset.GetPoints(), dataset.GetPolys(), dataset.GetStrips()
        return tuple(part.GetMTime() for part in parts if part is not None)
    if _kind(dataset) == "layer":
        return dataset.GetPoints().GetMTime(), dataset.dimensions
    where, name = scalar_array(dataset, scalars)
    data = dataset.GetPointData() if where == "point" else dataset.GetCellData()
    place = dataset.dimensions, dataset.spacing, dataset.origin
    return where, name, data.GetArray(name).GetMTime(), place, dataset.direction_matrix.tobytes()


def _surface_of(dataset: Any, scalars: str | None) -> _Surface:
    stamp = _stamp(dataset, scalars)
    if _kind(dataset) == "mesh":
        return _Surface(as_mesh(dataset), stamp, "point")
    if _kind(dataset) == "layer":
        shape, there = structured_ground(dataset)
        return _Surface(shape, stamp, "point", "", there)
    where, name = scalar_array(dataset, scalars)
    shape, there = image_ground(dataset, where, name)
    return _Surface(shape, stamp, where, name, there)


def _dressed(dataset: Any, surface: _Surface, baked: Baked) -> Any:
    """Return a copy of a dataset with a bake's colours and values."""
    colors, values = baked.colors, baked.intensity
    if surface.there is not None:
        count = len(surface.there)
        colors = np.full((count, 3), _NEUTRAL, np.uint8)
        colors[surface.there] = baked.colors
        values = np.full((count, *baked.intensity.shape[1:]), 0.5, baked.intensity.dtype)
        values[surface.there] = baked.intensity
    result = dataset.copy()
    data = result.point_data if surface.where == "point" else result.cell_data
    if "RGB" in data and _FIELD not in result.field_data:
        data["original_RGB"] = np.array(data["RGB"])
    data["RGB"] = colors
    data[f"depict_{baked.provenance['method']}"] = values
    result.field_data[_FIELD] = baked.comments
    if surface.name:
        result.field_data[SCALARS] = [surface.name]
    result.set_active_scalars("RGB", preference=surface.where)
    return result


def _volume_of(image: ImageData, where: str, name: str) -> Volume:
    """Return the volume of one array of an image."""
    from meshdepict.shapes.volume import Volume

    alone = image.copy(deep=False)
    for data in (alone.point_data, alone.cell_data):
        for other in [key for key in data if key != name]:
            del data[other]
    data = alone.point_data if where == "point" else alone.cell_data
    data.active_scalars_name = name
    return Volume.from_pyvista(alone)


def _as_accessor_method(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return ``depict.<name>(…)`` with a signature and a text for help and tab completion."""

    def shade(self: Depict, **settings: Any) -> Any:
        return self(name, **settings)

    options = options_of(function)
    keyword = inspect.Parameter.KEYWORD_ONLY
    own = [
        inspect.Parameter(option.name, keyword, default=option.default, annotation=option.kind)
        for option in options.values()
    ]
    itself = inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY)
    shade.__name__, shade.__qualname__ = name, f"Depict.{name}"
    shade.__signature__ = inspect.Signature([itself, *_BAKE.values(), *own])  # type: ignore[attr-defined]
    lines = [
        f"{(inspect.getdoc(function) or name).splitlines()[0]}",
        "",
        f'Returns a copy with the colours "RGB" and the values "depict_{name}".',
        "",
        "Parameters",
        "----------",
        f"{', '.join(_BAKE)}",
        "    As for `meshdepict.bake`.",
    ]
    for option in options.values():
        lines += [f"{option.name} : {option.accepts}", f"    {option.help}".rstrip()]
    shade.__doc__ = "\n".join(line for line in lines)
    return shade


for _name, _function in METHODS.items():
    setattr(Depict, _name, _as_accessor_method(_name, _function))


def register() -> None:
    """Make ``.depict`` known to PyVista; more than once does no harm."""
    import pyvista as pv

    # On all datasets, so that those without a surface say what to do.
    pv.register_dataset_accessor("depict", pv.DataSet)(Depict)


register()
