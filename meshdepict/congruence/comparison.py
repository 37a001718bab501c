"""Compare methods under many lights: pictures of one view and their congruence with the shape."""

from __future__ import annotations

import functools
import operator
import time
import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from meshdepict import color
from meshdepict.baking.accuracy import NORMAL
from meshdepict.baking.choice_list import HEIGHTS, IMAGE, SIDES
from meshdepict.baking.look import Look
from meshdepict.baking.surfaces import as_solid, with_choices
from meshdepict.congruence.judging import Judge, ShapeFlow, check_flow, picture
from meshdepict.congruence.lights import light_directions
from meshdepict.errors import MeshdepictError
from meshdepict.options import as_text, check, options_of
from meshdepict.scales.ladder import FACING, Progress
from meshdepict.scales.making import scale_space
from meshdepict.scales.reads import Reads
from meshdepict.scene.light import Light
from meshdepict.scene.names import as_light, light_angles
from meshdepict.scene.view import View
from meshdepict.shading.method import declaration
from meshdepict.shading.registry import METHODS, find_method
from meshdepict.shapes.gbuffer import GBuffer

if TYPE_CHECKING:
    from meshdepict.shapes.height_field import HeightField
    from meshdepict.shapes.mesh import Mesh

__all__ = ["Comparison", "compare", "options_text", "usual_methods"]

Shading = Callable[..., Any]
Scored = Literal["declared", "linear", "display"]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Scores and pictures of methods under lights.

    Attributes
    ----------
    methods : tuple of str
    lights : tuple of Light
    scores : (methods, lights) array
        Congruence, 0 … 1; see `congruence.score`.
    pictures : (methods, lights, height, width, 3) array of uint8
        Display colours on `background`.
    score_pictures : tuple of (height, width, 4) arrays of uint8
        For each method where its congruence is good (blue) and poor (red), under the light that
        `worst` names.
    options : tuple of dict
        Of each method.
    shape, view, settings, seconds
        What was compared, from where, how the scale space was made, and how long it took.
    """

    methods: tuple[str, ...]
    lights: tuple[Light, ...]
    scores: NDArray[np.float64]
    pictures: NDArray[np.uint8]
    score_pictures: tuple[NDArray[np.uint8], ...]
    options: tuple[dict[str, Any], ...]
    shape: Mesh | HeightField
    view: View
    settings: dict[str, Any]
    seconds: float

    def __repr__(self) -> str:
        """Return the methods with their mean scores, the best first."""
        ranked = sorted(zip(self.methods, self.means, strict=True), key=lambda pair: -pair[1])
        listed = ", ".join(f"{name} {mean:.3f}" for name, mean in ranked)
        return f"<Comparison under {len(self.lights)} lights: {listed}>"

    @property
    def means(self) -> NDArray[np.float64]:
        """(methods,) mean scores over the lights."""
        return self.scores.mean(axis=1)

    @property
    def worst(self) -> int:
        """Number of the light under which the first method scores least."""
        return int(np.argmin(self.scores[0]))

    @property
    def light_names(self) -> list[str]:
        """A short name for each light: its own, or its number."""
        return [light_name(light, i) for i, light in enumerate(self.lights, start=1)]

    @property
    def angles(self) -> list[tuple[float, float]]:
        """Azimuth and elevation of each light in degrees, in the view's frame."""
        return [light_angles(light, self.view) for light in self.lights]

    def table(self) -> list[list[str]]:
        """Return rows of texts: a heading, a row per method with its mean and every score.

        The heading names the lights, with azimuth and elevation in the view's frame.
        """
        names = [
            f"{name} (azimuth {azimuth:.0f} elevation {elevation:.0f})"
            for name, (azimuth, elevation) in zip(self.light_names, self.angles, strict=True)
        ]
        heading = ["method", "mean", *names]
        rows = [
            [name, *(f"{value:.3f}" for value in (mean, *scores))]
            for name, mean, scores in zip(self.methods, self.means, self.scores, strict=True)
        ]
        return [heading, *rows]


def compare(
    shape: object,
    methods: Sequence[str | Shading] | None = None,
    *,
    lights: Sequence[Any] | None = None,
    view: str | View = "front",
    up: str | None = None,
    size: tuple[int, int] = (480, 480),
    options: Mapping[str, Mapping[str, Any]] | None = None,
    per_pixel: bool = False,
    scored: Scored = "declared",
    flow: ShapeFlow = "depth",
    scales: int = 6,
    width: float | str | None = None,
    ratio: float = 1.7,
    facing: int = FACING,
    tolerance: float | None = None,
    accuracy: str = NORMAL,
    creases: float | None = None,
    normals: str = "computed",
    z_factor: float = 1.0,
    background: tuple[int, int, int] = (198, 205, 214),
    progress: Progress | None = None,
) -> Comparison:
    """Shade a surface by several methods under several lights, and score them all.

    All methods share one scale space, smoothed at those widths that one of them reads. Methods that
    can see with the view's eye do so here (``curvature="view"``), as they were published.

    Parameters
    ----------
    shape : path, Mesh, HeightField, pyvista.PolyData or trimesh.Trimesh
    methods : sequence of str or function, optional
        As for `bake`; `usual_methods` unless given.
    lights : sequence, optional
        The 21 lights of Local Light Alignment, §7, unless given.
    view, up
        As for `bake`.
    size : (width, height)
        Of every picture, in pixels; scores depend on it.
    options : mapping, optional
        Options of methods: ``{"exaggerated": {"exaggeration": 30}}``. Unless given, those that a
        method declares as `compared`: of Local Light Alignment's comparison, on a matt material,
        and for Exaggerated Shading of its own paper's examples.
    per_pixel : bool
        Shade pixels, as the papers do, instead of vertices.
    scored : {"declared", "linear", "display"}
        What values are scored: as each method declares its own (linear light of most, display
        values of Exaggerated Shading), or those of all alike.
    flow : {"depth", "slope"}
        What the shape's flow is read from: the depth, as in the paper, or the original normals, by
        how they tilt; see `congruence.score`.
    scales, width, ratio, facing, tolerance
        Of the scale space; see `scale_space`. Scales and ratio are the comparison's own, whatever
        the accuracy.
    accuracy
        As for `bake`.
    creases, normals, z_factor
        As for `bake`.
    background : three of 0 … 255
    progress : callable, optional
        ``progress(done, total)``.

    Returns
    -------
    Comparison

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range, no method, no light, a view that misses the shape.
    """
    start = time.perf_counter()
    if scored not in typing.get_args(Scored):
        raise MeshdepictError(f"scored={scored!r} is none of {', '.join(typing.get_args(Scored))}")
    check_flow(flow)
    functions = _by_name(usual_methods() if methods is None else methods)
    seen = Look(
        view=view, up=up, creases=creases, normals=normals, z_factor=z_factor,
        accuracy=accuracy,
    )  # fmt: skip
    if tolerance is not None:
        seen = seen.replace(tolerance=tolerance)
    solid = as_solid(shape)
    seen.of_kind(solid.kind)  # refuses what is about other kinds
    mesh = with_choices(solid, seen)
    chosen = _options(functions, options or {}, IMAGE if per_pixel else mesh.kind)
    chosen = tuple(
        dict(Look(function, accuracy=accuracy, **given).options)
        for function, given in zip(functions.values(), chosen, strict=True)
    )
    seen = seen.posed(mesh)
    made = {name: value for name, value in seen.words().items() if name in (*SIDES, "z_factor")}
    view = seen.view
    eye = view if isinstance(view, View) else _fitted(view, mesh, seen.axis(mesh.kind), size)
    buffer = GBuffer.of(mesh, eye, size=size)
    eye = buffer.view
    lamps = tuple(light_directions(eye) if lights is None else (as_light(x, eye) for x in lights))
    if not lamps:
        raise MeshdepictError("compare needs at least one light")
    steps = len(functions) * len(lamps)
    smoothing: dict[str, Any] = {
        "scales": scales, "width": width, "ratio": ratio, "facing": facing,
        "tolerance": seen.tolerance,
    }  # fmt: skip
    half = (lambda done, total: progress(done / total * steps, 2 * steps)) if progress else None
    space = scale_space(buffer if per_pixel else mesh, **smoothing, view=eye, at_once=())
    for_all = zip(functions.values(), chosen, strict=True)
    reads = (Look(function, **given).reads(space.last) for function, given in for_all)
    space.smooth(functools.reduce(operator.or_, reads, Reads()).sets, progress=half)

    def shaded(function: Shading, lamp: Light, options: Mapping[str, Any]) -> NDArray[Any]:
        values = Look(function, **options).shade(space, lamp, eye)
        return values if per_pixel else buffer.sample(values)

    def judged(values: NDArray[Any], function: Shading) -> NDArray[Any]:
        return buffer.image(_alike(values, scored, linear=declaration(function).linear))

    lambert = METHODS["lambert"]
    reference = shaded(lambert, Light(eye.towards_eye), {})
    judge = Judge(
        buffer.depth, buffer.mask, reference=judged(reference, lambert), flow=flow,
        normals=buffer.image(buffer.normals @ eye.frame.T) if flow == "slope" else None,
    )  # fmt: skip
    scores = np.zeros((len(functions), len(lamps)))
    height, width_px = buffer.mask.shape
    pictures = np.empty((len(functions), len(lamps), height, width_px, 3), np.uint8)
    for row, (function, given) in enumerate(zip(functions.values(), chosen, strict=True)):
        linear = declaration(function).linear
        for column, lamp in enumerate(lamps):
            values = shaded(function, lamp, given)
            scores[row, column] = judge.score(judged(values, function))
            shown = color.encode(values, linear=linear)
            pictures[row, column] = buffer.image(shown, background=background)
            if progress:
                progress(steps + row * len(lamps) + column + 1, 2 * steps)
    worst = lamps[int(np.argmin(scores[0]))]
    maps = tuple(
        picture(judge.flows(judged(shaded(function, worst, given), function)))
        for function, given in zip(functions.values(), chosen, strict=True)
    )
    return Comparison(
        methods=tuple(functions), lights=lamps, scores=scores, pictures=pictures,
        score_pictures=maps, options=chosen, shape=mesh, view=eye,
        settings={**smoothing, **made, "per_pixel": per_pixel, "scored": scored, "flow": flow},
        seconds=time.perf_counter() - start,
    )  # fmt: skip


def _alike(values: NDArray[Any], scored: str, *, linear: bool) -> NDArray[Any]:
    """Return values as they are, as linear light, or as they are displayed."""
    if scored == "linear" and not linear:
        return color.srgb_to_linear(values)
    if scored == "display" and linear:
        return color.linear_to_srgb(values)
    return values


def usual_methods() -> tuple[str, ...]:
    """Return what is compared unless said otherwise: plain shading, then what papers compare."""
    found = {name: declaration(function) for name, function in METHODS.items()}
    names = [name for name, declared in found.items() if declared.compared is not None]
    return tuple(sorted(names, key=lambda name: found[name].scales))


def light_name(light: Light, number: int) -> str:
    """Return a short name for a column; what has angles for a name, or none, gets a number."""
    if not light.name or light.name.startswith("azimuth "):
        return f"#{number}"
    return light.name


def options_text(options: Mapping[str, Any]) -> str:
    """Return options as ``--set`` takes them."""
    return " ".join(f"{name}={as_text(value)}" for name, value in options.items())


def _by_name(methods: Sequence[str | Shading]) -> dict[str, Shading]:
    """Return shading functions by their names."""
    found: dict[str, Shading] = {}
    for function in map(find_method, methods):
        name = function.__name__
        if found.setdefault(name, function) is not function:
            raise MeshdepictError(f"two methods are called {name!r}: compare them one at a time")
    if not found:
        raise MeshdepictError("compare needs at least one method")
    return found


def _options(
    functions: Mapping[str, Shading], given: Mapping[str, Mapping[str, Any]], kind: str
) -> tuple[dict[str, Any], ...]:
    """Return every method's options, checked, with what follows from the kind of shape."""
    for name in given:
        if name not in functions:
            raise MeshdepictError(
                f"options for {name!r}, which isn't compared (there are {', '.join(functions)})"
            )
    found = []
    for name, function in functions.items():
        sees = {"curvature": "view"} if "curvature" in options_of(function) else {}
        usual = sees | dict(declaration(function).compared or {})
        if kind == HEIGHTS and "one_light" in options_of(function):
            usual = {**sees, "one_light": True}  # what else papers compare is of objects
        found.append(usual | check(function, given.get(name, {}), name))
    return tuple(found)


def _fitted(name: str, mesh: Mesh | HeightField, up: str, size: tuple[int, int]) -> View:
    return View.fitted(name, mesh, up=up, aspect=size[0] / size[1], height_px=size[1])
