"""Options that are several numbers: one for all, a comma list, a fixed number, or none."""

from typing import Annotated

import numpy as np
import pytest

from meshdepict.errors import MeshdepictError
from meshdepict.options import Range, as_text, check, options_of, parse


def function(
    *,
    strength: Annotated[float | tuple[float, ...], Range(0, 1)] = 0.5,
    focus: Annotated[tuple[float, float, float] | None, Range()] = None,
    counts: Annotated[tuple[int, ...], Range(0, 9)] = (1, 2),
    plain: Annotated[float, Range(0, 1)] = 0.25,
):
    return strength, focus, counts, plain


def one(name, value):
    return check(function, {name: value}, "f")[name]


def test_kinds_and_counts_follow_the_annotation():
    known = options_of(function)
    assert {name: (o.kind, o.count) for name, o in known.items()} == {
        "strength": (float, 0), "focus": (float, 3), "counts": (int, 0), "plain": (float, 1),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("0.9,0.6,0.4", (0.9, 0.6, 0.4)),
        (" 0.9, 0.6 ", (0.9, 0.6)),
        ("0.7", 0.7),
        (0.7, 0.7),
        (np.float32(0.5), 0.5),
        ([0.1, 1], (0.1, 1.0)),
        (np.array([0.25, 0.5]), (0.25, 0.5)),
        ((0.5,), (0.5,)),
    ],
)
def test_one_number_or_several(given, expected):
    assert one("strength", given) == expected


@pytest.mark.parametrize("given", ["1,2,3", (1, 2, 3), np.array([1.0, 2.0, 3.0])])
def test_exactly_three_numbers(given):
    assert one("focus", given) == (1.0, 2.0, 3.0)


def test_an_option_that_may_be_left_out_may_be_none():
    assert one("focus", None) is None
    with pytest.raises(MeshdepictError, match="plain=None is not a number"):
        one("plain", None)


def test_whole_numbers():
    assert one("counts", "3,4") == (3, 4)
    with pytest.raises(MeshdepictError, match="not a whole number"):
        one("counts", "3,4.5")


@pytest.mark.parametrize(
    ("name", "given", "message"),
    [
        ("strength", "0.5,2", r"strength='2' is not a number in its range \(0 … 1\)"),
        ("strength", "0.5,", r"strength='' is not a number"),
        ("strength", (), r"strength=\(\) is not one number or several separated by commas"),
        ("strength", True, "strength=True is not a number"),
        ("strength", (0.5, True), "strength=True is not a number"),
        ("strength", (0.5, float("nan")), "strength=nan is not a number"),
        ("focus", "1,2", "is not 3 numbers separated by commas"),
        ("focus", 1.0, "focus=1.0 is not 3 numbers separated by commas"),
        ("focus", "1", "focus='1' is not 3 numbers"),
        ("focus", (1, 2, [3]), r"focus=\[3\] is not a number"),
    ],
)
def test_wrong_values_are_refused_in_one_sentence(name, given, message):
    with pytest.raises(MeshdepictError, match=f"f: .*{message}"):
        one(name, given)


def test_text_and_value_are_each_others_inverse():
    option = options_of(function)["strength"]
    for value in (0.1, (0.1, 0.25), (1.0,) * 3):
        assert parse(option, as_text(value), "f") == value
    assert as_text(3) == "3"
    assert as_text("word") == "word"
