"""What every extreme case is asked: a proper picture, or one sentence."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from numpy.typing import NDArray

import meshdepict as md
from meshdepict.options import options_of
from meshdepict.shading import METHODS

__all__ = ["always", "proper", "refused", "taken_or_refused", "usual", "variants"]

# pytest --hypothesis-profile long: other examples every time, for hours.
_LONG = settings.default is not None and settings.default.max_examples > 1_000


def always(few: int) -> settings:
    """Return settings: a few examples, the same every time, unless the profile is a long one."""
    return settings(
        max_examples=settings.default.max_examples if _LONG and settings.default else few,
        deadline=None, derandomize=not _LONG, database=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip


def proper(values: NDArray[Any], count: int) -> NDArray[Any]:
    """Return what a method gave, which is finite and in [0, 1], of the right shape and type."""
    assert values.shape in ((count,), (count, 3))
    assert values.dtype in (np.float32, np.float64)
    assert np.isfinite(values).all()
    assert values.min() >= 0
    assert values.max() <= 1
    return values


@contextmanager
def taken_or_refused() -> Iterator[None]:
    """Let nothing but a refusal of one sentence pass."""
    try:
        yield
    except md.MeshdepictError as error:
        one_sentence(str(error))


def refused(call: Callable[[], Any]) -> str:
    """Return the sentence that a call is refused with."""
    with pytest.raises(md.MeshdepictError) as caught:
        call()
    return one_sentence(str(caught.value))


def one_sentence(said: str) -> str:
    assert said
    assert said.isprintable()
    assert "\n" not in said
    return said


def usual(method: str) -> dict[str, Any]:
    """Return options with which a method takes milliseconds."""
    return {"rays": 8} if "rays" in options_of(METHODS[method]) else {}


def variants(method: str) -> list[dict[str, Any]]:
    """Return options that lead a method over all of its ways."""
    known, few = options_of(METHODS[method]), usual(method)
    found = [few]
    if "bounces" in known:
        found += [few | {"shadows": True}, few | {"bounces": 2, "denoise": 16.0}]
    if "curvature" in known:
        found += [few | {"curvature": "view"}]
    if "material" in known:
        none = ("mirror", "refractive")  # which show environments alone
        none += ("half_lambert", "lit_sphere") if method == "light_warping" else ()
        found += [few | {"material": m} for m in known["material"].accepts.names if m not in none]
    if "transmitted" in known:
        found += [few | {"transmitted": 1.0, "interfaces": 2}]
    return found
