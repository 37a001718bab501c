"""Whatever is given for whatever parameter: a result, or one sentence on one line."""

from __future__ import annotations

import datetime
import inspect
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import meshdepict as md
from meshdepict import color, samples, threads
from meshdepict.color.transfer import for_volume, preset
from meshdepict.color.transfer_function import TransferFunction
from meshdepict.drawing.figure import Figure
from meshdepict.errors import MeshdepictError
from meshdepict.options import options_of, real
from meshdepict.samples.phantom import ct_phantom
from meshdepict.scene.environment import Environment
from meshdepict.shading import METHODS
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.isosurface import isosurface
from meshdepict.shapes.volume import Volume
from meshdepict.viewer.session import Session

JUNK = [
    None, True, "x", "", "nan", "1e400", b"x", 3, -1, 0, 2.5, float("nan"), float("inf"), 10**400,
    1j, [], [1], [[1, 2], [3]], {}, {"a": 1}, {1}, object(), int, lambda: 1, [None],
    np.array([]), np.array([1.0, 2.0]), np.zeros((2, 2, 2)), np.array("x"), np.float64("nan"),
    np.ma.masked, datetime.datetime(2000, 1, 1), ("northwest", 3), [[[[]]]],
    "a\0b", "\ud800", "../x", "x.hdr", "a.toml",
]  # fmt: skip

BALL = samples.sphere(60)
SPACE = md.scale_space(BALL, scales=2)
IMAGE = GBuffer.of(BALL, size=(8, 8))
CT = ct_phantom((10, 10, 10))
RAW = Volume(np.arange(27, dtype=np.int16).reshape(3, 3, 3))
UP = np.tile((0.0, 0.0, 1.0), (4, 4, 1))
SKY = Environment(np.ones((4, 8, 3)))
POINTS = [(0, 0, (0, 0, 0)), (1, 1, (1, 1, 1))]
TABLE = {"points": [{"value": v, "opacity": o, "color": c} for v, o, c in POINTS]}

CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "bake": (md.bake, {"shape": BALL, "scales": 1}),
    "bake an image": (md.bake, {"shape": IMAGE, "scales": 1}),
    "bake_together": (md.bake_together, {"shapes": [BALL], "scales": 1}),
    "ground_under": (md.ground_under, {"mesh": BALL}),
    "bake_volume": (md.bake_volume, {"volume": CT, "scales": 1}),
    "plate": (md.plate, {"shapes": BALL, "methods": "lambert", "size": (80, 90), "views": "front"}),
    "methods": (md.methods, {}),
    "scale_space": (md.scale_space, {"shape": BALL, "scales": 1}),
    "smooth_normals": (md.smooth_normals, {"mesh": BALL, "width": 0.1}),
    "Session": (Session, {"shape": BALL, "scales": 1}),
    "Session.use": (Session(BALL, scales=1).use, {}),
    "Session.shine": (Session(BALL, scales=1).shine, {}),
    "Session.drag_light": (Session(BALL, scales=1).drag_light, {}),
    "Session.fix_light": (Session(BALL, scales=1).fix_light, {}),
    "Session.look": (Session(BALL, scales=1).look, {}),
    "Session.paint": (Session(BALL, scales=1).paint, {}),
    "Mesh": (md.Mesh, {"vertices": BALL.vertices, "faces": BALL.faces}),
    "Volume": (Volume, {"values": RAW.values}),
    "Volume.rescaled": (RAW.rescaled, {"slope": 1, "intercept": 0}),
    "isosurface": (isosurface, {"volume": CT, "value": 0}),
    "GBuffer": (
        GBuffer,
        {"view": IMAGE.view, "mask": IMAGE.mask, "normals": IMAGE.normals, "depths": IMAGE.depths},
    ),
    "GBuffer.of": (GBuffer.of, {"shape": BALL, "view": "front", "size": (8, 8)}),
    "GBuffer.from_images": (GBuffer.from_images, {"normals": UP}),
    "Environment": (Environment, {"pixels": np.ones((4, 8, 3))}),
    "Environment.from_file": (Environment.from_file, {"path": "missing.hdr"}),
    "Environment.lights": (SKY.lights, {}),
    "Environment.irradiance": (SKY.irradiance, {}),
    "Environment.lookup": (SKY.lookup, {"directions": UP[0]}),
    "Light": (md.Light, {"direction": (0, 0, 1)}),
    "Light.disc": (md.Light((0, 0, 1), spread=3).disc, {"count": 3}),
    "View": (md.View, {"position": (0, 0, 1), "focus": (0, 0, 0), "up": (0, 1, 0)}),
    "View.fitted": (md.View.fitted, {"name": "front", "shape": BALL}),
    "TransferFunction": (TransferFunction, {"points": POINTS}),
    "TransferFunction.from_toml": (TransferFunction.from_toml, {}),
    "TransferFunction.of_table": (TransferFunction.of_table, {"table": TABLE, "name": "x"}),
    "preset": (preset, {}),
    "for_volume": (for_volume, {"transfer": "bone", "volume": CT}),
    "Figure": (Figure, {}),
    "colormap": (color.colormap, {}),
    "encode": (color.encode, {"values": np.zeros(3), "linear": True}),
}


def tried(call: Callable[[], Any]) -> str | None:
    """Return the sentence of a refusal, None of a result; anything else goes on."""
    try:
        call()
    except MeshdepictError as error:
        return str(error)
    return None


@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
@pytest.mark.parametrize("name", CALLS)
def test_every_parameter_takes_anything_or_says_what_it_wants(name, folder):
    function, usual = CALLS[name]
    left_out = ("self", "progress", "linear")  # a callable, and what no person gives
    said = []
    for parameter in inspect.signature(function).parameters.values():
        if parameter.name in left_out or parameter.kind is parameter.VAR_KEYWORD:
            continue
        said += [
            tried(lambda p=parameter, j=junk: function(**{**usual, p.name: j})) for junk in JUNK
        ]
    refused = [sentence for sentence in said if sentence is not None]
    assert refused
    assert all(len(sentence.splitlines()) == 1 for sentence in refused)


@pytest.mark.filterwarnings("ignore::meshdepict.errors.MeshdepictWarning")
@pytest.mark.parametrize("method", METHODS)
def test_every_option_takes_anything_or_says_what_it_wants(method):
    for option in options_of(METHODS[method]):
        said = [tried(lambda o=option, j=junk: md.bake(SPACE, method, **{o: j})) for junk in JUNK]
        refused = [sentence for sentence in said if sentence is not None]
        assert len(refused) > 10
        assert all(len(sentence.splitlines()) == 1 for sentence in refused)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"ratio": "x"}, "ratio='x' is not a number above 1"),
        ({"scales": float("nan")}, "scales=nan is not a whole number"),
        ({"scales": "3"}, "scales='3' is not a whole number"),
        ({"tolerance": None}, "tolerance=None is not an angle"),
        ({"facing": "x"}, "facing='x' is neither 0"),
        ({"width": True}, "width=True is not a positive length"),
        ({"colormap": 1}, "a colour map is given by its name, not as 1"),
        ({"colormap2d": []}, "no 2D colour map"),
        ({"refine": "x"}, "refine='x' is not a number of grey levels"),
        ({"light": 3}, "light=3 is neither a name"),
        ({"view": 3}, "no view is called 3"),
        ({"up": 3}, "up=3 is not one of"),
        ({"method": 3}, "no method is called 3"),
        ({"albedo": ["keep"]}, "is neither 'keep' nor 'none'"),
    ],
)
def test_wrong_types_are_named_as_values_out_of_range_are(words, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        md.bake(BALL, **{"scales": 1, **words})


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"memory": "x"}, "memory='x' is not a number of bytes"),
        ({"memory": -1}, "memory=-1 is not a number of bytes"),
        ({"transfer": 1}, "transfer=1 is no transfer function"),
        ({"ratio": "x"}, "ratio='x' is not a number above 1"),
    ],
)
def test_the_same_of_volumes(words, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        md.bake_volume(CT, **words)


@pytest.mark.parametrize("count", ["x", float("nan"), float("inf"), np.array("x"), [1], True])
def test_threads_are_counted_in_whole_numbers(count):
    with pytest.raises(MeshdepictError, match="makes no sense"):
        threads.limit(count)


def test_a_real_number_is_what_is_one():
    quarter = Fraction(1, 4)
    for value, number in ((2, 2.0), (np.float32(0.5), 0.5), (np.array(3), 3.0), (quarter, 0.25)):
        assert real(value) == number
    others = (True, np.True_, "2", None, float("nan"), 10**400, 1j, np.array([2.0]), np.ma.masked)
    assert [real(value) for value in others] == [None] * len(others)


def test_what_is_quoted_never_breaks_the_line():
    assert str(MeshdepictError("a\n  b\r\nc  d")) == "a b c  d"
