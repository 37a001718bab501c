"""What a person chooses of a bake's looks: one list of names, with their defaults and their words.

Everything that takes a look or writes one down (bakes, recipes, windows, pages, the command line)
takes `Choices`, which are these; nothing lists these names a second time.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

from meshdepict.baking.accuracy import NORMAL
from meshdepict.scales.ladder import FACING, TOLERANCE
from meshdepict.scene.names import LightsLike
from meshdepict.scene.view import View

__all__ = [
    "AUTO",
    "HEIGHTS",
    "IMAGE",
    "LADDER",
    "MESH",
    "SIDES",
    "VOLUME",
    "ChoiceList",
    "choice_fields",
]

MESH, VOLUME, HEIGHTS, IMAGE = "mesh", "volume", "height field", "image"

_FACES = (MESH, IMAGE)  # what has triangles, or shows some
_SURFACES = (*_FACES, HEIGHTS)

AUTO = "auto"
"""Of up and view: what suits the shape."""

LADDER = ("scales", "width", "ratio", "facing", "tolerance")
"""Those of the choices that scale spaces are made with."""

SIDES = ("creases", "normals")
"""Those that their surface is made with."""


def _choice(
    default: Any,
    help: str,  # noqa: A002
    *,
    group: str = "Look",
    only: tuple[str, ...] = (),
    alone: str = "",
) -> Any:
    """Declare a choice: what it is for, where help lists it, and which kinds alone have it.

    ``alone`` is what its word on the command line stands for without a value.
    """
    about = {"help": help, "group": group, "only": only, "alone": alone}
    return field(default=default, metadata=about)


@dataclass(frozen=True, init=False, eq=False)
class ChoiceList:
    """How a shape shall look.

    Parameters
    ----------
    method : str or function
        A name of `shading.METHODS`, or a function made by the decorator `meshdepict.method`; the
        attribute `method` is its name, `function` the function.
    light : str, (3,) array_like, (azimuth, elevation) or Light, optional
        For some methods also "studio", "key-and-fill", a sequence of these, or an Environment or
        its file (.hdr). Names and angles refer to the view. Unless given, what the method declares:
        northwest, and lights that show what it is for where one would not.
    sampling : {"lobes", "lights"}
        How a panorama's file is: see `Environment`.
    view : str or View
        "front", "top", …; fitted to the shape. "auto" takes the one that shows most of it; see
        `shapes.standing`. Of a height field "front" and "auto" are the map: from above, north up.
    up : {"y", "z", "-y", "-z", "x", "-x", "auto"}, optional
        Which axis of the shape points up; unless given y, and z of a volume, as in a patient's
        frame, and of a height field. "auto" takes what the file's format defines, else how the
        shape can stand.
    scales, width, ratio, facing, tolerance
        See `scale_space`; None takes what the method declares.
    accuracy : {"draft", "normal", "reference"}
        A named set of these numbers and of the method's own rays and lights, those that nobody
        gives: see `accuracy.ACCURACIES` and docs/accuracy.md.
    budget : float or str, optional
        Seconds that a bake may take, as a number or such as "2s", "500ms", "1min": it has the best
        accuracy that is predicted to fit, or draft where none is. In place of ``accuracy``.
    colormap : str, optional
        Name of a 1D colour map of the result; grey unless given.
    colormap2d : {"dusk", "earth", "swiss"}, optional
        A map of two results: under the light, and under the light turned by 90° clockwise as the
        view sees it (northwest and northeast).
    blend : str or sequence, optional
        Pictures of several methods laid one upon the other, the first on top: the name of a
        combination, a text such as "sky_view:multiply:0.5,exaggerated", or layers; see `as_layers`.
        Each looks as it does alone. The method, its options and the light are then those of its
        layer, the lowest one's unless another is named.
    tint : str or (name, low, high), optional
        Colours by height, multiplied in linear light: "earth", "swiss", "desert" or a colour map,
        from the lowest to the highest point, or between two heights: "earth:0..3000".
    creases : float, optional
        Edges at which the surface bends by more than so many degrees are sharp: vertices there are
        parted, so that planes have one normal. New vertices come after the old ones.
    normals : {"computed", "file"}
        "file" takes the normals that the file holds; vertices that have several are parted.
    albedo : {"none", "keep"}
        "keep" multiplies the shape's own vertex colours, or its texture's at the vertices (along
        seams their mean), in linear light.
    refine : float, optional
        Split the triangles inside which interpolated colours are off by more than so many of 255
        grey levels, until they are not (five times at most); see `Baked.edge_error`. New vertices
        come after the old ones.
    ground : {"matt", "mirror"}, optional
        A level ground under a mesh, which pictures show; see `ground_under`. What is matt catches
        shadows and sends light up, a mirror shows what stands on it.
    two_sided : bool
        Shade the side that the view sees, also where faces look away from it.
    z_factor : float
        Of height fields: times their heights, before anything else.
    transfer : str or TransferFunction, optional
        Of volumes: opacity and base colour; a preset's name, a .toml file or a function. "bone"
        unless given.
    **options
        The method's own options.

    Raises
    ------
    MeshdepictError
        For anything unknown or out of range.
    """

    method: str = _choice("exaggerated", "How to shade: meshdepict methods lists what there is.")
    light: LightsLike | None = _choice(
        None,
        "A name (north, northeast, … northwest, front), azimuth,elevation in degrees, x,y,z; with "
        ":20 a disc of that half-angle, whose shadows are soft; where a method takes several also "
        "studio, key-and-fill, a panorama.hdr, or some parted by semicolons. [default: what the "
        "method asks for, mostly northwest]",
    )
    sampling: Literal["lobes", "lights"] = _choice(
        "lobes",
        "A panorama.hdr: lobes samples narrow highlights where they are; lights cuts all of it "
        "into lights, as version 0.1 did.",
    )
    view: str | View = _choice(
        "front",
        "Where names of lights and the picture look from: front, back, left, right, top, bottom, "
        "isometric, or auto: what shows most of it.",
    )
    up: Literal["auto", "y", "z", "-y", "-z", "x", "-x"] | None = _choice(
        None,
        "Axis of the object that points up, or auto: as its format has it, else as it can stand.",
    )
    colormap: str | None = _choice(
        None, "Colours for dark to bright; grey unless given.", only=_SURFACES
    )
    colormap2d: str | None = _choice(
        None, "Colours for two lights, the other one 90° clockwise: dusk, earth or swiss.",
        only=_SURFACES,
    )  # fmt: skip
    blend: Any = _choice(
        None,
        "Methods laid one upon the other, the first on top: archaeological, vat_flat, "
        "geomorphological, or method:mode:opacity parted by commas, as in "
        "sky_view:multiply:0.5,exaggerated.",
        only=_SURFACES,
    )
    tint: Any = _choice(
        None,
        "Colours by height, multiplied in linear light: earth, swiss, desert or a colour map, also "
        "between two heights, as in earth:0..3000.",
        only=_SURFACES,
    )
    transfer: Any = _choice(
        None,
        "What is shown, and its colours: bone, skin, muscle, lung, micro-ct, or a .toml file; bone "
        "unless given.",
        only=(VOLUME,),
    )
    z_factor: float = _choice(
        1.0, "Times the heights of terrain, cartographers' vertical exaggeration.",
        group="Detail", only=(HEIGHTS,),
    )  # fmt: skip
    scales: int | None = _choice(
        None, "How often to smooth; unless given, as often as the method wants.", group="Detail"
    )
    width: float | str | None = _choice(
        None,
        "First smoothing width in the file's units, terrain's metres, or 5mm where they are known, "
        "a share of the diagonal such as 0.2%, pixels of the picture such as 3px, cells of terrain "
        "such as 3cells, or the larger of two such as 0.2%,3px; unless given, the median edge, a "
        "cell, or the largest distance of voxels.",
        group="Detail",
    )
    ratio: float | None = _choice(None, "From one width to the next.", group="Detail")
    facing: Literal[0, 1] = _choice(
        FACING, "1 keeps the two sides of thin sheets apart; 0 is the plain sum of the paper.",
        group="Detail", only=_SURFACES,
    )  # fmt: skip
    tolerance: float = _choice(TOLERANCE, "Largest error of a normal, in radians.", group="Detail")
    accuracy: Literal["draft", "normal", "reference"] = _choice(
        NORMAL,
        "Tolerance, rays, lights of an environment and number of scales together: draft for "
        "previews, reference below half a grey level; what else is said comes first.",
        group="Detail",
    )
    budget: float | str | None = _choice(
        None,
        "Seconds that it may take, such as 2s, 500ms or 1min: the best accuracy that fits, as "
        "predicted.",
        group="Detail",
    )
    refine: float | None = _choice(
        None,
        "Split triangles inside which colours would be off by more than so many of 255 grey "
        "levels, 2 for instance.",
        group="Detail",
        only=_FACES,
    )
    creases: float | None = _choice(
        None,
        "Edges that bend by more than so many degrees are sharp: vertices there are parted. 40 "
        "suits CAD.",
        group="Detail",
        only=_FACES,
    )
    normals: Literal["computed", "file"] = _choice(
        "computed", "file: take the file's own normals.", group="Detail", only=_FACES
    )
    albedo: Literal["keep", "none"] = _choice(
        "none",
        "keep: multiply the file's own colours, or its texture's.",
        group="Files",
        only=_SURFACES,
    )
    ground: Literal["matt", "mirror"] | None = _choice(
        None,
        "A level ground under the object that pictures show: matt, for shadows and bounces, which "
        "--ground alone means, or a mirror.",
        only=(MESH,),
        alone="matt",
    )
    two_sided: bool = _choice(
        False,  # noqa: FBT003
        "Shade the side that is seen, also where faces look away from the eye: for open sheets.",
        only=_SURFACES,
    )
    options: Mapping[str, Any] = field(default_factory=dict)
    function: ClassVar[Callable[..., Any]]  # no choice of its own: it follows from the method


@functools.cache
def choice_fields() -> Mapping[str, dataclasses.Field[Any]]:
    """Return the choices by name, but for the options of the method."""
    return {each.name: each for each in dataclasses.fields(ChoiceList) if each.name != "options"}
