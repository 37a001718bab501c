import math
from typing import Annotated

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.options import Choice, Range, as_text, check, nearest, options_of, parse


def shade(
    space,
    plain=3,
    *,
    strength: Annotated[float, Range(0, 1, help="how much", unit="radii", soft=(0, 0.5))] = 0.5,
    rays: Annotated[int, Range(1, 4096, help="how many")] = 256,
    free: Annotated[float, Range(help="any")] = 0.0,
    where: Annotated[str, Choice(("object", "view"), help="of what")] = "object",
    each: Annotated[float | tuple[float, ...], Range(0, 1)] = 0.5,
    tint: Annotated[tuple[float, float, float], Range(0, 1)] = (1.0, 0.5, 0.0),
    cut: Annotated[float | None, Range(0)] = None,
    other: Annotated[str, "no range"] = "",
):
    return locals()


def test_options_are_what_is_annotated_in_order():
    found = options_of(shade)
    assert list(found) == ["strength", "rays", "free", "where", "each", "tint", "cut"]
    strength = found["strength"]
    assert (strength.name, strength.kind, strength.default) == ("strength", float, 0.5)
    assert strength.accepts == Range(0, 1, help="how much", unit="radii", soft=(0, 0.5))
    assert strength.help == "how much"
    assert found["rays"].kind is int
    assert [found[name].count for name in ("strength", "each", "tint")] == [1, 0, 3]


def test_options_cannot_be_spoilt():
    with pytest.raises(TypeError):
        options_of(shade)["strength"] = None


@pytest.mark.parametrize(
    ("accepts", "text"),
    [
        (Range(), "any number"),
        (Range(0), "≥ 0"),
        (Range(high=5, unit="degrees"), "≤ 5 degrees"),
        (Range(0, 1e30), "0 … 1e+30"),
        (Choice(("object", "view")), "object | view"),
    ],
)
def test_ranges_in_words(accepts, text):
    assert str(accepts) == text


# --- checking ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "value"),
    [
        ({"strength": 0}, 0.0),
        ({"strength": 1}, 1.0),
        ({"strength": "0.25"}, 0.25),
        ({"strength": np.float32(0.5)}, 0.5),
        ({"rays": 7.0}, 7),
        ({"rays": " 12 "}, 12),
        ({"rays": "1e3"}, 1000),
        ({"free": -1e308}, -1e308),
        ({"where": "view"}, "view"),
        ({"each": 0.25}, 0.25),
        ({"each": "0.25"}, 0.25),
        ({"each": "0.25,1"}, (0.25, 1.0)),
        ({"each": [1]}, (1.0,)),
        ({"tint": "0,0.5,1"}, (0.0, 0.5, 1.0)),
        ({"tint": np.array([0, 0.5, 1])}, (0.0, 0.5, 1.0)),
        ({"cut": None}, None),
        ({"cut": 3}, 3.0),
    ],
)
def test_values_in_their_range_become_their_type(given, value):
    checked = check(shade, given, "shade")
    ((name, found),) = checked.items()
    assert name in given
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"strength": 1.1}, "shade: strength=1.1 is not a number in its range (0 … 1 radii)"),
        ({"strength": -1}, "strength=-1 is not a number in its range"),
        ({"strength": math.nan}, "strength=nan is not a number"),
        ({"strength": True}, "strength=True is not a number"),
        ({"strength": "half"}, "strength='half' is not a number"),
        ({"strength": None}, "strength=None is not a number"),
        ({"strength": [0.5, 0.5]}, "strength=[0.5, 0.5] is not a number"),
        ({"strength": 10**400}, "is not a number in its range"),
        ({"free": math.inf}, "free=inf is not a number in its range (any number)"),
        ({"free": "1e400"}, "free='1e400' is not a number in its range"),
        ({"rays": 1.5}, "shade: rays=1.5 is not a whole number"),
        ({"rays": math.inf}, "rays=inf is not a number in its range (1 … 4096)"),
        ({"where": "viev"}, "where='viev' is not one of object | view; did you mean 'view'?"),
        ({"where": 3}, "where=3 is not one of object | view"),
        ({"each": ""}, "each='' is not a number"),
        ({"each": []}, "each=[] is not one number or several separated by commas"),
        ({"each": [0.5, 2]}, "each=2 is not a number in its range"),
        ({"each": True}, "each=True is not a number"),
        ({"tint": (0, 1)}, "tint=(0, 1) is not 3 numbers separated by commas"),
        ({"tint": 0.5}, "tint=0.5 is not 3 numbers"),
        ({"strengt": 1}, "shade has no option 'strengt'; did you mean 'strength'? (its options: "),
        ({"plain": 1}, "shade has no option 'plain'"),
        ({"zzz": 1}, "shade has no option 'zzz' (its options: strength, rays,"),
    ],
)
def test_other_values_are_refused_with_one_sentence(given, sentence):
    with pytest.raises(MeshdepictError) as caught:
        check(shade, given, "shade")
    assert sentence in str(caught.value)


def test_what_has_no_options_says_so():
    with pytest.raises(MeshdepictError, match=r"abs has no option 'x' \(its options: none\)"):
        check(abs, {"x": 1}, "abs")


@pytest.mark.parametrize("name", ["strength", "rays", "where", "each", "tint"])
def test_a_text_of_a_value_stands_for_the_value(name):
    option = options_of(shade)[name]
    assert parse(option, as_text(option.default), "shade") == option.default


def test_texts_keep_single_precision():
    value = float(np.float32(1 / 3))
    assert np.float32(as_text(value)) == np.float32(1 / 3)


# --- the nearest word -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("exagerated", "; did you mean 'exaggerated'?"),
        ("lamber", "; did you mean 'lambert'?"),
        ("qqqqq", ""),
        ("", ""),
        (3, ""),
    ],
)
def test_the_nearest_word_is_named_where_one_is_near(word, text):
    assert nearest(word, ("exaggerated", "lambert", "half_lambert")) == text
